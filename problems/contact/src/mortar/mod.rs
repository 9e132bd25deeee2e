//! Dual mortar coupling of two surface meshes that do not match, by segmentation.
//!
//! ```text
//! per slave facet, in its auxiliary plane, over the part that master facets f cover:
//!   D_k = ∫ N_k,  M_kl = ∫ N_k N_l,  P_kj = ∫ N_k Nᵐ_j,   ψ = diag(D) M⁻¹ N:  ∫ ψ_i N_k = δ_ik D_i
//! per slave node:  D_i = Σ D,   m_ij = Σ ∫ ψ_i Nᵐ_j / D_i,   Σ_j m_ij = 1
//! ```
//!
//! The plane goes through the centre of the slave facet; master facets are projected along its normal n₀. Only facets
//! that face it count, and of several layers the nearest. A projected quadrilateral that is not convex counts as two
//! triangles, one that folds over as none. Where the surface is covered all around, the weights have continuous
//! derivatives, up to the error of the rule (none for parallelograms and triangles, about 1e-8 on distorted grids, more
//! on facets seen edge-on). Where edges of both surfaces coincide, the derivatives are those of a master surface that
//! goes on beyond its edge.

mod cover;
mod curve;
mod derivative;
mod facet;
mod frame;
mod gradient;
mod normals;
mod opposite_facets;
mod pair;
mod planar;
mod polygon;
mod primitive;
pub(crate) mod vector;
mod weights;

#[cfg(test)]
mod tests;

pub use curve::{NO_MIDDLE, NODES, Quadratic, QuadraticFacet, Remainder};
pub use derivative::NodeSensitivity;
pub use facet::{Face, Facet};
pub use frame::doubled_area;
pub use primitive::Primitive;
pub use weights::{Mortar, MortarNode};

/// Direction of projection, and normals of the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Along {
    /// Along the third axis, whatever the shape; all nodes have the normal e₃.
    X3,
    /// Along the normal in the centre of each slave facet; nodes have the normal of their vector area.
    Normals,
}
