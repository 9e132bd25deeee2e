//! A net of control points in space, and the cubic B-spline surface that it makes.

use crate::mortar::vector::{dot, length, plus};
use crate::scalar::{Dual, Scalar};
use crate::shape::Basis;

/// Degree of the surfaces.
const DEGREE: usize = 3;
/// Steps to the nearest point.
const STEPS: usize = 20;
/// A change of the parameters that ends them.
const STILL: f64 = 1e-14;

/// A clamped uniform B-spline surface of degree 3 over [0, 1]², with control points in space.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineNet {
    bases: [Basis; 2],
    points: Vec<[f64; 3]>,
}

/// The basis over a number of intervals.
pub(super) fn basis(intervals: usize) -> Basis {
    Basis::clamped_at(DEGREE, (1..intervals).map(|knot| knot as f64 / intervals as f64))
}

/// The functions that are not zero at a place, with their values.
pub(super) fn weights<T: Scalar>(basis: &Basis, place: T) -> impl Iterator<Item = (usize, T)> {
    let spans = basis.count() - DEGREE;
    let first = ((place.value() * spans as f64) as usize).min(spans - 1);
    // Rounding may put a place on a knot into either interval; the function left out is zero there.
    basis.values(place).into_iter().enumerate().skip(first.saturating_sub(1)).take(DEGREE + 3)
}

impl SplineNet {
    /// A surface of which all points lie in one, over some intervals along both parameters.
    pub(super) fn at_one_place(place: [f64; 3], intervals: [usize; 2]) -> Self {
        let bases = intervals.map(basis);
        let count = bases[0].count() * bases[1].count();
        Self { bases, points: vec![place; count] }
    }

    /// Control points along both parameters.
    pub fn counts(&self) -> [usize; 2] {
        [self.bases[0].count(), self.bases[1].count()]
    }

    /// Degrees along both parameters.
    pub fn degrees(&self) -> [usize; 2] {
        [self.bases[0].degree(), self.bases[1].degree()]
    }

    /// Knots along both parameters, repetitions listed.
    pub fn knots(&self) -> [&[f64]; 2] {
        [self.bases[0].knots(), self.bases[1].knots()]
    }

    /// Control points, index i·n₂ + j, mm.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    pub(super) fn bases(&self) -> &[Basis; 2] {
        &self.bases
    }

    pub(super) fn add(&mut self, changes: impl Fn(usize) -> [f64; 3]) {
        self.points.iter_mut().enumerate().for_each(|(index, point)| *point = plus(*point, 1.0, changes(index)));
    }

    /// The point at parameters in [0, 1]².
    pub(crate) fn at<T: Scalar>(&self, place: [T; 2]) -> [T; 3] {
        let mut sum = [T::constant(0.0); 3];
        let second: Vec<(usize, T)> = weights(&self.bases[1], place[1]).collect();
        for (i, a) in weights(&self.bases[0], place[0]) {
            for &(j, b) in &second {
                let point = self.points[i * self.bases[1].count() + j];
                (0..3).for_each(|axis| sum[axis] += a * b * T::constant(point[axis]));
            }
        }
        sum
    }

    /// The derivatives along both parameters.
    fn slopes(&self, place: [f64; 2]) -> [[f64; 3]; 2] {
        [0, 1].map(|along| {
            let place: [Dual; 2] = std::array::from_fn(|axis| Dual::new(place[axis], f64::from(axis == along)));
            self.at(place).map(|x| x.derivative)
        })
    }

    /// The distance of a point from the surface, from first parameters on: Gauss-Newton, of which no step goes farther
    /// away.
    pub(crate) fn distance(&self, x: [f64; 3], first: [f64; 2]) -> f64 {
        let mut place = first;
        let mut best = length(plus(x, -1.0, self.at(place)));
        for _ in 0..STEPS {
            let (rest, [a, b]) = (plus(x, -1.0, self.at(place)), self.slopes(place));
            let (aa, ab, bb, ra, rb) = (dot(a, a), dot(a, b), dot(b, b), dot(rest, a), dot(rest, b));
            let determinant = aa * bb - ab * ab;
            let step = [(bb * ra - ab * rb) / determinant, (aa * rb - ab * ra) / determinant];
            let next: [f64; 2] = std::array::from_fn(|axis| (place[axis] + step[axis]).clamp(0.0, 1.0));
            let distance = length(plus(x, -1.0, self.at(next)));
            if distance.is_nan() || distance >= best {
                break;
            }
            let still = (0..2).all(|axis| (next[axis] - place[axis]).abs() < STILL);
            (place, best) = (next, distance);
            if still {
                break;
            }
        }
        best
    }

    /// The same surface with every interval along one or both parameters halved.
    pub(super) fn halved(&self, along: [bool; 2]) -> Self {
        let counts = self.counts();
        let intervals = [0, 1].map(|axis| (counts[axis] - DEGREE) * if along[axis] { 2 } else { 1 });
        let bases = intervals.map(basis);
        let [rows, columns] = [0, 1].map(|axis| {
            let same = |index: usize| vec![(index, 1.0)];
            if along[axis] { insertion(&self.bases[axis]) } else { (0..counts[axis]).map(same).collect() }
        });
        let mut points = Vec::with_capacity(rows.len() * columns.len());
        for row in &rows {
            for column in &columns {
                let mut sum = [0.0; 3];
                for (i, a) in row {
                    column.iter().for_each(|(j, b)| sum = plus(sum, a * b, self.points[i * counts[1] + j]));
                }
                points.push(sum);
            }
        }
        Self { bases, points }
    }
}

/// The control points after a knot is inserted into the middle of every interval, each as (point before, share)
/// (Boehm's algorithm).
fn insertion(basis: &Basis) -> Vec<Vec<(usize, f64)>> {
    let mut knots = basis.knots().to_vec();
    let mut rows: Vec<Vec<(usize, f64)>> = (0..basis.count()).map(|index| vec![(index, 1.0)]).collect();
    let middles = basis.knots()[DEGREE..=basis.count()].windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    for middle in middles {
        let span = knots.partition_point(|knot| *knot <= middle) - 1;
        let row = |index: usize| {
            let share = (middle - knots[index]) / (knots[index + DEGREE] - knots[index]);
            let mut sum: Vec<(usize, f64)> = rows[index].iter().map(|(point, own)| (*point, share * own)).collect();
            for (point, own) in &rows[index - 1] {
                match sum.iter_mut().find(|(other, _)| other == point) {
                    Some((_, value)) => *value += (1.0 - share) * own,
                    None => sum.push((*point, (1.0 - share) * own)),
                }
            }
            sum
        };
        let between: Vec<_> = (span - DEGREE + 1..=span).map(row).collect();
        rows.splice(span - DEGREE + 1..span, between);
        knots.insert(span + 1, middle);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wavy() -> SplineNet {
        let mut net = SplineNet::at_one_place([0.0; 3], [3, 2]);
        let columns = net.counts()[1];
        net.add(|index| {
            let [i, j] = [index / columns, index % columns].map(|index| index as f64);
            [2.0 * i + 0.1 * j, 3.0 * j, (1.3 * i).sin() + (0.7 * j).cos()]
        });
        net
    }

    #[test]
    fn halved_intervals_leave_the_surface_as_it_is() {
        let net = wavy();
        for along in [[true, false], [false, true], [true, true]] {
            let halved = net.halved(along);
            assert_eq!(halved.counts(), [if along[0] { 9 } else { 6 }, if along[1] { 7 } else { 5 }]);
            for index in 0..200 {
                let place = [0.618_034, 0.754_878].map(|step| (f64::from(index) * step).fract());
                let change = plus(net.at(place), -1.0, halved.at(place));
                // Rounding of sums of numbers up to 20.
                assert!(length(change) < 2e-14, "{change:?} at {place:?}");
            }
        }
    }

    #[test]
    fn the_distance_of_a_point_beside_the_surface_is_that_along_the_normal() {
        let net = wavy();
        for index in 0..50 {
            let place = [0.618_034, 0.754_878].map(|step| 0.1 + 0.8 * (f64::from(index) * step).fract());
            let [a, b] = net.slopes(place);
            let normal = crate::mortar::vector::cross(a, b);
            let normal = normal.map(|x| x / length(normal));
            let beside = plus(net.at(place), 0.05, normal);
            let found = net.distance(beside, place.map(|x| x + 0.03));
            assert!((found - 0.05).abs() < 1e-10, "{found} at {place:?}");
        }
    }
}
