//! B-spline surfaces as STEP files: the surface alone, or the solid below it.
//!
//! ```text
//! x(s, t) = Σᵢⱼ (a ξᵢ, b ηⱼ, αᵢⱼ) Nᵢ(s) Nⱼ(t),   ξᵢ = (tᵢ₊₁ + … + tᵢ₊ₚ)/p      Greville abscissae: Σᵢ ξᵢ Nᵢ(s) = s
//! ```
//! so that x₁ = a s and x₂ = b t exactly, and x₃ is the height: the surface in the file is the surface itself, not an
//! approximation. Formats: ISO 10303-21 (the text), ISO 10303-42 (`B_SPLINE_SURFACE_WITH_KNOTS`), ISO 10303-214 (the
//! schema `AUTOMOTIVE_DESIGN`). Lengths in mm.

mod entities;
mod shell;
mod spline;

pub use shell::{solid, surface};
pub use spline::SplineHeights;
