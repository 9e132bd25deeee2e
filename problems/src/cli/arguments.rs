//! Options of the two contact binaries.

use crate::cli::Failure;
use crate::contact_shape::SolverKind;
use crate::cost::PressureMeasure;
use crate::elasticity::{Formulation, Material};
use crate::error::SceneError;
use crate::scene::Scene;
use crate::shape::SplineKind;
use crate::tfeti::PreconditionerKind;
use clap::{Parser, ValueEnum};
use std::path::PathBuf;

/// What to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Command {
    /// Optimize the shape.
    Optimize,
    /// Objective, subgradient and certificates at one shape.
    Evaluate,
    /// Taylor test of the subgradient at one shape.
    Verify,
}

/// Which function of the contact pressure is minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ObjectiveName {
    /// Σσ^p.
    PressureNorm,
    /// max σ.
    PeakPressure,
}

/// 3D contact shape optimization with Coulomb friction (units: N, mm, MPa).
#[derive(Debug, Clone, Parser)]
#[command(version, allow_negative_numbers = true)]
pub struct Arguments {
    /// What to do.
    #[arg(value_enum, default_value_t = Command::Optimize)]
    pub command: Command,
    /// Bricks per edge of each body.
    #[arg(long, value_name = "N")]
    pub mesh: Option<usize>,
    /// Subdomains per edge of each body; must divide the mesh. Default 2, or, where 2 does not divide the mesh, the divisor
    /// that leaves closest to 6 bricks per subdomain and edge.
    #[arg(long, value_name = "S")]
    pub subdomains: Option<usize>,
    /// Coulomb friction coefficient.
    #[arg(long, value_name = "MU")]
    pub friction: Option<f64>,
    /// Spline of the contact surface.
    #[arg(long, value_name = "bspline:DEGREE|bezier", value_parser = parse_surface)]
    pub surface: Option<SplineKind>,
    /// Control points along x1 and x2.
    #[arg(long, value_name = "N1xN2", value_parser = parse_counts)]
    pub control_points: Option<[usize; 2]>,
    /// Poisson's ratio of the lower body.
    #[arg(long, value_name = "NU")]
    pub poisson_ratio: Option<f64>,
    /// Young's modulus of the lower body, MPa.
    #[arg(long, value_name = "E")]
    pub young_modulus: Option<f64>,
    /// How bricks of all bodies see the change of volume; mean-dilatation is for nearly incompressible materials.
    #[arg(long, value_parser = parse_formulation, value_name = "standard|mean-dilatation")]
    pub formulation: Option<Formulation>,
    /// Factor on all loads (negative: reversed).
    #[arg(long, value_name = "F")]
    pub load_factor: Option<f64>,
    /// Contact solver.
    #[arg(long, value_parser = parse_solver, default_value = "newton", value_name = "newton|direct|augmented-lagrangian")]
    pub solver: SolverKind,
    /// Preconditioner of the dual operator.
    #[arg(long, value_parser = parse_preconditioner, default_value = "dirichlet", value_name = "dirichlet|lumped|none")]
    pub preconditioner: PreconditionerKind,
    /// What is minimised.
    #[arg(long, value_enum, default_value_t = ObjectiveName::PressureNorm)]
    pub objective: ObjectiveName,
    /// Exponent p of the pressure norm.
    #[arg(long, value_name = "P")]
    pub exponent: Option<f64>,
    /// Control heights to evaluate or verify at: a JSON array, row major, index i*n2 + j with i along x1.
    #[arg(long, value_name = "FILE")]
    pub controls: Option<PathBuf>,
    /// Control heights to start the optimization from.
    #[arg(long, value_name = "FILE")]
    pub start_controls: Option<PathBuf>,
    /// Largest number of evaluations of the optimization.
    #[arg(long, value_name = "K")]
    pub max_evaluations: Option<usize>,
    /// Folder for the report, controls, history and pressures.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads for the work on subdomains.
    #[arg(long, value_name = "T")]
    pub threads: Option<usize>,
    /// With evaluate: contraction factor and condition at the state (costs some ten adjoint solves; not done unless asked).
    #[arg(long)]
    pub diagnose: bool,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
}

/// Exponent of the paper's norm.
const DEFAULT_EXPONENT: f64 = 4.0;

impl Arguments {
    /// Refuses options that do not go together.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the option.
    pub fn check(&self) -> Result<(), Failure> {
        let optimizing = self.command == Command::Optimize;
        let wrong = |option: &str, allowed: &str| Err(SceneError::out_of_range(option, "given", allowed).into());
        if optimizing && self.controls.is_some() {
            return wrong("--controls", "with evaluate and verify only (optimize takes --start-controls)");
        }
        if !optimizing && self.start_controls.is_some() {
            return wrong("--start-controls", "with optimize only (evaluate and verify take --controls)");
        }
        if !optimizing && self.max_evaluations.is_some() {
            return wrong("--max-evaluations", "with optimize only");
        }
        if self.diagnose && self.command != Command::Evaluate {
            return wrong("--diagnose", "with evaluate only");
        }
        if self.max_evaluations == Some(0) {
            return Err(SceneError::out_of_range("--max-evaluations", 0, "a number ≥ 1").into());
        }
        if self.threads == Some(0) {
            return Err(SceneError::out_of_range("--threads", 0, "a number ≥ 1").into());
        }
        if self.exponent.is_some() && self.objective == ObjectiveName::PeakPressure {
            return wrong("--exponent", "with --objective pressure-norm only");
        }
        Ok(())
    }

    /// The scene with the options put in.
    ///
    /// # Errors
    /// [`SceneError`] for a bad material; the rest is checked with the scene.
    pub fn apply(&self, mut scene: Scene) -> Result<Scene, SceneError> {
        if let Some(mesh) = self.mesh {
            scene.mesh = [mesh; 3];
        }
        if let Some(subdomains) = self.subdomains {
            scene.subdomains = [subdomains; 3];
        } else if self.mesh.is_some_and(|mesh| mesh > 0 && mesh % scene.subdomains[0] != 0) {
            scene.subdomains = [default_subdomains(self.mesh.unwrap_or(1)); 3];
        }
        scene.friction = self.friction.unwrap_or(scene.friction);
        scene.surface = self.surface.unwrap_or(scene.surface);
        scene.control_points = self.control_points.unwrap_or(scene.control_points);
        if self.poisson_ratio.is_some() || self.young_modulus.is_some() {
            let material = scene.lower.material;
            scene.lower.material = Material::new(
                self.young_modulus.unwrap_or(material.young_modulus()),
                self.poisson_ratio.unwrap_or(material.poisson_ratio()),
            )?
            .with_formulation(material.formulation());
        }
        for body in scene.bodies_mut() {
            if let Some(formulation) = self.formulation {
                body.material = body.material.with_formulation(formulation);
            }
            if let Some(factor) = self.load_factor {
                for load in &mut body.loads {
                    load.traction = load.traction.map(|traction| factor * traction);
                }
            }
        }
        Ok(scene)
    }

    /// What is minimised.
    pub fn measure(&self) -> PressureMeasure {
        match self.objective {
            ObjectiveName::PressureNorm => {
                PressureMeasure::Norm { exponent: self.exponent.unwrap_or(DEFAULT_EXPONENT) }
            }
            ObjectiveName::PeakPressure => PressureMeasure::Peak,
        }
    }
}

/// The divisor of the mesh that leaves closest to six bricks per subdomain and edge.
fn default_subdomains(mesh: usize) -> usize {
    let divisors = (1..=mesh).filter(|count| mesh.is_multiple_of(*count));
    let distance = |count: &usize| {
        let bricks = (mesh / count) as f64 / 6.0;
        bricks.max(1.0 / bricks)
    };
    divisors.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1)
}

fn parse_surface(text: &str) -> Result<SplineKind, String> {
    match text.split_once(':') {
        None if text == "bezier" => Ok(SplineKind::Bezier),
        Some(("bspline", degree)) => degree
            .parse()
            .map(SplineKind::BSpline)
            .map_err(|_| format!("the degree {degree:?} is not a number; allowed: bspline:1, bspline:2, …")),
        _ => Err("allowed: bspline:DEGREE or bezier".into()),
    }
}

fn parse_counts(text: &str) -> Result<[usize; 2], String> {
    let allowed = "allowed: two numbers from 2 to 40 such as 6x6".to_owned();
    let (first, second) = text.split_once('x').ok_or_else(|| allowed.clone())?;
    let counts = [first, second].map(|count| count.parse::<usize>().ok().filter(|count| (2..=40).contains(count)));
    match counts {
        [Some(first), Some(second)] => Ok([first, second]),
        _ => Err(allowed),
    }
}

fn parse_solver(text: &str) -> Result<SolverKind, String> {
    match text {
        "newton" => Ok(SolverKind::Newton),
        "direct" => Ok(SolverKind::Direct),
        "augmented-lagrangian" => Ok(SolverKind::AugmentedLagrangian),
        _ => Err("allowed: newton, direct, augmented-lagrangian".into()),
    }
}

fn parse_formulation(text: &str) -> Result<Formulation, String> {
    match text {
        "standard" => Ok(Formulation::Standard),
        "mean-dilatation" => Ok(Formulation::MeanDilatation),
        _ => Err("allowed: standard, mean-dilatation".into()),
    }
}

fn parse_preconditioner(text: &str) -> Result<PreconditionerKind, String> {
    match text {
        "dirichlet" => Ok(PreconditionerKind::Dirichlet),
        "lumped" => Ok(PreconditionerKind::Lumped),
        "none" => Ok(PreconditionerKind::None),
        _ => Err("allowed: dirichlet, lumped, none".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tearing_of_meshes_that_two_does_not_divide() {
        assert_eq!([35, 25, 9, 7, 13].map(default_subdomains), [5, 5, 1, 1, 1]);
    }

    #[test]
    fn surfaces_and_counts_are_parsed_or_refused() {
        assert_eq!(parse_surface("bspline:3"), Ok(SplineKind::BSpline(3)));
        assert_eq!(parse_surface("bezier"), Ok(SplineKind::Bezier));
        assert!(parse_surface("spline").is_err() && parse_surface("bspline:x").is_err());
        assert_eq!(parse_counts("6x8"), Ok([6, 8]));
        for bad in ["6", "6x", "1x6", "6x41", "-6x6", "axb"] {
            assert!(parse_counts(bad).is_err(), "{bad}");
        }
    }
}
