//! A 2D toy: contact with Coulomb friction in miniature, everything in closed form.
//!
//! Two control heights α shape a support, two spring-held nodes are pressed and dragged over it. State, coderivative,
//! cost, minimiser and Clarke sets are known exactly, and two controls can be drawn.
//!
//! ```text
//! h = Bα,   yⁱ = (λ_N, λ_T, n, w)(hᵢ) open / stick / slip                                       solver.rs, node.rs
//! Θ(α) = φ₁(h₁) + φ₂(h₂) + (γ/2)|α − ᾱ|²,    φᵢ(h) = t w − P n + (a/2) λ_N²                                cost.rs
//! ∂Θ(α) = Bᵀ (∂φ₁(h₁) × ∂φ₂(h₂)) + γ(α − ᾱ)                                                              clarke.rs
//! ```
//! **Data.** k = 2, κ = 1, 𝓕 = 1/4 for both nodes; (P, t) = (1, 1) and (2, 2); a = 2/5, γ = 1/8, ᾱ = (1, 1); U = [−4,
//! 6]². So Λ₊ = 4/3, Λ₋ = 12/7, and the kinks (touch, end of forward slip, start of backward slip) are h₁ = −1, 1/2,
//! 5/2 and h₂ = −2, 1, 5: two families of three parallel lines in the plane of α.
//!
//! **Minimiser.** α* = (1/4, 5/4), h* = (1/2, 1), Θ* = 3/10 + 6/5 + 5/128 = 1.5390625: both nodes just stick. There
//! λ_N* = 2, 4; dφ₁ jumps from −2/3 − 1 + a·2·Λ₊ = −3/5 (slip) to −1 + a·2·k = 3/5 (stick), dφ₂ from −6/5 to 6/5, and
//! B⁻ᵀγ(ᾱ − α*) = (5/32, −3/32) lies inside [−3/5, 3/5] × [−6/5, 6/5]: 0 is an interior point of ∂Θ(α*).
//!
//! **It is the only stationary point in U**: ⟨ξ, α − α*⟩ > 0 for all ξ ∈ ∂Θ(α), α ≠ α*, hence 0 ∉ ∂Θ(α) + N_U(α). For
//! ⟨ξ, α − α*⟩ = Σ φᵢ'(hᵢ)(hᵢ − hᵢ*) + γ⟨α − ᾱ, α − α*⟩, where φᵢ' ≤ 0 below and > 0 above hᵢ*. The last term is
//! positive unless |α − α*| ≤ |ᾱ − α*| = √(5/8) < 1; and for |α − α*| ≤ 1 both nodes are closed, |φᵢ'| ≥ 3/5, and with
//! σ_min(B) = 1/2 the sum is at least (3/10)|α − α*| > γ|ᾱ − α*||α − α*|. This estimate also gives the sharp growth
//! Θ(α) − Θ* ≥ |α − α*|/5 for |α − α*| ≤ 1.
//!
//! **Nonconvex**: φᵢ' drops at touch (0 to −5/3, −10/3) and at the start of backward slip; below touch Θ is nearly a
//! plateau.

mod clarke;
mod cost;
mod node;
mod solver;
mod study;

pub use clarke::{KINK_WIDTH, clarke_vertices};
pub use cost::ToyCost;
pub use node::{Kink, Node, NodeData, NodeStatus, NodeValues};
pub use solver::{NodeState, SURFACE, ToyContact, ToyState};
pub use study::{SUCCESS, ToyRun, ToyStudy, landscape, random_starts, run_study};

use nonsmooth::{Polyhedron, ReducedObjective, Vector};

/// Θ of the toy.
pub type ToyObjective = ReducedObjective<ToyContact, ToyCost>;

/// Lower bound of both controls.
pub const LOWER: f64 = -4.0;
/// Upper bound of both controls.
pub const UPPER: f64 = 6.0;
/// The minimiser α* of Θ.
pub const MINIMISER: [f64; 2] = [0.25, 1.25];
/// The minimum Θ* = Θ(α*).
pub const MINIMUM: f64 = 1.539_062_5;

/// Loads (P, t) of the two nodes.
const LOADS: [(f64, f64); 2] = [(1.0, 1.0), (2.0, 2.0)];

/// The objective with the data of the module head.
///
/// ```
/// use nonsmooth::{NonsmoothObjective, Request};
/// use problems::toy;
/// let answer = toy::toy_objective().evaluate(&Request::tight(&toy::minimiser()))?.into_evaluation();
/// assert!((answer.value - toy::MINIMUM).abs() < 1e-15);
/// # Ok::<(), nonsmooth::OracleError>(())
/// ```
pub fn toy_objective() -> ToyObjective {
    let nodes = LOADS.map(|(pressing_load, tangential_load)| {
        let (stiffness, coupling, friction_coefficient) = (2.0, 1.0, 0.25);
        Node::new(NodeData { stiffness, coupling, friction_coefficient, pressing_load, tangential_load })
            .expect("invariant: the toy's data are admissible")
    });
    let cost = ToyCost { loads: LOADS, pressure_weight: 0.4, shape_weight: 0.125, nominal_shape: [1.0, 1.0] };
    ReducedObjective::new(ToyContact::new(nodes), cost)
}

/// The admissible box U.
pub fn admissible_set() -> Polyhedron {
    Polyhedron::boxed(Vector::from_element(2, LOWER), Vector::from_element(2, UPPER))
        .expect("invariant: the toy's box is not empty")
}

/// α* as a vector.
pub fn minimiser() -> Vector {
    Vector::from_row_slice(&MINIMISER)
}
