//! Problems with nonlinear constraints: optimal values of other solvers, second statements of the functions,
//! derivatives.

use serde_json::Value;
use std::collections::BTreeMap;
use testset::constrained::{ConstrainedProblem, Kind, all, find};
use testset::kit::{Random, numbers};

/// The results of `testset/reference/constrained.py` by name.
fn references() -> BTreeMap<String, Value> {
    let table: Value = serde_json::from_str(include_str!("../../reference/constrained.json")).unwrap();
    let records = table["problems"].as_array().unwrap().clone();
    records.into_iter().map(|record| (record["name"].as_str().unwrap().to_owned(), record)).collect()
}

fn number(record: &Value, key: &str) -> f64 {
    record[key].as_f64().unwrap_or_else(|| panic!("{}: no number {key}", record["name"]))
}

/// Bounds, null for none.
fn bounds(record: &Value, key: &str, none: f64) -> Vec<f64> {
    record[key].as_array().unwrap().iter().map(|bound| bound.as_f64().unwrap_or(none)).collect()
}

fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / (1.0 + expected.abs())
}

/// Problem and record of all problems.
fn pairs() -> Vec<(ConstrainedProblem, Value)> {
    let mut references = references();
    let record = |p: &ConstrainedProblem| references.remove(&p.name).unwrap_or_else(|| panic!("{}: no record", p.name));
    let records: Vec<Value> = all().iter().map(record).collect();
    assert!(references.is_empty(), "records without a problem: {:?}", references.keys());
    all().into_iter().zip(records).collect()
}

#[test]
fn optimal_values_are_those_of_two_solvers() {
    for (p, record) in pairs() {
        let (optimum, second) = (number(&record, "optimum"), number(&record, "second_optimum"));
        assert!(record["converged"].as_bool().unwrap(), "{}", p.name);
        assert!(relative(optimum, p.optimum) <= 1e-9, "{}: {optimum:.15} {:.15}", p.name, p.optimum);
        // SLSQP ends with a violation; the multipliers tell by how much it lowers the value.
        let lowered = number(&record, "second_violation") * number(&record, "multiplier_sum");
        let gap = (second - p.optimum).abs();
        assert!(gap <= 1e-9 * (1.0 + p.optimum.abs()) + lowered, "{}: {second:.15} {:.15}", p.name, p.optimum);
        // Published values have eight to ten digits; others are closed forms.
        if let Some(known) = record["known"].as_f64() {
            assert!(relative(known, p.optimum) <= 3e-8, "{}: {known} {:.12}", p.name, p.optimum);
        }
        let from_start = number(&record, "optimum_from_start");
        assert!(relative(from_start, p.optimum) <= 1e-9, "{}: from the start {from_start}", p.name);
        assert_eq!(numbers(&record["other_local_optima"]), p.other_optima, "{}", p.name);
    }
}

#[test]
fn facts_are_those_of_the_records() {
    for (p, record) in pairs() {
        assert_eq!(record["n"].as_u64().unwrap() as usize, p.dimension, "{}", p.name);
        assert_eq!(record["m"].as_u64().unwrap() as usize, p.kinds.len(), "{}", p.name);
        assert_eq!(record["active"].as_u64().unwrap() as usize, p.active, "{}", p.name);
        assert!(relative(number(&record, "penalty"), p.penalty) < 1e-12, "{}: {}", p.name, number(&record, "penalty"));
        assert!(p.penalty >= 1.5 * number(&record, "multiplier_sum") - 1e-6, "{}", p.name);
        assert_eq!(numbers(&record["start"]), p.start, "{}", p.name);
        assert_eq!(bounds(&record, "lower", f64::NEG_INFINITY), p.lower, "{}", p.name);
        assert_eq!(bounds(&record, "upper", f64::INFINITY), p.upper, "{}", p.name);
        assert_eq!(find(&p.name).unwrap().source, p.source);
    }
}

#[test]
fn functions_are_those_of_the_second_statement() {
    for (p, record) in pairs() {
        let found = p.evaluate(&numbers(&record["probe"]));
        let expected = number(&record, "probe_value");
        assert!(relative(found.value, expected) < 1e-12, "{}: {} {expected}", p.name, found.value);
        let expected = numbers(&record["probe_constraints"]);
        assert_eq!(found.constraints.len(), expected.len(), "{}", p.name);
        for (j, ((value, _), expected)) in found.constraints.iter().zip(expected).enumerate() {
            assert!(relative(*value, expected) < 1e-12, "{}: constraint {}: {value} {expected}", p.name, j + 1);
        }
    }
}

#[test]
fn minimisers_are_feasible_and_have_the_optimal_value() {
    for (p, record) in pairs() {
        let x = numbers(&record["minimiser"]);
        let value = p.evaluate(&x);
        assert!(relative(value.value, p.optimum) <= 1e-9, "{}: {:.15}", p.name, value.value);
        // The constraints of Colville's third problem have coefficients of several hundred.
        assert!(p.violation(&x) <= 1e-8, "{}: violation {:e}", p.name, p.violation(&x));
        for j in numbers(&record["active_constraints"]) {
            let (c, _) = value.constraints[j as usize - 1];
            assert!(c.abs() <= 2e-6, "{}: constraint {j} is {c:e}", p.name);
        }
    }
}

/// Error of the slopes along a direction, relative to the largest term; central differences of fourth order.
fn slope_error(p: &ConstrainedProblem, x: &[f64], direction: &[f64]) -> f64 {
    let h = 1e-3;
    let at = |t: f64| {
        let moved: Vec<f64> = x.iter().zip(direction).map(|(x, d)| x + t * d).collect();
        let value = p.evaluate(&moved);
        let functions: Vec<f64> = [value.value].into_iter().chain(value.constraints.iter().map(|c| c.0)).collect();
        functions
    };
    let (near, far) = ([at(h), at(-h)], [at(2.0 * h), at(-2.0 * h)]);
    let value = p.evaluate(x);
    let gradients = [&value.subgradient].into_iter().chain(value.constraints.iter().map(|c| &c.1));
    let errors = gradients.enumerate().map(|(k, gradient)| {
        let terms = gradient.iter().zip(direction).map(|(g, d)| g * d);
        let difference = (8.0 * (near[0][k] - near[1][k]) - (far[0][k] - far[1][k])) / (12.0 * h);
        let size = terms.clone().fold(1.0, |m: f64, term| m.max(term.abs()));
        (terms.sum::<f64>() - difference).abs() / size
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn subgradients_are_the_differences_at_smooth_points() {
    let mut failures = Vec::new();
    for (seed, p) in all().iter().enumerate() {
        let mut random = Random(seed as u64);
        let (mut checked, mut worst) = (0, 0.0_f64);
        for _ in 0..200 {
            // A move of at most a tenth of each variable; a direction of at most a hundredth.
            let spread: Vec<f64> = p.start.iter().map(|x| x.abs() + 0.1).collect();
            let x: Vec<f64> = p.start.iter().zip(&spread).map(|(x, s)| x + 0.1 * s * random.signed()).collect();
            let direction: Vec<f64> = spread.iter().map(|s| 0.01 * s * random.signed()).collect();
            let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            if checked == 3 || p.kink_distance(&x) < 0.004 * length {
                continue;
            }
            checked += 1;
            worst = worst.max(slope_error(p, &x, &direction));
        }
        println!("{:26} points {checked}  worst relative error {worst:.1e}", p.name);
        if checked < 3 || worst > 1e-8 {
            failures.push((p.name.clone(), checked, worst));
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn the_penalty_is_exact_near_the_minimiser() {
    for (seed, (p, record)) in pairs().iter().enumerate() {
        let (minimiser, mut random) = (numbers(&record["minimiser"]), Random(seed as u64));
        let mut lowest = f64::INFINITY;
        for k in 0..60 {
            let size = [1e-2, 1e-3, 1e-4, 1e-6][k % 4];
            let sides = p.lower.iter().zip(&p.upper);
            let moved = minimiser.iter().map(|x| x + size * (x.abs() + 0.01) * random.signed());
            let x: Vec<f64> = moved.zip(sides).map(|(x, (&l, &u))| x.clamp(l, u)).collect();
            lowest = lowest.min(p.evaluate(&x).value + p.penalty * p.violation(&x));
        }
        let gain = (p.optimum - lowest) / (1.0 + p.optimum.abs());
        println!("{:26} {gain:9.1e}", p.name);
        assert!(gain <= 1e-9, "{}: the penalty function is lower by {gain:e}", p.name);
    }
}

#[test]
fn a_joined_problem_has_the_largest_of_its_inequalities() {
    for (p, record) in pairs() {
        let (joined, x) = (p.joined(), numbers(&record["probe"]));
        let (own, found) = (p.evaluate(&x), joined.evaluate(&x));
        let (equations, limits): (Vec<_>, Vec<_>) =
            own.constraints.into_iter().zip(&p.kinds).partition(|(_, kind)| **kind == Kind::SmoothEquality);
        assert_eq!((found.value, found.subgradient), (own.value, own.subgradient), "{}", p.name);
        let largest = limits.iter().map(|((value, _), _)| *value).fold(f64::NEG_INFINITY, f64::max);
        let first = limits.iter().find(|((value, _), _)| *value == largest).map(|(limit, _)| limit.clone());
        let expected: Vec<_> = first.into_iter().chain(equations.into_iter().map(|(equation, _)| equation)).collect();
        assert_eq!(found.constraints, expected, "{}", p.name);
        assert_eq!(joined.kinds.len(), found.constraints.len(), "{}", p.name);
    }
}

#[test]
fn outer_function_of_the_outputs_is_the_objective() {
    for (p, record) in pairs() {
        let x = numbers(&record["probe"]);
        let (outputs, gradients) = p.composition().linearize(&x);
        let (value, weights) = p.composition().outer().evaluate(&outputs);
        let expected = p.evaluate(&x);
        assert!(relative(value, expected.value) < 1e-14, "{}", p.name);
        for (i, expected) in expected.subgradient.iter().enumerate() {
            let found: f64 = weights.iter().zip(&gradients).map(|(weight, gradient)| weight * gradient[i]).sum();
            assert!((found - expected).abs() <= 1e-10 * (1.0 + expected.abs()), "{}: {found} {expected}", p.name);
        }
    }
}

#[test]
fn the_collection_is_broad() {
    let pairs = pairs();
    let count = |holds: &dyn Fn(&(ConstrainedProblem, Value)) -> bool| pairs.iter().filter(|pair| holds(pair)).count();
    assert_eq!(pairs.len(), 60);
    let curved_vertices = count(&|(p, _)| p.active >= 2);
    let large = count(&|(p, _)| p.dimension >= 50);
    let with_equations = count(&|(p, _)| p.kinds.contains(&Kind::SmoothEquality));
    // Two or more pieces of a constraint, or two or more eigenvalues, are active at the solution.
    let kinks = count(&|(_, record)| numbers(&record["kinks"]).iter().any(|pieces| *pieces >= 2.0));
    assert_eq!((curved_vertices, large, with_equations, kinks), (29, 9, 12, 12));
}
