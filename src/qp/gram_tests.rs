//! Subproblems solved with inner products have the solutions of the method with orthogonal factors, warm or cold.

use super::gram::{Gram, GramMemory};
use super::problem::{EpigraphQp, Metric};
use super::{EpigraphQpSolver, kkt_residual};
use crate::{Matrix, Vector};
use proptest::prelude::*;
use testset::kit::Random;

/// Cuts of a bundle that grows, in n variables; some repeat a slope of before with another offset.
struct Sequence {
    slopes: Vec<Vector>,
    offsets: Vec<f64>,
    diagonal: Vector,
}

impl Sequence {
    fn new(seed: u64, n: usize, cuts: usize) -> Self {
        let mut random = Random(seed);
        let mut slopes: Vec<Vector> = vec![];
        for j in 0..cuts {
            let fresh = Vector::from_fn(n, |_, _| random.signed());
            slopes.push(if j % 7 == 6 { slopes[j / 2].clone() } else { fresh });
        }
        let offsets = (0..cuts).map(|_| 0.1 * random.signed().abs()).collect();
        Self { slopes, offsets, diagonal: Vector::from_fn(n, |i, _| 1.0 + (i % 3) as f64) }
    }

    /// Hands over the problem of the cuts from `first` up to `last`, and the inner products of all.
    fn with_products(&self, (first, last): (usize, usize), weight: f64, act: impl FnOnce(&EpigraphQp<'_>, Gram<'_>)) {
        let n = self.diagonal.len();
        let metric = &self.diagonal * weight;
        let ids: Vec<u64> = (first as u64..last as u64).collect();
        let open = Vector::from_element(n, f64::INFINITY);
        let qp = EpigraphQp {
            metric: Metric::Diagonal(&metric),
            slopes: &self.slopes[first..last],
            offsets: &self.offsets[first..last],
            cut_ids: &ids,
            rows: &Matrix::zeros(0, n),
            row_lower: &Vector::zeros(0),
            row_upper: &Vector::zeros(0),
            lower: &-&open,
            upper: &open,
        };
        let raised: Vec<Vector> = self.slopes.iter().map(|slope| slope.component_div(&self.diagonal)).collect();
        let rows: Vec<Vec<f64>> =
            self.slopes.iter().map(|slope| raised.iter().map(|other| slope.dot(other)).collect()).collect();
        let slots: Vec<usize> = (first..last).collect();
        act(&qp, Gram { rows: &rows, slots: &slots, weight, lasting: true });
    }

    /// Solves the problem of the cuts from `first` up to `last` with all three: warm and cold with products, cold
    /// without.
    fn compare(&self, range: (usize, usize), weight: f64, warm: &mut EpigraphQpSolver) {
        self.with_products(range, weight, |qp, gram| {
            let expected = EpigraphQpSolver::new().solve(qp).expect("no sides");
            let again = warm.solve_with_products(qp, gram).expect("no sides");
            let cold = EpigraphQpSolver::new().solve_with_products(qp, gram).expect("no sides");
            let size = expected.step.amax().max(1e-3 / weight);
            for answer in [&again, &cold] {
                assert!(kkt_residual(qp, answer) <= 1e-12, "{:e}", kkt_residual(qp, answer));
                // The residual bounds the step through the strong convexity, as a square root where cuts are nearly
                // dependent.
                assert!((&answer.step - &expected.step).amax() <= 1e-9 * size);
                assert!((answer.epigraph - expected.epigraph).abs() <= 1e-11 * (1.0 + expected.epigraph.abs()));
            }
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn warm_and_cold_subproblems_have_one_solution(seed: u64, n in 1usize..60, power in -3.0..3.0f64) {
        let sequence = Sequence::new(seed, n, 40);
        let mut warm = EpigraphQpSolver::new();
        for last in 1..40_usize {
            // The weight changes now and then, and the oldest cuts leave.
            let weight = 10f64.powf(power) * if last % 5 == 0 { 0.3 } else { 1.0 };
            sequence.compare((last.saturating_sub(25), last), weight, &mut warm);
        }
    }
}

/// Steep cuts of a flat valley: half the last bit of a multiplier moves the value of a cut by ‖g‖²/u · 3e-17 = 1e-7,
/// which is 1e-12 of its terms, and the step is found to 1e-14 of them nevertheless.
#[test]
fn multipliers_of_finite_accuracy_give_the_step_to_rounding() {
    let (n, weight) = (30, 0.3);
    let mut random = Random(5);
    let steep = Vector::from_fn(n, |_, _| 1e4 * random.signed());
    let slopes = (0..8).map(|j| {
        let other = Vector::from_fn(n, |_, _| random.signed());
        if j % 2 == 0 { &steep + other } else { other - &steep }
    });
    let (slopes, offsets) = (slopes.collect(), (0..8).map(|j| 0.1 * f64::from(j)).collect());
    let sequence = Sequence { slopes, offsets, diagonal: Vector::from_element(n, 1.0) };
    sequence.with_products((0, 8), weight, |qp, gram| {
        let solution = GramMemory::default().solve(qp, gram, 1e-14).expect("no sides");
        assert!(kkt_residual(qp, &solution) <= 1e-14, "{:e}", kkt_residual(qp, &solution));
    });
}

#[test]
fn an_answer_that_leaves_a_bound_is_none() {
    let (slopes, rows) = ([Vector::from_vec(vec![1.0])], [vec![1.0]]);
    let qp = EpigraphQp {
        metric: Metric::ScaledIdentity(1.0),
        slopes: &slopes,
        offsets: &[0.0],
        cut_ids: &[7],
        rows: &Matrix::zeros(0, 1),
        row_lower: &Vector::zeros(0),
        row_upper: &Vector::zeros(0),
        lower: &Vector::from_element(1, -0.5),
        upper: &Vector::from_element(1, 0.5),
    };
    let gram = Gram { rows: &rows, slots: &[0], weight: 1.0, lasting: true };
    assert!(GramMemory::default().solve(&qp, gram, 1e-12).is_none());
    let solution = EpigraphQpSolver::new().solve_with_products(&qp, gram).expect("feasible");
    assert_eq!(solution.step[0], -0.5);
}
