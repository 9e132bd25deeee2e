//! The options that stand for fields of the scene. Each is declared once, in [`OPTIONS`] or [`OPTIMIZER_OPTIONS`];
//! parser, help with defaults, messages, and the changes of a scene derive from that.

use crate::commands::body_fields::{Settings, first_body, of_bodies, stands_for, unfit_subdomains};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::Error;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use contact::error::SceneError;
use scene_file::{LoadSection, MethodName, QuantityName, SceneFile, Setting, choices};

/// Largest traction, MPa, force, N, and moment, N mm, of a scene.
const LARGEST_TRACTION: f64 = 1e15;
const LARGEST_FORCE: f64 = 1e18;
const LARGEST_MOMENT: f64 = 1e21;

/// An option and what it changes.
pub struct SceneOption {
    /// Its name without the two dashes.
    pub name: &'static str,
    /// The fields that it stands for; the help shows the value of the first one where the option is not given.
    pub fields: &'static [&'static str],
    heading: &'static str,
    value_name: &'static str,
    help: &'static str,
    /// The fields with the values that a text gives them.
    read: fn(&'static [&'static str], &str) -> Settings,
    /// What the text changes in a scene, beginning with what was read.
    adapt: fn(&SceneFile, &str, Vec<Setting>) -> Settings,
}

const BODIES: &str = "Scene";
const SURFACE: &str = "Optimized shape";
const SOLVER: &str = "Contact solver";
const OBJECTIVE: &str = "Objective";
const OPTIMIZER: &str = "Optimizer";

/// The options that all commands take, in the order in which they change a scene.
const OPTIONS: [SceneOption; 14] = [
    SceneOption {
        adapt: fitting,
        ..option(
            (BODIES, "mesh", "N|N1xN2xN3"),
            &["body[0].block.bricks"],
            "Bricks of each body: per edge, or along x1, x2 and x3",
        )
    },
    option(
        (BODIES, "subdomains", "S|S1xS2xS3"),
        &["body[0].block.subdomains"],
        "Subdomains of each body, per edge or along x1, x2 and x3; must divide the mesh. Where neither this option nor the scene says it: 2, or, where 2 does not divide the mesh, the divisor that leaves closest to 6 bricks per subdomain and edge",
    ),
    option((BODIES, "friction", "MU"), &["friction"], "Coulomb friction coefficient"),
    option(
        (BODIES, "poisson-ratio", "NU"),
        &["body[0].material.poisson_ratio"],
        "Poisson's ratio of the optimized body",
    ),
    option(
        (BODIES, "young-modulus", "E"),
        &["body[0].material.young_modulus"],
        "Young's modulus of the optimized body, MPa",
    ),
    option(
        (BODIES, "formulation", "NAME"),
        &["body[0].material.formulation"],
        "How cells of all bodies see the change of volume; mean-dilatation is for nearly incompressible materials",
    ),
    SceneOption {
        read: factor,
        adapt: loaded,
        ..option((BODIES, "load-factor", "F"), &[], "Factor on all loads (negative: reversed) [default: 1]")
    },
    option(
        (SURFACE, "degrees", "P|P1xP2|P1xP2xP3"),
        &["body[0].lattice.degrees"],
        "Degrees of the splines; control points less one give Bernstein polynomials (Bézier)",
    ),
    option(
        (SURFACE, "control-points", "N1xN2|N1xN2xN3"),
        &["body[0].lattice.control_points"],
        "Control points along x1 and x2 of heights, or along the three coordinates of a lattice",
    ),
    option((SOLVER, "solver", "NAME"), &["solver.kind"], "Contact solver"),
    option((SOLVER, "preconditioner", "NAME"), &["solver.preconditioner"], "Preconditioner of the dual operator"),
    option(
        (SOLVER, "clusters", "N"),
        &["solver.clusters"],
        "Clusters of subdomains (hybrid total FETI); pays in many processes",
    ),
    SceneOption {
        adapt: measured,
        ..option(
            (OBJECTIVE, "objective", "NAME"),
            &["objective.quantity"],
            "What is minimised; pressure-deviation needs the field objective.wanted, open-area and loaded-area objective.pressure, reaction objective.region",
        )
    },
    option(
        (OBJECTIVE, "exponent", "P"),
        &["objective.exponent"],
        "Exponent p of the pressure norm or of the stress norm",
    ),
];

/// The options that commands which optimize take besides.
const OPTIMIZER_OPTIONS: [SceneOption; 5] = [
    option(
        (OPTIMIZER, "optimizer", "NAME"),
        &["optimizer.method"],
        "What proposes trial points: the composite model beside the bundle, or the bundle alone",
    ),
    option(
        (OPTIMIZER, "max-evaluations", "K"),
        &["optimizer.max_evaluations"],
        "Largest number of evaluations of the optimization",
    ),
    option(
        (OPTIMIZER, "time-limit", "SECONDS"),
        &["optimizer.time_limit"],
        "Longest time of this run in seconds; the evaluation under way is finished",
    ),
    option(
        (OPTIMIZER, "continuation", "N1,N2,...|MESH1,MESH2,..."),
        &["optimizer.continuation"],
        "Optimize on growing meshes, with so many bricks along the axis that has most, the others in proportion, or on files beside the scene file, each starting from the last optimum",
    ),
    option(
        (OPTIMIZER, "starts", "K"),
        &["optimizer.starts"],
        "Optimize from so many starts: that of the scene, one that follows the obstacle, then smooth random ones; reports how many agree",
    ),
];

/// An option that gives its value to its fields.
const fn option(
    (heading, name, value_name): (&'static str, &'static str, &'static str),
    fields: &'static [&'static str],
    help: &'static str,
) -> SceneOption {
    let read = |fields: &'static [&'static str], text: &str| fields.iter().map(|f| Setting::read(f, text)).collect();
    SceneOption { name, fields, heading, value_name, help, read, adapt: |file, _, settings| of_bodies(file, settings) }
}

/// Subdomains of the file that do not fit the new mesh give way to those that do.
fn fitting(file: &SceneFile, _: &str, settings: Vec<Setting>) -> Settings {
    let mut settings = of_bodies(file, settings)?;
    settings.extend(unfit_subdomains(&file.with(&settings)?));
    Ok(settings)
}

/// A factor on loads.
fn factor(_: &'static [&'static str], text: &str) -> Settings {
    let finite = |factor: &f64| factor.is_finite();
    match text.parse().ok().filter(finite) {
        Some(_) => Ok(vec![]),
        None => Err(SceneError::out_of_range("--load-factor", text, "a finite number")),
    }
}

/// All loads times the factor in the text, those that load cases state too.
fn loaded(file: &SceneFile, text: &str, mut settings: Vec<Setting>) -> Settings {
    let factor: f64 = text.parse().unwrap_or(f64::NAN);
    let bodies = file.body.iter().enumerate().map(|(number, body)| (format!("body[{number}]"), &body.loads));
    let cases = file.case.iter().enumerate().flat_map(|(case, section)| {
        let own = section.body.iter().enumerate();
        own.filter_map(move |(number, body)| Some((format!("case[{case}].body[{number}]"), body.loads.as_ref()?)))
    });
    for (place, loads) in bodies.chain(cases) {
        for (index, load) in loads.iter().enumerate() {
            scaled(load, factor, &format!("{place}.loads[{index}]"), &mut settings)?;
        }
    }
    Ok(settings)
}

/// The settings that multiply a load.
fn scaled(load: &LoadSection, factor: f64, place: &str, settings: &mut Vec<Setting>) -> Result<(), SceneError> {
    let vectors = [
        ("traction", "MPa", LARGEST_TRACTION, load.traction.as_ref().map(<[f64; 3]>::as_slice)),
        ("pressure", "MPa", LARGEST_TRACTION, load.pressure.as_ref().map(std::slice::from_ref)),
        ("force", "N", LARGEST_FORCE, load.force.as_ref().map(<[f64; 3]>::as_slice)),
        ("moment", "N mm", LARGEST_MOMENT, load.moment.as_ref().map(<[f64; 3]>::as_slice)),
        ("body_force", "N/mm³", LARGEST_TRACTION, load.body_force.as_ref().map(<[f64; 3]>::as_slice)),
    ];
    for (name, unit, largest, vector) in vectors {
        let Some(vector) = vector else { continue };
        let scaled: Vec<f64> = vector.iter().map(|part| factor * part).collect();
        if let Some(axis) = scaled.iter().position(|part| part.abs() > largest) {
            let allowed = format!("|{name}| ≤ {largest:e} {unit}, here {factor:e} times {:e}", vector[axis]);
            return Err(SceneError::out_of_range("--load-factor", format!("{factor:e}"), allowed));
        }
        let value = if name == "pressure" { format!("{:?}", scaled[0]) } else { format!("{scaled:?}") };
        settings.push(Setting::read(&format!("{place}.{name}"), &value)?);
    }
    if let Some(texts) = &load.formula {
        let texts: Vec<String> = texts.iter().map(|text| format!("{factor:?}*({text})")).collect();
        settings.push(Setting::read(&format!("{place}.formula"), &format!("{texts:?}"))?);
    }
    Ok(())
}

/// The details of the file belong to the file's quantity, as its method does.
fn measured(file: &SceneFile, _: &str, settings: Vec<Setting>) -> Settings {
    use QuantityName::{Mass, OpenArea, PeakPressure, PressureDeviation, PressureNorm, RelativeVolume, Volume};
    let quantity = file.with(&settings)?.objective.quantity;
    let has_model =
        matches!(quantity, PressureNorm | PeakPressure | PressureDeviation | OpenArea | Volume | RelativeVolume | Mass);
    let other_method = !has_model && file.optimizer.method == Some(MethodName::Composite);
    let other_quantity = quantity != file.objective.quantity;
    let removals = [(other_quantity, "objective"), (other_method, "optimizer.method")];
    let removals = removals.iter().filter(|(wanted, _)| *wanted).map(|(_, path)| Setting::removal(path));
    Ok(removals.chain(settings).collect())
}

impl SceneOption {
    /// The argument of the parser.
    fn argument(&'static self) -> Arg {
        let argument = Arg::new(self.name)
            .long(self.name)
            .value_name(self.value_name)
            .help_heading(self.heading)
            .help(self.help)
            .allow_negative_numbers(true);
        let names = self.fields.first().map_or_else(Vec::new, |field| choices(field));
        if !names.is_empty() && self.value_name == "NAME" {
            let values = names.into_iter().map(|(name, meaning)| match meaning.is_empty() {
                true => PossibleValue::new(name),
                false => PossibleValue::new(name).help(meaning),
            });
            return argument.value_parser(PossibleValuesParser::new(values));
        }
        argument.value_parser(clap::builder::NonEmptyStringValueParser::new().try_map(
            |text| match self.settings(&text) {
                Ok(_) => Ok(text),
                Err(SceneError::OutOfRange { allowed, .. }) => Err(format!("allowed: {allowed}")),
                Err(other) => Err(other.to_string()),
            },
        ))
    }

    /// Its fields with the values that a text gives them in any scene.
    fn settings(&self, text: &str) -> Settings {
        (self.read)(self.fields, text)
    }
}

/// The options of all commands, or those of the optimizer.
pub fn options(optimizer: bool) -> &'static [SceneOption] {
    static TABLES: [&[SceneOption]; 2] = [&OPTIONS, &OPTIMIZER_OPTIONS];
    TABLES[usize::from(optimizer)]
}

pub fn find(name: &str) -> Option<&'static SceneOption> {
    options(false).iter().chain(options(true)).find(|option| option.name == name)
}

/// The options of [`options`] that a command line has, with their texts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneOptions<const OPTIMIZER: bool>(pub Vec<(&'static str, String)>);

impl<const OPTIMIZER: bool> Args for SceneOptions<OPTIMIZER> {
    fn augment_args(command: Command) -> Command {
        command.args(options(OPTIMIZER).iter().map(SceneOption::argument))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<const OPTIMIZER: bool> FromArgMatches for SceneOptions<OPTIMIZER> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let text =
            |option: &SceneOption| matches.get_one::<String>(option.name).map(|text| (option.name, text.clone()));
        Ok(Self(options(OPTIMIZER).iter().filter_map(text).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl<const OPTIMIZER: bool> SceneOptions<OPTIMIZER> {
    /// The options that have one of some names.
    #[must_use]
    pub fn only(&self, names: &[&str]) -> Self {
        Self(self.0.iter().filter(|(name, _)| names.contains(name)).cloned().collect())
    }
}

/// What a command line changes in a scene.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct SceneChanges {
    #[command(flatten)]
    options: SceneOptions<false>,
    /// Any field of the scene, after the other options, several times: body[0].material.young_modulus=2e5,
    /// body[0].block.bricks=[6,6,3], body[1].loads[0].traction=[0,0,-1500]. --print-scene shows all fields.
    #[arg(long, value_name = "FIELD=VALUE", value_parser = Setting::parse, help_heading = BODIES)]
    set: Vec<Setting>,
}

impl SceneChanges {
    /// The changes with those of the optimizer.
    #[must_use]
    pub fn and(mut self, optimizer: &SceneOptions<true>) -> Self {
        self.options.0.extend_from_slice(&optimizer.0);
        self
    }

    /// Whether an option is given.
    pub fn has(&self, name: &str) -> bool {
        self.options.0.iter().any(|(given, _)| *given == name)
    }

    /// The scene file with the changes; checked further when it becomes a case.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for what no scene may have.
    pub fn apply(&self, mut file: SceneFile) -> Result<SceneFile, SceneError> {
        for (option, text) in self.options.0.iter().filter_map(|(name, text)| find(name).map(|option| (option, text))) {
            let blamed = |error| self.blame(error);
            file = file.with(&(option.adapt)(&file, text, option.settings(text)?).map_err(blamed)?)?;
        }
        if self.set.is_empty() { Ok(file) } else { file.with(&self.set) }
    }

    /// An error in the words of the command line where an option is at fault.
    pub fn blame(&self, error: SceneError) -> SceneError {
        let source = if let SceneError::InFile { source, .. } = &error { source } else { &error };
        let SceneError::OutOfRange { field, value, allowed } = source else { return error };
        let is_of = |own: &&str| field.starts_with(own) || stands_for(own, field);
        let stands_for = |name: &str| find(name).is_some_and(|option| option.fields.iter().any(is_of));
        let set = self.set.iter().find(|setting| field.starts_with(setting.path())).map(|_| format!("--set {field}"));
        let option = || self.options.0.iter().find(|(name, _)| stands_for(name)).map(|(name, _)| format!("--{name}"));
        match set.or_else(option) {
            Some(culprit) => SceneError::out_of_range(culprit, value, allowed),
            None => error,
        }
    }
}

/// Help that says what holds without an option: the field of a scene, or its value in the scene of the binary.
pub fn help_with_defaults(command: Command, scene: Option<&SceneFile>) -> Command {
    let described = |argument: Arg| {
        let Some(field) = find(argument.get_id().as_str()).and_then(|option| option.fields.first()) else {
            return argument;
        };
        let own = |scene: &SceneFile| scene.value(&first_body(scene, field));
        let default = scene.map_or_else(|| format!("{field} of the scene"), own);
        let meaning = argument.get_help().map(ToString::to_string).unwrap_or_default();
        argument.help(format!("{meaning} [default: {default}]"))
    };
    command.mut_args(described).mut_subcommands(|command| command.mut_args(described))
}
