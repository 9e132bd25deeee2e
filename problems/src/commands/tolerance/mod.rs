//! `tolerance`: objective and limits over random form errors of the shaped faces: how good the shape must be made.

pub mod form_error;
pub mod options;
mod pages;
mod random_shapes;
mod statistics;

use crate::commands::controls;
use crate::commands::export::run::KeptRun;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, printed_with_files};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::solved_shape::ContactObjective;
use crate::commands::tolerance::form_error::{FORM_ERROR, FormError, Row};
use crate::commands::tolerance::random_shapes::random_shapes;
use crate::commands::tolerance::statistics::Measures;
use contact::equilibrium::{ContactProblem, FormErrors};
use contact::load_cases::CaseStates;
use nonsmooth::{Accuracy, StateSolver, Vector};

/// Number of shapes that are solved.
const STATES: usize = 20;

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let arguments = session.arguments;
    let options = &arguments.tolerance;
    let run = options.run.as_ref().map(|folder| KeptRun::open(folder, loaded)).transpose()?;
    let case = run.as_ref().and_then(|run| run.on_last_mesh.as_ref()).unwrap_or(&loaded.case);
    let (controls, shape) = match &run {
        Some(run) => run.shape(None).map(|(controls, origin)| (controls, origin.source))?,
        None => {
            let file = arguments.shape.controls.as_deref();
            let problem = ContactProblem::new(case.scene.clone())?;
            let controls = controls::load(&problem, case, ("--controls", file))?;
            let named = |file: &std::path::Path| format!("the controls in {}", file.display());
            (controls, file.map_or_else(|| "the start of the scene".to_owned(), named))
        }
    };
    let errors = FormErrors { controls: controls.as_slice().to_vec(), wavelength: options.wavelength };
    let objective = case.with_form_errors(&errors, &session.processes)?;
    let folder = match &options.run {
        Some(path) => Some(Folder::reopen(path, 1)?),
        None => Folder::of_command(case, arguments)?,
    };
    let abandon = |_: &Failure| folder.iter().filter(|_| run.is_none()).for_each(Folder::abandon);
    let found = form_error(&objective, errors, (shape, options)).inspect_err(abandon)?;
    let file = found.file()?;
    let printed = arguments.printed(found.text(), file.clone());
    printed_with_files(printed, arguments.json, folder.as_ref(), |folder| {
        folder.write(FORM_ERROR, &file)?;
        match &run {
            Some(_) => pages::renew(folder, &found),
            None => folder.write("report.html", pages::page(&found, loaded)?),
        }
    })
}

/// Rates random shapes by first derivatives, and solves some of them.
fn form_error(
    objective: &ContactObjective,
    FormErrors { controls, wavelength }: FormErrors,
    (shape, options): (String, &options::ToleranceOptions),
) -> Result<FormError, Failure> {
    let problem = objective.solver().problem();
    let nominal = Vector::zeros(problem.map.control_count());
    let states = objective.cases().solve(&nominal, None, Accuracy::TIGHTEST)?;
    let model = objective.first_order(&nominal, &states)?;
    let shapes = random_shapes(problem, options.amplitude, (options.samples, options.seed));
    let measures = Measures::new(objective, &nominal, &states);
    let rated = measures.rate(&model, &shapes);
    let start = objective.cases().warm_start(&states);
    let solve = |index: usize| {
        let states = objective.cases().solve(&shapes[index], Some(&start), Accuracy::TIGHTEST);
        let states: CaseStates = states.map_err(|error| match Failure::from(error) {
            Failure::Input(reason) => {
                Failure::Input(format!("--amplitude {}: {reason}; a smaller one is needed", options.amplitude))
            }
            other => other,
        })?;
        Ok((index, measures.of_states(&shapes[index], &states)))
    };
    let chosen = measures.chosen(&rated, STATES);
    let solved = chosen.into_iter().map(solve).collect::<Result<Vec<_>, Failure>>()?;
    let rows = measures.rows(&rated, options.amplitude, &solved);
    let allowed = rows.iter().all(Row::is_known).then(|| rated.allowed(options.amplitude));
    Ok(FormError {
        scene: problem.scene.name.clone(),
        shape,
        controls,
        amplitude: options.amplitude,
        wavelength,
        samples: options.samples,
        seed: options.seed,
        states: solved.len(),
        rows,
        allowed,
    })
}
