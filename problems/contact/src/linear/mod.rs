//! Linear algebra that the contact solvers stand on; the only place that knows faer.

pub mod cholesky;
pub mod csr;
pub mod dense;
pub mod gmres;
pub mod ordering;
pub mod pcg;
pub mod symmetric;
pub mod vector;
