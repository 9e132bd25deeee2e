//! Median times of what a state and its derivatives are made of: factorisation, product with F, state, adjoint,
//! tangents for 36 changes of the controls.
//!
//! The scene is Signorini (the paper's Example 5.1) at the flat start: total FETI runs on 12³ bricks in 2³ subdomains
//! and on 24³ bricks in 4³, direct condensation on 12³. "pair" is Hertz (Example 5.2) along the averaged normals of 12³
//! bricks below 9³: weights of the mortar and their derivatives are part of it. The last column is relative:
//! factorisations to one product with F, states and derivatives to a cold state with its adjoint.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::equilibrium::{Configuration, ContactProblem, TangentsOf};
use contact::scene::{Geometry, NormalKind, hertz, signorini};
use contact::tfeti::{DualOperator, TornOptions, TotalFeti};
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

fn shape(bricks: usize, subdomains: usize, kind: SolverKind) -> Result<ContactShape, Box<dyn Error>> {
    Ok(ContactShape::new(signorini()?.with_bricks([bricks; 3], [subdomains; 3]), kind)?)
}

/// Two bodies along true normals, whose grids do not match.
fn pair() -> Result<ContactShape, Box<dyn Error>> {
    let mut scene = hertz()?;
    scene.contacts[0].normal = NormalKind::Surface;
    if let Geometry::Block(upper) = &mut scene.bodies[1].geometry {
        (upper.bricks, upper.subdomains) = ([9; 3], [1; 3]);
    }
    Ok(ContactShape::new(scene, SolverKind::Newton)?)
}

fn print(size: &str, what: &str, seconds: f64, unit: f64) {
    println!("{size:7} {what:32} {:10.3} {:8.2}", 1e3 * seconds, seconds / unit);
}

/// State and derivatives by a solver, in units of cold state and adjoint.
fn derivatives(size: &str, shape: &ContactShape) -> Result<(), Box<dyn Error>> {
    let (problem, start, accuracy) = (shape.problem(), shape.start(), Accuracy::relative(1e-8)?);
    let state = shape.solve(&start, None, accuracy)?;
    let dual = Vector::from_element(problem.boundary.row_count, 1.0);
    let unit = |control: usize| (0..start.len()).map(|i| f64::from(u8::from(i == control))).collect::<Vec<f64>>();
    let changes: Vec<Vec<f64>> = (0..start.len()).map(unit).collect();
    let cold = median(|| shape.solve(&start, None, accuracy));
    let adjoint = median(|| shape.coderivative(&start, &state, &dual));
    print(size, "state, cold, to 1e-8", cold, cold + adjoint);
    print(size, "adjoint and shape derivative", adjoint, cold + adjoint);
    for (what, tolerance) in [("tangents to 1e-2", 1e-2), ("tangents to 1e-4", 1e-4), ("tangents to rounding", 0.0)] {
        let seconds =
            median(|| shape.contact_solver().tangents(&state.solution, &changes, TangentsOf::Contact, tolerance));
        print(size, what, seconds, cold + adjoint);
    }
    Ok(())
}

/// The parts of total FETI, in units of one product with F.
fn parts(size: &str, shape: &ContactShape) -> Result<(), Box<dyn Error>> {
    let problem = ContactProblem::new(shape.problem().scene.clone())?;
    let configuration = Configuration::new(&problem, shape.start().as_slice())?;
    let torn = TotalFeti::new(Arc::new(problem), TornOptions::default())?;
    let model = torn.model();
    let system = model.factorize(&configuration)?;
    let operator = DualOperator::new(model, &system);
    let rows = operator.gather(operator.loaded_displacement());
    let product = median(|| operator.apply(&rows));
    print(size, "product with F", product, product);
    print(size, "factorisation of all subdomains", median(|| model.factorize(&configuration)), product);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("{:7} {:32} {:>10} {:>8}", "", "", "ms", "units");
    for (bricks, subdomains) in [(12, 2), (24, 4)] {
        let (size, shape) = (format!("{bricks}/{subdomains}"), shape(bricks, subdomains, SolverKind::Newton)?);
        parts(&size, &shape)?;
        derivatives(&size, &shape)?;
    }
    derivatives("direct", &shape(12, 2, SolverKind::Direct)?)?;
    derivatives("pair", &pair()?)
}
