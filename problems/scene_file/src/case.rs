//! From a scene file to the scene and the settings of a run.

use crate::bodies::body;
use crate::grid_file;
use crate::limit::limits;
use crate::load_case::{CaseScene, cases};
use crate::mesh_file::{self, MeshFile};
use crate::{
    AccuracyName, CounterSection, MeshBodySection, MethodName, Objective, OptimizerSection, OutputSection, SceneFile,
    SplineName, StartSection, SurfaceSection, UpperSection,
};
use contact::body::load_size;
use contact::body::mesh::{Mesh, bounding_box};
use contact::contact_objective::ContactObjective;
use contact::contact_shape::ContactShape;
use contact::cost::{Limit, Measure};
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::load_cases::{Bound, CasesCost, LoadCase, Over, WeightedCase};
use contact::names::find;
use contact::scene::{Blocks, BodyScene, CounterSurface, Geometry, MeshGeometry, Scene, UpperBody};
use contact::shape::{HeightShape, ShapeScene, SplineKind};
use contact::solvers::{Processes, SolverKind, SolverPlan, Wanted};
use contact::tfeti::PreconditionerKind;
use exchange::gmsh::GmshMesh;
use std::path::Path;
use std::sync::Arc;

/// Degree of the paper's B-splines.
const DEFAULT_DEGREE: usize = 3;

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
    pub objective: Objective,
    /// The load cases, at least one; all that differ.
    pub cases: Vec<CaseScene>,
    /// How they are rated together.
    pub over: Over,
    /// The limits of what the shape leads to.
    pub limits: Vec<Limit>,
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
        let parts = match &file.body {
            Some(body) => mesh_scene(file, body, folder, || mesh_file::read(&folder.join(&body.mesh), body.unit))?,
            None => block_scene(file, folder)?,
        };
        Self::of_parts(file, folder, parts)
    }

    /// As [`new`](Self::new), with a mesh in place of the file that `body.mesh` names.
    ///
    /// # Errors
    /// As [`new`](Self::new); cells are named by their tags.
    pub fn with_mesh(file: &SceneFile, folder: &Path, mesh: &GmshMesh) -> Result<Self, SceneError> {
        let body = required("body", file.body.as_ref(), "a table, for the body of the mesh")?;
        let mesh = || mesh_file::convert(mesh, body.unit, &body.mesh);
        Self::of_parts(file, folder, mesh_scene(file, body, folder, mesh)?)
    }

    fn of_parts(file: &SceneFile, folder: &Path, parts: Parts) -> Result<Self, SceneError> {
        let Parts { scene, start, notes } = parts;
        scene.validate()?;
        check_continuation(&file.optimizer, file.body.is_some())?;
        let objective = Objective::new(&file.objective, file.size, folder)?;
        if let (Objective::Deviation(wanted), Some(blocks)) = (&objective, scene.blocks()) {
            let height = scene.heights().map_or(0.0, |heights| heights.start_height);
            wanted.at(&blocks.grid().places().map(|[x1, x2]| [x1, x2, height]).collect::<Vec<_>>())?;
        }
        let cases = cases(file, &scene)?;
        let limits = limits(&file.limit, &file.case.iter().map(|case| case.name.trim()).collect::<Vec<_>>())?;
        let limits = limits.into_iter().map(|limit| of_first_equal(limit, &cases)).collect::<Vec<_>>();
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
            method,
            solver: file.solver.kind,
            preconditioner: file.solver.preconditioner,
            clusters: file.solver.clusters,
            optimizer: file.optimizer.clone(),
            tolerance,
            output: file.output.clone(),
            notes,
        })
    }

    /// What is minimised, on the mesh of a problem.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a formula that is not finite at a contact node, with the place.
    pub fn measure(&self, problem: &ContactProblem) -> Result<Measure, SceneError> {
        self.objective.measure(problem)
    }

    /// How every load case is to be solved.
    pub fn plans(&self, wanted: Wanted) -> impl Iterator<Item = SolverPlan> {
        let Self { preconditioner, clusters, solver: kind, .. } = *self;
        let scenes = self.cases.iter().map(|case| case.scene.clone());
        let cases = self.cases.len();
        scenes.map(move |scene| SolverPlan { scene, kind, preconditioner, clusters, wanted, cases })
    }

    /// Θ over all load cases, with solvers that are prepared in some processes.
    ///
    /// # Errors
    /// As [`Processes::solver`], [`Case::measure`] and [`ContactObjective::of_cases`].
    pub fn prepared(&self, wanted: Wanted, processes: &Processes) -> Result<ContactObjective, SceneError> {
        let case = |(case, plan): (&CaseScene, SolverPlan)| {
            let shape = ContactShape::by(processes.solver(plan)?);
            let measure = self.measure(shape.problem())?;
            Ok(LoadCase { name: case.name.clone(), weight: case.weight, shape, measure })
        };
        let cases = self.cases.iter().zip(self.plans(wanted)).map(case).collect::<Result<_, SceneError>>()?;
        ContactObjective::of_cases(cases, self.over, &self.limits)
    }

    /// Θ over all load cases as a function of their outputs, with their limits and problems; no solver is prepared.
    ///
    /// # Errors
    /// As [`ContactProblem::new`], [`Case::measure`] and [`CasesCost::new`].
    pub fn cost(&self) -> Result<(CasesCost, Vec<Bound>, Vec<ContactProblem>), SceneError> {
        let problem = |case: &CaseScene| ContactProblem::new(case.scene.clone());
        let problems = self.cases.iter().map(problem).collect::<Result<Vec<_>, SceneError>>()?;
        let weighted = |(case, problem): (_, _)| {
            let CaseScene { name, weight, .. }: &CaseScene = case;
            Ok(WeightedCase { name, weight: *weight, measure: self.measure(problem)?, problem })
        };
        let weighted = self.cases.iter().zip(&problems).map(weighted).collect::<Result<Vec<_>, SceneError>>()?;
        let cost = CasesCost::new(&weighted, self.over, &self.limits)?;
        let named = self.cases.iter().map(|case| case.name.as_str()).zip(&problems).collect::<Vec<_>>();
        let bounds = Bound::all(&self.limits, &named)?;
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
    pub fn with_blocks(mut self, change: impl Fn(&mut Blocks)) -> Self {
        self.scene = self.scene.with_blocks(&change);
        let changed = |case: CaseScene| CaseScene { scene: case.scene.clone().with_blocks(&change), ..case };
        self.cases = self.cases.into_iter().map(changed).collect();
        self
    }
}

/// A scene with what goes beside it.
struct Parts {
    scene: Scene,
    start: Option<Vec<f64>>,
    notes: Vec<String>,
}

/// A field that a scene of blocks, or of a mesh, must have.
fn required<'f, T>(field: &str, value: Option<&'f T>, allowed: &str) -> Result<&'f T, SceneError> {
    value.ok_or_else(|| SceneError::out_of_range(field, "missing", allowed))
}

/// The scene of blocks.
fn block_scene(file: &SceneFile, folder: &Path) -> Result<Parts, SceneError> {
    let block = "a table, for a block (or [body] with a mesh)";
    let size = *required("size", file.size.as_ref(), "the lengths of the base of a block (or [body] with a mesh)")?;
    let lower = required("lower", file.lower.as_ref(), block)?;
    let surface = required("surface", file.surface.as_ref(), block)?;
    let admissible = required("admissible", file.admissible.as_ref(), block)?;
    if file.lattice.is_some() {
        return Err(SceneError::out_of_range("lattice", "a table", "none for a block, which surface shapes"));
    }
    let control_points = surface.control_points;
    let (start_height, start) = start(&surface.start, size, control_points, folder)?;
    let upper = |upper: &UpperSection| {
        let body = body("upper", &upper.material, &upper.supports, &upper.loads)?;
        Ok::<_, SceneError>(UpperBody { body, top: upper.top })
    };
    let subdomains = file.mesh.subdomains.unwrap_or_else(|| file.mesh.bricks.map(default_subdomains));
    let scene = Scene {
        name: file.name.clone(),
        geometry: Geometry::Blocks(Blocks { size, bricks: file.mesh.bricks, subdomains }),
        lower: body("lower", &lower.material, &lower.supports, &lower.loads)?,
        upper: file.upper.as_ref().map(upper).transpose()?,
        counter_surface: counter_surface(&file.counter_surface, Some(size), folder)?,
        contact: file.contact.scene("top", file.friction, file.upper.is_some()),
        shape: ShapeScene::Heights(HeightShape {
            spline: spline(surface)?,
            control_points,
            bounds: admissible.bounds(),
            start_height,
            fairness: surface.fairness.as_ref().map_or(0.0, |fairness| fairness.weight),
        }),
    };
    Ok(Parts { scene, start, notes: Vec::new() })
}

/// The scene of a mesh.
fn mesh_scene(
    file: &SceneFile,
    body: &MeshBodySection,
    folder: &Path,
    mesh: impl FnOnce() -> Result<MeshFile, SceneError>,
) -> Result<Parts, SceneError> {
    for (field, given) in [
        ("size", file.size.is_some()),
        ("lower", file.lower.is_some()),
        ("upper", file.upper.is_some()),
        ("surface", file.surface.is_some()),
        ("admissible", file.admissible.is_some()),
    ] {
        if given {
            return Err(SceneError::out_of_range(
                field,
                "a value",
                "none beside [body], which has a mesh and a lattice",
            ));
        }
    }
    let MeshFile { mesh, mut notes } = mesh()?;
    let face = required("contact.face", file.contact.face.as_ref(), "the physical surface of the mesh that may touch")?;
    let lattice = required("lattice", file.lattice.as_ref(), "a table, for the shapes of a mesh")?;
    let lower = body.scene()?;
    notes.extend(doubts_of_unit(&mesh, &lower)?);
    let scene = Scene {
        name: file.name.clone(),
        lower,
        upper: None,
        counter_surface: counter_surface(&file.counter_surface, None, folder)?,
        contact: file.contact.scene(face, file.friction, false),
        shape: ShapeScene::Lattice(lattice.shape(&mesh)?),
        geometry: Geometry::Mesh(MeshGeometry { mesh: Arc::new(mesh), pieces: body.pieces }),
    };
    Ok(Parts { scene, start: None, notes })
}

/// Extents of a body, mm, outside which its unit is doubtful.
const USUAL_EXTENTS: [f64; 2] = [1.0, 2e4];
/// Nominal strain above which loads, unit or elastic constants are doubtful: linear elasticity ends before.
const USUAL_STRAIN: f64 = 0.05;

/// Signs of a mesh in another unit than the scene says: an unusual extent, and loads that strain the body too much.
fn doubts_of_unit(mesh: &Mesh, body: &BodyScene) -> Result<Vec<String>, SceneError> {
    let [least, most] = bounding_box(mesh.nodes());
    let mut extents = [0, 1, 2].map(|axis| most[axis] - least[axis]);
    extents.sort_by(f64::total_cmp);
    let mut doubts = Vec::new();
    if extents[2] < USUAL_EXTENTS[0] || extents[2] > USUAL_EXTENTS[1] {
        doubts.push(format!(
            "the body is {:.3e} mm long: is body.unit the unit of the mesh? (\"mm\", \"cm\", \"m\" or \"inch\")",
            extents[2]
        ));
    }
    let (load, section) = (load_size(mesh, &body.loads)?, extents[0] * extents[1]);
    let strain = load / section / body.material.young_modulus();
    if strain > USUAL_STRAIN {
        doubts.push(format!(
            "the loads, {load:.3e} N in all, over the section of the body, {section:.3e} mm^2, strain it by {:.1e} %: are \
             body.unit, the loads (N, MPa) and young_modulus (MPa) what they should be?",
            100.0 * strain
        ));
    }
    Ok(doubts)
}

/// 2 subdomains per edge, or, where 2 does not divide the bricks, the divisor that leaves closest to six bricks.
pub fn default_subdomains(bricks: usize) -> usize {
    if bricks.is_multiple_of(2) {
        return 2;
    }
    let divisors = (1..=bricks).filter(|count| bricks.is_multiple_of(*count));
    let distance = |count: &usize| {
        let bricks = (bricks / count) as f64 / 6.0;
        bricks.max(1.0 / bricks)
    };
    divisors.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1)
}

fn spline(section: &SurfaceSection) -> Result<SplineKind, SceneError> {
    match (section.spline, section.degree) {
        (SplineName::Bspline, degree) => Ok(SplineKind::BSpline(degree.unwrap_or(DEFAULT_DEGREE))),
        (SplineName::Bezier, None) => Ok(SplineKind::Bezier),
        (SplineName::Bezier, Some(degree)) => {
            Err(SceneError::out_of_range("surface.degree", degree, "no degree with surface.spline = \"bezier\""))
        }
    }
}

fn counter_surface(
    section: &CounterSection,
    base: Option<[f64; 2]>,
    folder: &Path,
) -> Result<CounterSurface, SceneError> {
    Ok(match section {
        &CounterSection::Plane { height } => CounterSurface::Plane { height },
        &CounterSection::Waves { base, first, second, period } => {
            CounterSurface::Waves { base, first, second, period, origin: [0.0; 2] }
        }
        &CounterSection::Sphere { apex, radius } => CounterSurface::Sphere { apex, radius, centre: [0.0; 2] },
        CounterSection::Grid { file, origin, size } => {
            let size = size.or(base);
            let size = *required("counter_surface.size", size.as_ref(), "the lengths of the grid along x1, x2 (mm)")?;
            let grid = grid_file::read(&folder.join(file), size, "mm")?;
            CounterSurface::Grid(grid.at(origin.unwrap_or_default()))
        }
        &CounterSection::TiltedPlane { point, normal } => CounterSurface::TiltedPlane { point, normal },
        &CounterSection::Ball { centre, radius, side } => CounterSurface::Ball { centre, radius, side },
        &CounterSection::Cylinder { point, axis, radius, side } => {
            CounterSurface::Cylinder { point, axis, radius, side }
        }
    })
}

/// Start height of the scene, and the controls where they differ from it.
fn start(
    section: &StartSection,
    size: [f64; 2],
    counts: [usize; 2],
    folder: &Path,
) -> Result<(f64, Option<Vec<f64>>), SceneError> {
    let sampled = |surface: CounterSurface| {
        let along = |axis: usize, index: usize| size[axis] * index as f64 / (counts[axis].max(2) - 1) as f64;
        let places = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
        places.map(|(i, j)| surface.height(along(0, i), along(1, j))).collect::<Vec<f64>>()
    };
    let controls = match section {
        &StartSection::Plane { height } => return Ok((height, None)),
        &StartSection::Waves { base, first, second, period } => {
            sampled(CounterSurface::Waves { base, first, second, period, origin: [0.0; 2] })
        }
        StartSection::Grid { file } => sampled(CounterSurface::Grid(grid_file::read(&folder.join(file), size, "mm")?)),
        StartSection::Controls { heights } => heights.clone(),
    };
    let expected = counts[0] * counts[1];
    if controls.len() != expected {
        return Err(SceneError::WrongCount { what: "surface.start.heights".into(), expected, found: controls.len() });
    }
    let mean = controls.iter().sum::<f64>() / expected as f64;
    Ok((mean, Some(controls)))
}

/// A limit of a case that is solved with an equal one, as a limit of that one.
fn of_first_equal(limit: Limit, cases: &[CaseScene]) -> Limit {
    let first = |name: &String| cases.iter().find(|case| case.equal.contains(name)).map(|case| case.name.clone());
    Limit { case: limit.case.as_ref().map(|name| first(name).unwrap_or_else(|| name.clone())), ..limit }
}

/// The method asked for, or the one that suits the objective: functions of the displacements are outputs like others
/// where several cases or limits go with them.
fn method(objective: &Objective, asked: Option<MethodName>, has_more: bool) -> Result<MethodName, SceneError> {
    let composite = !objective.is_of_displacements() || (has_more && !objective.has_unknown_kinks());
    match asked {
        None if composite => Ok(MethodName::Composite),
        None => Ok(MethodName::Bundle),
        Some(MethodName::Composite) if objective.has_unknown_kinks() => {
            let allowed = "\"bundle\" with this objective, a maximum over points: the composite model takes smooth functions and functions of the contact pressures";
            Err(SceneError::out_of_range("optimizer.method", "composite", allowed))
        }
        Some(method) => Ok(method),
    }
}

/// Accuracy on demand is relative to |Θ|, which says nothing about the forces where Θ comes near 0.
fn check_accuracy(objective: &Objective, accuracy: AccuracyName) -> Result<(), SceneError> {
    if accuracy == AccuracyName::OnDemand && objective.can_vanish() {
        let allowed = "\"tightest\" with this objective: accuracy on demand is relative to the objective, which can reach or cross 0 here";
        return Err(SceneError::out_of_range("optimizer.accuracy", "on-demand", allowed));
    }
    Ok(())
}

fn check_continuation(optimizer: &OptimizerSection, is_mesh: bool) -> Result<(), SceneError> {
    let meshes = &optimizer.continuation;
    if is_mesh && !meshes.is_empty() {
        let value = format!("{meshes:?}");
        return Err(SceneError::out_of_range("optimizer.continuation", value, "[] with [body]: a mesh is one mesh"));
    }
    if optimizer.starts > 1 && !meshes.is_empty() {
        return Err(SceneError::out_of_range("optimizer.starts", optimizer.starts, "1 with optimizer.continuation"));
    }
    match meshes.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => Err(SceneError::out_of_range(
            "optimizer.continuation",
            pair[1],
            format!("growing meshes, here > {}", pair[0]),
        )),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tearing_of_meshes_that_two_does_not_divide() {
        assert_eq!([12, 35, 25, 9, 7, 13, 1].map(default_subdomains), [2, 5, 5, 1, 1, 1, 1]);
    }
}
