//! A scene and how it is to be solved.

use crate::equilibrium::{ContactProblem, FormErrors};
use crate::error::SceneError;
use crate::scene::Scene;
use crate::solvers::SolverKind;
use crate::tfeti::PreconditionerKind;
use serde::{Deserialize, Serialize};

/// What a solver will be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wanted {
    /// States and their adjoints.
    States,
    /// The Jacobian of all contact forces too.
    Jacobians,
}

/// A scene and how it is to be solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolverPlan {
    /// The scene, with all that its file refers to.
    pub scene: Scene,
    /// The contact solver by name.
    pub kind: SolverKind,
    /// The preconditioner of total FETI.
    pub preconditioner: PreconditionerKind,
    /// Number of clusters of subdomains of all bodies (hybrid total FETI); none: every subdomain by itself.
    pub clusters: Option<usize>,
    /// Form errors in place of the controls of the scene, if they are.
    pub form_errors: Option<FormErrors>,
    /// What the solver will be asked for: the choice of `auto` depends on it.
    pub wanted: Wanted,
    /// Number of load cases whose states are held at the same time: memory must do for all of them.
    pub cases: usize,
}

impl SolverPlan {
    /// States of a scene by a solver of this kind, the rest by default.
    pub fn new(scene: Scene, kind: SolverKind) -> Self {
        Self {
            scene,
            kind,
            preconditioner: PreconditionerKind::default(),
            clusters: None,
            form_errors: None,
            wanted: Wanted::States,
            cases: 1,
        }
    }

    /// Columns of a Jacobian that is wanted, else 0.
    pub(crate) fn columns(&self) -> usize {
        let controls = match self.form_errors {
            Some(_) => FormErrors::WAVES * self.scene.shapes().count(),
            None => self.scene.control_count(),
        };
        if self.wanted == Wanted::Jacobians { controls } else { 0 }
    }

    /// Refuses clusters that the subdomains of a problem cannot make, processes that would own none, and glued faces
    /// with successive approximations. Direct condensation takes any number of processes.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] with what is allowed.
    pub(crate) fn check(&self, problem: &ContactProblem, processes: usize) -> Result<(), SceneError> {
        let subdomains: usize = problem.bodies.iter().map(|body| body.pieces.len()).sum();
        if self.kind == SolverKind::AugmentedLagrangian && problem.boundary.has_ties() {
            let allowed = "\"auto\", \"newton\" or \"direct\" with glued faces: the quadratic programs of this method know \
                           half-lines and discs alone";
            return Err(SceneError::out_of_range("solver.kind", "augmented-lagrangian", allowed));
        }
        if let Some(count) = self.clusters {
            let refused = |allowed: String| Err(SceneError::out_of_range("solver.clusters", count, allowed));
            if self.kind == SolverKind::Direct {
                return refused("no clusters with solver.kind = \"direct\", which has no subdomains".into());
            }
            let least = problem.bodies.len();
            if !(least..=subdomains).contains(&count) {
                return refused(format!("{least} … {subdomains}: at least one per body, at most the subdomains"));
            }
        }
        let (most, of) = match self.clusters {
            Some(clusters) => (clusters, "clusters (solver.clusters)"),
            None => (subdomains, "subdomains (mesh.subdomains)"),
        };
        if self.kind == SolverKind::Direct || processes <= most {
            return Ok(());
        }
        let allowed = format!("at most {most}, as many as there are {of}");
        Err(SceneError::out_of_range("number of processes", processes, allowed))
    }
}
