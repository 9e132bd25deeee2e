//! From a scene file to the scene and the settings of a run.

use crate::continuation::{self, FIELD};
use crate::conversion::{Parts, Sources, scene_of};
use crate::limit::limits;
use crate::load_case::{CaseScene, cases};
use crate::mesh_file;
use crate::quantity::{Details, Lookup};
use crate::report::reports;
use crate::{AccuracyName, MethodName, OptimizerSection, OutputSection, SceneFile};
use contact::communication::InProcess;
use contact::contact_objective::ContactObjective;
use contact::contact_shape::ContactShape;
use contact::cost::{Limit, PressureMeasure, Quantity, Reported};
use contact::equilibrium::{ContactProblem, FormErrors};
use contact::error::SceneError;
use contact::load_cases::{Bound, CasesCost, LoadCase, Over, Told, WeightedCase};
use contact::memory;
use contact::names::find;
use contact::scene::{Block, Scene};
use contact::solvers::{Processes, SolverKind, SolverPlan, Wanted};
use contact::tfeti::PreconditionerKind;
use exchange::gmsh::GmshMesh;
use std::path::Path;

/// The tolerance of an optimization with some limits.
fn usual_tolerance(limits: &[Limit]) -> f64 {
    if limits.iter().any(|limit| limit.quantity.is_of_shape()) { 1e-5 } else { 1e-7 }
}

/// A scene and how it is to be solved and optimized.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The scene.
    pub scene: Scene,
    /// Controls at the start, mm, where they are not those of the scene.
    pub start: Option<Vec<f64>>,
    /// What is minimised.
    pub objective: Quantity,
    /// The load cases, at least one; all that differ.
    pub cases: Vec<CaseScene>,
    /// How they are rated together.
    pub over: Over,
    /// The limits of what the shape leads to.
    pub limits: Vec<Limit>,
    /// What is told beside objective and limits.
    pub reports: Vec<Reported>,
    /// What proposes trial points.
    pub method: MethodName,
    /// The contact solver.
    pub solver: SolverKind,
    /// Its preconditioner.
    pub preconditioner: PreconditionerKind,
    /// Number of clusters of subdomains; none: every subdomain by itself.
    pub clusters: Option<usize>,
    /// Settings of the optimizer.
    pub optimizer: OptimizerSection,
    /// The case on each file of its continuation; empty without one, and for bricks.
    pub meshes: Vec<Case>,
    /// Predicted decrease, relative to the objective, at which an optimization ends.
    pub tolerance: f64,
    /// Outputs.
    pub output: OutputSection,
    /// What is to be said of the files of the scene before any work.
    pub notes: Vec<String>,
}

impl Case {
    /// Converts a scene file; files that it names are looked up beside it, in `folder`.
    ///
    /// # Errors
    /// [`SceneError`] naming the field, its value and what is allowed.
    pub fn new(file: &SceneFile, folder: &Path) -> Result<Self, SceneError> {
        Self::of_sources(file, &Sources { folder, mesh: &|name, unit| mesh_file::read(&folder.join(name), unit) })
    }

    /// As [`new`](Self::new), with a mesh in place of the file that the only body with a mesh names.
    ///
    /// # Errors
    /// As [`new`](Self::new); cells are named by their tags. [`SceneError::OutOfRange`] for several bodies with meshes
    /// and for none.
    pub fn with_mesh(file: &SceneFile, folder: &Path, mesh: &GmshMesh) -> Result<Self, SceneError> {
        let count = file.body.iter().filter(|body| body.mesh.is_some()).count();
        if count != 1 {
            return Err(SceneError::out_of_range("body", format!("{count} meshes"), "one body with a mesh"));
        }
        Self::of_sources(file, &Sources { folder, mesh: &|name, unit| mesh_file::convert(mesh, unit, name) })
    }

    fn of_sources(file: &SceneFile, sources: &Sources<'_>) -> Result<Self, SceneError> {
        let (Parts { scene, start, notes }, folder) = (scene_of(file, sources)?, sources.folder);
        scene.validate()?;
        continuation::check(&file.optimizer.continuation, file.optimizer.starts, &scene)?;
        let files =
            file.optimizer.continuation.iter().enumerate().filter_map(|(index, mesh)| Some((index, mesh.file()?)));
        let meshes = files.map(|mesh| on_mesh((file, folder), mesh, &scene)).collect::<Result<_, _>>()?;
        for (place, details) in stated(file) {
            details.check_bodies(&|name: &str| format!("{place}.{name}"), &scene)?;
        }
        let lookup = Lookup { base: base(&scene), folder };
        let field = |name: &str| format!("objective.{name}");
        let objective = file.objective.details.quantity(file.objective.quantity, (&field, false), &lookup)?;
        objective.check_differentiable("objective.quantity")?;
        check_wanted(&objective, &scene)?;
        let cases = cases(file, &scene)?;
        let names: Vec<&str> = file.case.iter().map(|case| case.name.trim()).collect();
        let of_first = |case: Option<String>| first_equal(case, &cases);
        let limits = limits(&file.limit, &names, &lookup)?.into_iter();
        let limits: Vec<Limit> = limits.map(|limit| Limit { case: of_first(limit.case), ..limit }).collect();
        let reports = reports(&file.report, &names, &lookup)?.into_iter();
        let reports = reports.map(|report| Reported { case: of_first(report.case), ..report }).collect();
        let tolerance = file.optimizer.tolerance.unwrap_or_else(|| usual_tolerance(&limits));
        let method = method(&objective, file.optimizer.method, cases.len() > 1 || !limits.is_empty())?;
        check_accuracy(&objective, file.optimizer.accuracy)?;
        Ok(Self {
            scene,
            start,
            objective,
            cases,
            over: file.objective.over,
            limits,
            reports,
            method,
            solver: file.solver.kind,
            preconditioner: file.solver.preconditioner,
            clusters: file.solver.clusters,
            optimizer: file.optimizer.clone(),
            meshes,
            tolerance,
            output: file.output.clone(),
            notes,
        })
    }

    /// The controls that the case starts from, mm.
    pub fn start_controls(&self) -> Vec<f64> {
        self.start.clone().unwrap_or_else(|| self.scene.start())
    }

    /// How every load case is to be solved.
    pub fn plans(&self, wanted: Wanted) -> impl Iterator<Item = SolverPlan> {
        let Self { preconditioner, clusters, solver: kind, .. } = *self;
        let scenes = self.cases.iter().map(|case| case.scene.clone());
        let cases = self.cases.len();
        scenes.map(move |scene| SolverPlan { scene, kind, preconditioner, clusters, form_errors: None, wanted, cases })
    }

    /// Θ over all load cases, with solvers that are prepared in some processes.
    ///
    /// # Errors
    /// As [`Processes::solver`] and [`ContactObjective::of_cases`].
    pub fn prepared(&self, wanted: Wanted, processes: &Processes) -> Result<ContactObjective, SceneError> {
        self.objective_of(self.plans(wanted), processes)
    }

    /// As [`prepared`](Self::prepared), with form errors in place of the controls, and Jacobians. The bending that
    /// fairness adds to Θ is left out: it is one of the controls.
    ///
    /// # Errors
    /// As [`prepared`](Self::prepared), and as [`FormErrors`] says.
    pub fn with_form_errors(&self, errors: &FormErrors, processes: &Processes) -> Result<ContactObjective, SceneError> {
        let around = |plan: SolverPlan| SolverPlan {
            scene: plan.scene.with_shapes(|shape| shape.fairness = 0.0),
            form_errors: Some(errors.clone()),
            ..plan
        };
        self.objective_of(self.plans(Wanted::Jacobians).map(around), processes)
    }

    fn objective_of(
        &self,
        plans: impl Iterator<Item = SolverPlan>,
        processes: &Processes,
    ) -> Result<ContactObjective, SceneError> {
        let case = |(case, plan): (&CaseScene, SolverPlan)| {
            let shape = ContactShape::by(processes.solver(plan)?);
            let quantity = self.objective.clone();
            Ok(LoadCase { name: case.name.clone(), weight: case.weight, shape, quantity })
        };
        let cases = self.cases.iter().zip(plans).map(case).collect::<Result<_, SceneError>>()?;
        ContactObjective::of_cases(cases, self.over, &self.limits, &self.reports)
    }

    /// What an optimization asks of the contact solver.
    pub fn wanted(&self) -> Wanted {
        match self.method {
            MethodName::Composite => Wanted::Jacobians,
            MethodName::Bundle => Wanted::States,
        }
    }

    /// Refuses a case that needs more memory than there is, or whose objective has no value on its mesh, without
    /// preparing a solver for it. What each of several processes needs is looked at when they begin the case.
    ///
    /// # Errors
    /// [`SceneError`] naming the field.
    pub fn check_ahead(&self, wanted: Wanted, processes: &Processes) -> Result<(), SceneError> {
        if processes.is_alone() {
            self.plans(wanted).try_for_each(|plan| memory::check(&plan, &InProcess))?;
        }
        self.cost().map(|_| ())
    }

    /// Θ over all load cases as a function of their outputs, with their limits and problems; no solver is prepared.
    ///
    /// # Errors
    /// As [`ContactProblem::new`] and [`CasesCost::new`].
    pub fn cost(&self) -> Result<(CasesCost, Vec<Bound>, Vec<ContactProblem>), SceneError> {
        let problem = |case: &CaseScene| ContactProblem::new(case.scene.clone());
        let problems = self.cases.iter().map(problem).collect::<Result<Vec<_>, SceneError>>()?;
        let weighted = |(case, problem): (_, _)| {
            let CaseScene { name, weight, .. }: &CaseScene = case;
            WeightedCase { name, weight: *weight, quantity: self.objective.clone(), problem }
        };
        let weighted = self.cases.iter().zip(&problems).map(weighted).collect::<Vec<_>>();
        let cost = CasesCost::new(&weighted, self.over, &self.limits)?;
        let named = self.cases.iter().map(|case| case.name.as_str()).zip(&problems).collect::<Vec<_>>();
        let bounds = Bound::all(&self.limits, &named)?;
        Told::all(&self.reports, &named)?;
        Ok((cost, bounds, problems))
    }

    /// A load case by its name, or that of an equal one; the only one of a scene without a name.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for an unknown name, and for none where there are several cases.
    pub fn named(&self, name: Option<&str>) -> Result<&CaseScene, SceneError> {
        let names = self.cases.iter().flat_map(|case| std::iter::once(&case.name).chain(&case.equal));
        let names: Vec<&str> = names.map(String::as_str).collect();
        match (name, self.cases.as_slice()) {
            (None, [only]) => Ok(only),
            (None, _) => Err(SceneError::out_of_range("--case", "missing", names.join(", "))),
            (Some(name), cases) => {
                let name = names[find("--case", name, names.iter().copied())?];
                let has = |case: &&CaseScene| case.name == name || case.equal.iter().any(|own| own == name);
                cases.iter().find(has).ok_or_else(|| SceneError::out_of_range("--case", name, names.join(", ")))
            }
        }
    }

    /// The case with changed blocks in all its scenes; a scene of a mesh stays as it is.
    #[must_use]
    pub fn with_blocks(mut self, change: impl Fn(&mut Block)) -> Self {
        self.scene = self.scene.with_blocks(&change);
        let changed = |case: CaseScene| CaseScene { scene: case.scene.clone().with_blocks(&change), ..case };
        self.cases = self.cases.into_iter().map(changed).collect();
        self
    }
}

/// Least corner and lengths of the base over which a file of numbers is given: that of the only optimized block.
fn base(scene: &Scene) -> Option<[[f64; 2]; 2]> {
    scene.shaped_block().map(|(block, _)| [block.corner, block.size])
}

/// The details of all quantities that a file states, with their places.
fn stated(file: &SceneFile) -> Vec<(String, &Details)> {
    let limits = file.limit.iter().enumerate().map(|(index, own)| (format!("limit[{index}]"), &own.details));
    let reports = file.report.iter().enumerate().map(|(index, own)| (format!("report[{index}]"), &own.details));
    std::iter::once(("objective".to_owned(), &file.objective.details)).chain(limits).chain(reports).collect()
}

/// Checks a wanted pressure at the grid of the optimized block, without a mesh.
fn check_wanted(objective: &Quantity, scene: &Scene) -> Result<(), SceneError> {
    let Quantity::Pressure(PressureMeasure::Deviation { wanted }) = objective else { return Ok(()) };
    let Some((block, heights)) = scene.shaped_block() else { return Ok(()) };
    let places = block.grid().places().map(|[x1, x2]| [x1, x2, heights.start]).collect::<Vec<_>>();
    wanted.at("objective.wanted.pressure", &places).map(|_| ())
}

/// The name of a case, or of the one that it is equal to and solved with.
fn first_equal(name: Option<String>, cases: &[CaseScene]) -> Option<String> {
    let name = name?;
    let first = cases.iter().find(|case| case.equal.contains(&name));
    Some(first.map_or(name, |case| case.name.clone()))
}

/// The method asked for, or the one that suits the objective: a single function of the state is an output like others
/// where several cases or limits go with it.
fn method(objective: &Quantity, asked: Option<MethodName>, has_more: bool) -> Result<MethodName, SceneError> {
    // The composite model knows kinks of functions of the pressures alone.
    let is_output = !objective.is_of_pressures() && !objective.is_of_shape();
    let has_unknown_kinks = is_output && !objective.is_smooth();
    let composite = !is_output || (has_more && !has_unknown_kinks);
    match asked {
        None if composite => Ok(MethodName::Composite),
        None => Ok(MethodName::Bundle),
        Some(MethodName::Composite) if has_unknown_kinks => {
            let allowed = "\"bundle\" with this objective, which has kinks: the composite model takes smooth functions and functions of the contact pressures";
            Err(SceneError::out_of_range("optimizer.method", "composite", allowed))
        }
        Some(method) => Ok(method),
    }
}

/// Accuracy on demand is relative to |Θ|, which says nothing about the forces where Θ comes near 0.
fn check_accuracy(objective: &Quantity, accuracy: AccuracyName) -> Result<(), SceneError> {
    if accuracy == AccuracyName::OnDemand && objective.can_vanish() {
        let allowed = "\"tightest\" with this objective: accuracy on demand is relative to the objective, which can reach or cross 0 here";
        return Err(SceneError::out_of_range("optimizer.accuracy", "on-demand", allowed));
    }
    Ok(())
}

/// The case on a file of the continuation. Its lattices have the extents of those of the scene, so that a control means
/// the same on all meshes.
///
/// # Errors
/// [`SceneError`] with the name of the file.
fn on_mesh(
    (file, folder): (&SceneFile, &Path),
    (index, name): (usize, &str),
    scene: &Scene,
) -> Result<Case, SceneError> {
    let mut own = file.clone();
    own.optimizer.continuation.clear();
    own.mesh_files_mut().for_each(|mesh| name.clone_into(mesh));
    let mut case = Case::new(&own, folder).map_err(|error| match error {
        error @ (SceneError::InFile { .. } | SceneError::File { .. }) => error,
        other => SceneError::InFile { file: format!("{FIELD}[{index}] = \"{name}\""), source: Box::new(other) },
    })?;
    for changed in std::iter::once(&mut case.scene).chain(case.cases.iter_mut().map(|case| &mut case.scene)) {
        for (body, model) in changed.bodies.iter_mut().zip(&scene.bodies) {
            if let (Some(own), Some(model)) = (&mut body.shape, &model.shape) {
                own.coordinates = model.coordinates;
            }
        }
    }
    Ok(case)
}
