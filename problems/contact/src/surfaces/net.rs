//! A net of control points in space, and the cubic B-spline surface that it makes.

use crate::mortar::vector::{cross, dot, length, plus};
use crate::scalar::{Dual, Scalar};
use crate::shape::{Basis, SplineSurface};

/// Degree of the surfaces.
const DEGREE: usize = 3;
/// Steps to the nearest point.
const STEPS: usize = 20;
/// A change of the parameters that ends them.
const STILL: f64 = 1e-14;

/// A clamped B-spline surface of degree 3 over [0, 1]², with control points in space.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineNet {
    surface: SplineSurface,
    points: Vec<[f64; 3]>,
}

/// The functions that are not zero at a place, with their values.
pub(super) fn weights<T: Scalar>(basis: &Basis, place: T) -> impl Iterator<Item = (usize, T)> {
    let first = interval(basis, place.value());
    basis.values(place).into_iter().enumerate().skip(first).take(DEGREE + 1)
}

/// The interval between knots in which a parameter lies.
pub(super) fn interval(basis: &Basis, place: f64) -> usize {
    let inner = &basis.knots()[DEGREE + 1..basis.count()];
    inner.partition_point(|knot| *knot <= place)
}

/// The ends of all intervals between knots.
pub(super) fn ends(basis: &Basis) -> &[f64] {
    &basis.knots()[DEGREE..=basis.count()]
}

impl SplineNet {
    /// A surface with so many equal intervals between knots, of which all points lie in one.
    pub(super) fn at_one_place(intervals: [usize; 2], place: [f64; 3]) -> Self {
        let inner = |count: usize| (1..count).map(move |knot| knot as f64 / count as f64);
        let bases = intervals.map(|count| Basis::clamped_at(DEGREE, inner(count)));
        let count = bases.iter().map(Basis::count).product();
        Self { surface: SplineSurface::new(bases), points: vec![place; count] }
    }

    /// Counts, degrees and knots along both parameters.
    pub fn surface(&self) -> &SplineSurface {
        &self.surface
    }

    /// Control points, index i·n₂ + j, mm.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    pub(super) fn bases(&self) -> &[Basis; 2] {
        self.surface.bases()
    }

    pub(super) fn add(&mut self, changes: impl Fn(usize) -> [f64; 3]) {
        self.points.iter_mut().enumerate().for_each(|(index, point)| *point = plus(*point, 1.0, changes(index)));
    }

    /// The point at parameters in [0, 1]².
    pub(crate) fn at<T: Scalar>(&self, place: [T; 2]) -> [T; 3] {
        let mut sum = [T::constant(0.0); 3];
        let second: Vec<(usize, T)> = weights(&self.bases()[1], place[1]).collect();
        for (i, a) in weights(&self.bases()[0], place[0]) {
            for &(j, b) in &second {
                let point = self.points[i * self.bases()[1].count() + j];
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

    /// The normal, whose length is the scale of area.
    pub(super) fn normal(&self, place: [f64; 2]) -> [f64; 3] {
        let [a, b] = self.slopes(place);
        cross(a, b)
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

    /// This surface with further knots along both parameters, ascending.
    pub(super) fn refined(&self, knots: [&[f64]; 2]) -> Self {
        let [(first, rows), (second, columns)] = [0, 1].map(|axis| insertion(&self.bases()[axis], knots[axis]));
        let count = self.bases()[1].count();
        let mut points = Vec::with_capacity(rows.len() * columns.len());
        for row in &rows {
            for column in &columns {
                let mut sum = [0.0; 3];
                for (i, a) in row {
                    column.iter().for_each(|(j, b)| sum = plus(sum, a * b, self.points[i * count + j]));
                }
                points.push(sum);
            }
        }
        Self { surface: SplineSurface::new([first, second]), points }
    }
}

/// The basis with further knots, and its control points, each as (point before, share) (Boehm's algorithm).
fn insertion(basis: &Basis, further: &[f64]) -> (Basis, Vec<Vec<(usize, f64)>>) {
    let mut knots = basis.knots().to_vec();
    let mut rows: Vec<Vec<(usize, f64)>> = (0..basis.count()).map(|index| vec![(index, 1.0)]).collect();
    for &knot in further {
        let span = knots.partition_point(|other| *other <= knot) - 1;
        let row = |index: usize| {
            let share = (knot - knots[index]) / (knots[index + DEGREE] - knots[index]);
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
        knots.insert(span + 1, knot);
    }
    let inner = knots[DEGREE + 1..rows.len()].iter().copied();
    (Basis::clamped_at(DEGREE, inner), rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wavy() -> SplineNet {
        let mut net = SplineNet::at_one_place([1; 2], [0.0; 3]).refined([&[0.3, 0.5], &[0.6]]);
        let columns = net.surface().counts()[1];
        net.add(|index| {
            let [i, j] = [index / columns, index % columns].map(|index| index as f64);
            [2.0 * i + 0.1 * j, 3.0 * j, (1.3 * i).sin() + (0.7 * j).cos()]
        });
        net
    }

    #[test]
    fn further_knots_leave_the_surface_as_it_is() {
        let net = wavy();
        let cases: [[&[f64]; 2]; 3] = [[&[0.1, 0.4, 0.45], &[]], [&[], &[0.2, 0.9]], [&[0.75], &[0.3, 0.8]]];
        for knots in cases {
            let refined = net.refined(knots);
            assert_eq!(refined.surface().counts(), [6 + knots[0].len(), 5 + knots[1].len()]);
            for index in 0..200 {
                let place = [0.618_034, 0.754_878].map(|step| (f64::from(index) * step).fract());
                let change = plus(net.at(place), -1.0, refined.at(place));
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
            let normal = net.normal(place);
            let normal = normal.map(|x| x / length(normal));
            let beside = plus(net.at(place), 0.05, normal);
            let found = net.distance(beside, place.map(|x| x + 0.03));
            assert!((found - 0.05).abs() < 1e-10, "{found} at {place:?}");
        }
    }
}
