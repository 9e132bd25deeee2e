//! All cases.

use crate::stability::case::Case;
use crate::stability::{contacts, friction, geometry, kinks, loads, locking, materials, optimizer, tearing, units};

/// The whole matrix, in the order of the page.
pub fn all() -> Vec<Case> {
    let groups = [
        materials::cases(),
        locking::cases(),
        geometry::cases(),
        friction::cases(),
        contacts::cases(),
        loads::cases(),
        kinks::cases(),
        units::cases(),
        tearing::cases(),
        optimizer::cases(),
    ];
    groups.into_iter().flatten().collect()
}
