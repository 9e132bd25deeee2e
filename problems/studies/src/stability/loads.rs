//! Loads from nothing to 1e12 times the usual, reversed, and bodies that only contact holds.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{below, block, footed, pair, stacked, with_loads};
use contact::body::mesh::BlockFace;
use contact::error::SceneError;
use contact::scene::{CounterSurface, Load, Scene, Support};

const LOADS: &str = "load";
const SUPPORTS: &str = "supports";

pub fn cases() -> Vec<Case> {
    let mut cases = sizes();
    cases.extend(held_by_contact());
    cases
}

/// Loads of all sizes, and reversed ones.
fn sizes() -> Vec<Case> {
    let mut cases = Vec::new();
    for factor in [0.0, 1e-12, 1e-8, 1e-4, 1e4, 1e8, 1e12] {
        for (name, scene) in [
            ("block held by contact", block()),
            ("held base, gap 0", footed(0.0)),
            ("stacked", stacked(0.3, 1.0, 0.1)),
            ("two bodies", pair()),
        ] {
            let case = ContactCase::new(with_loads(scene, factor));
            cases.push(case.case(LOADS, format!("load × {factor:e}, {name}")));
        }
    }
    for (name, scene) in [("block held by contact", block()), ("stacked", stacked(0.3, 1.0, 0.1))] {
        let case = ContactCase::new(with_loads(scene, -1.0)).refused("NoEquilibrium");
        cases.push(case.case(LOADS, format!("load reversed, {name}")));
    }
    cases.push(ContactCase::new(with_loads(footed(0.0), -1.0)).case(LOADS, "load reversed, held base"));
    cases
}

/// The block without supports, under a traction on its base.
fn unsupported(friction: f64, traction: [f64; 3]) -> Result<Scene, SceneError> {
    let mut scene = block()?;
    scene.bodies[0].supports.clear();
    scene.bodies[0].loads = vec![Load::traction(BlockFace::Bottom, traction)];
    Ok(scene.with_friction(friction))
}

/// Bodies whose rigid motions only contact and friction hold, or fail to hold.
fn held_by_contact() -> Vec<Case> {
    let pressed = [0.0, 0.0, 3000.0];
    let flat = unsupported(0.0, pressed).map(|scene| below(scene, CounterSurface::Plane { height: 101.0 }));
    // Held along x₁ and x₂ at the base only: rotations about x₁ and x₂, and x₃, are held by contact.
    let rotation = block().map(|mut scene| {
        scene.bodies[0].supports = vec![Support::new(BlockFace::Bottom, [true, true, false])];
        scene.bodies[0].loads =
            vec![Load::traction(BlockFace::Bottom, pressed), Load::traction(BlockFace::X1Max, [0.0, 0.0, 500.0])];
        scene
    });
    let moment = stacked(0.3, 1.0, 0.0).map(|mut scene| {
        scene.bodies[1].loads.push(Load::traction(BlockFace::X1Max, [0.0, 0.0, 2.0]));
        scene
    });
    let solved = |scene, name: &str| ContactCase::new(scene).case(SUPPORTS, name);
    let refused = |scene, name: &str| ContactCase::new(scene).refused("NoEquilibrium").case(SUPPORTS, name);
    vec![
        solved(unsupported(0.3, pressed), "no support but contact and friction"),
        solved(unsupported(0.3, [500.0, 0.0, 3000.0]), "no support, pushed sideways within friction"),
        refused(unsupported(0.05, [2000.0, 0.0, 3000.0]), "no support, pushed sideways beyond friction"),
        solved(unsupported(0.0, pressed), "no support, no friction, wavy obstacle"),
        solved(flat, "no support, no friction, plane: free motions grounded"),
        solved(rotation, "rotation held by contact only"),
        refused(moment, "moment beyond the edge of the contact"),
    ]
}
