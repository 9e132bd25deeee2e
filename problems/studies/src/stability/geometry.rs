//! Flat and tall bricks, slivers, shapes that nearly fold and one that does; shapes and numbers of subdomains.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::contacts::uniform;
use crate::stability::scenes::{HELD, below, block, pair, stacked};
use contact::body::mesh::BlockFace;
use contact::scene::{CounterSurface, Geometry, Support};

const GROUP: &str = "geometry";
const SUBDOMAINS: &str = "subdomains";
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
        cases.push(case.case(GROUP, format!("height to width {:e}", height / 10.0)));
    }
    for (label, size) in [("1000 : 1 plan", [10.0, 1e4]), ("1 : 1000 plan", [10.0, 1e-2])] {
        let scene = stacked(0.3, 1.0, 0.05).map(|scene| scene.with_blocks(|blocks| blocks.size = size));
        let case = ContactCase::new(scene).check(uniform(1.0, 0.05));
        cases.push(case.limit([&["BeyondPrecision"], &[]], FACTORS).case(GROUP, label));
    }
    for (label, height) in [
        ("one corner column of 1 % of the height", 1.0),
        ("one corner column of 1e-4 of the height (slivers)", 1e-2),
        ("one corner column of 1e-8 of the height (nearly folded)", 1e-6),
        ("corner column of height 0", 0.0),
        ("folded: corner column of height −50 mm", -50.0),
    ] {
        let mut controls = vec![97.0; 36];
        controls[35] = height;
        let case = ContactCase::new(block()).at(controls);
        cases.push(if height > 0.0 { case } else { case.refused("InvertedElement") }.case(GROUP, label));
    }
    let sphere = CounterSurface::Sphere { apex: 100.0, radius: 50.0, centre: [0.0; 2] };
    let scene = block().map(|scene| below(scene, sphere));
    cases.push(ContactCase::new(scene).refused("Scene").case(GROUP, "counter surface that ends above the base"));
    cases
}

pub fn subdomains() -> Vec<Case> {
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
            cases.push(ContactCase::new(scene).wavy().case(SUBDOMAINS, format!("{label}, {name}")));
        }
    }
    let thin = block().map(|scene| scene.with_bricks([4, 4, 1], [2, 2, 1]));
    cases.push(ContactCase::new(thin).case(SUBDOMAINS, "one layer of bricks"));
    let single = block().map(|scene| scene.with_bricks([1; 3], [1; 3]));
    cases.push(ContactCase::new(single).case(SUBDOMAINS, "one brick in all"));
    // Edges and corners held by several faces at once: every dof has one row per copy, whatever the number of supports.
    let redundant = block().map(|mut scene| {
        let sides = [BlockFace::X1Min, BlockFace::X2Min, BlockFace::X1Max, BlockFace::X1Min];
        scene.bodies[0].supports = sides.map(|face| Support::new(face, [true, true, false])).into();
        scene.bodies[0].supports.push(Support::new(BlockFace::Bottom, HELD));
        scene.with_blocks(|blocks| blocks.subdomains = [4; 3])
    });
    cases.push(ContactCase::new(redundant).case(SUBDOMAINS, "faces held several times over, loaded face held"));
    let odd = block().map(|scene| scene.with_blocks(|blocks| blocks.subdomains = [3, 2, 2]));
    cases.push(ContactCase::new(odd).refused("Scene").case(SUBDOMAINS, "subdomains that do not divide the mesh"));
    cases
}
