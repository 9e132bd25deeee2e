//! Balance of loads, contact forces and reactions; the largest stress; what is known before a solve.

use crate::common::change_counter_surface;
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{Quantity, Region, StateCost, StateView};
use contact::equilibrium::ContactProblem;
use contact::fields::Resultants;
use contact::scene::{CounterSurface, Held, Load, NormalKind, Scene, Support, hertz, signorini};
use nonsmooth::{Accuracy, StateSolver};

const KINDS: [SolverKind; 2] = [SolverKind::Newton, SolverKind::Direct];

fn of(scene: &Scene, kind: SolverKind) -> Resultants {
    let shape = ContactShape::new(scene.clone(), kind).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    assert!(state.forces.total_normal_force() > 0.0);
    shape.resultants(&state).unwrap()
}

fn scenes() -> [Scene; 4] {
    let small = |scene: Scene| scene.with_bricks([4; 3], [2, 1, 2]);
    let mut moved = small(hertz().unwrap());
    let upper = &mut moved.bodies[1];
    upper.supports.push(Support { face: "top".into(), held: Held::Components([None, None, Some(-0.05)]) });
    let mut by_normals = small(signorini().unwrap());
    by_normals.contacts[0].normal = NormalKind::Surface;
    // It holds an edge of the contact face, whose normals have parts along it.
    by_normals.bodies[0].supports.push(Support::along_normal("x1-max"));
    [small(signorini().unwrap()), small(hertz().unwrap()), moved, by_normals]
}

fn size(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn loads_contact_forces_and_reactions_are_in_balance_and_the_same_for_both_solvers() {
    for scene in scenes() {
        let [newton, direct] = KINDS.map(|kind| of(&scene, kind));
        for (one, other) in newton.bodies.iter().zip(&direct.bodies) {
            let scale = size(one.loads) + size(one.contact);
            for (words, body) in [("total FETI", one), ("direct condensation", other)] {
                let rest = size(body.imbalance());
                assert!(rest < 1e-8 * scale, "{}, {words}, {}: {rest} N of {scale} N", scene.name, body.body);
            }
            assert_eq!(one.supports.len(), other.supports.len());
            for (a, b) in one.supports.iter().zip(&other.supports) {
                let difference = size(std::array::from_fn(|axis| a.force[axis] - b.force[axis]));
                assert!(a.face == b.face && difference < 1e-7 * scale, "{a:?} {b:?} of {scale} N");
            }
        }
        let [one, other] = [newton, direct].map(|found| found.largest_stress.unwrap());
        // Rounding decides which of several cells that are alike by symmetry is named.
        assert_eq!(one.body, other.body);
        assert!((one.value / other.value - 1.0).abs() < 1e-7, "{one:?} {other:?}");
    }
}

/// Quantities are computed from the work on rigid motions, resultants from sums over nodes.
#[test]
fn quantities_of_forces_are_the_resultants() {
    for scene in scenes() {
        for kind in KINDS {
            let shape = ContactShape::new(scene.clone(), kind).unwrap().with_displacements();
            let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
            let (problem, resultants) = (shape.problem(), shape.resultants(&state).unwrap());
            let value = |quantity: Quantity| {
                let cost = StateCost::new("report", &quantity, problem).unwrap().unwrap();
                cost.value(problem, StateView::of(&state))
            };
            let slave = problem.scene.contacts[0].slave.body;
            let scale = size(resultants.bodies[slave].contact);
            let agrees = |quantity: Quantity, exact: f64| {
                let found = value(quantity.clone());
                assert!(
                    (found - exact).abs() < 1e-8 * scale,
                    "{}, {kind:?}, {quantity:?}: {found} {exact}",
                    scene.name
                );
            };
            for axis in 0..3 {
                let force = resultants.bodies[slave].contact[axis];
                agrees(Quantity::ContactForce { contact: Some(0), axis: Some(axis) }, force);
            }
            agrees(Quantity::ContactForce { contact: None, axis: None }, scale);
            for body in &resultants.bodies {
                for support in &body.supports {
                    let own = body.supports.iter().filter(|other| other.face == support.face);
                    let sum =
                        own.fold([0.0; 3], |sum, other| std::array::from_fn(|axis| sum[axis] + other.force[axis]));
                    let (name, face) = (Some(body.body.clone()), Some(support.face.clone()));
                    let region = Region { body: name, face, ..Region::WHOLE };
                    for axis in 0..3 {
                        agrees(Quantity::Reaction { region: region.clone(), axis: Some(axis) }, sum[axis]);
                    }
                    agrees(Quantity::Reaction { region, axis: None }, size(sum));
                }
            }
        }
    }
}

/// A bar under a pressure of 30 MPa: the obstacle carries it; held instead, its foot does.
#[test]
fn a_pressed_bar_has_reactions_and_stress_by_hand() {
    let mut scene = signorini().unwrap().with_bricks([3; 3], [1; 3]).with_friction(0.0);
    scene.bodies[0].material = Material::new(1.1e5, 0.0).unwrap();
    scene.bodies[0].loads = vec![Load::traction(BlockFace::Bottom, [0.0, 0.0, 30.0])];
    change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 100.0 });
    for kind in KINDS {
        let found = of(&scene, kind);
        let body = &found.bodies[0];
        assert!((body.loads[2] - 3e5).abs() < 1e-6 && (body.contact[2] + 3e5).abs() < 1e-3, "{body:?}");
        assert!(size(body.supports[0].force) < 1e-3, "{body:?}");
        let stress = found.largest_stress.unwrap();
        assert!((stress.value - 30.0).abs() < 1e-6, "{stress:?}");
        let mut held = scene.clone();
        held.bodies[0].loads.clear();
        held.bodies[0]
            .supports
            .push(Support { face: "bottom".into(), held: Held::Components([None, None, Some(100.0 * 30.0 / 1.1e5)]) });
        let found = of(&held, kind);
        let body = &found.bodies[0];
        assert!((body.supports[1].force[2] - 3e5).abs() < 1e-3 && size(body.loads) == 0.0, "{body:?}");
    }
}

#[test]
fn a_preview_tells_gaps_supports_motions_and_loads() {
    let preview = ContactProblem::new(hertz().unwrap().with_bricks([4; 3], [2; 3])).unwrap().preview();
    assert_eq!(preview.contact_nodes, 25);
    assert!(preview.gaps[0].abs() < 1e-12 && preview.gaps[1] > 1.0 && preview.overlapping == 0, "{preview:?}");
    let [lower, upper] = &preview.bodies[..] else { unreachable!("two bodies") };
    assert_eq!((lower.name.as_str(), upper.name.as_str()), ("lower", "upper"));
    assert_eq!(lower.held_faces, ["x1-min", "x2-min", "bottom"]);
    assert_eq!((lower.free_motions, lower.free_translations), (0, [false; 3]));
    assert_eq!((upper.free_motions, upper.free_translations), (1, [false, false, true]));
    assert!(upper.load[0] > 0.0 && upper.load[1] == 0.0 && upper.load[2] < 0.0 && lower.load == [0.0; 3]);
    let mut scene = signorini().unwrap().with_bricks([4; 3], [2; 3]);
    scene.contacts[0].interference = 4.0;
    let problem = ContactProblem::new(scene).unwrap();
    let preview = problem.preview();
    assert!(preview.gaps[0] < -3.9 && preview.overlapping > 0, "{preview:?}");
    assert_eq!((preview.bodies[0].free_motions, preview.bodies[0].free_translations), (1, [false, false, true]));
    assert!((preview.bodies[0].load[2] - 3e7).abs() < 1.0, "{preview:?}");
    assert!(serde_json::to_string(&preview).unwrap().contains("\"overlapping\""));
}
