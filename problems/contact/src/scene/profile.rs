//! A plane curve through points, with its signed distance: the meridian of a surface of revolution.
//!
//! ```text
//! cubic Hermite pieces over the chord length;  slopes from polynomials of degree ≤ 4 through the points around
//! corners, where the polygon turns by more than 30°, end the smooth branches
//! distance d along the normal m, curvature κ of the curve:   ∇²d = κ/(1 + κ d) t tᵀ;   of a corner:  (1/d) t tᵀ
//! ```
//! The curve runs with the outside on its right.

use crate::error::SceneError;
use crate::scene::nearest_place::nearest_place;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Cosine of the turn of a polygon from which a point is a corner: 30°.
const SMOOTH: f64 = 0.866_025_403_784_438_6;
/// Points through which a polynomial gives a slope.
const WINDOW: usize = 5;

/// Points (ρ, z) of a meridian in their order, mm: from one end to the other, or closed where the last is the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<[f64; 2]>", into = "Vec<[f64; 2]>")]
pub struct Profile(Arc<Curve>);

#[derive(Debug, PartialEq)]
struct Curve {
    points: Vec<[f64; 2]>,
    pieces: Vec<Cubic>,
}

/// Signed distance of a point of the half-plane from a meridian, positive outside.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeridianDistance {
    pub value: f64,
    /// The unit normal m.
    pub normal: [f64; 2],
    /// k, 1/mm.
    pub bending: f64,
}

/// A cubic between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cubic {
    /// The points of its Bézier polygon.
    polygon: [[f64; 2]; 4],
    /// Centre and radius of a circle around it.
    bound: ([f64; 2], f64),
    /// Whether the curve ends or has a corner at the ends of the piece.
    is_end: [bool; 2],
}

/// The nearest point of a piece.
struct Nearest {
    piece: usize,
    /// From 0 to 1.
    place: f64,
    distance: f64,
}

impl TryFrom<Vec<[f64; 2]>> for Profile {
    type Error = SceneError;

    fn try_from(points: Vec<[f64; 2]>) -> Result<Self, SceneError> {
        Self::new(points)
    }
}

impl From<Profile> for Vec<[f64; 2]> {
    fn from(profile: Profile) -> Self {
        profile.0.points.clone()
    }
}

impl Profile {
    /// The curve through points (ρ, z), mm. Its outside is the side away from the axis of a curve from a smaller to a
    /// larger z, and that outside of a closed curve.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for fewer than two points, numbers that are not finite, negative radii, points that
    /// coincide, and an open curve that ends at the z at which it begins.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, SceneError> {
        SceneError::require(points.len() >= 2, "points of a profile", points.len(), "at least 2")?;
        for (index, [radius, height]) in points.iter().enumerate() {
            let valid = *radius >= 0.0 && radius.is_finite() && height.is_finite();
            let field = format!("point {} of a profile", index + 1);
            let allowed = "finite numbers (mm), the radius ≥ 0";
            SceneError::require(valid, field, format!("({radius}, {height})"), allowed)?;
        }
        for (index, pair) in points.windows(2).enumerate() {
            let field = format!("points {} and {} of a profile", index + 1, index + 2);
            SceneError::require(pair[0] != pair[1], field, format!("{:?}", pair[0]), "two places")?;
        }
        let (first, last) = (points[0], points[points.len() - 1]);
        let is_closed = first == last;
        let rise = if is_closed { area(&points) } else { last[1] - first[1] };
        let allowed = "an end above or below the first point, or at the first point";
        SceneError::require(rise != 0.0, "the last point of a profile", format!("{last:?}"), allowed)?;
        let mut ordered = points.clone();
        if rise < 0.0 {
            ordered.reverse();
        }
        Ok(Self(Arc::new(Curve { pieces: pieces(&ordered, is_closed), points })))
    }

    /// The signed distance of a place (ρ, z).
    pub(super) fn distance(&self, x: [f64; 2]) -> Result<MeridianDistance, &'static str> {
        let to = |point: [f64; 2]| (point[0] - x[0]).hypot(point[1] - x[1]);
        let reach = self.0.points.iter().map(|point| to(*point)).fold(f64::INFINITY, f64::min);
        let near = |piece: &Cubic| to(piece.bound.0) - piece.bound.1 <= reach;
        let candidates = self.0.pieces.iter().enumerate().filter(|(_, piece)| near(piece));
        let nearest = candidates.map(|(number, piece)| {
            let place = piece.nearest(x);
            Nearest { piece: number, place, distance: to(piece.at(place)) }
        });
        let nearest = nearest.min_by(|a, b| a.distance.total_cmp(&b.distance));
        let Some(Nearest { piece, place, distance }) = nearest else { return Err("the profile has no nearest point") };
        let own = &self.0.pieces[piece];
        let end = usize::from(place >= 0.5);
        if (place == 0.0 || place == 1.0) && own.is_end[end] {
            return Ok(self.at_corner(piece, end, x, distance));
        }
        let (normal, curvature) = (own.normal(place), own.curvature(place));
        let point = own.at(place);
        let value = (x[0] - point[0]) * normal[0] + (x[1] - point[1]) * normal[1];
        let room = 1.0 + curvature * value;
        if room <= 0.0 {
            return Err("its nearest point on the profile is not unique: the gap exceeds the radius of curvature");
        }
        Ok(MeridianDistance { value, normal, bending: curvature / room })
    }

    /// The distance of a place from an end of the curve, or from a corner between two branches.
    fn at_corner(&self, piece: usize, end: usize, x: [f64; 2], distance: f64) -> MeridianDistance {
        let own = &self.0.pieces[piece];
        let point = own.polygon[3 * end];
        let away = [x[0] - point[0], x[1] - point[1]];
        let normal = own.normal(end as f64);
        let meets = |other: &&Cubic| other.is_end[1 - end] && other.polygon[3 * (1 - end)] == point;
        let other = self.0.pieces.iter().find(meets).map(|other| other.normal((1 - end) as f64));
        let mean = other.map_or(normal, |other| {
            let sum = [normal[0] + other[0], normal[1] + other[1]];
            let size = sum[0].hypot(sum[1]);
            if size > 0.0 { sum.map(|part| part / size) } else { normal }
        });
        if distance == 0.0 {
            return MeridianDistance { value: 0.0, normal: mean, bending: 0.0 };
        }
        // Beside the end of a curve there is nothing to lie inside of.
        let is_inside = other.is_some() && away[0] * mean[0] + away[1] * mean[1] < 0.0;
        let sign = if is_inside { -1.0 } else { 1.0 };
        let value = sign * distance;
        MeridianDistance { value, normal: away.map(|part| part / value), bending: 1.0 / value }
    }
}

/// Twice the area that a closed curve runs around counterclockwise.
fn area(points: &[[f64; 2]]) -> f64 {
    points.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]).sum()
}

/// The pieces of a curve, branch by branch.
fn pieces(points: &[[f64; 2]], is_closed: bool) -> Vec<Cubic> {
    let count = points.len() - 1;
    let turns = |before: usize, after: usize| {
        let (a, b) = (chord(points, before), chord(points, after));
        a[0] * b[0] + a[1] * b[1] < SMOOTH * a[0].hypot(a[1]) * b[0].hypot(b[1])
    };
    let corner = (0..count).find(|&k| if k == 0 { is_closed && turns(count - 1, 0) } else { turns(k - 1, k) });
    match corner {
        None if is_closed => smooth_ring(&points[..count]),
        // A closed curve begins at a corner.
        Some(first) if is_closed && first > 0 => {
            let mut turned = points[first..count].to_vec();
            turned.extend_from_slice(&points[..=first]);
            pieces(&turned, true)
        }
        _ => {
            let corners = (1..count).filter(|&k| turns(k - 1, k));
            let ends: Vec<usize> = std::iter::once(0).chain(corners).chain([count]).collect();
            ends.windows(2).flat_map(|pair| branch(&points[pair[0]..=pair[1]])).collect()
        }
    }
}

fn chord(points: &[[f64; 2]], k: usize) -> [f64; 2] {
    [0, 1].map(|axis| points[k + 1][axis] - points[k][axis])
}

/// The pieces of a closed curve without corners, through each of its points once.
fn smooth_ring(points: &[[f64; 2]]) -> Vec<Cubic> {
    let count = points.len();
    let around: Vec<[f64; 2]> =
        (0..count + 2 * WINDOW).map(|k| points[(k + count * WINDOW - WINDOW) % count]).collect();
    let mut pieces = branch(&around)[WINDOW..WINDOW + count].to_vec();
    pieces.iter_mut().for_each(|piece| piece.is_end = [false; 2]);
    pieces
}

/// The pieces of a smooth branch between its ends.
fn branch(points: &[[f64; 2]]) -> Vec<Cubic> {
    let last = points.len() - 1;
    let lengths: Vec<f64> = (0..last).map(|k| chord(points, k)).map(|[a, b]| a.hypot(b)).collect();
    let mut places = vec![0.0; points.len()];
    (0..last).for_each(|k| places[k + 1] = places[k] + lengths[k]);
    let slopes: Vec<[f64; 2]> = (0..=last)
        .map(|at| {
            let first = at.saturating_sub(WINDOW / 2).min((last + 1).saturating_sub(WINDOW));
            let around = first..=(first + WINDOW - 1).min(last);
            let own = &places[around.clone()];
            let weights = around.clone().map(|k| derivative_weight(own, k - first, at - first));
            around
                .clone()
                .zip(weights)
                .fold([0.0; 2], |sum, (k, weight)| [sum[0] + weight * points[k][0], sum[1] + weight * points[k][1]])
        })
        .collect();
    let piece = |k: usize| {
        let (start, end, third) = (points[k], points[k + 1], lengths[k] / 3.0);
        let from = |point: [f64; 2], way: f64, slope: [f64; 2]| [0, 1].map(|axis| point[axis] + way * slope[axis]);
        let polygon = [start, from(start, third, slopes[k]), from(end, -third, slopes[k + 1]), end];
        let centre = [0, 1].map(|axis| 0.5 * (start[axis] + end[axis]));
        let radius = polygon.iter().map(|p| (p[0] - centre[0]).hypot(p[1] - centre[1])).fold(0.0, f64::max);
        Cubic { polygon, bound: (centre, radius), is_end: [k == 0, k + 1 == last] }
    };
    (0..last).map(piece).collect()
}

/// The derivative at place `at` of the polynomial that is one at place `k` and zero at the others.
fn derivative_weight(places: &[f64], k: usize, at: usize) -> f64 {
    let others = || (0..places.len()).filter(move |&j| j != k);
    if k == at {
        return others().map(|j| 1.0 / (places[at] - places[j])).sum();
    }
    let factors = others().filter(|&j| j != at).map(|j| (places[at] - places[j]) / (places[k] - places[j]));
    factors.product::<f64>() / (places[k] - places[at])
}

impl Cubic {
    fn at(&self, t: f64) -> [f64; 2] {
        let u = 1.0 - t;
        let weights = [u * u * u, 3.0 * u * u * t, 3.0 * u * t * t, t * t * t];
        [0, 1].map(|axis| (0..4).map(|k| weights[k] * self.polygon[k][axis]).sum())
    }

    fn first(&self, t: f64) -> [f64; 2] {
        let u = 1.0 - t;
        let weights = [3.0 * u * u, 6.0 * u * t, 3.0 * t * t];
        [0, 1].map(|axis| (0..3).map(|k| weights[k] * (self.polygon[k + 1][axis] - self.polygon[k][axis])).sum())
    }

    fn second(&self, t: f64) -> [f64; 2] {
        let p = &self.polygon;
        [0, 1].map(|axis| {
            let [start, end] = [0, 1].map(|k| p[k + 2][axis] - 2.0 * p[k + 1][axis] + p[k][axis]);
            6.0 * ((1.0 - t) * start + t * end)
        })
    }

    /// The unit normal to the right.
    fn normal(&self, t: f64) -> [f64; 2] {
        let [radial, axial] = self.first(t);
        let size = radial.hypot(axial);
        [axial / size, -radial / size]
    }

    /// Positive where the curve bends away from its normal, as a circle from its outer one.
    fn curvature(&self, t: f64) -> f64 {
        let ([a, b], [c, d]) = (self.first(t), self.second(t));
        (a * d - b * c) / a.hypot(b).powi(3)
    }

    /// The place of the point nearest to x.
    fn nearest(&self, x: [f64; 2]) -> f64 {
        let from = |t: f64| {
            let point = self.at(t);
            [point[0] - x[0], point[1] - x[1]]
        };
        let product = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        nearest_place(|t| product(from(t), from(t)), |t| product(from(t), self.first(t)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of an arc about (3, 1) of radius 2.
    fn arc(count: usize, from: f64, to: f64) -> Vec<[f64; 2]> {
        let angle = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
        (0..count).map(|k| [3.0 + 2.0 * angle(k).cos(), 1.0 + 2.0 * angle(k).sin()]).collect()
    }

    /// The largest error of the distance beside an arc.
    fn error(profile: &Profile) -> f64 {
        let places = (0..40).map(|k| (-0.9 + 0.045 * f64::from(k), 1.5 + 0.02 * f64::from(k)));
        let errors = places.map(|(angle, radius)| {
            let found = profile.distance([3.0 + radius * angle.cos(), 1.0 + radius * angle.sin()]).expect("a foot");
            (found.value - (radius - 2.0)).abs()
        });
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn arcs_are_of_fourth_order_and_smooth_rings_have_no_ends() {
        let open = |count| Profile::new(arc(count, -1.2, 1.2)).expect("an arc");
        let errors = [9, 17, 33].map(|count| error(&open(count)));
        assert!(errors[0] / errors[1] > 12.0 && errors[1] / errors[2] > 12.0 && errors[2] < 1e-6, "{errors:?}");
        let ring = |count: usize| {
            let mut points = arc(count, 0.3, 0.3 + std::f64::consts::TAU);
            points[count - 1] = points[0];
            Profile::new(points).expect("a ring")
        };
        let errors = [17, 33, 65].map(|count| error(&ring(count)));
        assert!(errors[0] / errors[1] > 12.0 && errors[1] / errors[2] > 12.0 && errors[2] < 1e-5, "{errors:?}");
        // Whatever sense the points run in.
        let mut backwards = arc(9, -1.2, 1.2);
        backwards.reverse();
        assert!((error(&Profile::new(backwards).expect("an arc")) - error(&open(9))).abs() < 1e-14);
    }

    #[test]
    fn corners_and_ends_are_points() {
        // A step from radius 2 to radius 1, seen from outside: convex at (2, 1), concave at (1, 1).
        let profile = Profile::new(vec![[2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0]]).expect("a step");
        let value = |x| profile.distance(x).expect("a foot").value;
        let cases = [
            ([2.5, 0.5], 0.5),
            ([2.3, 1.4], 0.5),
            ([1.8, 1.1], 0.1),
            ([1.2, 2.0], 0.2),
            ([1.9, 0.7], -0.1),
            ([0.5, 2.0], -0.5),
            ([0.6, 0.7], -0.5),
            ([1.3, 3.4], 0.5),
            ([0.7, 3.4], 0.5),
        ];
        for (x, expected) in cases {
            assert!((value(x) - expected).abs() < 1e-14, "{x:?}: {}", value(x));
        }
        let at_corner = profile.distance([2.0, 1.0]).expect("a foot");
        assert!(at_corner.value == 0.0 && (at_corner.normal[0] - 0.5_f64.sqrt()).abs() < 1e-15, "{at_corner:?}");
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        for (points, words) in [
            (vec![[1.0, 0.0]], "points of a profile"),
            (vec![[1.0, 0.0], [-1.0, 2.0]], "point 2 of a profile"),
            (vec![[1.0, 0.0], [1.0, 0.0]], "points 1 and 2 of a profile"),
            (vec![[1.0, 0.0], [2.0, 1.0], [2.0, 0.0]], "the last point of a profile"),
        ] {
            let refusal = Profile::new(points).expect_err(words).to_string();
            assert!(refusal.starts_with(words), "{refusal}");
        }
    }
}
