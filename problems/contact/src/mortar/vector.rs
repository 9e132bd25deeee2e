//! Vectors in space.

use crate::scalar::Scalar;

/// a·b.
pub fn dot<T: Scalar>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub fn cross<T: Scalar>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + factor b.
pub fn plus(a: [f64; 3], factor: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + factor * b[axis])
}

/// Length of a vector.
pub fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Two unit vectors t₁, t₂ with t₁ × t₂ = n, for a unit vector n.
pub fn across(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let axis = (0..3).fold(0, |best, k| if normal[k].abs() < normal[best].abs() { k } else { best });
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    let raw = plus(unit, -normal[axis], normal);
    let size = length(raw);
    let first = raw.map(|component| component / size);
    [first, cross(normal, first)]
}
