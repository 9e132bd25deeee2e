//! The volume of the lower body as a function of the controls.

use crate::equilibrium::ContactProblem;
use nonsmooth::Vector;

/// The volume of the lower body at some controls, mm³.
pub(crate) fn volume(problem: &ContactProblem, controls: &[f64]) -> f64 {
    problem.bodies[0].mesh.volume(&problem.map.positions(controls))
}

/// Its derivative by the controls, mm³ per unit of a control.
pub(crate) fn volume_gradient(problem: &ContactProblem, controls: &[f64]) -> Vector {
    let slope = problem.bodies[0].mesh.volume_derivative(&problem.map.positions(controls));
    Vector::from_vec(problem.map.pull_back(&slope))
}
