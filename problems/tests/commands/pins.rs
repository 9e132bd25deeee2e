//! Θ and ξ, pinned: a change of the code's order must not change a bit of them. Of optimizations, the best of 60 values
//! may lie a tenth above the pinned one: rounding leads two courses apart.

use crate::binary;
use serde_json::Value;
use testset::kit::{check_pins, json};

const PINS: &str = include_str!("../data/pins.json");

fn run(name: &str, arguments: &[&str]) -> Value {
    json(binary(name).unwrap(), &[arguments, &["--json"]].concat())
}

#[test]
fn states_and_subgradients_are_the_pinned_ones() {
    check_pins(PINS, |pin| pin["command"] == "evaluate", run);
}

/// Optimizations on 12³ bricks are compared by the test `long` of the studies.
#[test]
fn optimizations_on_small_meshes_come_as_low_as_pinned() {
    check_pins(PINS, |pin| pin["command"] == "optimize" && pin["mesh"] == "6", run);
}
