//! scratch
#![allow(missing_docs)]
pub fn knob(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|t| t.parse().ok()).unwrap_or(default)
}
