//! Contact scenes as objectives: Θ, its subgradient, pressures and statuses at a shape, and the optimal shape.

use crate::contact_mesh::MeshArrays;
use crate::contact_run::optimize;
use crate::contact_state::{StateArrays, in_words};
use crate::convert;
use crate::errors::failed;
use crate::failure::Failure;
use crate::outcome::RunOutcome;
use crate::run::signal;
use crate::setup::Setup;
use contact::contact_objective::ContactObjective;
use contact::cost::LimitSide;
use contact::error::SceneError;
use contact::fields::Fields;
use contact::load_cases::CaseStates;
use contact::plausibility::Warning;
use contact::solvers::{Processes, Wanted};
use nonsmooth::interruption::watched;
use nonsmooth::{Accuracy, OracleError, StateSolver, Vector};
use numpy::PyArrayDyn;
use problems::commands::{look_page, raised, solved_page};
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use scene_file::{AccuracyName, Case, FILES, SceneFile, read_text, set_field};
use std::path::Path;
use std::sync::OnceLock;

/// Largest scene file, bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// A scene, with the solver of its contact problem once it is needed.
#[pyclass(frozen, module = "nonsmooth._engine")]
#[derive(Debug)]
pub struct ContactScene {
    file: SceneFile,
    case: Case,
    objective: OnceLock<ContactObjective>,
}

fn input(error: SceneError) -> PyErr {
    match error {
        SceneError::File { .. } => PyOSError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

fn computation(error: OracleError) -> PyErr {
    match error {
        OracleError::Input(error) => crate::errors::input(error),
        OracleError::OutsideDomain { reason } => crate::errors::OutsideDomain::new_err(reason),
        error => PyRuntimeError::new_err(error.to_string()),
    }
}

/// Shapes that the admissible set refuses lie outside the domain of Θ, as for the commands.
fn shape(error: SceneError) -> PyErr {
    match error {
        SceneError::NotAdmissible { .. } => crate::errors::OutsideDomain::new_err(error.to_string()),
        error => input(error),
    }
}

/// Writes a first scene for a mesh beside it; the path of the scene.
#[pyfunction]
pub fn new_scene(mesh: std::path::PathBuf) -> PyResult<std::path::PathBuf> {
    problems::commands::new_scene(&mesh).map_err(failed)
}

/// Sets fields of a table by their paths, whole tables included, as the option --set does; null removes one.
fn replace(table: &mut toml::Table, fields: serde_json::Map<String, serde_json::Value>) -> PyResult<()> {
    for (path, value) in fields {
        let value = (!value.is_null()).then(|| toml::Value::try_from(value)).transpose();
        let value = value.map_err(|error| PyValueError::new_err(format!("{path}: {error}")))?;
        set_field(table, &path, value).map_err(input)?;
    }
    Ok(())
}

#[pymethods]
impl ContactScene {
    /// The scene of a file, or of none, with fields changed: a JSON object of the form of the file. A mesh, if there is
    /// one, takes the place of the file that the scene names.
    #[new]
    fn new(path: Option<&str>, fields: &str, mesh: Option<MeshArrays<'_>>) -> PyResult<Self> {
        let name = path.unwrap_or("scene");
        let bad = |error: &dyn std::fmt::Display| PyValueError::new_err(format!("{name}: {error}"));
        let mut table = match path {
            Some(path) => toml::from_str(&read_text(Path::new(path), LARGEST_FILE).map_err(input)?)
                .map_err(|error| bad(&error))?,
            None => toml::Table::new(),
        };
        replace(&mut table, serde_json::from_str(fields).map_err(|error| bad(&error))?)?;
        let mesh = mesh.map(|mesh| mesh.mesh()).transpose()?;
        if mesh.is_some() {
            let [.., name] = FILES;
            let bodies = table.entry("body").or_insert_with(|| vec![toml::Table::new()].into());
            let bodies = bodies.as_array_mut().map_or(&mut [][..], Vec::as_mut_slice);
            let [toml::Value::Table(body)] = bodies else {
                let allowed = "a scene of one body, whose mesh it is; several bodies have files";
                return Err(input(SceneError::out_of_range("mesh", format!("{} bodies", bodies.len()), allowed)));
            };
            body.insert("mesh".into(), (*name).into());
        }
        let text = toml::to_string(&table).map_err(|error| bad(&error))?;
        let file = SceneFile::parse(&text, name).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let folder = path.and_then(|path| Path::new(path).parent()).unwrap_or(Path::new(""));
        let case = match &mesh {
            None => Case::new(&file, folder),
            Some(mesh) => Case::with_mesh(&file, folder, mesh),
        };
        let case = case.map_err(input)?;
        Ok(Self { file, case, objective: OnceLock::new() })
    }

    /// The scene as a complete commented file.
    fn toml(&self) -> PyResult<String> {
        self.file.print().map_err(input)
    }

    /// The scene before any solve, as an HTML page.
    fn look(&self, py: Python<'_>) -> PyResult<String> {
        let text = self.toml()?;
        py.detach(|| look_page(&self.case, &text)).map_err(failed)
    }

    /// The start and the shape of some controls, solved, as an HTML page.
    fn solved_page(&self, py: Python<'_>, controls: &Bound<'_, PyAny>) -> PyResult<String> {
        let controls = convert::vector(controls, "controls", Some(self.case.scene.control_count()))?;
        let objective = self.objective(py)?;
        objective.solver().problem().admissible.check_shape(&controls).map_err(shape)?;
        let start = Vector::from_vec(self.case.start_controls());
        let failure = Failure::default();
        let watch = failure.clone();
        let pages = || solved_page(objective, &[("start", &start), ("shape", &controls)]);
        let page = py.detach(|| watched(move || signal(&watch), pages));
        match failure.take() {
            Some(error) => Err(error),
            None => page.map_err(failed),
        }
    }

    /// Name of the scene.
    #[getter]
    fn name(&self) -> String {
        self.case.scene.name.clone()
    }

    /// What is to be said of the meshes of the scene before any work.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.case.notes.clone()
    }

    /// Whether the controls are heights of a surface; else they are displacements of the control points of a lattice.
    #[getter]
    fn has_heights(&self) -> bool {
        self.case.scene.heights().is_some()
    }

    /// Shape of arrays of the controls: control points along x₁ and x₂, or the number of controls.
    #[getter]
    fn control_shape(&self) -> Vec<usize> {
        let scene = &self.case.scene;
        scene.heights().map_or_else(|| vec![scene.control_count()], |heights| heights.control_points[..2].to_vec())
    }

    /// Controls at the start, mm.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        convert::shaped(py, self.case.start_controls(), &self.control_shape())
    }

    /// Θ, its subgradient, and the state at controls in row-major order; with its fields and warnings if asked for,
    /// else with the limits as constraints.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        controls: &Bound<'py, PyAny>,
        checks: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let controls = convert::vector(controls, "controls", Some(self.case.scene.control_count()))?;
        let objective = self.objective(py)?;
        let solver = objective.solver();
        solver.problem().admissible.check_shape(&controls).map_err(shape)?;
        let solve = || {
            let states = objective.cases().solve(&controls, None, Accuracy::TIGHTEST)?;
            let evaluation = match checks {
                true => objective.differentiate(&controls, &states)?,
                false => objective.differentiate_with_limits(&controls, &states)?,
            };
            let checked = |case: usize| {
                let shape = objective.cases().case(case);
                Ok::<_, OracleError>((shape.warnings(&states[case])?, shape.fields(&states[case])?))
            };
            let checked = if checks { (0..states.len()).map(checked).collect::<Result<Vec<_>, _>>()? } else { vec![] };
            Ok((states, evaluation, checked))
        };
        let failure = Failure::default();
        let watch = failure.clone();
        let solved = py.detach(|| watched(move || signal(&watch), solve));
        let (states, evaluation, checked) = match (solved, failure.take()) {
            (_, Some(error)) => return Err(error),
            (solved, None) => solved.map_err(computation)?,
        };
        let result = PyDict::new(py);
        result.set_item("value", evaluation.value)?;
        let gradient = convert::shaped(py, evaluation.subgradient.as_slice().to_vec(), &self.control_shape())?;
        result.set_item("gradient", gradient)?;
        if checked.is_empty() {
            let limits = evaluation.constraints.as_ref();
            let (count, rows) = limits.map_or((0, None), |limits| (limits.values.len(), Some(&limits.jacobian)));
            let entry = |i: usize, j: usize| rows.map_or(0.0, |rows| rows[(i, j)]);
            result.set_item("limits", convert::array2(py, count, controls.len(), entry)?)?;
            let values = limits.map_or_else(|| Vector::zeros(0), |limits| limits.values.clone());
            result.set_item("limit_values", convert::array(py, &values))?;
            return Ok(result);
        }
        result.set_item("root", objective.root())?;
        result.set_item("unit", raised(&objective.unit()))?;
        result.set_item("norm_in_mpa", objective.norm_in_mpa(evaluation.value))?;
        result.set_item("error_bound", evaluation.error_bound)?;
        set_cases(&result, objective, &states, &checked)?;
        set_limits(&result, objective, &controls, &states)?;
        set_reports(&result, objective, &controls, &states)?;
        Ok(result)
    }

    /// The admissible controls: bounds, rows, sides of the rows; and of every limit, whether it is an equality.
    fn constraints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let objective = self.objective(py)?;
        let set = objective.solver().problem().admissible.polyhedron();
        let result = PyDict::new(py);
        let equal: Vec<bool> = objective.limits().map(|limit| limit.side == LimitSide::Equal).collect();
        result.set_item("limits", equal)?;
        result.set_item("lower", convert::array(py, set.lower()))?;
        result.set_item("upper", convert::array(py, set.upper()))?;
        let rows = set.rows();
        result.set_item("rows", convert::array2(py, rows.nrows(), rows.ncols(), |i, j| rows[(i, j)])?)?;
        result.set_item("row_lower", convert::array(py, set.row_lower()))?;
        result.set_item("row_upper", convert::array(py, set.row_upper()))?;
        Ok(result)
    }

    /// The settings of the scene's optimizer as options of the package, as JSON.
    fn options(&self) -> PyResult<String> {
        let optimizer = &self.case.optimizer;
        let accuracy = match optimizer.accuracy {
            AccuracyName::Tightest => "tightest",
            AccuracyName::OnDemand => "on_demand",
        };
        crate::convert::json(&serde_json::json!({
            "max_evaluations": optimizer.max_evaluations,
            "tolerance": self.case.tolerance,
            "max_seconds": optimizer.time_limit,
            "first_step": optimizer.first_step,
            "bundle_size": optimizer.bundle_size,
            "accuracy": accuracy,
        }))
    }

    /// Minimises Θ from the start of the setup; settings that it leaves open are those of the scene. As
    /// [`crate::run::minimize`].
    fn optimize<'py>(
        &self,
        py: Python<'py>,
        setup: Setup,
    ) -> PyResult<(Option<RunOutcome>, Option<Bound<'py, PyAny>>)> {
        optimize(py, &self.case, &setup)
    }
}

/// Adds the states of all cases by their names, and that of the worst case at the top.
fn set_cases(
    result: &Bound<'_, PyDict>,
    objective: &ContactObjective,
    states: &CaseStates,
    checked: &[(Vec<Warning>, Fields)],
) -> PyResult<()> {
    let py = result.py();
    let (worst, weighted) = (objective.worst(states), objective.weighted_values(states));
    let cases = PyDict::new(py);
    for (case, (warnings, fields)) in checked.iter().enumerate() {
        let (own, state) = (PyDict::new(py), &states[case]);
        let problem = objective.cases().case(case).problem();
        for result in [Some(&own), Some(result).filter(|_| case == worst)].into_iter().flatten() {
            result.set_item("warnings", in_words(warnings))?;
            result.set_item("total_force", state.forces.total_normal_force())?;
            result.set_item("residual", state.forces.residuals.largest())?;
            result.set_item("weakly_active", convert::json(&state.forces.kink)?)?;
            StateArrays { problem, fields, forces: &state.forces }.set(result)?;
        }
        own.set_item("weighted_value", weighted[case])?;
        cases.set_item(objective.cases().name(case), own)?;
    }
    result.set_item("cases", cases)
}

/// Adds the limits with the values of their quantities.
fn set_limits(
    result: &Bound<'_, PyDict>,
    objective: &ContactObjective,
    controls: &Vector,
    states: &CaseStates,
) -> PyResult<()> {
    let limits = PyList::empty(result.py());
    for (limit, value) in objective.limits().zip(objective.limited_values(controls, states)) {
        let own = PyDict::new(result.py());
        own.set_item("quantity", limit.quantity.name())?;
        own.set_item("case", limit.case.clone())?;
        own.set_item(limit.side.name(), limit.bound)?;
        own.set_item("value", value)?;
        own.set_item("violation", limit.excess(value))?;
        limits.append(own)?;
    }
    result.set_item("limits", limits)
}

/// Adds the quantities that the scene reports.
fn set_reports(
    result: &Bound<'_, PyDict>,
    objective: &ContactObjective,
    controls: &Vector,
    states: &CaseStates,
) -> PyResult<()> {
    let reports = PyList::empty(result.py());
    for (report, value) in objective.reported(controls, states) {
        let own = PyDict::new(result.py());
        own.set_item("quantity", report.quantity.name())?;
        own.set_item("label", report.label.clone())?;
        own.set_item("case", report.case.clone())?;
        own.set_item("unit", raised(&report.quantity.unit()))?;
        own.set_item("value", value)?;
        reports.append(own)?;
    }
    result.set_item("reports", reports)
}

impl ContactScene {
    fn objective_for(&self, wanted: Wanted) -> Result<ContactObjective, SceneError> {
        self.case.prepared(wanted, &Processes::alone())
    }

    /// Θ for single shapes, prepared at the first call.
    fn objective(&self, py: Python<'_>) -> PyResult<&ContactObjective> {
        if self.objective.get().is_none() {
            let built = py.detach(|| self.objective_for(Wanted::States)).map_err(input)?;
            // Another thread may have been first; its solver is the same.
            let _first = self.objective.set(built);
        }
        self.objective.get().ok_or_else(|| PyRuntimeError::new_err("the contact solver was not prepared"))
    }
}
