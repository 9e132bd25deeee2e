//! Problems of users in which the engine went wrong.

use crate::stability::mixed_units::function::{Function, Outer, Quadratic};
use crate::stability::mixed_units::problem::{Problem, Start};
use nonsmooth::{Matrix, Vector};

/// The row of the table.
pub const REPORTED: &str = "problems of users";
/// Abscissas of a fit.
const AT: [f64; 9] = [0.05, 0.15, 0.3, 0.35, 0.5, 0.6, 0.75, 0.9, 1.0];
/// Measured values of the reported fit.
const DATA: [f64; 9] = [2.1, 3.4, 2.9, 4.2, 4.0, 5.6, 5.2, 7.3, 6.4];

fn vector(entries: &[f64]) -> Vector {
    Vector::from_column_slice(entries)
}

fn given(points: &[&[f64]]) -> Vec<Start> {
    points.iter().map(|point| Start::Given(vector(point))).collect()
}

/// A modulus of 1e8 and a length of 1 in the largest of four affine functions.
fn modulus_and_length() -> (Problem, Vector) {
    let rows = Matrix::from_row_slice(4, 2, &[1.0, 0.0, -1.0, 0.0, -0.1, -1.0, 0.0, 1.0]);
    let function = Function::new(Outer::Largest, rows, vector(&[0.0, 0.0, -1.0, 1.2]));
    let problem = Problem::free(REPORTED, function).boxed((vector(&[-1.0, 0.0]), vector(&[1.0, 2.0])));
    (problem.with_starts(vec![Start::Zero]), vector(&[1.0, 1e8]))
}

/// Parabolas through nine points, the slope in a unit of 1e-4: least absolute deviations, least largest deviation.
fn parabolas() -> [(Problem, Vector); 2] {
    let rows = Matrix::from_fn(9, 3, |i, j| AT[i].powi(j as i32));
    let units = vector(&[1.0, 1e4, 0.1]);
    let starts: Vec<Start> = [[0.0; 3], [1.0; 3], [1.0, 100.0, 1.0], [1.0, 1e4, 1.0]]
        .into_iter()
        .map(|point| Start::Given(vector(&point).component_div(&units)))
        .collect();
    [Function::new(Outer::AbsoluteSum, rows.clone(), vector(&DATA)), Function::largest_absolute(&rows, &vector(&DATA))]
        .map(|function| (Problem::free(REPORTED, function).with_starts(starts.clone()), units.clone()))
}

/// (x − 2)² over [0, 1], and x over [0, 5].
fn on_a_bound() -> [(Problem, Vector); 2] {
    let zero = Function::new(Outer::Largest, Matrix::zeros(1, 1), Vector::zeros(1));
    let root = 2_f64.sqrt();
    let quadratic = Quadratic { root: Matrix::from_element(1, 1, root), right: vector(&[0.0]) };
    let parabola = Function { quadratic: Some(quadratic), centre: vector(&[2.0]), ..zero };
    let line = Function::new(Outer::Largest, Matrix::from_element(1, 1, 1.0), Vector::zeros(1));
    [(parabola, 1.0, [1.0, 3.0, 0.2]), (line, 5.0, [0.0, 2.5, 7.0])].map(|(function, side, starts)| {
        let problem = Problem::free(REPORTED, function).boxed((vector(&[0.0]), vector(&[side])));
        (problem.with_starts(given(&starts.each_ref().map(std::slice::from_ref))), vector(&[1.0]))
    })
}

/// All of them, each with the units of its variables.
pub fn reported() -> Vec<(Problem, Vector)> {
    let mut all = vec![modulus_and_length()];
    all.extend(parabolas());
    all.extend(on_a_bound());
    all
}
