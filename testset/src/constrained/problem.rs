//! A problem with nonlinear constraints.

use crate::composition::{Composition, Outer, Outputs, Term};
use crate::dual::Dual;
use std::fmt;
use std::sync::Arc;

/// What a constraint asks for, and whether it has kinks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// c(x) ≤ 0 with kinks.
    Nonsmooth,
    /// c(x) ≤ 0 without kinks.
    Smooth,
    /// c(x) = 0 without kinks.
    SmoothEquality,
}

/// A problem with nonlinear constraints.
#[derive(Clone)]
#[non_exhaustive]
pub struct ConstrainedProblem {
    /// Unique name.
    pub name: String,
    /// Publication and number there.
    pub source: &'static str,
    /// Number of variables.
    pub dimension: usize,
    /// Start point; not always feasible.
    pub start: Vec<f64>,
    /// Lower bounds, −∞ for none.
    pub lower: Vec<f64>,
    /// Upper bounds, ∞ for none.
    pub upper: Vec<f64>,
    /// The kinds of the constraints.
    pub kinds: Vec<Kind>,
    /// Optimal value.
    pub optimum: f64,
    /// Values of other local minima where solvers may end.
    pub other_optima: Vec<f64>,
    /// Constraints that are active at the solution and not linear, equations included.
    pub active: usize,
    /// A weight ρ with which f + ρ max(0, cⱼ, |c_eq|) has the same minimiser: 1.5 times the sum of the multipliers,
    /// rounded up to two digits, and at least ½.
    pub penalty: f64,
    objective: Composition,
    constraints: Outputs,
}

/// The functions at a point.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConstrainedValue {
    /// f.
    pub value: f64,
    /// One subgradient of f.
    pub subgradient: Vec<f64>,
    /// Value and one subgradient of every constraint.
    pub constraints: Vec<(f64, Vec<f64>)>,
}

impl ConstrainedProblem {
    /// An unbounded problem; [`solved`](Self::solved) completes it.
    pub(super) fn new(
        (name, source): (&str, &'static str),
        start: impl Into<Vec<f64>>,
        objective: Composition,
        kinds: impl Into<Vec<Kind>>,
        constraints: impl Fn(&[Dual]) -> Vec<Dual> + Send + Sync + 'static,
    ) -> Self {
        let start = start.into();
        let n = start.len();
        Self {
            name: name.to_owned(),
            source,
            dimension: n,
            start,
            lower: vec![f64::NEG_INFINITY; n],
            upper: vec![f64::INFINITY; n],
            kinds: kinds.into(),
            optimum: f64::NAN,
            other_optima: Vec::new(),
            active: 0,
            penalty: f64::NAN,
            objective,
            constraints: Arc::new(constraints),
        }
    }

    /// With these bounds.
    pub(super) fn within(self, lower: impl Into<Vec<f64>>, upper: impl Into<Vec<f64>>) -> Self {
        Self { lower: lower.into(), upper: upper.into(), ..self }
    }

    /// With optimal value, number of active constraints and exact penalty.
    pub(super) fn solved(self, optimum: f64, active: usize, penalty: f64) -> Self {
        Self { optimum, active, penalty, ..self }
    }

    /// With the value of another local minimum.
    pub(super) fn or_ends_at(self, value: f64) -> Self {
        Self { other_optima: vec![value], ..self }
    }

    /// Objective and constraints with one subgradient each.
    ///
    /// # Panics
    /// When `x` has not the problem's dimension.
    pub fn evaluate(&self, x: &[f64]) -> ConstrainedValue {
        let (objective, constraints) = self.differentiate(x);
        let (value, subgradient, _) = objective.into_parts();
        let constraints = constraints.into_iter().map(|constraint| {
            let (value, subgradient, _) = constraint.into_parts();
            (value, subgradient)
        });
        ConstrainedValue { value, subgradient, constraints: constraints.collect() }
    }

    /// Distance from `x` to the nearest kink of the objective or of a constraint, to first order; ∞ where there is
    /// none.
    ///
    /// # Panics
    /// When `x` has not the problem's dimension.
    pub fn kink_distance(&self, x: &[f64]) -> f64 {
        let (objective, constraints) = self.differentiate(x);
        constraints.into_iter().chain([objective]).map(|function| function.into_parts().2).fold(f64::INFINITY, f64::min)
    }

    /// Largest violation of a bound or a constraint, zero at a feasible point.
    ///
    /// # Panics
    /// When `x` has not the problem's dimension.
    pub fn violation(&self, x: &[f64]) -> f64 {
        let bounds = x.iter().zip(self.lower.iter().zip(&self.upper)).map(|(x, (l, u))| (l - x).max(x - u));
        let constraints = self.evaluate(x).constraints.into_iter().zip(&self.kinds);
        let outside = constraints.map(|((c, _), kind)| if *kind == Kind::SmoothEquality { c.abs() } else { c });
        bounds.chain(outside).fold(0.0, f64::max)
    }

    /// The objective as a convex function of smooth outputs: a maximum, a sum of magnitudes, or one smooth output
    /// itself.
    pub fn composition(&self) -> &Composition {
        &self.objective
    }

    /// The problem with all its inequalities joined into their maximum, which comes first; the equations follow.
    pub fn joined(&self) -> Self {
        let equations = self.kinds.iter().filter(|kind| **kind == Kind::SmoothEquality).count();
        let (kinds, constraints) = (self.kinds.clone(), Arc::clone(&self.constraints));
        if equations == kinds.len() {
            return self.clone();
        }
        let joined = move |x: &[Dual]| {
            let pairs = kinds.iter().zip(constraints(x));
            let (equations, limits): (Vec<_>, Vec<_>) = pairs.partition(|(kind, _)| **kind == Kind::SmoothEquality);
            let largest = Dual::max(limits.into_iter().map(|(_, limit)| limit));
            [largest].into_iter().chain(equations.into_iter().map(|(_, equation)| equation)).collect()
        };
        Self {
            name: format!("{}Joined", self.name),
            kinds: [vec![Kind::Nonsmooth], vec![Kind::SmoothEquality; equations]].concat(),
            active: equations + usize::from(self.active > equations),
            constraints: Arc::new(joined),
            ..self.clone()
        }
    }

    fn differentiate(&self, x: &[f64]) -> (Dual, Vec<Dual>) {
        assert_eq!(x.len(), self.dimension, "{}: dimension of the point", self.name);
        let x = Dual::variables(x);
        (self.objective.function()(&x), (self.constraints)(&x))
    }
}

impl fmt::Debug for ConstrainedProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ConstrainedProblem")
            .field("name", &self.name)
            .field("dimension", &self.dimension)
            .field("kinds", &self.kinds)
            .finish_non_exhaustive()
    }
}

/// A smooth objective.
pub(super) fn smooth(function: impl Fn(&[Dual]) -> Dual + Send + Sync + 'static) -> Composition {
    Composition::new(Outer::sum_of(Term::Itself, 1), move |x| vec![function(x)])
}

/// The largest of smooth functions.
pub(super) fn maximum(pieces: impl Fn(&[Dual]) -> Vec<Dual> + Send + Sync + 'static) -> Composition {
    Composition::new(Outer::Maximum, pieces)
}

/// The variables by name.
pub(super) fn variables<const N: usize>(x: &[Dual]) -> [&Dual; N] {
    std::array::from_fn(|i| &x[i])
}

/// Σ (xᵢ − center)².
pub(super) fn squares(x: &[Dual], center: f64) -> Dual {
    Dual::sum(x.iter().map(|x| (x - center).square()))
}
