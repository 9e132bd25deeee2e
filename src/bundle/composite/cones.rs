//! The subproblem of an outer function built from cones, by an interior-point method.
//!
//! ```text
//! min over (d, t)   Σ t + u‖d‖²/2 + dᵀBd/2 − u⟨W o, d⟩,   (t, c + G d) in the cones of h,   x + d ∈ U
//! scaled:           d = D d̂,  c = σ ĉ,  t = σ^p t̂,   σ = max|c_i|,  D_kk = min(σ/max_i|G_ik|, (σ^p/(B + u W)_kk)^(1/2))
//! ```
//! The multipliers of c + G d are the weights w of the outputs. How good the answer is, the sum that weak duality leaves tells, with the
//! multipliers μ of the sides of U and the residual ρ = Gᵀw + u W (d − o) + B d + Aᵀμ:
//!
//! ```text
//! h(c + G d) − ⟨w, c + G d⟩ + h*(w) + Σ |μ_i| slack_i + ‖ρ‖* max(‖d‖, ‖ρ‖*/2u)
//! ```

use super::model::CompositeModel;
use crate::bundle::proposers::subproblem::Room;
use crate::composite::Epigraph;
use crate::qp::interior_point::{compressed, settings};
use crate::{Matrix, Vector};
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, PowerConeT, SecondOrderConeT, SupportedConeT, ZeroConeT,
};

/// What the method has found, as good as it has got it.
pub(super) struct ConeAnswer {
    pub step: Vector,
    /// w.
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
    /// Rows and, after them, bounds behind the first sides, with what each was multiplied by.
    origins: Vec<(usize, f64)>,
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

/// Solves the subproblem; none where the method fails.
pub(super) fn solve(model: &CompositeModel<'_>, epigraph: Epigraph) -> Option<ConeAnswer> {
    let (outputs, jacobian) = (&model.linearization.outputs, &model.linearization.jacobian);
    let (m, n) = jacobian.shape();
    let mut metric = model.curvature.cloned().unwrap_or_else(|| Matrix::zeros(n, n));
    model.norm.add_to(&mut metric, model.weight);
    let units = Units::new(outputs, jacobian, (&metric, epigraph));
    let count = if epigraph == Epigraph::EuclideanNorm { 1 } else { m };
    let mut constraints =
        Constraints { columns: vec![vec![]; n + count], sides: vec![], cones: vec![], origins: vec![] };
    constraints.admit(model, &units);
    let first = constraints.sides.len();
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
    solver.solve();
    let (x, z) = (&solver.solution.x, &solver.solution.z[first..]);
    let step = Vector::from_column_slice(&x[..n]).component_mul(&units.steps);
    let weights = Vector::from_fn(m, |i, _| match epigraph {
        Epigraph::EuclideanNorm => -z[1 + i],
        Epigraph::SumOfPowers { exponent: 1.0 } => z[2 * i] - z[2 * i + 1],
        Epigraph::SumOfPowers { .. } => -z[3 * i + 2],
    });
    let weights = epigraph.within_domain(weights * (units.value / units.outputs));
    let rows = model.set.rows().nrows();
    let mut multipliers = Vector::zeros(rows + n);
    for (&(origin, factor), &z) in constraints.origins.iter().zip(&solver.solution.z) {
        multipliers[origin] += z * factor * units.value;
    }
    let sides = (multipliers.rows(0, rows).into_owned(), multipliers.rows(rows, n).into_owned());
    let finite = step.iter().chain(weights.iter()).chain(multipliers.iter()).all(|entry| entry.is_finite());
    finite.then_some(ConeAnswer { step, weights, sides })
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
    /// x + d ∈ U, every side divided by the length of its row; equalities first.
    fn admit(&mut self, model: &CompositeModel<'_>, units: &Units) {
        let room = Room::around(model.set, model.base);
        let (rows, n) = (model.set.rows(), model.base.len());
        let row = |i: usize| (0..n).map(|k| (k, rows[(i, k)] * units.steps[k])).collect::<Vec<_>>();
        let of_rows = (0..rows.nrows()).map(|i| (row(i), room.rows.0[i], room.rows.1[i]));
        let of_bounds = (0..n).map(|k| (vec![(k, units.steps[k])], room.bounds.0[k], room.bounds.1[k]));
        let sides: Vec<_> = of_rows.chain(of_bounds).collect();
        let scaled = |row: &[(usize, f64)], sign: f64| {
            let size = row.iter().map(|(_, a)| a * a).sum::<f64>().sqrt();
            let factor = if size > 0.0 { sign / size } else { sign };
            (factor, row.iter().map(|&(k, a)| (k, factor * a)).collect::<Vec<_>>())
        };
        let mut add = |origin: usize, side: f64, sign: f64| {
            let (factor, row) = scaled(&sides[origin].0, sign);
            self.push(factor * side, row);
            self.origins.push((origin, factor));
        };
        let (equal, unequal): (Vec<usize>, Vec<usize>) = (0..sides.len()).partition(|&i| sides[i].1 == sides[i].2);
        equal.iter().for_each(|&i| add(i, sides[i].2, 1.0));
        for (&i, sign) in unequal.iter().flat_map(|i| [(i, 1.0), (i, -1.0)]) {
            let side = if sign > 0.0 { sides[i].2 } else { sides[i].1 };
            if side.is_finite() {
                add(i, side, sign);
            }
        }
        let equalities = equal.len();
        self.cones.extend([ZeroConeT(equalities), NonnegativeConeT(self.sides.len() - equalities)]);
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
