//! The subproblem of an outer function built from cones, by an interior-point method.
//!
//! ```text
//! min over (d, t)   Σ t + u‖d‖²/2 + dᵀBd/2 − u⟨W o, d⟩,   (t, c + G d) in the cones of h,   x + d ∈ U
//! scaled:           d = D d̂,  c = σ ĉ,  t = σ^p t̂,   σ = max|c_i|,  D_kk = min(σ/max_i|G_ik|, (σ^p/(B + u W)_kk)^(1/2))
//! ```
//! The multipliers of c + G d are the weights w of the outputs. By weak duality, the answer lies above the optimum by
//! at most the following sum, with the multipliers μ of the sides of U and the residual ρ = Gᵀw + u W (d − o) + B d +
//! Aᵀμ:
//!
//! ```text
//! h(c + G d) − ⟨w, c + G d⟩ + h*(w) + Σ |μ_i| slack_i + ‖ρ‖* max(‖d‖, ‖ρ‖*/2u)
//! ```

use super::model::CompositeModel;
use crate::bundle::proposers::subproblem::Room;
use crate::composite::Epigraph;
use crate::interruption::interrupted;
use crate::qp::interior_point::{ScaledSide, compressed, equalities_first, push_set, settings};
use crate::qp::primal_dual::{self, Program};
use crate::{Matrix, Vector};
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, PowerConeT, SecondOrderConeT, SupportedConeT, ZeroConeT,
};

/// The last iterate of the method, of any quality: the caller checks it by weak duality.
pub(super) struct ConeAnswer {
    pub step: Vector,
    /// The weights w of the outputs.
    pub weights: Vector,
    /// Multipliers of the rows and of the bounds, > 0 at an upper side and < 0 at a lower one.
    pub sides: (Vector, Vector),
}

/// The units of the program: of d, of the outputs and of h.
struct Units {
    /// The diagonal of D.
    steps: Vector,
    /// σ.
    outputs: f64,
    /// σ^p.
    value: f64,
}

/// The constraints b − A (d̂, t̂) ∈ cones, A by columns.
struct Constraints {
    columns: Vec<Vec<(usize, f64)>>,
    sides: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Constraints {
    fn push(&mut self, side: f64, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (column, entry) in entries {
            if entry != 0.0 {
                self.columns[column].push((self.sides.len(), entry));
            }
        }
        self.sides.push(side);
    }
}

/// Solves the subproblem; none where the method cannot start or its numbers are not finite.
pub(super) fn solve(model: &CompositeModel<'_>, epigraph: Epigraph) -> Option<ConeAnswer> {
    let (outputs, jacobian) = (&model.linearization.outputs, &model.linearization.jacobian);
    let (m, n) = jacobian.shape();
    let metric = model.with_metric(Matrix::zeros(n, n));
    let units = Units::new(outputs, jacobian, (&metric, epigraph));
    if epigraph == (Epigraph::SumOfPowers { exponent: 1.0 }) {
        return solve_absolute_values(model, (&metric, &units), epigraph);
    }
    let count = if epigraph == Epigraph::EuclideanNorm { 1 } else { m };
    let mut constraints = Constraints { columns: vec![vec![]; n + count], sides: vec![], cones: vec![] };
    let (room, rows) = (Room::around(model.set, model.base), model.set.rows());
    let mut of_set = vec![];
    let (of_rows, bounds) = ((&room.rows.0, &room.rows.1), (&room.bounds.0, &room.bounds.1));
    push_set(&mut of_set, rows, of_rows, bounds, |entry, k| entry * units.steps[k]);
    constraints.admit(&mut of_set);
    let scaled = Matrix::from_fn(m, n, |i, k| jacobian[(i, k)] * units.steps[k] / units.outputs);
    constraints.epigraph(&(outputs / units.outputs), &scaled, epigraph);
    let entry = |i: usize, j: usize| metric[(i, j)] * units.steps[i] * units.steps[j] / units.value;
    let mut quadratic: Vec<Vec<(usize, f64)>> =
        (0..n).map(|j| (0..=j).map(|i| (i, entry(i, j))).filter(|(_, h)| *h != 0.0).collect()).collect();
    quadratic.extend(vec![vec![]; count]);
    let pull = model.pull_to_origin().component_mul(&units.steps) / units.value;
    let linear: Vec<f64> = pull.iter().copied().chain(vec![1.0; count]).collect();
    let (quadratic, matrix) =
        (compressed(n + count, &quadratic), compressed(constraints.sides.len(), &constraints.columns));
    let mut solver =
        DefaultSolver::new(&quadratic, &linear, &matrix, &constraints.sides, &constraints.cones, scaled_settings())
            .ok()?;
    solver.set_termination_callback(|_| interrupted());
    solver.solve();
    let (x, z) = (&solver.solution.x, &solver.solution.z[of_set.len()..]);
    let step = Vector::from_column_slice(&x[..n]).component_mul(&units.steps);
    let weights = Vector::from_fn(m, |i, _| match epigraph {
        Epigraph::EuclideanNorm => -z[1 + i],
        Epigraph::SumOfPowers { exponent: 1.0 } => z[2 * i] - z[2 * i + 1],
        Epigraph::SumOfPowers { .. } => -z[3 * i + 2],
    });
    let weights = epigraph.within_domain(weights * (units.value / units.outputs));
    let mut sides = (Vector::zeros(rows.nrows()), Vector::zeros(n));
    for (side, &z) in of_set.iter().zip(&solver.solution.z) {
        side.add_multiplier(z, units.value, &mut sides);
    }
    let finite =
        step.iter().chain(weights.iter()).chain(sides.0.iter()).chain(sides.1.iter()).all(|entry| entry.is_finite());
    finite.then_some(ConeAnswer { step, weights, sides })
}

/// Solves the subproblem of a sum of absolute values, by the method for many dense residuals.
fn solve_absolute_values(
    model: &CompositeModel<'_>,
    (metric, units): (&Matrix, &Units),
    epigraph: Epigraph,
) -> Option<ConeAnswer> {
    let (outputs, jacobian) = (&model.linearization.outputs, &model.linearization.jacobian);
    let (m, n) = jacobian.shape();
    let (room, rows) = (Room::around(model.set, model.base), model.set.rows());
    let mut sides = vec![];
    let (of_rows, bounds) = ((&room.rows.0, &room.rows.1), (&room.bounds.0, &room.bounds.1));
    push_set(&mut sides, rows, of_rows, bounds, |entry, k| entry * units.steps[k]);
    let equalities = equalities_first(&mut sides);
    let answer = primal_dual::solve(&Program {
        outputs: &(outputs / units.outputs),
        jacobian: &Matrix::from_fn(m, n, |i, k| jacobian[(i, k)] * units.steps[k] / units.outputs),
        quadratic: &Matrix::from_fn(n, n, |i, j| metric[(i, j)] * units.steps[i] * units.steps[j] / units.value),
        linear: &(model.pull_to_origin().component_mul(&units.steps) / units.value),
        sides: &sides,
        equalities,
    })?;
    let mut multipliers = (Vector::zeros(rows.nrows()), Vector::zeros(n));
    for (side, &z) in sides.iter().zip(&answer.multipliers) {
        side.add_multiplier(z, units.value, &mut multipliers);
    }
    let step = answer.x.component_mul(&units.steps);
    let weights = epigraph.within_domain(answer.weights * (units.value / units.outputs));
    Some(ConeAnswer { step, weights, sides: multipliers })
}

/// The program is scaled already; another scaling, by cones, ends the method early where there are many power cones.
fn scaled_settings() -> DefaultSettings<f64> {
    DefaultSettings { equilibrate_enable: false, min_terminate_step_length: 1e-10, ..settings() }
}

impl Units {
    fn new(outputs: &Vector, jacobian: &Matrix, (metric, epigraph): (&Matrix, Epigraph)) -> Self {
        let size = outputs.amax();
        // Outputs that all vanish leave the unit free.
        let size = if size > 0.0 { size } else { 1.0 };
        let exponent = if let Epigraph::SumOfPowers { exponent } = epigraph { exponent } else { 1.0 };
        let value = size.powf(exponent);
        let step = |k: usize| (size / jacobian.column(k).amax()).min((value / metric[(k, k)]).sqrt());
        Self { steps: Vector::from_fn(metric.nrows(), |k, _| step(k)), outputs: size, value }
    }
}

impl Constraints {
    /// x + d ∈ U.
    fn admit(&mut self, sides: &mut [ScaledSide]) {
        let equalities = equalities_first(sides);
        for side in sides.iter() {
            self.push(side.bound, side.normal.iter().copied());
        }
        self.cones.extend([ZeroConeT(equalities), NonnegativeConeT(sides.len() - equalities)]);
    }

    /// (t, ĉ + Ĝ d̂) in the cones of h.
    fn epigraph(&mut self, outputs: &Vector, jacobian: &Matrix, epigraph: Epigraph) {
        let (m, n) = jacobian.shape();
        let output = |i: usize, sign: f64| (0..n).map(move |k| (k, sign * jacobian[(i, k)]));
        match epigraph {
            Epigraph::EuclideanNorm => {
                self.push(0.0, [(n, -1.0)]);
                (0..m).for_each(|i| self.push(outputs[i], output(i, -1.0)));
                self.cones.push(SecondOrderConeT(m + 1));
            }
            Epigraph::SumOfPowers { exponent: 1.0 } => {
                for i in 0..m {
                    self.push(-outputs[i], output(i, 1.0).chain([(n + i, -1.0)]));
                    self.push(outputs[i], output(i, -1.0).chain([(n + i, -1.0)]));
                }
                self.cones.push(NonnegativeConeT(2 * m));
            }
            Epigraph::SumOfPowers { exponent } => {
                for i in 0..m {
                    self.push(0.0, [(n + i, -1.0)]);
                    self.push(1.0, []);
                    self.push(outputs[i], output(i, -1.0));
                    self.cones.push(PowerConeT(exponent.recip()));
                }
            }
        }
    }
}
