//! Stresses and displacements of blocks at random shapes: both paths, one and two bodies, with and without friction.

use crate::common::start_height;
use crate::field_check::{check, conclude};
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity, Region, StateCost};
use contact::equilibrium::TangentsOf;
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, StateSolver, Vector};

const KINDS: [SolverKind; 2] = [SolverKind::Newton, SolverKind::Direct];

fn face(body: &str, name: &str) -> Region {
    Region { body: Some(body.into()), face: Some(name.into()), ..Region::WHOLE }
}

fn measures(scene: &Scene) -> Vec<Quantity> {
    let height = start_height(scene);
    // Away from the supports, and from nodes that stick, where displacements are 0 whatever the shape.
    let inner = Region {
        lower: [0.2 * height, 0.2 * height, 0.3 * height],
        upper: [f64::INFINITY, f64::INFINITY, 0.7 * height],
        body: Some("lower".into()),
        ..Region::WHOLE
    };
    let above = Region { lower: [0.2 * height, 0.2 * height, 0.3 * height], ..Region::WHOLE };
    let displacement = |region, axis, least| Quantity::Displacement { region, relative_to: None, axis, least };
    let mut measures = vec![
        Quantity::Stress { region: Region::WHOLE, without_held: true },
        Quantity::Stress { region: Region { body: Some("lower".into()), ..above.clone() }, without_held: false },
        displacement(face("lower", "top"), Some(2), false),
        displacement(face("lower", "x1-max"), Some(0), false),
        displacement(inner, Some(0), true),
        displacement(above, None, false),
        Quantity::StressNorm { region: Region::WHOLE, exponent: 8.0 },
        Quantity::Compliance,
        Quantity::Displacement {
            region: face("lower", "x1-max"),
            relative_to: Some(face("lower", "bottom")),
            axis: None,
            least: false,
        },
        Quantity::ContactMoment { contact: Some(0), axis: Some(0), about: [height, 2.0, 3.0] },
        Quantity::Pressure(PressureMeasure::Norm { exponent: 3.0, weight: NodeWeight::Area }),
        Quantity::Slip { contact: Some(0) },
    ];
    if scene.has_friction() {
        measures.push(Quantity::FrictionWork { contact: None });
        // Without friction, loads determine these.
        measures.push(Quantity::Reaction { region: face("lower", "x1-min"), axis: Some(0) });
        measures.push(Quantity::ContactForce { contact: Some(0), axis: Some(0) });
    }
    if scene.bodies.len() > 1 {
        measures.push(displacement(face("upper", "bottom"), Some(1), true));
    } else {
        measures.push(Quantity::LoadedArea { pressure: 2000.0 });
    }
    measures
}

fn case(scene: &Scene, seed: u64) -> [Vector; 2] {
    let height = start_height(scene);
    let at = seeded_direction(scene.control_count(), 3 * seed + 1).map(|entry| height * (0.98 + 0.01 * entry));
    [at, seeded_direction(scene.control_count(), 3 * seed + 2)]
}

fn check_scene(scene: Scene, friction: f64) {
    let scene = scene.with_bricks([4; 3], [2, 1, 2]).with_friction(friction);
    let measures = measures(&scene);
    for kind in KINDS {
        let found = check(&scene, kind, &measures, start_height(&scene), |seed| case(&scene, seed));
        conclude(&format!("{}, friction {friction}, {kind:?}", scene.name), &measures, &found);
    }
}

#[test]
fn quantities_of_one_body() {
    check_scene(signorini().unwrap(), 0.0);
}

#[test]
fn quantities_of_one_body_with_friction() {
    check_scene(signorini().unwrap(), 0.3);
}

#[test]
fn quantities_of_two_bodies() {
    check_scene(hertz().unwrap(), 0.0);
}

#[test]
fn quantities_of_two_bodies_with_friction() {
    check_scene(hertz().unwrap(), 0.3);
}

/// The message with which a measure is refused.
fn refused(measure: Quantity) -> String {
    let scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
    let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
    StateCost::new("limits[2]", &measure, shape.problem()).unwrap_err().to_string()
}

#[test]
fn measures_without_a_meaning_are_refused() {
    let displacement = |region, axis, least| Quantity::Displacement { region, relative_to: None, axis, least };
    let nearby = Region { upper: [1.0, 100.0, 100.0], ..face("lower", "x1-max") };
    let low = Region { upper: [100.0, 100.0, 10.0], ..Region::WHOLE };
    let at_supports = Region { upper: [25.0, 100.0, 100.0], ..Region::WHOLE };
    for (measure, words) in [
        (displacement(Region::WHOLE, Some(3), false), ["limits[2].axis = 3", "0, 1 or 2"]),
        (displacement(Region::WHOLE, None, true), ["limits[2].least = true", "length"]),
        (
            displacement(face("lower", "topp"), None, false),
            ["limits[2].region.face = \"topp\"", "did you mean \"top\""],
        ),
        (displacement(face("upper", "top"), None, false), ["limits[2].region.body = \"upper\"", "allowed: \"lower\""]),
        (displacement(nearby, None, false), ["limits[2].region", "node of the face"]),
        (displacement(low, None, false), ["limits[2].region", "centre of a cell"]),
        (
            Quantity::Stress { region: face("lower", "top"), without_held: false },
            ["limits[2].region.face = \"top\"", "whole cells"],
        ),
        (
            Quantity::Stress { region: at_supports, without_held: true },
            ["limits[2].without_held = true", "every cell of the region"],
        ),
    ] {
        let found = refused(measure);
        assert!(words.iter().all(|words| found.contains(words)), "{found}");
    }
}

/// Displacements come beside all else, which stays as it is to the last bit; both paths find them.
#[test]
fn tangents_of_displacements_change_nothing_else() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let scene = scene.with_bricks([4; 3], [2, 1, 2]).with_friction(0.3);
        let [at, change] = case(&scene, 7);
        let found = KINDS.map(|kind| {
            let shape = ContactShape::new(scene.clone(), kind).unwrap();
            let state = shape.solve(&at, None, Accuracy::TIGHTEST).unwrap().solution;
            let solve = |of| {
                let changes = [change.as_slice().to_vec(), at.as_slice().to_vec()];
                shape.contact_solver().tangents(&state, &changes, of, 0.0).unwrap()
            };
            let [without, with] = [TangentsOf::Contact, TangentsOf::Displacements].map(solve);
            assert_eq!((&without.forces, &without.openings), (&with.forces, &with.openings));
            assert!(without.displacements.is_none() && without.residual == with.residual);
            let more = with.applications - without.applications;
            assert_eq!(more, if kind == SolverKind::Direct { 0 } else { 2 });
            let displacements = with.displacements.unwrap();
            assert!(displacements.iter().all(|column| column.len() == shape.problem().displacement_count()));
            Vector::from_vec(displacements.concat())
        });
        let [torn, direct] = found;
        let difference = (&torn - &direct).norm() / direct.norm();
        assert!(difference < 1e-8, "{difference:.1e}");
    }
}

/// Bodies that nothing loads and nothing touches have no displacements, whatever their shape.
#[test]
fn displacements_of_bodies_at_rest_do_not_change() {
    let mut scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
    scene.bodies[0].loads.clear();
    for kind in KINDS {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let at = shape.start() * 0.9;
        let state = shape.solve(&at, None, Accuracy::TIGHTEST).unwrap().solution;
        let changes = [vec![1.0; at.len()]];
        let tangents = shape.contact_solver().tangents(&state, &changes, TangentsOf::Displacements, 0.0).unwrap();
        assert_eq!(tangents.displacements, Some(vec![vec![0.0; shape.problem().displacement_count()]]));
    }
}
