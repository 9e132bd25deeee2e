//! Faces of a shape as B-spline surfaces in space.
//!
//! ```text
//! S(s, t) = Σ P_ij N_i(s) N_j(t),      min Σ_k |S(s_k, t_k) − x_k|²/n + λ h⁴ ∫ |D²(S − S₀)|²/A
//! ```
//! x_k: nodes of the face where they have moved to; (s_k, t_k): their places on a plane, a cylinder or a sphere that
//! goes with the face at the start; h² = A/n; S₀: that plane, cylinder or sphere, then the surface on the finest net
//! that the nodes determine between them too. Knots are added where nodes are off; λ falls from 1 to
//! 1e-6 as long as no waves come between nodes.

mod chart;
mod face;
mod fit;
mod net;
mod part;

#[cfg(test)]
mod tests;

pub use face::{SplineFace, SurfaceError, spline_faces};
pub use net::SplineNet;
