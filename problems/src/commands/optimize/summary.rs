//! The facts of an optimization.

use crate::commands::case_facts;
use crate::commands::facts::{Fact, Facts, Group, Value};
use crate::commands::failure::Failure;
use crate::commands::numbers::{number, raised};
use crate::commands::report::found_label;
use crate::commands::scene_words;
use crate::commands::shape_facts;
use crate::commands::solved_shape::{SolvedShape, solver_facts};
use contact::plausibility::Warning;
use contact::scene::Scene;
use contact::solvers::Usage;
use nonsmooth::{Certificate, IterationRecord, Report, Vector};
use scene_file::CaseScene;
use scene_file::optimization::{ContactRun, ContactStage, Part, Runs, bending_of};
use serde_json::json;

/// One evaluation; its `objective` is null if it failed, its `seconds` count from the start, its `products` are those
/// with the dual operator.
fn course(record: &IterationRecord) -> serde_json::Value {
    let mut entry = json!({
        "evaluation": record.evaluation,
        "objective": record.value,
        "kind": record.kind,
        "origin": record.origin,
        "jacobian": record.jacobian,
        "products": record.work,
        "seconds": record.seconds,
    });
    if let Some(note) = record.note.as_ref().or(record.failure.as_ref()) {
        entry["note"] = note.as_str().into();
    }
    entry
}

/// One of several runs: a mesh of a coarse-to-fine optimization, a start, an attempt.
fn stage(run: &ContactRun) -> serde_json::Value {
    json!({
        "run": run.stage.label.part.folder(),
        "mesh": bricks(&run.stage.objective.solver().problem().scene),
        "objective_start": run.report.start_value,
        "objective": run.report.value,
        "evaluations": run.report.counts.evaluations,
        "seconds": run.report.seconds,
        "termination": ending(&run.report),
    })
}

/// The bricks of the only optimized block, or of the first body; none for a mesh.
fn bricks(scene: &Scene) -> Option<[usize; 3]> {
    let block = scene.shaped_block().map(|(block, _)| block).or_else(|| scene.bodies.first()?.block())?;
    Some(block.bricks)
}

/// How a run ended.
pub fn ending(report: &Report) -> serde_json::Value {
    let termination = &report.termination;
    json!({ "reason": termination, "text": termination.to_string(), "confirmed": report.is_confirmed() })
}

/// Whether the end of a run is confirmed, and if not, why and what to do: a line of its own.
pub fn verdict(report: &Report) -> String {
    let termination = &report.termination;
    match report.is_confirmed() {
        true => termination.to_string().replacen("confirmed", "Confirmed", 1),
        false => format!("Not confirmed: {termination}; {}", report.advice()),
    }
}

/// Difference of Θ beyond which two ends are two optima, relative to Θ where it lies between the next constant and 1
/// times the largest decrease of a run, else to this bound. A Θ that falls to zero, or that carries a constant, has the
/// decrease alone as its scale.
const SAME_OPTIMUM: f64 = 1e-5;
/// Least scale of Θ in largest decreases.
const LEAST_SCALE: f64 = 1e-3;
/// Relative rounding of Θ.
const ROUNDING: f64 = 1e-12;

/// Number of different values of Θ at confirmed ends.
fn optima(runs: &[ContactRun]) -> usize {
    let decrease = runs.iter().map(|run| run.report.start_value - run.report.value).fold(0.0, f64::max);
    // The end of an attempt is none.
    let confirmed = runs.iter().filter(|run| run.report.is_confirmed() && !run.stage.label.part.is_attempt());
    different(confirmed.map(|run| run.report.value).collect(), decrease)
}

/// Number of values that differ by more than runs with this largest decrease resolve.
fn different(mut values: Vec<f64>, decrease: f64) -> usize {
    values.sort_by(f64::total_cmp);
    values.dedup_by(|b, a| {
        let scale = a.abs().clamp(LEAST_SCALE * decrease, decrease);
        (*b - *a).abs() <= SAME_OPTIMUM * scale + ROUNDING * a.abs()
    });
    values.len()
}

/// An optimization that has ended, with what its facts are made of.
pub struct Ended<'a> {
    /// The run that it is reported by: the last mesh, or the best start.
    pub last: &'a ContactRun,
    /// All runs, in order.
    pub runs: &'a Runs,
    /// The shape at the start of the run that it is reported by, or of the first mesh, and the shape found.
    pub shapes: &'a [SolvedShape; 2],
    /// The load cases of the scene.
    pub cases: &'a [CaseScene],
    /// What is implausible about the shape found.
    pub checks: &'a [Warning],
    pub left_out: Vec<&'static str>,
    /// What several processes have used.
    pub processes: Option<Usage>,
}

impl Ended<'_> {
    /// All facts.
    ///
    /// # Errors
    /// [`Failure::Computation`] for a value that has no JSON.
    pub fn facts(&self) -> Result<Facts, Failure> {
        let ContactRun { stage: ContactStage { objective, .. }, report, .. } = self.last;
        let shapes = self.shapes.each_ref();
        let scene = &objective.solver().problem().scene;
        let lead = vec![format!("{}: {}", scene.name, shape_facts::found(objective, shapes)), verdict(report)];
        let mut result = vec![shape_facts::peak_pressure(&shapes)];
        result.extend(shape_facts::limits(&shapes));
        result.extend(self.limits()?);
        result.extend(shape_facts::objective(objective, &shapes).into_iter().map(Fact::without_key));
        result.extend([
            Fact::json("objective_start", &shapes[0].value)?,
            Fact::json("objective", &report.value)?,
            Fact::json("objective_root", &objective.root())?,
            Fact::json("controls", &report.solution.as_slice())?,
        ]);
        let states = shape_facts::states(objective, &shapes, ["kinks.smallest_margin", "kinks.weakly_active"]);
        let columns = vec!["start".to_owned(), found_label(report).to_owned()];
        let pair = |title, facts| Group { title, columns: columns.clone(), facts, words: String::new() };
        let groups = vec![
            pair("", result),
            shape_facts::reports(columns.clone(), &shapes)?,
            self.cases(columns.clone())?,
            Group::new("", scene_words::facts(scene)?),
            self.stages()?,
            self.course()?,
            certificate(report.certificate.as_ref())?,
            pair("States", states),
            self.rest()?,
        ];
        Ok(Facts { lead, groups })
    }

    /// The load cases at both ends.
    fn cases(&self, columns: Vec<String>) -> Result<Group, Failure> {
        let proof = self.last.report.certificate.as_ref().and_then(|certificate| certificate.composite.as_ref());
        case_facts::cases(&self.last.stage.objective, self.cases, (columns, &self.shapes.each_ref()), proof)
    }

    /// What the limits cost; nothing without one.
    fn limits(&self) -> Result<Vec<Fact>, Failure> {
        let ContactRun { stage: ContactStage { objective, .. }, report, .. } = self.last;
        let [start, end] = self.shapes;
        let (mut keys, mut facts) = (Vec::new(), Vec::new());
        for ((found, start), end) in report.constraints.iter().zip(&start.limits).zip(&end.limits) {
            let active = found.multiplier != 0.0;
            let mut own = end.keys();
            own.extend(
                [
                    ("start", json!(start.value)),
                    ("end", json!(end.value)),
                    ("violation", json!(end.excess())),
                    ("satisfied", json!(found.satisfied)),
                    ("active", json!(active)),
                    ("multiplier", json!(found.multiplier)),
                    ("penalty", json!(report.penalty)),
                ]
                .map(|(key, value)| (key.to_owned(), value)),
            );
            let quantity = &end.limit.quantity;
            let unit = if quantity.unit().is_empty() {
                "1 (in the ratio)".into()
            } else {
                format!("one {}", raised(&quantity.unit()))
            };
            let words = match (found.satisfied, active) {
                (false, _) => "violated".to_owned(),
                (true, true) => {
                    let gain = number(found.multiplier.abs());
                    format!("active: {unit} more room would bring {gain} {}", raised(&objective.unit()))
                }
                (true, false) => "not active".to_owned(),
            };
            facts.push(Fact::new("", &format!("at the shape found, {} is", end.words()), words, ""));
            keys.push(own);
        }
        if !keys.is_empty() {
            facts.push(Fact::json("limits", &keys)?);
            let penalty = report.penalty.map_or(Value::Missing, Value::Rough);
            facts.push(Fact::new("", "penalty weight of the limits", penalty, "").detail());
        }
        Ok(facts)
    }

    /// The facts of several runs.
    fn stages(&self) -> Result<Group, Failure> {
        let several =
            || self.runs.ended.iter().filter(|run| run.stage.label.part != Part::Whole || self.runs.ended.len() > 1);
        let fact = |run: &ContactRun| {
            let (report, name) =
                (&run.report, run.stage.label.part.folder().unwrap_or("from the best".into()).replace('_', " "));
            let scene = &run.stage.objective.solver().problem().scene;
            let end = if report.is_confirmed() { "confirmed".to_owned() } else { report.termination.to_string() };
            let values = vec![
                scene_words::mesh(scene).into(),
                report.start_value.into(),
                report.value.into(),
                report.counts.evaluations.into(),
                Value::Rough(report.seconds),
                end.into(),
            ];
            Fact::row("", &name, values, "")
        };
        let mut facts: Vec<Fact> = several().map(fact).collect();
        if several().next().is_some() {
            facts.push(Fact::json("stages", &several().map(stage).collect::<Vec<_>>())?);
        }
        let columns = ["mesh", "Θ at its start", "Θ at its end", "evaluations", "seconds", "ended"].map(str::to_owned);
        let words = "Pictures, course and certificate are those of the last mesh, of the best start, or of the last run from the best \
                     attempt. The result compares the best of several starts or attempts with its own start, and the last of \
                     several meshes with the start on the first.";
        Ok(Group { title: "Runs", columns: columns.into(), facts, words: words.into() })
    }

    /// The facts of the course.
    fn course(&self) -> Result<Group, Failure> {
        let ContactRun { report, replayed, .. } = self.last;
        let (counts, trials) = (&report.counts, &report.counts.trials);
        let first = report.history.first().map_or(0.0, |record| record.seconds);
        let slowest = report.history.windows(2).map(|pair| pair[1].seconds - pair[0].seconds).fold(first, f64::max);
        let all: f64 = self.runs.ended.iter().map(|run| run.report.seconds).sum();
        let count = |key, name: &str, count: usize| Fact::new(key, name, count, "").detail();
        let mut facts = vec![
            Fact::new("evaluations", "evaluations", counts.evaluations, "").meaning(
                "a contact problem with a subgradient each; a failed one could not be computed and shortened the step",
            ),
            Fact::new("seconds", "time of the whole run", all, "s"),
            Fact::new("", "constraints attained", active_constraints(self.last), ""),
            Fact::json("states", &counts.evaluations)?,
            count("jacobians", "Jacobians", counts.jacobians),
            count("serious_steps", "serious steps", counts.serious),
            count("null_steps", "null steps", counts.null),
            count("", "refined evaluations", counts.refined),
            count("", "failed evaluations", counts.failed),
            count("", "restarts", counts.restarts),
            count("", "trial points: cuts", trials.cuts),
            count("", "trial points: curved model", trials.curved_model),
            count("", "trial points: composite model", trials.composite_model),
            count("", "trial points: confirmation", trials.confirmation),
            count("", "subproblems", counts.qp_solves),
            count("", "of these, fallback solver", counts.qp_fallbacks),
            count("resumed_evaluations", "evaluations from the journal", *replayed),
            Fact::new("", "mean evaluation", report.seconds / counts.evaluations.max(1) as f64, "s").detail(),
            Fact::new("", "longest evaluation", slowest, "s").detail(),
            Fact::new(
                "largest_constraint_violation",
                "constraint violation",
                Value::Rough(report.largest_violation),
                "",
            )
            .meaning("largest relative violation of a point evaluated")
            .detail(),
            Fact::json("termination", &ending(report))?,
            Fact::json("course", &report.history.iter().map(course).collect::<Vec<_>>())?,
        ];
        facts.extend(self.ways());
        if self.runs.ended.iter().filter(|run| run.stage.label.part != Part::Whole).count() > 1 {
            facts.push(
                Fact::new("optima", "different optima", optima(&self.runs.ended), "")
                    .meaning("different values of Θ at confirmed ends of the runs"),
            );
        }
        if self.runs.ended.len() < self.runs.asked {
            facts.push(Fact::new("", "runs begun", format!("{} of {}", self.runs.ended.len(), self.runs.asked), ""));
        }
        Ok(Group::new("Course of the optimization", facts).with_words(verdict(report) + "."))
    }

    /// How attempts agree, and what fairness has changed.
    fn ways(&self) -> Vec<Fact> {
        let mut facts = Vec::new();
        if let Some([agreeing, all]) = self.runs.agreement(self.last.report.value) {
            let words = format!("{agreeing} of {all}");
            let meaning = "short runs with all controls, with a coarse net of controls and from other starts, those that came within \
                           3 % of the Θ found; the whole run begins at the best of them";
            facts.push(Fact::new("attempts", "attempts that agree", words, "").meaning(meaning));
            facts.push(Fact::new("all_evaluations", "evaluations of all runs", self.runs.evaluations(), ""));
        }
        let ContactRun { stage: ContactStage { label, objective, .. }, report, .. } = self.last;
        if let (Some(before), Ok(after)) = (label.bending_before, bending_of(objective, &report.solution)) {
            let words = format!("{} -> {}", number(before), number(after));
            let meaning = "of shapes that are as good, the one that bends least was taken: controls that the objective does not see are \
                           smooth";
            facts.push(Fact::new("bending", "bending", words, "").meaning(meaning));
        }
        facts
    }

    /// Solver, warnings, and what was left out.
    fn rest(&self) -> Result<Group, Failure> {
        let mut facts = solver_facts(self.shapes[1].state())?;
        let warnings = all_warnings(&self.last.report, self.checks);
        facts.extend(closing_facts(&warnings, &self.left_out, self.processes.as_ref())?);
        Ok(Group::new("", facts))
    }
}

/// The constraints of the shape that the solution of a run attains, in words.
fn active_constraints(run: &ContactRun) -> String {
    /// As many constraints as a line holds.
    const MAX_NAMED_CONSTRAINTS: usize = 3;
    let active = run.stage.objective.solver().problem().admissible.active(&run.report.solution);
    match active.len() {
        0 => "no constraint of the shape".into(),
        count if count > MAX_NAMED_CONSTRAINTS => {
            let named = active[..MAX_NAMED_CONSTRAINTS].join("; ");
            format!("{named}; {} more", count - MAX_NAMED_CONSTRAINTS)
        }
        _ => active.join("; "),
    }
}

/// The facts of the certificate; its cuts go to a file.
fn certificate(certificate: Option<&Certificate>) -> Result<Group, Failure> {
    let title = "Certificate";
    let Some(certificate) = certificate else {
        let none = Fact::json("certificate", &None::<()>)?;
        return Ok(Group::new(title, vec![none]));
    };
    let active = |multipliers: &Vector| multipliers.iter().filter(|multiplier| **multiplier != 0.0).count();
    let rough = |key, name, value| Fact::new(key, name, Value::Rough(value), "").detail();
    let count = |key, name, count: usize| Fact::new(key, name, count, "").detail();
    let facts = vec![
        rough("certificate.aggregate_norm", "aggregate subgradient", certificate.aggregate_norm)
            .meaning("its norm; it vanishes at a stationary point, as the aggregate error does"),
        rough("certificate.aggregate_error", "aggregate error", certificate.aggregate_error),
        rough("certificate.predicted_decrease", "predicted decrease", certificate.predicted_decrease)
            .meaning("what the model still hopes for"),
        count("certificate.active_cuts", "active cuts", certificate.active_cuts().count()),
        rough("certificate.active_radius", "radius of active cuts", certificate.active_radius),
        count("certificate.active_rows", "active rows", active(&certificate.row_multipliers)),
        count("certificate.active_bounds", "active bounds", active(&certificate.bound_multipliers)),
        rough("certificate.noise", "noise", certificate.noise),
        rough("", "weight", certificate.weight),
        rough("", "curvature added", certificate.convexification),
        rough("", "predicted decrease/Θ", certificate.predicted_decrease / certificate.value.abs()),
    ];
    let words = "certificate.json holds all cuts and multipliers, from which the command recheck computes norm and error again.";
    Ok(Group::new(title, facts).with_words(words))
}

/// What stands last: warnings, a line each and as a list, what was left out, and what several processes have used.
pub fn closing_facts(warnings: &[Warning], left_out: &[&str], usage: Option<&Usage>) -> Result<Vec<Fact>, Failure> {
    let lines = warnings.iter().map(|warning| Fact::new("", "warning", warning.to_string(), ""));
    let mut facts: Vec<Fact> = lines.collect();
    facts.push(Fact::json("warnings", &warnings)?);
    facts.push(Fact::object("left_out", "left out", &left_out, left_out.join("; "))?.detail());
    if let Some(usage) = usage {
        facts.push(Fact::object("processes", "processes", usage, usage.to_string())?);
    }
    Ok(facts)
}

/// The warnings of the optimizer and those about the final state.
pub fn all_warnings(report: &Report, checks: &[Warning]) -> Vec<Warning> {
    let own = report.warnings.iter().map(|text| match text.strip_prefix("plateau: ") {
        Some(text) => Warning { code: "plateau", text: text.to_owned() },
        None => Warning { code: "optimizer", text: text.clone() },
    });
    own.chain(checks.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn optima_are_told_apart_on_the_scale_of_their_decrease() {
        for (values, decrease, expected) in [
            (vec![1.0, 1.0 + 1e-7, 1.1], 10.0, 2),
            // Deviations that vanish up to rounding.
            (vec![1e-14, 3e-12, 0.0], 1.0, 1),
            (vec![0.0, 1e-4], 1.0, 2),
            // Two ends that a large constant would hide.
            (vec![1e6, 1e6 + 0.5], 1.0, 2),
            (vec![-1e-9, 1e-9], 5.0, 1),
            // Nothing can be gained, and values are equal up to rounding.
            (vec![7.0, 7.0 * (1.0 + 1e-15)], 0.0, 1),
            (vec![], 0.0, 0),
        ] {
            for unit in [1e-20, 1.0, 1e20] {
                let scaled = values.iter().map(|value| unit * value).collect();
                assert_eq!(different(scaled, unit * decrease), expected, "{values:?} in units of {unit:e}");
            }
        }
    }
}
