//! Maxima of smooth functions with limits, and smooth objectives whose constraint is a maximum over a parameter.

use super::problem::{ConstrainedProblem, Kind, maximum, smooth, squares};
use crate::dual::Dual;
use crate::minimax;
use crate::table;

/// The problems of this file.
pub fn problems() -> Vec<ConstrainedProblem> {
    vec![cb2(), evd52(), shor(), maxquad(), maxquad_norms(), polak3(), davidon2(), tfi1(), tfi2(), tfi3()]
}

/// Both limits are active at (1 + √⅛, 1 − √⅛), where the second piece is the largest; the first limit excludes a disk.
fn cb2() -> ConstrainedProblem {
    let limits = |x: &[Dual]| vec![2.25 - squares(x, 0.0), &x[0] + &x[1] - 2.0];
    let source =
        "C. Charalambous, J. W. Bandler, Int. J. Syst. Sci. 7 (1976), CB2; limits of later tests of SQP methods";
    ConstrainedProblem::new(("CB2Limited", source), [2.1, 1.9], maximum(minimax::cb2), [Kind::Smooth; 2], limits)
        .solved(2.25, 1, 7.5)
        .or_ends_at(4.05622996)
}

fn evd52() -> ConstrainedProblem {
    let ball = |x: &[Dual], shifted: usize| {
        Dual::sum((0..3).map(|i| if i == shifted { (&x[i] - 1.0).square() } else { x[i].square() }))
    };
    let limits = move |x: &[Dual]| vec![ball(x, 0) - 0.5, ball(x, 1) - 1.0];
    let source = "Lukšan, Vlček (2000), EVD52; two balls added here";
    ConstrainedProblem::new(("EVD52TwoBalls", source), [1.0; 3], maximum(minimax::evd52), [Kind::Smooth; 2], limits)
        .solved(3.605451658068, 2, 0.5)
}

fn shor() -> ConstrainedProblem {
    let record = table::records().into_iter().find(|record| record.name == "Shor");
    let record = record.expect("Shor's problem is in the table");
    let objective = maximum(minimax::shor(record.matrix("a"), record.vector("b")));
    let limits = |x: &[Dual]| vec![squares(x, 0.0) - 4.0, x[2].square() - &x[4] + 0.36];
    let source = "N. Z. Shor (1985); two limits added here";
    ConstrainedProblem::new(("ShorTwoLimits", source), [0.0, 0.0, 0.0, 0.0, 1.0], objective, [Kind::Smooth; 2], limits)
        .solved(24.81473102051, 2, 4.9)
}

fn maxquad() -> ConstrainedProblem {
    let source = "C. Lemaréchal, Maxquad; a ball added here";
    let limit = |x: &[Dual]| vec![squares(x, 0.0) - 0.04];
    ConstrainedProblem::new(("MaxquadBall", source), [1.0; 10], maximum(minimax::maxquad()), [Kind::Smooth], limit)
        .solved(-0.675413566357, 1, 7.7)
}

/// The largest magnitude at most 0.1, and the sum of magnitudes at most 0.4.
fn maxquad_norms() -> ConstrainedProblem {
    let limits = |x: &[Dual]| vec![Dual::max(x.iter().map(Dual::abs)) - 0.1, Dual::sum(x.iter().map(Dual::abs)) - 0.4];
    let source = "C. Lemaréchal, Maxquad; limits on two norms added here";
    ConstrainedProblem::new(
        ("MaxquadNorms", source),
        [1.0; 10],
        maximum(minimax::maxquad()),
        [Kind::Nonsmooth; 2],
        limits,
    )
    .solved(-0.55212228164, 2, 4.1)
}

fn polak3() -> ConstrainedProblem {
    let limits = |x: &[Dual]| vec![squares(x, 0.5) - 1.0, x[0].square() + x[1].square() - &x[2]];
    let source = "Lukšan, Vlček (2000), Polak 3; two limits added here";
    ConstrainedProblem::new(("Polak3Ball", source), [1.0; 11], maximum(minimax::polak3), [Kind::Smooth; 2], limits)
        .solved(4.111404280278, 2, 1.7)
}

fn davidon2() -> ConstrainedProblem {
    let limit = |x: &[Dual]| vec![(squares(x, 0.0) - 300.0) / 100.0];
    let source = "Lukšan, Vlček (2000), Davidon 2; a ball added here";
    let start = [25.0, 5.0, -5.0, -1.0];
    ConstrainedProblem::new(("Davidon2Ball", source), start, maximum(minimax::davidon2), [Kind::Smooth], limit).solved(
        122.543646169343,
        1,
        24.0,
    )
}

/// A problem whose constraint holds for t = 0, 0.01, …, 1.
fn on_grid(
    name: &'static str,
    start: [f64; 3],
    objective: impl Fn(&[Dual]) -> Dual + Send + Sync + 'static,
    constraint: impl Fn(&[Dual], f64) -> Dual + Send + Sync + 'static,
) -> ConstrainedProblem {
    let limit = move |x: &[Dual]| vec![Dual::max((0..=100).map(|i| constraint(x, f64::from(i) / 100.0)))];
    let source = "Y. Tanaka, M. Fukushima, T. Ibaraki, J. Comput. Appl. Math. 23 (1988), on 101 points";
    ConstrainedProblem::new((name, source), start, smooth(objective), [Kind::Nonsmooth], limit)
}

fn parabola(x: &[Dual], t: f64) -> Dual {
    &x[0] + t * &x[1] + t * t * &x[2]
}

fn tfi1() -> ConstrainedProblem {
    let wave = |t: f64| (2.0 * t).exp() - 2.0 * (4.0 * t).sin();
    let constraint = move |x: &[Dual], t: f64| &x[0] + &x[1] * (t * &x[2]).exp() + wave(t);
    on_grid("TFI1", [1.0; 3], |x| squares(x, 0.0), constraint).solved(5.334687280053, 1, 0.64)
}

fn tfi2() -> ConstrainedProblem {
    let objective = |x: &[Dual]| &x[0] + &x[1] / 2.0 + &x[2] / 3.0;
    on_grid("TFI2", [0.0; 3], objective, |x, t| t.tan() - parabola(x, t)).solved(0.649031108253, 1, 1.5)
}

fn tfi3() -> ConstrainedProblem {
    let objective = |x: &[Dual]| Dual::sum(x.iter().map(Dual::exp));
    let constraint = |x: &[Dual], t: f64| 1.0 / (1.0 + t * t) - parabola(x, t);
    on_grid("TFI3", [1.0, 0.5, 0.0], objective, constraint).solved(4.301157877668, 1, 4.2)
}
