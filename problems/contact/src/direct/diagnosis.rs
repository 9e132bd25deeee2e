//! Contraction and condition of a condensed state, from its assembled matrices.
//!
//! ```text
//! M (dλ; da) = e dΨ on the slip rows,   M: Newton's matrix with slip bounds given (Tresca),   Φ′ = 𝓕 ∂λ_N/∂Ψ over the sliding nodes
//! ```

use crate::direct::active_system::{ActiveSystem, Kept};
use crate::direct::compliant_contact::CompliantContact;
use crate::direct::newton::SPRINGS;
use crate::equilibrium::certificate::wedging;
use crate::equilibrium::diagnosis::{Diagnosis, spectral_radius};
use crate::equilibrium::law::{Friction, Linearization};
use crate::error::ContactError;
use crate::linear::dense::{DenseLu, spectral_condition};
use crate::linear::vector::{dot, norm};

/// Contraction factor and condition at given derivatives.
///
/// # Errors
/// [`ContactError::NotFinite`] when eigenvalues or singular values cannot be found.
pub(super) fn diagnose(
    contact: &CompliantContact,
    linearizations: &[Linearization],
) -> Result<Diagnosis, ContactError> {
    let newton = ActiveSystem::new(contact, linearizations, 0.0, Friction::Coulomb, Kept::All);
    let condition = spectral_condition(newton.matrix())
        .ok_or(ContactError::NotFinite { what: "condition number of Newton's matrix" })?;
    let contraction = contraction(contact, linearizations);
    if !contraction.is_finite() {
        return Err(ContactError::NotFinite { what: "contraction factor" });
    }
    Ok(Diagnosis { contraction, condition: Some(condition) })
}

/// Spectral radius of Φ′.
fn contraction(contact: &CompliantContact, linearizations: &[Linearization]) -> f64 {
    let bounds = BoundChange::new(contact, linearizations);
    let count = bounds.sliding.len();
    let mut map = vec![0.0; count * count];
    for column in 0..count {
        let mut unit = vec![0.0; count];
        unit[column] = 1.0;
        for (row, change) in bounds.apply(&unit).into_iter().enumerate() {
            map[row * count + column] = change;
        }
    }
    spectral_radius(count, &map)
}

/// ‖∂(𝓕 λ_N)/∂λ_T‖₂ over the closed nodes by power iteration: it bounds the contraction of the slip bounds as long
/// as the same nodes are closed, whichever of them slide and in whatever direction. Where no node is closed, over
/// those that friction could wedge in; 0 without friction or where there are none of these either.
pub(super) fn estimate_contraction(
    contact: &CompliantContact,
    unknowns: &[f64],
    linearizations: &[Linearization],
) -> f64 {
    let boundary = &contact.problem.boundary;
    let mut closed: Vec<bool> = linearizations.iter().map(|l| *l != Linearization::Open).collect();
    if !closed.contains(&true) {
        closed = wedging(boundary, &contact.jumps(unknowns, 0.0)).into_iter().map(|excess| excess > 0.0).collect();
    }
    let sliding = Linearization::Slip { direction: [1.0, 0.0], ratio: 0.0 };
    let all_sliding: Vec<Linearization> =
        closed.iter().map(|&closed| if closed { sliding } else { Linearization::Open }).collect();
    let system = ActiveSystem::new(contact, &all_sliding, 0.0, Friction::Tresca, Kept::All).with_springs(SPRINGS[0]);
    let (factors, size) = (DenseLu::new(system.matrix()), system.matrix().nrows());
    // Per row: 𝓕 for normal rows, none for tangential ones.
    let mut friction_of = vec![None; boundary.row_count];
    boundary.points.iter().for_each(|point| friction_of[point.start] = Some(point.friction));
    let tangential = |values: &mut [f64]| {
        for (position, value) in values.iter_mut().enumerate() {
            let belongs = system.rows().get(position).is_some_and(|&row| friction_of[row].is_none());
            *value = if belongs { *value } else { 0.0 };
        }
    };
    // 𝓕 times the normal forces.
    let bounds = |values: &mut [f64]| {
        for (position, value) in values.iter_mut().enumerate() {
            *value *= system.rows().get(position).and_then(|&row| friction_of[row]).unwrap_or(0.0);
        }
    };
    let mut forces: Vec<f64> = (0..size).map(|position| 1.0 + 0.5 * (1.7 * position as f64).sin()).collect();
    let mut square = 0.0;
    for _step in 0..POWER_STEPS {
        tangential(&mut forces);
        let length = norm(&forces);
        if length == 0.0 {
            return 0.0;
        }
        forces.iter_mut().for_each(|force| *force /= length);
        factors.solve_in_place(&mut forces);
        bounds(&mut forces);
        square = dot(&forces, &forces);
        bounds(&mut forces);
        factors.solve_transpose_in_place(&mut forces);
    }
    square.sqrt()
}

/// Steps of the power iteration of a rough estimate.
const POWER_STEPS: usize = 10;

/// A sliding node: the position of its normal row in the active system, direction, number of tangential rows, 𝓕.
struct Sliding {
    position: usize,
    direction: [f64; 2],
    tangents: usize,
    friction: f64,
}

/// The map Φ′ over the sliding nodes.
struct BoundChange {
    sliding: Vec<Sliding>,
    factors: DenseLu,
    size: usize,
}

impl BoundChange {
    fn new(contact: &CompliantContact, linearizations: &[Linearization]) -> Self {
        let boundary = &contact.problem.boundary;
        let tresca = ActiveSystem::new(contact, linearizations, 0.0, Friction::Tresca, Kept::All);
        let tresca = tresca.with_springs(SPRINGS[0]);
        let mut sliding = Vec::new();
        let mut position = 0;
        for (node, linearization) in boundary.points.iter().zip(linearizations) {
            if let Linearization::Slip { direction, .. } = *linearization {
                sliding.push(Sliding { position, direction, tangents: node.tangents, friction: node.friction });
            }
            position += if *linearization == Linearization::Open { 0 } else { node.row_count() };
        }
        let (factors, size) = (DenseLu::new(tresca.matrix()), tresca.matrix().nrows());
        Self { sliding, factors, size }
    }

    /// The product Φ′ dΨ.
    fn apply(&self, bounds: &[f64]) -> Vec<f64> {
        let mut change = vec![0.0; self.size];
        for (Sliding { position, direction, tangents, .. }, bound) in self.sliding.iter().zip(bounds) {
            for (entry, direction) in change[position + 1..=position + tangents].iter_mut().zip(direction) {
                *entry = bound * direction;
            }
        }
        self.factors.solve_in_place(&mut change);
        self.sliding.iter().map(|sliding| sliding.friction * change[sliding.position]).collect()
    }
}
