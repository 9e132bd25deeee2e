//! Loads from nothing to 1e12 times the usual, reversed, and bodies that only contact holds.

use crate::stability::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{block, footed, pair, stacked, with_loads};
use contact::body::mesh::Face;
use contact::scene::{CounterSurface, Load, Scene, Support};

const LOADS: &str = "load";
const SUPPORTS: &str = "supports";

pub fn cases() -> Vec<Case> {
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
    let without = |friction: f64, traction: [f64; 3]| {
        block().map(|mut scene| {
            scene.lower.supports.clear();
            scene.lower.loads = vec![Load { face: Face::Bottom, traction }];
            Scene { friction, ..scene }
        })
    };
    cases
        .push(ContactCase::new(without(0.3, [0.0, 0.0, 3000.0])).case(SUPPORTS, "no support but contact and friction"));
    cases.push(
        ContactCase::new(without(0.3, [500.0, 0.0, 3000.0]))
            .case(SUPPORTS, "no support, pushed sideways within friction"),
    );
    cases.push(
        ContactCase::new(without(0.05, [2000.0, 0.0, 3000.0]))
            .refused("NoEquilibrium")
            .case(SUPPORTS, "no support, pushed sideways beyond friction"),
    );
    cases.push(
        ContactCase::new(without(0.0, [0.0, 0.0, 3000.0])).case(SUPPORTS, "no support, no friction, wavy obstacle"),
    );
    let flat = without(0.0, [0.0, 0.0, 3000.0])
        .map(|scene| Scene { counter_surface: CounterSurface::Plane { height: 101.0 }, ..scene });
    cases.push(ContactCase::new(flat).case(SUPPORTS, "no support, no friction, plane: free motions grounded"));
    // Held along x₁ and x₂ at the base only: rotations about x₁ and x₂, and x₃, are held by contact.
    let rotation = block().map(|mut scene| {
        scene.lower.supports = vec![Support { face: Face::Bottom, components: [true, true, false] }];
        scene.lower.loads = vec![
            Load { face: Face::Bottom, traction: [0.0, 0.0, 3000.0] },
            Load { face: Face::X1Max, traction: [0.0, 0.0, 500.0] },
        ];
        scene
    });
    cases.push(ContactCase::new(rotation).case(SUPPORTS, "rotation held by contact only"));
    let moment = stacked(0.3, 1.0, 0.0).map(|mut scene| {
        if let Some(upper) = &mut scene.upper {
            upper.body.loads.push(Load { face: Face::X1Max, traction: [0.0, 0.0, 2.0] });
        }
        scene
    });
    cases.push(
        ContactCase::new(moment).refused("NoEquilibrium").case(SUPPORTS, "moment beyond the edge of the contact"),
    );
    cases
}
