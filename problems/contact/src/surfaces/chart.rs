//! Parameters of a face: places on a plane, a cylinder or a sphere.

use super::fit::Samples;
use super::net::SplineNet;
use crate::linear::FactorizationError;
use crate::mortar::vector::{across, cross, dot, length, plus};
use crate::mortar::{Facet, Primitive, doubled_area};
use crate::patches::fit;

/// Least share of the smallest in the largest scale of area between a face and its parameters.
const LEAST_SHARE: f64 = 0.2;
/// Angle of an interval between knots of the base, at most; and their largest number.
const STEP: f64 = 0.15;
const MOST: usize = 64;
/// Points per interval that the surface of the base goes through.
const SAMPLES: usize = 3;
/// A chart replaces one before it where its share is larger by more than this.
const BETTER: f64 = 1e-3;

/// The surface whose coordinates are the parameters.
#[derive(Debug, Clone, Copy)]
enum Base {
    Plane,
    /// Angle times radius, and the axis.
    Cylinder {
        radius: f64,
    },
    /// Stereographic projection from the point opposite to the middle of the face.
    Sphere {
        radius: f64,
    },
}

/// Parameters (mm) of the points of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chart {
    base: Base,
    point: [f64; 3],
    /// Two directions, and the normal of the plane, the axis of the cylinder or the direction to the middle.
    frame: [[f64; 3]; 3],
    /// Turns the parameters, so that the rectangle around them is small.
    turn: [f64; 2],
    /// −1: the first parameter runs back, so that the normal of the surface is the outward one.
    sign: f64,
}

impl Chart {
    /// The chart of the least distortion; none where every one folds the face, or nearly.
    pub(super) fn new(facets: &[Facet], normals: &[[f64; 3]], x: &dyn Fn(u32) -> [f64; 3]) -> Option<Self> {
        let mut nodes: Vec<u32> = facets.iter().flat_map(|facet| facet.corners().iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let points: Vec<[f64; 3]> = nodes.iter().map(|&node| x(node)).collect();
        let mut best: Option<(Self, f64)> = None;
        let area = |facet: usize| {
            let corners: Vec<[f64; 3]> = facets[facet].corners().iter().map(|&node| x(node)).collect();
            length(doubled_area(&corners))
        };
        for chart in Self::candidates(&points, normals, area).into_iter().flatten() {
            let (share, sign) = chart.least_share(facets, x);
            if share >= LEAST_SHARE && best.is_none_or(|(_, other)| share > other + BETTER) {
                best = Some((Self { sign, ..chart }, share));
            }
        }
        let (chart, _) = best?;
        let turned = !matches!(chart.base, Base::Cylinder { .. });
        let places: Vec<[f64; 2]> = points.iter().map(|&x| chart.place(x)).collect();
        Some(if turned { Self { turn: turn(places), ..chart } } else { chart })
    }

    fn candidates(points: &[[f64; 3]], normals: &[[f64; 3]], area: impl Fn(usize) -> f64) -> [Option<Self>; 3] {
        let centre = fit::mean(points);
        let primitive = fit::primitive(points, normals);
        let chart = |base, point, frame| Self { base, point, frame, turn: [1.0, 0.0], sign: 1.0 };
        let about = |first: [f64; 3], third: [f64; 3]| [first, cross(third, first), third];
        let mean = fit::mean(normals);
        let size = length(mean);
        let plane = (size > 0.0).then(|| {
            let normal = mean.map(|x| x / size);
            let [first, second] = across(normal);
            chart(Base::Plane, centre, [first, second, normal])
        });
        let line = match primitive {
            Some(Primitive::Cylinder { point, axis, radius } | Primitive::Cone { point, axis, radius, .. }) => {
                Some((point, axis, radius.abs()))
            }
            _ => {
                // Small facets at an end may look along the axis.
                let axis = fit::least_spread(normals, area);
                fit::circle(points, axis, centre).map(|(point, radius)| (point, axis, radius))
            }
        };
        let cylinder = line.and_then(|(point, axis, radius)| {
            let axis = forward(axis);
            // Angles are cut opposite to the middle of the face.
            let from = |x: &[f64; 3]| {
                let from = plus(*x, -1.0, point);
                let outward = plus(from, -dot(from, axis), axis);
                outward.map(|x| x / length(outward))
            };
            let middle = fit::mean(&points.iter().map(from).collect::<Vec<_>>());
            let size = length(middle);
            (size > 0.0).then(|| chart(Base::Cylinder { radius }, point, about(middle.map(|x| x / size), axis)))
        });
        let is_sphere = |found: &Primitive| matches!(found, Primitive::Sphere { .. });
        let sphere = primitive.filter(is_sphere).or_else(|| fit::sphere(points, centre)).and_then(|sphere| {
            let Primitive::Sphere { point, radius } = sphere else { return None };
            let from = plus(centre, -1.0, point);
            let size = length(from);
            (size > 0.0).then(|| {
                let middle = from.map(|x| x / size);
                let [first, second] = across(middle);
                chart(Base::Sphere { radius }, point, [first, second, middle])
            })
        });
        [plane, cylinder, sphere]
    }

    /// The parameters of a point, mm.
    pub(super) fn place(&self, x: [f64; 3]) -> [f64; 2] {
        let from = plus(x, -1.0, self.point);
        let [a, b, c] = self.frame.map(|direction| dot(from, direction));
        let [u, v] = match self.base {
            Base::Plane => [a, b],
            Base::Cylinder { radius } => [radius * b.atan2(a), c],
            Base::Sphere { radius } => [a, b].map(|part| 2.0 * radius * part / (length(from) + c)),
        };
        let [cosine, sine] = self.turn;
        let u = self.sign * u;
        [cosine * u + sine * v, cosine * v - sine * u]
    }

    /// The point of the base with some parameters.
    fn point(&self, [p, q]: [f64; 2]) -> [f64; 3] {
        let [cosine, sine] = self.turn;
        let (u, v) = (self.sign * (cosine * p - sine * q), sine * p + cosine * q);
        let [a, b, c] = match self.base {
            Base::Plane => [u, v, 0.0],
            Base::Cylinder { radius } => [radius * (u / radius).cos(), radius * (u / radius).sin(), v],
            Base::Sphere { radius } => {
                let square = (u * u + v * v) / (4.0 * radius * radius);
                [u / (1.0 + square), v / (1.0 + square), radius * (1.0 - square) / (1.0 + square)]
            }
        };
        let [first, second, third] = self.frame;
        plus(plus(plus(self.point, a, first), b, second), c, third)
    }

    /// The base over a rectangle of parameters, given by its least corner and its sides.
    pub(super) fn surface(&self, corner: [f64; 2], sides: [f64; 2]) -> Result<SplineNet, FactorizationError> {
        let along = |side: f64, radius: f64| ((side / radius / STEP).ceil() as usize).clamp(1, MOST);
        let intervals = match self.base {
            Base::Plane => [1, 1],
            Base::Cylinder { radius } => [along(sides[0], radius), 1],
            Base::Sphere { radius } => sides.map(|side| along(side, radius)),
        };
        let counts = intervals.map(|count| SAMPLES * (count + 1));
        let places: Vec<[f64; 2]> = (0..=counts[0])
            .flat_map(|i| (0..=counts[1]).map(move |j| [i as f64 / counts[0] as f64, j as f64 / counts[1] as f64]))
            .collect();
        let point = |place: &[f64; 2]| self.point([0, 1].map(|axis| corner[axis] + sides[axis] * place[axis]));
        let points: Vec<[f64; 3]> = places.iter().map(point).collect();
        Samples { places: &places, points: &points, sides, has_waves: &|_| false }.on_net(intervals)
    }

    /// The smallest over the largest scale of area of the corners of all facets, negative where facets lie in opposite
    /// senses; and the sign of most areas.
    fn least_share(&self, facets: &[Facet], x: &dyn Fn(u32) -> [f64; 3]) -> (f64, f64) {
        let mut scales = Vec::new();
        for facet in facets {
            let corners = facet.corners();
            let count = corners.len();
            for k in 0..if count == 3 { 1 } else { count } {
                let [a, b, c] = [k, (k + 1) % count, (k + 2) % count].map(|k| x(corners[k]));
                let area = length(cross(plus(b, -1.0, a), plus(c, -1.0, a)));
                let [p, q, r] = [a, b, c].map(|x| self.place(x));
                let own = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                if area > 0.0 {
                    scales.push(own / area);
                }
            }
        }
        let sign = if scales.iter().sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
        let [least, most] = scales.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], scale| {
            [least.min(sign * scale), most.max(sign * scale)]
        });
        (least / most, sign)
    }
}

/// A direction or its opposite: the one of which the first component that is not small is positive. Rounding decides
/// which of the two an axis comes as.
fn forward(axis: [f64; 3]) -> [f64; 3] {
    let leading = axis.into_iter().find(|x| x.abs() > 0.1).unwrap_or(1.0);
    axis.map(|x| x * leading.signum())
}

/// Cosine and sine of the direction of the smallest rectangle around some places: it has a side of their convex hull.
fn turn(mut places: Vec<[f64; 2]>) -> [f64; 2] {
    places.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut hull: Vec<[f64; 2]> = Vec::new();
    let half = |hull: &mut Vec<[f64; 2]>, place: [f64; 2], first: usize| {
        while let [.., a, b] = hull[first.min(hull.len())..] {
            let left = (b[0] - a[0]) * (place[1] - a[1]) - (b[1] - a[1]) * (place[0] - a[0]);
            if left > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(place);
    };
    places.iter().for_each(|place| half(&mut hull, *place, 0));
    let first = hull.len().saturating_sub(1);
    places.iter().rev().skip(1).for_each(|place| half(&mut hull, *place, first));
    let mut best = ([1.0, 0.0], f64::INFINITY);
    for pair in hull.windows(2) {
        let way = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let size = way[0].hypot(way[1]);
        if size <= 0.0 {
            continue;
        }
        let [cosine, sine] = way.map(|x| x / size);
        let [[u0, u1], [v0, v1]] = [[cosine, sine], [-sine, cosine]].map(|[a, b]| {
            let along = hull.iter().map(|place| a * place[0] + b * place[1]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| [least.min(x), most.max(x)])
        });
        let area = (u1 - u0) * (v1 - v0);
        // Of equal rectangles, up to rounding, the first.
        if area < best.1 * (1.0 - 1e-9) {
            best = ([cosine, sine], area);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_and_points_of_the_base_belong_together() {
        let frame = [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]];
        for base in [Base::Plane, Base::Cylinder { radius: 7.0 }, Base::Sphere { radius: 7.0 }] {
            let chart = Chart { base, point: [1.0, -2.0, 30.0], frame, turn: [0.8, 0.6], sign: -1.0 };
            for place in [[0.0, 0.0], [3.0, -2.0], [-5.0, 4.0]] {
                let found = chart.place(chart.point(place));
                assert!((0..2).all(|axis| (found[axis] - place[axis]).abs() < 1e-13), "{base:?}: {found:?}");
            }
            let net = chart.surface([-5.0, -4.0], [10.0, 8.0]).expect("a surface");
            let at = |t: f64, axis: usize, side: f64| side * t - [5.0, 4.0][axis];
            for [s, t] in [[0.0, 0.0], [0.33, 0.71], [1.0, 0.2]] {
                let (found, exact) = (net.at([s, t]), chart.point([at(s, 0, 10.0), at(t, 1, 8.0)]));
                assert!(length(plus(found, -1.0, exact)) < 1e-4 * 7.0, "{base:?}: {found:?} {exact:?}");
            }
        }
    }
}
