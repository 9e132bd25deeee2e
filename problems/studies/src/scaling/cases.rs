//! Which meshes are measured, with which solvers.

use clap::ValueEnum;
use contact::contact_shape::Solver;
use contact::direct::DirectSolver;
use contact::equilibrium::ContactProblem;
use contact::error::{ContactError, SceneError};
use contact::scene::{self, Scene};
use contact::tfeti::{DualMethod, PreconditionerKind, Recycling, TornOptions, TotalFeti};
use serde::Serialize;
use std::fmt;
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

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// s = 2, 3 only.
    Quick,
    /// s = 2 … 5.
    Usual,
    /// s = 2 … 7, direct condensation up to 35 bricks; s = 9 and 12 with the Dirichlet preconditioner alone.
    Full,
}

/// H/h of the study of growing s.
pub const RATIO: usize = 7;
/// s of the study of growing H/h.
pub const FIXED_SUBDOMAINS: usize = 3;
/// Most subdomains per edge for which more than one solver is measured.
const COMPARED: usize = 7;
/// Most subdomains per edge for which the unpreconditioned solver is measured.
const UNPRECONDITIONED: usize = 3;

impl Case {
    /// N bricks, S subdomains per edge.
    ///
    /// # Errors
    /// Returns a message when S does not divide N or N is out of range.
    pub fn parse(text: &str) -> Result<Self, String> {
        let allowed = || {
            format!(
                "unknown case {text:?}; allowed: N/S with 1 to 400 bricks N per edge and a divisor S of N, such as 6/2, \
                 12/2, 21/3, 35/5"
            )
        };
        let (mesh, subdomains) = text.split_once('/').ok_or_else(allowed)?;
        match (mesh.parse::<usize>(), subdomains.parse::<usize>()) {
            (Ok(mesh @ 1..=400), Ok(subdomains @ 1..)) if mesh.is_multiple_of(subdomains) => {
                Ok(Self { mesh, subdomains })
            }
            _ => Err(allowed()),
        }
    }

    /// H/h, bricks per subdomain and edge.
    pub fn ratio(&self) -> usize {
        self.mesh / self.subdomains
    }

    /// The solvers measured on this case.
    pub fn variants(&self, extent: Extent) -> Vec<Variant> {
        let largest_direct = match extent {
            Extent::Quick => 14,
            Extent::Usual => 21,
            Extent::Full => 35,
        };
        if self.subdomains > COMPARED {
            return vec![Variant::Dirichlet];
        }
        let mut variants = vec![Variant::Dirichlet, Variant::Lumped];
        if self.subdomains <= UNPRECONDITIONED {
            variants.push(Variant::None);
        }
        variants.push(Variant::AugmentedLagrangian);
        if self.mesh <= largest_direct {
            variants.push(Variant::Direct);
        }
        variants
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.mesh, self.subdomains)
    }
}

impl Extent {
    /// The cases: s = 2 at H/h = 6, growing s at H/h = 7, growing H/h at s = 3.
    pub fn cases(self) -> Vec<Case> {
        let (growing, ratios): (&[usize], &[usize]) = match self {
            Self::Quick => (&[2, 3], &[3]),
            Self::Usual => (&[2, 3, 4, 5], &[3, 5, 9]),
            Self::Full => (&[2, 3, 4, 5, 6, 7, 9, 12], &[3, 5, 9]),
        };
        let of = |ratio, subdomains| Case { mesh: ratio * subdomains, subdomains };
        let growing_ratio = ratios.iter().map(|&ratio| of(ratio, FIXED_SUBDOMAINS));
        std::iter::once(of(6, 2)).chain(growing_ratio).chain(growing.iter().map(|&s| of(RATIO, s))).collect()
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
    /// The solver of a problem.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn solver(self, problem: &Arc<ContactProblem>) -> Result<Solver, ContactError> {
        self.clustered_solver(problem, 1)
    }

    /// The solver of a problem with clusters of about so many subdomains per axis.
    ///
    /// # Errors
    /// As [`Variant::solver`], and [`ContactError::Clusters`].
    pub fn clustered_solver(self, problem: &Arc<ContactProblem>, clusters: usize) -> Result<Solver, ContactError> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_are_parsed_or_refused_with_what_is_allowed() {
        assert_eq!(Case::parse("35/5"), Ok(Case { mesh: 35, subdomains: 5 }));
        for bad in ["35", "35/", "/5", "35/4", "0/1", "6/0", "401/1", "-6/2", "a/b", "6/2/1"] {
            let message = Case::parse(bad).expect_err(bad);
            assert!(message.contains(bad) && message.contains("divisor"), "{message}");
        }
    }

    #[test]
    fn the_usual_study_holds_the_paper_size_once() {
        let cases = Extent::Usual.cases();
        assert_eq!(cases.iter().filter(|case| case.to_string() == "35/5").count(), 1);
        assert_eq!(cases.iter().filter(|case| case.subdomains == 3).map(Case::ratio).max(), Some(9));
    }
}
