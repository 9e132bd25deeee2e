//! Smooth objectives with inequalities, nearly all from W. Hock, K. Schittkowski, Test Examples for Nonlinear
//! Programming Codes (1981), and one example with kinks.

use super::problem::{ConstrainedProblem, Kind, smooth, squares, variables};
use crate::composition::{Composition, Outer, Term};
use crate::dual::Dual;
use crate::penalty::{self, Colville};
use std::f64::consts::SQRT_2;

const INF: f64 = f64::INFINITY;

/// The problems of this file.
pub fn problems() -> Vec<ConstrainedProblem> {
    let small =
        [rosen_suzuki(), nonsmooth_rosenbrock(), hs10(), hs11(), hs12(), hs22(), hs29(), hs31(), hs34(), hs64()];
    let large = [hs65(), hs66(), hs72(), hs83(), hs93(), hs100(), hs104(), hs106(), hs113(), hs117(), wong3()];
    small.into_iter().chain(large).collect()
}

/// A smooth problem with inequalities.
fn smooth_problem<const M: usize>(
    name: (&str, &'static str),
    start: impl Into<Vec<f64>>,
    objective: impl Fn(&[Dual]) -> Dual + Send + Sync + 'static,
    constraints: impl Fn(&[Dual]) -> [Dual; M] + Send + Sync + 'static,
) -> ConstrainedProblem {
    ConstrainedProblem::new(name, start, smooth(objective), [Kind::Smooth; M], move |x| constraints(x).into())
}

fn rosen_suzuki() -> ConstrainedProblem {
    let source = "J. B. Rosen, S. Suzuki, Commun. ACM 8 (1965); Hock, Schittkowski (1981), 43";
    let (objective, limits) = (penalty::rosen_suzuki_objective, |x: &[Dual]| penalty::rosen_suzuki_constraints(x, 2.0));
    smooth_problem(("RosenSuzuki", source), [0.0; 4], objective, limits).solved(-44.0, 2, 4.5)
}

/// 8 |x₁² − x₂| + (1 − x₁)² with max(√2 x₁, 2 x₂) ≤ 1; solution (√½, ½), on the kinks of both functions.
fn nonsmooth_rosenbrock() -> ConstrainedProblem {
    let outer = Outer::Sum(vec![(8.0, Term::Magnitude), (1.0, Term::Itself)]);
    let objective = Composition::new(outer, |x| vec![x[0].square() - &x[1], (1.0 - &x[0]).square()]);
    let limit = |x: &[Dual]| vec![Dual::max([SQRT_2 * &x[0], 2.0 * &x[1]]) - 1.0];
    let source = "F. E. Curtis, M. L. Overton, SIAM J. Optim. 22 (2012), example 5.1";
    ConstrainedProblem::new(("NonsmoothRosenbrock", source), [-1.2, 1.0], objective, [Kind::Nonsmooth], limit).solved(
        (1.0 - 0.5_f64.sqrt()).powi(2),
        1,
        0.5,
    )
}

fn hs10() -> ConstrainedProblem {
    let limit = |x: &[Dual]| [3.0 * x[0].square() - 2.0 * &x[0] * &x[1] + x[1].square() - 1.0];
    let source = "Hock, Schittkowski (1981), 10";
    smooth_problem(("HS10", source), [-10.0, 10.0], |x| &x[0] - &x[1], limit).solved(-1.0, 1, 0.75)
}

fn hs11() -> ConstrainedProblem {
    let objective = |x: &[Dual]| (&x[0] - 5.0).square() + x[1].square() - 25.0;
    let source = "Hock, Schittkowski (1981), 11";
    smooth_problem(("HS11", source), [4.9, 0.1], objective, |x| [x[0].square() - &x[1]]).solved(-8.498464223155, 1, 4.6)
}

fn hs12() -> ConstrainedProblem {
    let objective = |x: &[Dual]| 0.5 * x[0].square() + x[1].square() - &x[0] * &x[1] - 7.0 * &x[0] - 7.0 * &x[1];
    let limit = |x: &[Dual]| [4.0 * x[0].square() + x[1].square() - 25.0];
    smooth_problem(("HS12", "Hock, Schittkowski (1981), 12"), [0.0; 2], objective, limit).solved(-30.0, 1, 0.75)
}

fn hs22() -> ConstrainedProblem {
    let objective = |x: &[Dual]| (&x[0] - 2.0).square() + (&x[1] - 1.0).square();
    let limits = |x: &[Dual]| [x[0].square() - &x[1], &x[0] + &x[1] - 2.0];
    smooth_problem(("HS22", "Hock, Schittkowski (1981), 22"), [2.0; 2], objective, limits).solved(1.0, 1, 2.0)
}

fn hs29() -> ConstrainedProblem {
    let limit = |x: &[Dual]| [x[0].square() + 2.0 * x[1].square() + 4.0 * x[2].square() - 48.0];
    let source = "Hock, Schittkowski (1981), 29";
    smooth_problem(("HS29", source), [1.0; 3], |x| -(&x[0] * &x[1] * &x[2]), limit).solved(-16.0 * SQRT_2, 1, 1.1)
}

fn hs31() -> ConstrainedProblem {
    let objective = |x: &[Dual]| 9.0 * x[0].square() + x[1].square() + 9.0 * x[2].square();
    let source = "Hock, Schittkowski (1981), 31";
    smooth_problem(("HS31", source), [1.0; 3], objective, |x| [1.0 - &x[0] * &x[1]])
        .within([-10.0, 1.0, -10.0], [10.0, 10.0, 1.0])
        .solved(6.0, 1, 9.0)
}

fn exponentials(x: &[Dual]) -> [Dual; 2] {
    [x[0].exp() - &x[1], x[1].exp() - &x[2]]
}

fn hs34() -> ConstrainedProblem {
    smooth_problem(("HS34", "Hock, Schittkowski (1981), 34"), [0.0, 1.05, 2.9], |x| -&x[0], exponentials)
        .within([0.0; 3], [100.0, 100.0, 10.0])
        .solved(-(10_f64.ln().ln()), 2, 0.72)
}

fn hs64() -> ConstrainedProblem {
    let cost = |x: &Dual, own: f64, fixed: f64| own * x + fixed / x;
    let objective =
        move |x: &[Dual]| cost(&x[0], 5.0, 50_000.0) + cost(&x[1], 20.0, 72_000.0) + cost(&x[2], 10.0, 144_000.0);
    let limit = |x: &[Dual]| [4.0 / &x[0] + 32.0 / &x[1] + 120.0 / &x[2] - 1.0];
    smooth_problem(("HS64", "Hock, Schittkowski (1981), 64"), [1.0; 3], objective, limit)
        .within([1e-5; 3], [INF; 3])
        .solved(6299.84242792152, 1, 3500.0)
}

fn hs65() -> ConstrainedProblem {
    let objective =
        |x: &[Dual]| (&x[0] - &x[1]).square() + (&x[0] + &x[1] - 10.0).square() / 9.0 + (&x[2] - 5.0).square();
    let limit = |x: &[Dual]| [squares(x, 0.0) - 48.0];
    smooth_problem(("HS65", "Hock, Schittkowski (1981), 65"), [-5.0, 5.0, 0.0], objective, limit)
        .within([-4.5, -4.5, -5.0], [4.5, 4.5, 5.0])
        .solved(0.953528856805, 1, 0.5)
}

fn hs66() -> ConstrainedProblem {
    let objective = |x: &[Dual]| 0.2 * &x[2] - 0.8 * &x[0];
    smooth_problem(("HS66", "Hock, Schittkowski (1981), 66"), [0.0, 1.05, 2.9], objective, exponentials)
        .within([0.0; 3], [100.0, 100.0, 10.0])
        .solved(0.518163274182, 2, 1.3)
}

fn hs72() -> ConstrainedProblem {
    let fractions = |x: &[Dual], weights: [f64; 4]| Dual::sum(weights.into_iter().zip(x).map(|(weight, x)| weight / x));
    let limits = move |x: &[Dual]| {
        [fractions(x, [4.0, 2.25, 1.0, 0.25]) - 0.0401, fractions(x, [0.16, 0.36, 0.64, 0.64]) - 0.010_085]
    };
    let objective = |x: &[Dual]| 1.0 + Dual::sum(x.iter().cloned());
    smooth_problem(("HS72", "Hock, Schittkowski (1981), 72"), [1.0; 4], objective, limits)
        .within([0.001; 4], [4e5, 3e5, 2e5, 1e5])
        .solved(727.679357789613, 2, 74_000.0)
}

/// Colville's third problem.
fn hs83() -> ConstrainedProblem {
    let objective =
        |x: &[Dual]| 5.357_854_7 * x[2].square() + 0.835_689_1 * &x[0] * &x[4] + 37.293_239 * &x[0] - 40_792.141;
    let limits = |x: &[Dual]| {
        let [a, b, c, d, e] = variables(x);
        let first = 85.334_407 + 0.005_685_8 * b * e + 0.000_626_2 * a * d - 0.002_205_3 * c * e;
        let second = -9.487_51 + 0.007_131_7 * b * e + 0.002_995_5 * a * b + 0.002_181_3 * c.square();
        let third = -10.699_039 + 0.004_702_6 * c * e + 0.001_254_7 * a * c + 0.001_908_5 * c * d;
        [-&first, first - 92.0, -&second, second - 20.0, -&third, third - 5.0]
    };
    smooth_problem(("HS83", "Hock, Schittkowski (1981), 83"), [78.0, 33.0, 27.0, 27.0, 27.0], objective, limits)
        .within([78.0, 33.0, 27.0, 27.0, 27.0], [102.0, 45.0, 45.0, 45.0, 45.0])
        .solved(-30_665.538_671_783_3, 2, 1900.0)
}

/// Design of a transformer.
fn hs93() -> ConstrainedProblem {
    let core = |x: &[Dual]| &x[0] * &x[3] * (&x[0] + &x[1] + &x[2]);
    let winding = |x: &[Dual]| &x[1] * &x[2] * (&x[0] + 1.57 * &x[1] + &x[3]);
    let objective =
        move |x: &[Dual]| core(x) * (0.0204 + 0.0607 * x[4].square()) + winding(x) * (0.0187 + 0.0437 * x[5].square());
    let limits = move |x: &[Dual]| {
        let product = &x[0] * &x[1] * &x[2] * &x[3] * &x[4] * &x[5];
        let losses = 0.000_62 * core(x) * x[4].square() + 0.000_58 * winding(x) * x[5].square();
        [2.07 - 0.001 * product, losses - 1.0]
    };
    let start = [5.54, 4.4, 12.02, 11.82, 0.702, 0.852];
    smooth_problem(("HS93", "Hock, Schittkowski (1981), 93"), start, objective, limits)
        .within([0.0; 6], [INF; 6])
        .solved(135.075962829152, 2, 210.0)
}

fn hs100() -> ConstrainedProblem {
    let start = [1.0, 2.0, 0.0, 4.0, 0.0, 1.0, 1.0];
    let source = "J. Asaadi, Math. Program. 4 (1973); Hock, Schittkowski (1981), 100";
    smooth_problem(("HS100", source), start, penalty::wong1_objective, penalty::wong1_constraints).solved(
        680.6300573744,
        2,
        2.3,
    )
}

/// Design of a reactor.
fn hs104() -> ConstrainedProblem {
    let objective =
        |x: &[Dual]| 0.4 * (&x[0] / &x[6]).powf(0.67) + 0.4 * (&x[1] / &x[7]).powf(0.67) + 10.0 - &x[0] - &x[1];
    let limits = move |x: &[Dual]| {
        let stage =
            |a: &Dual, b: &Dual, c: &Dual| 4.0 * a / b + 2.0 * a.powf(-0.71) / b + 0.0588 * a.powf(-1.3) * c - 1.0;
        [
            0.0588 * &x[4] * &x[6] + 0.1 * &x[0] - 1.0,
            0.0588 * &x[5] * &x[7] + 0.1 * &x[0] + 0.1 * &x[1] - 1.0,
            stage(&x[2], &x[4], &x[6]),
            stage(&x[3], &x[5], &x[7]),
            1.0 - objective(x),
            objective(x) - 4.2,
        ]
    };
    let start = [6.0, 3.0, 0.4, 0.2, 6.0, 6.0, 1.0, 0.5];
    smooth_problem(("HS104", "Hock, Schittkowski (1981), 104"), start, objective, limits)
        .within([0.1; 8], [10.0; 8])
        .solved(3.951163440104, 4, 16.0)
}

/// Heat exchangers, in the form with divisions of R. S. Dembo.
fn hs106() -> ConstrainedProblem {
    let limits = |x: &[Dual]| {
        let [first, second, third] = penalty::dembo5_constraints(x);
        let balance = 0.0025 * (&x[4] + &x[6] - &x[3]) - 1.0;
        [first, second, third, 0.0025 * (&x[3] + &x[5]) - 1.0, balance, 0.01 * (&x[7] - &x[4]) - 1.0]
    };
    let start = [5000.0, 5000.0, 5000.0, 200.0, 350.0, 150.0, 225.0, 425.0];
    let source = "R. S. Dembo, Math. Program. 10 (1976), 5; Hock, Schittkowski (1981), 106";
    smooth_problem(("HS106", source), start, |x| &x[0] + &x[1] + &x[2], limits)
        .within([vec![100.0, 1000.0, 1000.0], vec![10.0; 5]].concat(), [vec![1e4; 3], vec![1000.0; 5]].concat())
        .solved(7049.24802052867, 3, 56_000.0)
}

/// The names of the sources of Wong's second and third problem.
const WONG: [&str; 2] = [
    "J. Asaadi, Math. Program. 4 (1973); Hock, Schittkowski (1981), 113",
    "J. Asaadi, Math. Program. 4 (1973), Wong 3",
];

fn hs113() -> ConstrainedProblem {
    let start = [2.0, 3.0, 5.0, 5.0, 1.0, 2.0, 7.0, 3.0, 6.0, 10.0];
    let limits = |x: &[Dual]| penalty::wong2_constraints(x).into_iter().chain(penalty::wong2_rows(x)).collect();
    ConstrainedProblem::new(("HS113", WONG[0]), start, smooth(penalty::wong_objective), [Kind::Smooth; 8], limits)
        .solved(24.306_209_068_18, 3, 6.3)
}

fn wong3() -> ConstrainedProblem {
    let start = [2.0, 3.0, 5.0, 5.0, 1.0, 2.0, 7.0, 3.0, 6.0, 10.0, 2.0, 2.0, 6.0, 15.0, 1.0, 2.0, 1.0, 2.0, 1.0, 3.0];
    let limits = |x: &[Dual]| penalty::wong3_constraints(x).into_iter().chain(penalty::wong3_rows(x)).collect();
    ConstrainedProblem::new(("Wong3", WONG[1]), start, smooth(penalty::wong_objective), [Kind::Smooth; 17], limits)
        .solved(133.728276167816, 9, 7.9)
}

/// Colville's second problem, the dual of his first, x = (w, y).
fn hs117() -> ConstrainedProblem {
    let (data, same) = (Colville::published(), Colville::published());
    let objective = move |x: &[Dual]| data.dual_value(&x[10..], &x[..10]);
    let limits = move |x: &[Dual]| same.stationarity(&x[10..], &x[..10]);
    let start: Vec<f64> = (0..15).map(|i| if i == 6 { 60.0 } else { 0.001 }).collect();
    let source = "A. R. Colville (1968), 2; Hock, Schittkowski (1981), 117";
    ConstrainedProblem::new(("HS117", source), start, smooth(objective), [Kind::Smooth; 5], limits)
        .within([0.0; 15], [INF; 15])
        .solved(32.348678965724, 5, 2.6)
}
