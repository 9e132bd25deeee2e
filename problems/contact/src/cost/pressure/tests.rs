//! Bounds, derivatives and convexity of the costs of the pressure.

use super::*;
use crate::cost::WantedPressure;
use proptest::prelude::*;

/// Σσ^p of forces over areas.
fn norm(forces: &[f64], areas: &[f64], p: f64) -> f64 {
    forces.iter().zip(areas).map(|(force, area)| (force / area).powf(p)).sum()
}

#[test]
fn the_lower_bound_is_attained_and_never_undercut() {
    let areas = vec![1.0, 2.0, 4.0, 0.5];
    for p in [1.02, 1.5, 4.0, 12.0] {
        let measure = PressureMeasure::Norm { exponent: p, weight: NodeWeight::Nodes };
        let cost = cost_over(measure, &areas);
        let weights: Vec<f64> = areas.iter().map(|area: &f64| area.powf(p / (p - 1.0))).collect();
        let forces: Vec<f64> = weights.iter().map(|w| 30.0 * w / weights.iter().sum::<f64>()).collect();
        let bound = cost.lower_bound(30.0).expect("areas that stay");
        assert!((norm(&forces, &areas, p) / bound - 1.0).abs() < 1e-12);
        for other in [[30.0, 0.0, 0.0, 0.0], [7.5; 4], [4.0, 8.0, 16.0, 2.0]] {
            assert!(norm(&other, &areas, p) >= bound * (1.0 - 1e-12));
        }
    }
    // Near p = 1 everything goes to the largest area: (30/4)^p.
    let nearly = PressureMeasure::Norm { exponent: 1.001, weight: NodeWeight::Nodes };
    let cost = cost_over(nearly, &areas);
    assert!((cost.lower_bound(30.0).expect("areas that stay") / 7.5_f64.powf(1.001) - 1.0).abs() < 1e-12);
    let cost = cost_over(PressureMeasure::Peak, &areas);
    assert!((cost.lower_bound(30.0).expect("areas that stay") - 4.0).abs() < 1e-14);
}

#[test]
fn the_lower_bound_of_the_paper_s_example() {
    // method.md (9.1): (3e7)⁴/(Σ A^{4/3})³ = 1.294e16 on 12 × 12 bricks of a 100 mm square.
    let problem = ContactProblem::new(crate::scene::signorini().expect("a scene")).expect("a problem");
    let areas = problem.start_rows().areas();
    assert_eq!(areas.len(), 13 * 13);
    let cost = cost_over(PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes }, &areas);
    assert!((cost.lower_bound(3e7).expect("areas that stay") / 1.294e16 - 1.0).abs() < 5e-4);
}

/// A cost over nodes with these areas.
fn cost_over(measure: PressureMeasure, areas: &[f64]) -> PressureCost {
    let wanted = match &measure {
        PressureMeasure::Deviation { wanted: WantedPressure::AtNodes(wanted) } => wanted.clone(),
        _ => Vec::new(),
    };
    PressureCost::over("objective", measure, wanted, (areas.to_vec(), false)).expect("a measure over as many nodes")
}

/// A cost over four nodes.
fn cost(measure: PressureMeasure) -> PressureCost {
    cost_over(measure, &[1.0, 2.0, 4.0, 0.5])
}

#[test]
fn the_least_deviation_is_attained_and_never_undercut() {
    let areas = [1.0, 2.0, 4.0, 0.5];
    for wanted in [vec![3.0, 1.0, 2.0, 8.0], vec![-5.0, 0.0, 1.0, 6.0], vec![5.0; 4]] {
        let cost = cost(PressureMeasure::Deviation { wanted: WantedPressure::AtNodes(wanted.clone()) });
        for force in [0.0, 2.0, 15.0, 40.0] {
            let bound = cost.lower_bound(force).expect("areas that stay");
            // The best of a fine family of pressures that carry the force is not below the bound, and comes near it.
            let mut best = f64::INFINITY;
            for step in 0..4000 {
                let shift = -10.0 + 0.01 * f64::from(step);
                let carried = wanted.iter().map(|w| (w + shift).max(0.0));
                let total: f64 = carried.clone().zip(areas).map(|(pressure, area)| area * pressure).sum();
                let factor = if total > 0.0 { force / total } else { 0.0 };
                if total > 0.0 || force == 0.0 {
                    let pressures = Vector::from_iterator(4, carried.map(|pressure| factor * pressure));
                    best = best.min(cost.value(&pressures));
                }
            }
            assert!(best >= bound * (1.0 - 1e-12) - 1e-12, "{wanted:?} {force}: {best} {bound}");
            assert!(best - bound < 1e-3 * (1.0 + bound), "{wanted:?} {force}: {best} {bound}");
        }
    }
    // A pressure that can be had has the bound 0.
    let uniform = cost(PressureMeasure::Deviation { wanted: WantedPressure::AtNodes(vec![5.0; 4]) });
    assert_eq!(uniform.lower_bound(37.5).expect("areas that stay"), 0.0);
    assert_eq!(uniform.value(&Vector::from_element(4, 5.0)), 0.0);
}

#[test]
fn the_open_area_counts_whole_nodes_parts_and_none() {
    let cost = cost(PressureMeasure::OpenArea { pressure: 10.0 });
    let pressures = Vector::from_vec(vec![0.0, 5.0, 10.0, 30.0]);
    assert_eq!(cost.value(&pressures), 2.0);
    assert_eq!(cost.lower_bound(30.0).expect("areas that stay"), 4.5);
    assert_eq!(cost.lower_bound(100.0).expect("areas that stay"), 0.0);
    assert!(cost.curvature(&pressures, &Matrix::zeros(4, 2)).is_none());
}

#[test]
fn curvature_of_a_norm_is_the_derivative_of_its_subgradient() {
    for weight in [NodeWeight::Nodes, NodeWeight::Area] {
        let cost = cost(PressureMeasure::Norm { exponent: 4.0, weight });
        let jacobian = Matrix::from_fn(4, 3, |i, j| ((3 * i + j) as f64).sin());
        let (c, d) = (Vector::from_vec(vec![3.0, 2.9, 2.8, 0.5]), Vector::from_vec(vec![3e-5, -7e-5, 4e-5]));
        let slope = |sign: f64| jacobian.tr_mul(&cost.subgradient(&(&c + &jacobian * &d * sign)));
        let difference = (slope(1.0) - slope(-1.0)) * 0.5;
        let product = cost.curvature(&c, &jacobian).expect("smooth") * &d;
        // Relative to the subgradient, the rounding of the difference is 1e-16, and the change is 1e-4 of it.
        assert!((&difference - &product).norm() < 1e-8 * product.norm(), "{weight:?}: {difference} {product}");
    }
}

#[test]
fn curvature_of_the_deviation_is_the_derivative_of_its_subgradient() {
    let cost = cost(PressureMeasure::Deviation { wanted: WantedPressure::AtNodes(vec![1.0, -2.0, 0.5, 3.0]) });
    let jacobian = Matrix::from_fn(4, 3, |i, j| ((3 * i + j) as f64).sin());
    let (c, d) = (Vector::from_vec(vec![2.0, 0.0, 1.0, 7.0]), Vector::from_vec(vec![0.3, -0.7, 0.4]));
    let difference = cost.subgradient(&(&c + &jacobian * &d)) - cost.subgradient(&c);
    let product = cost.curvature(&c, &jacobian).expect("smooth") * &d;
    assert!((jacobian.tr_mul(&difference) - &product).norm() < 1e-13 * product.norm());
}

#[test]
fn an_integral_over_the_area_is_least_for_the_uniform_pressure() {
    let areas = [1.0, 2.0, 4.0, 0.5];
    for exponent in [1.02, 2.0, 4.0, 16.0, 64.0] {
        let norm = cost(PressureMeasure::Norm { exponent, weight: NodeWeight::Area });
        for cost in [norm.clone(), norm.rooted()] {
            let uniform = Vector::from_element(4, 4.0);
            let (least, bound) = (cost.value(&uniform), cost.lower_bound(30.0).expect("areas that stay"));
            assert!((least / bound - 1.0).abs() < 1e-13, "{exponent}: {least} {bound}");
            // The subgradient is proportional to the areas: no pressures of the same force are below, to first order.
            let slopes = cost.subgradient(&uniform).component_div(&Vector::from_column_slice(&areas));
            assert!(slopes.max() - slopes.min() < 1e-13 * slopes.max(), "{slopes}");
            for forces in [[30.0, 0.0, 0.0, 0.0], [7.5; 4], [4.4, 8.0, 15.6, 2.0]] {
                let pressures = Vector::from_fn(4, |index, _| forces[index] / areas[index]);
                assert!(cost.value(&pressures) > bound, "{exponent}: {forces:?}");
            }
        }
    }
}

#[test]
fn a_norm_in_mpa_is_the_sum_over_nodes_or_the_mean_over_the_area() {
    let pressures = Vector::from_vec(vec![3.0, 1.0, 0.0, 2.0]);
    for (weight, unit, value) in [(NodeWeight::Nodes, "MPa^{4}", 98.0), (NodeWeight::Area, "MPa^{4}·mm^{2}", 91.0)] {
        let norm = cost(PressureMeasure::Norm { exponent: 4.0, weight });
        assert_eq!((norm.value(&pressures), norm.unit().as_str(), norm.norm_of_root()), (value, unit, None));
        let size = if weight == NodeWeight::Area { 7.5 } else { 1.0 };
        let expected = (value / size).powf(0.25);
        let root = norm.clone().rooted();
        assert_eq!((root.unit().as_str(), root.root()), ("MPa", 4.0));
        assert_eq!(root.norm_of_root(), Some((size, unit.to_owned())));
        for found in [norm.norm_in_mpa(value), root.norm_in_mpa(root.value(&pressures))] {
            assert!((found.expect("a norm") / expected - 1.0).abs() < 1e-15, "{found:?} {expected}");
        }
        // Without any pressure, value and subgradient are zero.
        let nothing = Vector::zeros(4);
        assert!(root.value(&nothing) < 1e-300 && root.subgradient(&nothing) == nothing);
    }
    assert_eq!(cost(PressureMeasure::Peak).norm_in_mpa(3.0), None);
}

#[test]
fn subgradients_of_norms_are_their_derivatives() {
    let (here, step) = (Vector::from_vec(vec![3.0, 1.0, 0.5, 2.0]), Vector::from_vec(vec![0.3, -0.7, 0.4, 0.9]));
    for weight in [NodeWeight::Area, NodeWeight::Nodes] {
        let norm = cost(PressureMeasure::Norm { exponent: 6.0, weight });
        for cost in [norm.clone(), norm.rooted()] {
            let value = |length: f64| cost.value(&(&here + length * &step));
            let difference = (value(1e-5) - value(-1e-5)) / 2e-5;
            let slope = cost.subgradient(&here).dot(&step);
            // Second-order differences at 1e-5 leave an error of some 1e-9 of a slope of this size.
            assert!((difference / slope - 1.0).abs() < 1e-8, "{weight:?}: {difference} {slope}");
        }
    }
}

#[test]
fn curvature_of_a_root_is_positive_where_one_node_carries_the_norm() {
    for (exponent, weight) in [8.0, 64.0].into_iter().flat_map(|p| [(p, NodeWeight::Nodes), (p, NodeWeight::Area)]) {
        let cost = cost(PressureMeasure::Norm { exponent, weight }).rooted();
        let jacobian = Matrix::from_fn(4, 3, |i, j| ((3 * i + j) as f64).sin());
        let curvature = |c: &Vector| cost.curvature(c, &jacobian).expect("smooth");
        // The curvature is of the size of (σ/N)^{p−2} at the other nodes: at p = 64 far below the rounding of the terms
        // that cancel.
        let eigenvalues = curvature(&Vector::from_vec(vec![1300.0, 500.0, 100.0, 0.0])).symmetric_eigenvalues();
        assert!(
            eigenvalues.min() >= -1e-14 * eigenvalues.max() && eigenvalues.max() > 0.0,
            "{exponent}: {eigenvalues}"
        );
        let (c, d) = (Vector::from_vec(vec![3.0, 2.9, 2.8, 0.0]), Vector::from_vec(vec![3e-6, -7e-6, 4e-6]));
        let slope = |sign: f64| jacobian.tr_mul(&cost.subgradient(&(&c + &jacobian * &d * sign)));
        let (difference, product) = ((slope(1.0) - slope(-1.0)) * 0.5, curvature(&c) * &d);
        assert!((&difference - &product).norm() < 1e-7 * product.norm(), "{exponent}: {difference} {product}");
    }
}

proptest! {
    #[test]
    fn subgradients_lie_below_the_measure(
        a in prop::array::uniform4(0.0_f64..20.0), b in prop::array::uniform4(0.0_f64..20.0),
        w in prop::array::uniform4(-5.0_f64..20.0), pressure in 0.5_f64..15.0,
    ) {
        let (a, b) = (Vector::from_vec(a.to_vec()), Vector::from_vec(b.to_vec()));
        let wanted = WantedPressure::AtNodes(w.to_vec());
        for measure in [PressureMeasure::Deviation { wanted }, PressureMeasure::OpenArea { pressure }] {
            let cost = cost(measure);
            let (here, there) = (cost.value(&a), cost.value(&b));
            let cut = here + cost.subgradient(&a).dot(&(&b - &a));
            prop_assert!(cut <= there + 1e-12 * (here + there), "{cut} {there}");
        }
    }
}
