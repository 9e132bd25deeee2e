//! Structured blocks of bricks and their tearing into subdomains.

mod block;
mod tearing;

pub use block::{Block, Face, Grid};
pub use tearing::{Subdomain, Tearing};
