//! The subproblem of an outer function built from cones, by an interior-point method.
//!
//! ```text
//! min over (d, t)   Σ μ t + u‖d‖²/2 + dᵀBd/2 − u⟨W o, d⟩,   (t, c + G d) in the cones of h,   x + d ∈ U
//! scaled:           d = D d̂,  c = σ ĉ,  t = σ^p t̂,   σ = max|c_i|,  τ = max μ σ^p,
//!                   D_kk = min(σ/max_i|G_ik|, (τ/(B + u W)_kk)^(1/2))
//! ```
//! Linear terms of h need no cone: their slopes are added to the linear part of the program. The multipliers of c + G d
//! are the weights w of the outputs. By weak duality, the answer lies above the optimum by at most the following sum,
//! with the multipliers μ of the sides of U and the residual ρ = Gᵀw + u W (d − o) + B d + Aᵀμ:
//!
//! ```text
//! h(c + G d) − ⟨w, c + G d⟩ + h*(w) + Σ |μ_i| slack_i + ‖ρ‖* max(‖d‖, ‖ρ‖*/2u)
//! ```

use super::absolute_values::{self, absolute_values};
use super::model::CompositeModel;
use super::scaled_program::{ConeAnswer, Units, exponent, linear_part, multipliers, sides_of};
use crate::composite::{ConeFunction, Epigraph, EpigraphTerm};
use crate::interruption::interrupted;
use crate::qp::interior_point::{ScaledSide, compressed, equalities_first, settings};
use crate::{Matrix, Vector};
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, PowerConeT, SecondOrderConeT, SupportedConeT, ZeroConeT,
};

/// The constraints b − A (d̂, t̂) ∈ cones, A by columns.
struct ConeRows {
    columns: Vec<Vec<(usize, f64)>>,
    sides: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

/// A term and its first row.
struct Place<'a> {
    term: &'a EpigraphTerm,
    row: usize,
}

/// Solves the subproblem; none where the method cannot start or its numbers are not finite.
pub(super) fn solve(model: &CompositeModel<'_>, epigraph: &Epigraph) -> Option<ConeAnswer> {
    let (outputs, jacobian) = (&model.linearization.outputs, &model.linearization.jacobian);
    let (m, n) = jacobian.shape();
    let metric = model.with_metric(Matrix::zeros(n, n));
    if let Some(values) = absolute_values(epigraph) {
        return absolute_values::solve(model, &metric, &values, epigraph);
    }
    let units = Units::of_terms(outputs, jacobian, &metric, epigraph);
    let count: usize = epigraph.terms().iter().map(variables).sum();
    let mut constraints = ConeRows { columns: vec![vec![]; n + count], sides: vec![], cones: vec![] };
    let mut of_set = sides_of(model, &units);
    constraints.admit(&mut of_set);
    let mut linear: Vec<f64> = linear_part(model, epigraph, &units).iter().copied().collect();
    let mut places = vec![];
    for term in epigraph.terms() {
        let scaled = Matrix::from_fn(term.outputs.len(), n, |i, k| {
            jacobian[(term.outputs.start + i, k)] * units.steps[k] / units.outputs
        });
        let own = outputs.rows(term.outputs.start, term.outputs.len()) / units.outputs;
        places.push(Place { term, row: constraints.sides.len() });
        constraints.epigraph(&own, &scaled, term.function, linear.len());
        linear.extend(vec![term.weight * units.outputs.powf(exponent(term)) / units.value; variables(term)]);
    }
    let entry = |i: usize, j: usize| metric[(i, j)] * units.steps[i] * units.steps[j] / units.value;
    let mut quadratic: Vec<Vec<(usize, f64)>> =
        (0..n).map(|j| (0..=j).map(|i| (i, entry(i, j))).filter(|(_, h)| *h != 0.0).collect()).collect();
    quadratic.extend(vec![vec![]; count]);
    let (quadratic, matrix) =
        (compressed(n + count, &quadratic), compressed(constraints.sides.len(), &constraints.columns));
    let mut solver =
        DefaultSolver::new(&quadratic, &linear, &matrix, &constraints.sides, &constraints.cones, scaled_settings())
            .ok()?;
    solver.set_termination_callback(|_| interrupted());
    solver.solve();
    let (x, z) = (&solver.solution.x, &solver.solution.z);
    let step = Vector::from_column_slice(&x[..n]).component_mul(&units.steps);
    let mut weights = Vector::zeros(m);
    places.iter().for_each(|place| place.add_weights(z, &mut weights));
    let weights = epigraph.within_domain(weights * (units.value / units.outputs));
    ConeAnswer::finite(step, weights, multipliers(&of_set, z, model, &units))
}

/// The program is scaled already; another scaling, by cones, ends the method early where there are many power cones.
fn scaled_settings() -> DefaultSettings<f64> {
    DefaultSettings { equilibrate_enable: false, min_terminate_step_length: 1e-10, ..settings() }
}

/// The number of epigraph variables of a term.
fn variables(term: &EpigraphTerm) -> usize {
    match term.function {
        ConeFunction::Linear => 0,
        ConeFunction::Norm | ConeFunction::Largest => usize::from(!term.outputs.is_empty()),
        _ => term.outputs.len(),
    }
}

impl Place<'_> {
    /// Adds the multipliers of the outputs of a term, in the units of the program.
    fn add_weights(&self, z: &[f64], weights: &mut Vector) {
        let (outputs, z) = (&self.term.outputs, &z[self.row..]);
        for (i, output) in outputs.clone().enumerate() {
            weights[output] = match self.term.function {
                ConeFunction::Linear => 0.0,
                ConeFunction::AbsoluteValues => z[2 * i] - z[2 * i + 1],
                ConeFunction::PositiveParts => z[2 * i],
                ConeFunction::Largest => z[i],
                ConeFunction::Norm => -z[1 + i],
                ConeFunction::Powers { .. } => -z[3 * i + 2],
            };
        }
    }
}

impl ConeRows {
    fn push(&mut self, side: f64, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (column, entry) in entries {
            if entry != 0.0 {
                self.columns[column].push((self.sides.len(), entry));
            }
        }
        self.sides.push(side);
    }

    /// x + d ∈ U.
    fn admit(&mut self, sides: &mut [ScaledSide]) {
        let equalities = equalities_first(sides);
        for side in sides.iter() {
            self.push(side.bound, side.normal.iter().copied());
        }
        self.cones.extend([ZeroConeT(equalities), NonnegativeConeT(sides.len() - equalities)]);
    }

    /// (t, ĉ + Ĝ d̂) in the cones of a term, whose epigraph variables begin at a column.
    fn epigraph(&mut self, outputs: &Vector, jacobian: &Matrix, function: ConeFunction, first: usize) {
        let (m, n) = jacobian.shape();
        if m == 0 {
            return;
        }
        let output = |i: usize, sign: f64| (0..n).map(move |k| (k, sign * jacobian[(i, k)]));
        match function {
            ConeFunction::Linear => {}
            ConeFunction::AbsoluteValues => {
                for i in 0..m {
                    self.push(-outputs[i], output(i, 1.0).chain([(first + i, -1.0)]));
                    self.push(outputs[i], output(i, -1.0).chain([(first + i, -1.0)]));
                }
                self.cones.push(NonnegativeConeT(2 * m));
            }
            ConeFunction::PositiveParts => {
                for i in 0..m {
                    self.push(-outputs[i], output(i, 1.0).chain([(first + i, -1.0)]));
                    self.push(0.0, [(first + i, -1.0)]);
                }
                self.cones.push(NonnegativeConeT(2 * m));
            }
            ConeFunction::Largest => {
                (0..m).for_each(|i| self.push(-outputs[i], output(i, 1.0).chain([(first, -1.0)])));
                self.cones.push(NonnegativeConeT(m));
            }
            ConeFunction::Norm => {
                self.push(0.0, [(first, -1.0)]);
                (0..m).for_each(|i| self.push(outputs[i], output(i, -1.0)));
                self.cones.push(SecondOrderConeT(m + 1));
            }
            ConeFunction::Powers { exponent } => {
                for i in 0..m {
                    self.push(0.0, [(first + i, -1.0)]);
                    self.push(1.0, []);
                    self.push(outputs[i], output(i, -1.0));
                    self.cones.push(PowerConeT(exponent.recip()));
                }
            }
        }
    }
}
