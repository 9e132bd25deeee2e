//! Published nonsmooth test problems: value, one Clarke subgradient, start point, optimal value, linear constraints and
//! the evaluation counts of nine solvers.
//!
//! ```text
//! minimise f(x)  over  lower ≤ x ≤ upper,  row_lower ≤ A x ≤ row_upper
//! ```
//!
//! Sources: L. Lukšan, J. Vlček, Test problems for nonsmooth unconstrained and linearly constrained optimization
//! (2000), and ACM TOMS Algorithm 811; M. Haarala, K. Miettinen, M. Mäkelä, Optim. Methods Softw. 19 (2004); M.
//! Gürbüzbalaban, M. Overton, Nonlinear Anal. 75 (2012); Yu. Nesterov, Introductory Lectures on Convex Optimization
//! (2004).

use std::collections::BTreeMap;
use std::fmt;

mod approximation;
mod composition;
pub mod constrained;
mod dual;
mod functions;
mod geometry;
pub mod kit;
mod minimax;
mod penalty;
mod scalable;
mod table;

pub use composition::{Composition, Outer, Term};
use dual::Function;
pub use scalable::Scalable;

/// With or without linear constraints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// No constraint at all.
    Unconstrained,
    /// Bounds or linear rows.
    LinearlyConstrained,
}

/// A published problem with its start and its optimal value.
#[derive(Clone)]
#[non_exhaustive]
pub struct Problem {
    /// Name by which the collection finds the problem.
    pub name: String,
    /// Number of variables.
    pub dimension: usize,
    /// With or without linear constraints.
    pub family: Family,
    /// Part of the collection: unconstrained, minimax, linear, scalable, overton, nesterov.
    pub group: String,
    /// Convex on x ≥ [`convex_lower`](Self::convex_lower).
    pub convex: bool,
    /// Lower corner of the orthant on which a convex problem is convex, −∞ nearly always.
    pub convex_lower: Vec<f64>,
    /// Description of the function, with indices from one.
    pub formula: String,
    /// Publication that states the problem.
    pub source: String,
    /// Remark on the problem.
    pub note: Option<String>,
    /// Start point; not always feasible.
    pub start: Vec<f64>,
    /// Optimal value.
    pub optimal_value: f64,
    /// Lower bounds, −∞ for none.
    pub lower: Vec<f64>,
    /// Upper bounds, ∞ for none.
    pub upper: Vec<f64>,
    /// Rows of A.
    pub rows: Vec<Vec<f64>>,
    /// Lower bounds of A x, −∞ for none.
    pub row_lower: Vec<f64>,
    /// Upper bounds of A x, ∞ for none.
    pub row_upper: Vec<f64>,
    /// Evaluations each solver needed for f − f* ≤ 1e-6 (1 + |f*|) at a feasible point; `None`: not reached.
    pub peers: BTreeMap<String, Option<usize>>,
    function: Function,
    composition: Option<Composition>,
}

impl Problem {
    /// Value and one Clarke subgradient.
    ///
    /// # Panics
    /// When `x` has not the problem's dimension.
    pub fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let (value, gradient, _) = self.differentiate(x);
        (value, gradient)
    }

    /// Distance from `x` to the nearest kink of the function, to first order; ∞ where there is none.
    ///
    /// # Panics
    /// When `x` has not the problem's dimension.
    pub fn kink_distance(&self, x: &[f64]) -> f64 {
        self.differentiate(x).2
    }

    /// Largest violation of a bound or a row, zero at a feasible point.
    ///
    /// # Panics
    /// When `x` has not the problem's dimension.
    pub fn violation(&self, x: &[f64]) -> f64 {
        assert_eq!(x.len(), self.dimension, "{}: dimension of the point", self.name);
        let outside = |value: f64, lower: f64, upper: f64| (lower - value).max(value - upper).max(0.0);
        let bounds = x.iter().zip(self.lower.iter().zip(&self.upper)).map(|(&v, (&l, &u))| outside(v, l, u));
        let sides = self.row_lower.iter().zip(&self.row_upper);
        let rows = self.rows.iter().zip(sides).map(|(row, (&l, &u))| {
            let value = row.iter().zip(x).map(|(a, v)| a * v).sum::<f64>();
            outside(value, l, u)
        });
        bounds.chain(rows).fold(0.0, f64::max)
    }

    /// The problem as a convex function of smooth outputs, if it is one with kinks.
    pub fn composition(&self) -> Option<&Composition> {
        self.composition.as_ref()
    }

    fn differentiate(&self, x: &[f64]) -> (f64, Vec<f64>, f64) {
        assert_eq!(x.len(), self.dimension, "{}: dimension of the point", self.name);
        (self.function)(&dual::Dual::variables(x)).into_parts()
    }

    fn new(record: table::Record, (function, composition): (Function, Option<Composition>)) -> Self {
        let n = record.dimension;
        let constrained = record.lower.is_some() || record.upper.is_some() || !record.rows.is_empty();
        Self {
            family: if constrained { Family::LinearlyConstrained } else { Family::Unconstrained },
            lower: table::bounds(record.lower.as_deref(), n, f64::NEG_INFINITY),
            upper: table::bounds(record.upper.as_deref(), n, f64::INFINITY),
            row_lower: table::bounds(Some(&record.cl), 0, f64::NEG_INFINITY),
            row_upper: table::bounds(Some(&record.cu), 0, f64::INFINITY),
            rows: record.rows,
            convex_lower: functions::convex_lower(&record.name, n),
            name: record.name,
            dimension: n,
            group: record.group,
            convex: record.convex,
            formula: record.formula,
            source: record.source,
            note: record.note,
            start: record.x0,
            optimal_value: record.fstar,
            peers: record.evaluations,
            function,
            composition,
        }
    }
}

impl fmt::Debug for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Problem")
            .field("name", &self.name)
            .field("dimension", &self.dimension)
            .field("family", &self.family)
            .field("formula", &self.formula)
            .finish_non_exhaustive()
    }
}

/// All problems in the order of the table.
///
/// # Panics
/// When the table names a problem without a function, which the tests rule out.
pub fn all() -> Vec<Problem> {
    let problem = |record: table::Record| match functions::function(&record) {
        Some(function) => Problem::new(record, function),
        None => panic!("{}: no function", record.name),
    };
    table::records().into_iter().map(problem).collect()
}

/// The problem of this name.
pub fn find(name: &str) -> Option<Problem> {
    let record = table::records().into_iter().find(|record| record.name == name)?;
    let function = functions::function(&record)?;
    Some(Problem::new(record, function))
}
