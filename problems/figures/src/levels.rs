//! Colour scales in steps, and values on triangles and quadrilaterals drawn with them.
//!
//! Inside a quadrilateral the values are linear on the four triangles between its sides and its middle, which has the
//! mean value: the area above a level is then a polygon per triangle, without ambiguous cases.

use super::canvas::INK;
use super::canvas::{Canvas, LABEL, Place, Stroke};
use super::colours;
use super::regions::{Corner, around, borders, mean, ring};
use super::scale::{Axis, Tick, extent};

/// About the number of colours of a scale.
const STEPS: usize = 24;
/// Most changes of colour inside faces, counted over all faces: some 10 bytes each. Beyond, the steps become coarser.
const MAX_CHANGES: usize = 60_000;

/// One colour scale for all values of a figure, in steps whose ends are multiples of a round number.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColourScale {
    pub axis: Axis,
    levels: Vec<f64>,
}

/// Values of points on the drawing, with faces that have the same sense of rotation there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    pub places: &'a [Place],
    pub faces: &'a [Vec<usize>],
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

    /// Colour of a number of steps from the one that begins at level k − 1.
    fn colour(&self, step: usize, count: usize) -> String {
        let end =
            |index: Option<usize>, outside: f64| index.and_then(|i| self.levels.get(i)).copied().unwrap_or(outside);
        let (low, high) = (end(step.checked_sub(1), 0.0), end(Some(step + count - 1), 1.0));
        colours::colour(0.5 * (low + high))
    }

    /// The number of the step a share of the scale belongs to.
    fn step(&self, share: f64) -> usize {
        self.levels.partition_point(|level| *level <= share)
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
            canvas.rectangle([left, foot(high)], [WIDTH, foot(low) - foot(high) + more], &self.colour(step, 1));
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

/// A corner with its value.
type Valued = (Corner, f64);

/// Values filled with the colours of a scale.
pub(super) fn fill(canvas: &mut Canvas, field: Field, scale: &ColourScale) {
    let shares: Vec<f64> = field.values.iter().map(|value| scale.axis.share(*value).unwrap_or(0.0)).collect();
    let field = Field { values: &shares, ..field };
    let ranges: Vec<(f64, f64)> = field.faces.iter().map(|face| field.range(face)).collect();
    let Some((lowest, highest)) = extent(ranges.iter().flat_map(|(low, high)| [*low, *high])) else { return };
    let changes: usize = ranges.iter().map(|(low, high)| scale.step(*high) - scale.step(*low)).sum();
    let stride = 1 + changes / MAX_CHANGES;
    // Steps below all values would be painted over, steps above all values are empty.
    let first = scale.step(lowest) / stride * stride;
    for step in (first..=scale.step(highest)).step_by(stride) {
        let level = if step == first { f64::NEG_INFINITY } else { scale.levels[step - 1] };
        let next = scale.levels.get(step + stride - 1).copied().unwrap_or(f64::INFINITY);
        let borders = borders(field.above(&ranges, level, next));
        canvas.area(&scale.colour(step, stride), borders.iter().map(Vec::as_slice));
    }
}

/// Lines on which the values have a level, in pieces.
pub(super) fn contour(field: Field, level: f64) -> Vec<Vec<Place>> {
    let crossing = |triangle: [Valued; 3]| {
        let cut = around(&triangle).filter(|(a, b)| (a.1 >= level) != (b.1 >= level));
        cut.map(|(a, b)| between(a, b, level).1).collect::<Vec<Place>>()
    };
    let pieces = (0..field.faces.len()).flat_map(|face| field.triangles(face)).map(crossing);
    pieces.filter(|piece| !piece.is_empty()).collect()
}

/// The place on a side where the values have a level.
fn between((a, value): Valued, (b, other): Valued, level: f64) -> Corner {
    let share = (level - value) / (other - value);
    let place = [0, 1].map(|axis| a.1[axis] + share * (b.1[axis] - a.1[axis]));
    let (from, to) = (a.0[0], b.0[0]);
    ([from.min(to), from.max(to)], place)
}

impl Field<'_> {
    fn range(&self, face: &[usize]) -> (f64, f64) {
        extent(face.iter().map(|&point| self.values[point])).unwrap_or((0.0, 0.0))
    }

    /// The triangles on which values are linear.
    fn triangles(&self, index: usize) -> Vec<[Valued; 3]> {
        let face = &self.faces[index];
        let values = face.iter().map(|&point| self.values[point]);
        let corners = ring(face, self.places);
        let middle: Vec<Place> = corners.iter().map(|corner| corner.1).collect();
        // Numbers beyond those of the points are free for the middles.
        let middle = ([self.places.len() + index; 2], mean(&middle));
        let average = values.clone().sum::<f64>() / face.len() as f64;
        let ring: Vec<Valued> = corners.into_iter().zip(values).collect();
        match ring[..] {
            [a, b, c] => vec![[a, b, c]],
            _ => around(&ring).map(|(a, b)| [a, b, (middle, average)]).collect(),
        }
    }

    /// Areas where the values are at least a level: whole faces, and parts of triangles; without the faces that are
    /// covered by the areas of the next level.
    fn above(&self, ranges: &[(f64, f64)], level: f64, next: f64) -> impl Iterator<Item = Vec<Corner>> {
        let some = move |(low, high): (f64, f64)| high >= level && low < next;
        ranges.iter().enumerate().filter(move |(_, range)| some(**range)).flat_map(move |(index, range)| {
            if range.0 >= level {
                return vec![ring(&self.faces[index], self.places)];
            }
            self.triangles(index).iter().filter_map(|triangle| part_above(triangle, level)).collect()
        })
    }
}

fn part_above(triangle: &[Valued; 3], level: f64) -> Option<Vec<Corner>> {
    let mut part = Vec::with_capacity(4);
    for (a, b) in around(triangle) {
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
    use crate::grid_faces;

    fn size(area: &[[f64; 2]]) -> f64 {
        let turned = area.iter().zip(area.iter().cycle().skip(1));
        turned.map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum::<f64>().abs()
    }

    #[test]
    fn the_area_above_a_level_of_a_linear_field_is_exact() {
        // x over a 4 × 4 square with a quadrilateral in two triangles: above 1.5 lies 2.5/4 of it.
        let places: Vec<Place> = (0..25).map(|node| [f64::from(node / 5), f64::from(node % 5)]).collect();
        let values: Vec<f64> = places.iter().map(|place| place[0]).collect();
        let mut faces = grid_faces([5, 5]);
        let [a, b, c, d] = faces[5][..] else { panic!("a quadrilateral") };
        faces[5] = vec![a, b, c];
        faces.push(vec![a, c, d]);
        let field = Field { places: &places, faces: &faces, values: &values };
        let ranges: Vec<(f64, f64)> = faces.iter().map(|face| field.range(face)).collect();
        let areas = |level: f64| borders(field.above(&ranges, level, f64::INFINITY));
        assert_eq!(areas(1.5).len(), 1);
        assert!((size(&areas(1.5)[0]) - 10.0).abs() < 1e-12, "{:?}", areas(1.5));
        assert!(areas(4.5).is_empty() && size(&areas(f64::NEG_INFINITY)[0]) == 16.0);
        let length: f64 =
            contour(field, 1.5).iter().map(|line| (line[0][0] - line[1][0]).hypot(line[0][1] - line[1][1])).sum();
        assert!((length - 4.0).abs() < 1e-12, "{length}");
    }

    #[test]
    fn a_scale_covers_all_values_and_begins_at_zero_where_that_is_near() {
        let scale = ColourScale::new("p", "MPa", [3.0, 14_809.0]);
        assert_eq!(scale.axis.ends(), [0.0, 14_809.0]);
        assert_eq!((scale.step(0.0), scale.step(1.0)), (0, scale.levels.len()));
        assert_eq!(ColourScale::new("h", "mm", [45.0, 50.0]).axis.ends(), [45.0, 50.0]);
    }
}
