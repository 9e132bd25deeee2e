//! Properties of the QP solver on random problems; see `qps.rs` for their kinds.

use crate::qps::{self, BundleSequence, OwnedMetric, OwnedQp, Shape, random_qp};
use crate::reference::Reference;
use nonsmooth::qp::{EpigraphQpSolver, QpError, QpMethod, QpSolution, kkt_residual, project};
use nonsmooth::{Matrix, Polyhedron, Vector};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use std::cell::Cell;
use testset::kit::Random;

/// Bound asked of every answer; found on these problems: at most 1e-14.
const KKT: f64 = 1e-12;

fn solve(qp: &OwnedQp) -> QpSolution {
    let mut solver = EpigraphQpSolver::new();
    let solution = solver.solve(&qp.view()).expect("a feasible problem");
    assert_eq!(solver.counts().fallbacks, 0);
    assert_eq!(solution.method, QpMethod::ActiveSet);
    solution
}

fn shapes() -> impl Strategy<Value = Shape> {
    (1usize..40, 1usize..60, 0usize..60).prop_map(|(dimension, cuts, rows)| Shape { dimension, cuts, rows })
}

/// min max(d, −s(d + ½)) + ½ d² at the wall d = −½: v = −½ to rounding, although the steep cut knows its own value to
/// 0.1 only.
#[test]
fn beside_a_wall_the_other_cut_says_the_value() {
    let steepness = 1e15;
    let slopes = vec![Vector::from_vec(vec![1.0]), Vector::from_vec(vec![-steepness])];
    let solution = solve(&OwnedQp::free(1.0, slopes, vec![0.0, 0.5 * steepness]));
    let wall = -0.5 * steepness / (1.0 + steepness);
    assert!((solution.step[0] - wall).abs() <= 1e-15 && (solution.epigraph - wall).abs() <= 1e-15, "{solution:?}");
    assert!((solution.cut_multipliers[1] - (1.0 + wall) / (1.0 + steepness)).abs() <= 1e-12 / steepness);
    assert!(solution.kkt_residual <= KKT, "{:e}", solution.kkt_residual);
}

fn scale_metric(metric: &mut OwnedMetric, factor: f64) {
    match metric {
        OwnedMetric::ScaledIdentity(weight) => *weight *= factor,
        OwnedMetric::Diagonal(diagonal) => *diagonal *= factor,
        OwnedMetric::Dense(matrix) => *matrix *= factor,
    }
}

/// √(dᵀ H d).
fn metric_norm(qp: &OwnedQp, step: &Vector) -> f64 {
    step.dot(&qp.view().metric.apply(step)).max(0.0).sqrt()
}

/// The problem with cuts taken near poles, up to 10^power times as steep as the others; none excludes 0, some are
/// active.
fn with_poles(mut qp: OwnedQp, seed: u64, poles: usize, power: f64) -> OwnedQp {
    let (mut random, dimension) = (Random(seed ^ 1), qp.slopes[0].len());
    let first = qp.slopes.len() as u64;
    for id in first..first + poles as u64 {
        let factor = 10f64.powf(power * (0.5 + 0.5 * random.signed().abs()));
        let slope = qps::vector(&mut random, dimension) * factor;
        qp.offsets.push(slope.norm() * random.signed().abs());
        qp.slopes.push(slope);
        qp.cut_ids.push(id);
    }
    qp
}

/// Draws too rare for the properties below. Each needs one rule of the active-set method, and ended as a contradiction
/// without it.
#[test]
fn rare_draws_are_solved() {
    let shape = |dimension, cuts, rows| Shape { dimension, cuts, rows };
    // The first two: a flat cut falls by what a steep one rises, however little that is. The others: a steep active cut
    // makes independent rows look dependent unless its column is scaled up.
    for (seed, shape, poles, power) in [
        (17_733, shape(18, 31, 53), 19, 8.911_399_740_239_702),
        (51_001, shape(18, 39, 54), 7, 8.529_784_206_436_382),
        (147_295, shape(2, 31, 55), 10, 9.984_715_879_053_077),
        (20_043, shape(3, 42, 35), 7, 9.903_644_428_749_878),
    ] {
        let solution = solve(&with_poles(random_qp(seed, shape), seed, poles, power));
        assert!(solution.kkt_residual <= KKT, "{seed}: {:e}", solution.kkt_residual);
    }
    // The only cut held does not leave, though v is 1e10 times the square of its column.
    for (seed, shape, power) in [(13_259, shape(1, 15, 17), 10.2), (82_224, shape(16, 49, 47), 11.955_703_370_180_007)]
    {
        let mut qp = random_qp(seed, shape);
        scale_metric(&mut qp.metric, 10f64.powf(power));
        assert!(solve(&qp).kkt_residual <= KKT, "{seed}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_answer_has_a_small_kkt_residual(seed: u64, shape in shapes()) {
        let qp = random_qp(seed, shape);
        let solution = solve(&qp);
        prop_assert!(solution.kkt_residual <= KKT, "{:e}", solution.kkt_residual);
        prop_assert_eq!(solution.kkt_residual, kkt_residual(&qp.view(), &solution));
        let values = qp.slopes.iter().zip(&qp.offsets).map(|(g, e)| g.dot(&solution.step) - e);
        let highest = values.fold(f64::NEG_INFINITY, f64::max);
        prop_assert!((highest - solution.epigraph).abs() <= 1e-13 * (1.0 + highest.abs()));
    }

    #[test]
    fn weights_of_any_size_are_solved(seed: u64, shape in shapes(), power in -12.0..12.0f64) {
        let mut qp = random_qp(seed, shape);
        scale_metric(&mut qp.metric, 10f64.powf(power));
        prop_assert!(solve(&qp).kkt_residual <= KKT);
    }

    /// In one scale of the columns, and with v from the steepest cut, one in a hundred of the programs with cuts of 1e8
    /// and more fails, and one in ten needs another method.
    #[test]
    fn cuts_of_poles_hide_no_others(seed: u64, shape in shapes(), poles in 1usize..20, power in 4.0..10.0f64) {
        let qp = with_poles(random_qp(seed, shape), seed, poles, power);
        let solution = solve(&qp);
        prop_assert!(solution.kkt_residual <= KKT, "{:e}", solution.kkt_residual);
    }

    /// Cuts of any steepness exclude no point of the set.
    #[test]
    fn cuts_of_any_steepness_contradict_no_sides(
        seed: u64,
        shape in shapes(),
        poles in 1usize..20,
        power in 10.0..15.0f64,
    ) {
        let qp = with_poles(random_qp(seed, shape), seed, poles, power);
        let result = EpigraphQpSolver::new().solve(&qp.view());
        prop_assert!(!matches!(result, Err(QpError::Infeasible { .. })), "{:?}", result);
    }

    #[test]
    fn units_of_values_and_variables_do_not_matter(
        seed: u64,
        shape in shapes(),
        value in -6i32..=6,
        length in -6i32..=6,
    ) {
        let qp = random_qp(seed, shape);
        let (value, length) = (10f64.powi(value), 10f64.powi(length));
        let mut scaled = qp.clone();
        scale_metric(&mut scaled.metric, value / (length * length));
        scaled.slopes.iter_mut().for_each(|slope| *slope *= value / length);
        scaled.offsets.iter_mut().for_each(|offset| *offset *= value);
        for side in [&mut scaled.row_lower, &mut scaled.row_upper, &mut scaled.lower, &mut scaled.upper] {
            *side *= length;
        }
        let (one, two) = (solve(&qp), solve(&scaled));
        prop_assert!(two.kkt_residual <= KKT, "{:e}", two.kkt_residual);
        // Strong convexity turns residuals of 1e-14 of the gradients into steps that agree to this part of the free
        // step.
        let free = qp.slopes.iter().map(|g| dual_norm(&qp, g)).fold(0.0, f64::max);
        let gap = metric_norm(&qp, &(&two.step / length - &one.step));
        prop_assert!(gap <= 1e-9 * (free + metric_norm(&qp, &one.step)), "gap {:e} of {:e}", gap, free);
    }

    #[test]
    fn warm_sequences_equal_cold_solves(seed in 0u64..1000, dimension in 1usize..20, rows in 0usize..20) {
        let record = BundleSequence { dimension, pieces: 12, cuts: 15, rows, solves: 40 }.record(seed);
        let mut warm = EpigraphQpSolver::new();
        for qp in &record {
            let (one, two) = (warm.solve(&qp.view()).expect("feasible"), solve(qp));
            prop_assert!(one.kkt_residual <= KKT, "{:e}", one.kkt_residual);
            let gap = (&one.step - &two.step).norm();
            let free = qp.slopes.iter().map(|g| dual_norm(qp, g)).fold(0.0, f64::max);
            prop_assert!(metric_norm(qp, &(&one.step - &two.step)) <= 1e-9 * free, "gap {:e}", gap);
        }
        prop_assert_eq!(warm.counts().fallbacks, 0);
    }

    #[test]
    fn a_memory_of_another_problem_does_no_harm(seed: u64, one in shapes(), two in shapes()) {
        let mut solver = EpigraphQpSolver::new();
        solver.solve(&random_qp(seed, one).view()).expect("feasible");
        let qp = random_qp(seed ^ 1, two);
        let (warm, cold) = (solver.solve(&qp.view()).expect("feasible"), solve(&qp));
        prop_assert!(warm.kkt_residual <= KKT);
        let free = qp.slopes.iter().map(|g| dual_norm(&qp, g)).fold(0.0, f64::max);
        prop_assert!(metric_norm(&qp, &(&warm.step - &cold.step)) <= 1e-9 * (free + metric_norm(&qp, &cold.step)));
    }

    #[test]
    fn moving_the_center_onto_active_sides_is_no_contradiction(seed: u64, shape in shapes(), power in -8.0..8.0f64) {
        let mut qp = random_qp(seed, shape);
        scale_metric(&mut qp.metric, 10f64.powf(power));
        let mut solver = EpigraphQpSolver::new();
        // The sides of the second problem are differences: what is left of the active ones is rounding.
        for _ in 0..4 {
            let solution = solver.solve(&qp.view()).expect("the center is admissible up to rounding");
            prop_assert!(solution.kkt_residual <= 1e-10, "{:e}", solution.kkt_residual);
            recenter(&mut qp, &solution);
        }
    }

    #[test]
    fn clusters_of_cuts_are_solved(seed: u64, digits in 3.0..16.0f64, steep: bool) {
        let (spread, mut random) = (10f64.powf(-digits), Random(seed));
        let centers: Vec<Vector> = (0..5).map(|_| qps::vector(&mut random, 3)).collect();
        let size = |j: usize| if steep && j.is_multiple_of(3) { 1e5 } else { 1.0 };
        let slopes = (0..80).map(|j| (&centers[j % 5] + qps::vector(&mut random, 3) * spread) * size(j)).collect();
        let offsets = (0..80).map(|_| 0.1 + spread * random.signed()).collect();
        prop_assert!(solve(&OwnedQp::free(1.0, slopes, offsets)).kkt_residual <= KKT);
    }

    #[test]
    fn a_projection_is_admissible_and_satisfies_the_obtuse_angle(seed: u64, shape in shapes()) {
        let qp = random_qp(seed, shape);
        let set = polyhedron(&qp);
        let mut random = Random(seed);
        let x = qps::vector(&mut random, shape.dimension) * 3.0;
        let nearest = project(&set, &x).expect("a nonempty set");
        // Absolute: a row whose terms all vanish at the nearest point has no relative scale.
        let excess = largest_excess(&qp, &nearest);
        prop_assert!(excess <= 1e-12 * (1.0 + x.amax()), "{:e}", excess);
        let inside = project(&set, &(qps::vector(&mut random, shape.dimension))).expect("a nonempty set");
        let angle = (&x - &nearest).dot(&(&inside - &nearest));
        prop_assert!(angle <= 1e-12 * (&x - &nearest).norm() * (1.0 + (&inside - &nearest).norm()), "{:e}", angle);
    }
}

/// Largest share of the problems that the reference may leave without an answer; found: 3 of 256.
const UNANSWERED: f64 = 0.05;

#[test]
fn the_interior_point_method_finds_the_same_value() {
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    let (cases, unanswered) = (config.cases, Cell::new(0_u32));
    let result = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha)).run(
        &(any::<u64>(), shapes()),
        |(seed, shape)| {
            let qp = random_qp(seed, shape);
            let solution = solve(&qp);
            let Some(reference) = Reference::new(&qp.view()).solve(1e-11) else {
                unanswered.set(unanswered.get() + 1);
                return Ok(());
            };
            let other = Vector::from_column_slice(&reference[..shape.dimension]);
            let (own, theirs) = (objective(&qp, &solution.step), objective(&qp, &other));
            // The reference may leave the rows by 1e-11 of its own scale, at the price of their multipliers.
            let size = 1.0 + own.abs() + theirs.abs() + metric_norm(&qp, &other).powi(2);
            prop_assert!((own - theirs).abs() <= 1e-7 * size, "{:e} and {:e}", own, theirs);
            Ok(())
        },
    );
    result.unwrap();
    println!("the reference left {} of {cases} problems without an answer", unanswered.get());
    assert!(f64::from(unanswered.get()) <= UNANSWERED * f64::from(cases), "{} of {cases}", unanswered.get());
}

/// max_j (g_jᵀ d − e_j) + ½ dᵀ H d.
fn objective(qp: &OwnedQp, step: &Vector) -> f64 {
    let values = qp.slopes.iter().zip(&qp.offsets).map(|(g, e)| g.dot(step) - e);
    values.fold(f64::NEG_INFINITY, f64::max) + 0.5 * metric_norm(qp, step).powi(2)
}

/// √(gᵀ H⁻¹ g): length of the free step of one cut in the metric.
fn dual_norm(qp: &OwnedQp, slope: &Vector) -> f64 {
    let n = slope.len();
    let inverse = match &qp.metric {
        OwnedMetric::ScaledIdentity(weight) => slope / *weight,
        OwnedMetric::Diagonal(diagonal) => slope.component_div(diagonal),
        OwnedMetric::Dense(matrix) => matrix.clone().cholesky().map_or(Vector::zeros(n), |factor| factor.solve(slope)),
    };
    slope.dot(&inverse).sqrt()
}

/// Moves the origin of cuts, rows and box to the end of the step.
fn recenter(qp: &mut OwnedQp, solution: &QpSolution) {
    for (slope, offset) in qp.slopes.iter().zip(&mut qp.offsets) {
        *offset += solution.epigraph - slope.dot(&solution.step);
    }
    let shift = &qp.rows * &solution.step;
    qp.row_lower -= &shift;
    qp.row_upper -= &shift;
    qp.lower -= &solution.step;
    qp.upper -= &solution.step;
}

fn polyhedron(qp: &OwnedQp) -> Polyhedron {
    Polyhedron::boxed(qp.lower.clone(), qp.upper.clone())
        .and_then(|set| set.with_rows(&qp.rows, &qp.row_lower, &qp.row_upper))
        .expect("valid data")
}

/// Largest amount by which any side is exceeded.
fn largest_excess(qp: &OwnedQp, x: &Vector) -> f64 {
    let values = &qp.rows * x;
    let rows = (0..values.len()).map(|i| (values[i] - qp.row_upper[i]).max(qp.row_lower[i] - values[i]));
    let bounds = (0..x.len()).map(|k| (x[k] - qp.upper[k]).max(qp.lower[k] - x[k]));
    rows.chain(bounds).fold(0.0, f64::max)
}

fn vector(entries: &[f64]) -> Vector {
    Vector::from_column_slice(entries)
}

#[test]
fn one_cut_gives_the_gradient_step() {
    let solution = solve(&OwnedQp::free(2.0, vec![vector(&[4.0, -6.0])], vec![0.5]));
    assert_eq!(solution.step, vector(&[-2.0, 3.0]));
    assert_eq!(solution.epigraph, -26.5);
    assert_eq!(solution.cut_multipliers, vec![1.0]);
}

#[test]
fn absolute_value_has_its_kink_found_exactly() {
    let solution = solve(&OwnedQp::free(1e-3, vec![vector(&[1.0]), vector(&[-3.0])], vec![0.0, 4.0]));
    // d − 0 = −3 d − 4 at d = −1, v = −1; 0 = u d + π − 3 (1 − π).
    assert!((solution.step[0] + 1.0).abs() <= 1e-15);
    assert!((solution.cut_multipliers[0] - 3.001 / 4.0).abs() <= 1e-15);
}

#[test]
fn a_bound_and_a_row_take_their_signed_multipliers() {
    let mut qp = OwnedQp::free(1.0, vec![vector(&[1.0, -1.0])], vec![0.0]);
    qp.lower[0] = -0.25;
    qp.rows = Matrix::from_row_slice(1, 2, &[0.0, 2.0]);
    (qp.row_lower, qp.row_upper) = (vector(&[-1.0]), vector(&[1.0]));
    let solution = solve(&qp);
    assert_eq!(solution.step, vector(&[-0.25, 0.5]));
    assert_eq!(solution.bound_multipliers, vec![-0.75, 0.0]);
    assert_eq!(solution.row_multipliers, vec![0.25]);
}

#[test]
fn identical_cuts_share_one_answer() {
    let slope = vector(&[1.0, 2.0, 3.0]);
    let solution = solve(&OwnedQp::free(1.0, vec![slope.clone(); 7], vec![0.1; 7]));
    assert_eq!(solution.step, -slope);
    assert_eq!(solution.cut_multipliers.iter().sum::<f64>(), 1.0);
}

#[test]
fn fixed_variables_and_repeated_equalities_are_no_obstacle() {
    let mut qp = OwnedQp::free(1.0, vec![vector(&[1.0, 1.0, 1.0])], vec![0.0]);
    (qp.lower[0], qp.upper[0]) = (0.5, 0.5);
    qp.rows = Matrix::from_row_slice(3, 3, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0]);
    (qp.row_lower, qp.row_upper) = (vector(&[1.0, 2.0, 1.0]), vector(&[1.0, 2.0, 1.0]));
    let solution = solve(&qp);
    assert!((&solution.step - vector(&[0.5, 0.25, 0.25])).norm() <= 1e-15);
    assert!(solution.kkt_residual <= 1e-15);
}

#[test]
fn all_variables_fixed_is_solved() {
    let mut qp = OwnedQp::free(1.0, vec![vector(&[1.0, 1.0]), vector(&[-1.0, 0.0])], vec![0.0, 0.0]);
    (qp.lower, qp.upper) = (vector(&[1.0, -2.0]), vector(&[1.0, -2.0]));
    let solution = solve(&qp);
    assert_eq!((solution.step, solution.epigraph), (vector(&[1.0, -2.0]), -1.0));
}

#[test]
fn an_empty_set_is_refused_with_its_violation() {
    for metric in [OwnedMetric::ScaledIdentity(1.0), OwnedMetric::Dense(Matrix::identity(2, 2))] {
        let mut qp = OwnedQp::free(1.0, vec![vector(&[1.0, -1.0])], vec![0.0]);
        qp.metric = metric;
        (qp.lower, qp.upper) = (vector(&[0.0, 0.0]), vector(&[1.0, 1.0]));
        qp.rows = Matrix::from_row_slice(1, 2, &[1.0, 1.0]);
        (qp.row_lower, qp.row_upper) = (vector(&[3.0]), vector(&[f64::INFINITY]));
        match EpigraphQpSolver::new().solve(&qp.view()) {
            Err(QpError::Infeasible { violation }) => assert!(violation > 0.1 && violation <= 1.0, "{violation}"),
            other => panic!("expected an infeasible set, got {other:?}"),
        }
        assert!(matches!(project(&polyhedron(&qp), &vector(&[0.0, 0.0])), Err(QpError::Infeasible { .. })));
    }
}

#[test]
fn contradictory_equalities_are_refused() {
    let mut qp = OwnedQp::free(1.0, vec![vector(&[1.0, -1.0])], vec![0.0]);
    qp.rows = Matrix::from_row_slice(2, 2, &[1.0, 1.0, 2.0, 2.0]);
    (qp.row_lower, qp.row_upper) = (vector(&[1.0, 3.0]), vector(&[1.0, 3.0]));
    assert!(matches!(EpigraphQpSolver::new().solve(&qp.view()), Err(QpError::Infeasible { .. })));
}

#[test]
fn input_is_checked_at_the_border() {
    let good = OwnedQp::free(1.0, vec![vector(&[1.0, -1.0])], vec![0.0]);
    let refused = |change: &dyn Fn(&mut OwnedQp)| {
        let mut qp = good.clone();
        change(&mut qp);
        matches!(EpigraphQpSolver::new().solve(&qp.view()), Err(QpError::Input(_)))
    };
    assert!(refused(&|qp| qp.slopes.clear()));
    assert!(refused(&|qp| qp.offsets[0] = f64::NAN));
    assert!(refused(&|qp| qp.slopes[0][1] = f64::INFINITY));
    assert!(refused(&|qp| qp.metric = OwnedMetric::ScaledIdentity(0.0)));
    assert!(refused(&|qp| qp.metric = OwnedMetric::Diagonal(vector(&[1.0]))));
    assert!(refused(&|qp| qp.metric = OwnedMetric::Dense(Matrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]))));
    assert!(refused(&|qp| qp.metric = OwnedMetric::Dense(Matrix::from_row_slice(2, 2, &[1.0, 0.5, 0.0, 1.0]))));
    assert!(refused(&|qp| qp.lower[0] = f64::NAN));
    assert!(refused(&|qp| (qp.lower[0], qp.upper[0]) = (1.0, 0.0)));
    assert!(refused(&|qp| qp.cut_ids.clear()));
}

#[test]
fn the_certificate_sees_a_spoiled_answer() {
    let qp = random_qp(11, Shape { dimension: 12, cuts: 20, rows: 10 });
    let good = solve(&qp);
    let spoiled = |change: &dyn Fn(&mut QpSolution)| {
        let mut solution = good.clone();
        change(&mut solution);
        kkt_residual(&qp.view(), &solution)
    };
    assert!(spoiled(&|solution| solution.step[3] += 1e-3) > 1e-6);
    assert!(spoiled(&|solution| solution.epigraph += 1e-3) > 1e-6);
    assert!(spoiled(&|solution| solution.cut_multipliers[0] -= 1e-3) > 1e-6);
    assert!(spoiled(&|solution| solution.step[0] = f64::NAN) == f64::INFINITY);
}

#[test]
fn a_thousand_variables_on_their_bounds_are_solved_from_cold() {
    for metric in
        [OwnedMetric::ScaledIdentity(1e-3), OwnedMetric::Diagonal(Vector::from_fn(1000, |i, _| 1.0 + i as f64))]
    {
        let mut random = Random(5);
        let slopes: Vec<Vector> = (0..100).map(|_| qps::vector(&mut random, 1000)).collect();
        let offsets = (0..100).map(|_| random.unit()).collect();
        let mut qp = OwnedQp::free(1.0, slopes, offsets);
        qp.metric = metric;
        (qp.lower, qp.upper) = (Vector::from_element(1000, -0.1), Vector::from_element(1000, 0.1));
        assert!(solve(&qp).kkt_residual <= KKT);
    }
}

#[test]
fn a_bundle_sequence_costs_few_pivots() {
    let record = BundleSequence { dimension: 36, pieces: 60, cuts: 80, rows: 150, solves: 100 }.record(7);
    let mut solver = EpigraphQpSolver::new();
    for qp in &record {
        assert!(solver.solve(&qp.view()).expect("feasible").kkt_residual <= KKT);
    }
    let counts = solver.counts();
    assert_eq!((counts.solves, counts.fallbacks), (100, 0));
    // Found: about 4 per solve on the long run; the first solves of a run make most of them.
    assert!(counts.pivots <= 1500, "{}", counts.pivots);
}
