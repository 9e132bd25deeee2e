//! A bar pressed against a rough plane and pulled at its end: it slips as far as friction needs to carry the pull.
//!
//! ```text
//! E A u″ = 𝓕 p b on (L − ℓ, L),  u = 0 before,  E A u′(L) = Q:     ℓ = Q/(𝓕 p b),   u = 𝓕 p b (x − L + ℓ)²/(2 E A)
//! ```
//! ν = 0 and a height far below the length of a brick make the column of bricks that bar, up to (height/length of a
//! brick).

use super::setting::{SECOND, block, load, pressures, solve, support};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{Quantity, StateCost, StateView};
use contact::equilibrium::ContactStatus;
use contact::scene::{CounterSurface, Scene};
use nonsmooth::{Accuracy, StateSolver};

const LENGTH: f64 = 100.0;
const WIDTH: f64 = 2.0;
const HEIGHT: f64 = 0.001;
const MODULUS: f64 = 1.0e5;
const PRESSURE: f64 = 10.0;
const FRICTION: f64 = 0.4;
/// ℓ, mm: slip ends at a third of a brick on both meshes.
const SLIP_LENGTH: f64 = 5.0 * (12.0 + 1.0 / 3.0);

fn bar(bricks: usize) -> Scene {
    let material = Material::new(MODULUS, 0.0).unwrap();
    let scene = block([LENGTH, WIDTH], HEIGHT, [bricks, 1, 1], material, CounterSurface::Plane { height: HEIGHT });
    let mut scene = scene.with_friction(FRICTION);
    scene.bodies[0].supports = vec![support(BlockFace::X2Min, SECOND), support(BlockFace::X2Max, SECOND)];
    let pull = FRICTION * PRESSURE * SLIP_LENGTH / HEIGHT;
    scene.bodies[0].loads =
        vec![load(BlockFace::Bottom, [0.0, 0.0, PRESSURE]), load(BlockFace::X1Max, [pull, 0.0, 0.0])];
    scene
}

/// Slip length by the friction forces that are on the cone, mm; largest error of the slip over its largest value.
fn measure(bricks: usize) -> (f64, f64) {
    let (shape, state) = solve(&bar(bricks), SolverKind::Direct);
    let friction_per_length = FRICTION * PRESSURE * WIDTH;
    let (mut slipping, mut worst) = (0.0, 0.0_f64);
    let exact =
        |x: f64| friction_per_length * (x - LENGTH + SLIP_LENGTH).max(0.0).powi(2) / (2.0 * MODULUS * WIDTH * HEIGHT);
    for (index, ([x, _], area, _)) in pressures(&shape, &state).into_iter().enumerate() {
        if state.forces.status[index] == ContactStatus::Slip {
            slipping += area / WIDTH;
        }
        worst = worst.max((state.forces.slip[index][0] - exact(x)).abs() / exact(LENGTH));
    }
    (slipping, worst)
}

#[test]
fn slip_length_and_displacement() {
    let mut errors = Vec::new();
    for bricks in [20, 80] {
        let (slipping, error) = measure(bricks);
        let brick = LENGTH / bricks as f64;
        println!(
            "bar of {bricks} bricks: slip length {slipping:.3} (exact {SLIP_LENGTH:.3}, brick {brick}), slip error {error:.1e}"
        );
        assert!((slipping - SLIP_LENGTH).abs() <= brick, "{bricks}: {slipping}");
        errors.push(error);
    }
    let rate = (errors[0] / errors[1]).log2() / 2.0;
    println!("rate of the slip error {rate:.2}");
    assert!(errors[1] < 2e-4 && rate > 1.5, "{errors:?} {rate}");
}

/// f·u = Q u(L) + p b L · p h/E: the pull moves its end by u(L), the pressure shortens the bar by p h/E.
#[test]
fn compliance_is_the_work_of_pull_and_pressure() {
    let shape = ContactShape::new(bar(80), SolverKind::Direct).unwrap().with_displacements();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    let compliance = StateCost::new("objective", &Quantity::Compliance, shape.problem()).unwrap().unwrap();
    let found = compliance.value(shape.problem(), StateView::of(&state));
    let pull = FRICTION * PRESSURE * WIDTH * SLIP_LENGTH;
    let end = FRICTION * PRESSURE * WIDTH * SLIP_LENGTH.powi(2) / (2.0 * MODULUS * WIDTH * HEIGHT);
    let exact = pull * end + PRESSURE * WIDTH * LENGTH * PRESSURE * HEIGHT / MODULUS;
    println!("compliance of the bar {found:.6} (exact {exact:.6})");
    // The error of the displacement at the end.
    assert!((found / exact - 1.0).abs() < 2e-4, "{found} {exact}");
}
