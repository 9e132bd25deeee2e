//! Linear algebra that the contact solvers stand on; the only place that knows faer.

pub mod cholesky;
pub(crate) mod csr;
pub(crate) mod dense;
mod error;
pub(crate) mod gmres;
pub mod ordering;
pub(crate) mod pcg;
pub mod symmetric;
pub mod vector;

pub use error::FactorizationError;
