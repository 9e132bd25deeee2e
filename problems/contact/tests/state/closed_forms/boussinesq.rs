//! Boussinesq: the surface of an elastic half-space sinks by (1 − ν²)P/(πEr) at the distance r of a normal force P.
//!
//! A quarter of a block stands for the half-space, and a column of the inverse of its condensed stiffness for the
//! deflections. A finite block adds a field that is smooth and even in r: A/r + B + Cr² is fitted at distances from 0.2
//! to 0.7 of the side.

use super::setting::{FIRST, SECOND, THIRD, block, support};
use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::direct::DirectSolver;
use contact::equilibrium::ContactProblem;
use contact::scene::CounterSurface;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::Arc;

const SIDE: f64 = 10.0;
const MODULUS: f64 = 1.0e4;
const POISSON: f64 = 0.3;

/// A·πE/(1 − ν²), which is 1 on the half-space, and the largest misfit relative to A/r.
fn fitted(bricks: usize) -> (f64, f64) {
    let material = Material::new(MODULUS, POISSON).unwrap();
    let mut scene = block([SIDE; 2], SIDE, [bricks; 3], material, CounterSurface::Plane { height: SIDE });
    scene.bodies[0].supports =
        vec![support(BlockFace::X1Min, FIRST), support(BlockFace::X2Min, SECOND), support(BlockFace::Bottom, THIRD)];
    let grid = scene.bodies[0].block().unwrap().grid();
    let problem = ContactProblem::new(scene).unwrap();
    let problem = Arc::new(problem);
    let contact = DirectSolver::new(Arc::clone(&problem)).unwrap().contact(&[SIDE; 4]).unwrap();
    let normal: Vec<usize> = problem.boundary.points.iter().map(|point| point.start).collect();
    // A force on the corner of the quarter is four times as large on the whole block.
    let deflection = |column: usize| 0.25 * contact.unit * contact.compliance[(normal[column], normal[0])];
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for (column, (i, j)) in grid.columns().enumerate() {
        let r = SIDE / bricks as f64 * (i as f64).hypot(j as f64);
        if (0.2 * SIDE..=0.7 * SIDE).contains(&r) {
            // Scaled by r: the misfit is relative.
            rows.extend([1.0, r, r.powi(3)]);
            right.push(r * deflection(column));
        }
    }
    let matrix = DMatrix::from_row_slice(right.len(), 3, &rows);
    let right = DVector::from_vec(right);
    let fit = matrix.clone().svd(true, true).solve(&right, 1e-14).unwrap();
    let misfit = (matrix * &fit - right).amax() / fit[0];
    (fit[0] * PI * MODULUS / (1.0 - POISSON * POISSON), misfit)
}

#[test]
fn compliance_decays_like_the_inverse_distance() {
    let mut errors = Vec::new();
    for bricks in [12, 20] {
        let (factor, misfit) = fitted(bricks);
        println!(
            "Boussinesq, {bricks}³ bricks: coefficient of 1/r off by {:.2} %, misfit {misfit:.1e}",
            100.0 * (factor - 1.0)
        );
        errors.push(((factor - 1.0).abs(), misfit));
    }
    assert!(errors[1].0 < 0.025 && errors[1].1 < 0.04, "{errors:?}");
    assert!(errors[1].0 < errors[0].0 && errors[1].1 < errors[0].1, "{errors:?}");
}
