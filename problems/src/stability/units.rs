//! The same scene in N–mm and N–m.

use crate::stability::Case;
pub fn cases() -> Vec<Case> { Vec::new() }
