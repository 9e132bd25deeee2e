//! Colour scales in steps, and values on a grid drawn with them.
//!
//! Inside a cell the values are linear on the four triangles between its corners and its middle, which has the mean
//! value: the area above a level is then a polygon per triangle, without ambiguous cases.

use super::canvas::INK;
use super::canvas::{Canvas, LABEL, Place, Stroke};
use super::colours;
use super::scale::{Axis, Tick, extent};

/// About the number of colours of a scale.
const STEPS: usize = 24;

/// One colour scale for all values of a figure, in steps whose ends are multiples of a round number.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColourScale {
    pub axis: Axis,
    levels: Vec<f64>,
}

/// A grid of values: n₁ × n₂ at equal distances, index i·n₂ + j.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lattice<'a> {
    pub counts: [usize; 2],
    pub values: &'a [f64],
}

impl ColourScale {
    /// A scale over all values; it begins at zero if the smallest is positive but below half of the largest.
    pub fn new(name: &str, unit: &str, values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = extent(values).unwrap_or((0.0, 1.0));
        let low = if low > 0.0 && low < 0.5 * high { 0.0 } else { low };
        let axis = Axis::linear(name, unit, [low, high], 0.0, 6);
        let fine = Axis::linear(name, unit, axis.ends(), 0.0, STEPS);
        let inside = |share: &f64| *share > 1e-9 && *share < 1.0 - 1e-9;
        let levels = fine.ticks.iter().map(|tick| tick.share).filter(inside).collect();
        Self { axis, levels }
    }

    /// Shares of the scale at which the colour changes.
    pub fn levels(&self) -> &[f64] {
        &self.levels
    }

    /// Colour between level k − 1 and level k.
    pub fn step_colour(&self, step: usize) -> String {
        let end =
            |index: Option<usize>, outside: f64| index.and_then(|i| self.levels.get(i)).copied().unwrap_or(outside);
        let (low, high) = (end(step.checked_sub(1), 0.0), end(Some(step), 1.0));
        colours::colour(0.5 * (low + high))
    }

    /// The number of the step a value belongs to.
    pub fn step(&self, value: f64) -> usize {
        let share = self.axis.share(value).unwrap_or(0.0);
        self.levels.iter().filter(|level| **level <= share).count()
    }

    /// A bar with the colours, labels at its right and the title above.
    pub fn bar(&self, canvas: &mut Canvas, [left, top]: Place, height: f64) {
        const WIDTH: f64 = 15.0;
        let foot = |share: f64| top + (1.0 - share) * height;
        canvas.raw("<g class=\"bar\">\n");
        for step in 0..=self.levels.len() {
            let low = if step == 0 { 0.0 } else { self.levels[step - 1] };
            let high = self.levels.get(step).copied().unwrap_or(1.0);
            // A little more than a step, so that no line is seen between two.
            let more = if step == 0 { 0.0 } else { 0.4 };
            canvas.rectangle([left, foot(high)], [WIDTH, foot(low) - foot(high) + more], &self.step_colour(step));
        }
        let corners = [[left, top], [left + WIDTH, top], [left + WIDTH, top + height], [left, top + height]];
        canvas.outline(&corners, Stroke::solid(INK, 0.8));
        // Both ends have a label; ticks give way to them.
        let apart = |tick: &&Tick| (1.1 * LABEL..=height - 1.1 * LABEL).contains(&(tick.share * height));
        let between = self.axis.ticks.iter().filter(apart).map(|tick| (tick.share, tick.label.clone()));
        for (share, label) in [0.0, 1.0].into_iter().zip(self.axis.end_labels()).chain(between) {
            let y = foot(share);
            canvas.line(&[[left + WIDTH, y], [left + WIDTH + 4.0, y]], Stroke::solid(INK, 0.8));
            canvas.text([left + WIDTH + 7.0, y + 0.34 * LABEL], LABEL, &label);
        }
        canvas.raw("</g>\n");
        canvas.text([left, top - 10.0], LABEL, &self.axis.title);
    }
}

/// Values filled with the colours of a scale; `place` maps (i, j), also between nodes, to the drawing.
pub(super) fn fill(canvas: &mut Canvas, lattice: Lattice, scale: &ColourScale, place: impl Fn([f64; 2]) -> Place) {
    let shares: Vec<f64> = lattice.values.iter().map(|value| scale.axis.share(*value).unwrap_or(0.0)).collect();
    let (lowest, highest) = extent(shares.iter().copied()).unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
    let shares = Lattice { counts: lattice.counts, values: &shares };
    let all = [f64::NEG_INFINITY].into_iter().chain(scale.levels().iter().copied());
    for (step, level) in all.enumerate() {
        let next = scale.levels().get(step).copied().unwrap_or(f64::INFINITY);
        // Steps below all values would be painted over, steps above all values are empty.
        if next > lowest && level <= highest {
            let areas = above(shares, level);
            let placed: Vec<Vec<Place>> = areas.iter().map(|area| corners(area.iter().map(|p| place(*p)))).collect();
            canvas.area(&scale.step_colour(step), placed.iter().map(Vec::as_slice));
        }
    }
}

/// A closed polygon without the points that lie on straight lines between their neighbours.
fn corners(polygon: impl Iterator<Item = Place>) -> Vec<Place> {
    /// Distance from a line that is not seen, points.
    const UNSEEN: f64 = 0.02;
    let mut kept: Vec<Place> = Vec::new();
    for place in polygon {
        while let [.., a, b] = kept[..] {
            let (along, length) = ([place[0] - a[0], place[1] - a[1]], (place[0] - a[0]).hypot(place[1] - a[1]));
            let across = along[0] * (b[1] - a[1]) - along[1] * (b[0] - a[0]);
            let between = along[0] * (b[0] - a[0]) + along[1] * (b[1] - a[1]);
            if across.abs() > UNSEEN * length || !(0.0..=length * length).contains(&between) {
                break;
            }
            kept.pop();
        }
        kept.push(place);
    }
    kept
}

/// Lines on which the values have a level, in pieces.
pub(super) fn contour(lattice: Lattice, level: f64) -> Vec<[[f64; 2]; 2]> {
    let mut pieces = Vec::new();
    for (i, j) in lattice.cells() {
        for triangle in lattice.triangles(i, j) {
            let mut ends = Vec::with_capacity(2);
            for edge in 0..3 {
                let (a, b) = (triangle[edge], triangle[(edge + 1) % 3]);
                if (a.1 >= level) != (b.1 >= level) {
                    ends.push(between(a, b, level));
                }
            }
            if let [first, second] = ends[..] {
                pieces.push([first, second]);
            }
        }
    }
    pieces
}

type Corner = ([f64; 2], f64);

fn between(a: Corner, b: Corner, level: f64) -> [f64; 2] {
    let share = (level - a.1) / (b.1 - a.1);
    std::array::from_fn(|axis| a.0[axis] + share * (b.0[axis] - a.0[axis]))
}

impl Lattice<'_> {
    fn at(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.counts[1] + j]
    }

    fn cells(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [n1, n2] = self.counts;
        (0..n1 - 1).flat_map(move |i| (0..n2 - 1).map(move |j| (i, j)))
    }

    fn triangles(&self, i: usize, j: usize) -> [[Corner; 3]; 4] {
        let corner = |di: usize, dj: usize| ([(i + di) as f64, (j + dj) as f64], self.at(i + di, j + dj));
        let ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let mean = ring.iter().map(|corner| 0.25 * corner.1).sum();
        let middle = ([i as f64 + 0.5, j as f64 + 0.5], mean);
        std::array::from_fn(|k| [ring[k], ring[(k + 1) % 4], middle])
    }
}

/// Areas where the values are at least a level: runs of whole cells along the second index, and parts of triangles.
fn above(lattice: Lattice, level: f64) -> Vec<Vec<[f64; 2]>> {
    let mut areas = Vec::new();
    let [n1, n2] = lattice.counts;
    for i in 0..n1 - 1 {
        let mut run: Option<usize> = None;
        for j in 0..n2 {
            let corners = |j: usize| [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
            let values = || corners(j).map(|(a, b)| lattice.at(a, b));
            let whole = j + 1 < n2 && values().iter().all(|value| *value >= level);
            match (whole, run) {
                (true, None) => run = Some(j),
                (false, Some(first)) => {
                    // All nodes along the run: it need not be straight where it is placed.
                    let side = |i: usize| (first..=j).map(move |node| [i as f64, node as f64]);
                    areas.push(side(i + 1).chain(side(i).rev()).collect());
                    run = None;
                }
                _ => {}
            }
            if j + 1 < n2 && !whole && values().iter().any(|value| *value >= level) {
                areas.extend(lattice.triangles(i, j).iter().filter_map(|triangle| part_above(triangle, level)));
            }
        }
    }
    areas
}

fn part_above(triangle: &[Corner; 3], level: f64) -> Option<Vec<[f64; 2]>> {
    let mut part = Vec::with_capacity(4);
    for edge in 0..3 {
        let (a, b) = (triangle[edge], triangle[(edge + 1) % 3]);
        if a.1 >= level {
            part.push(a.0);
        }
        if (a.1 >= level) != (b.1 >= level) {
            part.push(between(a, b, level));
        }
    }
    (part.len() >= 3).then_some(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn size(area: &[[f64; 2]]) -> f64 {
        let turned = area.iter().zip(area.iter().cycle().skip(1));
        turned.map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum::<f64>().abs()
    }

    #[test]
    fn the_area_above_a_level_of_a_linear_field_is_exact() {
        // x over a 4 × 4 square: above 1.5 lies 2.5/4 of it.
        let values: Vec<f64> = (0..25).map(|node| f64::from(node / 5)).collect();
        let lattice = Lattice { counts: [5, 5], values: &values };
        let total: f64 = above(lattice, 1.5).iter().map(|area| size(area)).sum();
        assert!((total - 10.0).abs() < 1e-12, "{total}");
        assert!(above(lattice, 4.5).is_empty() && above(lattice, f64::NEG_INFINITY).len() == 4);
        let length: f64 = contour(lattice, 1.5).iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert!((length - 4.0).abs() < 1e-12, "{length}");
    }

    #[test]
    fn straight_runs_keep_their_corners_only_and_bent_ones_their_nodes() {
        let run = |bend: f64| {
            corners((0..=4).map(|j| [f64::from(j), bend * f64::from(j * j)]).chain([[4.0, -9.0], [0.0, -9.0]]))
        };
        assert_eq!(run(0.0), [[0.0, 0.0], [4.0, 0.0], [4.0, -9.0], [0.0, -9.0]]);
        assert_eq!(run(0.5).len(), 7);
        assert_eq!(corners([[0.0; 2]; 3].into_iter()).len(), 2);
    }

    #[test]
    fn a_scale_covers_all_values_and_begins_at_zero_where_that_is_near() {
        let scale = ColourScale::new("p", "MPa", [3.0, 14_809.0]);
        assert_eq!(scale.axis.ends(), [0.0, 14_809.0]);
        assert_eq!((scale.step(0.0), scale.step(14_809.0)), (0, scale.levels().len()));
        assert_eq!(ColourScale::new("h", "mm", [45.0, 50.0]).axis.ends(), [45.0, 50.0]);
    }
}
