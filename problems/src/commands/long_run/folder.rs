//! The folder of a run: what was asked for, so that the run can be continued from the folder alone.

use crate::commands::controls;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, file_error, json};
use crate::commands::loaded_scene::LoadedScene;
use contact::error::SceneError;
use nonsmooth::{Journal, Journaled, NonsmoothObjective, Vector};
use scene_file::{CounterSection, OptimizerSection, OutputSection, SceneFile, StartSection};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

const SCENE: &str = "scene.toml";
const START: &str = "start.json";
const REPORT: &str = "report.json";
/// What would be wrong beside another run.
const REPORTS: [&str; 5] = [REPORT, "report.html", "report.txt", "controls.json", "certificate.json"];

/// Folders of the two runs of a comparison.
pub const COMPARED: [&str; 2] = ["with_friction", "without_friction"];

/// A folder in which a run is kept.
#[derive(Debug)]
pub struct RunFolder {
    folder: Folder,
    /// Whether the run continues what the folder holds.
    resumed: bool,
}

impl RunFolder {
    /// The scene file of a run that is to be continued, with its path; `comparison` says that the run is a comparison, which
    /// keeps its optimizations in folders of their own.
    ///
    /// # Errors
    /// [`SceneError::File`] if the folder holds no run of this kind.
    pub fn scene(folder: &Path, comparison: bool) -> Result<(SceneFile, Option<PathBuf>), SceneError> {
        if !folder.join(SCENE).exists() || !folder.join(START).exists() {
            let reason = format!("holds no run to resume ({SCENE}, {START} and a journal)");
            return Err(file_error(folder, reason));
        }
        if COMPARED.iter().any(|part| folder.join(part).join(START).exists()) != comparison {
            let found = if comparison {
                "an optimization: continue it with optimize"
            } else {
                "a comparison: continue it with compare"
            };
            return Err(file_error(folder, format!("holds {found} --resume")));
        }
        let file = folder.join(SCENE);
        let mut scene = SceneFile::read(&file)?;
        scene.output.folder = Some(folder.display().to_string());
        Ok((scene, Some(file)))
    }

    /// Whether a folder holds a run, ended or not.
    pub fn is_one(folder: &Path) -> bool {
        folder.join(START).exists() && folder.join(SCENE).exists()
    }

    /// A folder for the results of another command, if one is asked for; refuses the folder of an optimization, whose report
    /// would be replaced.
    ///
    /// # Errors
    /// As [`Folder::with_room`].
    pub fn folder_for_results(path: Option<&str>) -> Result<Option<Folder>, SceneError> {
        let Some(path) = path.map(Path::new) else { return Ok(None) };
        if Self::is_one(path) {
            let reason = "holds an optimization, whose report would be replaced; --out takes another folder";
            return Err(file_error(path, reason));
        }
        Folder::with_room(path, 1).map(Some)
    }

    /// Prepares the folder for a run; `bytes` must fit into it.
    ///
    /// # Errors
    /// [`SceneError::File`] if the folder cannot be written to, or holds another run that has not ended.
    pub fn open(path: &str, bytes: u64, resumed: bool) -> Result<Self, SceneError> {
        let folder = Folder::with_room(Path::new(path), bytes)?;
        let this = Self { folder, resumed };
        if !resumed && !this.journals()?.is_empty() && !this.path(REPORT).exists() {
            let reason = "holds a run that has not ended; continue it with --resume, or remove the folder";
            return Err(file_error(Path::new(path), reason));
        }
        Ok(this)
    }

    /// Folders with a journal: this one, those of its stages, and those of the parts of a comparison.
    fn journals(&self) -> Result<Vec<PathBuf>, SceneError> {
        let failed = |error: std::io::Error| file_error(self.folder.path(), error);
        let mut found = vec![self.folder.path().to_owned()];
        found.extend(COMPARED.iter().map(|part| self.path(part)).filter(|part| part.exists()));
        for place in found.clone() {
            for entry in std::fs::read_dir(place).map_err(failed)? {
                let path = entry.map_err(failed)?.path();
                if path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("stage_")) {
                    found.push(path);
                }
            }
        }
        found.retain(|path| Journal::exists(path));
        Ok(found)
    }

    /// Whether the run continues what the folder holds.
    pub fn is_resumed(&self) -> bool {
        self.resumed
    }

    /// The initial controls of the run that the folder holds, which goes on from here with the limits of this scene.
    ///
    /// # Errors
    /// [`Failure`] if a file cannot be written or read.
    pub fn resume(&self, loaded: &LoadedScene, count: usize) -> Result<Vector, Failure> {
        // From here on a folder without report is that of a run that has not ended. What the run has found so far stays until
        // its end replaces it.
        self.remove_old(&REPORTS[..1])?;
        self.keep_scene(loaded.file.clone())?;
        Ok(controls::read(&self.path(START), count)?)
    }

    /// Begins another run, with its scene and its initial controls.
    ///
    /// # Errors
    /// [`Failure`] if a file cannot be written or read.
    pub fn begin(&self, loaded: &LoadedScene, initial_controls: &[f64]) -> Result<(), Failure> {
        // From here on a folder without report is that of a run that has not ended.
        self.remove_old(&REPORTS)?;
        // No journal may ever stand beside a scene that is not its own.
        let journals = self.journals()?;
        if !journals.is_empty() {
            eprintln!("warning: {}: the run that it held is replaced", self.folder.path().display());
        }
        for path in journals {
            Journal::remove(&path)?;
        }
        for part in COMPARED {
            self.remove_old(&[SCENE, START, REPORT].map(|file| format!("{part}/{file}")))?;
        }
        let mut scene = loaded.file.clone();
        self.keep_grids(&mut scene, loaded.folder())?;
        self.folder.replace(START, &json(initial_controls)?)?;
        self.keep_scene(scene)
    }

    /// Writes the scene file, without the folder: that is where the file lies, and a file that named it would send other
    /// commands there.
    fn keep_scene(&self, mut scene: SceneFile) -> Result<(), Failure> {
        scene.output.folder = None;
        self.folder.replace(SCENE, &scene.print()?)
    }

    /// Removes files of an earlier run, as far as there are any.
    fn remove_old(&self, names: &[impl AsRef<Path>]) -> Result<(), SceneError> {
        for name in names {
            let path = self.folder.path().join(name);
            match std::fs::remove_file(&path) {
                Err(error) if !matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                    return Err(file_error(&path, error));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Copies the grids that the scene names, and names the copies.
    fn keep_grids(&self, scene: &mut SceneFile, from: &Path) -> Result<(), Failure> {
        let copy = |file: &mut String, name: &str| {
            let path = from.join(&*file);
            let text = std::fs::read_to_string(&path).map_err(|error| file_error(&path, error))?;
            *file = name.to_owned();
            self.folder.replace(name, &text)
        };
        if let CounterSection::Grid { file } = &mut scene.counter_surface {
            copy(file, "counter_surface.csv")?;
        }
        if let StartSection::Grid { file } = &mut scene.surface.start {
            copy(file, "start.csv")?;
        }
        Ok(())
    }

    /// An objective with the journal of the run or of one of its stages.
    ///
    /// # Errors
    /// [`Failure::Input`] for a folder that cannot be written to, and for a journal that cannot be read or that is that of
    /// another scene.
    pub fn journaled<O: NonsmoothObjective>(&self, objective: O, stage: Option<&str>) -> Result<Journaled<O>, Failure> {
        Ok(Journaled::open(objective, self.place(stage), &self.identity(stage)?)?)
    }

    /// All that the objective depends on: the scene that the folder holds, and the stage.
    fn identity(&self, stage: Option<&str>) -> Result<String, Failure> {
        let scene = SceneFile::read(&self.path(SCENE))?;
        let scene = SceneFile { optimizer: OptimizerSection::default(), output: OutputSection::default(), ..scene };
        let text = serde_json::to_string(&scene).map_err(Failure::computation)?;
        Ok(stage.map_or_else(|| text.clone(), |stage| format!("{stage}: {text}")))
    }

    /// Number of evaluations that the journal of the run, or of one of its stages, holds.
    ///
    /// # Errors
    /// [`Failure::Input`] for a journal that cannot be read.
    pub fn evaluations(&self, stage: Option<&str>) -> Result<usize, Failure> {
        Ok(Journal::read(self.place(stage))?.map_or(0, |journal| journal.entries.len()))
    }

    /// Where the journal of the run, or of one of its stages, lies.
    fn place(&self, stage: Option<&str>) -> PathBuf {
        stage.map_or_else(|| self.folder.path().to_owned(), |stage| self.path(stage))
    }

    /// The folder for the files of the report.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}
