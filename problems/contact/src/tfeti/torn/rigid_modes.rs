//! The six rigid body modes of a floating subdomain, known analytically and orthonormalised.

use crate::body::{MOTIONS, rigid_motions};
use crate::linear::sums::Whole;
use crate::linear::vector::norm;

/// Orthonormal basis of the rigid motions of a set of nodes, six columns of three dofs per node.
pub fn orthonormal_modes(points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let count = points.len() as f64;
    let centre: [f64; 3] = std::array::from_fn(|axis| points.iter().map(|node| node[axis]).sum::<f64>() / count);
    let length = points
        .iter()
        .map(|node| (0..3).map(|axis| (node[axis] - centre[axis]).powi(2)).sum::<f64>())
        .fold(0.0, f64::max)
        .sqrt();
    let mut modes = vec![Vec::new(); MOTIONS];
    for &point in points {
        for (mode, motion) in modes.iter_mut().zip(rigid_motions(point, centre, length)) {
            mode.extend_from_slice(&motion);
        }
    }
    orthonormalise(&mut modes);
    modes
}

/// Orthonormalises by two passes of the method of Gram and Schmidt.
pub fn orthonormalise(vectors: &mut [Vec<f64>]) {
    for index in 0..vectors.len() {
        let (done, rest) = vectors.split_at_mut(index);
        let vector = &mut rest[0];
        Whole::orthogonalise(vector, done);
        let length = norm(vector);
        vector.iter_mut().for_each(|entry| *entry /= length);
    }
}
