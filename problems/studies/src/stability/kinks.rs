//! Nodes exactly on a kink: the state is unique, the derivative is a selection, and the report says so.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{footed, stacked, with_loads};
use contact::equilibrium::WEAKLY_ACTIVE;
use contact::equilibrium::{ContactForces, ContactProblem};

const GROUP: &str = "kinks";

/// Expects at least this many nodes reported as weakly active.
fn reported(least: usize) -> impl Fn(&ContactProblem, &ContactForces) -> Result<String, String> {
    move |_, forces| {
        let kink = forces.kink;
        let text = format!(
            "{} nodes reported on a kink (margin {:.1e}); the derivative is one selection",
            kink.weakly_active, kink.smallest_margin
        );
        if kink.weakly_active >= least && kink.smallest_margin <= WEAKLY_ACTIVE { Ok(text) } else { Err(text) }
    }
}

pub fn cases() -> Vec<Case> {
    vec![
        ContactCase::new(with_loads(footed(0.0), 0.0))
            .check(reported(25))
            .case(GROUP, "λ_N = 0 with closed gap: no load"),
        ContactCase::new(stacked(0.3, 1.0, 0.3))
            .check(reported(25))
            .case(GROUP, "|λ_T| = 𝓕λ_N with zero slip at all nodes, upper body held by contact only"),
    ]
}
