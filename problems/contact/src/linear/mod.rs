//! Linear algebra of the contact solvers: factorisations by faer, Krylov methods, sparse products, blocks of columns.

mod border;
pub mod cholesky;
pub(crate) mod columns;
pub(crate) mod csr;
pub(crate) mod dense;
pub(crate) mod entry;
mod error;
mod fronts;
pub(crate) mod gcr;
pub(crate) mod gmres;
mod multifrontal;
pub mod ordering;
pub(crate) mod parallel;
pub(crate) mod pcg;
pub(crate) mod real;
pub(crate) mod right_side;
mod separator;
pub(crate) mod sums;
mod supernodal;
pub mod symmetric;
mod triangle;
pub mod vector;

pub use error::FactorizationError;
