//! Error against run time: the study behind `docs/accuracy.md`.

mod manufactured;

pub use manufactured::{ManufacturedErrors, manufactured_errors};
