//! The limiting gradients of Θ at a control: the corners of its Clarke subdifferential.
//!
//! ```text
//! ∂_BΘ(α) = { ∇₁J + Bᵀ (⟨∇₂J, dy¹/dh⟩_s₁, ⟨∇₂J, dy²/dh⟩_s₂) : sᵢ a status next to hᵢ },     ∂Θ(α) = conv ∂_BΘ(α)
//! ```
//! One gradient where Θ is smooth, two on a kink line, four where two lines cross.

use super::ToyObjective;
use nonsmooth::{Accuracy, Cost, OracleError, StateSolver, Vector};

/// Distance |h − kink| up to which a support counts as lying on the kink, mm.
pub const KINK_WIDTH: f64 = 1e-9;

/// All limiting gradients of the toy's Θ at a control, up to [`KINK_WIDTH`]; the Clarke subdifferential is their hull.
///
/// # Errors
/// An [`OracleError`] unless the control has two finite entries.
pub fn clarke_vertices(objective: &ToyObjective, control: &Vector) -> Result<Vec<Vector>, OracleError> {
    let solver = objective.solver();
    let state = solver.solve(control, None, Accuracy::TIGHTEST)?;
    let gradient = objective.cost().gradient(control, &state);
    let [first, second] = [0, 1].map(|i| solver.nodes()[i].neighbouring_statuses(state.nodes[i].support, KINK_WIDTH));
    let mut vertices = Vec::with_capacity(first.len() * second.len());
    for &left in &first {
        for &right in &second {
            vertices.push(&gradient.control + solver.pull_back([left, right], &gradient.state));
        }
    }
    Ok(vertices)
}
