//! A membrane over an obstacle, pressed and lifted by controlled loads: a state problem beyond contact of solids.
//!
//! ```text
//! u ≥ ψ,   λ = −Δu − f(α) ≥ 0,   λ (u − ψ) = 0   in Ω = (x₀, x₀ + l)²,     u = g on ∂Ω
//! f(α) = f₀ + Σ α_k χ_k,   χ_k the patches of a square grid                                           problem.rs
//! J(α, u, λ) = ½∫(u − u_d)² + (ν/2)∫(f(α) − f₀)² + κ∫λ                                                    cost.rs
//! ```
//! The membrane is a scalar variational inequality: S: α ↦ (u, λ) is Lipschitz, piecewise linear after discretisation,
//! with a kink wherever a node touches the obstacle without pressing on it. Discretised by differences on a square grid
//! (`grid`), solved by the primal–dual active set method (`active_set`), which for this M-matrix ends after finitely
//! many steps with the exact state \[HintermuellerItoKunisch2003\].

mod active_set;
mod cost;
mod grid;
mod problem;

pub use active_set::MembraneState;
pub use cost::MembraneCost;
pub use grid::MembraneGrid;
pub use problem::{MembraneControl, MembraneData, MembraneError};

use nonsmooth::{Polyhedron, ReducedObjective, Vector};

/// Θ of a membrane problem.
pub type MembraneObjective = ReducedObjective<MembraneControl, MembraneCost>;

/// Number of load patches per edge in the example.
pub const PATCHES: usize = 4;
/// Largest load of a patch of the example.
pub const LARGEST_LOAD: f64 = 40.0;

/// The example: a membrane clamped at height 0 sags under the load −8 onto a dome, ψ = 0.1 − |x − (½, ½)|². It shall
/// take the shape u_d = 0.08 sin πx₁ sin πx₂, which the dome pierces, and press on it as little as possible: κ = 0.02,
/// ν = 10⁻⁶.
///
/// ```
/// use nonsmooth::{NonsmoothObjective, Request, Vector};
/// let theta = problems::membrane::example(16)?;
/// let answer = theta.evaluate(&Request::tight(&Vector::zeros(16)))?.into_evaluation();
/// assert!(answer.value > 0.0 && answer.subgradient.len() == 16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MembraneError`] for fewer than two cells per edge, and when the symbolic analysis fails.
pub fn example(cells: usize) -> Result<MembraneObjective, MembraneError> {
    let grid = MembraneGrid::new(cells, [0.0, 0.0], 1.0)?;
    let data = MembraneData {
        load: Box::new(|_| -8.0),
        obstacle: Box::new(|[x, y]| 0.1 - (x - 0.5).powi(2) - (y - 0.5).powi(2)),
        boundary: Box::new(|_| 0.0),
        patches: PATCHES,
    };
    let wanted = |[x, y]: [f64; 2]| 0.08 * (std::f64::consts::PI * x).sin() * (std::f64::consts::PI * y).sin();
    let cost = MembraneCost::new(&grid, wanted, 1e-6, 0.02);
    Ok(ReducedObjective::new(MembraneControl::new(grid, &data)?, cost))
}

/// The admissible loads of the example: each patch pulls or pushes with at most [`LARGEST_LOAD`].
pub fn admissible_loads() -> Polyhedron {
    let limit = Vector::from_element(PATCHES * PATCHES, LARGEST_LOAD);
    Polyhedron::boxed(-&limit, limit).expect("invariant: the box is not empty")
}
