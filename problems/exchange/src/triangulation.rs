//! Triangles on a surface of smooth pieces, with a bound of their distance from it.
//!
//! ```text
//! |vᵀ∇²F v| ≤ c₁₁ v₁² + 2 c₁₂ |v₁ v₂| + c₂₂ v₂²   ⇒   |F − I F| ≤ (c₁₁ h₁² + 2 c₁₂ h₁h₂ + c₂₂ h₂²)/8
//! ```
//! on a right triangle with legs h₁, h₂ along the axes, where I F is linear and equals F at the corners p: with
//! barycentric coordinates λ of x, F − I F = −½ Σ λ (p − x)ᵀ∇²F (p − x) by Taylor's formula at x, and Σ λ (p − x)₁² =
//! s(1 − s) h₁² ≤ h₁²/4 with the share s of the corners at one end of the leg. The vertical error bounds the distance.
//! Lines stand where F has kinks, so that F is smooth inside every triangle. Corners are rounded to single precision,
//! which moves them by at most δ = √3 · 2⁻²⁴ · (largest coordinate); triangles keep within (tolerance − δ) + δ.

use crate::error::{ExchangeError, ascending};
use crate::heights::Heights;

/// Three corners, counterclockwise as seen from outside, mm.
pub type Triangle = [[f32; 3]; 3];

/// Most triangles of a surface: a file of 200 MB.
const MOST_TRIANGLES: f64 = 4e6;

/// Least tolerance in roundings δ of a corner.
const LEAST_ROUNDINGS: f64 = 4.0;

/// Lines on which triangles keep within `tolerance` (mm) of a surface that is smooth between the lines `kinks` (mm; the
/// edges included), with `curvature` = [c₁₁, c₁₂, c₂₂] (1/mm) there: bounds of its second derivatives are such numbers.
/// `reach` is the largest coordinate of the surface, mm.
///
/// # Errors
/// [`ExchangeError::Tolerance`] for a tolerance that single precision does not reach,
/// [`ExchangeError::TooManyTriangles`], [`ExchangeError::Number`] for kinks that single precision cannot tell apart,
/// and derivatives that are not finite.
pub fn lines(
    kinks: [&[f64]; 2],
    curvature: [f64; 3],
    reach: f64,
    tolerance: f64,
) -> Result<[Vec<f64>; 2], ExchangeError> {
    let rounding = 3.0_f64.sqrt() * 0.5 * f64::from(f32::EPSILON) * reach;
    let least = LEAST_ROUNDINGS * rounding;
    if tolerance.is_nan() || tolerance <= 0.0 || tolerance < least {
        return Err(ExchangeError::Tolerance { value: tolerance, least });
    }
    if let Some(index) = curvature.iter().position(|value| !value.is_finite()) {
        let (what, value, allowed) = ("curvature", curvature[index], "finite numbers");
        return Err(ExchangeError::Number { what, index, value, allowed });
    }
    let lengths = kinks.map(|kinks| kinks.last().copied().unwrap_or(0.0) - kinks.first().copied().unwrap_or(0.0));
    let steps = steps(curvature, lengths, tolerance - rounding);
    let pieces = |axis: usize| {
        let (kinks, step): (&[f64], f64) = (kinks[axis], steps[axis]);
        kinks.windows(2).map(move |pair| ((pair[1] - pair[0]) / step).ceil().max(1.0))
    };
    let needed = 2.0 * pieces(0).sum::<f64>() * pieces(1).sum::<f64>();
    if needed.is_nan() || needed > MOST_TRIANGLES {
        return Err(ExchangeError::TooManyTriangles { value: tolerance, needed, most: MOST_TRIANGLES });
    }
    let divided: [Vec<f64>; 2] = std::array::from_fn(|axis| {
        let spans = kinks[axis].windows(2).zip(pieces(axis)).flat_map(|(pair, count)| {
            (0..count as usize).map(move |part| pair[0] + (pair[1] - pair[0]) * part as f64 / count)
        });
        spans.chain(kinks[axis].last().copied()).collect()
    });
    divided.iter().try_for_each(|lines| ascending(lines))?;
    Ok(divided)
}

/// Largest steps h₁, h₂ within a chord error; infinite along an axis without curvature.
fn steps([first, mixed, second]: [f64; 3], lengths: [f64; 2], chord: f64) -> [f64; 2] {
    // Where an axis has no curvature of its own, the mixed derivative limits both steps in the proportion of the
    // lengths.
    let proportion = lengths[1] / lengths[0];
    let weights = [first.max(mixed * proportion), second.max(mixed / proportion)];
    let part = |value: f64, weight: f64| if value > 0.0 { value / weight } else { 0.0 };
    let sum = part(first, weights[0]) + part(second, weights[1]) + 2.0 * part(mixed, (weights[0] * weights[1]).sqrt());
    weights.map(|weight| if weight > 0.0 { (8.0 * chord / (sum * weight)).sqrt() } else { f64::INFINITY })
}

/// The surface alone, seen from above.
pub fn sheet(heights: &Heights) -> Vec<Triangle> {
    let points: Vec<[f32; 3]> = heights.points().map(rounded).collect();
    surface(heights.counts()).map(|corners| corners.map(|corner| points[corner])).collect()
}

/// The closed body between the surface and the horizontal plane at the height `plane`, mm, which lies below or above
/// all of it.
///
/// # Errors
/// [`ExchangeError::Thickness`] where heights lie on the other side of the plane or on it.
pub fn solid(heights: &Heights, plane: f64) -> Result<Vec<Triangle>, ExchangeError> {
    let mut points: Vec<[f32; 3]> = heights.points().map(rounded).collect();
    let level = plane as f32;
    let below = points.first().is_some_and(|point| level < point[2]);
    if let Some(index) = points.iter().position(|point| point[2] == level || (level < point[2]) != below) {
        let [x1, x2, height] = points[index].map(f64::from);
        return Err(ExchangeError::Thickness { x1, x2, height, plane });
    }
    let counts = heights.counts();
    let rim = rim(counts);
    let (first, count) = (points.len(), rim.len());
    points.extend(rim.iter().map(|&corner| [points[corner][0], points[corner][1], level]).collect::<Vec<_>>());
    let middle = |axis: usize| {
        let lines = &heights.lines()[axis];
        ((lines[0] + lines[lines.len() - 1]) / 2.0) as f32
    };
    let centre = points.len();
    points.push([middle(0), middle(1), level]);
    let sides = (0..count).flat_map(|place| {
        let next = (place + 1) % count;
        let (a, b, low_a, low_b) = (rim[place], rim[next], first + place, first + next);
        [[low_a, low_b, b], [low_a, b, a], [centre, low_b, low_a]]
    });
    let corners = surface(counts).chain(sides);
    // Above the surface, everything is seen from the other side.
    let outward = |[a, b, c]: [usize; 3]| if below { [a, b, c] } else { [a, c, b] };
    Ok(corners.map(|corners| outward(corners).map(|corner| points[corner])).collect())
}

fn rounded(point: [f64; 3]) -> [f32; 3] {
    point.map(|coordinate| coordinate as f32)
}

/// Corners of the triangles of the surface, counterclockwise from above.
fn surface([n1, n2]: [usize; 2]) -> impl Iterator<Item = [usize; 3]> {
    (0..n1 - 1).flat_map(move |i| {
        (0..n2 - 1).flat_map(move |j| {
            let here = i * n2 + j;
            [[here, here + n2, here + n2 + 1], [here, here + n2 + 1, here + 1]]
        })
    })
}

/// The crossings on the edge of the rectangle, counterclockwise from above.
fn rim([n1, n2]: [usize; 2]) -> Vec<usize> {
    let along_first = (0..n1 - 1).map(|i| i * n2);
    let along_second = (0..n2 - 1).map(|j| (n1 - 1) * n2 + j);
    let back_first = (1..n1).rev().map(|i| i * n2 + n2 - 1);
    let back_second = (1..n2).rev();
    along_first.chain(along_second).chain(back_first).chain(back_second).collect()
}
