//! Θ on a mesh by a contact solver.

use crate::accuracy::extent::case;
use crate::scaling::SceneName;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{PressureCost, PressureMeasure};
use contact::error::SceneError;
use contact::tfeti::{PreconditionerKind, Recycling};
use nonsmooth::ReducedObjective;
use problems::commands::Failure;
use serde::Serialize;

/// Θ of a scene.
pub type Objective = ReducedObjective<ContactShape, PressureCost>;

/// The paper's exponent.
pub const EXPONENT: f64 = 4.0;

/// A contact solver with its preconditioner.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Method {
    /// Name for tables and pictures.
    pub name: &'static str,
    kind: SolverKind,
    preconditioner: PreconditionerKind,
    recycling: Recycling,
}

impl Method {
    const fn new(
        name: &'static str,
        kind: SolverKind,
        preconditioner: PreconditionerKind,
        recycling: Recycling,
    ) -> Self {
        Self { name, kind, preconditioner, recycling }
    }

    /// The default: descent on total FETI, Dirichlet preconditioner.
    pub const DESCENT: Self =
        Self::new("descent, Dirichlet", SolverKind::Newton, PreconditionerKind::Dirichlet, Recycling::On);
    /// Direct condensation, the independent path.
    pub const DIRECT: Self =
        Self::new("direct condensation", SolverKind::Direct, PreconditionerKind::Dirichlet, Recycling::Auto);
    /// All contact solvers and preconditioners.
    pub const ALL: [Self; 6] = [
        Self::DESCENT,
        Self::new("descent, lumped", SolverKind::Newton, PreconditionerKind::Lumped, Recycling::On),
        Self::new("descent, none", SolverKind::Newton, PreconditionerKind::None, Recycling::On),
        Self::new("Newton–GMRES", SolverKind::Newton, PreconditionerKind::Dirichlet, Recycling::Off),
        Self::new(
            "augmented Lagrangian",
            SolverKind::AugmentedLagrangian,
            PreconditionerKind::Dirichlet,
            Recycling::Auto,
        ),
        Self::DIRECT,
    ];

    /// Θ = Σσ⁴, or another measure, on N bricks per edge.
    ///
    /// # Errors
    /// [`Failure::Input`] from the scene.
    pub fn objective(&self, scene: SceneName, mesh: usize, measure: PressureMeasure) -> Result<Objective, Failure> {
        self.objective_on(scene.scene(case(mesh))?, measure)
    }

    /// Θ of any scene.
    ///
    /// # Errors
    /// [`Failure::Input`] from the scene.
    pub fn objective_on(&self, scene: contact::scene::Scene, measure: PressureMeasure) -> Result<Objective, Failure> {
        let shape = ContactShape::with_preconditioner(scene, self.kind, self.preconditioner)?;
        let shape = shape.with_recycling(self.recycling);
        let cost: Result<_, SceneError> = PressureCost::new(measure, &shape.problem().boundary);
        Ok(ReducedObjective::new(shape, cost?))
    }
}

/// Σσ⁴.
pub fn norm() -> PressureMeasure {
    PressureMeasure::Norm { exponent: EXPONENT }
}
