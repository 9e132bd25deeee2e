//! Median times of what a state and its derivatives are made of: factorisation, product with F, state, adjoint, tangents for
//! 36 changes of the heights.
//!
//! Signorini at the flat start on 12³ bricks in 2³ subdomains and on 24³ bricks in 4³. The last column relates each time to
//! that of one product with F.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::equilibrium::{ContactProblem, ContactSolver};
use contact::scene::{Scene, signorini};
use contact::tfeti::{DualOperator, PreconditionerKind, TornSolver};
use nonsmooth::{Accuracy, Coderivative, StateSolver, Vector};
use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Least number of repetitions.
const MIN_CALLS: usize = 5;
/// Seconds after which no further repetition begins.
const MAX_SECONDS: f64 = 1.0;

/// Median seconds of a call.
fn median<T>(mut call: impl FnMut() -> T) -> f64 {
    let whole = Instant::now();
    let mut seconds = Vec::new();
    while seconds.len() < MIN_CALLS || whole.elapsed().as_secs_f64() < MAX_SECONDS {
        let clock = Instant::now();
        black_box(call());
        seconds.push(clock.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

fn measure(mesh: usize, subdomains: usize) -> Result<(), Box<dyn Error>> {
    let shape =
        ContactShape::new(Scene { mesh: [mesh; 3], subdomains: [subdomains; 3], ..signorini()? }, SolverKind::Newton)?;
    let (problem, start, accuracy) = (shape.problem(), shape.start(), Accuracy::relative(1e-8)?);
    let torn = TornSolver::new(Arc::new(ContactProblem::new(problem.scene.clone())?), PreconditionerKind::default())?;
    let model = torn.model();
    let blocks = problem.blocks(start.as_slice())?;
    let system = model.factorize(&blocks)?;
    let operator = DualOperator::new(model, &system);
    let rows = operator.gather(&operator.loaded_displacement());
    let state = shape.solve(&start, None, accuracy)?;
    let dual = Vector::from_element(problem.boundary.dual_dimension(), 1.0);
    let unit = |control: usize| (0..start.len()).map(|i| f64::from(u8::from(i == control))).collect::<Vec<f64>>();
    let changes: Vec<Vec<f64>> = (0..start.len()).map(|control| problem.height_map.heights(&unit(control))).collect();
    let tangents = |tolerance| median(|| shape.contact_solver().tangents(&state.solution, &changes, tolerance));

    let product = median(|| operator.apply(&rows));
    for (what, seconds) in [
        ("product with F", product),
        ("factorisation of all subdomains", median(|| model.factorize(&blocks))),
        ("state, cold, to 1e-8", median(|| shape.solve(&start, None, accuracy))),
        ("adjoint and shape derivative", median(|| shape.coderivative(&start, &state, &dual))),
        ("tangents to 1e-2", tangents(1e-2)),
        ("tangents to 1e-4", tangents(1e-4)),
        ("tangents to rounding", tangents(0.0)),
    ] {
        println!("{mesh:3}/{subdomains} {what:32} {:10.3} {:8.1}", 1e3 * seconds, seconds / product);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("{:5} {:32} {:>10} {:>8}", "N/S", "", "ms", "products");
    measure(12, 2)?;
    measure(24, 4)
}
