//! One body slides over the facets of the other: the slope of the objective has no jumps while the statuses stay.

use crate::setting::{body, boxed, pair, stacked};
use contact::body::mesh::CellKind;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::scene::{Scene, Support};
use contact::shape::{Coordinates, Directions, LatticeShape};
use nonsmooth::{Accuracy, StateSolver, Vector};

/// A small body that slides along x₁ over a large one: its only control moves it as a whole.
fn sliding(distortion: f64, slave: usize) -> Scene {
    let lower = body("lower", boxed([9, 7, 2], distortion, [0.0; 3], [18.0, 14.0, 6.0]), [1000.0, 0.3]);
    let bump = |[s, t, r]: crate::grid::Point| {
        let [x1, x2] = [4.0 + 7.0 * s, 3.0 + 6.0 * t];
        let height = 6.0 + 0.02 * ((x1 - 7.5).powi(2) + (x2 - 6.0).powi(2)) - 0.05;
        [x1, x2, height + r * (11.0 - height)]
    };
    let mut upper = body("upper", crate::grid::mesh(CellKind::Hex8, [5, 4, 2], distortion, bump), [2000.0, 0.3]);
    let edges = [[20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 20.0]];
    upper.shape = Some(LatticeShape {
        directions: Directions::Axes([true, false, false]),
        hold_supports: false,
        ..LatticeShape::new(Coordinates::Cartesian { corner: [0.0; 3], edges }, [1; 3], [-3.0, 3.0])
    });
    let mut bodies = stacked(lower, upper, 1.0);
    bodies[0].supports = vec![Support::new("bottom", [true; 3])];
    bodies[1].loads.clear();
    bodies[1].supports = vec![Support::new("top", [true; 3])];
    pair(bodies, slave, 0.0)
}

/// The slope of Θ with the statuses at a place.
type Slope = (f64, Vec<contact::equilibrium::ContactStatus>);

fn slope(objective: &ContactObjective, place: f64) -> Slope {
    let control = Vector::from_element(1, place);
    let state = objective.cases().solve(&control, None, Accuracy::TIGHTEST).unwrap();
    let slope = objective.differentiate(&control, &state).unwrap().subgradient[0];
    (slope, state[0].forces.status.clone())
}

/// What of five slopes in equal steps is no cubic curve: 6 parts for a jump of 6; none where statuses change.
fn roughness(five: &[Slope]) -> Option<f64> {
    let s = |k: usize| five[k].0;
    let is_same = five.iter().all(|(_, status)| *status == five[0].1);
    is_same.then(|| (s(4) - 4.0 * s(3) + 6.0 * s(2) - 4.0 * s(1) + s(0)).abs() / 6.0)
}

/// Largest jump of dΘ/ds over its size: the roughest places of a coarse look, looked at ever more closely. A jump
/// stays, and the roughness of a curve with kinks falls with the step.
fn largest_jump(distortion: f64, slave: usize) -> f64 {
    const STEPS: usize = 80;
    let shape = ContactShape::new(sliding(distortion, slave), SolverKind::Direct).unwrap();
    let norm = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Area };
    let objective = ContactObjective::new(shape, Quantity::Pressure(norm), &[]).unwrap();
    let looks = |from: f64, width: f64, steps: usize| -> Vec<Slope> {
        (0..=steps).map(|step| slope(&objective, from + width * step as f64)).collect()
    };
    // At 0 and ±1 the boundary of the small body passes edges of facets of the large one, whose dual bases over the
    // part that is left change at once: only away from there is the large body covered all around its closed nodes.
    let (first, length) = if slave == 0 { (0.053, 0.9) } else { (-1.103, 2.2) };
    let width = length / STEPS as f64;
    let coarse = looks(first, width, STEPS);
    let size = coarse.iter().map(|(slope, _)| slope.abs()).fold(0.0, f64::max);
    let windows = coarse.windows(5).enumerate().filter_map(|(k, five)| Some((roughness(five)?, k)));
    let mut windows: Vec<(f64, usize)> = windows.collect();
    assert!(windows.len() > STEPS / 3, "{} windows", windows.len());
    windows.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut jump: f64 = 0.0;
    for (_, start) in windows.into_iter().take(2) {
        let (mut from, mut width, mut rough) = (first + width * start as f64, width, 0.0);
        for _level in 0..9 {
            width /= 4.0;
            let fine = looks(from, width, 16);
            let windows = fine.windows(5).enumerate().filter_map(|(k, five)| Some((roughness(five)?, k)));
            let Some(worst) = windows.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            (rough, from) = (worst.0, from + width * worst.1 as f64);
        }
        jump = jump.max(rough);
    }
    jump / size
}

#[test]
fn slopes_have_no_jumps_where_facets_slide_over_each_other() {
    for slave in [0, 1] {
        for (distortion, allowed) in [(0.0, 1e-6), (0.2, 1e-4)] {
            let jump = largest_jump(distortion, slave);
            println!("slave {slave}, distortion {distortion}: jump {jump:.1e}");
            assert!(jump < allowed, "slave {slave}, distortion {distortion}: {jump:e}");
        }
    }
}
