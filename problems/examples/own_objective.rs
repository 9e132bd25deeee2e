//! An objective of your own on the contact state, for several load cases:
//! `cargo run --release -p problems --example own_objective`.
//!
//! The cost is the mean square of the friction traction, Σ|λ_T|²/A / ΣA in MPa², over the contact surface of the
//! paper's Example 5.2. It is summed over two load cases. `docs/plug_in_your_problem.md` explains the steps.

use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::scene::hertz;
use nonsmooth::verify::{self, Direction};
use nonsmooth::{
    BundleTrust, BundleTrustConfig, Cost, CostGradient, FnObjective, ReducedObjective, Report, StateSolver, Vector,
};
use std::error::Error;

/// The mean square of the friction traction.
struct Shear {
    /// Tributary area of every contact node at the start, mm²; projected areas do not change with the shape.
    areas: Vec<f64>,
}

impl Cost<ContactState> for Shear {
    fn value(&self, _control: &Vector, state: &ContactState) -> f64 {
        let terms = state.forces.tangential.iter().zip(&self.areas);
        terms.map(|(force, area)| force.iter().map(|f| f * f).sum::<f64>() / area).sum::<f64>()
            / self.areas.iter().sum::<f64>()
    }

    /// The dual of a state has one entry per contact row: the normal one of a node, then its tangential ones.
    fn gradient(&self, control: &Vector, state: &ContactState) -> CostGradient {
        let whole = self.areas.iter().sum::<f64>();
        let slope = |(force, area): (&[f64; 3], &f64)| force.map(|force| 2.0 * force / (area * whole));
        let tangential: Vec<[f64; 3]> = state.forces.tangential.iter().zip(&self.areas).map(slope).collect();
        let dual = Vector::from_vec(state.rows.pack(&vec![0.0; self.areas.len()], &tangential));
        CostGradient { control: Vector::zeros(control.len()), state: dual }
    }
}

/// The scene with all loads times a factor.
fn load_case(factor: f64) -> Result<ReducedObjective<ContactShape, Shear>, Box<dyn Error>> {
    let mut scene = hertz()?.with_bricks([4; 3], [2; 3]);
    let loads = scene.bodies.iter_mut().flat_map(|body| &mut body.loads);
    loads.for_each(|load| *load = load.scaled(factor));
    let shape = ContactShape::new(scene, SolverKind::Auto)?;
    let areas = shape.problem().start_rows().areas();
    Ok(ReducedObjective::new(shape, Shear { areas }))
}

/// Checks the subgradient, and minimises the sum over two load cases with the admissible set of the scene.
pub fn minimize() -> Result<Report, Box<dyn Error>> {
    let cases = [load_case(0.5)?, load_case(1.0)?];
    let shape = cases[0].solver();
    let start = shape.start();
    println!("{}", verify::taylor_test(&cases[1], &start, &Direction::Seeded(1), &[1e-3, 3e-4, 1e-4, 3e-5])?);
    let sum = FnObjective::new(start.len(), |control: &Vector| {
        let [first, second] = cases.each_ref().map(|case| {
            let state = case.solver().solve(control, None, nonsmooth::Accuracy::TIGHTEST)?;
            case.differentiate(control, &state)
        });
        let (first, second) = (first?, second?);
        Ok::<_, nonsmooth::OracleError>((first.value + second.value, first.subgradient + second.subgradient))
    });
    let config = BundleTrustConfig { first_step: Some(0.1), max_evaluations: 30, ..BundleTrustConfig::default() };
    let set = shape.problem().admissible.polyhedron().clone();
    Ok(BundleTrust::new(config)?.constraints(set).minimize(&sum, start)?)
}

#[allow(dead_code, reason = "a test includes this file and calls `minimize`")]
fn main() -> Result<(), Box<dyn Error>> {
    println!("{}", minimize()?);
    Ok(())
}
