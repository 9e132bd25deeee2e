//! The shape of an optimization in its folder: the optimum, the best one so far, or that of any evaluation.

use crate::commands::controls::{self, Layout};
use crate::commands::export::files::Origin;
use crate::commands::failure::Failure;
use crate::commands::folder::{COMPARED, REPORT, SCENE, START, quoted};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::long_run::RunFolder;
use crate::commands::run_kind::RunKind;
use crate::commands::scene_difference::{Difference, differences, is_below};
use contact::error::SceneError;
use contact::scene::{Block, BodyScene, CounterSurface, Scene};
use contact::shape::{LatticeShape, ShapedFace};
use nonsmooth::journal::{Entry, RecordedAnswer};
use nonsmooth::{Journal, Vector};
use scene_file::optimization::{PlannedRun, last_begun, stages};
use scene_file::{Case, SceneFile, read_text};
use std::path::{Path, PathBuf};

/// The fields of a scene that make its surfaces.
const SURFACES: [&str; 8] = [
    "body.name",
    "body.unit",
    "body.block.corner",
    "body.block.size",
    "body.block.bottom",
    "body.block.top",
    "body.lattice",
    "contact.obstacle",
];
/// The fields of a lattice on which its surfaces do not depend: start, bounds, course.
const NO_SURFACE: [&str; 8] = [
    "body.lattice.start",
    "body.lattice.controls",
    "body.lattice.thickness",
    "body.lattice.slope",
    "body.lattice.volume",
    "body.lattice.fairness",
    "body.lattice.attempts",
    "body.lattice.displacement",
];
/// The fields of a scene on which the friction problem of a shape does not depend; the mesh may be that of a stage.
const NO_FRICTION_PROBLEM: [&str; 7] =
    ["name", "solver", "optimizer", "output", "objective", "body.block.bricks", "body.block.subdomains"];
/// The fields in which the scene of a run and that of a command may differ although they are the same problem.
const SETTINGS: [&str; 5] = ["name", "solver", "optimizer", "output", "body.mesh"];
/// Largest report that is read, bytes.
const LARGEST_REPORT: u64 = 256 << 20;

/// The folder of an optimization, ended or not, or of one of its parts: a mesh or a start.
pub struct KeptRun {
    folder: PathBuf,
    /// The folders of the journals that have been begun.
    parts: Vec<PathBuf>,
    kind: Kind,
    /// How its controls stand in files.
    layout: Layout,
    /// How its scene differs from that of the command in what makes a friction problem.
    pub differences: Vec<Difference>,
    /// The scene on the last of several meshes that was begun, if the command has the scene of the run.
    pub on_last_mesh: Option<Case>,
}

/// What the journals of a run are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// One run on one mesh.
    Single,
    /// A part of a run with several.
    Part,
    /// One journal per mesh, each going on where the one before ended.
    Meshes,
    /// One journal per start.
    Starts,
}

impl KeptRun {
    /// The run in a folder, whose surfaces must be those of the scene.
    ///
    /// # Errors
    /// [`Failure::Input`] for a folder without an optimization, for a comparison, and for a run of other surfaces.
    pub fn open(folder: &Path, loaded: &LoadedScene) -> Result<Self, Failure> {
        let refused = |reason: String| Err(Failure::Input(format!("--run {}: {reason}", folder.display())));
        if let Some(kind) = RunKind::of(folder)?.filter(|kind| *kind != RunKind::Optimization) {
            let parts = if kind == RunKind::Study { ["row_001", "row_002"] } else { COMPARED };
            let parts = parts.map(|part| folder.join(part).display().to_string());
            let words = format!("holds {}; name one of its optimizations, such as", kind.words());
            return refused(format!("{words} {}", parts.join(" or ")));
        }
        let whole = folder.parent().filter(|whole| !RunFolder::is_one(folder) && RunFolder::is_one(whole));
        let root = whole.filter(|_| Journal::exists(folder)).unwrap_or(folder);
        if !RunFolder::is_one(root) {
            return refused(format!("holds no optimization ({SCENE}, {START} and a journal)"));
        }
        let path = root.join(SCENE);
        let own = LoadedScene::new(SceneFile::read(&path)?, Some(path.clone()))?;
        let of_surface =
            differences(&own, loaded, |field| is_below(field, &SURFACES) && !is_below(field, &NO_SURFACE))?;
        // Of a coarse-to-fine optimization, each of its meshes.
        let other_mesh = || {
            let first = other_files(&own.case.scene, &loaded.case.scene)?;
            let other = |stage: &PlannedRun| other_files(&stage.case.scene, &loaded.case.scene).is_some();
            stages(&own.case).iter().all(other).then_some(first)
        };
        if let Some(difference) = of_surface.first().map(Difference::to_string).or_else(other_mesh) {
            let [scene, run] = [&path, folder].map(|path| quoted(path.display().to_string()));
            let hint = format!("take its own scene: contact3d {scene} export --run {run} --out DIR2");
            return refused(format!("is a run of another surface: {difference}; {hint}"));
        }
        let counts = |field: &str| !is_below(field, &NO_FRICTION_PROBLEM) && !is_below(field, &NO_SURFACE);
        let is_own = differences(&own, loaded, |field| !is_below(field, &SETTINGS))?.is_empty()
            && other_files(&own.case.scene, &loaded.case.scene).is_none();
        let mut differences = differences(&own, loaded, counts)?;
        let own = own.case;
        let last = last(&own, root, folder);
        differences.extend(other_bricks(&last.scene, &loaded.case.scene));
        let on_last_mesh = Some(last).filter(|_| is_own && !own.optimizer.continuation.is_empty());
        let (kind, parts) = if root == folder {
            let places = stages(&own)
                .into_iter()
                .map(|stage| stage.part.folder().map_or(root.to_owned(), |name| root.join(name)));
            let kind = match () {
                () if !own.optimizer.continuation.is_empty() => Kind::Meshes,
                () if own.optimizer.starts > 1 => Kind::Starts,
                () => Kind::Single,
            };
            let mut parts: Vec<PathBuf> = places.filter(|place| Journal::exists(place)).collect();
            // The whole run before its attempts.
            parts.sort_by_key(|place| place != root);
            (kind, parts)
        } else {
            (Kind::Part, vec![folder.to_owned()])
        };
        Ok(Self { folder: folder.to_owned(), parts, kind, layout: Layout::of(&own.scene), differences, on_last_mesh })
    }

    /// The shape of an evaluation, or the one that the run has found.
    ///
    /// # Errors
    /// [`Failure::Input`] for an evaluation that the run does not have or that does not tell which part is meant; any
    /// [`Failure`] of the files.
    pub fn shape(&self, evaluation: Option<usize>) -> Result<(Vector, Origin), Failure> {
        match evaluation {
            Some(evaluation) => self.evaluation(evaluation),
            None if self.kind != Kind::Part && self.folder.join(REPORT).exists() => self.optimum(),
            None => self.best(),
        }
    }

    /// The shape that an ended run reports.
    fn optimum(&self) -> Result<(Vector, Origin), Failure> {
        let controls = controls::read(&self.folder.join("controls.json"), self.layout)?;
        let report = read_text(&self.folder.join(REPORT), LARGEST_REPORT)?;
        let report: serde_json::Value = serde_json::from_str(&report).unwrap_or_default();
        let confirmed = report["termination"]["confirmed"] == true;
        let shape = if confirmed { "optimum" } else { "best shape" };
        let source = format!("the {shape} of {}", self.folder.display());
        Ok((controls, Origin { source, evaluation: None, objective: report["objective"].as_f64() }))
    }

    /// The best shape in the journals of a run that has not ended: of its last mesh, or of all its starts.
    fn best(&self) -> Result<(Vector, Origin), Failure> {
        let mut journals = Vec::new();
        for part in &self.parts {
            journals.extend(Journal::read(part)?.map(|journal| evaluated(&journal)).filter(|known| !known.is_empty()));
        }
        let count: usize = journals.iter().map(Vec::len).sum();
        let considered = if self.kind == Kind::Meshes {
            journals.len().saturating_sub(1)..journals.len()
        } else {
            0..journals.len()
        };
        let known = journals[considered].iter().flatten();
        let Some((value, entry)) = known.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            let words = "no evaluation has ended yet";
            return Err(Failure::Input(format!("--run {}: {words}", self.folder.display())));
        };
        let source = format!(
            "evaluation {}, the best of {count} in {}, {}",
            entry.evaluation,
            self.folder.display(),
            if self.kind == Kind::Part { "a part of a run" } else { "which has not ended" }
        );
        let origin = Origin { source, evaluation: Some(entry.evaluation), objective: Some(*value) };
        Ok((self.controls(entry)?, origin))
    }

    /// The controls of an evaluation.
    fn controls(&self, entry: &Entry) -> Result<Vector, SceneError> {
        let what = || format!("controls of evaluation {} in {}", entry.evaluation, self.folder.display());
        let expected = self.layout.count();
        if entry.point.len() != expected {
            return Err(SceneError::WrongCount { what: what(), expected, found: entry.point.len() });
        }
        match entry.point.iter().find(|height| !height.is_finite()) {
            Some(height) => Err(SceneError::out_of_range(what(), height, "finite numbers (mm)")),
            None => Ok(Vector::from_column_slice(&entry.point)),
        }
    }

    /// The shape of one evaluation.
    fn evaluation(&self, evaluation: usize) -> Result<(Vector, Origin), Failure> {
        if matches!(self.kind, Kind::Meshes | Kind::Starts) {
            let parts: Vec<String> = self.parts.iter().map(|part| format!("--run {}", part.display())).collect();
            let words = "is allowed for one mesh or one start of this run only";
            return Err(Failure::Input(format!("--evaluation {words}: {}", parts.join(" or "))));
        }
        let journal = Journal::read(self.parts.first().unwrap_or(&self.folder))?;
        let entries = journal.map(|journal| journal.entries).unwrap_or_default();
        let allowed = match entries.len() {
            0 => format!("none, for {} holds no evaluation yet", self.folder.display()),
            count => format!("1 to {count}, the evaluations in {}", self.folder.display()),
        };
        let outside = || SceneError::out_of_range("--evaluation", evaluation, allowed);
        let entry = evaluation.checked_sub(1).and_then(|index| entries.get(index)).ok_or_else(outside)?;
        let (objective, words) = match &entry.answer {
            RecordedAnswer::Evaluated { value, no_descent: false, .. } => (Some(*value), String::new()),
            RecordedAnswer::Evaluated { .. } => (None, ", known to be no descent".into()),
            RecordedAnswer::Failed(reason) => (None, format!(", which failed: {reason}")),
            _ => (None, String::new()),
        };
        let source = format!("evaluation {evaluation} of {}{words}", self.folder.display());
        Ok((self.controls(entry)?, Origin { source, evaluation: Some(evaluation), objective }))
    }
}

/// The case of a run, or of its part in a folder: of several meshes, the last one that was begun.
fn last(case: &Case, root: &Path, folder: &Path) -> Case {
    let of_folder = |stage: &PlannedRun| stage.part.folder().is_some_and(|name| root.join(name) == folder);
    let stage = if root == folder { last_begun(case, root) } else { stages(case).into_iter().find(of_folder) };
    stage.map_or_else(|| case.clone(), |stage| stage.case)
}

/// What differs in the surfaces of scenes whose files agree in their fields: heights and meshes of other files.
fn other_files(there: &Scene, here: &Scene) -> Option<String> {
    let obstacle = |scene: &Scene| scene.contacts.iter().map(|contact| contact.obstacle().cloned()).collect::<Vec<_>>();
    let faces = |body: &BodyScene| {
        let shaped = body.heights().and_then(LatticeShape::face);
        let faces = |block: &Block| {
            let face = |face, surface: &CounterSurface| (shaped != Some(face)).then(|| surface.clone());
            let faces = [face(ShapedFace::Bottom, &block.bottom), face(ShapedFace::Top, &block.top)];
            (block.corner, block.size, faces)
        };
        body.block().map(faces)
    };
    let meshes = |body: &BodyScene| if body.block().is_some() { None } else { Some(body.geometry.clone()) };
    let (bodies, others) = (&there.bodies, &here.bodies);
    if bodies.len() != others.len() {
        return Some(format!("it has {} bodies, this scene has {}", bodies.len(), others.len()));
    }
    if obstacle(there) != obstacle(here) || bodies.iter().map(faces).ne(others.iter().map(faces)) {
        return Some("the heights of an obstacle or of a face of a block differ".to_owned());
    }
    bodies.iter().map(meshes).ne(others.iter().map(meshes)).then(|| "the meshes differ".to_owned())
}

/// The bricks of blocks that a run has other than the scene of the command.
fn other_bricks(there: &Scene, here: &Scene) -> Vec<Difference> {
    let bricks = |body: &BodyScene| body.block().map_or_else(Vec::new, |block| block.bricks.to_vec());
    let field = |body: usize| format!("body[{body}].block.bricks");
    let pairs = there.bodies.iter().map(bricks).zip(here.bodies.iter().map(bricks)).enumerate();
    let found = pairs.filter(|(_, (there, here))| there != here);
    found.map(|(body, (there, here))| Difference::new(&field(body), there, here)).collect()
}

/// The evaluations of a journal whose value is known.
fn evaluated(journal: &Journal) -> Vec<(f64, Entry)> {
    let known = journal.entries.iter().filter_map(|entry| match entry.answer {
        RecordedAnswer::Evaluated { value, no_descent: false, .. } => Some((value, entry.clone())),
        _ => None,
    });
    known.collect()
}
