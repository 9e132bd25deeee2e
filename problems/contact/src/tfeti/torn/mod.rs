//! Torn bodies: rows of B, factors of the subdomains, rigid modes, what passes between processes, and the way back to whole
//! bodies.

pub mod communication;
pub mod constraints;
pub mod factors;
pub mod model;
pub mod recovery;
pub mod rigid_modes;
