//! Heights of a surface over a plane.

/// A height with its derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Jet {
    pub height: f64,
    pub slopes: [f64; 2],
    pub second: [[f64; 2]; 2],
}
