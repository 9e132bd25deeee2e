//! The whole matrix of cases.

use crate::stability::case::Case;
use crate::stability::{contacts, friction, geometry, loads, locking, materials, tearing, units};

/// All cases, in the order of the page.
pub fn all() -> Vec<Case> {
    let groups = [
        materials::cases(),
        locking::cases(),
        geometry::cases(),
        friction::cases(),
        contacts::cases(),
        loads::cases(),
        contacts::kinks(),
        units::cases(),
        tearing::cases(),
    ];
    groups.into_iter().flatten().collect()
}
