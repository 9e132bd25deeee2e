//! `verify`: Taylor test of the subgradient on the smooth piece around one shape.

use crate::commands::controls;
use crate::commands::facts::line;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json, printed_with_files};
use crate::commands::loaded_scene::Session;
use crate::commands::numbers::rounded;
use crate::commands::solved_shape::{self, ContactObjective};
use contact::body::mesh::smallest_extent;
use contact::equilibrium::Residuals;
use contact::load_cases::CaseStates;
use contact::solvers::Usage;
use nonsmooth::verify::{Direction, TaylorTest, taylor_test};
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::Case;
use serde::Serialize;

/// Seed of the direction.
pub const DIRECTION_SEED: u64 = 20_231;
/// Number of steps in the table.
const STEP_COUNT: i32 = 9;
/// Ratio of neighbouring steps: ten to the power −½.
const STEP_RATIO: f64 = 0.316_227_766_016_837_94;
/// Largest step tried, relative to the height of a block or to the smallest extent of a mesh.
const MAX_RELATIVE_STEP: f64 = 1e-3;
/// Number of times that the step is shortened in search of the smooth piece.
const MAX_SHORTENINGS: usize = 16;

/// The keys of the JSON of `verify`.
#[derive(Debug, Serialize)]
struct VerificationJson {
    #[serde(flatten)]
    test: TaylorTest,
    /// Largest step of the table, mm: no contact node changes its status over it, unless every step tried was too long.
    smooth_step: f64,
    smallest_margin: f64,
    weakly_active: usize,
    /// Certificates of the state that the test is made around.
    residuals: Residuals,
    #[serde(skip_serializing_if = "Option::is_none")]
    processes: Option<Usage>,
}

pub fn run(case: &Case, session: &Session<'_>) -> Result<String, Failure> {
    let (objective, arguments) = (&solved_shape::objective(case, &session.processes)?, session.arguments);
    let shape = objective.solver();
    let control = controls::load(shape.problem(), case, ("--controls", arguments.shape.controls.as_deref()))?;
    let folder = Folder::of_command(case, arguments)?;
    let found = smooth_taylor_test(objective, &control);
    let (states, step, test) = found.inspect_err(|_| folder.iter().for_each(Folder::abandon))?;
    let here = states.iter().min_by(|a, b| a.forces.kink.smallest_margin.total_cmp(&b.forces.kink.smallest_margin));
    let here = here.ok_or_else(|| Failure::computation("a scene has at least one case"))?;
    let result = VerificationJson {
        test,
        smooth_step: step,
        smallest_margin: here.forces.kink.smallest_margin,
        weakly_active: here.forces.kink.weakly_active,
        residuals: here.forces.residuals,
        processes: session.processes.usage(here.solver)?,
    };
    let object = json(&result)?;
    let text = lead(&result) + &result.test.to_string() + &rest(&result);
    let write = |folder: &Folder| {
        folder.write("verification.json", &object)?;
        folder.write("verification.txt", &text)
    };
    let printed = arguments.printed(text.clone(), object.clone());
    printed_with_files(printed, arguments.json, folder.as_ref(), write)
}

/// Whether the subgradient is right, and where that was tested: two lines.
fn lead(result: &VerificationJson) -> String {
    /// Least slope of the remainder of a right subgradient; a wrong one has 1.
    const LEAST_SLOPE: f64 = 1.5;
    let verdict = match result.test.fitted_slope {
        Some(slope) if slope >= LEAST_SLOPE => {
            format!(
                "the subgradient is right: the remainder falls with the power {slope:.3} of the step (right: 2, wrong: 1)"
            )
        }
        Some(slope) => format!(
            "the subgradient is wrong, or a kink is near: the remainder falls with the power {slope:.3} of the step (right: 2)"
        ),
        None => "nothing can be said of the subgradient: rounding hides the remainder".into(),
    };
    let (step, error) = (rounded(result.smooth_step, 2), rounded(result.test.best_derivative_error, 2));
    let where_from = format!("no contact node changes its status up to the step {step} mm");
    format!("{verdict}\n{where_from}; smallest relative error of the derivative {error}\n")
}

/// What the table of the test leaves out.
fn rest(result: &VerificationJson) -> String {
    let margin = rounded(result.smallest_margin, 2);
    let kink = format!("relative margin {margin}, {} nodes weakly active", result.weakly_active);
    let usage = result.processes.iter().map(|usage| line("processes", &usage.to_string()));
    let lines = [line("nearest kink", &kink), line("relative residuals", &result.residuals.to_string())];
    lines.into_iter().chain(usage).collect()
}

/// Taylor test of the subgradient at a shape on the smooth piece around it, with contact state and largest step.
pub fn smooth_taylor_test(
    objective: &ContactObjective,
    control: &Vector,
) -> Result<(CaseStates, f64, TaylorTest), Failure> {
    let direction = nonsmooth::verify::seeded_direction(control.len(), DIRECTION_SEED);
    let here = objective.cases().solve(control, None, Accuracy::TIGHTEST)?;
    let step = smooth_step(objective, control, &direction, &here)?;
    let test = taylor_test(objective, control, &Direction::Given(direction), &taylor_steps(step))?;
    Ok((here, step, test))
}

/// The steps of a Taylor table, from the largest down.
pub fn taylor_steps(largest: f64) -> Vec<f64> {
    (0..STEP_COUNT).map(|index| largest * STEP_RATIO.powi(index)).collect()
}

/// A step along the direction and against it that changes no contact status; the shortest step tried if there is none.
fn smooth_step(
    objective: &ContactObjective,
    control: &Vector,
    direction: &Vector,
    here: &CaseStates,
) -> Result<f64, Failure> {
    let problem = objective.solver().problem();
    let size = match problem.scene.heights() {
        Some(_) => control.iter().map(|height| height.abs()).sum::<f64>() / control.len() as f64,
        None => {
            let positions = problem.map.positions(control.as_slice());
            let shaped = problem.map.shaped_bodies().map(|body| smallest_extent(&positions[body]));
            shaped.fold(f64::INFINITY, f64::min)
        }
    };
    let mut step = MAX_RELATIVE_STEP * size;
    let stays = |step: f64| -> Result<bool, Failure> {
        let states = objective.cases().solve(&(control + direction * step), None, Accuracy::TIGHTEST)?;
        Ok(states.iter().zip(here.iter()).all(|(state, here)| state.forces.status == here.forces.status))
    };
    for _shortening in 0..MAX_SHORTENINGS {
        if stays(step)? && stays(-step)? {
            break;
        }
        step *= STEP_RATIO;
    }
    Ok(step)
}
