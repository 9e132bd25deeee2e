//! The toy: closed forms against enumeration, differences, grids and the definition of the Clarke set.

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};
use nonsmooth::{Accuracy, Coderivative, Cost, NonsmoothObjective, Request, StateSolver, Vector};
use problems::toy::*;
use proptest::prelude::*;

const STATUSES: [NodeStatus; 4] =
    [NodeStatus::Open, NodeStatus::Stick, NodeStatus::SlipForward, NodeStatus::SlipBackward];

/// The state of a node under an assumed status, from the 4×4 system in (λ_N, λ_T, n, w), if its inequalities hold.
fn assume(data: &NodeData, status: NodeStatus, support: f64, slack: f64) -> Option<[f64; 4]> {
    let NodeData { stiffness: k, coupling: c, friction_coefficient: f, pressing_load: p, tangential_load: t } = *data;
    let sign = match status {
        NodeStatus::SlipForward => 1.0,
        NodeStatus::SlipBackward => -1.0,
        _ => 0.0,
    };
    let (third, fourth, height) = match status {
        NodeStatus::Open => ([1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], 0.0),
        NodeStatus::Stick => ([0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], support),
        _ => ([0.0, 0.0, 1.0, 0.0], [-sign * f, 1.0, 0.0, 0.0], support),
    };
    let rows: Vec<f64> = [[-1.0, 0.0, k, c], [0.0, 1.0, c, k], third, fourth].into_iter().flatten().collect();
    let solution = Matrix4::from_row_slice(&rows).lu().solve(&Vector4::new(-p, t, height, 0.0))?;
    let [normal, tangential, n, w] = [solution[0], solution[1], solution[2], solution[3]];
    let holds = match status {
        NodeStatus::Open => n >= support - slack,
        NodeStatus::Stick => normal >= -slack && tangential.abs() <= f * normal + slack,
        _ => normal >= -slack && sign * w >= -slack,
    };
    holds.then_some([normal, tangential, n, w])
}

/// |λ − Π(λ + x)| with x = (h − n, w): the projection form of all contact conditions.
fn projection_residual(data: &NodeData, values: &NodeValues, support: f64) -> f64 {
    let normal = (values.normal_force + support - values.height).max(0.0);
    let radius = data.friction_coefficient * normal;
    let tangential = (values.tangential_force + values.slip).clamp(-radius, radius);
    (values.normal_force - normal).abs().max((values.tangential_force - tangential).abs())
}

fn equilibrium_residual(data: &NodeData, values: &NodeValues) -> f64 {
    let NodeValues { normal_force, tangential_force, height, slip } = *values;
    let normal = data.stiffness * height + data.coupling * slip + data.pressing_load - normal_force;
    let tangential = data.coupling * height + data.stiffness * slip - data.tangential_load + tangential_force;
    normal.abs().max(tangential.abs())
}

prop_compose! {
    fn any_node()(
        stiffness in 0.5..4.0, ratio in -0.9..0.9, friction_coefficient in 0.05..1.0,
        pressing_load in -3.0..3.0, tangential_load in -3.0..3.0,
    ) -> Node {
        let coupling = ratio * stiffness;
        Node::new(NodeData { stiffness, coupling, friction_coefficient, pressing_load, tangential_load })
            .expect("𝓕|κ| < k")
    }
}

fn any_toy() -> impl Strategy<Value = ToyContact> {
    (any_node(), any_node()).prop_map(|(first, second)| ToyContact::new([first, second]))
}

fn any_control() -> impl Strategy<Value = Vector> {
    [LOWER..UPPER, LOWER..UPPER].prop_map(|control| Vector::from_row_slice(&control))
}

/// Distance of both supports from their nearest kinks.
fn margin(solver: &ToyContact, control: &Vector) -> f64 {
    let kinks = solver.nearest_kinks(control).expect("finite control");
    kinks.iter().flatten().map(|(_, distance)| *distance).fold(f64::INFINITY, f64::min)
}

fn state(solver: &ToyContact, control: &Vector) -> ToyState {
    solver.solve(control, None, Accuracy::TIGHTEST).expect("finite control")
}

fn theta(control: &Vector) -> (f64, Vector) {
    let answer = toy_objective().evaluate(&Request::tight(control)).expect("finite control").into_evaluation();
    (answer.value, answer.subgradient)
}

/// Central difference of a function along an axis.
fn central(at: &Vector, axis: usize, step: f64, value: impl Fn(&Vector) -> f64) -> f64 {
    let [after, before] = [1.0, -1.0].map(|sign| {
        let mut moved = at.clone();
        moved[axis] += sign * step;
        value(&moved)
    });
    (after - before) / (2.0 * step)
}

/// Distance of a point from the convex hull of at most four plane vectors: over all triangles (Carathéodory).
fn distance_from_hull(vertices: &[Vector], point: &Vector) -> f64 {
    let mut best = f64::INFINITY;
    let count = vertices.len();
    for i in 0..count {
        for j in 0..count {
            for k in 0..count {
                let corner = [&vertices[i], &vertices[j], &vertices[k]];
                let system = DMatrix::from_fn(3, 3, |row, column| if row < 2 { corner[column][row] } else { 1.0 });
                let right = DVector::from_vec(vec![point[0], point[1], 1.0]);
                let Ok(weights) = system.clone().svd(true, true).solve(&right, 1e-12) else { continue };
                let negative = weights.iter().fold(0.0_f64, |worst, weight| worst.max(-weight));
                best = best.min((system * &weights - right).norm() + negative);
            }
        }
    }
    best
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Exactly one status solves the contact problem, and it is the one of the closed form.
    #[test]
    fn state_agrees_with_enumeration(node in any_node(), support in -8.0..8.0_f64) {
        let kink = node.kinks().iter().map(|kink| (kink.height - support).abs()).fold(f64::INFINITY, f64::min);
        prop_assume!(kink > 1e-6);
        let (status, values) = node.solve(support);
        // rounding of the 4×4 system, whose condition is at most about 1e3 here
        let solutions: Vec<_> = STATUSES
            .iter()
            .filter_map(|&status| assume(node.data(), status, support, -1e-11).map(|found| (status, found)))
            .collect();
        prop_assert_eq!(solutions.len(), 1);
        prop_assert_eq!(solutions[0].0, status);
        let difference = Vector4::from(solutions[0].1) - Vector4::from(values.packed());
        prop_assert!(difference.norm() < 1e-11 * (1.0 + Vector4::from(values.packed()).norm()));
    }

    /// The projection form and equilibrium hold everywhere, on kinks too, and the state is continuous there.
    #[test]
    fn state_satisfies_the_projection_form(node in any_node(), support in -8.0..8.0_f64) {
        let kinks = node.kinks().into_iter().map(|kink| kink.height);
        for height in kinks.chain([support]).filter(|height| height.abs() < 1e3) {
            let (_, values) = node.solve(height);
            let size = 1e-12 * (1.0 + height.abs()) * 10.0;
            prop_assert!(projection_residual(node.data(), &values, height) < size);
            prop_assert!(equilibrium_residual(node.data(), &values) < size);
            for side in [-1e-9, 1e-9] {
                let (_, near) = node.solve(height + side);
                let jump = Vector4::from(near.packed()) - Vector4::from(values.packed());
                // Lipschitz constant of S in these data: at most max(k, Λ_σ) ≤ 4/(1 − 0.9) with the other rows
                prop_assert!(jump.norm() < 1e-9 * 100.0 + size);
            }
        }
    }

    /// The chain of statuses at the kinks is the one that `solve` reports just beside them.
    #[test]
    fn kinks_separate_the_statuses(node in any_node()) {
        for kink in node.kinks().iter().filter(|kink| kink.height.abs() < 1e3) {
            let apart = node.kinks().iter().all(|other| other == kink || (other.height - kink.height).abs() > 1e-6);
            prop_assume!(apart);
            prop_assert_eq!(node.solve(kink.height - 1e-8).0, kink.below);
            prop_assert_eq!(node.solve(kink.height + 1e-8).0, kink.above);
        }
    }

    #[test]
    fn coderivative_agrees_with_central_differences(
        toy in any_toy(),
        control in any_control(),
        dual in prop::array::uniform8(-1.0..1.0_f64),
    ) {
        let step = 1e-4;
        prop_assume!(margin(&toy, &control) > step);
        let dual = Vector::from_row_slice(&dual);
        let adjoint = toy.coderivative(&control, &state(&toy, &control), &dual).expect("8 entries").element;
        for j in 0..2 {
            // S is affine between kinks: the difference is exact up to rounding / step
            let difference = central(&control, j, step, |moved| state(&toy, moved).packed().dot(&dual));
            prop_assert!((difference - adjoint[j]).abs() < 1e-9 * (1.0 + adjoint.norm()));
        }
    }

    #[test]
    fn subgradient_agrees_with_central_differences(control in any_control()) {
        let step = 1e-4;
        prop_assume!(margin(toy_objective().solver(), &control) > step);
        let (_, subgradient) = theta(&control);
        for j in 0..2 {
            // Θ is quadratic between kinks: exact up to rounding / step
            let difference = central(&control, j, step, |moved| theta(moved).0);
            prop_assert!((difference - subgradient[j]).abs() < 1e-9 * (1.0 + subgradient.norm()));
        }
        let vertices = clarke_vertices(&toy_objective(), &control).expect("finite control");
        prop_assert_eq!(vertices.len(), 1);
        prop_assert!((&vertices[0] - subgradient).norm() < 1e-12);
    }

    /// On a kink line, or where two cross: the returned element lies in the hull, the corners are the limits of
    /// gradients from all sides, and every gradient nearby is close to a corner.
    #[test]
    fn subgradient_on_a_kink_lies_in_the_clarke_set(
        first in 0..3_usize, second in 0..4_usize, free in -3.5..5.5_f64,
    ) {
        let objective = toy_objective();
        let kinks = objective.solver().nodes().map(|node| node.kinks());
        let other = kinks[1].get(second).map_or(free, |kink| kink.height);
        let on_second = kinks[1].iter().any(|kink| (kink.height - other).abs() < 1e-6);
        let control = from_heights([kinks[0][first].height, other]);
        let (_, element) = theta(&control);
        let vertices = clarke_vertices(&objective, &control).expect("finite control");
        prop_assert_eq!(vertices.len(), if on_second { 4 } else { 2 });
        prop_assert!(distance_from_hull(&vertices, &element) < 1e-12);
        let mut seen = vec![false; vertices.len()];
        for step in 0..16 {
            let angle = 0.2 + step as f64 * std::f64::consts::TAU / 16.0;
            let nearby = &control + Vector::from_vec(vec![angle.cos(), angle.sin()]) * 1e-7;
            let (_, gradient) = theta(&nearby);
            // second derivatives of Θ are at most about 4
            let close: Vec<_> = vertices.iter().map(|vertex| (vertex - &gradient).norm() < 1e-6).collect();
            prop_assert!(close.contains(&true));
            seen.iter_mut().zip(close).for_each(|(seen, close)| *seen |= close);
        }
        prop_assert!(seen.iter().all(|seen| *seen));
    }

    /// The proof of the module head: limiting gradients point away from the minimiser: no other point is stationary.
    #[test]
    fn gradients_point_away_from_the_minimiser(control in any_control()) {
        points_away(&control)?;
    }
}

/// α = B⁻¹ h.
fn from_heights([first, second]: [f64; 2]) -> Vector {
    Vector::from_vec(vec![1.5 * first - 0.5 * second, 1.5 * second - 0.5 * first])
}

fn points_away(control: &Vector) -> Result<(), TestCaseError> {
    let offset = control - minimiser();
    let distance = offset.norm();
    if distance > 1e-6 {
        for vertex in clarke_vertices(&toy_objective(), control).expect("finite control") {
            prop_assert!(vertex.dot(&offset) > 0.0, "at {control}");
            prop_assert!(distance > 1.0 || vertex.dot(&offset) > 0.2 * distance, "growth at {control}");
        }
    }
    Ok(())
}

#[test]
fn gradients_point_away_from_the_minimiser_on_the_kink_lines() {
    let kinks = toy_objective().solver().nodes().map(|node| node.kinks());
    for step in 0..=1000 {
        let free = -12.0 + 0.024 * f64::from(step);
        for (first, second) in kinks[0].iter().zip(&kinks[1]) {
            for heights in [[first.height, free], [free, second.height]] {
                let control = from_heights(heights);
                if control.iter().all(|value| (LOWER..=UPPER).contains(value)) {
                    points_away(&control).expect("no other stationary point");
                }
            }
        }
    }
}

#[test]
fn kinks_are_those_of_the_module_head() {
    let objective = toy_objective();
    let expected = [[-1.0, 0.5, 2.5], [-2.0, 1.0, 5.0]];
    use NodeStatus::{Open, SlipBackward, SlipForward, Stick};
    for (node, heights) in objective.solver().nodes().iter().zip(expected) {
        let kinks = node.kinks();
        assert_eq!(kinks.iter().map(|kink| kink.height).collect::<Vec<_>>(), heights);
        let statuses = [(Open, SlipForward), (SlipForward, Stick), (Stick, SlipBackward)];
        assert_eq!(kinks.iter().map(|kink| (kink.below, kink.above)).collect::<Vec<_>>(), statuses);
    }
}

#[test]
fn zero_is_inside_the_clarke_set_at_the_minimiser() {
    let objective = toy_objective();
    let vertices = clarke_vertices(&objective, &minimiser()).expect("finite control");
    assert_eq!(vertices.len(), 4);
    assert!(distance_from_hull(&vertices, &Vector::zeros(2)) < 1e-14);
    // interior: a disc of radius 1/5 around 0 lies inside
    for step in 0..64 {
        let angle = f64::from(step) * std::f64::consts::TAU / 64.0;
        let point = Vector::from_vec(vec![angle.cos(), angle.sin()]) * 0.2;
        assert!(distance_from_hull(&vertices, &point) < 1e-13);
    }
    assert!((theta(&minimiser()).0 - MINIMUM).abs() < 1e-15);
}

#[test]
fn fine_grid_has_its_minimum_at_the_minimiser() {
    // 400 cells: spacing 0.025, α* = (1/4, 5/4) is a grid point up to rounding
    let points = landscape(400).expect("finite controls");
    let lowest = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    assert!((lowest - MINIMUM).abs() < 1e-12);
    for (control, value) in points {
        let distance = (Vector::from_row_slice(&control) - minimiser()).norm();
        assert!(value >= MINIMUM - 1e-12 + 0.2 * distance.min(1.0), "{control:?}");
    }
}

/// A fine grid around the minimiser, off the kinks, down to 1e-6.
#[test]
fn growth_is_sharp_at_every_scale() {
    for scale in [1e-1, 1e-3, 1e-6] {
        for i in -50..=50 {
            for j in -50..=50 {
                let offset = Vector::from_vec(vec![f64::from(i), f64::from(j)]) * (scale / 50.0);
                let growth = theta(&(minimiser() + &offset)).0 - MINIMUM;
                assert!(growth >= 0.2 * offset.norm() - 1e-14);
            }
        }
    }
}

#[test]
fn objective_is_nonconvex() {
    // across the touching line of the first node, second node held at stick
    let at = |first: f64| theta(&from_heights([first, 2.0])).0;
    assert!(at(-1.0) > 0.5 * (at(-1.2) + at(-0.8)) + 0.1);
    let across = |first: f64| theta(&from_heights([first, 2.0])).1;
    assert!((across(2.5 + 1e-9) - across(2.5 - 1e-9)).dot(&from_heights([1.0, 0.0])) < -0.5);
}

#[test]
fn cost_gradient_agrees_with_central_differences() {
    let objective = toy_objective();
    let control = Vector::from_vec(vec![2.0, -0.5]);
    let at = state(objective.solver(), &control);
    let gradient = objective.cost().gradient(&control, &at);
    let step = 1e-4;
    for entry in 0..ToyState::LEN {
        let shifted = |sign: f64| {
            let mut moved = at.clone();
            let values = &mut moved.nodes[entry / 4].values;
            let target = [&mut values.normal_force, &mut values.tangential_force, &mut values.height, &mut values.slip];
            *target.into_iter().nth(entry % 4).expect("four entries") += sign * step;
            objective.cost().value(&control, &moved)
        };
        let difference = (shifted(1.0) - shifted(-1.0)) / (2.0 * step);
        assert!((difference - gradient.state[entry]).abs() < 1e-9);
    }
    for entry in 0..2 {
        let difference = central(&control, entry, step, |moved| objective.cost().value(moved, &at));
        assert!((difference - gradient.control[entry]).abs() < 1e-9);
    }
}

#[test]
fn engine_finds_the_minimiser_from_random_starts() {
    for seed in 1..=5 {
        let study = run_study(&random_starts(seed, 20)).expect("finite starts").expect("twenty starts");
        assert!(study.all_found(), "seed {seed}\n{study}");
    }
}

#[test]
fn random_starts_are_admissible_and_reproducible() {
    let starts = random_starts(7, 1000);
    assert_eq!(starts, random_starts(7, 1000));
    assert!(starts.iter().flatten().all(|value| (LOWER..=UPPER).contains(value)));
    let mean = starts.iter().flatten().sum::<f64>() / 2000.0;
    // uniform on [−4, 6]: mean 1, standard error 0.065
    assert!((mean - 1.0).abs() < 0.3);
}

#[test]
fn inadmissible_data_are_refused() {
    let data = *toy_objective().solver().nodes()[0].data();
    for bad in [
        NodeData { stiffness: 0.0, ..data },
        NodeData { coupling: -2.0, ..data },
        NodeData { friction_coefficient: 0.0, ..data },
        NodeData { friction_coefficient: 2.0, ..data },
        NodeData { pressing_load: f64::NAN, ..data },
        NodeData { tangential_load: f64::INFINITY, ..data },
    ] {
        assert!(Node::new(bad).is_err(), "{bad:?}");
    }
    let objective = toy_objective();
    for control in [vec![1.0], vec![1.0, f64::NAN]] {
        assert!(objective.evaluate(&Request::tight(&Vector::from_vec(control))).is_err());
    }
    assert!(landscape(0).is_err());
}
