//! Bodies inside each other, sharp ridges, two shaped surfaces, faces that hang over, and what is refused.

use crate::grid::{Point, mesh, sector};
use crate::setting::{body, boxed, lattice, pair, stacked};
use contact::body::mesh::CellKind;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::equilibrium::ContactProblem;
use contact::scene::{
    BodyFace, ContactScene, CounterSurface, Geometry, Load, Master, NormalKind, Scene, Support, hertz,
};
use contact::shape::{LatticeShape, ShapedFace};
use nonsmooth::{Accuracy, StateSolver, Vector};

/// Both solvers find states with the same displacements, and forces on every body in equilibrium; the displacements.
fn agreed(scene: &Scene) -> Vec<Point> {
    let at = Vector::from_vec(scene.start());
    let [first, second] = [SolverKind::Direct, SolverKind::Newton].map(|kind| {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let state = shape.solve(&at, None, Accuracy::TIGHTEST).unwrap();
        let force = state.forces.total_normal_force();
        for body in shape.resultants(&state).unwrap().bodies {
            let off = body.imbalance().iter().fold(0.0, |off: f64, force| off.max(force.abs()));
            assert!(off < 1e-8 * force, "{kind:?} {}: {off:e} of {force:e}", body.body);
        }
        shape.bodies(&state).unwrap().into_iter().flat_map(|body| body.displacement).collect::<Vec<Point>>()
    });
    let size = first.iter().flatten().fold(0.0, |size: f64, u| size.max(u.abs()));
    let off = first.iter().flatten().zip(second.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-8 * size, "{off:e} of {size:e}");
    first
}

#[test]
fn a_pin_in_a_bush_presses_on_one_side() {
    let mut pin = body("pin", mesh(CellKind::Hex8, [9, 2, 2], 0.0, sector([2.0, 5.0], 3.0, 6.0)), [2000.0, 0.3]);
    let mut bush = body("bush", mesh(CellKind::Hex8, [13, 3, 2], 0.0, sector([5.02, 8.0], 3.0, 6.0)), [1000.0, 0.3]);
    pin.shape = lattice([-6.0, 0.0, -1.0], [12.0, 6.0, 7.0], [true; 3]);
    bush.supports = vec![Support::new("top", [true; 3])];
    pin.supports = vec![Support::new("bottom", [true, true, false])];
    pin.loads = vec![Load::traction("bottom", [0.0, 0.0, 20.0])];
    let contact = ContactScene::new(BodyFace::new(0, "top"), Master::Body(BodyFace::new(1, "bottom")), 0.2);
    let scene = Scene { name: "pin".into(), bodies: vec![pin, bush], contacts: vec![contact] };
    let displacement = agreed(&scene);
    assert!(displacement.iter().any(|u| u[2] > 0.02), "the pin comes to the bush");
    let shape = ContactShape::new(scene.clone(), SolverKind::Direct).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    let counts = state.forces.counts();
    assert!(counts.open > 0 && counts.stick + counts.slip > 5, "{counts:?}");
}

#[test]
fn a_ridge_between_nodes_is_no_obstacle_to_a_state() {
    let height = |x1: f64| 8.0 - 0.5 * (x1 - 5.0).abs();
    let below = |[s, t, r]: Point| [10.0 * s, 10.0 * t, r * height(10.0 * s)];
    let above = |[s, t, r]: Point| [10.0 * s, 10.0 * t, height(10.0 * s) + r * (16.0 - height(10.0 * s))];
    for [lower, upper] in [[4, 3], [3, 4], [4, 6]] {
        let mut own = body("lower", mesh(CellKind::Hex8, [lower, lower, 2], 0.0, below), [1000.0, 0.3]);
        own.shape = lattice([0.0; 3], [10.0; 3], [true; 3]);
        let other = body("upper", mesh(CellKind::Hex8, [upper, upper, 2], 0.0, above), [1500.0, 0.3]);
        let mut bodies = stacked(own, other, 5.0);
        bodies.iter_mut().for_each(|body| body.supports.retain(|support| support.face != "x1-min"));
        bodies[0].supports.push(Support::new("bottom", [true; 3]));
        bodies[0].supports.retain(|support| support.face == "bottom");
        bodies[1].supports = vec![Support::new("top", [true, true, false])];
        for slave in [0, 1] {
            agreed(&pair(bodies.clone(), slave, 0.2));
        }
    }
}

/// The Hertz scene with a shaped bottom of the upper block as well.
fn both_shaped() -> Scene {
    let mut scene = hertz().unwrap().with_bricks([4; 3], [2; 3]);
    if let Geometry::Block(block) = &mut scene.bodies[1].geometry {
        block.bricks = [5; 3];
        block.subdomains = [1; 3];
    }
    let heights = LatticeShape::heights(ShapedFace::Bottom, [4, 4], [3, 3], 10.2);
    let (slope, volume) = (Some(5.0), Some([800.0, 1200.0]));
    scene.bodies[1].shape = Some(LatticeShape { thickness: Some(4.0), slope, volume, ..heights });
    scene
}

#[test]
fn one_vector_of_controls_shapes_both_surfaces() {
    let scene = both_shaped();
    assert_eq!(scene.control_count(), 36 + 16);
    for (kind, normal) in [(SolverKind::Direct, NormalKind::X3), (SolverKind::Newton, NormalKind::Surface)] {
        let mut scene = scene.clone();
        scene.contacts[0].normal = normal;
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let set = shape.problem().admissible.clone();
        let measure = Quantity::Pressure(PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area });
        let objective = ContactObjective::new(shape, measure, &[]).unwrap();
        let start = Vector::from_vec(scene.start());
        let at = Vector::from_fn(start.len(), |k, _| start[k] + 0.05 * (2.0 * k as f64 + 1.0).cos());
        set.check(&at).unwrap();
        let through = Vector::from_fn(start.len(), |k, _| if k < 36 { 10.3 } else { 10.1 });
        assert!(set.check(&through).is_err(), "surfaces that go through each other");
        let solve = |control: &Vector| objective.cases().solve(control, None, Accuracy::TIGHTEST).unwrap();
        let here = solve(&at);
        let direction = Vector::from_fn(at.len(), |k, _| (k as f64 + 1.0).sin());
        let slope = objective.differentiate(&at, &here).unwrap().subgradient.dot(&direction);
        let step = 1e-5;
        let value = |steps: f64| objective.value(&solve(&(&at + &direction * (steps * step))));
        let quotient = (8.0 * (value(1.0) - value(-1.0)) - (value(2.0) - value(-2.0))) / (12.0 * step);
        assert!((slope / quotient - 1.0).abs() < 1e-6, "{kind:?}: {slope} {quotient}");
    }
}

/// A small body on a large one, whose face is the slave.
fn hanging_over() -> Scene {
    let mut lower = body("lower", boxed([7, 7, 2], 0.0, [0.0; 3], [14.0, 14.0, 5.0]), [1000.0, 0.3]);
    lower.shape = lattice([0.0; 3], [14.0, 14.0, 6.0], [true; 3]);
    let upper = body("upper", boxed([4, 4, 2], 0.0, [0.0, 0.0, 5.0], [8.7, 8.7, 9.0]), [1000.0, 0.3]);
    pair(stacked(lower, upper, 5.0), 0, 0.2)
}

#[test]
fn slave_nodes_beside_the_master_carry_nothing_and_are_told_of() {
    let scene = hanging_over();
    agreed(&scene);
    let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
    let uncovered: Vec<_> = shape.problem().uncovered_nodes().collect();
    assert!(matches!(uncovered[..], [(0, count)] if count > 20), "{uncovered:?}");
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    let warnings = shape.warnings(&state).unwrap();
    assert!(warnings.iter().any(|warning| warning.code == "overhanging-face"), "{warnings:?}");
    // Where the master ends within a facet, the covered part of its area counts.
    let total: f64 = state.rows.contact_nodes().iter().filter(|node| node.is_covered).map(|node| node.area).sum();
    assert!((total / (8.7 * 8.7) - 1.0).abs() < 1e-3, "{total}");
}

#[test]
fn equal_grids_have_one_partner_per_node() {
    let problem = ContactProblem::new(hertz().unwrap().with_bricks([5; 3], [1; 3])).unwrap();
    for (point, rows) in problem.boundary.points.iter().zip(&problem.start_rows().nodes) {
        assert!(point.sides.len() == 2 && rows.weights[0] == 1.0, "{:?}", rows.weights);
        assert!((rows.weights[1] + 1.0).abs() < 1e-12, "{:?}", rows.weights);
    }
}

fn refused(change: impl FnOnce(&mut Scene)) -> String {
    let mut scene = hanging_over();
    change(&mut scene);
    ContactProblem::new(scene).unwrap_err().to_string()
}

#[test]
fn what_is_no_contact_is_refused_with_the_reason() {
    let itself = refused(|scene| scene.contacts[0].master = Master::Body(BodyFace::new(0, "x1-max")));
    assert!(itself.contains("contact[0].master.body") && itself.contains("another body"), "{itself}");
    let apart = refused(|scene| {
        scene.bodies[1] = scene.bodies[1].clone().moved([40.0, 0.0, 0.0]).unwrap();
    });
    assert!(apart.contains("opposite to each other"), "{apart}");
    let twice = refused(|scene| {
        let floor = Master::Obstacle(CounterSurface::Plane { height: 6.0 });
        scene.contacts.push(ContactScene::along_x3(BodyFace::new(0, "top"), floor, 0.0));
    });
    assert!(twice.contains("contact[1].slave") && twice.contains("another contact"), "{twice}");
    let glued = refused(|scene| {
        scene.contacts[0].kind = contact::scene::ContactKind::Tied;
        scene.contacts[0].friction = 0.2;
    });
    assert!(glued.contains("contact[0].tied"), "{glued}");
    let named = refused(|scene| scene.contacts[0].master = Master::Body(BodyFace::new(1, "botom")));
    assert!(named.contains("contact[0].master") && named.contains("bottom"), "{named}");
    let alone = refused(|scene| {
        let mut third = scene.bodies[1].clone();
        third.name = "third".into();
        scene.bodies.push(third);
    });
    assert!(alone.contains("third"), "{alone}");
}
