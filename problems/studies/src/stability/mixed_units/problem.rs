//! A convex problem in variables whose units are all 1, and what it becomes in other units.

use crate::stability::mixed_units::function::{Function, columns_over};
use nonsmooth::{InputError, Matrix, Polyhedron, Vector};

/// Where a run starts.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    Zero,
    /// At a random point.
    Random(Vector),
    /// At a point that belongs to the problem.
    Given(Vector),
    Minimiser,
    /// Outside of the active bounds: the nearest admissible point is the minimiser.
    Beyond,
}

impl Start {
    /// The kind of start in names of cases.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Zero => "from zero",
            Self::Random(_) => "from afar",
            Self::Given(_) => "as given",
            Self::Minimiser => "at the minimiser",
            Self::Beyond => "beyond the minimiser",
        }
    }
}

/// min Θ(y) over lower ≤ y ≤ upper and R y ≤ s.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The row of the table.
    pub family: &'static str,
    /// Θ, without an offset.
    pub function: Function,
    /// Lower bounds, −∞ where open.
    pub lower: Vector,
    /// Upper bounds, ∞ where open.
    pub upper: Vector,
    /// The matrix R of the rows.
    pub rows: Matrix,
    /// The right sides s.
    pub sides: Vector,
    pub starts: Vec<Start>,
}

impl Problem {
    /// The function without any constraint.
    pub fn free(family: &'static str, function: Function) -> Self {
        let n = function.dimension();
        Self {
            family,
            function,
            lower: Vector::from_element(n, f64::NEG_INFINITY),
            upper: Vector::from_element(n, f64::INFINITY),
            rows: Matrix::zeros(0, n),
            sides: Vector::zeros(0),
            starts: vec![],
        }
    }

    /// Restricts the variables to a box.
    #[must_use]
    pub fn boxed(self, (lower, upper): (Vector, Vector)) -> Self {
        Self { lower, upper, ..self }
    }

    /// Replaces the starts of the runs.
    #[must_use]
    pub fn with_starts(self, starts: Vec<Start>) -> Self {
        Self { starts, ..self }
    }

    /// Whether every variable has two finite bounds.
    pub fn is_boxed(&self) -> bool {
        self.lower.iter().chain(&self.upper).all(|side| side.is_finite())
    }

    /// The admissible set in variables D y.
    ///
    /// # Errors
    /// [`InputError`] if the data are no polyhedron.
    pub fn set(&self, units: &Vector) -> Result<Polyhedron, InputError> {
        let open = Vector::from_element(self.sides.len(), f64::NEG_INFINITY);
        let set = Polyhedron::boxed(self.lower.component_mul(units), self.upper.component_mul(units))?;
        set.with_rows(&columns_over(&self.rows, units), &open, &self.sides)
    }
}
