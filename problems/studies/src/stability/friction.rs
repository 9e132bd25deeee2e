//! Friction from nothing to far beyond one; where contraction, and with it the proof of uniqueness, is lost.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{block, footed, pair};
use contact::body::mesh::BlockFace;
use contact::scene::Load;

const GROUP: &str = "friction";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for friction in [0.0, 1e-12, 0.3, 0.9, 1.5, 5.0] {
        for (name, scene) in [("block", block()), ("two bodies", pair())] {
            let scene = scene.map(|scene| scene.with_friction(friction));
            let case = ContactCase::new(scene).wavy().with_paper();
            cases.push(case.case(GROUP, format!("𝓕 = {friction:?}, {name}")));
        }
    }
    for friction in [0.3, 0.9, 1.5, 2.0, 3.0, 5.0] {
        let scene = footed(0.0).map(|mut scene| {
            scene.bodies[0].loads = vec![
                Load::traction(BlockFace::X1Max, [40.0, 7.0, 20.0]),
                Load::traction(BlockFace::X1Min, [40.0, 0.0, 20.0]),
            ];
            scene.with_friction(friction)
        });
        cases.push(ContactCase::new(scene).with_paper().case(GROUP, format!("𝓕 = {friction:?}, held base, pushed")));
    }
    cases
}
