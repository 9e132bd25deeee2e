//! Times, on request.

use super::super::Along;
use super::surface::{Surface, mortar};
use std::time::Instant;

#[test]
#[ignore = "measures times"]
fn times() {
    let slave = Surface::unit(25, 0.0, true).distorted(0.2 / 25.0, 1);
    let master = Surface::unit(20, 0.0, false).distorted(0.2 / 20.0, 1);
    for along in [Along::X3, Along::Normals] {
        let start = Instant::now();
        let coupled = mortar(&slave, &master, along);
        let built = start.elapsed();
        let field = |side: usize, node: u32| [1.0, side as f64, f64::from(node)];
        let _ = coupled.changes(&field);
        let first = start.elapsed() - built;
        let start = Instant::now();
        let _ = coupled.changes(&field);
        let second = start.elapsed();
        let own = vec![super::super::NodeSensitivity { area: 1.0, ..Default::default() }; coupled.nodes.len()];
        let start = Instant::now();
        coupled.pull_back(&own, [&|_| true, &|_| true], &mut |_, _, _| {});
        let pairs: usize = coupled.covers().map(|(_, cover)| cover.pairs.len()).sum();
        let reverse = start.elapsed();
        println!("{along:?}: {pairs} pairs, new {built:?}, Jacobians {first:?}, changes {second:?}, back {reverse:?}");
    }
}
