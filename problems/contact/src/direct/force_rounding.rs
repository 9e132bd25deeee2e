//! What condensation has lost of the contact forces.
//!
//! ```text
//! r = f ∓ Bᵀλ − K u,   δ = C r̂,   Δλ: one Newton step of the contact problem whose jumps are moved by δ
//! ```
//! C and the factor of K carry the rounding of the stiffest entries of K. In tall columns and in nearly incompressible
//! bricks these are so much stiffer than the motion of the top that digits of C are lost, of which no residual formed
//! with C knows. r is formed with K; free rigid motions are left out of u, since K times their rounding is no force. δ
//! is the length that one step of iterative refinement would move the contact nodes by. It does not count where
//! equilibrium alone determines the forces, since condensed loads keep the resultants of the loads; Δλ shows it.

use crate::body::mesh::Block;
use crate::direct::compliant_body::CompliantBody;
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::condensation::{CondensationPattern, CondensedBody};
use crate::equilibrium::law::Linearization;
use crate::linear::dense::multiply;
use crate::linear::vector::{add_scaled, norm};
use crate::scene::BodyScene;
use faer::Mat;

/// f − K u, N: what displacements leave of forces f over a body; 0 at held dofs, which supports carry.
fn unbalanced(
    pattern: &CondensationPattern,
    scene: &BodyScene,
    block: &Block,
    u: &[f64],
    mut force: Vec<f64>,
) -> Mat<f64> {
    let local = &pattern.pattern;
    let values = local.assemble(&scene.material, |brick| block.brick(brick));
    let mut image = vec![0.0; u.len()];
    local.pattern.multiply(&values, u, &mut image);
    add_scaled(&mut force, -1.0, &image);
    let held = &pattern.held;
    Mat::from_fn(force.len(), 1, |dof, _| if held[dof] { 0.0 } else { force[dof] })
}

impl CondensedBody {
    /// The loads and forces on the contact dofs, N, over the whole body.
    fn full_force(&self, forces: &[f64]) -> Vec<f64> {
        let mut full = self.full_load.clone();
        for (&first, force) in self.contact.iter().zip(forces.chunks_exact(3)) {
            add_scaled(&mut full[first..first + 3], 1.0, force);
        }
        full
    }
}

impl CompliantBody {
    /// C r̂ for packed multipliers, over the contact dofs, mm: how far one step of refinement moves them.
    pub(super) fn refinement(
        &self,
        pattern: &CondensationPattern,
        scene: &BodyScene,
        block: &Block,
        multipliers: &[f64],
    ) -> Vec<f64> {
        let (forces, load) = (self.contact_forces(multipliers), &self.condensed.full_load);
        let displacement = self.displacement(multipliers, &vec![0.0; self.motions.len()], true);
        let u = self.condensed.extend(&displacement, &forces, load);
        let rest = unbalanced(pattern, scene, block, &u, self.condensed.full_force(&forces));
        let rest = self.condensed.condense_loads(rest, &pattern.held);
        multiply(&self.compliance, rest.col_as_slice(0))
    }
}

impl CompliantContact {
    /// |Δλ| over the load where the contact dofs of the bodies move by δ, mm; not finite where δ is not.
    pub(super) fn change_of_forces(&self, linearizations: &[Linearization], delta: &[Vec<f64>]) -> f64 {
        let mut moved = vec![0.0; self.row_count()];
        for (body, delta) in self.bodies.iter().zip(delta) {
            for &(row, dof) in &body.rows {
                moved[row] += body.sign * delta[dof] / (self.unit * self.load);
            }
        }
        let boundary = &self.problem.boundary;
        let mut residual = vec![0.0; self.row_count() + self.resultant.len()];
        for (node, linearization) in boundary.points.iter().zip(linearizations) {
            let count = node.row_count();
            let block = linearization.derivative(count, boundary.friction);
            for (row, coefficients) in block.iter().enumerate().take(count) {
                let terms = coefficients[..count].iter().zip(&moved[node.start..]);
                residual[node.start + row] = -terms.map(|(d, moved)| d * moved).sum::<f64>();
            }
        }
        norm(&self.exact_step(linearizations, &residual)[..self.row_count()])
    }
}
