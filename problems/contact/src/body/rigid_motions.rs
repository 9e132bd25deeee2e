//! Rigid motions of points.

/// Six motions per body: translations, and rotations about a common centre divided by a common length.
pub const MOTIONS: usize = 6;

/// Displacement (three components) of a point in the six motions; `centre`, `length` in mm.
pub fn rigid_motions(point: [f64; 3], centre: [f64; 3], length: f64) -> [[f64; 3]; MOTIONS] {
    let x: [f64; 3] = std::array::from_fn(|axis| (point[axis] - centre[axis]) / length);
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]]
}
