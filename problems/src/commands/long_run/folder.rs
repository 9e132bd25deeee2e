//! The folder of a run: what was asked for, so that the run can be continued from the folder alone.

use crate::commands::controls::{self, Layout};
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, REPORT, SCENE, START, file_error, json, resume_command};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::register::JOURNAL;
use crate::commands::run_kind::{RUN, RunKind};
use contact::error::SceneError;
use nonsmooth::{Journal, JournalError, Journaled, NonsmoothObjective, Vector};
use scene_file::optimization::stages;
use scene_file::{OptimizerSection, OutputSection, SceneFile};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A folder in which a run is kept.
#[derive(Debug)]
pub struct RunFolder {
    /// The folder for the files of the report.
    pub folder: Folder,
    /// What the objective depends on.
    identity: Identity,
    /// The controls that the run starts from.
    pub initial_controls: Vector,
    /// Whether the run continues what the folder holds.
    pub resumed: bool,
    /// Whether another version of the program may continue.
    new_version: bool,
}

/// The name of an objective in its journal: all that its values depend on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Identity {
    /// Version of the program.
    version: String,
    /// The mesh of a coarse-to-fine optimization.
    stage: Option<String>,
    /// Hashes of the start and of the files that the scene names.
    contents: BTreeMap<String, String>,
    scene: SceneFile,
}

impl Identity {
    fn new(loaded: &LoadedScene, initial_controls: &[f64]) -> Result<Self, Failure> {
        let mut scene = loaded.file.clone();
        let mut contents = BTreeMap::from([(START.to_owned(), hash(json(initial_controls)?.as_bytes()))]);
        // The start is known by its controls.
        for lattice in scene.body.iter_mut().filter_map(|body| body.lattice.as_mut()) {
            (lattice.start, lattice.controls) = (None, None);
        }
        for (name, file) in scene.files_mut() {
            contents.insert(name.to_owned(), hash(&content(loaded, file)?));
            *file = name;
        }
        (scene.optimizer, scene.output) = (OptimizerSection::default(), OutputSection::default());
        Ok(Self { version: env!("CARGO_PKG_VERSION").to_owned(), stage: None, contents, scene })
    }

    fn text(&self) -> Result<String, Failure> {
        serde_json::to_string(self).map_err(Failure::computation)
    }
}

/// 64 bits that tell contents apart (FNV-1a), the same on every machine and with every compiler.
fn hash(bytes: &[u8]) -> String {
    let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix))
}

impl RunFolder {
    /// The scene file of a run that is to be continued, with its path. Comparisons and studies keep their optimizations
    /// in folders of their own.
    ///
    /// # Errors
    /// [`SceneError::File`] if the folder holds no run of this kind.
    pub fn scene(folder: &Path, kind: RunKind) -> Result<(SceneFile, Option<PathBuf>), SceneError> {
        if !Self::is_one(folder) {
            let reason = format!("holds no run to resume ({SCENE}, {START} and a journal)");
            return Err(file_error(folder, reason));
        }
        let unknown = || {
            let place = folder.display();
            let hint =
                format!("`export --run {place}` writes its shape, from which {} begins anew", controls::START_OPTION);
            file_error(
                folder,
                format!("{RUN}, which says what the run is, is missing: older versions wrote none; {hint}"),
            )
        };
        let found = RunKind::of(folder)?.ok_or_else(unknown)?;
        if found != kind {
            let command = resume_command(folder, found);
            return Err(file_error(folder, format!("holds {}: continue it with `{command}`", found.words())));
        }
        let file = folder.join(SCENE);
        let mut scene = SceneFile::read(&file)?;
        scene.output.folder = Some(folder.display().to_string());
        Ok((scene, Some(file)))
    }

    /// Whether a folder holds a run, ended or not.
    pub fn is_one(folder: &Path) -> bool {
        [START, SCENE].iter().all(|name| folder.join(name).exists())
    }

    /// Begins a run in a folder, with what it is, its scene and its initial controls. `claimed` are further files that
    /// will be written there.
    pub fn begin(
        folder: Folder,
        loaded: &LoadedScene,
        initial_controls: &Vector,
        (kind, claimed): (RunKind, &[String]),
    ) -> Result<Self, Failure> {
        claimed.iter().try_for_each(|name| folder.claim(name))?;
        let identity = Identity::new(loaded, initial_controls.as_slice())?;
        let mut scene = loaded.file.clone();
        for (name, file) in scene.files_mut() {
            folder.write(&name, content(loaded, file)?)?;
            *file = name;
        }
        folder.write(RUN, kind.file()?)?;
        let layout = Layout::of(&loaded.case.scene);
        folder.write(START, controls::written(initial_controls.as_slice(), layout)?)?;
        // With its scene, the folder holds a run.
        keep_scene(&folder, scene)?;
        let initial_controls = initial_controls.clone();
        Ok(Self { folder, identity, initial_controls, resumed: false, new_version: false })
    }

    /// The run that a folder holds, to be continued. Nothing of it is changed.
    ///
    /// # Errors
    /// [`Failure::Input`] for a journal of another scene or, unless `new_version`, of another version of the program,
    /// and for fewer evaluations than it holds; any [`Failure`] of the folder.
    pub fn reopen(folder: Folder, loaded: &LoadedScene, new_version: bool) -> Result<Self, Failure> {
        let layout = Layout::of(&loaded.case.scene);
        let initial_controls = controls::read(&folder.path().join(START), layout)?;
        let identity = Identity::new(loaded, initial_controls.as_slice())?;
        let this = Self { folder, identity, initial_controls, resumed: true, new_version };
        for stage in stages(&loaded.case) {
            let (held, limit) = (this.held(stage.part.folder().as_deref())?, stage.case.optimizer.max_evaluations);
            if held > limit {
                let allowed = format!("at least the {held} evaluations that the folder holds");
                return Err(SceneError::out_of_range("--max-evaluations", limit, allowed).into());
            }
        }
        Ok(this)
    }

    /// Goes on with the run: from here on a folder without report is that of a run that has not ended. What the run has
    /// found so far stays until its end replaces it.
    pub fn proceed(&self, loaded: &LoadedScene) -> Result<(), Failure> {
        if !self.resumed {
            return Ok(());
        }
        let report = self.folder.path().join(REPORT);
        match std::fs::remove_file(&report) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(file_error(&report, error).into()),
            _ => {}
        }
        keep_scene(&self.folder, loaded.file.clone())
    }

    /// Takes a new run back whose input turned out to be wrong; a run that is continued stays.
    pub fn abandon(&self) {
        if !self.resumed {
            self.folder.abandon();
        }
    }

    /// An objective with the journal of the run or of one of its stages.
    ///
    /// # Errors
    /// [`Failure::Input`] for a journal that is that of another scene or that cannot be understood;
    /// [`Failure::Computation`] if it cannot be read or written.
    pub fn journaled<O: NonsmoothObjective>(&self, objective: O, stage: Option<&str>) -> Result<Journaled<O>, Failure> {
        let prefix = stage.map_or_else(String::new, |stage| format!("{stage}/"));
        self.folder.claim(&format!("{prefix}{JOURNAL}"))?;
        let place = self.place(stage);
        let journal = Journal::read(&place)?;
        Ok(Journaled::open(objective, &place, &self.known(stage, journal.as_ref())?)?)
    }

    /// Number of evaluations in the journal of the run or of one of its stages.
    fn held(&self, stage: Option<&str>) -> Result<usize, Failure> {
        let Some(journal) = Journal::read(self.place(stage))? else { return Ok(0) };
        let expected = self.known(stage, Some(&journal))?;
        if journal.identity != expected {
            let path = self.place(stage).join(JOURNAL);
            return Err(JournalError::Identity { path, found: journal.identity, expected }.into());
        }
        Ok(journal.entries.len())
    }

    /// The name of the objective in a journal, which may be that of another version of the program if that is allowed.
    fn known(&self, stage: Option<&str>, journal: Option<&Journal>) -> Result<String, Failure> {
        #[derive(Deserialize)]
        struct Written {
            version: String,
        }
        let expected = Identity { stage: stage.map(str::to_owned), ..self.identity.clone() };
        let found = journal.map_or("", |journal| &journal.identity);
        let version =
            serde_json::from_str(found).map_or_else(|_| expected.version.clone(), |Written { version }| version);
        if version != expected.version && !self.new_version {
            let here = &expected.version;
            let words = format!(
                "the run was begun by version {version} of the program, this is version {here}; --new-version continues it"
            );
            return Err(file_error(&self.place(stage).join(JOURNAL), words).into());
        }
        // A build that has other fields writes the same identity in another way.
        let same = serde_json::from_str(found).is_ok_and(|mut found: Identity| {
            (found.scene.optimizer, found.scene.output) = (OptimizerSection::default(), OutputSection::default());
            found == Identity { version, ..expected.clone() }
        });
        if same { Ok(found.to_owned()) } else { expected.text() }
    }

    /// Where the journal of the run, or of one of its stages, lies.
    fn place(&self, stage: Option<&str>) -> PathBuf {
        let path = self.folder.path();
        stage.map_or_else(|| path.to_owned(), |stage| path.join(stage))
    }
}

/// What a file holds that a scene names.
fn content(loaded: &LoadedScene, file: &str) -> Result<Vec<u8>, Failure> {
    let path = loaded.folder().join(file);
    std::fs::read(&path).map_err(|error| file_error(&path, error).into())
}

/// Writes the scene file, without the folder: a file that named it would send other commands there.
fn keep_scene(folder: &Folder, mut scene: SceneFile) -> Result<(), Failure> {
    scene.output.folder = None;
    folder.write(SCENE, scene.print()?)
}
