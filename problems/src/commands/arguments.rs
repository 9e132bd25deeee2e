//! The command and the options of the contact binaries.

use crate::commands::ascii::shown;
use crate::commands::export::options::ExportOptions;
use crate::commands::failure::{Failure, refused};
use crate::commands::processes::SharedSolver;
use crate::commands::run_kind::RunKind;
use crate::commands::study::varied::Varied;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, ValueEnum};
use contact::body::elasticity::Formulation;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::error::SceneError;
use contact::shape::SplineKind;
use contact::tfeti::PreconditionerKind;
use scene_file::{MeasureName, MethodName};
use serde::de::value::Error as NameError;
use serde::de::{DeserializeOwned, IntoDeserializer};
use std::path::{Path, PathBuf};

/// What to do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Command {
    /// Optimize the shape.
    #[default]
    Optimize,
    /// Optimize with and without friction, and solve both shapes with and without it (Example 5.3 of the paper).
    Compare,
    /// A table over values of parameters (--vary), each evaluated, or optimized with --optimize.
    Study,
    /// Objective, subgradient and certificates at one shape.
    Evaluate,
    /// Taylor test of the subgradient at one shape.
    Verify,
    /// Compute norm and error of the certificate of an optimization again, from the files in its folder DIR.
    Recheck,
    /// Write a shape as files for other programs (STL, STEP, CSV, matrices); needs --out.
    Export,
}

/// 3D contact shape optimization with Coulomb friction (units: N, mm, MPa). An option that is not given leaves the field of the
/// scene as it is; --print-scene shows all fields.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(version, allow_negative_numbers = true)]
pub struct Arguments {
    /// What to do.
    #[arg(value_enum, default_value_t)]
    pub command: Command,
    /// With recheck: the folder that an optimization of this scene has left.
    #[arg(value_name = "DIR")]
    pub certified: Option<PathBuf>,
    /// Bricks of each body: per edge, or along x1, x2 and x3.
    #[arg(long, value_name = "N|N1xN2xN3", value_parser = parse_mesh)]
    pub mesh: Option<[usize; 3]>,
    /// Subdomains per edge of each body; must divide the mesh. Where neither this option nor the scene says it: 2, or, where 2
    /// does not divide the mesh, the divisor that leaves closest to 6 bricks per subdomain and edge.
    #[arg(long, value_name = "S", value_parser = count("mesh.subdomains"))]
    pub subdomains: Option<usize>,
    /// Coulomb friction coefficient.
    #[arg(long, value_name = "MU", value_parser = real("friction"))]
    pub friction: Option<f64>,
    /// Spline of the contact surface.
    #[arg(long, value_name = "bspline:DEGREE|bezier", value_parser = parse_surface)]
    pub surface: Option<SplineKind>,
    /// Control points along x1 and x2.
    #[arg(long, value_name = "N1xN2", value_parser = parse_counts)]
    pub control_points: Option<[usize; 2]>,
    /// Poisson's ratio of the lower body.
    #[arg(long, value_name = "NU", value_parser = real("lower.material.poisson_ratio"))]
    pub poisson_ratio: Option<f64>,
    /// Young's modulus of the lower body, MPa.
    #[arg(long, value_name = "E", value_parser = real("lower.material.young_modulus"))]
    pub young_modulus: Option<f64>,
    /// How bricks of all bodies see the change of volume; mean-dilatation is for nearly incompressible materials.
    #[arg(long, value_parser = named::<Formulation>, value_name = "standard|mean-dilatation")]
    pub formulation: Option<Formulation>,
    /// Factor on all loads (negative: reversed) [default: 1].
    #[arg(long, value_name = "F", value_parser = finite)]
    pub load_factor: Option<f64>,
    /// Contact solver.
    #[arg(long, value_parser = named::<SolverKind>, value_name = "auto|newton|direct|augmented-lagrangian")]
    pub solver: Option<SolverKind>,
    /// Preconditioner of the dual operator.
    #[arg(long, value_parser = named::<PreconditionerKind>, value_name = "dirichlet|lumped|none")]
    pub preconditioner: Option<PreconditionerKind>,
    /// What is minimised; two names need fields of the scene file.
    #[arg(long, value_parser = measures())]
    pub objective: Option<MeasureName>,
    /// Exponent p of the pressure norm or of the stress norm.
    #[arg(long, value_name = "P", value_parser = real("objective.exponent"))]
    pub exponent: Option<f64>,
    /// With study: an option and its values, a,b,c or FIRST:LAST:COUNT; several of them make all combinations.
    #[arg(long, value_name = "OPTION=VALUES", value_parser = Varied::parse)]
    pub vary: Vec<Varied>,
    /// With study: optimize in every row, instead of evaluating the start.
    #[arg(long)]
    pub optimize: bool,
    /// Control heights to evaluate, verify or export: a JSON array with an array per control point along x1 [default: surface.start].
    #[arg(long, value_name = "FILE")]
    pub controls: Option<PathBuf>,
    /// With evaluate and study: every control height is off by so much, mm, up or down at random.
    #[arg(long, value_name = "MM", value_parser = size)]
    pub height_error: Option<f64>,
    /// With --height-error: another number, other signs [default: 1].
    #[arg(long, value_name = "K")]
    pub seed: Option<u64>,
    /// Control heights to start the optimization from, as with --controls [default: surface.start].
    #[arg(long, value_name = "FILE")]
    pub start_controls: Option<PathBuf>,
    /// What proposes trial points: the composite model beside the bundle, or the bundle alone.
    #[arg(long, value_parser = named::<MethodName>, value_name = "composite|bundle")]
    pub optimizer: Option<MethodName>,
    /// Largest number of evaluations of the optimization.
    #[arg(long, value_name = "K", value_parser = count("optimizer.max_evaluations"))]
    pub max_evaluations: Option<usize>,
    /// Longest time of this run in seconds; the evaluation under way is finished [default: that of the scene, or none].
    #[arg(long, value_name = "SECONDS", value_parser = real("optimizer.time_limit"))]
    pub time_limit: Option<f64>,
    /// Optimize on growing meshes with so many bricks along the axis that has most, the others in proportion, each starting from the last
    /// optimum.
    #[arg(long, value_name = "N1,N2,...", value_delimiter = ',', value_parser = count("optimizer.continuation"))]
    pub continuation: Option<Vec<usize>>,
    /// Optimize from so many starts: that of the scene, then random surfaces near it; reports how many optima they reach.
    #[arg(long, value_name = "K", value_parser = count("optimizer.starts"))]
    pub starts: Option<usize>,
    /// New folder for the report, controls, history and pressures; an optimization can be resumed from there [default: none].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// With --out: rename a DIR that holds results to the first free DIR.1, DIR.2, ...
    #[arg(long, requires = "out")]
    pub overwrite: bool,
    /// With optimize and a folder: fields for ParaView of the start and of every serious step, as a series (history.pvd).
    #[arg(long)]
    pub vtk_history: bool,
    /// What export writes.
    #[command(flatten)]
    pub export: ExportOptions,
    /// Continue the run that DIR holds (with --max-evaluations, --time-limit, --threads, --vtk-history, --no-checks,
    /// --new-version, --json only).
    #[arg(long, value_name = "DIR")]
    pub resume: Option<PathBuf>,
    /// With --resume: continue a run that another version of the program has begun.
    #[arg(long, requires = "resume")]
    pub new_version: bool,
    /// Threads for the work on subdomains [default: one per processor].
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub threads: Option<u16>,
    /// With evaluate: contraction factor and condition at the state (costs some ten adjoint solves; not done unless asked).
    #[arg(long)]
    pub diagnose: bool,
    /// Leave out the checks of uniqueness and plausibility at the state of evaluate and at the final shape of optimize.
    #[arg(long)]
    pub no_checks: bool,
    /// Print one JSON object on stdout.
    #[arg(long)]
    pub json: bool,
    /// Print the scene, options included, as a complete commented file, and do nothing else.
    #[arg(long)]
    pub print_scene: bool,
    /// Print the JSON schema of scene files for editors, and do nothing else.
    #[arg(long)]
    pub print_schema: bool,
}

impl Command {
    /// The kind of run that it continues.
    pub fn kind(self) -> RunKind {
        match self {
            Self::Compare => RunKind::Comparison,
            Self::Study => RunKind::Study,
            _ => RunKind::Optimization,
        }
    }
}

impl Arguments {
    /// The folder that holds what is printed too, if there is one.
    pub fn kept(&self) -> Option<&Path> {
        self.out.as_deref().or(self.resume.as_deref())
    }

    /// What was left out because the scene does not need it or an option says so, in words.
    pub fn left_out(&self, shape: &ContactShape<SharedSolver>) -> Vec<&'static str> {
        let mut left_out = shape.left_out();
        left_out.extend(self.no_checks.then_some("checks of uniqueness and plausibility (--no-checks)"));
        left_out
    }

    /// Refuses options that do not go together.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the option.
    pub fn check(&self) -> Result<(), Failure> {
        self.check_command()?;
        if self.continuation.is_some() && self.mesh.is_some() {
            return refused("--mesh", "without --continuation, which names the meshes");
        }
        for (option, path) in [("--out", &self.out), ("--resume", &self.resume)] {
            if let Some(path) = path.as_ref().filter(|path| path.to_str().is_none()) {
                return Err(SceneError::out_of_range(option, path.display(), "a name in Unicode").into());
            }
        }
        self.check_resume()?;
        self.export.check(self.command == Command::Export, self.out.is_some(), self.controls.is_some())?;
        let has_exponent = |measure| matches!(measure, MeasureName::PressureNorm | MeasureName::StressNorm);
        if self.exponent.is_some() && self.objective.is_some_and(|measure| !has_exponent(measure)) {
            return refused("--exponent", "with --objective pressure-norm or stress-norm only");
        }
        Ok(())
    }

    /// Refuses options that the command does not take.
    fn check_command(&self) -> Result<(), Failure> {
        let studying = self.command == Command::Study;
        let optimizing_rows = studying && (self.optimize || self.resume.is_some());
        let evaluating = matches!(self.command, Command::Evaluate | Command::Verify) || studying && !self.optimize;
        let optimizing = matches!(self.command, Command::Optimize | Command::Compare) || optimizing_rows;
        let rechecking = self.command == Command::Recheck;
        let looking = self.command == Command::Evaluate || studying && !self.optimize;
        let showing = evaluating || self.command == Command::Export;
        let takes_controls = "with evaluate, verify, study and export only (what optimizes takes --start-controls)";
        let takes_start = "with optimize, compare and study --optimize only (what evaluates takes --controls)";
        let limits = "with optimize, compare and study --optimize only";
        for (option, given, taken, allowed) in [
            ("--controls", self.controls.is_some(), showing, takes_controls),
            ("--start-controls", self.start_controls.is_some(), optimizing, takes_start),
            (
                "--height-error",
                self.height_error.is_some(),
                looking,
                "with evaluate, and with study without --optimize",
            ),
            (
                "--seed",
                self.seed.is_some(),
                looking && (self.height_error.is_some() || studying),
                "with --height-error only",
            ),
            ("--optimizer", self.optimizer.is_some(), optimizing, limits),
            ("--max-evaluations", self.max_evaluations.is_some(), optimizing, limits),
            ("--diagnose", self.diagnose, self.command == Command::Evaluate, "with evaluate only"),
            (
                "--time-limit",
                self.time_limit.is_some(),
                optimizing || studying,
                "with optimize, compare and study only",
            ),
            ("--vary", !self.vary.is_empty(), studying, "with study only"),
            ("--optimize", self.optimize, studying, "with study only"),
            ("--continuation", self.continuation.is_some(), optimizing, limits),
            ("--vtk-history", self.vtk_history, self.command == Command::Optimize, "with optimize only"),
            ("--starts", self.starts.is_some(), self.command == Command::Optimize, "with optimize only"),
            ("--resume", self.resume.is_some(), optimizing || studying, "with optimize, compare and study only"),
            ("--out", self.out.is_some(), !rechecking, "without recheck, which writes no file"),
            ("DIR", self.certified.is_some(), rechecking, "with recheck only"),
        ] {
            if given && !taken {
                return refused(option, allowed);
            }
        }
        if studying && self.vary.is_empty() && self.resume.is_none() {
            return Err(Failure::Input("study needs --vary OPTION=VALUES, for example --vary friction=0:0.8:5".into()));
        }
        if rechecking && self.certified.is_none() {
            return Err(Failure::Input("recheck needs DIR, the folder that an optimization has left".into()));
        }
        Ok(())
    }

    /// The result of a command for stdout, in the form that is asked for.
    pub fn printed(&self, text: String, json: String) -> String {
        if self.json { json } else { shown(&text).into_owned() }
    }

    /// Refuses options beside --resume that are no limits: a run that is continued has its scene and its options in its folder.
    fn check_resume(&self) -> Result<(), Failure> {
        if self.resume.is_none() {
            return Ok(());
        }
        let Ok(nothing) = Self::try_parse_from(["resume"]) else { return Ok(()) };
        let allowed = Self {
            command: self.command,
            resume: self.resume.clone(),
            max_evaluations: self.max_evaluations,
            time_limit: self.time_limit,
            threads: self.threads,
            vtk_history: self.vtk_history,
            no_checks: self.no_checks,
            new_version: self.new_version,
            json: self.json,
            ..nothing
        };
        if *self == allowed {
            return Ok(());
        }
        let allowed = "with --max-evaluations, --time-limit, --threads, --vtk-history, --no-checks, --new-version, --json only: all else is in the folder";
        Err(Failure::Input(format!("--resume is allowed {allowed}")))
    }
}

fn parse_surface(text: &str) -> Result<SplineKind, String> {
    match text.split_once(':') {
        None if text == "bezier" => Ok(SplineKind::Bezier),
        Some(("bspline", degree)) => count("surface.degree")(degree).map(SplineKind::BSpline),
        _ => Err("allowed: bspline:DEGREE or bezier".into()),
    }
}

fn parse_mesh(text: &str) -> Result<[usize; 3], String> {
    let bricks: Vec<usize> = text.split('x').map(count("mesh.bricks")).collect::<Result<_, _>>()?;
    match bricks[..] {
        [all] => Ok([all; 3]),
        [first, second, third] => Ok([first, second, third]),
        _ => Err("allowed: one number, or three such as 12x12x6".into()),
    }
}

fn parse_counts(text: &str) -> Result<[usize; 2], String> {
    let (first, second) = text.split_once('x').ok_or("allowed: two numbers such as 6x6")?;
    let count = count("surface.control_points");
    Ok([count(first)?, count(second)?])
}

/// Reads a number for a field of the scene.
fn real(field: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| scene_file::number(field, text)
}

/// Reads a count for a field of the scene.
fn count(field: &'static str) -> impl Fn(&str) -> Result<usize, String> + Clone {
    move |text| scene_file::number(field, text).map(|count| count as usize)
}

fn finite(text: &str) -> Result<f64, &'static str> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or("allowed: a finite number")
}

fn size(text: &str) -> Result<f64, &'static str> {
    finite(text).ok().filter(|size| *size >= 0.0).ok_or("allowed: a finite number ≥ 0")
}

/// A choice by its name in scene files; the error lists all names.
fn named<T: DeserializeOwned>(text: &str) -> Result<T, NameError> {
    T::deserialize(text.into_deserializer())
}

fn measures() -> impl TypedValueParser<Value = MeasureName> {
    let value = |name, meaning| PossibleValue::new(name).help(meaning);
    PossibleValuesParser::new([
        value("pressure-norm", "∫σ^p dA, or Σσ^p with objective.weight = \"nodes\" in the scene file"),
        value("peak-pressure", "max σ"),
        value("pressure-deviation", "mean of (σ − wanted)²; needs objective.wanted of the scene file"),
        value("open-area", "area that lacks contact pressure; needs objective.pressure of the scene file"),
        value(
            "stress-norm",
            "p-norm of the von Mises stress, in the whole bodies or in objective.region of the scene file",
        ),
        value("compliance", "work of all loads"),
    ])
    .try_map(|name| named(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_that_the_help_lists_is_one() {
        let command = <Arguments as clap::CommandFactory>::command();
        for option in ["solver", "preconditioner", "formulation", "objective", "optimizer"] {
            let argument = command.get_arguments().find(|argument| argument.get_id() == option).expect(option);
            let listed: Vec<String> = match argument.get_possible_values() {
                values if !values.is_empty() => values.iter().map(|value| value.get_name().to_owned()).collect(),
                _ => argument.get_value_names().expect(option)[0].split('|').map(str::to_owned).collect(),
            };
            assert!(listed.len() > 1, "{option}");
            for name in listed {
                Arguments::try_parse_from(["contact", &format!("--{option}"), &name]).expect(&name);
            }
        }
        let refusal = Arguments::try_parse_from(["contact", "--solver", "newtn"]).expect_err("no solver").to_string();
        assert!(refusal.contains("`auto`, `newton`, `direct`, `augmented-lagrangian`"), "{refusal}");
    }

    #[test]
    fn surfaces_and_counts_are_parsed_or_refused() {
        assert_eq!(parse_surface("bspline:3"), Ok(SplineKind::BSpline(3)));
        assert_eq!(parse_surface("bezier"), Ok(SplineKind::Bezier));
        assert!(parse_surface("spline").is_err() && parse_surface("bspline:x").is_err());
        assert_eq!((parse_mesh("6"), parse_mesh("12x10x4")), (Ok([6; 3]), Ok([12, 10, 4])));
        for bad in ["", "6x", "6x6", "6x6x0", "6x6x6x6", "6x6x401"] {
            assert!(parse_mesh(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_counts("6x8"), Ok([6, 8]));
        for bad in ["6", "6x", "1x6", "6x41", "-6x6", "axb"] {
            assert!(parse_counts(bad).is_err(), "{bad}");
        }
    }
}
