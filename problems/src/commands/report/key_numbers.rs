//! The numbers by which shapes are judged, side by side with their change: as a table of the page and as JSON.

use crate::commands::report::gallery::ShownShape;
use crate::commands::solved_shape::ContactObjective;
use contact::deformation::Deformation;
use contact::fields::Fields;
use figures::page::{Block, Section};
use serde::Serialize;

/// Shapes side by side.
#[derive(Debug, Serialize)]
pub struct KeyNumbers {
    /// What the shapes are called.
    columns: Vec<&'static str>,
    rows: Vec<Row>,
}

/// One quantity.
#[derive(Debug, Serialize)]
struct Row {
    /// Its name in files, which does not change.
    key: &'static str,
    /// Its name for people.
    quantity: &'static str,
    unit: String,
    /// One per column.
    values: Vec<f64>,
    /// From the first column to the second, in per cent of the first; null for a single column and where the first is zero.
    change_percent: Option<f64>,
}

impl KeyNumbers {
    /// Those of shapes that have fields; friction work only where there is friction.
    pub fn new(objective: &ContactObjective, shapes: &[ShownShape<'_>]) -> Self {
        let seen: Vec<(&ShownShape<'_>, &Fields)> =
            shapes.iter().filter_map(|shape| Some((shape, shape.fields.as_ref()?))).collect();
        let row = |key, quantity, unit: &str, value: &dyn Fn(&ShownShape<'_>, &Fields) -> f64| {
            let values: Vec<f64> = seen.iter().map(|(shape, fields)| value(shape, fields)).collect();
            let change_percent = match values[..] {
                [first, second] if first != 0.0 => Some(100.0 * (second - first) / first.abs()),
                _ => None,
            };
            Row { key, quantity, unit: unit.to_owned(), values, change_percent }
        };
        let area = |fields: &Fields| fields.contact.area.iter().sum::<f64>();
        let mut rows = vec![
            row("objective", "objective Θ", &objective.unit().replace(['{', '}'], ""), &|shape, _| shape.solved.value),
            row("peak_pressure", "peak contact pressure", "MPa", &|shape, _| shape.solved.peak_pressure),
            row("mean_pressure", "mean pressure over the whole contact surface", "MPa", &|shape, fields| {
                shape.solved.state.forces.total_normal_force() / area(fields)
            }),
            row("contact_area", "contact area (nodes that are closed)", "mm²", &|shape, _| {
                objective.solver().problem().boundary.closed_area(&shape.solved.state.forces.status)
            }),
            row("peak_von_mises_at_centres", "peak von Mises stress at brick centres", "MPa", &|_, fields| {
                largest(fields.bodies.iter().flat_map(|body| &body.von_mises))
            }),
            row("peak_von_mises_at_nodes", "peak von Mises stress, averaged to nodes", "MPa", &|_, fields| {
                largest(fields.bodies.iter().flat_map(|body| &body.nodal_von_mises))
            }),
            row("largest_displacement", "largest displacement", "mm", &|_, fields| deformation(fields).displacement),
            row("largest_strain", "largest principal strain (modulus, at brick centres)", "%", &|_, fields| {
                100.0 * deformation(fields).strain
            }),
        ];
        let bodies = seen.iter().map(|(_, fields)| fields.bodies.len()).min().unwrap_or(0);
        let names = [("volume_lower", "volume of the lower body"), ("volume_upper", "volume of the upper body")];
        for (body, (key, quantity)) in names.into_iter().enumerate().take(bodies) {
            rows.push(row(key, quantity, "mm³", &|_, fields| fields.bodies[body].block.volume()));
        }
        if objective.solver().problem().boundary.has_friction() {
            rows.push(row("friction_work", "friction work Σ|λ_T·slip|", "N·mm", &|shape, _| {
                let forces = &shape.solved.state.forces;
                let pairs = forces.tangential.iter().zip(&forces.slip);
                pairs.map(|(force, slip)| (force[0] * slip[0] + force[1] * slip[1]).abs()).sum()
            }));
        }
        Self { columns: seen.iter().map(|(shape, _)| shape.label).collect(), rows }
    }

    /// The table of the page.
    pub fn section(&self) -> Section {
        let compared = self.columns.len() == 2;
        let head = [""].into_iter().chain(self.columns.iter().copied()).chain(compared.then_some("change"));
        let rows = self.rows.iter().map(|row| {
            let name = format!("{}, {}", row.quantity, row.unit);
            let values = row.values.iter().map(|value| written(*value));
            let change = || row.change_percent.map_or_else(|| "–".to_owned(), changed);
            std::iter::once(name).chain(values).chain(compared.then(change)).collect::<Vec<String>>()
        });
        let words = "Stresses at brick centres converge with the square of the mesh size; averages at nodes show the surface, where they \
                     are of first order only.";
        Section::new("Result", vec![Block::table(head, rows), Block::Text(words.into())])
    }
}

/// The largest of some values.
fn largest<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    values.copied().fold(f64::NEG_INFINITY, f64::max)
}

fn deformation(fields: &Fields) -> Deformation {
    let bodies = fields.bodies.iter().map(|body| Deformation::of(&body.block, &body.displacement));
    bodies.fold(Deformation::NONE, Deformation::and)
}

/// A change in per cent with its sign, none before zero.
fn changed(percent: f64) -> String {
    let text = format!("{percent:+.1}");
    if text.ends_with("0.0") && text.len() == 4 { "0.0 %".into() } else { format!("{} %", text.replace('-', "−")) }
}

/// A value with six digits.
fn written(value: f64) -> String {
    let text = format!("{value:.5e}");
    let power = text.rsplit('e').next().and_then(|power| power.parse::<i32>().ok());
    match power {
        Some(power @ -3..6) => format!("{value:.*}", (5 - power) as usize),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_are_shown() {
        let texts = [12_082.04, 0.012_345_678, 800_000.0, 99.999_999_99, 2.5e-9, 1.8e16, 0.0].map(written);
        assert_eq!(texts, ["12082.0", "0.0123457", "800000", "100.000", "2.50000e-9", "1.80000e16", "0.00000"]);
        assert_eq!([-0.04, 0.0, -10.04, 156.0].map(changed), ["0.0 %", "0.0 %", "−10.0 %", "+156.0 %"]);
    }

    #[test]
    fn the_table_has_a_change_where_two_shapes_stand_side_by_side() {
        let row = |values: Vec<f64>, change_percent| Row {
            key: "k",
            quantity: "q",
            unit: "mm".into(),
            values,
            change_percent,
        };
        let table = |columns: Vec<&'static str>, rows| KeyNumbers { columns, rows }.section().blocks[0].clone();
        let two = table(vec!["a", "b"], vec![row(vec![2.0, 1.0], Some(-50.0)), row(vec![0.0, 1.0], None)]);
        let Block::Table { head, rows } = two else { panic!("a table") };
        assert_eq!(head.last().map(String::as_str), Some("change"));
        assert_eq!(rows.iter().map(|row| row[3].as_str()).collect::<Vec<_>>(), ["−50.0 %", "–"]);
        let Block::Table { head, rows } = table(vec!["value"], vec![row(vec![2.0], None)]) else { panic!("a table") };
        assert_eq!((head.len(), rows[0].len()), (2, 2));
    }
}
