//! Fields of two shapes as VTK files: `cargo run --release -p problems --example fields -- FOLDER`, then open
//! `FOLDER/fields.pvd` in a viewer that reads VTK files.
//!
//! The shapes are the start of Example 5.2 of the paper and one after a single step down the subgradient.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::fields::Fields;
use contact::scene::hertz;
use nonsmooth::{Accuracy, CompositeObjective, OutputJacobian, StateSolver, Vector};
use problems::vtk_files::{FieldState, vtk_files};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name the folder to write to")?);
    let shape = ContactShape::new(hertz()?.with_bricks([8; 3], [2; 3]), SolverKind::Newton)?;
    let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
    let cost = PressureCost::new(measure, shape.problem())?;
    let start = shape.start();
    let objective = CompositeObjective::new(shape, cost);
    let (first, subgradient) = solved(&objective, &start)?;
    // A tenth of a millimetre at most.
    let moved = &start - subgradient.scale(0.1 / subgradient.amax());
    let (second, _) = solved(&objective, &moved)?;
    let states = [
        FieldState { time: 0.0, name: "start", fields: &first, notes: &[] },
        FieldState { time: 1.0, name: "moved", fields: &second, notes: &[] },
    ];
    std::fs::create_dir_all(&folder)?;
    for (name, text) in vtk_files(&states)? {
        std::fs::write(folder.join(&name), text)?;
        println!("{}", folder.join(name).display());
    }
    Ok(())
}

/// Fields with sensitivities, and the subgradient.
fn solved(
    objective: &CompositeObjective<ContactShape, PressureCost>,
    control: &Vector,
) -> Result<(Fields, Vector), Box<dyn Error>> {
    let shape = objective.solver();
    let state = shape.solve(control, None, Accuracy::TIGHTEST)?;
    let (positions, _) = shape.position_sensitivity(&state, &objective.cost_gradient(control, &state).state)?;
    let subgradient = Vector::from_vec(shape.problem().map.pull_back(&positions));
    let mut fields = shape.fields(&state)?;
    fields.contact.set_sensitivity(shape.problem(), &positions);
    println!("Θ = {:.6e}, largest pressure {:.0} MPa", objective.value(&state), shape.outputs(&state).max());
    Ok((fields, subgradient))
}
