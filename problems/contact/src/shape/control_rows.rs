//! Rows of U that the net of controls of a lattice has: slopes between neighbours, and the volume of the body.

use crate::body::mesh::Mesh;
use crate::error::SceneError;
use crate::scene::Block;
use crate::shape::{BodyMap, LatticeShape, ShapedFace};
use std::collections::BTreeMap;

/// Relative rounding of a volume.
const ROUNDING: f64 = 1e-12;

/// A row with its name, entries and sides.
pub(crate) type NamedRow = (String, Vec<(usize, f64)>, [f64; 2]);

/// Slopes between neighbouring control points, at most `most`; `first`: of the controls among all.
pub(crate) fn slope_rows(shape: &LatticeShape, most: f64, first: usize, block: Option<&Block>) -> Vec<NamedRow> {
    let (counts, lengths) = (shape.control_points, shape.coordinates.lengths(block));
    let steps = [counts[1] * counts[2], counts[2], 1];
    let movers = shape.movers();
    let difference = |way: usize, points: [usize; 2]| {
        let mut row = BTreeMap::new();
        for (point, sign) in points.into_iter().zip([-1.0, 1.0]) {
            for &(control, factor) in movers.get(&(point, way)).into_iter().flatten() {
                *row.entry(control).or_insert(0.0) += sign * factor;
            }
        }
        row.retain(|_, value| *value != 0.0);
        row.into_iter().collect::<Vec<(usize, f64)>>()
    };
    let is_image = |row: &[(usize, f64)], (_, known, _): &NamedRow| {
        let times = |sign: f64| row.iter().map(move |&(control, value)| (control, sign * value));
        shape.symmetric != [false; 3] && [1.0, -1.0].into_iter().any(|sign| times(sign).eq(known.iter().copied()))
    };
    let mut rows: Vec<NamedRow> = Vec::new();
    for point in 0..counts.iter().product() {
        let index = [point / steps[0], point / counts[2] % counts[1], point % counts[2]];
        for axis in (0..3).filter(|&axis| index[axis] + 1 < counts[axis] && !shape.is_across(axis)) {
            let bound = most * lengths[axis] / (counts[axis] - 1) as f64;
            for way in shape.ways() {
                let row = difference(way, [point, point + steps[axis]]);
                if !row.is_empty() && !rows.iter().any(|known| is_image(&row, known)) {
                    let name = format!("{} (lattice.slope along x{})", sum(first, &row), axis + 1);
                    rows.push((name, row, [-bound, bound]));
                }
            }
        }
    }
    rows
}

/// The volume of a body, which is linear in controls that move nodes along one axis: of its cells and, of heights,
/// the measure below or above the spline, which is off by the discretisation error.
///
/// # Errors
/// [`SceneError::OutOfRange`] for controls that move nodes along several axes.
pub(crate) fn volume_rows(
    shape: &LatticeShape,
    [least, largest]: [f64; 2],
    (map, mesh): (&BodyMap, &Mesh),
    block: Option<&Block>,
) -> Result<Vec<NamedRow>, SceneError> {
    let moves = |axis: &usize| (0..mesh.node_count() as u32).any(|node| !map.row(node, *axis).is_empty());
    let allowed = "none where controls move nodes along several axes; a limit bounds such a volume";
    SceneError::require((0..3).filter(moves).count() == 1, "lattice.volume", "bounds", allowed)?;
    let mut row = vec![0.0; map.controls];
    for (node, slope) in mesh.volume_derivative(mesh.nodes()).iter().enumerate() {
        for axis in 0..3 {
            map.row(node as u32, axis).iter().for_each(|&(control, value)| row[control] += slope[axis] * value);
        }
    }
    let whole = mesh.volume(mesh.nodes());
    let rest = whole - shape.start * row.iter().sum::<f64>();
    // A bound that the start attains is attained there whatever its volume rounds to.
    let side = |bound: f64| if (bound - whole).abs() <= ROUNDING * whole { whole - rest } else { bound - rest };
    let sides = [side(least), side(largest)];
    let mut rows = Vec::new();
    if let (Some(face), Some(block)) = (shape.face(), block) {
        let (words, sign) = if face == ShapedFace::Top { ("under", 1.0) } else { ("above", -1.0) };
        let area = sign * block.size[0] * block.size[1];
        let measure = shape.surface()?.integrals().into_iter().map(|value| value * area).enumerate().collect();
        rows.push((format!("volume {words} the surface (lattice.volume)"), measure, sides));
    }
    let own = row.into_iter().enumerate().filter(|(_, value)| *value != 0.0).collect();
    rows.push(("volume of the cells (lattice.volume)".into(), own, sides));
    Ok(rows)
}

/// A sum of controls in words, the last one first.
fn sum(first: usize, row: &[(usize, f64)]) -> String {
    let term = |&(control, factor): &(usize, f64)| {
        let sign = if factor < 0.0 { "−" } else { "+" };
        let size = if factor.abs() == 1.0 { String::new() } else { format!("{} ", factor.abs()) };
        format!("{sign} {size}α[{}]", first + control)
    };
    let words = row.iter().rev().map(term).collect::<Vec<_>>().join(" ");
    words.strip_prefix("+ ").map_or(words.clone(), str::to_owned)
}
