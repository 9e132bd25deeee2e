//! Contraction factor of a torn state by Arnoldi's method on Φ′.
//!
//! ```text
//! dΨ ↦ 𝓕 dλ_N:   λ = Q y + e dΨ,   (Qᵀ F Q + Δ) y − Qᵀ Gᵀ a = −Qᵀ F e dΨ,   G λ = 0          (Tresca: slip bounds given)
//! ```
//! Every step is one projected conjugate gradient solve; the radius is that of the Hessenberg matrix, exact (up to the
//! accuracy of the solves) when there are no more sliding nodes than steps.

use crate::equilibrium::ContactPoint;
use crate::equilibrium::certificate::wedging;
use crate::equilibrium::diagnosis::{Diagnosis, spectral_radius};
use crate::equilibrium::law::{Friction, Linearization};
use crate::error::ContactError;
use crate::linear::pcg::pcg;
use crate::linear::sums::Whole;
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::dual::{ActiveSet, TornContact, TornSolution};
use crate::tfeti::newton::slip_bounds;

/// Number of Arnoldi steps after which the estimate stands.
const MAX_STEPS: usize = 12;
/// Relative length of a new basis vector that counts as zero: the space is invariant.
const INVARIANT: f64 = 1e-4;
/// Relative reduction of the linear solves: two digits of the estimate are meant to be right.
const REDUCTION: f64 = 1e-5;
/// Relative reduction of the one linear solve of a rough estimate.
const ROUGH_REDUCTION: f64 = 0.1;
/// Multiple of its target that the residual of a linear solve may reach.
const MAX_MISS: f64 = 1e3;
/// Krylov iterations allowed per solve.
const MAX_KRYLOV: usize = 600;

/// Estimates the contraction factor at given derivatives.
///
/// # Errors
/// [`ContactError::NotConverged`] when a linear solve does not reach its tolerance, [`ContactError::Unheld`],
/// [`ContactError::NotFinite`].
pub fn diagnose(contact: &TornContact<'_>, linearizations: &[Linearization]) -> Result<Diagnosis, ContactError> {
    let sliding = sliding(contact, linearizations);
    let start = (0..sliding.len()).map(|node| 1.0 + 0.5 * (1.7 * node as f64).sin()).collect::<Vec<f64>>();
    let length = norm(&start);
    let mut basis = vec![start.into_iter().map(|entry| entry / length).collect::<Vec<f64>>()];
    let steps = MAX_STEPS.min(sliding.len());
    let mut hessenberg = vec![0.0; steps * steps];
    let mut taken = 0;
    if steps == 0 {
        return Ok(Diagnosis { contraction: 0.0, condition: None });
    }
    let active = contact.active_set(linearizations.to_vec(), Friction::Tresca)?;
    while taken < steps {
        let (mut image, miss) = bound_change(contact, &active, &sliding, &basis[taken], REDUCTION, MAX_KRYLOV);
        if miss.is_nan() || miss > MAX_MISS * REDUCTION {
            return Err(ContactError::NotConverged {
                solver: "Tresca problem of the contraction factor",
                residual: miss,
                tolerance: REDUCTION,
                iterations: MAX_KRYLOV,
                history: vec![miss],
            });
        }
        let size = norm(&image);
        for (row, component) in Whole::orthogonalise(&mut image, &basis).into_iter().enumerate() {
            hessenberg[row * steps + taken] = component;
        }
        taken += 1;
        let rest = norm(&image);
        if taken == steps || rest.is_nan() || rest <= INVARIANT * size {
            break;
        }
        hessenberg[taken * steps + taken - 1] = rest;
        basis.push(image.into_iter().map(|entry| entry / rest).collect());
    }
    let leading: Vec<f64> = (0..taken * taken).map(|i| hessenberg[i / taken * steps + i % taken]).collect();
    let contraction = spectral_radius(taken, &leading);
    if !contraction.is_finite() {
        return Err(ContactError::NotFinite { what: "contraction factor" });
    }
    Ok(Diagnosis { contraction, condition: None })
}

/// A rough |Φ′ Ψ|/|Ψ| at the slip bounds Ψ of the state, by at most so many products with F; 0 without friction
/// forces. Where no node slides, Φ′ is that of all closed nodes sliding along their friction forces: where they
/// stick, slip bounds change nothing nearby, but nodes that only friction keeps closed may as well be open. Where
/// no node is closed, it is that of the nodes which friction could wedge in, sliding as they do.
///
/// # Errors
/// [`ContactError::Unheld`] when the closed nodes leave a motion free.
pub fn estimate_contraction(
    contact: &TornContact<'_>,
    state: &TornSolution,
    max_products: usize,
) -> Result<f64, ContactError> {
    let (forces, jumps) = (state.iterate.multipliers.contact(), state.iterate.jumps.contact());
    let mut linearizations = state.linearizations.clone();
    let mut bounds = slip_bounds(contact, forces);
    if linearizations.iter().all(|linearization| *linearization == Linearization::Open) {
        bounds = wedging(contact.boundary, jumps);
        let wedged = bounds.iter().map(|bound| *bound > 0.0);
        linearizations
            .iter_mut()
            .zip(wedged)
            .filter(|(_, wedged)| *wedged)
            .for_each(|(l, _)| *l = Linearization::Stick);
        let_slide(contact, &mut linearizations, jumps);
    } else if sliding(contact, &linearizations).is_empty() {
        let_slide(contact, &mut linearizations, forces);
    }
    let sliding = sliding(contact, &linearizations);
    if sliding.is_empty() {
        return Ok(0.0);
    }
    let slides = linearizations.iter().map(|linearization| matches!(linearization, Linearization::Slip { .. }));
    let bounds: Vec<f64> = bounds.iter().zip(slides).filter(|(_, slides)| *slides).map(|(b, _)| *b).collect();
    let active = contact.active_set(linearizations, Friction::Tresca)?;
    let (image, _) = bound_change(contact, &active, &sliding, &bounds, ROUGH_REDUCTION, max_products.saturating_sub(1));
    Ok(norm(&image) / norm(&bounds))
}

/// Makes sticking nodes slide along the tangential part of their friction forces, or of their jumps.
fn let_slide(contact: &TornContact<'_>, linearizations: &mut [Linearization], vectors: &[f64]) {
    for (point, linearization) in contact.boundary.points.iter().zip(linearizations) {
        let friction = &vectors[point.rows()][1..];
        let size = norm(friction);
        if *linearization == Linearization::Stick && size > 0.0 {
            let mut direction = [0.0; 2];
            direction.iter_mut().zip(friction).for_each(|(entry, force)| *entry = force / size);
            *linearization = Linearization::Slip { direction, ratio: 1.0 };
        }
    }
}

/// The sliding nodes with their directions.
fn sliding<'c>(contact: &'c TornContact<'_>, linearizations: &[Linearization]) -> Vec<(&'c ContactPoint, [f64; 2])> {
    let nodes = contact.boundary.points.iter().zip(linearizations);
    nodes
        .filter_map(|(point, linearization)| match linearization {
            Linearization::Slip { direction, .. } => Some((point, *direction)),
            _ => None,
        })
        .collect()
}

/// Φ′ dΨ over the sliding nodes (scaled rows; all rows of a node share their scale), and the relative residual of
/// its linear system.
fn bound_change(
    contact: &TornContact<'_>,
    active: &ActiveSet<'_>,
    sliding: &[(&ContactPoint, [f64; 2])],
    bounds: &[f64],
    reduction: f64,
    max_krylov: usize,
) -> (Vec<f64>, f64) {
    let rows = &active.rows;
    let mut driven = contact.zeros();
    for ((point, direction), bound) in sliding.iter().zip(bounds) {
        for (tangent, entry) in direction.iter().enumerate().take(point.tangents) {
            driven.contact_mut()[point.start + 1 + tangent] = bound * entry;
        }
    }
    let resultant: Vec<f64> = contact.space.resultant(&driven).into_iter().map(|entry| -entry).collect();
    let mut unknowns = vec![0.0; rows.dimension()];
    active.enforce(&mut unknowns, &resultant);
    let mut multipliers = rows.trial(&unknowns);
    add_scaled(&mut multipliers, 1.0, &driven);
    let image = contact.operator.apply(&multipliers);
    let mut residual: Vec<f64> = rows.test_transposed(&image).into_iter().map(|entry| -entry).collect();
    rows.add_compliance(&unknowns, &mut residual, -1.0);
    active.project(&mut residual);
    let size = contact.norm(&residual);
    let krylov = pcg(
        &contact.operator.model.sums(),
        &residual,
        reduction * size,
        max_krylov,
        |v| contact.projected_precondition(active, v),
        |z| contact.reduced_product(active, z).0,
    );
    add_scaled(&mut unknowns, 1.0, &krylov.solution);
    let multipliers = rows.trial(&unknowns);
    let change = |(point, _): &(&ContactPoint, _)| point.friction * multipliers.contact()[point.start];
    (sliding.iter().map(change).collect(), krylov.residual / size)
}
