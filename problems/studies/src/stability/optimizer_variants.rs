//! The problems of the collection, changed in ways that must not change the optimizer's terminations.
//!
//! ```text
//! Θ(x) = a·(f(x/c) + η (1 + |f*|) noise) + s,   start σ c x₀,   one variable with a wide side, one call in ten failing
//! ```

use nonsmooth::{Answer, Evaluation, InputError, Matrix, NonsmoothObjective, OracleError, Polyhedron, Request, Vector};
use std::cell::Cell;
use testset::Problem;
use testset::kit::jitter;

/// Bound of the entries in a box with one wide side, in largest entries of the start (at least 1).
const SMALL_SIDE: f64 = 100.0;
/// Upper bound of the first entry in that box.
const WIDE_SIDE: f64 = 1e8;
/// Every how many calls one fails.
const FAILING: usize = 10;

/// Changes of start, function, variables, bounds and noise of a problem.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Variant {
    /// Factor σ of the start.
    pub start: f64,
    /// Shift s of the function.
    pub shift: f64,
    /// Factor a of the function.
    pub factor: f64,
    /// Factor c of the variables.
    pub unit: f64,
    /// Whether a box with one wide side is added.
    pub wide: bool,
    /// Whether every tenth call fails.
    pub failing: bool,
    /// Noise η relative to 1 + |f*|; the oracle states it.
    pub noise: f64,
}

impl Variant {
    /// The problem as it is.
    pub const PLAIN: Self =
        Self { start: 1.0, shift: 0.0, factor: 1.0, unit: 1.0, wide: false, failing: false, noise: 0.0 };

    /// The name of the row of the table that the variant belongs to.
    pub fn group(&self) -> &'static str {
        match self {
            _ if self.noise > 0.0 => "noise 1e-8 and 1e-4, stated",
            _ if self.failing => "every tenth call fails",
            _ if self.wide => "one wide side",
            _ if self.unit != 1.0 => "variables × 1e±2",
            _ if self.factor != 1.0 => "functions × 1e±6",
            _ if self.shift != 0.0 => "shifts ±1e8",
            _ if self.start != 1.0 => "starts × 1e-12 … 1e6",
            _ => "as they are",
        }
    }
}

/// All variants: starts and shifts combined with each other, the other changes with three starts and two shifts each,
/// noise with all starts.
pub fn variants() -> Vec<Variant> {
    let plain = Variant::PLAIN;
    let starts = [1.0, 1e-12, 1e-8, 1e-4, 1e-2, 1e3, 1e6];
    let mut all = vec![];
    for shift in [0.0, 1e8, -1e8] {
        all.extend(starts.map(|start| Variant { start, shift, ..plain }));
    }
    let changed = [
        Variant { factor: 1e6, ..plain },
        Variant { factor: 1e-6, ..plain },
        Variant { unit: 1e2, ..plain },
        Variant { unit: 1e-2, ..plain },
        Variant { wide: true, ..plain },
        Variant { failing: true, ..plain },
    ];
    for change in changed {
        for start in [1.0, 1e-8, 1e3] {
            all.extend([0.0, 1e8].map(|shift| Variant { start, shift, ..change }));
        }
    }
    for noise in [1e-8, 1e-4] {
        all.extend(starts.map(|start| Variant { start, noise, ..plain }));
    }
    all
}

/// A problem with its changes, as an objective.
pub struct Changed<'p> {
    pub problem: &'p Problem,
    pub variant: Variant,
    calls: Cell<usize>,
}

impl<'p> Changed<'p> {
    pub fn new(problem: &'p Problem, variant: Variant) -> Self {
        Self { problem, variant, calls: Cell::new(0) }
    }

    /// f(x/c) and its subgradient with respect to x/c.
    pub fn exact(&self, x: &Vector) -> (f64, Vector) {
        let (value, gradient) = self.problem.evaluate((x / self.variant.unit).as_slice());
        (value, Vector::from_vec(gradient))
    }

    /// η (1 + |f*|), in units of f.
    pub fn noise(&self) -> f64 {
        self.variant.noise * (1.0 + self.problem.optimal_value.abs())
    }

    pub fn start(&self) -> Vector {
        Vector::from_column_slice(&self.problem.start) * (self.variant.start * self.variant.unit)
    }

    /// The admissible set in the changed variables.
    pub fn set(&self) -> Result<Polyhedron, InputError> {
        let problem = self.problem;
        let vector = |values: &[f64]| Vector::from_column_slice(values);
        let (mut lower, mut upper) = (vector(&problem.lower), vector(&problem.upper));
        if self.variant.wide {
            let start = problem.start.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            lower = lower.map(|side| side.max(-SMALL_SIDE * start));
            upper = upper.map(|side| side.min(SMALL_SIDE * start));
            upper[0] = WIDE_SIDE;
        }
        let unit = self.variant.unit;
        let rows = Matrix::from_fn(problem.rows.len(), problem.dimension, |i, j| problem.rows[i][j]);
        let sides = (vector(&problem.row_lower) * unit, vector(&problem.row_upper) * unit);
        Polyhedron::boxed(lower * unit, upper * unit)?.with_rows(&rows, &sides.0, &sides.1)
    }
}

impl NonsmoothObjective for Changed<'_> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.problem.dimension
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let Variant { factor, shift, unit, failing, .. } = self.variant;
        let call = self.calls.get() + 1;
        self.calls.set(call);
        if failing && call.is_multiple_of(FAILING) {
            return Err(OracleError::NotConverged { solver: "one call in ten", residual: 1.0, iterations: call });
        }
        let (value, subgradient) = self.exact(request.point);
        let noisy = value + self.noise() * jitter(request.point.as_slice(), 0);
        let evaluation = Evaluation::exact(factor * noisy + shift, subgradient * (factor / unit), ());
        Ok(Answer::Accurate(Evaluation { error_bound: factor * self.noise(), ..evaluation }))
    }
}
