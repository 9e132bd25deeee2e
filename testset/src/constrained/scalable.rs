//! Problems of many variables.

use super::problem::{ConstrainedProblem, Kind, maximum, smooth, squares};
use crate::composition::{Composition, Outer, Term};
use crate::dual::Dual;
use crate::scalable;

/// The problems of this file.
pub fn problems() -> Vec<ConstrainedProblem> {
    let published = [maxq(50), chained_lq(200), chained_cb3(100), chained_lq_links(60), nesterov(200)];
    let further = [largest_stress(60), tour(25), total_variation(100), limited_lq(50)];
    published.into_iter().chain(further).collect()
}

/// max xᵢ² with a limit on each pair of neighbours; solution ⅓ everywhere, where all limits are active.
fn maxq(n: usize) -> ConstrainedProblem {
    let links = |x: &[Dual]| {
        let link = |pair: &[Dual]| circle(pair) - 2.0 * &pair[0] - 2.0 * &pair[1] + 1.0;
        x.windows(2).map(link).collect()
    };
    let source = "Haarala, Miettinen, Mäkelä (2004), MAXQ; N. Karmitsa, modification of MAD1 as constraints";
    let objective = maximum(|x| x.iter().map(Dual::square).collect());
    ConstrainedProblem::new(("MaxqLinks50", source), vec![0.6; n], objective, vec![Kind::Smooth; n - 1], links).solved(
        1.0 / 9.0,
        n - 1,
        0.51,
    )
}

/// a² + b² + a b.
fn circle(pair: &[Dual]) -> Dual {
    pair[0].square() + pair[1].square() + &pair[0] * &pair[1]
}

/// Mean of 1, 2, 3, 1, … times xᵢ².
fn ellipsoid(x: &[Dual]) -> Dual {
    let weights = [1.0, 2.0, 3.0].into_iter().cycle();
    Dual::sum(x.iter().zip(weights).map(|(x, weight)| weight * x.square())) / x.len() as f64
}

fn lq_objective(n: usize) -> Composition {
    Composition::new(Outer::sum_of(Term::Larger, n - 1), scalable::chained_lq)
}

fn chained_lq(n: usize) -> ConstrainedProblem {
    let name = ("ChainedLQEllipsoid200", "Haarala, Miettinen, Mäkelä (2004), chained LQ; an ellipsoid added here");
    ConstrainedProblem::new(name, vec![-0.5; n], lq_objective(n), [Kind::Smooth], |x| vec![ellipsoid(x) - 0.9]).solved(
        -273.881414884963,
        1,
        130.0,
    )
}

/// A limit on each pair of neighbours; solution √⅓ everywhere, where all limits are active.
fn chained_lq_links(n: usize) -> ConstrainedProblem {
    let links = |x: &[Dual]| x.windows(2).map(|pair| circle(pair) - 1.0).collect();
    let source = "Haarala, Miettinen, Mäkelä (2004), chained LQ; first piece of MAD1 as constraints, added here";
    let name = ("ChainedLQLinks60", source);
    ConstrainedProblem::new(name, vec![-0.5; n], lq_objective(n), vec![Kind::Smooth; n - 1], links).solved(
        -2.0 * (n - 1) as f64 / 3_f64.sqrt(),
        n - 1,
        52.0,
    )
}

fn chained_cb3(n: usize) -> ConstrainedProblem {
    let source = "Haarala, Miettinen, Mäkelä (2004), chained CB3 II; an ellipsoid added here";
    let (name, objective) = (("ChainedCB3IIEllipsoid100", source), maximum(scalable::chained_cb3_ii));
    ConstrainedProblem::new(name, vec![2.0; n], objective, [Kind::Smooth], |x| vec![ellipsoid(x) - 1.9]).solved(
        199.226390681471,
        1,
        42.0,
    )
}

/// Solution −r/√n everywhere for the radius r = ½, where all n pieces are active.
fn nesterov(n: usize) -> ConstrainedProblem {
    let source = "Yu. Nesterov, Introductory Lectures on Convex Optimization (2004), worst function; a ball added here";
    let (name, objective) = (("NesterovBall200", source), maximum(scalable::nesterov_worst));
    ConstrainedProblem::new(name, vec![0.0; n], objective, [Kind::Smooth], |x| vec![squares(x, 0.0) - 0.25]).solved(
        0.125 - 5.0 / (n as f64).sqrt(),
        1,
        0.5,
    )
}

/// max aᵢ xᵢ² with Σ bᵢ / xᵢ ≤ 1; all pieces are active at the solution, whose value is (Σ bᵢ √aᵢ)².
fn largest_stress(n: usize) -> ConstrainedProblem {
    let load = |i: usize| 1.0 + 0.5 * ((i + 1) as f64).sin();
    let share = move |i: usize| (1.0 + 0.5 * (2.0 * (i + 1) as f64).cos()) / n as f64;
    let objective = maximum(move |x| x.iter().enumerate().map(|(i, x)| load(i) * x.square()).collect());
    let limit = move |x: &[Dual]| vec![Dual::sum(x.iter().enumerate().map(|(i, x)| share(i) / x)) - 1.0];
    let optimum: f64 = (0..n).map(|i| share(i) * load(i).sqrt()).sum();
    let name = ("LargestStress60", "Largest square with a limit on a sum of reciprocals, added here; closed form");
    ConstrainedProblem::new(name, vec![3.0; n], objective, [Kind::Smooth], limit)
        .within(vec![0.01; n], vec![100.0; n])
        .solved(optimum.powi(2), 1, 3.0)
}

/// The shortest path from (0, 0) to (k + 1, 0) with one point in each of k disks, in their order.
fn tour(k: usize) -> ConstrainedProblem {
    let centers: Vec<[f64; 2]> = (0..k).map(|i| [(i + 1) as f64, if i % 2 == 0 { 1.5 } else { -1.5 }]).collect();
    let start = centers.concat();
    let objective = move |x: &[Dual]| {
        let fixed = |value: f64| 0.0 * &x[0] + value;
        let ends = ([fixed(0.0), fixed(0.0)], [fixed((k + 1) as f64), fixed(0.0)]);
        let path: Vec<Dual> = ends.0.into_iter().chain(x.iter().cloned()).chain(ends.1).collect();
        Dual::sum((0..=k).map(|i| (&path[2 * i + 2] - &path[2 * i]).hypot(&(&path[2 * i + 3] - &path[2 * i + 1]))))
    };
    let disks = move |x: &[Dual]| {
        let radius = |i: usize| 0.5 + 0.2 * ((i + 1) as f64).sin();
        let disk = |(i, point): (usize, &[Dual])| {
            (&point[0] - centers[i][0]).square() + (&point[1] - centers[i][1]).square() - radius(i).powi(2)
        };
        x.chunks(2).enumerate().map(disk).collect()
    };
    let source = "M. S. Lobo et al., Linear Algebra Appl. 284 (1998), sums of norms; data added here";
    ConstrainedProblem::new(("Tour25", source), start, smooth(objective), vec![Kind::Smooth; k], disks).solved(
        56.58961539717,
        k,
        74.0,
    )
}

/// ½ Σ (xᵢ − centerᵢ)².
fn half_squares(x: &[Dual], center: impl Fn(usize) -> f64) -> Dual {
    0.5 * Dual::sum(x.iter().enumerate().map(|(i, x)| (x - center(i)).square()))
}

/// A noisy signal with a limit on its total variation; at the solution, most neighbours are equal.
fn total_variation(n: usize) -> ConstrainedProblem {
    let jump = |i: usize| f64::from(u8::from((30..60).contains(&i)));
    let objective = smooth(move |x| half_squares(x, |i| jump(i) + 0.3 * (1.7 * i as f64).sin()));
    let limit = |x: &[Dual]| vec![Dual::sum(x.windows(2).map(|pair| (&pair[1] - &pair[0]).abs())) - 2.0];
    let source = "L. I. Rudin, S. Osher, E. Fatemi, Physica D 60 (1992), total variation; data added here";
    ConstrainedProblem::new(("TotalVariation100", source), vec![0.0; n], objective, [Kind::Nonsmooth], limit).solved(
        2.170826451838,
        1,
        0.5,
    )
}

/// The nearest point where chained LQ is at most −45; twelve of its terms have their kink there.
fn limited_lq(n: usize) -> ConstrainedProblem {
    let objective = smooth(|x| half_squares(x, |i| 1.5 * (i as f64).cos()));
    let limit = |x: &[Dual]| {
        let terms = scalable::chained_lq(x);
        vec![Dual::sum(terms.chunks(2).map(|pair| Dual::max(pair.iter().cloned()))) + 45.0]
    };
    let source = "Haarala, Miettinen, Mäkelä (2004), chained LQ as the constraint; objective added here";
    ConstrainedProblem::new(("LimitedLQ50", source), vec![0.0; n], objective, [Kind::Nonsmooth], limit).solved(
        20.65720144747,
        1,
        0.97,
    )
}
