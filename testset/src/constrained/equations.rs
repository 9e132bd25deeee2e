//! Smooth problems with equations from W. Hock, K. Schittkowski, Test Examples for Nonlinear Programming Codes (1981).

use super::problem::{ConstrainedProblem, Kind, smooth, squares, variables};
use crate::dual::Dual;
use std::f64::consts::SQRT_2;

/// The problems of this file.
pub fn problems() -> Vec<ConstrainedProblem> {
    vec![hs6(), hs7(), hs27(), hs39(), hs40(), hs63(), hs71(), hs77(), hs78(), hs79(), hs80(), hs111()]
}

/// A smooth problem with equations alone.
fn problem<const M: usize>(
    name: (&str, &'static str),
    start: impl Into<Vec<f64>>,
    objective: impl Fn(&[Dual]) -> Dual + Send + Sync + 'static,
    equations: impl Fn(&[Dual]) -> [Dual; M] + Send + Sync + 'static,
) -> ConstrainedProblem {
    ConstrainedProblem::new(name, start, smooth(objective), [Kind::SmoothEquality; M], move |x| equations(x).into())
}

fn hs6() -> ConstrainedProblem {
    let equation = |x: &[Dual]| [10.0 * (&x[1] - x[0].square())];
    let source = "Hock, Schittkowski (1981), 6";
    problem(("HS6", source), [-1.2, 1.0], |x| (1.0 - &x[0]).square(), equation).solved(0.0, 1, 0.5)
}

fn hs7() -> ConstrainedProblem {
    let objective = |x: &[Dual]| (1.0 + x[0].square()).ln() - &x[1];
    let equation = |x: &[Dual]| [(1.0 + x[0].square()).square() + x[1].square() - 4.0];
    problem(("HS7", "Hock, Schittkowski (1981), 7"), [2.0; 2], objective, equation).solved(-(3_f64.sqrt()), 1, 0.5)
}

fn hs27() -> ConstrainedProblem {
    let objective = |x: &[Dual]| 0.01 * (&x[0] - 1.0).square() + (&x[1] - x[0].square()).square();
    let equation = |x: &[Dual]| [&x[0] + x[2].square() + 1.0];
    problem(("HS27", "Hock, Schittkowski (1981), 27"), [2.0; 3], objective, equation).solved(0.04, 1, 0.5)
}

fn hs39() -> ConstrainedProblem {
    let equations = |x: &[Dual]| [&x[1] - x[0].powi(3) - x[2].square(), x[0].square() - &x[1] - x[3].square()];
    problem(("HS39", "Hock, Schittkowski (1981), 39"), [2.0; 4], |x| -&x[0], equations).solved(-1.0, 2, 3.0)
}

fn hs40() -> ConstrainedProblem {
    let objective = |x: &[Dual]| -(&x[0] * &x[1] * &x[2] * &x[3]);
    let equations = |x: &[Dual]| {
        let [a, b, c, d] = variables(x);
        [a.powi(3) + b.square() - 1.0, a.square() * d - c, d.square() - b]
    };
    problem(("HS40", "Hock, Schittkowski (1981), 40"), [0.8; 4], objective, equations).solved(-0.25, 3, 2.0)
}

fn hs63() -> ConstrainedProblem {
    let objective = |x: &[Dual]| {
        let [a, b, c] = variables(x);
        1000.0 - a.square() - 2.0 * b.square() - c.square() - a * b - a * c
    };
    let equations = |x: &[Dual]| [8.0 * &x[0] + 14.0 * &x[1] + 7.0 * &x[2] - 56.0, squares(x, 0.0) - 25.0];
    problem(("HS63", "Hock, Schittkowski (1981), 63"), [2.0; 3], objective, equations)
        .within([0.0; 3], [f64::INFINITY; 3])
        .solved(961.71517213, 1, 2.3)
}

fn hs71() -> ConstrainedProblem {
    let objective = |x: &[Dual]| &x[0] * &x[3] * (&x[0] + &x[1] + &x[2]) + &x[2];
    let constraints = |x: &[Dual]| vec![25.0 - &x[0] * &x[1] * &x[2] * &x[3], squares(x, 0.0) - 40.0];
    let kinds = [Kind::Smooth, Kind::SmoothEquality];
    let name = ("HS71", "Hock, Schittkowski (1981), 71");
    ConstrainedProblem::new(name, [1.0, 5.0, 5.0, 1.0], smooth(objective), kinds, constraints)
        .within([1.0; 4], [5.0; 4])
        .solved(17.014017289157, 2, 1.1)
}

fn hs77() -> ConstrainedProblem {
    let objective = |x: &[Dual]| {
        let [a, b, c, d, e] = variables(x);
        (a - 1.0).square() + (a - b).square() + (c - 1.0).square() + (d - 1.0).powi(4) + (e - 1.0).powi(6)
    };
    let equations = |x: &[Dual]| {
        let [a, b, c, d, e] = variables(x);
        [a.square() * d + (d - e).sin() - 2.0 * SQRT_2, b + c.powi(4) * d.square() - 8.0 - SQRT_2]
    };
    problem(("HS77", "Hock, Schittkowski (1981), 77"), [2.0; 5], objective, equations).solved(0.24150512879, 2, 0.5)
}

/// The equations of problems 78 and 80.
fn sphere_and_products(x: &[Dual]) -> [Dual; 3] {
    let [a, b, c, d, e] = variables(x);
    [squares(x, 0.0) - 10.0, b * c - 5.0 * d * e, a.powi(3) + b.powi(3) + 1.0]
}

fn hs78() -> ConstrainedProblem {
    let objective = |x: &[Dual]| &x[0] * &x[1] * &x[2] * &x[3] * &x[4];
    let source = "Hock, Schittkowski (1981), 78";
    problem(("HS78", source), [-2.0, 1.5, 2.0, -1.0, -1.0], objective, sphere_and_products).solved(
        -2.919700408964,
        3,
        2.4,
    )
}

fn hs79() -> ConstrainedProblem {
    let objective = |x: &[Dual]| {
        let [a, b, c, d, e] = variables(x);
        (a - 1.0).square() + (a - b).square() + (b - c).square() + (c - d).powi(4) + (d - e).powi(4)
    };
    let equations = |x: &[Dual]| {
        let [a, b, c, d, e] = variables(x);
        [a + b.square() + c.powi(3) - 2.0 - 3.0 * SQRT_2, b - c.square() + d + 2.0 - 2.0 * SQRT_2, a * e - 2.0]
    };
    problem(("HS79", "Hock, Schittkowski (1981), 79"), [2.0; 5], objective, equations).solved(0.078776820871, 3, 0.5)
}

fn hs80() -> ConstrainedProblem {
    let objective = |x: &[Dual]| (&x[0] * &x[1] * &x[2] * &x[3] * &x[4]).exp();
    let source = "Hock, Schittkowski (1981), 80";
    problem(("HS80", source), [-2.0, 2.0, 2.0, -1.0, -1.0], objective, sphere_and_products)
        .within([-2.3, -2.3, -3.2, -3.2, -3.2], [2.3, 2.3, 3.2, 3.2, 3.2])
        .solved(0.05394984777, 3, 0.5)
}

/// Equilibrium of ten chemical compounds of three elements; x are the logarithms of their amounts.
fn hs111() -> ConstrainedProblem {
    let objective = |x: &[Dual]| {
        let energies = [-6.089, -17.164, -34.054, -5.914, -24.721, -14.986, -24.1, -10.708, -26.662, -22.179];
        let total = Dual::sum(x.iter().map(Dual::exp)).ln();
        Dual::sum(x.iter().zip(energies).map(|(x, energy)| x.exp() * (energy + x - &total)))
    };
    let equations = |x: &[Dual]| {
        let atoms = |counts: &[(usize, f64)]| Dual::sum(counts.iter().map(|&(j, count)| count * x[j].exp()));
        [
            atoms(&[(0, 1.0), (1, 2.0), (2, 2.0), (5, 1.0), (9, 1.0)]) - 2.0,
            atoms(&[(3, 1.0), (4, 2.0), (5, 1.0), (6, 1.0)]) - 1.0,
            atoms(&[(2, 1.0), (6, 1.0), (7, 1.0), (8, 2.0), (9, 1.0)]) - 1.0,
        ]
    };
    problem(("HS111", "Hock, Schittkowski (1981), 111"), [-2.3; 10], objective, equations)
        .within([-100.0; 10], [100.0; 10])
        .solved(-47.761090859366, 3, 57.0)
}
