//! Convex quadratic programs over separable sets with linear equalities; no mechanics here.
//!
//! ```text
//! min ½ xᵀHx − xᵀb   s.t.   C x = e,   x ∈ Ω = free entries × half-lines × discs
//! ```
//! `mpgp`: gradient projection with conjugate gradients in the face, for Ω alone. `smalse`: an augmented Lagrangian
//! loop around it for C x = e. With the feature `interior-point`, `ConeProgram` minimises over friction cones.
//!
//! References: \[Dostal2009\] (the algorithms), \[DostalKozubek2012\] (separable convex constraints),
//! \[DostalKucera2010\] (with equalities), \[Kucera2007\] (reduced gradients).

#[cfg(feature = "interior-point")]
mod cone;
mod error;
mod face;
mod lanczos;
mod mpgp;
mod operator;
mod program;
mod separable_set;
mod smalse;

#[cfg(feature = "interior-point")]
pub use cone::{Cone, ConeProgram, MAX_ITERATIONS, Minimiser};
pub use error::QpError;
pub use face::Face;
pub use lanczos::largest_eigenvalue;
pub use mpgp::{FacePreconditioner, Mpgp, Point, StepCounts};
pub use operator::{DenseEqualities, LinearEqualities, SymmetricOperator};
pub use program::{QpLimits, QuadraticProgram, SmalseSolution, WarmStart};
pub use separable_set::{Block, SeparableSet};
pub use smalse::Smalse;
