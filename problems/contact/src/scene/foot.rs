//! The foot of a point on a surface: unit normal and gap, with their derivatives by the position of the point.
//!
//! ```text
//! signed distance d, s = ±1 by the side of the body:   n = −s ∇d,   gap = s d,   n′ = −s ∇²d x′
//! ```

use crate::scene::side::Side;

/// Normal and gap of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Unit normal n, from the body into the obstacle.
    pub normal: [f64; 3],
    /// Gap, mm; negative where the point lies inside the obstacle.
    pub gap: f64,
    /// ∂gap/∂x.
    pub gap_slope: [f64; 3],
    /// ∂n_i/∂x_j, 1/mm.
    pub normal_slope: [[f64; 3]; 3],
}

impl Foot {
    /// From the signed distance of a surface, positive outside: its value, its gradient, which is a unit vector, and
    /// its second derivatives.
    pub(super) fn of_distance(value: f64, gradient: [f64; 3], second: [[f64; 3]; 3], side: Side) -> Self {
        let sign = if side == Side::Outside { 1.0 } else { -1.0 };
        Self {
            normal: gradient.map(|part| -sign * part),
            gap: sign * value,
            gap_slope: gradient.map(|part| sign * part),
            normal_slope: second.map(|row| row.map(|part| -sign * part)),
        }
    }
}
