//! B-spline surfaces as STEP files: surfaces alone, or the solid below heights.
//!
//! ```text
//! x(s, t) = Σᵢⱼ Pᵢⱼ Nᵢ(s) Nⱼ(t),   heights: Pᵢⱼ = (a ξᵢ, b ηⱼ, αᵢⱼ),   ξᵢ = (tᵢ₊₁ + … + tᵢ₊ₚ)/p      Greville abscissae: Σᵢ ξᵢ Nᵢ(s) = s
//! ```
//! Of heights, x₁ = a s and x₂ = b t exactly, and x₃ is the height: the surface in the file is the surface itself, not
//! an approximation. Formats: ISO 10303-21 (the text), ISO 10303-42 (`B_SPLINE_SURFACE_WITH_KNOTS`), ISO 10303-214 (the
//! schema `AUTOMOTIVE_DESIGN`). Lengths in mm.

mod entities;
mod shell;
mod spline;

pub use shell::{solid, surfaces};
pub use spline::{SplineHeights, SplinePatch};
