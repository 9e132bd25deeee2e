//! `verify`: Taylor test of the subgradient on the smooth piece around one shape.

use crate::commands::{Arguments, ContactObjective, Failure, Folder, controls, json};
use contact::equilibrium::{ContactStatus, Residuals};
use nonsmooth::verify::{Direction, TaylorTest, taylor_test};
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::Case;
use serde::Serialize;

/// Seed of the direction.
const SEED: u64 = 20_231;
/// Steps of the table.
const STEPS: usize = 9;
/// Ratio of neighbouring steps.
const RATIO: f64 = 0.316_227_766_016_837_94;
/// Largest step tried, relative to the height of the body.
const LARGEST_STEP: f64 = 1e-3;
/// Times the step is shortened in search of the smooth piece.
const SHORTENINGS: usize = 16;

/// What `verify` reports; the keys of its JSON.
#[derive(Debug, Serialize)]
struct Verified {
    #[serde(flatten)]
    test: TaylorTest,
    /// Largest step up to which no contact node changes its status.
    smooth_step: f64,
    smallest_margin: f64,
    weakly_active: usize,
    /// Certificates of the state that the test is made around.
    residuals: Residuals,
}

pub fn run(objective: &ContactObjective, case: &Case, arguments: &Arguments) -> Result<String, Failure> {
    let folder = Folder::for_results(case.output.folder.as_deref())?;
    let shape = objective.solver();
    let control = controls::load(shape, case, arguments.controls.as_deref())?;
    let direction = nonsmooth::verify::seeded_direction(control.len(), SEED);
    let here = shape.solve(&control, None, Accuracy::TIGHTEST)?;
    let step = smooth_step(objective, &control, &direction, &here.forces.status)?;
    let steps: Vec<f64> = (0..STEPS).map(|index| step * RATIO.powi(index as i32)).collect();
    let test = taylor_test(objective, &control, &Direction::Given(direction), &steps)?;
    let result = Verified {
        test,
        smooth_step: step,
        smallest_margin: here.forces.kink.smallest_margin,
        weakly_active: here.forces.kink.weakly_active,
        residuals: here.forces.residuals,
    };
    let json = json(&result)?;
    let text = format!(
        "{}no contact node changes its status up to the step {:.1e} mm (nearest kink: relative margin {:.1e}, {} nodes weakly active)\n\
         relative residuals of the state: {}\n",
        result.test, step, result.smallest_margin, result.weakly_active, result.residuals
    );
    if let Some(folder) = folder {
        let printed = if arguments.json { &json } else { &text };
        let written = folder.write("verification.json", &json).and_then(|()| folder.write("verification.txt", &text));
        written.map_err(|failure| failure.after(printed))?;
    }
    Ok(if arguments.json { json } else { text })
}

/// A step along which no contact node changes its status, to either side; the shortest one tried if all do.
pub fn smooth_step(
    objective: &ContactObjective,
    control: &Vector,
    direction: &Vector,
    status: &[ContactStatus],
) -> Result<f64, Failure> {
    let height = control.iter().map(|height| height.abs()).sum::<f64>() / control.len() as f64;
    let mut step = LARGEST_STEP * height;
    for _shortening in 0..SHORTENINGS {
        if same_piece(objective, control, direction, step, status)? {
            break;
        }
        step *= RATIO;
    }
    Ok(step)
}

/// Whether all contact nodes keep their status a step to either side.
fn same_piece(
    objective: &ContactObjective,
    control: &Vector,
    direction: &Vector,
    step: f64,
    status: &[ContactStatus],
) -> Result<bool, Failure> {
    for sign in [1.0, -1.0] {
        let state = objective.solver().solve(&(control + direction * (sign * step)), None, Accuracy::TIGHTEST)?;
        if state.forces.status != status {
            return Ok(false);
        }
    }
    Ok(true)
}
