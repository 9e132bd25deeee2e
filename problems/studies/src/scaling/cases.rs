//! What can be measured: scenes, meshes, solvers.

use clap::ValueEnum;
use contact::contact_shape::Solver;
use contact::direct::DirectSolver;
use contact::equilibrium::ContactProblem;
use contact::error::{ContactError, SceneError};
use contact::scene::{self, Scene};
use contact::tfeti::{DualMethod, PreconditionerKind, Recycling, TornOptions, TotalFeti};
use scene_file::SceneFile;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

/// Bricks and subdomains per edge of each body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Case {
    /// N, bricks per edge.
    pub mesh: usize,
    /// S, subdomains per edge.
    pub subdomains: usize,
}

/// The scenes of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SceneName {
    /// Example 5.1.
    Signorini,
    /// Example 5.2.
    Hertz,
}

/// A contact solver with its preconditioner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Newton on TFETI, Dirichlet preconditioner.
    Dirichlet,
    /// Newton on TFETI, lumped preconditioner.
    Lumped,
    /// Newton on TFETI, no preconditioner.
    None,
    /// The paper's path: successive approximations over dual QPs, Dirichlet preconditioner in the faces.
    AugmentedLagrangian,
    /// Newton on TFETI, Dirichlet preconditioner, every step with a GMRES of its own; measured when asked for by name.
    Gmres,
    /// Newton on directly condensed bodies.
    Direct,
}

/// H/h of the study of growing s.
pub const RATIO: usize = 7;
/// s of the study of growing H/h, and the most for which the unpreconditioned solver is measured.
const FIXED_SUBDOMAINS: usize = 3;
/// Most subdomains per edge for which more than one solver is measured.
const COMPARED: usize = 7;

/// A scene on a mesh.
#[derive(Debug, Clone)]
pub enum Subject {
    /// A scene of the paper on the mesh of a case.
    Paper(SceneName, Case),
    /// The first load case of a scene file, on the mesh that the file names.
    File(PathBuf),
}

impl Subject {
    /// The scene.
    ///
    /// # Errors
    /// [`SceneError`] of the file.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        match self {
            Self::Paper(scene, case) => scene.scene(*case),
            Self::File(file) => {
                let folder = file.parent().map_or_else(PathBuf::new, PathBuf::from);
                let case = scene_file::Case::new(&SceneFile::read(file)?, &folder)?;
                Ok(case.cases[0].scene.clone())
            }
        }
    }

    /// The case; none for a file.
    pub fn case(&self) -> Option<Case> {
        match self {
            Self::Paper(_, case) => Some(*case),
            Self::File(_) => None,
        }
    }

    /// The solvers measured on it.
    pub fn variants(&self, full: bool) -> Vec<Variant> {
        match self {
            Self::Paper(_, case) => case.variants(full),
            Self::File(_) => vec![Variant::Dirichlet, Variant::Direct],
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Paper(_, case) => write!(f, "{case}"),
            Self::File(file) => write!(f, "{}", file.file_stem().unwrap_or(file.as_os_str()).display()),
        }
    }
}

impl Case {
    /// N bricks, S subdomains per edge.
    ///
    /// # Errors
    /// Returns a message when S does not divide N or N is out of range.
    pub fn parse(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(mesh, subdomains)| (mesh.parse(), subdomains.parse()));
        match numbers {
            Some((Ok(mesh @ 1..=400), Ok(subdomains @ 1..))) if usize::is_multiple_of(mesh, subdomains) => {
                Ok(Self { mesh, subdomains })
            }
            _ => Err(format!(
                "unknown case {text:?}; allowed: N/S with 1 to 400 bricks N per edge and a divisor S of N, such as 6/2, \
                 12/2, 21/3, 35/5"
            )),
        }
    }

    /// The cases of the study: s = 2 at H/h = 6, growing H/h at s = 3, growing s at H/h = 7.
    pub fn all(full: bool) -> Vec<Self> {
        let growing: &[usize] = if full { &[2, 3, 4, 5, 6, 7, 9, 12] } else { &[2, 3, 4, 5] };
        let of = |ratio, subdomains| Self { mesh: ratio * subdomains, subdomains };
        let ratios = [3, 5, 9].map(|ratio| of(ratio, FIXED_SUBDOMAINS));
        std::iter::once(of(6, 2)).chain(ratios).chain(growing.iter().map(|&s| of(RATIO, s))).collect()
    }

    /// H/h, bricks per subdomain and edge.
    pub fn ratio(&self) -> usize {
        self.mesh / self.subdomains
    }

    /// Dofs of the subdomains of a body.
    pub fn torn_dofs(&self) -> usize {
        3 * (self.mesh + self.subdomains).pow(3)
    }

    /// The solvers measured on this case.
    pub fn variants(&self, full: bool) -> Vec<Variant> {
        let is_compared = |variant: &Variant| match variant {
            Variant::Dirichlet => true,
            Variant::None => self.subdomains <= FIXED_SUBDOMAINS,
            Variant::Direct => self.mesh <= if full { 35 } else { 21 },
            Variant::Lumped | Variant::AugmentedLagrangian => self.subdomains <= COMPARED,
            Variant::Gmres => false,
        };
        Variant::value_variants().iter().copied().filter(is_compared).collect()
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.mesh, self.subdomains)
    }
}

impl SceneName {
    /// The scene on the mesh of a case.
    pub fn scene(self, case: Case) -> Result<Scene, SceneError> {
        let scene = match self {
            Self::Signorini => scene::signorini()?,
            Self::Hertz => scene::hertz()?,
        };
        Ok(scene.with_bricks([case.mesh; 3], [case.subdomains; 3]))
    }
}

impl Variant {
    /// The solver of a problem, with clusters of about so many subdomains per axis.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails, and [`ContactError::Clusters`].
    pub fn solver(self, problem: &Arc<ContactProblem>, clusters: usize) -> Result<Solver, ContactError> {
        let problem = Arc::clone(problem);
        let Some(preconditioner) = self.preconditioner() else {
            return DirectSolver::new(problem).map(Solver::from);
        };
        let method = match self {
            Self::AugmentedLagrangian => DualMethod::SuccessiveApproximations,
            Self::Gmres => DualMethod::Newton(Recycling::Off),
            _ => DualMethod::Newton(Recycling::On),
        };
        let clusters = (clusters > 1).then(|| cluster_count(&problem, clusters));
        let options = TornOptions { preconditioner, clusters, ..TornOptions::default() };
        Ok(Solver::from(TotalFeti::new(problem, options)?.with_method(method)))
    }

    /// The preconditioner; none for direct condensation.
    pub fn preconditioner(self) -> Option<PreconditionerKind> {
        match self {
            Self::Dirichlet | Self::AugmentedLagrangian | Self::Gmres => Some(PreconditionerKind::Dirichlet),
            Self::Lumped => Some(PreconditionerKind::Lumped),
            Self::None => Some(PreconditionerKind::None),
            Self::Direct => None,
        }
    }
}

/// Number of clusters of all bodies, of about `edge`³ subdomains each.
pub fn cluster_count(problem: &ContactProblem, edge: usize) -> usize {
    problem.bodies.iter().map(|body| (body.pieces.len() / edge.pow(3)).max(1)).sum()
}

/// The name of a value of an enumeration on the command line.
pub fn option_name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
