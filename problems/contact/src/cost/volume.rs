//! The volume of the bodies that controls shape as a function of the controls.

use crate::equilibrium::ContactProblem;
use nonsmooth::Vector;

/// The volume of the shaped bodies at some controls, mm³.
pub(crate) fn volume(problem: &ContactProblem, controls: &[f64]) -> f64 {
    let positions = problem.map.positions(controls);
    problem.map.shaped_bodies().map(|body| problem.bodies[body].mesh.volume(&positions[body])).sum()
}

/// Its derivative by the positions of the nodes of all bodies, mm².
pub(crate) fn volume_slope(problem: &ContactProblem, controls: &[f64]) -> Vec<[f64; 3]> {
    let positions = problem.map.positions(controls);
    let mut slope = problem.no_sensitivities();
    for body in problem.map.shaped_bodies() {
        let own = problem.bodies[body].mesh.volume_derivative(&positions[body]);
        slope[problem.map.nodes(body)].copy_from_slice(&own);
    }
    slope
}

/// Its derivative by the controls, mm³ per unit of a control.
pub(crate) fn volume_gradient(problem: &ContactProblem, controls: &[f64]) -> Vector {
    Vector::from_vec(problem.map.pull_back(&volume_slope(problem, controls)))
}
