//! Facts about the load cases of shapes: measures, forces on the bodies, reactions of supports, largest stresses.

use crate::commands::arguments::Arguments;
use crate::commands::facts::{Fact, Group, Value};
use crate::commands::failure::Failure;
use crate::commands::numbers::{number, raised};
use crate::commands::output::notice;
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use contact::equilibrium::Preview;
use contact::fields::Resultants;
use contact::load_cases::Over;
use nonsmooth::CompositeProof;
use scene_file::CaseScene;
use serde_json::{Map, json};

/// What the words of the table say of cases.
const INDEPENDENT: &str = "Cases are independent states under one loading each, not a history: each begins with bodies at rest. The \
                           multiplier of a case is its share in the optimum: without the cases whose multiplier is 0, the shape would be \
                           optimal too.";

/// Says on stderr, before any solve, how the bodies of every case lie and what holds them.
pub fn announce(objective: &ContactObjective, arguments: &Arguments) {
    for case in (0..objective.cases().count()).filter(|_| arguments.verbose) {
        let name = Some(objective.cases().name(case)).filter(|name| !name.is_empty());
        let lead = name.map_or_else(String::new, |name| format!("case \"{name}\": "));
        notice(&format!("{lead}{}", before(&objective.cases().case(case).problem().preview())));
    }
}

/// Gaps and supports in words.
pub fn before(preview: &Preview) -> String {
    let [least, largest] = preview.gaps.map(number);
    let mut words = match preview.overlapping {
        0 => format!("initial gaps {least} to {largest} mm"),
        count => format!("initial gaps {least} to {largest} mm, {count} of {} nodes overlap", preview.contact_nodes),
    };
    for body in &preview.bodies {
        let held = if body.held_faces.is_empty() { "nothing".to_owned() } else { body.held_faces.join(", ") };
        let free = match body.free_motions {
            0 => String::new(),
            1 => ", 1 rigid motion left free".into(),
            count => format!(", {count} rigid motions left free"),
        };
        words += &format!("; {} held at {held}{free}, load {} N", body.name, vector(body.load));
    }
    words
}

fn vector(vector: [f64; 3]) -> String {
    format!("({})", vector.map(number).join(", "))
}

/// The cases of some shapes: a table, and the list `cases` in JSON for the last shape. `proof`: that of an
/// optimization.
pub fn cases(
    objective: &ContactObjective,
    scenes: &[CaseScene],
    (labels, shapes): (Vec<String>, &[&SolvedShape]),
    proof: Option<&CompositeProof>,
) -> Result<Group, Failure> {
    let Some(last) = shapes.last() else { return Ok(Group::new("", Vec::new())) };
    let multipliers = proof.and_then(|proof| multipliers(objective, proof));
    let several = scenes.len() > 1;
    let weighted: Vec<Vec<f64>> = shapes.iter().map(|shape| objective.weighted_values(&shape.states)).collect();
    let (mut facts, mut list) = (Vec::new(), Vec::new());
    for (case, scene) in scenes.iter().enumerate() {
        let resultants = shapes.iter().map(|shape| objective.cases().case(case).resultants(&shape.states[case]));
        let resultants = resultants.collect::<Result<Vec<_>, _>>()?;
        let multiplier = multipliers.as_ref().map(|multipliers| multipliers[case]);
        let own: Vec<f64> = weighted.iter().map(|values| values[case]).collect();
        let rows = rows(objective, (scene, case), shapes, &own, &resultants, multiplier);
        facts.extend(rows.into_iter().map(|fact| if several { fact } else { fact.detail() }));
        list.push(object(
            objective,
            (scene, case),
            last,
            own[own.len() - 1],
            &resultants[resultants.len() - 1],
            multiplier,
        )?);
    }
    facts.push(Fact::json("cases", &list)?);
    let (title, words) = if several { ("Load cases", INDEPENDENT) } else { ("Forces and stresses", "") };
    Ok(Group { title, columns: labels, facts, words: words.into() })
}

/// The rows of one case.
fn rows(
    objective: &ContactObjective,
    (scene, case): (&CaseScene, usize),
    shapes: &[&SolvedShape],
    weighted: &[f64],
    resultants: &[Resultants],
    multiplier: Option<f64>,
) -> Vec<Fact> {
    let name = |what: &str| match scene.name.as_str() {
        "" => what.to_owned(),
        name => format!("{name}: {what}"),
    };
    let row = |what: &str, unit: &str, values: Vec<Value>| Fact::row("", &name(what), values, unit);
    let mut facts = Vec::new();
    if !scene.name.is_empty() {
        let weight = if scene.weight == 1.0 { String::new() } else { format!("{} × ", number(scene.weight)) };
        let measure = format!("{weight}measure");
        facts.push(row(&measure, &raised(&objective.unit()), weighted.iter().map(|value| (*value).into()).collect()));
        let peaks = shapes.iter().map(|shape| shape.peak_of(objective, case).into()).collect();
        facts.push(row("peak contact pressure", "MPa", peaks));
        if let Some(multiplier) = multiplier {
            facts.push(Fact::new("", &name("multiplier"), Value::Rough(multiplier), ""));
        }
    }
    let stress = |resultants: &Resultants| {
        let largest = resultants.largest_stress.as_ref();
        let body = |body: usize| resultants.bodies.get(body).map_or("", |body| body.body.as_str());
        largest.map_or(Value::Missing, |found| {
            format!("{} in {} at {}", number(found.value), body(found.body), vector(found.place)).into()
        })
    };
    facts.push(row("largest von Mises stress", "MPa", resultants.iter().map(stress).collect()));
    let Some(first) = resultants.first() else { return facts };
    for (index, body) in first.bodies.iter().enumerate() {
        let contact = resultants.iter().map(|found| vector(found.bodies[index].contact).into()).collect();
        facts.push(row(&format!("contact force on {}", body.body), "N", contact).detail());
        for (place, support) in body.supports.iter().enumerate() {
            let force = |found: &Resultants| vector(found.bodies[index].supports[place].force).into();
            let what = format!("reaction of {} at {}", body.body, support.face);
            facts.push(row(&what, "N", resultants.iter().map(force).collect()).detail());
        }
        let held = |found: &Resultants| found.bodies[index].friction_of_held;
        if resultants.iter().any(|found| held(found) > 0.0) {
            let what = format!("friction on {} along held directions, in no sum, at most", body.body);
            facts.push(row(&what, "N", resultants.iter().map(|found| held(found).into()).collect()).detail());
        }
    }
    facts
}

/// A case as an object of JSON.
fn object(
    objective: &ContactObjective,
    (scene, case): (&CaseScene, usize),
    shape: &SolvedShape,
    weighted: f64,
    resultants: &Resultants,
    multiplier: Option<f64>,
) -> Result<Map<String, serde_json::Value>, Failure> {
    let failed = |error: serde_json::Error| Failure::Computation(error.to_string());
    let forces = &shape.states[case].forces;
    let counts = forces.counts();
    let before = objective.cases().case(case).problem().preview();
    Ok(Map::from_iter([
        ("name".to_owned(), json!(scene.name)),
        ("equal".to_owned(), json!(scene.equal)),
        ("weight".to_owned(), json!(scene.weight)),
        ("weighted_measure".to_owned(), json!(weighted)),
        ("multiplier".to_owned(), json!(multiplier)),
        ("peak_pressure".to_owned(), json!(shape.peak_of(objective, case))),
        ("total_normal_force".to_owned(), json!(forces.total_normal_force())),
        ("status".to_owned(), json!({ "open": counts.open, "stick": counts.stick, "slip": counts.slip })),
        ("residual".to_owned(), json!(forces.residuals.largest())),
        ("resultants".to_owned(), serde_json::to_value(resultants).map_err(failed)?),
        ("before".to_owned(), serde_json::to_value(before).map_err(failed)?),
    ]))
}

/// What every case contributes to the certificate of an optimization over the worst case: the multipliers of its cuts.
fn multipliers(objective: &ContactObjective, proof: &CompositeProof) -> Option<Vec<f64>> {
    let (cost, count) = (objective.cost(), objective.cases().count());
    if cost.over() != Over::Worst || count == 1 {
        return None;
    }
    let mut found = vec![0.0; count];
    for cut in &proof.cuts {
        if let Some(case) = cost.case_of(&cut.subgradient) {
            found[case] += cut.multiplier;
        }
    }
    Some(found)
}
