//! Convex quadratic programs with an epigraph variable: data, certificate, and two solvers.
//!
//! ```text
//! min over (d, v)   v + ½ dᵀ H d
//! s.t.              g_jᵀ d − e_j ≤ v            (cuts, multipliers π_j ≥ 0, Σ π_j = 1)
//!                   row_lower ≤ A d ≤ row_upper (multipliers μ, signed: > 0 upper side, < 0 lower side)
//!                   lower ≤ d ≤ upper           (multipliers ν, signed likewise)
//! KKT:              H d + Σ π_j g_j + Aᵀ μ + ν = 0
//! ```
