//! The constraint qualification of Mangasarian and Fromovitz at a center.
//!
//! ```text
//! min over d  max_i ⟨n_i, d⟩ + ‖d‖²/2,   x̂ + d ∈ U,  equalities kept      n_i: unit normals of the active inequalities
//! ```
//! ‖d‖ is the length of the shortest convex combination of the normals, up to normals of U and of the equalities. Where
//! it vanishes, no direction leads inside, and multipliers need not exist.

use crate::ConstraintKind;
use crate::bundle::proposers::proposer::Position;
use crate::bundle::proposers::subproblem::{self, Cuts};

/// Linearizations within this share of the size of the variables are active.
const ACTIVE: f64 = 1e-4;
/// A combination of unit normals shorter than this vanishes.
const VANISHING: f64 = 1e-6;

/// The distance of the farthest active linearization, relative to the size of the variables, where the qualification
/// fails at a feasible center.
pub(super) fn fails_within(at: &mut Position<'_>) -> Option<f64> {
    let working = at.working.filter(|working| !working.restoring())?;
    let (center, norm, size) = (&at.state.center, &at.state.norm, at.state.length_scale());
    let (mut normals, mut equalities, mut farthest) = (vec![], vec![], 0.0_f64);
    for (i, tangent) in working.tangents.iter().enumerate() {
        if working.kinds[tangent.constraint] == ConstraintKind::SmoothEquality {
            equalities.push(i);
            continue;
        }
        let slope = norm.dual_length(&tangent.slope);
        let distance = -tangent.at(center) / (slope * size);
        if distance <= ACTIVE {
            farthest = farthest.max(distance);
            normals.push(&*tangent.slope / slope);
        }
    }
    if normals.is_empty() {
        return None;
    }
    let set = at.set.with_tangents_kept(&equalities);
    let (offsets, ids) = (vec![0.0; normals.len()], (0..normals.len() as u64).collect::<Vec<_>>());
    let cuts = Cuts { slopes: &normals, offsets: &offsets, ids: &ids, gram: None };
    let solution = subproblem::solve(at.solver, &set, center, norm.weighted(1.0).metric(), cuts).ok()?;
    (norm.length(&solution.step) <= VANISHING).then_some(farthest)
}
