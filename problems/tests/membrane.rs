//! The membrane: closed form with its rate, an independent solver, subgradients, kinks, and an optimum.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use nonsmooth::verify::{Direction, STEPS, seeded_direction, taylor_test};
use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, Coderivative, NonsmoothObjective, OracleError, Request, StateSolver,
    Vector,
};
use problems::membrane::{MembraneControl, MembraneData, MembraneGrid, MembraneState, admissible_loads, example};

fn value(theta: &impl NonsmoothObjective, x: &Vector) -> f64 {
    theta.evaluate(&Request::tight(x)).map(|answer| answer.into_evaluation().value).unwrap()
}

/// u = r²/2 − ln r − ½ outside the unit disc, 0 on it, for the load −2 over ψ = 0 on (−1.5, 1.5)².
fn radial([x, y]: [f64; 2]) -> f64 {
    let r = x.hypot(y);
    if r > 1.0 { 0.5 * r * r - r.ln() - 0.5 } else { 0.0 }
}

fn radial_problem(cells: usize) -> (MembraneControl, MembraneState) {
    let data =
        MembraneData { load: Box::new(|_| -2.0), obstacle: Box::new(|_| 0.0), boundary: Box::new(radial), patches: 1 };
    let problem = MembraneControl::new(MembraneGrid::new(cells, [-1.5, -1.5], 3.0).unwrap(), &data).unwrap();
    let state = problem.solve(&Vector::zeros(1), None, Accuracy::TIGHTEST).unwrap();
    (problem, state)
}

#[test]
fn the_radial_solution_is_met_with_second_order() {
    let error = |cells| {
        let (problem, state) = radial_problem(cells);
        let errors = state.displacement.iter().enumerate().map(|(i, u)| (u - radial(problem.grid().node(i))).abs());
        errors.fold(0.0, f64::max)
    };
    let errors = [16, 32, 64, 128].map(error);
    let rate = (errors[0] / errors[3]).log2() / 3.0;
    // The free boundary moves by whole cells, which makes single ratios uneven.
    assert!((1.6..2.4).contains(&rate) && errors[3] < 2e-4, "{errors:?}");
    // On the disc the obstacle carries the whole load: λ = 2 where the difference star lies inside.
    let (problem, state) = radial_problem(64);
    for (i, reaction) in state.reaction.iter().enumerate() {
        let [x, y] = problem.grid().node(i);
        if x.hypot(y) < 0.9 {
            assert!((reaction - 2.0).abs() < 1e-9, "{reaction} at {x}, {y}");
        }
    }
}

/// Gauss–Seidel with projection on u ≥ ψ: knows no active sets and no factors.
fn projected_sweeps(grid: &MembraneGrid, load: &[f64], obstacle: &[f64]) -> Vec<f64> {
    let mut u = obstacle.to_vec();
    for _ in 0..4000 {
        for i in 0..u.len() {
            let around: f64 = grid.neighbours(i).map(|k| u[k]).sum();
            u[i] = (0.25 * (load[i] + around)).max(obstacle[i]);
        }
    }
    u
}

#[test]
fn active_sets_and_projected_sweeps_agree() {
    let theta = example(16).unwrap();
    for seed in 1..=5 {
        let loads = seeded_direction(16, seed) * 20.0;
        let state = theta.solver().solve(&loads, None, Accuracy::TIGHTEST).unwrap();
        let load = theta.solver().load(&loads).unwrap();
        let sweeps = projected_sweeps(theta.solver().grid(), &load, theta.solver().obstacle());
        for (u, other) in state.displacement.iter().zip(&sweeps) {
            assert!((u - other).abs() < 1e-12, "{u} {other}");
        }
        // A warm start leads to the same bits.
        let start = theta.solver().solve(&(&loads * 0.9), None, Accuracy::TIGHTEST).unwrap();
        let again = theta.solver().solve(&loads, Some(&start.active), Accuracy::TIGHTEST).unwrap();
        assert_eq!((&again.displacement, &again.active), (&state.displacement, &state.active));
        assert!(again.steps <= state.steps);
    }
}

#[test]
fn subgradients_pass_the_taylor_test() {
    let theta = example(24).unwrap();
    for seed in 1..=4 {
        let point = seeded_direction(16, 100 + seed) * 10.0;
        // The longest step crosses kinks.
        let table = taylor_test(&theta, &point, &Direction::Seeded(seed), &STEPS[1..]).unwrap();
        assert!((table.fitted_slope.unwrap() - 2.0).abs() < 0.1 && table.best_derivative_error < 1e-7, "{table}");
    }
}

#[test]
fn coderivative_is_the_adjoint_of_difference_quotients() {
    let theta = example(16).unwrap();
    let solver = theta.solver();
    let point = seeded_direction(16, 7) * 10.0;
    let step = seeded_direction(16, 8);
    let packed = |x: &Vector| {
        let state = solver.solve(x, None, Accuracy::TIGHTEST).unwrap();
        Vector::from_iterator(2 * state.reaction.len(), state.displacement.iter().chain(&state.reaction).copied())
    };
    let state = solver.solve(&point, None, Accuracy::TIGHTEST).unwrap();
    let dual = seeded_direction(2 * state.reaction.len(), 9);
    let t = 1e-4;
    // The state is piecewise linear: the quotient is exact up to rounding as long as the active set stays.
    let quotient = (packed(&(&point + &step * t)) - packed(&(&point - &step * t))).dot(&dual) / (2.0 * t);
    let product = solver.coderivative(&point, &state, &dual).unwrap().element.dot(&step);
    assert!((quotient - product).abs() < 1e-7 * product.abs(), "{quotient} {product}");
}

#[test]
fn across_a_kink_the_product_lies_between_the_one_sided_quotients() {
    let theta = example(16).unwrap();
    let (free, held) = (Vector::from_element(16, 20.0), Vector::from_element(16, -20.0));
    let touched = |x: &Vector| theta.solver().solve(x, None, Accuracy::TIGHTEST).unwrap().active.iter().any(|&a| a);
    assert!(!touched(&free) && touched(&held));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if touched(&free.lerp(&held, middle)) { high = middle } else { low = middle }
    }
    let kink = free.lerp(&held, low);
    let direction = (&held - &free).normalize();
    let t = 1e-4;
    let here = value(&theta, &kink);
    let after = (value(&theta, &(&kink + &direction * t)) - here) / t;
    let before = (here - value(&theta, &(&kink - &direction * t))) / t;
    let product = theta.evaluate(&Request::tight(&kink)).unwrap().into_evaluation().subgradient.dot(&direction);
    let (least, largest) = (before.min(after), before.max(after));
    let slack = 1e-4 * largest.abs();
    assert!(largest - least > 10.0 * slack, "no kink: {before} {after}");
    assert!((least - slack..=largest + slack).contains(&product), "{before} {product} {after}");
}

#[test]
fn the_engine_finds_a_stationary_load() {
    let theta = example(16).unwrap();
    let start = Vector::zeros(16);
    let first = value(&theta, &start);
    let report = BundleTrust::new(BundleTrustConfig::default())
        .unwrap()
        .constraints(admissible_loads())
        .minimize(&theta, start)
        .unwrap();
    assert!(report.termination.is_stationary(), "{report}");
    assert!(report.value < 0.05 * first, "{report}");
    // No random direction of the box descends.
    for seed in 1..=20 {
        let trial = &report.solution + seeded_direction(16, seed) * 0.05;
        if trial.amax() <= problems::membrane::LARGEST_LOAD {
            assert!(value(&theta, &trial) >= report.value - 1e-7 * report.value, "seed {seed}");
        }
    }
}

#[test]
fn wrong_controls_and_data_are_refused() {
    let theta = example(4).unwrap();
    let error = theta.solver().solve(&Vector::zeros(3), None, Accuracy::TIGHTEST).unwrap_err();
    assert!(matches!(error, OracleError::Input(_)) && error.to_string().contains("16"), "{error}");
    assert!(theta.solver().solve(&Vector::from_element(16, f64::NAN), None, Accuracy::TIGHTEST).is_err());
    let data = MembraneData {
        load: Box::new(|_| f64::NAN),
        obstacle: Box::new(|_| 0.0),
        boundary: Box::new(|_| 0.0),
        patches: 1,
    };
    let grid = || MembraneGrid::new(4, [0.0, 0.0], 1.0).unwrap();
    assert!(MembraneControl::new(grid(), &data).unwrap_err().to_string().contains("NaN"));
    let none = MembraneData { load: Box::new(|_| 0.0), patches: 0, ..data };
    assert!(MembraneControl::new(grid(), &none).unwrap_err().to_string().contains("patches"));
    assert!(MembraneGrid::new(1, [0.0, 0.0], 1.0).is_err() && MembraneGrid::new(4, [0.0, 0.0], -1.0).is_err());
    assert!(example(1).is_err());
}
