//! The paths to a state of a random scene, and what is found of each.

use contact::WorkEstimate;
use contact::contact_shape::ContactState;
use contact::direct::{CompliantContact, DirectSolver, by_cone_programs};
use contact::equilibrium::{ContactForces, ContactProblem, ContactRows};
use contact::error::ContactError;
use contact::linear::vector::norm;
use contact::solvers::{Processes, Solver, SolverKind, SolverPlan};
use scene_file::Case;
use std::sync::Arc;

/// Largest residual of a state.
pub(super) const MAX_RESIDUAL: f64 = 1e-8;

const EXPONENT: i32 = 4;
/// Share of the load below which contact forces are rounding.
const NOTHING: f64 = 1e-6;
/// Jumps may differ by this many roundings of their terms.
const JUMP_ROUNDINGS: f64 = 50.0;
/// Relative residual asked of states.
const TOLERANCE: f64 = 1e-12;

/// A state that a path found.
#[derive(Debug, Clone)]
pub struct Found {
    /// Name of the solver.
    pub path: String,
    /// The objective Θ.
    pub objective: f64,
    /// Largest residual, computed anew from the forces.
    pub residual: f64,
    pub operations: f64,
    /// Whether the state may not be unique.
    pub may_not_be_unique: bool,
}

/// A path's state, or why it found none.
pub type PathResult = Result<Found, String>;

/// The problem of a random scene with all that its paths share.
pub struct Examined {
    problem: Arc<ContactProblem>,
    controls: Vec<f64>,
    /// Operations per part of a state.
    pub estimate: WorkEstimate,
    contact: Result<CompliantContact, ContactError>,
    /// Least Θ that differences of Θ are taken relative to: that of a pressure of 1e-6 of the load over the base.
    pub smallest: f64,
}

impl Examined {
    /// Prepares a case.
    ///
    /// # Errors
    /// Returns a message when the scene describes no problem.
    pub fn new(case: &Case) -> Result<Self, String> {
        let message = |error: contact::error::SceneError| error.to_string();
        let problem = Arc::new(ContactProblem::new(case.scene.clone()).map_err(message)?);
        let controls = case.start_controls();
        let contact = DirectSolver::new(Arc::clone(&problem)).and_then(|solver| solver.contact(&controls));
        let base = problem.contact_area();
        let smallest = contact.as_ref().map_or(0.0, |contact| (NOTHING * contact.load / base).powi(EXPONENT));
        Ok(Self { smallest, controls, estimate: WorkEstimate::of(&case.scene), contact, problem })
    }

    /// Whether rigid statics allow an equilibrium.
    pub fn has_statics(&self) -> bool {
        !matches!(self.contact, Err(ContactError::NoEquilibrium { .. } | ContactError::InvertedElement { .. }))
    }

    /// Relative change of Θ, by direct condensation, when the heights change by their rounding.
    pub fn rounding(&self) -> f64 {
        let objective = |factor: f64| {
            let controls: Vec<f64> = self.controls.iter().map(|height| height * factor).collect();
            self.at(SolverKind::Direct, &controls).map_or(f64::NAN, |found| found.objective)
        };
        let values = [0.0, 4.0, -4.0].map(|roundings| objective(1.0 + roundings * f64::EPSILON));
        let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(*v), high.max(*v)));
        (high - low) / high.max(f64::MIN_POSITIVE)
    }

    /// The state by a contact solver.
    pub fn by(&self, kind: SolverKind) -> PathResult {
        self.at(kind, &self.controls)
    }

    fn at(&self, kind: SolverKind, controls: &[f64]) -> PathResult {
        let plan = SolverPlan::new(self.problem.scene.clone(), kind);
        let solver = Processes::alone().solver(plan).map_err(|error| error.to_string())?;
        let (state, contraction) = self.solved(&solver, controls).map_err(|error| error.to_string())?;
        let condensed = self.residual(&state.forces, &state.rows);
        // Where condensation itself finds no state, its matrices have lost the digits that would judge one: the
        // certificate, from the displacements, does.
        let is_judge = kind == SolverKind::Direct || condensed <= MAX_RESIDUAL || self.by(SolverKind::Direct).is_ok();
        Ok(Found {
            path: format!("{kind:?}, {:?}", state.solver),
            objective: objective(&state.forces.normal, &state.rows),
            residual: if is_judge { condensed } else { state.forces.residuals.largest() },
            operations: self.estimate.operations(state.solver, &state.work()),
            may_not_be_unique: contraction.is_some_and(|factor| factor >= 1.0),
        })
    }

    /// A state with all that a path asks of its solver: sensitivities, and the contraction where it is estimated.
    fn solved(&self, solver: &Solver, controls: &[f64]) -> Result<(ContactState, Option<f64>), ContactError> {
        let state = solver.solve(controls, None, TOLERANCE)?;
        let friction = self.problem.boundary.has_friction();
        let exponent = f64::from(EXPONENT);
        let mut dual = vec![0.0; self.problem.boundary.row_count];
        for (point, (node, force)) in
            self.problem.boundary.points.iter().zip(state.rows.nodes.iter().zip(&state.forces.normal))
        {
            dual[point.start] = exponent * (force.max(0.0) / node.area).powi(EXPONENT - 1) / node.area;
        }
        solver.sensitivities(&state.solution, &dual, 1e-11)?;
        let contraction = if friction { solver.estimate_contraction(&state.solution, 20).ok() } else { None };
        Ok((state, contraction))
    }

    /// The state by cone programs alone, however many they take. This is the last resort of direct condensation without
    /// its limit on work, which refuses what these programs leave with a residual above that of a state, and so does
    /// this path; the study computes the residuals of the other paths.
    pub fn by_cone_programs(&self) -> PathResult {
        self.contact.as_ref().map_err(ToString::to_string)?;
        let solver = DirectSolver::new(Arc::clone(&self.problem));
        let contact = solver.and_then(|solver| solver.contact(&self.controls));
        let mut contact = contact.map_err(|error| error.to_string())?;
        let found = by_cone_programs(&mut contact, TOLERANCE, usize::MAX);
        let unknowns = found.unknowns.ok_or_else(|| format!("{} cone programs led to no state", found.count))?;
        let (forces, _) = contact.dimensional(&unknowns);
        let normal: Vec<f64> = self.problem.boundary.points.iter().map(|point| forces[point.start].max(0.0)).collect();
        let residual = norm(&contact.residual(&unknowns, 0.0).0);
        if residual.is_nan() || residual > MAX_RESIDUAL {
            return Err(format!("{} cone programs ended with residual {residual:.1e}", found.count));
        }
        let rows = self.problem.positions(&self.controls).and_then(|positions| self.problem.rows(&positions));
        let objective = objective(&normal, &rows.map_err(|error| error.to_string())?);
        Ok(Found {
            path: "cone programs".into(),
            objective,
            residual,
            operations: f64::INFINITY,
            may_not_be_unique: false,
        })
    }

    /// The residual of given forces in the problem condensed anew: equilibrium and contact law.
    fn residual(&self, forces: &ContactForces, rows: &ContactRows) -> f64 {
        let Ok(contact) = &self.contact else { return f64::NAN };
        let (boundary, length) = (&self.problem.boundary, contact.unit * contact.load);
        let mut unknowns = vec![0.0; contact.row_count()];
        let mut jumps = vec![0.0; contact.row_count()];
        let along = |direction: &[f64; 3], vector: [f64; 3]| -> f64 {
            direction.iter().zip(vector).map(|(direction, entry)| direction * entry).sum()
        };
        for (index, (point, node)) in boundary.points.iter().zip(&rows.nodes).enumerate() {
            unknowns[point.start] = forces.normal[index] / contact.load;
            jumps[point.start] = forces.opening[index] / length;
            for (row, tangent) in point.rows().zip(&node.directions).skip(1) {
                unknowns[row] = along(tangent, forces.tangential[index]) / contact.load;
                jumps[row] = along(tangent, forces.slip[index]) / length;
            }
        }
        // The amplitudes that explain the jumps best. The columns of R are orthonormal up to rounding: a few passes.
        let forces = unknowns.clone();
        unknowns.resize(forces.len() + contact.resultant.len(), 0.0);
        let mut explained = contact.jumps(&unknowns, 0.0);
        for _pass in 0..4 {
            for column in 0..contact.resultant.len() {
                let rest = |row: usize| jumps[row] - explained[row];
                let share: f64 = (0..forces.len()).map(|row| contact.motions[(row, column)] * rest(row)).sum();
                unknowns[forces.len() + column] += share;
            }
            explained = contact.jumps(&unknowns, 0.0);
        }
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b.abs()) })
        };
        let defect = largest(&mut explained.iter().zip(&jumps).map(|(a, b)| a - b));
        let amplitudes = unknowns[contact.row_count()..].iter();
        let terms = largest(&mut contact.constant().iter().chain(amplitudes).copied());
        let rounding = JUMP_ROUNDINGS * f64::EPSILON * terms;
        let mut law = 0.0_f64;
        for point in &boundary.points {
            let range = point.rows();
            let argument: Vec<f64> = range.clone().map(|row| forces[row] + jumps[row]).collect();
            let radius = point.friction * argument[0].max(0.0);
            let length = argument[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
            let factor = if length > radius { radius / length } else { 1.0 };
            law = law.max((forces[range.start] - argument[0].max(0.0)).abs());
            for (row, x) in range.skip(1).zip(&argument[1..]) {
                law = law.max((forces[row] - if argument[0] > 0.0 { factor * x } else { 0.0 }).abs());
            }
        }
        let balance =
            contact.residual(&unknowns, 0.0).0[contact.row_count()..].iter().map(|r| r.abs()).fold(0.0, f64::max);
        if defect > rounding { law.max(balance).max(defect) } else { law.max(balance) }
    }
}

/// Θ of normal forces.
fn objective(normal: &[f64], rows: &ContactRows) -> f64 {
    normal.iter().zip(&rows.nodes).map(|(force, node)| (force.max(0.0) / node.area).powi(EXPONENT)).sum()
}
