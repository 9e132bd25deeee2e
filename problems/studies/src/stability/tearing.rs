//! Shapes and numbers of subdomains; supports whose rows would be redundant if tearing did not know better.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{HELD, block, pair};
use contact::body::mesh::BlockFace;
use contact::scene::Support;

const GROUP: &str = "subdomains";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (label, subdomains) in [
        ("one per body", [1, 1, 1]),
        ("columns 1 × 1 × 4 bricks", [4, 4, 1]),
        ("plates 4 × 4 × 1 bricks", [1, 1, 4]),
        ("beams 1 × 4 × 1 bricks", [4, 1, 4]),
        ("one brick each (64 per body, nearly all floating)", [4, 4, 4]),
        ("unequal 2 × 1 × 4", [2, 4, 1]),
    ] {
        for (name, scene) in [("block", block()), ("two bodies", pair())] {
            let scene = scene.map(|scene| scene.with_blocks(|blocks| blocks.subdomains = subdomains));
            cases.push(ContactCase::new(scene).wavy().case(GROUP, format!("{label}, {name}")));
        }
    }
    let thin = block().map(|scene| scene.with_bricks([4, 4, 1], [2, 2, 1]));
    cases.push(ContactCase::new(thin).case(GROUP, "one layer of bricks"));
    let single = block().map(|scene| scene.with_bricks([1; 3], [1; 3]));
    cases.push(ContactCase::new(single).case(GROUP, "one brick in all"));
    // Edges and corners held by several faces at once: every dof has one row per copy, whatever the number of supports.
    let redundant = block().map(|mut scene| {
        scene.bodies[0].supports = vec![
            Support::new(BlockFace::X1Min, [true, true, false]),
            Support::new(BlockFace::X2Min, [true, true, false]),
            Support::new(BlockFace::X1Max, [true, true, false]),
            Support::new(BlockFace::X1Min, [true, true, false]),
            Support::new(BlockFace::Bottom, HELD),
        ];
        scene.with_blocks(|blocks| blocks.subdomains = [4; 3])
    });
    cases.push(ContactCase::new(redundant).case(GROUP, "faces held several times over, loaded face held"));
    let odd = block().map(|scene| scene.with_blocks(|blocks| blocks.subdomains = [3, 2, 2]));
    cases.push(ContactCase::new(odd).refused("Scene").case(GROUP, "subdomains that do not divide the mesh"));
    cases
}
