//! A solved shape: contact forces, status, certificates, work.

use crate::equilibrium::{
    ContactBoundary, ContactPoint, ContactRows, ContactStatus, Kink, NodeRows, Residuals, SolvedBody, StatusCounts,
};
use crate::error::ContactError;
use crate::solvers::SolverKind;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Work spent on one state and its subgradient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Work {
    /// Semismooth Newton steps; in the descent of total FETI, which recycles all directions, one per new direction.
    pub newton_steps: usize,
    /// Tresca problems of the successive approximations.
    pub fixed_point_steps: usize,
    /// Conjugate gradient steps of the dual QP solver.
    pub cg_steps: usize,
    /// Expansion steps of the dual QP solver.
    pub expansion_steps: usize,
    /// Proportioning steps of the dual QP solver.
    pub proportioning_steps: usize,
    /// Products with the dual operator F (0 for direct condensation).
    pub dual_operator_applications: usize,
    /// Of these, products spent on the adjoint.
    pub adjoint_applications: usize,
    /// Numeric factorisations of stiffness matrices (subdomains, interiors, bodies); none for factors that another
    /// solver of the same [`Processes`](crate::solvers::Processes) held.
    pub factorizations: usize,
    /// Dense factorisations on condensed bodies: one per Newton step, one per iteration of a cone program.
    pub dense_factorizations: usize,
}

impl Work {
    /// The sum of this work and the work of an attempt before.
    #[must_use]
    pub fn after(self, other: Self) -> Self {
        Self {
            newton_steps: self.newton_steps + other.newton_steps,
            fixed_point_steps: self.fixed_point_steps + other.fixed_point_steps,
            cg_steps: self.cg_steps + other.cg_steps,
            expansion_steps: self.expansion_steps + other.expansion_steps,
            proportioning_steps: self.proportioning_steps + other.proportioning_steps,
            dual_operator_applications: self.dual_operator_applications + other.dual_operator_applications,
            adjoint_applications: self.adjoint_applications + other.adjoint_applications,
            factorizations: self.factorizations + other.factorizations,
            dense_factorizations: self.dense_factorizations + other.dense_factorizations,
        }
    }
}

/// A solver's failure, and the work that it cost.
#[derive(Debug)]
pub(crate) struct Failed {
    pub(crate) error: Box<ContactError>,
    pub(crate) work: Work,
}

impl From<ContactError> for Failed {
    fn from(error: ContactError) -> Self {
        Self { error: Box::new(error), work: Work::default() }
    }
}

/// Wall-clock seconds of the stages of one state.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StageSeconds {
    /// Rigid body analysis of the scene.
    pub equilibrium: f64,
    /// Assembly and factorisation of subdomains (interiors included) or bodies.
    pub factorization: f64,
    /// Coarse space: G, the part of its matrix that all active sets share, and its factors, solves and projections.
    pub coarse_space: f64,
    /// Iteration for the contact forces, whatever its method, without the coarse space: Krylov spaces, products with F.
    pub newton: f64,
    /// Time for displacements and certificates.
    pub recovery: f64,
}

/// What restarts a solve nearby.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactWarmStart {
    /// Multipliers of the torn problem, all rows.
    Multipliers(Vec<f64>),
    /// Packed contact forces of the condensed problem, N, then the free rigid motions of all bodies, mm.
    Forces(Vec<f64>),
}

/// A solved shape; `S` is what its solver keeps of it.
#[derive(Debug)]
pub struct ContactState<S> {
    /// Contact forces with status and certificates.
    pub forces: ContactForces,
    /// The contact rows of the shape: normals, gaps, areas.
    pub rows: Arc<ContactRows>,
    /// What derivative, diagnosis and displacements are computed from.
    pub solution: S,
    /// All bodies with their displacements, lower first, for a cost that depends on them; none otherwise
    /// ([`ContactShape::with_displacements`](crate::contact_shape::ContactShape::with_displacements)).
    pub bodies: Option<Vec<SolvedBody>>,
    /// Force that residuals are relative to, N; zero for bodies at rest.
    pub load: f64,
    /// The solver that found it.
    pub solver: SolverKind,
    /// Why that solver, where another would have been the first choice.
    pub reason: Option<String>,
    /// Contraction factor observed by the successive approximations, where these found the state in enough steps.
    pub contraction: Option<f64>,
    /// Seconds of the stages, where the solver takes them.
    pub stages: Option<StageSeconds>,
    pub(crate) work: Work,
    pub(crate) adjoint_applications: AtomicUsize,
}

impl<S> ContactState<S> {
    /// Work spent so far, the adjoint included.
    pub fn work(&self) -> Work {
        let adjoint_applications = self.adjoint_applications.load(Ordering::Relaxed);
        Work {
            adjoint_applications,
            dual_operator_applications: self.work.dual_operator_applications + adjoint_applications,
            ..self.work
        }
    }

    /// Replaces the solver's own part of the solution and keeps all else.
    pub fn map<T>(self, change: impl FnOnce(S) -> T) -> ContactState<T> {
        let Self {
            forces,
            rows,
            solution,
            bodies,
            load,
            solver,
            reason,
            contraction,
            stages,
            work,
            adjoint_applications,
        } = self;
        let solution = change(solution);
        ContactState {
            forces,
            rows,
            solution,
            bodies,
            load,
            solver,
            reason,
            contraction,
            stages,
            work,
            adjoint_applications,
        }
    }
}

/// Forces on the contact nodes and what is known about them; physical units, whatever solver found them.
#[derive(Debug, Clone)]
pub struct ContactForces {
    /// λ_N per contact node, N; compression positive.
    pub normal: Vec<f64>,
    /// λ_T per contact node along the axes, N; empty without friction.
    pub tangential: Vec<[f64; 3]>,
    /// Normal jump minus gap per node, (N u − c_N), mm; ≤ 0.
    pub opening: Vec<f64>,
    /// Tangential jump per node along the axes, mm; empty without friction.
    pub slip: Vec<[f64; 3]>,
    /// Forces on the nodes that are glued to a master, along the axes, N, as they act on the master.
    pub ties: Vec<[f64; 3]>,
    /// Contact status per contact node.
    pub status: Vec<ContactStatus>,
    /// Residuals that certify the equilibrium.
    pub residuals: Residuals,
    /// Distance to the nearest kink.
    pub kink: Kink,
}

impl ContactForces {
    /// From packed physical multipliers, jumps and statuses.
    pub fn unpack(
        boundary: &ContactBoundary,
        rows: &ContactRows,
        forces: &[f64],
        jumps: &[f64],
        status: Vec<ContactStatus>,
        residuals: Residuals,
        kink: Kink,
    ) -> Self {
        let contact = boundary.contact_points();
        let normal = contact.iter().map(|point| forces[point.start]).collect();
        let opening = contact.iter().map(|point| jumps[point.start]).collect();
        let vectors = |points: &[ContactPoint], nodes: &[NodeRows], values: &[f64], first: usize| -> Vec<[f64; 3]> {
            let vector = |(point, node): (&ContactPoint, &NodeRows)| {
                let parts = || node.directions[first..].iter().zip(&values[point.start + first..]);
                std::array::from_fn(|axis| parts().map(|(tangent, value)| tangent[axis] * value).sum())
            };
            points.iter().zip(nodes).map(vector).collect()
        };
        let sliding = if boundary.has_friction() { contact } else { &[] };
        let [tangential, slip] = [forces, jumps].map(|values| vectors(sliding, &rows.nodes, values, 1));
        let (tied, tied_rows) = (&boundary.points[contact.len()..], &rows.nodes[contact.len()..]);
        let ties = vectors(tied, tied_rows, forces, 0);
        let mut status = status;
        status.truncate(contact.len());
        Self { normal, tangential, opening, slip, ties, status, residuals, kink }
    }

    /// Total normal force Σλ_N, N.
    pub fn total_normal_force(&self) -> f64 {
        self.normal.iter().sum()
    }

    /// Numbers of nodes per status.
    pub fn counts(&self) -> StatusCounts {
        StatusCounts::of(&self.status)
    }
}
