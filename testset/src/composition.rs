//! Problems as h∘c: smooth outputs c with all their gradients, and a convex function h of them.
//!
//! ```text
//! f(x) = max cᵢ(x),   max |cᵢ(x)|,   or   Σ wₖ φₖ(c(x)) with φ one of  c,  |c|,  max(c, 0),  max(c, c'),  |(c, c')|
//! ```

use crate::dual::{Dual, Function};
use std::sync::Arc;

/// The outputs of a problem.
pub(crate) type Outputs = Arc<dyn Fn(&[Dual]) -> Vec<Dual> + Send + Sync>;

/// A convex function of outputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Outer {
    /// The largest output.
    Maximum,
    /// The largest magnitude of an output.
    LargestMagnitude,
    /// A weighted sum of terms that take the outputs in order; the weights of terms that are not linear are positive.
    Sum(Vec<(f64, Term)>),
}

/// A convex function of the next output or the next two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// c
    Itself,
    /// |c|
    Magnitude,
    /// max(0, c)
    PositivePart,
    /// max(c, c')
    Larger,
    /// √(c² + c'²)
    Length,
}

impl Term {
    fn size(self) -> usize {
        if matches!(self, Self::Larger | Self::Length) { 2 } else { 1 }
    }

    fn of(self, outputs: &[Dual]) -> Dual {
        match self {
            Self::Itself => outputs[0].clone(),
            Self::Magnitude => outputs[0].abs(),
            Self::PositivePart => outputs[0].positive_part(),
            Self::Larger => Dual::max(outputs.iter().cloned()),
            Self::Length => outputs[0].hypot(&outputs[1]),
        }
    }
}

impl Outer {
    /// The sum of `count` terms of one kind, with weight one.
    pub(crate) fn sum_of(term: Term, count: usize) -> Self {
        Self::Sum(vec![(1.0, term); count])
    }

    fn of(&self, outputs: &[Dual]) -> Dual {
        match self {
            Self::Maximum => Dual::max(outputs.iter().cloned()),
            Self::LargestMagnitude => Dual::max(outputs.iter().map(Dual::abs)),
            Self::Sum(terms) => {
                let mut rest = outputs;
                Dual::sum(terms.iter().map(|&(weight, term)| {
                    let (own, others) = rest.split_at(term.size());
                    rest = others;
                    if weight == 1.0 { term.of(own) } else { weight * term.of(own) }
                }))
            }
        }
    }

    /// h(c) and one subgradient.
    ///
    /// # Panics
    /// When there are fewer outputs than the function takes.
    pub fn evaluate(&self, outputs: &[f64]) -> (f64, Vec<f64>) {
        let (value, subgradient, _) = self.of(&Dual::variables(outputs)).into_parts();
        (value, subgradient)
    }
}

/// A problem as h∘c.
#[derive(Clone)]
pub struct Composition {
    outer: Outer,
    outputs: Outputs,
}

impl Composition {
    pub(crate) fn new(outer: Outer, outputs: impl Fn(&[Dual]) -> Vec<Dual> + Send + Sync + 'static) -> Self {
        Self { outer, outputs: Arc::new(outputs) }
    }

    /// The outer function h.
    pub fn outer(&self) -> &Outer {
        &self.outer
    }

    /// c(x) and its gradients.
    pub fn linearize(&self, x: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let outputs = (self.outputs)(&Dual::variables(x));
        outputs.into_iter().map(|output| output.into_parts()).map(|(value, gradient, _)| (value, gradient)).unzip()
    }

    /// h∘c as a function of the variables.
    pub(crate) fn function(&self) -> Function {
        let Self { outer, outputs } = self.clone();
        Arc::new(move |x| outer.of(&outputs(x)))
    }
}
