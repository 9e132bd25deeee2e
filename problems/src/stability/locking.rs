//! The same scene.
use crate::stability::Case;
pub fn cases() -> Vec<Case> { Vec::new() }
/// x
pub struct LockingError;
/// y
pub fn field_error() {}
