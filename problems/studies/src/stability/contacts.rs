//! No contact, one node, all nodes; stick and slip everywhere; onset of sliding; gaps of every size; nodes exactly on a
//! kink, where the state is unique, the derivative is a selection, and the report says so.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{HELD, below, block, footed, pair, stacked, with_loads};
use contact::body::mesh::BlockFace;
use contact::equilibrium::{ContactForces, ContactProblem, WEAKLY_ACTIVE};
use contact::error::SceneError;
use contact::scene::{CounterSurface, Load, Scene, Support};

const GROUP: &str = "contact";
const KINKS: &str = "kinks";

/// Expects numbers of (open, stick, slip) nodes.
pub fn counts(expected: [usize; 3]) -> impl Fn(&ContactProblem, &ContactForces) -> Result<String, String> {
    move |_, forces| {
        let found = forces.counts();
        let found = [found.open, found.stick, found.slip];
        let text = format!("{} open, {} stick, {} slip", found[0], found[1], found[2]);
        if found == expected { Ok(text) } else { Err(format!("{text}; expected {expected:?}")) }
    }
}

/// Expects uniform pressure and shear; how exactly they are met depends on the condition of the scene and is reported.
pub fn uniform(pressure: f64, shear: f64) -> impl Fn(&ContactProblem, &ContactForces) -> Result<String, String> {
    move |problem, forces| {
        let mut error = 0.0_f64;
        // Areas are those of the base, whatever the shape.
        for (index, node) in problem.start_rows().nodes.iter().enumerate() {
            error = error.max((forces.normal[index] / node.area / pressure - 1.0).abs());
            let traction = forces.tangential.get(index).map_or([0.0; 3], |force| force.map(|f| f / node.area));
            error = error.max((traction[0] + shear).abs() / pressure).max(traction[1].abs() / pressure);
        }
        let text = format!("exact state within {error:.1e}");
        if error < 1e-5 { Ok(text) } else { Err(text) }
    }
}

pub fn cases() -> Vec<Case> {
    let mut cases = uniform_status();
    cases.extend(onset_of_sliding());
    cases.extend(penetrations_and_distances());
    cases
}

/// A quarter of a ball of some radius, pressed by some pressure on its top.
fn ball(radius: f64, pressure: f64) -> Result<Scene, SceneError> {
    let mut scene = below(pair()?, CounterSurface::Sphere { apex: 10.0, radius, centre: [0.0; 2] });
    scene.bodies[1].loads = vec![Load::traction(BlockFace::Top, [0.0, 0.0, -pressure])];
    Ok(scene.with_friction(0.3))
}

/// The lower block is drawn along x₁ below a plate that presses on it: every node slides.
fn dragged(friction: f64) -> Result<Scene, SceneError> {
    let mut scene = stacked(friction, 1.0, 0.0)?;
    let [lower, upper] = [0, 1];
    scene.bodies[lower].supports = vec![Support::new(BlockFace::Bottom, HELD)];
    scene.bodies[upper].supports = vec![Support::new(BlockFace::X1Max, [true, true, false])];
    scene.bodies[upper].loads = vec![Load::traction(BlockFace::Top, [0.0, 0.0, -1.0])];
    let faces = [BlockFace::X1Min, BlockFace::X2Min, BlockFace::X2Max];
    scene.bodies[lower].loads = faces.map(|face| Load::traction(face, [0.02, 0.0, 0.0])).to_vec();
    Ok(scene)
}

/// No contact, one node, all nodes; all nodes of one status.
fn uniform_status() -> Vec<Case> {
    vec![
        ContactCase::new(footed(1.0)).check(counts([25, 0, 0])).case(GROUP, "no contact at all (held base)"),
        ContactCase::new(footed(1e12)).check(counts([25, 0, 0])).case(GROUP, "gap of 1e12 mm (held base)"),
        ContactCase::new(footed(1e-12)).case(GROUP, "gap of 1e-12 mm"),
        ContactCase::new(footed(0.0)).case(GROUP, "gap of 0"),
        ContactCase::new(stacked(0.3, 1.0, 0.0))
            .check(uniform(1.0, 0.0))
            .case(GROUP, "contact at all nodes, all stick"),
        ContactCase::new(ball(20.0, 1.0)).check(counts([24, 1, 0])).case(GROUP, "contact at one node"),
        ContactCase::new(dragged(1e-3)).check(counts([0, 0, 25])).case(GROUP, "all slip"),
    ]
}

/// Tangential loads just below and above what friction can carry.
fn onset_of_sliding() -> Vec<Case> {
    let loaded = |share: f64| {
        let case = ContactCase::new(stacked(0.3, 1.0, 0.3 * share));
        let case = if share < 1.0 { case.check(uniform(1.0, 0.3 * share)) } else { case.refused("NoEquilibrium") };
        case.case(GROUP, format!("onset of sliding: tangential load {share} of the limit"))
    };
    [0.9, 0.999, 0.999_999, 1.001, 1.1].map(loaded).into()
}

/// Gaps from half of the height inside the obstacle to 1e12 mm away from it.
fn penetrations_and_distances() -> Vec<Case> {
    let plane = |(label, depth): (&str, f64)| {
        let scene = stacked(0.3, 1.0, 0.0).map(|scene| below(scene, CounterSurface::Plane { height: 10.0 - depth }));
        ContactCase::new(scene).check(uniform(1.0, 0.0)).case(GROUP, format!("initial penetration {label}"))
    };
    let wavy = |base: f64| {
        let surface = CounterSurface::Waves { base, first: 1.0, second: 2.0, period: 100.0, origin: [0.0; 2] };
        ContactCase::new(block().map(|scene| below(scene, surface)))
    };
    let mut cases: Vec<Case> = [("1 µm", 1e-3), ("1 mm", 1.0), ("half of the height", 5.0)].map(plane).into();
    cases.push(wavy(95.0).case(GROUP, "initial penetration of a wavy obstacle"));
    for distance in [1e3, 1e6, 1e12] {
        let name = format!("obstacle {distance:e} mm away, held by contact only");
        let case = wavy(100.0 + distance);
        cases.push(if distance > 1e9 {
            case.limit([&["NotConverged"], &[]], FAR).case(GROUP, name)
        } else {
            case.case(GROUP, name)
        });
    }
    cases
}

/// Why total FETI finds no state at a distance of 1e12 mm.
const FAR: &str = "total FETI takes jumps as differences of displacements 1e12 times as large";

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

/// Nodes on a kink.
pub fn kinks() -> Vec<Case> {
    vec![
        ContactCase::new(with_loads(footed(0.0), 0.0))
            .check(reported(25))
            .case(KINKS, "λ_N = 0 with closed gap: no load"),
        ContactCase::new(stacked(0.3, 1.0, 0.3))
            .check(reported(25))
            .case(KINKS, "|λ_T| = 𝓕λ_N with zero slip at all nodes, upper body held by contact only"),
    ]
}
