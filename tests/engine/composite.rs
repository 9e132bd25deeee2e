//! Convex functions of outputs with their Jacobians: optima, evaluations, invariance, certificates.

use crate::common::v;
use nonsmooth::composite::{EuclideanNorm, FnOuter, Maximum, OuterFunction, SumOfPowers};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{
    BundleTrust, BundleTrustConfig, CompositeFunction, Convexity, FnObjective, Matrix, NonsmoothObjective, Polyhedron,
    Report, Request, Termination, Vector,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::cell::RefCell;

type Outputs = fn(f64, f64) -> (Vec<f64>, Vec<f64>);

/// A problem of two variables with its optimum, and what a run takes.
struct Case {
    name: &'static str,
    outer: Box<dyn OuterFunction>,
    outputs: Outputs,
    set: Polyhedron,
    start: [f64; 2],
    solution: [f64; 2],
    optimum: f64,
    evaluations: usize,
    jacobians: usize,
}

fn cb3(x: f64, y: f64) -> (Vec<f64>, Vec<f64>) {
    let e = 2.0 * (y - x).exp();
    (
        vec![x.powi(4) + y * y, (2.0 - x).powi(2) + (2.0 - y).powi(2), e],
        vec![4.0 * x.powi(3), 2.0 * y, 2.0 * x - 4.0, 2.0 * y - 4.0, -e, e],
    )
}

/// c₀ + 10 Σ max(c_i, 0): an exact penalty.
fn penalty(c: &Vector) -> (f64, Vector) {
    let slope = |i: usize| if i == 0 { 1.0 } else { 10.0 * f64::from(u8::from(c[i] > 0.0)) };
    let slopes = Vector::from_fn(c.len(), |i, _| slope(i));
    (slopes.dot(c), slopes)
}

/// x ≤ 0.1 and x + y ≤ 2.
fn corner() -> Polyhedron {
    Polyhedron::boxed(v(&[-5.0, -5.0]), v(&[0.1, 5.0]))
        .unwrap()
        .with_rows(&Matrix::from_row_slice(1, 2, &[1.0, 1.0]), &v(&[f64::NEG_INFINITY]), &v(&[2.0]))
        .unwrap()
}

fn cases() -> Vec<Case> {
    [sums(), others()].into_iter().flatten().collect()
}

fn free() -> Polyhedron {
    Polyhedron::unbounded(2)
}

fn sums() -> Vec<Case> {
    vec![
        Case {
            name: "sum of absolute values",
            outer: Box::new(SumOfPowers { exponent: 1.0 }),
            outputs: |x, y| (vec![10.0 * (y - x * x), 1.0 - x], vec![-20.0 * x, 10.0, -1.0, 0.0]),
            set: free(),
            start: [-1.2, 1.0],
            solution: [1.0, 1.0],
            optimum: 0.0,
            evaluations: 23,
            jacobians: 23,
        },
        Case {
            name: "sum of squares",
            outer: Box::new(SumOfPowers { exponent: 2.0 }),
            outputs: |x, y| (vec![10.0 * (y - x * x), 1.0 - x, 2.0], vec![-20.0 * x, 10.0, -1.0, 0.0, 0.0, 0.0]),
            set: free(),
            start: [-1.2, 1.0],
            solution: [1.0, 1.0],
            optimum: 4.0,
            evaluations: 19,
            jacobians: 19,
        },
        Case {
            name: "sum of fourth powers",
            outer: Box::new(SumOfPowers { exponent: 4.0 }),
            // Mean 1 in x, −2 in y; by symmetry the optimum.
            outputs: |x, y| (vec![x, x - 2.0, y + 1.0, y + 3.0], vec![1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0]),
            set: free(),
            start: [5.0, 4.0],
            solution: [1.0, -2.0],
            optimum: 4.0,
            evaluations: 4,
            jacobians: 4,
        },
    ]
}

fn others() -> Vec<Case> {
    vec![
        Case {
            name: "minimax",
            outer: Box::new(Maximum),
            outputs: cb3,
            set: free(),
            start: [2.0, 2.0],
            solution: [1.0, 1.0],
            optimum: 2.0,
            evaluations: 7,
            jacobians: 7,
        },
        Case {
            name: "Euclidean norm",
            outer: Box::new(EuclideanNorm),
            outputs: |x, y| {
                (vec![x - 1.0, y + 2.0, 1.0 + (x - 1.0).powi(2)], vec![1.0, 0.0, 0.0, 1.0, 2.0 * (x - 1.0), 0.0])
            },
            set: free(),
            start: [3.0, 1.0],
            solution: [1.0, -2.0],
            optimum: 1.0,
            evaluations: 7,
            jacobians: 7,
        },
        Case {
            name: "exact penalty",
            outer: Box::new(FnOuter::new(penalty)),
            // (x − 2)² + (y − 1)² where x² ≤ y and x + y ≤ 2; multipliers 2/3.
            outputs: |x, y| {
                let value = (x - 2.0).powi(2) + (y - 1.0).powi(2);
                (vec![value, x * x - y, x + y - 2.0], vec![2.0 * (x - 2.0), 2.0 * (y - 1.0), 2.0 * x, -1.0, 1.0, 1.0])
            },
            set: free(),
            start: [-1.0, 3.0],
            solution: [1.0, 1.0],
            optimum: 1.0,
            evaluations: 6,
            jacobians: 6,
        },
        Case {
            name: "minimax in a corner of the admissible set",
            outer: Box::new(Maximum),
            outputs: |x, y| {
                (vec![(x - 2.0).powi(2) - y, (y - 3.0).powi(2)], vec![2.0 * (x - 2.0), -1.0, 0.0, 2.0 * (y - 3.0)])
            },
            set: corner(),
            start: [-3.0, -2.0],
            // The first piece falls with x and y.
            solution: [0.1, 1.9],
            optimum: 1.71,
            evaluations: 2,
            jacobians: 2,
        },
    ]
}

fn objective(case: &Case) -> impl NonsmoothObjective {
    CompositeFunction::new(2, &*case.outer, |p: &Vector| {
        let (outputs, rows) = (case.outputs)(p[0], p[1]);
        (Vector::from_vec(outputs.clone()), Matrix::from_row_slice(outputs.len(), 2, &rows))
    })
}

fn run(theta: &impl NonsmoothObjective, set: &Polyhedron, start: Vector, config: BundleTrustConfig) -> Report {
    BundleTrust::new(config).unwrap().constraints(set.clone()).minimize(theta, start).unwrap()
}

#[test]
fn known_optima_are_confirmed_after_a_pinned_number_of_evaluations() {
    let mut differences = vec![];
    for case in cases() {
        let report = run(&objective(&case), &case.set, v(&case.start), BundleTrustConfig::default());
        assert!(report.termination.is_confirmed(), "{}: {report}", case.name);
        // The tolerance of the run is 1e-7 of the value at the start or the optimum.
        assert!((report.value - case.optimum).abs() < 1e-6, "{}: {report}", case.name);
        assert!((&report.solution - v(&case.solution)).amax() < 2e-2, "{}: {}", case.name, report.solution);
        let found = (report.counts.evaluations, report.counts.jacobians);
        if found != (case.evaluations, case.jacobians) {
            differences.push(format!("{}: {found:?}", case.name));
        }
        assert_eq!(report.history.iter().filter(|record| record.jacobian).count(), report.counts.jacobians);
    }
    assert!(differences.is_empty(), "{differences:#?}");
}

#[test]
fn certificates_are_recomputed_from_outputs_jacobian_and_outer_function() {
    for case in cases() {
        let report = run(&objective(&case), &case.set, v(&case.start), BundleTrustConfig::default());
        let certificate = report.certificate.unwrap();
        // A decrease of 1e-7 of the values is small, and a step of a hundredth of the variables may bring it.
        let check = certificate.recheck(&case.set).unwrap();
        assert!(check.confirms(1e-3, 1e-4), "{}: {check:?}", case.name);
        if let Some(proof) = &certificate.composite {
            assert!(proof.recheck(&certificate, &*case.outer).unwrap().largest() < 1e-9, "{}", case.name);
        }
        let active = case.name.contains("corner");
        assert_eq!(certificate.bound_multipliers.amax() > 1e-3, active, "{}", case.name);
        assert_eq!(certificate.row_multipliers.iter().any(|m| m.abs() > 1e-3), active, "{}", case.name);
    }
}

/// The run in variables x/a, with the value times b and the outputs times c.
fn scaled(case: &Case, [a, b, c]: [f64; 3]) -> Report {
    let outer = FnOuter::new(move |outputs: &Vector| {
        let inner = outputs / c;
        (b * case.outer.value(&inner), case.outer.subgradient(&inner) * (b / c))
    });
    let theta = CompositeFunction::new(2, outer, |p: &Vector| {
        let (outputs, rows) = (case.outputs)(a * p[0], a * p[1]);
        (Vector::from_vec(outputs.clone()) * c, Matrix::from_row_slice(outputs.len(), 2, &rows) * (a * c))
    });
    let set = Polyhedron::boxed(case.set.lower() / a, case.set.upper() / a)
        .and_then(|set| set.with_rows(&(case.set.rows() * a), case.set.row_lower(), case.set.row_upper()))
        .unwrap();
    run(&theta, &set, v(&case.start) / a, BundleTrustConfig::default())
}

#[test]
fn powers_of_two_change_no_bit_of_the_course() {
    for case in cases() {
        let plain = scaled(&case, [1.0; 3]);
        for factors in [[1024.0, 1.0, 1.0], [1.0, 65536.0, 1.0], [1.0, 1.0, 0.0625], [0.125, 4.0, 256.0]] {
            let other = scaled(&case, factors);
            assert_eq!(other.counts, plain.counts, "{} {factors:?}", case.name);
            let values = |report: &Report, factor: f64| -> Vec<f64> {
                report.history.iter().map(|record| record.value.unwrap() / factor).collect()
            };
            if case.set.rows().nrows() == 0 {
                assert_eq!(values(&other, factors[1]), values(&plain, 1.0), "{} {factors:?}", case.name);
                assert_eq!(&other.solution * factors[0], plain.solution, "{} {factors:?}", case.name);
            } else {
                // Rows are divided by their lengths, which are no powers of two.
                for (a, b) in values(&other, factors[1]).iter().zip(values(&plain, 1.0)) {
                    assert!((a - b).abs() <= 1e-12 * b.abs(), "{} {factors:?}: {a} {b}", case.name);
                }
            }
        }
    }
}

#[test]
fn a_shift_of_the_coordinates_changes_no_count() {
    let config = || BundleTrustConfig { first_step: Some(1.0), ..BundleTrustConfig::default() };
    for case in cases() {
        let plain = run(&objective(&case), &case.set, v(&case.start), config());
        // A dyadic shift of the size of the variables, so that relative lengths keep their order.
        let shift = v(&[0.5, -0.25]);
        let theta = CompositeFunction::new(2, &*case.outer, |p: &Vector| {
            let (outputs, rows) = (case.outputs)(p[0] - shift[0], p[1] - shift[1]);
            (Vector::from_vec(outputs.clone()), Matrix::from_row_slice(outputs.len(), 2, &rows))
        });
        let moved = case.set.rows() * &shift;
        let set = Polyhedron::boxed(case.set.lower() + &shift, case.set.upper() + &shift)
            .and_then(|set| {
                set.with_rows(case.set.rows(), &(case.set.row_lower() + &moved), &(case.set.row_upper() + &moved))
            })
            .unwrap();
        let other = run(&theta, &set, v(&case.start) + &shift, config());
        assert_eq!(other.counts.evaluations, plain.counts.evaluations, "{}", case.name);
        assert!((other.value - plain.value).abs() < 1e-7, "{}", case.name);
    }
}

/// c_i(x) = ½(x − z_i)ᵀ(A_iᵀA_i + I/10)(x − z_i) + b_i with entries from a seed.
fn quadratics(n: usize, pieces: usize, seed: u64) -> Vec<(Matrix, Vector, f64)> {
    let piece = |i: u64| {
        let entries = seeded_direction(n * n, seed + 3 * i);
        let factor = Matrix::from_fn(n, n, |j, k| entries[n * j + k]);
        let curvature = factor.tr_mul(&factor) + Matrix::identity(n, n) * 0.1;
        (curvature, seeded_direction(n, seed + 3 * i + 1) * 2.0, seeded_direction(1, seed + 3 * i + 2)[0])
    };
    (0..pieces as u64).map(piece).collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(7),
        ..ProptestConfig::default()
    })]

    #[test]
    fn minimax_of_random_quadratics_agrees_with_cuts(n in 1_usize..7, pieces in 1_usize..8, seed in 0_u64..1 << 40) {
        let parts = quadratics(n, pieces, seed);
        let linearize = |x: &Vector| {
            let slopes: Vec<Vector> = parts.iter().map(|(curvature, center, _)| curvature * (x - center)).collect();
            let value = |i: usize| 0.5 * slopes[i].dot(&(x - &parts[i].1)) + parts[i].2;
            (Vector::from_fn(pieces, |i, _| value(i)), Matrix::from_fn(pieces, n, |i, j| slopes[i][j]))
        };
        let theta = CompositeFunction::new(n, Maximum, linearize);
        let cuts = FnObjective::new(n, |x: &Vector| {
            let (outputs, jacobian) = linearize(x);
            (outputs.max(), jacobian.row(outputs.imax()).transpose())
        });
        let config = || BundleTrustConfig { convexity: Convexity::Convex, ..BundleTrustConfig::default() };
        let (start, set) = (seeded_direction(n, seed + 100) * 3.0, Polyhedron::unbounded(n));
        let report = run(&theta, &set, start.clone(), config());
        let plain = run(&cuts, &set, start, config());
        // At a smooth optimum the slopes of the last cuts vanish so fast that the scale of Θ which is taken from them
        // may fall below rounding: the termination is then the noise limit, with a bound of what is left.
        let bounded = matches!(report.termination, Termination::NoiseLimit { estimate } if estimate <= 1e-6);
        prop_assert!(report.termination.is_confirmed() || bounded, "{report}");
        prop_assert!((report.value - plain.value).abs() <= 1e-6 * plain.value.abs().max(1.0), "{report}{plain}");
        let certificate = report.certificate.unwrap();
        let check = certificate.recheck(&set).unwrap();
        prop_assert!((check.aggregate_norm - certificate.aggregate_norm).abs() <= 1e-8, "{check:?}");
        prop_assert!((check.aggregate_error - certificate.aggregate_error).abs() <= 1e-8, "{check:?}");
        let here = theta.evaluate(&Request::tight(&report.solution)).unwrap().into_evaluation().value;
        prop_assert_eq!(here, report.value);
    }
}

/// A stiff output far from its optimum at the start sets the weights; y then falls slowly along a line. Steps along
/// it are short beside its length, each promises less than a small decrease, and all of them together little more.
#[test]
fn a_decrease_that_is_small_at_every_step_does_not_hold_up_the_end() {
    for (slope, x) in [(1.1e-5, 0.43), (1.26e-5, 0.43), (1.26e-5, 1.0), (1.58e-5, 1.0)] {
        let linearize = |p: &Vector| {
            let outputs = v(&[100.0 * p[0], 1.0 - slope * p[1], 0.5 + 0.5 * p[2], 1.5 - 0.5 * p[2]]);
            let rows = [100.0, 0.0, 0.0, 0.0, -slope, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, -0.5];
            (outputs, Matrix::from_row_slice(4, 3, &rows))
        };
        let theta = CompositeFunction::new(3, SumOfPowers { exponent: 4.0 }, linearize);
        let config = BundleTrustConfig { first_step: Some(1.0), max_evaluations: 200, ..BundleTrustConfig::default() };
        let set = Polyhedron::boxed(v(&[-10.0, -10.0, -20.0]), v(&[10.0, 10.0, 20.0])).unwrap();
        let report = run(&theta, &set, v(&[x, 0.5, 1.2]), config);
        assert!(report.termination.is_confirmed(), "slope {slope}: {report}");
        assert!(report.counts.evaluations <= 15, "slope {slope}: {report}");
        assert!(report.value <= 3.0 + 1e-4, "slope {slope}: {report}");
    }
}

/// Beyond y = 0.1 another output grows steeply, which the Jacobian before it does not tell: steps along the slope of y
/// are rejected there, and those that are short enough promise less than a small decrease.
#[test]
fn a_rejected_point_is_not_proposed_again() {
    for (slope, wall, [x, y]) in [(1e-4, 1e6, [0.043, 0.0]), (3e-5, 1e4, [0.43, 0.09]), (3e-6, 1e6, [0.43, 0.099])] {
        let points = RefCell::new(Vec::<Vector>::new());
        let linearize = |p: &Vector| {
            points.borrow_mut().push(p.clone());
            let (y, steep) = (p[1], wall * f64::from(u8::from(p[1] > 0.1)));
            let outputs = v(&[100.0 * p[0], 1.0 - slope * y, 0.5 + 0.5 * p[2], 1.5 - 0.5 * p[2], steep * (y - 0.1)]);
            let rows = [100.0, 0.0, 0.0, 0.0, -slope, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, -0.5, 0.0, steep, 0.0];
            (outputs, Matrix::from_row_slice(5, 3, &rows))
        };
        let theta = CompositeFunction::new(3, SumOfPowers { exponent: 4.0 }, linearize);
        let config = BundleTrustConfig { first_step: Some(1.0), max_evaluations: 60, ..BundleTrustConfig::default() };
        let set = Polyhedron::boxed(v(&[-1.0, -10.0, -2.0]), v(&[1.0, 10.0, 2.0])).unwrap();
        let report = run(&theta, &set, v(&[x, y, 1.2]), config);
        let points = points.into_inner();
        let again = (1..points.len()).filter(|&i| points[..i].contains(&points[i])).count();
        assert_eq!(again, 0, "slope {slope}: {report}");
    }
}
