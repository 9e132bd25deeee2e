//! The command and the options of the contact binaries.

use crate::commands::export::options::ExportOptions;
use crate::commands::failure::{Failure, refused};
use crate::commands::run_kind::RunKind;
use crate::commands::scene_options::{SceneChanges, SceneOptions, options};
use crate::commands::study::varied::Varied;
use crate::commands::tolerance::options::ToleranceOptions;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, FromArgMatches, Subcommand, ValueEnum};
use contact::contact_shape::ContactShape;
use contact::error::SceneError;
use scene_file::SceneFile;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The argument that names the scene, where the binary takes any.
pub const SCENE: &str = "scene";
/// The options of a scene that a run which is continued may have.
const LIMITS: [&str; 2] = ["max-evaluations", "time-limit"];
/// What stands above the list of options.
const ABOUT: &str = "3D contact shape optimization with Coulomb friction (units: N, mm, MPa). Options without a command are those of \
    optimize [default: optimize]; COMMAND --help shows those of the others. An option that is not given leaves the field of the scene \
    as it is; --print-scene shows all fields.";

/// What to do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Subcommand)]
pub enum Command {
    /// Optimize the shape
    #[default]
    Optimize,
    /// Optimize with and without friction, and solve both shapes with and without it (Example 5.3 of the paper)
    Compare,
    /// A table over values of parameters (--vary), each evaluated, or optimized with --optimize
    Study,
    /// The scene before any solve: bodies, names, supports, loads, gaps; with --out a page to turn it
    Look,
    /// Objective, subgradient and certificates at one shape
    Evaluate,
    /// Taylor test of the subgradient at one shape
    Verify,
    /// Objective and limits over random form errors of the shaped faces: how good the shape must be made
    Tolerance,
    /// Compute norm and error of the certificate of an optimization again, from the files in its folder DIR
    Recheck,
    /// Write a shape as files for other programs (STL, STEP, CSV, matrices); needs --out
    Export,
}

/// Declares [`Arguments`]: groups of options, each with its commands. Options of other commands are not given.
macro_rules! groups {
    ($($(#[$meaning:meta])* $field:ident: $group:ty, of $($command:ident)|+;)+) => {
        /// A command with its options.
        #[derive(Debug, Clone, Default, PartialEq)]
        pub struct Arguments {
            /// What to do.
            pub command: Command,
            /// Whether one JSON object is printed on stdout.
            pub json: bool,
            /// Whether the inner numbers of the optimizer are printed.
            pub verbose: bool,
            $($(#[$meaning])* pub $field: $group,)+
        }

        impl Arguments {
            /// The parser with the options of a command.
            fn augmented(command: Command, mut parser: clap::Command) -> clap::Command {
                // A group would put its own description in the place of the command's.
                let about = parser.get_about().cloned();
                $(if matches!(command, $(Command::$command)|+) {
                    parser = <$group as Args>::augment_args(parser);
                })+
                parser.about(about.unwrap_or_default())
            }

            /// What the parser found.
            fn groups(command: Command, matches: &ArgMatches) -> Result<Self, Error> {
                $(let $field = if matches!(command, $(Command::$command)|+) {
                    <$group as FromArgMatches>::from_arg_matches(matches)?
                } else {
                    <$group>::default()
                };)+
                Ok(Self { command, json: false, verbose: false, $($field,)+ })
            }
        }
    };
}

groups! {
    /// The folder to check again.
    certified: Certified, of Recheck;
    /// What a study varies.
    variation: Variation, of Study;
    /// What is exported.
    export: ExportOptions, of Export;
    /// The form errors of a shape.
    tolerance: ToleranceOptions, of Tolerance;
    /// What changes in the scene.
    scene: SceneChanges, of Optimize | Compare | Study | Look | Evaluate | Verify | Tolerance | Recheck | Export;
    /// The shape that is looked at.
    shape: Shape, of Study | Look | Evaluate | Verify | Tolerance | Export;
    /// How far that shape is off.
    error: HeightError, of Study | Evaluate;
    /// How the scene changes the optimizer.
    optimizer: SceneOptions<true>, of Optimize | Compare | Study;
    /// Where an optimization begins.
    course: Course, of Optimize | Compare | Study;
    /// Where files go.
    files: Files, of Optimize | Compare | Study | Look | Evaluate | Verify | Tolerance | Export;
    /// A series of fields.
    series: Series, of Optimize;
    /// What is computed besides at a state.
    diagnosis: Diagnosis, of Evaluate;
    /// What is said of states and runs.
    results: Results, of Optimize | Compare | Study | Evaluate;
    /// What all commands take.
    common: Common, of Optimize | Compare | Study | Look | Evaluate | Verify | Tolerance | Recheck | Export;
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[allow(missing_docs, reason = "the help says it, here and below")]
pub struct Certified {
    /// The folder that an optimization of this scene has left.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Study")]
#[allow(missing_docs)]
pub struct Variation {
    /// An option of the scene, or any of its fields, with values a,b,c or FIRST:LAST:COUNT; several of them make all
    /// combinations.
    #[arg(long, value_name = "OPTION=VALUES", value_parser = Varied::parse)]
    pub vary: Vec<Varied>,
    /// Optimize in every row, instead of evaluating the start.
    #[arg(long)]
    pub optimize: bool,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Shape")]
#[allow(missing_docs)]
pub struct Shape {
    /// Control heights of the shape: a JSON array with an array per control point along x1 [default: lattice.start].
    #[arg(long, value_name = "FILE")]
    pub controls: Option<PathBuf>,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Shape")]
#[allow(missing_docs)]
pub struct HeightError {
    /// Every control height is off by so much, mm, up or down at random.
    #[arg(long, value_name = "MM", value_parser = size)]
    pub height_error: Option<f64>,
    /// With --height-error: another number, other signs [default: 1].
    #[arg(long, value_name = "K")]
    pub seed: Option<u64>,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Optimizer")]
#[allow(missing_docs)]
pub struct Course {
    /// Control heights to start the optimization from, a file as with --controls of evaluate [default: lattice.start].
    #[arg(long, value_name = "FILE")]
    pub start_controls: Option<PathBuf>,
    /// Optimize every start once, with all controls: no attempts, no coarse net, no fairness [default: optimizer.single
    /// of the scene].
    #[arg(long)]
    pub single: bool,
    /// Continue the run that DIR holds (with --max-evaluations, --time-limit, --threads, --vtk-history, --no-checks,
    /// --new-version, --verbose, --json only).
    #[arg(long, value_name = "DIR")]
    pub resume: Option<PathBuf>,
    /// With --resume: continue a run that another version of the program has begun.
    #[arg(long, requires = "resume")]
    pub new_version: bool,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Results")]
#[allow(missing_docs)]
pub struct Files {
    /// New folder for report, pictures and data; an optimization can be resumed from there [default: none].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// With --out: rename a DIR that holds results to the first free DIR.1, DIR.2, ...
    #[arg(long, requires = "out")]
    pub overwrite: bool,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Results")]
#[allow(missing_docs)]
pub struct Series {
    /// With a folder: fields for ParaView of the start and of every serious step, as a series (history.pvd).
    #[arg(long)]
    pub vtk_history: bool,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Results")]
#[allow(missing_docs)]
pub struct Diagnosis {
    /// Contraction factor and condition at the state (costs some ten adjoint solves; not done unless asked).
    #[arg(long)]
    pub diagnose: bool,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Results")]
#[allow(missing_docs)]
pub struct Results {
    /// Leave out the checks of uniqueness and plausibility.
    #[arg(long)]
    pub no_checks: bool,
    /// Print the optimizer's inner numbers too.
    #[arg(long)]
    verbose: bool,
}

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Program")]
#[allow(missing_docs)]
pub struct Common {
    /// Threads for the work on subdomains [default: one per processor].
    #[arg(long, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub threads: Option<u16>,
    /// Print one JSON object on stdout.
    #[arg(long)]
    json: bool,
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
    /// The parser: the options of `optimize`, and all commands with theirs.
    pub fn parser() -> clap::Command {
        let root = clap::Command::new("contact").version(env!("CARGO_PKG_VERSION"));
        let root = Command::augment_subcommands(Self::augmented(Command::Optimize, root));
        let root = root.subcommand_required(false).arg_required_else_help(false).disable_help_subcommand(true);
        let with_options = |parser: clap::Command| match Command::from_str(parser.get_name(), false) {
            Ok(command) => Self::augmented(command, parser).allow_negative_numbers(true),
            Err(_) => parser,
        };
        root.about(ABOUT).allow_negative_numbers(true).mut_subcommands(with_options)
    }

    /// What the parser found, of the options of a command.
    fn found(command: Command, matches: &ArgMatches) -> Result<Self, Error> {
        let found = Self::groups(command, matches)?;
        Ok(Self { json: found.common.json, verbose: found.results.verbose, ..found })
    }

    /// Reads the words of a command line, the name of the program first.
    ///
    /// # Errors
    /// [`Error`] for what the parser refuses, and with the help that is asked for.
    pub fn try_parse_from(words: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> Result<Self, Error> {
        Self::parse_by(Self::parser(), words).map(|(arguments, _)| arguments)
    }

    /// Reads the words of a command line by this parser; the scene too, where it has an argument for one.
    pub fn parse_by(
        mut parser: clap::Command,
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<(Self, Option<PathBuf>), Error> {
        let matches = parser.try_get_matches_from_mut(words).map_err(|error| with_takers(error, &mut parser))?;
        let scene = matches.try_get_one::<PathBuf>(SCENE).ok().flatten().cloned();
        let Some((name, inner)) = matches.subcommand() else {
            return Ok((Self::found(Command::Optimize, &matches)?, scene));
        };
        let is_given = |id: &str| id != SCENE && matches.value_source(id) == Some(ValueSource::CommandLine);
        let early = parser.get_arguments().find(|argument| is_given(argument.get_id().as_str()));
        if let Some(option) = early.and_then(clap::Arg::get_long) {
            let words = format!("--{option} is allowed after the command: {name} --{option}");
            return Err(parser.error(ErrorKind::ArgumentConflict, words));
        }
        let command =
            Command::from_str(name, false).map_err(|words| parser.error(ErrorKind::InvalidSubcommand, words))?;
        Ok((Self::found(command, inner)?, scene))
    }

    /// The folder that holds what is printed too, if there is one.
    pub fn kept(&self) -> Option<&Path> {
        self.files.out.as_deref().or(self.course.resume.as_deref())
    }

    /// All that changes in the scene.
    pub fn changes(&self) -> SceneChanges {
        self.scene.clone().and(&self.optimizer)
    }

    /// The scene file with all changes; checked further when it becomes a case.
    pub fn apply(&self, file: SceneFile) -> Result<SceneFile, SceneError> {
        let mut file = self.changes().apply(file)?;
        if let Some(folder) = &self.files.out {
            file.output.folder = Some(folder.display().to_string());
        }
        file.optimizer.single |= self.course.single;
        Ok(file)
    }

    /// What was left out because the scene does not need it or an option says so, in words.
    pub fn left_out(&self, shape: &ContactShape) -> Vec<&'static str> {
        let mut left_out = shape.left_out();
        left_out.extend(self.results.no_checks.then_some("checks of uniqueness and plausibility (--no-checks)"));
        left_out
    }

    /// The result of a command for stdout, in the form that is asked for.
    pub fn printed(&self, text: String, json: String) -> String {
        if self.json { json } else { text }
    }

    /// Refuses options that do not go together.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the option.
    pub fn check(&self) -> Result<(), Failure> {
        let changes = self.changes();
        if changes.has("continuation") && changes.has("mesh") {
            return refused("--mesh", "without --continuation, which names the meshes");
        }
        for (option, path) in [("--out", &self.files.out), ("--resume", &self.course.resume)] {
            if let Some(path) = path.as_ref().filter(|path| path.to_str().is_none()) {
                return Err(SceneError::out_of_range(option, path.display(), "a name in Unicode").into());
            }
        }
        if self.command == Command::Evaluate && self.error.seed.is_some() && self.error.height_error.is_none() {
            return refused("--seed", "with --height-error only");
        }
        if self.course.resume.is_some() {
            return self.check_resumed();
        }
        match self.command {
            Command::Export => self.export.check(self.files.out.is_some(), self.shape.controls.is_some()),
            Command::Tolerance => self.tolerance.check(self.files.out.is_some(), self.shape.controls.is_some()),
            Command::Study => self.check_study(),
            _ => Ok(()),
        }
    }

    /// Refuses options of a study that belong to the other kind of rows.
    fn check_study(&self) -> Result<(), Failure> {
        let Variation { vary, optimize } = &self.variation;
        if vary.is_empty() {
            return Err(Failure::Input("study needs --vary OPTION=VALUES, for example --vary friction=0:0.8:5".into()));
        }
        if *optimize && self.shape.controls.is_some() {
            return refused("--controls", "without --optimize (rows that are optimized begin at --start-controls)");
        }
        let of_optimizer =
            options(true).iter().find(|option| option.name != "time-limit" && self.changes().has(option.name));
        let start = self.course.start_controls.as_ref().map(|_| "start-controls");
        match start.or(of_optimizer.map(|option| option.name)).filter(|_| !optimize) {
            Some(option) => refused(&format!("--{option}"), "with optimize, compare and study --optimize only"),
            None => Ok(()),
        }
    }

    /// Refuses options beside --resume that are no limits: the folder of a run has its scene and its options.
    fn check_resumed(&self) -> Result<(), Failure> {
        let allowed = Self {
            command: self.command,
            json: self.json,
            verbose: self.verbose,
            optimizer: self.optimizer.only(&LIMITS),
            course: Course { start_controls: None, single: false, ..self.course.clone() },
            series: self.series.clone(),
            results: self.results.clone(),
            common: Common { print_scene: false, print_schema: false, ..self.common.clone() },
            ..Self::default()
        };
        if *self == allowed {
            return Ok(());
        }
        let allowed = "with --max-evaluations, --time-limit, --threads, --vtk-history, --no-checks, --new-version, --verbose, --json \
                       only: all else is in the folder";
        Err(Failure::Input(format!("--resume is allowed {allowed}")))
    }
}

/// An error about an option that the command does not take, with those that do, or about an unknown command.
fn with_takers(error: Error, parser: &mut clap::Command) -> Error {
    let context = match error.kind() {
        ErrorKind::UnknownArgument => ContextKind::InvalidArg,
        ErrorKind::InvalidSubcommand => ContextKind::InvalidSubcommand,
        _ => return error,
    };
    let Some(ContextValue::String(word)) = error.get(context) else { return error };
    let is_meant = |argument: &clap::Arg| match word.strip_prefix("--") {
        Some(option) => argument.get_long() == Some(option),
        None => argument.is_positional() && !word.starts_with('-'),
    };
    let takes = |command: &&clap::Command| {
        error.kind() == ErrorKind::InvalidSubcommand || command.get_arguments().any(is_meant)
    };
    let takers: Vec<&str> = parser.get_subcommands().filter(takes).map(clap::Command::get_name).collect();
    let Some((last, others)) = takers.split_last() else { return error };
    let takers = if others.is_empty() { (*last).to_owned() } else { format!("{} and {last}", others.join(", ")) };
    let words = match error.kind() {
        ErrorKind::UnknownArgument => format!("{word} is allowed with {takers} only"),
        _ => format!("there is no command {word}; allowed: {takers}"),
    };
    parser.error(error.kind(), words)
}

fn size(text: &str) -> Result<f64, &'static str> {
    let size = text.parse().ok().filter(|size: &f64| size.is_finite() && *size >= 0.0);
    size.ok_or("allowed: a finite number ≥ 0")
}
