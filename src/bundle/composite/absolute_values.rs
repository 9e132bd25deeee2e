//! The subproblem of a sum of absolute values, positive parts and linear functions, by the method for many residuals.
//!
//! ```text
//! μ|c_i| = |μ c_i|,    μ max(0, c_i) = |μ c_i/2| + μ c_i/2
//! ```

use super::model::CompositeModel;
use super::scaled_program::{ConeAnswer, Units, linear_part, multipliers, sides_of, unit};
use crate::composite::{ConeFunction, Epigraph};
use crate::qp::interior_point::equalities_first;
use crate::qp::primal_dual;
use crate::qp::program::Program;
use crate::{Matrix, Vector};

/// One absolute value |a c_i|, and what it leaves of the function: a share b c_i.
pub(super) struct AbsoluteValue {
    output: usize,
    /// a > 0.
    factor: f64,
    /// b.
    rest: f64,
}

/// The absolute values of h; none where h has other terms than these, positive parts and linear functions.
pub(super) fn absolute_values(epigraph: &Epigraph) -> Option<Vec<AbsoluteValue>> {
    let mut values = vec![];
    for term in epigraph.terms() {
        let (factor, rest) = match term.function {
            ConeFunction::Linear => continue,
            ConeFunction::AbsoluteValues => (term.weight, 0.0),
            ConeFunction::PositiveParts => (0.5 * term.weight, 0.5 * term.weight),
            _ => return None,
        };
        values.extend(term.outputs.clone().map(|output| AbsoluteValue { output, factor, rest }));
    }
    Some(values)
}

/// Solves the subproblem of an h that consists of these values and linear terms.
pub(super) fn solve(
    model: &CompositeModel<'_>,
    metric: &Matrix,
    values: &[AbsoluteValue],
    epigraph: &Epigraph,
) -> Option<ConeAnswer> {
    let (outputs, jacobian) = (&model.linearization.outputs, &model.linearization.jacobian);
    let n = jacobian.ncols();
    let size = unit(values.iter().map(|value| value.factor * outputs[value.output].abs()));
    let largest =
        |k: usize| values.iter().map(|value| value.factor * jacobian[(value.output, k)].abs()).fold(0.0, f64::max);
    let units = Units::new(size, size, metric, largest);
    let mut sides = sides_of(model, &units);
    let equalities = equalities_first(&mut sides);
    let mut linear = linear_part(model, epigraph, &units);
    let mut scaled = Matrix::zeros(values.len(), n);
    for k in 0..n {
        let step = units.steps[k] / size;
        for (i, value) in values.iter().enumerate() {
            let entry = jacobian[(value.output, k)] * step;
            scaled[(i, k)] = value.factor * entry;
            linear[k] += value.rest * entry;
        }
    }
    let answer = primal_dual::solve(&Program {
        outputs: &Vector::from_fn(values.len(), |i, _| values[i].factor * outputs[values[i].output] / size),
        jacobian: &scaled,
        quadratic: &Matrix::from_fn(n, n, |i, j| metric[(i, j)] * units.steps[i] * units.steps[j] / size),
        linear: &linear,
        sides: &sides,
        equalities,
    })?;
    let mut weights = Vector::zeros(outputs.len());
    for (value, found) in values.iter().zip(answer.weights.iter()) {
        weights[value.output] = value.factor * found + value.rest;
    }
    let sides = multipliers(&sides, &answer.multipliers, model, &units);
    ConeAnswer::finite(answer.x.component_mul(&units.steps), epigraph.within_domain(weights), sides)
}
