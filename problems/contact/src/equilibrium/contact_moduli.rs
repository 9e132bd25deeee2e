//! The stiffness of what lies under a contact node: the unit of its displacements.

use crate::body::Body;
use crate::equilibrium::ContactBoundary;

/// E* per contact node, MPa: 1/E* = Σ (1 − ν²)/E over the bodies that meet there, each with the stiffest material at
/// the node.
pub(super) fn contact_moduli(bodies: &[Body], boundary: &ContactBoundary) -> Vec<f64> {
    let by_node: Vec<Vec<f64>> = bodies.iter().map(plane_moduli).collect();
    let of_point = |point: &crate::equilibrium::ContactPoint| {
        let mut compliance = 1.0 / by_node[point.body][point.node as usize];
        // The nodes of the master that have weights at some shape: its stiffest material among them.
        let masters = point.sides.iter().filter(|side| side.body != point.body);
        let stiffest = masters.map(|side| by_node[side.body][side.node as usize]).fold(0.0, f64::max);
        if stiffest > 0.0 {
            compliance += 1.0 / stiffest;
        }
        1.0 / compliance
    };
    boundary.points.iter().map(of_point).collect()
}

/// The largest E/(1 − ν²) of the cells at every node, MPa.
fn plane_moduli(body: &Body) -> Vec<f64> {
    let mut moduli = vec![0.0_f64; body.mesh.node_count()];
    for cell in 0..body.mesh.cell_count() {
        let material = body.solid.material(cell);
        let modulus = material.young_modulus() / (1.0 - material.poisson_ratio().powi(2));
        for &node in body.mesh.cell(cell).nodes {
            moduli[node as usize] = moduli[node as usize].max(modulus);
        }
    }
    moduli
}
