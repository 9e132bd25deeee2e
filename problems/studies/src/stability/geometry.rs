//! Flat and tall bricks, slivers, shapes that nearly fold and one that does.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::contacts::uniform;
use crate::stability::scenes::{below, block, stacked};
use contact::scene::{CounterSurface, Geometry};

const GROUP: &str = "geometry";
const FACTORS: &str =
    "factors of floating subdomains of such bricks lose too many digits; condensed bodies do not float";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for height in [1e-2, 0.1, 1.0, 100.0, 1e3, 1e4] {
        let scene = stacked(0.3, 1.0, 0.05).map(|scene| {
            let mut scene = scene.with_shapes(|heights| heights.start = height);
            if let Geometry::Block(block) = &mut scene.bodies[1].geometry {
                block.top = CounterSurface::Plane { height: 2.0 * height };
            }
            below(scene, CounterSurface::Plane { height })
        });
        let mut case = ContactCase::new(scene).check(uniform(1.0, 0.05));
        if !(0.1..1e4).contains(&height) {
            // Total FETI may reach no residual of 1e-8 in the unit of the contact forces, and says so.
            case = case.limit([&["BeyondPrecision", "Inaccurate"], &[]], FACTORS);
        }
        let case = case.case(GROUP, format!("height to width {:e}", height / 10.0));
        cases.push(if (1.0..=1e3).contains(&height) { case } else { case.slow() });
    }
    for (label, size) in [("1000 : 1 plan", [10.0, 1e4]), ("1 : 1000 plan", [10.0, 1e-2])] {
        let scene = stacked(0.3, 1.0, 0.05).map(|scene| scene.with_blocks(|blocks| blocks.size = size));
        let case = ContactCase::new(scene).check(uniform(1.0, 0.05));
        let case = case.limit([&["BeyondPrecision"], &[]], FACTORS);
        cases.push(case.case(GROUP, label).slow());
    }
    for (label, height) in [
        ("one corner column of 1 % of the height", 1.0),
        ("one corner column of 1e-4 of the height (slivers)", 1e-2),
        ("one corner column of 1e-8 of the height (nearly folded)", 1e-6),
    ] {
        let mut controls = vec![97.0; 36];
        controls[35] = height;
        cases.push(ContactCase::new(block()).at(controls).case(GROUP, label));
    }
    for (label, height) in [("corner column of height 0", 0.0), ("folded: corner column of height −50 mm", -50.0)] {
        let mut controls = vec![97.0; 36];
        controls[35] = height;
        cases.push(ContactCase::new(block()).at(controls).refused("InvertedElement").case(GROUP, label));
    }
    let sphere = CounterSurface::Sphere { apex: 100.0, radius: 50.0, centre: [0.0; 2] };
    let scene = block().map(|scene| below(scene, sphere));
    cases.push(ContactCase::new(scene).refused("Scene").case(GROUP, "counter surface that ends above the base"));
    cases
}
