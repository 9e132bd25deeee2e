//! Facts about solved shapes: objective, peak pressure, and how far the contact states can be trusted.

use crate::commands::facts::{Fact, Group, Value};
use crate::commands::failure::Failure;
use crate::commands::numbers::{number, plain_unit, raised, reduction};
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::contact_objective::PressureRoot;
use contact::cost::Reported;
use serde_json::{Map, json};

/// Decrease of Θ, relative to Θ, up to which a shape is no better than another.
const NO_DECREASE: f64 = 1e-9;

/// The largest contact pressure.
pub fn peak_pressure(shapes: &[&SolvedShape]) -> Fact {
    row("peak_pressure", "peak contact pressure", "MPa", shapes, &|shape| shape.peak_pressure.into())
}

/// Whether the shapes keep their limits: a row for each.
pub fn limits(shapes: &[&SolvedShape]) -> Vec<Fact> {
    let count = shapes.first().map_or(0, |shape| shape.limits.len());
    let row = |index: usize| {
        let values: Vec<Value> = shapes.iter().map(|shape| shape.limits[index].verdict()).collect();
        Fact::row("", &format!("limit: {}", shapes[0].limits[index].words()), values, "")
    };
    (0..count).map(row).collect()
}

/// The quantities that the scene reports: a row for each, and the list `reports` in JSON.
///
/// # Errors
/// [`Failure::Computation`] for a value that has no JSON.
pub fn reports(labels: Vec<String>, shapes: &[&SolvedShape]) -> Result<Group, Failure> {
    let Some(last) = shapes.last().filter(|shape| !shape.reports.is_empty()) else {
        return Ok(Group::new("", Vec::new()));
    };
    let row = |(index, (report, _)): (usize, &(Reported, f64))| {
        let values = shapes.iter().map(|shape| shape.reports[index].1.into()).collect();
        Fact::row("", &report.title(), values, &raised(&report.quantity.unit()))
    };
    let mut facts: Vec<Fact> = last.reports.iter().enumerate().map(row).collect();
    let object = |(index, (report, _)): (usize, &(Reported, f64))| {
        let values: Vec<f64> = shapes.iter().map(|shape| shape.reports[index].1).collect();
        let mut keys = Map::from_iter([
            ("quantity".to_owned(), json!(report.quantity.name())),
            ("unit".to_owned(), json!(plain_unit(&report.quantity.unit()))),
        ]);
        keys.extend(report.label.iter().map(|label| ("label".to_owned(), json!(label))));
        keys.extend(report.case.iter().map(|case| ("case".to_owned(), json!(case))));
        if let [start, .., _] = values[..] {
            keys.insert("start".to_owned(), json!(start));
        }
        keys.insert("end".to_owned(), json!(values.last()));
        keys
    };
    let list: Vec<_> = last.reports.iter().enumerate().map(object).collect();
    facts.push(Fact::json("reports", &list)?);
    Ok(Group { title: "Reports", columns: labels, facts, words: String::new() })
}

/// Θ of the shapes, and the root of a sum of powers of pressures, a pressure that can be compared.
pub fn objective(objective: &ContactObjective, shapes: &[&SolvedShape]) -> Vec<Fact> {
    let value = row("objective", "objective Θ", &raised(&objective.unit()), shapes, &|shape| shape.value.into());
    let root = objective.pressure_root(0.0).map(|PressureRoot { name, .. }| {
        let root = |shape: &SolvedShape| objective.pressure_root(shape.value).map(|root| root.value).into();
        row("", &raised(&name), "MPa", shapes, &root)
            .meaning("the root of Θ; a shape of uniform pressure has it in proportion to the pressure")
    });
    std::iter::once(value).chain(root).collect()
}

/// The bound of the objective, the force, the numbers of nodes per status, and residuals. `kinks`: the names in JSON of
/// the two facts on the nearest kink.
pub fn states(objective: &ContactObjective, shapes: &[&SolvedShape], kinks: [&'static str; 2]) -> Vec<Fact> {
    let force = |shape: &SolvedShape| shape.state().forces.total_normal_force();
    let bound = |shape: &SolvedShape| objective.lower_bound(&shape.states);
    let above_zero = |shape: &SolvedShape| bound(shape).filter(|bound| *bound > 0.0);
    let row = |key, name, unit: &str, value: &dyn Fn(&SolvedShape) -> Value| row(key, name, unit, shapes, value);
    let rough =
        |key, name, value: fn(&SolvedShape) -> f64| row(key, name, "", &|shape| Value::Rough(value(shape))).detail();
    let mut facts = vec![row("total_normal_force", "total normal force", "N", &|shape| force(shape).into())];
    if shapes.iter().any(|shape| bound(shape).is_some()) {
        facts.push(
            row("", "least objective for this total force", &raised(&objective.unit()), &|shape| bound(shape).into())
                .meaning("no shape that carries the same total force over the same contact nodes is below it")
                .detail(),
        );
        let over = |shape: &SolvedShape| above_zero(shape).map(|bound| shape.value / bound).into();
        facts.push(row("", "Θ over that", "", &over).detail());
    }
    facts.extend([
        row("status.open", "open contact nodes", "", &|shape| shape.state().forces.counts().open.into()),
        row("status.stick", "sticking contact nodes", "", &|shape| shape.state().forces.counts().stick.into()),
        row("status.slip", "slipping contact nodes", "", &|shape| shape.state().forces.counts().slip.into()),
        rough("residuals.equilibrium", "residual: equilibrium", |shape| shape.state().forces.residuals.equilibrium)
            .meaning("this residual and the next four are relative to the load"),
        rough("residuals.complementarity", "residual: complementarity", |shape| {
            shape.state().forces.residuals.complementarity
        }),
        rough("residuals.friction_cone", "residual: friction cone", |shape| {
            shape.state().forces.residuals.friction_cone
        }),
        rough("residuals.dissipation", "residual: dissipation", |shape| shape.state().forces.residuals.dissipation),
        rough("residuals.newton", "residual: Newton", |shape| shape.state().forces.residuals.newton),
        rough(kinks[0], "margin of the nearest kink", |shape| shape.state().forces.kink.smallest_margin)
            .meaning("relative distance of a contact node from a change between open, stick and slip"),
        row(kinks[1], "weakly active nodes", "", &|shape| shape.state().forces.kink.weakly_active.into()).detail(),
    ]);
    facts
}

/// A fact with a value per shape.
fn row(
    key: &'static str,
    name: &str,
    unit: &str,
    shapes: &[&SolvedShape],
    value: &dyn Fn(&SolvedShape) -> Value,
) -> Fact {
    Fact::row(key, name, shapes.iter().map(|shape| value(shape)).collect(), unit)
}

/// Whether the second value of Θ is less than the first by more than rounding.
pub fn is_better(start: f64, end: f64) -> bool {
    start - end > NO_DECREASE * start.abs()
}

/// What was found between a start and an end, in a sentence: first the peak pressure, then the objective.
pub fn found(objective: &ContactObjective, [start, end]: [&SolvedShape; 2]) -> String {
    let root = |shape: &SolvedShape| objective.pressure_root(shape.value);
    let (name, values, of) = match (root(start), root(end)) {
        (Some(first), Some(second)) => (raised(&first.name), [first.value, second.value], "MPa".into()),
        _ => ("objective Θ".into(), [start.value, end.value], raised(&objective.unit())),
    };
    let peaks = [start.peak_pressure, end.peak_pressure];
    let violated = end.limits.iter().filter(|limit| limit.excess() > 0.0);
    let violated: Vec<String> = violated
        .map(|limit| format!("{} is {} instead of {}", limit.limit.quantity.name(), number(limit.value), limit.words()))
        .collect();
    if !violated.is_empty() {
        return format!("NO shape within the limits was found: {}", violated.join("; "));
    }
    if !start.keeps_limits() {
        let (peak, value) = (changed(peaks, "MPa"), changed(values, &of));
        return format!("a shape within the limits was found: peak pressure {peak}; {name} {value}");
    }
    if is_better(start.value, end.value) {
        let (peak, value) = (changed(peaks, "MPa"), changed(values, &of));
        return format!("a better shape was found: peak pressure {peak}; {name} {value}");
    }
    format!(
        "no better shape was found than the start: peak pressure {} MPa; {name} {} {of}",
        number(end.peak_pressure),
        number(values[1])
    )
}

/// "12 -> 3 MPa, 4.00 times less"
fn changed([start, end]: [f64; 2], unit: &str) -> String {
    let times = match reduction(start, end) {
        Some(ratio) if ratio >= 1.0 => format!(", {ratio:.2} times less"),
        Some(ratio) => format!(", {:.2} times more", 1.0 / ratio),
        None => String::new(),
    };
    format!("{} -> {} {unit}{times}", number(start), number(end))
}
