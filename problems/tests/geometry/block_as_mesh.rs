//! A block that is written as a Gmsh file and read again gives the results of the block: the file keeps positions,
//! names and cells, and a lattice over the mesh can be the height surface of the block.

use crate::scenes::{BLOCK, case, objective, solved};
use contact::solvers::SolverKind;
use nonsmooth::Vector;
use std::fs;
use std::process::Command;
use testset::kit::scratch;

const LARGEST_DIFFERENCE: f64 = 1e-10;

/// The fields of the mesh in place of those of the block. Control points of the upper layer move along x3 with the
/// weights of the block's surface: B-splines of degree 3 along x1 and x2, linear from the bottom to the top.
const MESH: &str = r#"
name = "block-as-mesh"
friction = 0.3

[[body]]
mesh = "MESH"
pieces = 8
material = { young_modulus = 1.1e5, poisson_ratio = 0.33 }
supports = [{ face = "x1-min", held = ["u1", "u2"] }]
loads = [{ face = "bottom", traction = [0.0, 0.0, 3000.0] }]

[body.lattice]
control_points = [6, 6, 2]
box = [[0.0, 0.0, 0.0], [100.0, 100.0, 100.0]]
directions = [3]
frozen = [[0, 0], [0, 0], [1, 0]]
displacement = [-2.0, 2.0]
hold_supports = false

[[contact]]
slave = { face = "top" }

[contact.obstacle]
form = "waves"
base = 103.0
first = 1.0
second = 2.0
period = 100.0

[objective]
weight = "nodes"
"#;

#[test]
fn a_block_as_a_file_has_the_results_of_the_block() {
    let folder = scratch();
    let scene = folder.path().join("block.toml");
    fs::write(&scene, BLOCK).expect("a file");
    let exported = Command::new(env!("CARGO_BIN_EXE_contact3d"))
        .arg(&scene)
        .args(["export", "--msh", "--out"])
        .arg(folder.path().join("out"))
        .output()
        .expect("an answer");
    assert!(exported.status.success(), "{}", String::from_utf8_lossy(&exported.stderr));
    let mesh = folder.path().join("out/lower_body.msh");
    let mesh = case(&MESH.replace("MESH", mesh.to_str().expect("a path in Unicode")));
    let moves = Vector::from_fn(36, |index, _| 0.4 * (1.7 * index as f64).sin());
    let heights = moves.map(|displacement| 100.0 + displacement);
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let (block, mesh) = (objective(&case(BLOCK), kind), objective(&mesh, kind));
        let (expected, expected_gradient, expected_state) = solved(&block, &heights);
        let (value, gradient, state) = solved(&mesh, &moves);
        assert!((value - expected).abs() < LARGEST_DIFFERENCE * expected, "{value} {expected}");
        let difference = (&gradient - &expected_gradient).amax() / expected_gradient.amax();
        assert!(difference < LARGEST_DIFFERENCE, "{difference:e}");
        let (forces, expected) = (&state.forces.normal, &expected_state.forces.normal);
        assert_eq!(forces.len(), expected.len());
        let largest = expected.iter().fold(0.0_f64, |size, force| size.max(force.abs()));
        let differences = forces.iter().zip(expected).map(|(force, expected)| (force - expected).abs());
        let difference = differences.fold(0.0, f64::max) / largest;
        assert!(difference < LARGEST_DIFFERENCE, "{difference:e}");
    }
}
