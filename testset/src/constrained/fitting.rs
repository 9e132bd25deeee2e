//! Fits to data with limits: sums of absolute residuals, and least squares with a limit on a sum of magnitudes.

use super::problem::{ConstrainedProblem, Kind, smooth, squares};
use crate::approximation;
use crate::composition::{Composition, Outer, Term};
use crate::dual::Dual;

/// The problems of this file.
pub fn problems() -> Vec<ConstrainedProblem> {
    vec![stack_loss(), el_attar(), lasso()]
}

/// Loss of ammonia on 21 days, flow of air, temperature of the water, concentration of the acid.
const STACK_LOSS: [[f64; 4]; 21] = [
    [42.0, 80.0, 27.0, 89.0],
    [37.0, 80.0, 27.0, 88.0],
    [37.0, 75.0, 25.0, 90.0],
    [28.0, 62.0, 24.0, 87.0],
    [18.0, 62.0, 22.0, 87.0],
    [18.0, 62.0, 23.0, 87.0],
    [19.0, 62.0, 24.0, 93.0],
    [20.0, 62.0, 24.0, 93.0],
    [15.0, 58.0, 23.0, 87.0],
    [14.0, 58.0, 18.0, 80.0],
    [14.0, 58.0, 18.0, 89.0],
    [13.0, 58.0, 17.0, 88.0],
    [11.0, 58.0, 18.0, 82.0],
    [12.0, 58.0, 19.0, 93.0],
    [8.0, 50.0, 18.0, 89.0],
    [7.0, 50.0, 18.0, 86.0],
    [8.0, 50.0, 19.0, 72.0],
    [8.0, 50.0, 19.0, 79.0],
    [9.0, 50.0, 20.0, 80.0],
    [15.0, 56.0, 20.0, 82.0],
    [15.0, 70.0, 20.0, 91.0],
];

fn stack_loss() -> ConstrainedProblem {
    let residuals = |x: &[Dual]| {
        let day = |[loss, air, water, acid]: [f64; 4]| &x[0] + air * &x[1] + water * &x[2] + acid * &x[3] - loss;
        STACK_LOSS.map(day).into()
    };
    let limits = |x: &[Dual]| vec![squares(&x[1..], 0.0) - 0.64, (&x[0] / 20.0).square() - &x[1]];
    let source = "K. A. Brownlee, Statistical Theory and Methodology (1965), stack loss; two limits added here";
    let objective = Composition::new(Outer::sum_of(Term::Magnitude, STACK_LOSS.len()), residuals);
    ConstrainedProblem::new(("StackLossBall", source), [0.0; 4], objective, [Kind::Smooth; 2], limits).solved(
        61.457732853072,
        2,
        67.0,
    )
}

fn el_attar() -> ConstrainedProblem {
    let objective = Composition::new(Outer::sum_of(Term::Magnitude, 51), approximation::el_attar);
    let limit = |x: &[Dual]| vec![x[0].square() + x[1].square() + x[4].square() - 6.0];
    let source = "R. A. El-Attar, M. Vidyasagar, S. R. K. Dutta, SIAM J. Numer. Anal. 16 (1979); a ball added here";
    ConstrainedProblem::new(("ElAttarBall", source), [2.0, 2.0, 7.0, 0.0, -2.0, 1.0], objective, [Kind::Smooth], limit)
        .solved(0.965524790021, 1, 0.52)
        .or_ends_at(5.844494)
}

/// ½ Σ (aᵢᵀ x − bᵢ)² with Σ |xⱼ| ≤ 0.6; two of twenty variables are not zero at the solution.
fn lasso() -> ConstrainedProblem {
    let objective = |x: &[Dual]| {
        let residual = |i: i32| {
            let (i, shift) = (f64::from(i), 0.3);
            let weights = (0..20).map(|j| (0.7 * i * (f64::from(j) + 1.0) + shift * f64::from(j)).cos());
            Dual::combination(weights.zip(x)) - (1.3 * i).sin() - i / 30.0
        };
        0.5 * Dual::sum((1..=30).map(|i| residual(i).square()))
    };
    let limit = |x: &[Dual]| vec![Dual::sum(x.iter().map(Dual::abs)) - 0.6];
    let source = "R. Tibshirani, J. R. Stat. Soc. B 58 (1996); data added here";
    ConstrainedProblem::new(("Lasso20", source), [0.0; 20], smooth(objective), [Kind::Nonsmooth], limit).solved(
        7.426731097321,
        1,
        9.7,
    )
}
