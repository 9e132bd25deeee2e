//! Where a surface is smooth, and how much it is curved there.
//!
//! ```text
//! |vᵀ∇²F v| ≤ c₁₁ v₁² + 2 c₁₂ |v₁ v₂| + c₂₂ v₂²
//! ```

/// A surface F over a base that is twice differentiable between lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Pieces {
    /// Lines x₁ = const and x₂ = const between which F is smooth, the edges of the base included, mm.
    pub lines: [Vec<f64>; 2],
    /// c₁₁, c₁₂, c₂₂ of the bound above between the lines, 1/mm; bounds of |∂₁₁F|, |∂₁₂F|, |∂₂₂F| are such numbers.
    pub curvature: [f64; 3],
}
