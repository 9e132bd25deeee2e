//! Functions of the displacements at random shapes: gradients by adjoints against central differences, and against rows
//! by tangents of the displacements.

#![allow(dead_code, reason = "either binary uses a part of it")]

use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::cost::{Quantity, StateCost, StateGradient, StatePiece, StateView};
use contact::equilibrium::TangentsOf;
use contact::scene::Scene;
use nonsmooth::{Accuracy, Coderivative, StateSolver, Vector};

/// Shapes per scene and path.
pub const SHAPES: u64 = 20;
/// Steps of the central quotients, in units of `length`: a long one may lie across a kink, a short one drown in
/// rounding; a wrong gradient agrees with none.
const STEPS: [f64; 4] = [1e-5, 3e-5, 3e-6, 1e-6];
/// Largest difference of a central quotient and ⟨g, d⟩ over |g| |d|.
const OF_DIFFERENCES: f64 = 1e-6;
/// Largest difference of a row and a gradient over the size of the gradient.
const OF_ROWS: f64 = 1e-7;
/// Distance to the nearest kink, of the contact state or of the maximum, below which steps may cross it.
const NEAR_KINK: f64 = 1e-4;

/// What was found of one measure.
#[derive(Debug, Default, Clone)]
pub struct Tally {
    pub checked: usize,
    /// Shapes near a kink.
    pub skipped: usize,
    /// Largest number of pieces.
    pub pieces: usize,
    /// Largest errors of quotients and of rows.
    pub errors: [f64; 2],
}

fn unit_changes(count: usize) -> Vec<Vec<f64>> {
    (0..count).map(|k| (0..count).map(|i| f64::from(u8::from(i == k))).collect()).collect()
}

/// Derivatives of a function of a state by the controls, by an adjoint.
fn by_adjoint(shape: &ContactShape, at: &Vector, state: &ContactState, gradient: StateGradient) -> Vector {
    let gradient = gradient.pulled(shape.problem());
    gradient.control + shape.coderivative(at, state, &gradient.state).unwrap().element
}

/// Distance of the extreme value from the second one over the largest of both.
fn distance_of_pieces(pieces: &[StatePiece]) -> f64 {
    match pieces {
        [first, second, ..] => (first.value - second.value).abs() / first.value.abs().max(second.value.abs()),
        _ => f64::INFINITY,
    }
}

/// Checks measures at the shapes and along the directions that `case` has for seeds; `length`: how far shapes may
/// change, mm.
pub fn check(
    scene: &Scene,
    kind: SolverKind,
    measures: &[Quantity],
    length: f64,
    case: impl Fn(u64) -> [Vector; 2],
) -> Vec<Tally> {
    let shape = ContactShape::new(scene.clone(), kind).unwrap().with_displacements();
    let costs: Vec<StateCost> =
        measures.iter().map(|own| StateCost::new("limit", own, shape.problem()).unwrap().unwrap()).collect();
    let problem = shape.problem();
    let mut tallies = vec![Tally::default(); costs.len()];
    for seed in 0..SHAPES {
        let [at, direction] = case(seed);
        let solve = |at: &Vector| shape.solve(at, None, Accuracy::TIGHTEST).unwrap();
        let state = solve(&at);
        let view = StateView::of(&state);
        let changes = unit_changes(at.len());
        let tangents = shape.contact_solver().tangents(&state.solution, &changes, TangentsOf::Displacements, 0.0);
        let tangents = tangents.unwrap();
        let velocities = shape.problem().map.velocities(&changes);
        let pairs = STEPS.map(|step| [1.0, -1.0].map(|way| (step, solve(&(&at + &direction * (way * step * length))))));
        for ((cost, measure), tally) in costs.iter().zip(measures).zip(&mut tallies) {
            let pieces = cost.pieces(problem, view);
            tally.pieces = tally.pieces.max(pieces.len());
            let gradient = by_adjoint(&shape, &at, &state, cost.gradient(problem, view));
            assert_eq!(pieces.is_empty(), !cost.has_pieces());
            if let (Some(first), Some(last)) = (pieces.first(), pieces.last()) {
                assert!((first.value - cost.value(problem, view)).abs() <= 1e-12 * first.value.abs());
                let of_last = by_adjoint(&shape, &at, &state, last.gradient(problem));
                for (piece, gradient) in [(first, &gradient), (last, &of_last)] {
                    let row = Vector::from_vec(piece.row(&tangents, &velocities));
                    let error = (row - gradient).norm() / gradient.norm();
                    tally.errors[1] = tally.errors[1].max(error);
                    let slope = gradient.norm();
                    assert!(
                        error < OF_ROWS,
                        "{measure:?}, {kind:?}, shape {seed}: {error:.1e} of {slope:.1e}; {piece:?}"
                    );
                }
            }
            let near = state.forces.kink.smallest_margin.min(distance_of_pieces(&pieces));
            if near < NEAR_KINK {
                tally.skipped += 1;
                continue;
            }
            let (product, size) = (gradient.dot(&direction), gradient.norm() * direction.norm());
            let error = |[ahead, behind]: &[(f64, ContactState); 2]| {
                let values = [ahead, behind].map(|(_, state)| cost.value(problem, StateView::of(state)));
                ((values[0] - values[1]) / (2.0 * ahead.0 * length) - product).abs() / size
            };
            let error = pairs.iter().map(error).fold(f64::INFINITY, f64::min);
            tally.checked += 1;
            tally.errors[0] = tally.errors[0].max(error);
            assert!(error < OF_DIFFERENCES, "{measure:?}, {kind:?}, shape {seed}: {error:.1e}");
        }
    }
    tallies
}

/// Prints tallies of measures, and asserts that few shapes were left out.
pub fn conclude(name: &str, measures: &[Quantity], tallies: &[Tally]) {
    for (measure, tally) in measures.iter().zip(tallies) {
        let Tally { checked, skipped, pieces, errors } = tally;
        println!(
            "{name}, {measure:?}: {checked} shapes, {skipped} near kinks, at most {pieces} pieces; quotients {:.1e}, rows \
             {:.1e}",
            errors[0], errors[1]
        );
        assert!(*skipped <= SHAPES as usize / 5, "{name}, {measure:?}: {skipped} shapes near kinks");
    }
}
