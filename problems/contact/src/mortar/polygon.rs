//! Convex polygons in a plane: clipping, area, centroid.
//!
//! ```text
//! side(p) = (b − a) × (p − a) > 0 inside an edge from a to b
//! cut of p (inside) and q (outside): p + (q − p) side(p) / (side(p) − side(q))
//! ```

use crate::scalar::Scalar;

/// Two quadrilaterals meet in at most eight corners; the rest is for rounding.
const CAPACITY: usize = 12;

/// An edge that is cut this far beyond its end is nearly parallel to the cutting line: its end is taken.
const BEYOND: f64 = 1.001;

/// A convex polygon, counterclockwise.
#[derive(Debug, Clone, Copy)]
pub struct Polygon<T> {
    vertices: [[T; 2]; CAPACITY],
    count: usize,
}

/// a × b.
pub fn cross<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[1] - a[1] * b[0]
}

/// a − b.
pub fn minus<T: Scalar>(a: [T; 2], b: [T; 2]) -> [T; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// A number times a constant.
pub fn scaled<T: Scalar>(number: T, factor: f64) -> T {
    number.map(|value| value * factor, |_| factor)
}

impl<T: Scalar> Polygon<T> {
    /// Collect at most twelve vertices.
    pub fn new(vertices: impl IntoIterator<Item = [T; 2]>) -> Self {
        let mut polygon = Self { vertices: [[T::constant(0.0); 2]; CAPACITY], count: 0 };
        vertices.into_iter().for_each(|vertex| polygon.push(vertex));
        polygon
    }

    fn push(&mut self, vertex: [T; 2]) {
        if let Some(place) = self.vertices.get_mut(self.count) {
            *place = vertex;
            self.count += 1;
        }
    }

    pub fn vertices(&self) -> &[[T; 2]] {
        &self.vertices[..self.count]
    }

    /// The edges, each from its first to its second end.
    pub fn edges(&self) -> impl Iterator<Item = [[T; 2]; 2]> + '_ {
        let vertices = self.vertices();
        vertices.iter().zip(vertices.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
    }

    /// The part inside `other`. What lies within `tolerance` (twice an area) of an edge of `other` is taken to that
    /// edge, so where edges coincide, the derivatives are those of the edges of `other`.
    pub fn clipped(self, other: &Self, tolerance: f64) -> Self {
        other.edges().fold(self, |rest, edge| rest.cut(edge, tolerance))
    }

    fn cut(&self, [a, b]: [[T; 2]; 2], tolerance: f64) -> Self {
        let along = minus(b, a);
        let sides = self.vertices.map(|vertex| cross(along, minus(vertex, a)));
        let inside = |k: usize| sides[k].value() > tolerance;
        let mut rest = Self::new([]);
        for here in 0..self.count {
            let next = (here + 1) % self.count;
            if inside(here) {
                rest.push(self.vertices[here]);
            }
            if inside(here) != inside(next) {
                let (p, q) = if inside(here) { (here, next) } else { (next, here) };
                rest.push(meeting([self.vertices[p], self.vertices[q]], [sides[p], sides[q]]));
            }
        }
        rest
    }

    /// Twice the area.
    fn doubled_area(&self) -> T {
        let origin = self.vertices[0];
        self.edges().fold(T::constant(0.0), |sum, [a, b]| sum + cross(minus(a, origin), minus(b, origin)))
    }

    pub fn area(&self) -> T {
        scaled(self.doubled_area(), 0.5)
    }

    /// The centroid of the area, which is not zero.
    pub fn centroid(&self) -> [T; 2] {
        let origin = self.vertices[0];
        let (mut area, mut moment) = (T::constant(0.0), [T::constant(0.0); 2]);
        for [a, b] in self.edges() {
            let (a, b) = (minus(a, origin), minus(b, origin));
            let part = cross(a, b);
            area += part;
            (0..2).for_each(|axis| moment[axis] += (a[axis] + b[axis]) * part);
        }
        std::array::from_fn(|axis| origin[axis] + scaled(moment[axis] / area, 1.0 / 3.0))
    }
}

impl Polygon<f64> {
    /// The area common with `other`.
    pub fn overlap(&self, other: &Self, tolerance: f64) -> f64 {
        let apart = |axis: usize| {
            let [low, high] = self.range(axis);
            let [other_low, other_high] = other.range(axis);
            low >= other_high || high <= other_low
        };
        if apart(0) || apart(1) { 0.0 } else { self.clipped(other, tolerance).area() }
    }

    fn range(&self, axis: usize) -> [f64; 2] {
        let widened = |[low, high]: [f64; 2], v: &[f64; 2]| [low.min(v[axis]), high.max(v[axis])];
        self.vertices().iter().fold([f64::INFINITY, f64::NEG_INFINITY], widened)
    }
}

/// Where the segment from an inner to an outer point crosses the line to which they have the signed distances `sides`.
fn meeting<T: Scalar>([p, q]: [[T; 2]; 2], sides: [T; 2]) -> [T; 2] {
    let share = sides[0] / (sides[0] - sides[1]);
    if share.value() > BEYOND {
        return q;
    }
    let step = minus(q, p);
    std::array::from_fn(|axis| p[axis] + step[axis] * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    fn square<T: Scalar>(low: T, high: T) -> Polygon<T> {
        Polygon::new([[low, low], [high, low], [high, high], [low, high]])
    }

    #[test]
    fn area_and_centroid_do_not_see_vertices_on_edges() {
        let corners = [[3.0, 1.0], [5.0, 1.0], [4.0, 4.0]];
        let with_more = [[3.0, 1.0], [3.1, 1.0], [3.5, 1.0], [5.0, 1.0], [4.5, 2.5], [4.0, 4.0]];
        for polygon in [Polygon::new(corners), Polygon::new(with_more)] {
            let centroid = polygon.centroid();
            assert!((polygon.area() - 3.0).abs() < 1e-14);
            assert!((centroid[0] - 4.0).abs() < 1e-14 && (centroid[1] - 2.0).abs() < 1e-14);
        }
    }

    #[test]
    fn squares_meet_in_squares_and_octagons() {
        let (unit, shifted) = (square(0.0, 1.0), square(0.25, 1.25));
        assert!((unit.clipped(&shifted, 0.0).area() - 0.5625).abs() < 1e-15);
        assert!((unit.overlap(&shifted, 0.0) - 0.5625).abs() < 1e-15);
        assert_eq!(unit.overlap(&square(1.0, 2.0), 0.0), 0.0);
        let diamond = Polygon::new([[0.5, -0.2], [1.2, 0.5], [0.5, 1.2], [-0.2, 0.5]]);
        let octagon = diamond.clipped(&unit, 1e-12);
        // The diamond has the area 0.98; four corners of height 0.2 and width 0.4 lie outside the square.
        assert!(octagon.vertices().len() == 8 && (octagon.area() - 0.82).abs() < 1e-15);
    }

    #[test]
    fn coinciding_edges_move_with_the_clipping_polygon() {
        // Area (1 + ε)² of the polygon that clips, whatever the other does.
        let (still, moves) =
            (square(Dual::new(0.0, 0.0), Dual::new(1.0, 0.0)), square(Dual::new(0.0, 0.0), Dual::new(1.0, 1.0)));
        assert!((still.clipped(&moves, 1e-11).area().derivative - 2.0).abs() < 1e-14);
        assert!(moves.clipped(&still, 1e-11).area().derivative.abs() < 1e-14);
        // Skew corners too.
        let skew = |s: f64| {
            let number = |value: f64, slope: f64| Dual::new(value, s * slope);
            Polygon::new([
                [number(0.0, 0.3), number(0.0, -0.4)],
                [number(1.0, 0.2), number(0.1, 0.5)],
                [number(1.4, -0.7), number(0.9, 0.1)],
                [number(-0.2, 0.6), number(1.1, 0.8)],
            ])
        };
        let exact = skew(1.0).area().derivative;
        assert!((skew(0.0).clipped(&skew(1.0), 1e-11).area().derivative - exact).abs() < 1e-13 && exact.abs() > 0.1);
        assert!((skew(-3.0).clipped(&skew(1.0), 1e-11).area().derivative - exact).abs() < 1e-13);
    }
}
