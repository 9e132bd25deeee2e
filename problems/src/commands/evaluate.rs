//! `evaluate`: objective, subgradient and certificates at one shape.

use crate::commands::case_facts;
use crate::commands::controls;
use crate::commands::facts::{Fact, Facts, Group, Value};
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json, printed_with_files};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::numbers::{number, plain_unit, raised};
use crate::commands::optimize::summary::closing_facts;
use crate::commands::report::files;
use crate::commands::scene_words;
use crate::commands::shape_facts;
use crate::commands::solved_shape::{self, ContactObjective, SolvedShape, checks, solver_facts};
use contact::contact_objective::PressureRoot;
use contact::contact_shape::ContactState;
use nonsmooth::Evaluation;
use serde_json::json;
use std::time::Instant;

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let (objective, arguments) = (&solved_shape::objective(&loaded.case, &session.processes)?, session.arguments);
    let solver = objective.solver();
    let controls = controls::load(solver.problem(), &loaded.case, ("--controls", arguments.shape.controls.as_deref()))?;
    let controls = controls::as_made(controls, &arguments.error);
    case_facts::announce(objective, arguments);
    let folder = Folder::of_command(&loaded.case, arguments)?;
    let clock = Instant::now();
    let abandon = |_: &Failure| folder.iter().for_each(Folder::abandon);
    let shape = SolvedShape::at(objective, &controls).inspect_err(abandon)?;
    let state_seconds = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let evaluation = objective.differentiate(&controls, &shape.states).map_err(Failure::from).inspect_err(abandon)?;
    let subgradient_seconds = clock.elapsed().as_secs_f64();
    let result = result(objective, &shape, &evaluation)?;
    let warnings = checks(objective, &shape, arguments)?;
    let states = shape_facts::states(objective, &[&shape], ["kink.smallest_margin", "kink.weakly_active"]);
    let diagnosis = arguments
        .diagnosis
        .diagnose
        .then(|| objective.cases().case(shape.worst).diagnose(shape.state()))
        .transpose()?;
    let mut rest = solver_facts(shape.state())?;
    rest.extend(work(shape.state(), [state_seconds, subgradient_seconds])?);
    rest.push(match diagnosis {
        Some(diagnosis) => Fact::object("diagnosis", "diagnosis", &diagnosis, diagnosis.to_string())?,
        None => Fact::json("diagnosis", &None::<()>)?,
    });
    let usage = session.processes.usage(shape.state().solver)?;
    rest.extend(closing_facts(&warnings, &arguments.left_out(solver), usage.as_ref())?);
    let cases = case_facts::cases(objective, &loaded.case.cases, (vec![], &[&shape]), None)?;
    let scene = Group::new("", scene_words::facts(&solver.problem().scene)?);
    let reports = shape_facts::reports(vec![], &[&shape])?;
    let groups =
        vec![Group::new("", result), reports, scene, cases, Group::new("State", states), Group::new("Work", rest)];
    let facts = Facts { lead: lead(objective, &shape), groups };
    let object = json(&facts)?;
    let write =
        |folder: &Folder| files::write_evaluation(folder, loaded, objective, &shape, (&facts, &object), &warnings);
    let printed = arguments.printed(facts.text(arguments.verbose), object.clone());
    printed_with_files(printed, arguments.json, folder.as_ref(), write)
}

/// Θ and its subgradient with the areas in contact.
fn result<W>(
    objective: &ContactObjective,
    shape: &SolvedShape,
    evaluation: &Evaluation<W>,
) -> Result<Vec<Fact>, Failure> {
    let root = objective.root();
    // The norm of a root r is s r^p, with the derivative s p r^{p−1} ∂r.
    let (size, norm_unit) = objective.norm_of_root().unwrap_or_else(|| (1.0, objective.unit()));
    let (power, slope) = (size * evaluation.value.powf(root), size * root * evaluation.value.powf(root - 1.0));
    let representable = power.is_normal() && (slope * evaluation.subgradient.amax()).is_finite();
    let (value, slope, objective_root) =
        if representable { (power, slope, 1.0) } else { (evaluation.value, 1.0, root) };
    let subgradient = &evaluation.subgradient * slope;
    // Squares of entries above 1e154 are no doubles.
    let largest = subgradient.amax().max(f64::MIN_POSITIVE);
    let unit = if objective_root == root { objective.unit() } else { norm_unit };
    let limits = shape.limits.iter().map(|limit| {
        let mut keys = limit.keys();
        keys.extend([("end".to_owned(), json!(limit.value)), ("violation".to_owned(), json!(limit.excess()))]);
        keys
    });
    let limits: Vec<_> = limits.collect();
    let mut result = vec![
        shape_facts::peak_pressure(&[shape]),
        Fact::json("limits", &limits)?,
        Fact::new("objective", "objective Θ", value, &raised(&unit)),
        Fact::json("objective_unit", &plain_unit(&unit))?,
        Fact::json("objective_root", &objective_root)?,
    ];
    result.extend(shape_facts::limits(&[shape]));
    result.extend(shape_facts::objective(objective, &[shape]).into_iter().skip(1));
    let logarithm = (evaluation.value > 0.0).then(|| size.log10() + root * evaluation.value.log10());
    result.extend([
        Fact::new("log10_objective", "log10 of Θ", logarithm, "").detail(),
        Fact::new("", "norm of subgradient", largest * (&subgradient / largest).norm(), ""),
        Fact::json("subgradient", &subgradient.as_slice())?,
    ]);
    Ok(result)
}

/// What an engineer asks of a shape, in two lines: how it is loaded, and what is in contact.
fn lead(objective: &ContactObjective, shape: &SolvedShape) -> Vec<String> {
    let counts = shape.state().forces.counts();
    let value = |root: PressureRoot| format!("{} {} MPa", raised(&root.name), number(root.value));
    let plain = || format!("objective Θ {} {}", number(shape.value), raised(&objective.unit()));
    let value = objective.pressure_root(shape.value).map_or_else(plain, value);
    let name = &objective.solver().problem().scene.name;
    let violated = if shape.keeps_limits() { "" } else { "; a limit is VIOLATED" };
    vec![
        format!("{name}: peak pressure {} MPa; {value}{violated}", number(shape.peak_pressure)),
        format!("contact nodes: {} open, {} stick, {} slip", counts.open, counts.stick, counts.slip),
    ]
}

fn work(state: &ContactState, [of_state, of_subgradient]: [f64; 2]) -> Result<Vec<Fact>, Failure> {
    let work = state.work();
    let words = format!(
        "{} Newton steps, {} products with the dual operator ({} for the adjoint), {} factorisations",
        work.newton_steps, work.dual_operator_applications, work.adjoint_applications, work.factorizations
    );
    let contraction = Fact::new("contraction", "contraction", state.contraction, "")
        .meaning("contraction factor seen by the successive approximations; none for the other solvers")
        .detail();
    let mut facts = vec![Fact::object("work", "work", &work, words)?.detail(), contraction];
    if work.fixed_point_steps > 0 {
        let words = format!(
            "{} Tresca problems, {} cg, {} expansion, {} proportioning steps",
            work.fixed_point_steps, work.cg_steps, work.expansion_steps, work.proportioning_steps
        );
        facts.push(Fact::new("", "dual QPs", words, "").detail());
    }
    facts.extend([
        Fact::new("seconds.state", "time of the state", Value::Rough(of_state), "s").detail(),
        Fact::new("seconds.subgradient", "time of subgradient", Value::Rough(of_subgradient), "s").detail(),
    ]);
    Ok(facts)
}
