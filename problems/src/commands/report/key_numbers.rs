//! The key numbers of shapes, side by side with their change.

use crate::commands::facts::{Fact, Group};
use crate::commands::numbers::raised;
use crate::commands::report::gallery::ShownShape;
use crate::commands::scene_words;
use crate::commands::shape_facts;
use crate::commands::solved_shape::ContactObjective;
use contact::deformation::Deformation;
use contact::fields::Fields;
use figures::page::{Block, Section};

/// The key numbers of shapes that have fields; friction work only where there is friction.
pub fn key_numbers<'s, 'o: 's>(
    objective: &ContactObjective,
    shapes: impl IntoIterator<Item = &'s ShownShape<'o>>,
) -> Group {
    let seen: Vec<(&ShownShape<'_>, &Fields)> =
        shapes.into_iter().filter_map(|shape| Some((shape, shape.fields.as_ref()?))).collect();
    let row = |key: &'static str, quantity: &str, unit: &str, value: &dyn Fn(&ShownShape<'_>, &Fields) -> f64| {
        Fact::row(key, quantity, seen.iter().map(|(shape, fields)| value(shape, fields).into()).collect(), unit)
    };
    let area = |fields: &Fields| fields.contact.area.iter().sum::<f64>();
    let mut facts = measures(objective, &seen, &row);
    facts.extend([
        row("mean_pressure", "mean pressure over the whole contact surface", "MPa", &|shape, fields| {
            shape.state().forces.total_normal_force() / area(fields)
        }),
        row("contact_area", "contact area (nodes that are closed)", "mm²", &|shape, _| {
            shape.state().rows.closed_area(&shape.state().forces.status)
        }),
        row("peak_von_mises_at_centres", "von Mises stress at cell centres, peak", "MPa", &|_, fields| {
            largest(fields.bodies.iter().flat_map(|body| &body.von_mises))
        })
        .meaning("stresses at the centres of cells converge with the square of the mesh size"),
        row("peak_von_mises_at_nodes", "von Mises stress averaged at nodes, peak", "MPa", &|_, fields| {
            largest(fields.bodies.iter().flat_map(|body| &body.nodal_von_mises))
        })
        .meaning(
            "the mean over the cells that share the node, as in the picture; it is never above the peak at a centre, and equals it where \
             the cell of the peak has a node of its own, at a corner of a body",
        ),
        row("largest_displacement", "largest displacement", "mm", &|_, fields| deformation(fields).displacement),
        row("largest_strain", "largest principal strain (modulus, at cell centres)", "%", &|_, fields| {
            100.0 * deformation(fields).strain
        }),
    ]);
    let scene = &objective.solver().problem().scene;
    for (number, body) in scene.bodies.iter().enumerate() {
        // The body of a mesh alone has always been the lower one here.
        let (name, stem) = match body.name.as_str() {
            "body" => ("lower", "lower".to_owned()),
            name => (name, scene_words::stem(scene, number)),
        };
        let volumes = seen.iter().map(|(_, fields)| {
            let body = &fields.bodies[number];
            body.mesh.volume(&body.positions).into()
        });
        let quantity = format!("volume of the {name} body");
        facts.push(Fact::row(format!("volume_{stem}"), &quantity, volumes.collect(), "mm³"));
    }
    if objective.solver().problem().boundary.has_friction() {
        facts.push(row("friction_work", "friction work Σ|λ_T·slip|", "N·mm", &|shape, _| {
            let forces = &shape.state().forces;
            let pairs = forces.tangential.iter().zip(&forces.slip);
            pairs.map(|(force, slip)| force.iter().zip(slip).map(|(f, s)| f * s).sum::<f64>().abs()).sum()
        }));
    }
    let columns = seen.iter().map(|(shape, _)| shape.label.clone()).collect();
    Group { title: "Result", columns, facts, words: String::new() }
}

/// The key numbers as a section of the page: a table per load case, so that each fits.
pub fn section(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Section {
    let count = objective.cases().count();
    if count == 1 {
        return key_numbers(objective, shapes).section();
    }
    let of_case = |case: usize| {
        let own = key_numbers(objective, shapes.iter().filter(move |shape| shape.case == case)).section();
        let name = Block::Text(format!("Load case \"{}\":", objective.cases().name(case)));
        std::iter::once(name).chain(own.blocks)
    };
    Section::new("Result", (0..count).flat_map(of_case).collect())
}

/// A row over shapes by what a shape and its fields say.
type Row<'r> = dyn Fn(&'static str, &str, &str, &dyn Fn(&ShownShape<'_>, &Fields) -> f64) -> Fact + 'r;

/// Peak pressure and objective; with several load cases those of the case.
fn measures(objective: &ContactObjective, seen: &[(&ShownShape<'_>, &Fields)], row: &Row<'_>) -> Vec<Fact> {
    let peak =
        row("peak_pressure", "peak contact pressure", "MPa", &|shape, _| shape.solved.peak_of(objective, shape.case));
    let mut facts = vec![peak];
    if objective.cases().count() == 1 {
        let solved: Vec<_> = seen.iter().map(|(shape, _)| shape.solved).collect();
        facts.extend(shape_facts::objective(objective, &solved));
    } else {
        let unit = raised(&objective.unit());
        facts.push(row("objective", "measure of the case, times its weight", &unit, &|shape, _| {
            objective.weighted_values(&shape.solved.states)[shape.case]
        }));
    }
    facts
}

/// The largest of some values.
fn largest<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    values.copied().fold(f64::NEG_INFINITY, f64::max)
}

fn deformation(fields: &Fields) -> Deformation {
    let bodies = fields.bodies.iter().map(|body| Deformation::of(&body.mesh, &body.positions, &body.displacement));
    bodies.fold(Deformation::NONE, Deformation::and)
}
