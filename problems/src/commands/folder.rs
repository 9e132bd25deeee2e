//! Output folders, and JSON as text.

use crate::commands::arguments::Arguments;
use crate::commands::facts::line;
use crate::commands::failure::Failure;
use crate::commands::output::notice;
use crate::commands::register::{self, REGISTER, Register, UNFINISHED};
use crate::commands::run_kind::{RUN, RunKind};
use contact::error::SceneError;
use figures::Figure;
use scene_file::{Case, FILES};
use serde::Serialize;
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files of a run: what was asked for, where it started, and, when it has ended, its report.
pub const SCENE: &str = "scene.toml";
pub const START: &str = "start.json";
pub const REPORT: &str = "report.json";
/// The page to print of an optimization.
pub const SUMMARY: &str = "summary.html";
/// Folders of the two runs of a comparison.
pub const COMPARED: [&str; 2] = ["with_friction", "without_friction"];
/// What a study varies; its rows lie beside it.
pub const STUDY: &str = "study.json";
/// Bytes that stand for those of a run, while it is tried out whether they fit.
const PROBE: &str = "room";

/// An output folder, or one inside it, that was found writable before the work began. No other process works in it.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// The path below the folder with the list, with the last `/`.
    prefix: String,
    register: Arc<Register>,
    /// The folder that was renamed, with its list, which stays locked: a process may have found it under the old name.
    renamed: Option<(PathBuf, Register)>,
}

impl Folder {
    /// A folder for new results, in which files of so many bytes can be written. With `overwrite`, a folder that holds
    /// results is renamed to the first free `DIR.1`, `DIR.2`, …
    ///
    /// # Errors
    /// [`Failure::Input`] for a folder with a file that the program did not write, with results (unless `overwrite`),
    /// or in which another process works; [`Failure::Computation`] with the system's reason if it cannot be written.
    /// Nothing is changed then.
    pub fn create(path: &Path, bytes: u64, overwrite: bool) -> Result<Self, Failure> {
        let held = Register::lock(path, false)?;
        let names = held.as_ref().map(Register::names).unwrap_or_default();
        if let Some(file) = register::foreign(path, &names).map_err(unwritable(path))? {
            if held.is_none() && (Register::lock(path, false)?.is_some() || !register::exists(&file)) {
                // Another process has begun or given up here since the list was looked for.
                return Self::create(path, bytes, overwrite);
            }
            let words = "was not written by this program; no results are put beside it, take another folder";
            return Err(Failure::Input(format!("{}: {} {words}", path.display(), file.display())));
        }
        let Some(held) = held else { return Self::begin(path, bytes) };
        if !names.iter().any(|name| is_result(name) && register::exists(&path.join(name))) {
            // The program ended before anything was begun there.
            held.clear().map_err(unwritable(path))?;
            return Self::with_room(path, bytes, held);
        }
        if !overwrite {
            return Err(Failure::Input(format!("{}: {}", path.display(), what_it_holds(path))));
        }
        let elsewhere = free_name(path)?;
        std::fs::rename(path, &elsewhere).map_err(unwritable(path))?;
        match Self::begin(path, bytes) {
            Ok(folder) => {
                notice(&format!("{} was renamed to {}", path.display(), elsewhere.display()));
                Ok(Self { renamed: Some((elsewhere, held)), ..folder })
            }
            Err(failure) => {
                std::fs::rename(&elsewhere, path).map_err(unwritable(path))?;
                Err(failure)
            }
        }
    }

    /// The folder for the results of a command that is not a long run, if one is asked for.
    pub fn of_command(case: &Case, arguments: &Arguments) -> Result<Option<Self>, Failure> {
        let create = |path: &String| Self::create(Path::new(path), 1, arguments.files.overwrite);
        case.output.folder.as_ref().map(create).transpose()
    }

    /// The folder of a run that is continued.
    ///
    /// # Errors
    /// [`Failure`] if another process works there, or if it cannot be written.
    pub fn reopen(path: &Path, bytes: u64) -> Result<Self, Failure> {
        let missing = || Failure::Input(format!("{}: {REGISTER} is missing or changed", path.display()));
        Self::with_room(path, bytes, Register::lock(path, false)?.ok_or_else(missing)?)
    }

    /// Takes back what was begun in a new folder, as far as the system lets it.
    pub fn abandon(&self) {
        let names = self.register.names();
        let folders: BTreeSet<&Path> = names.iter().filter_map(|name| Path::new(name).parent()).collect();
        if self.register.clear().and_then(|()| std::fs::remove_file(self.path.join(REGISTER))).is_ok() {
            // The folders below come first; those that were not made yet are not there.
            folders.into_iter().rev().for_each(|folder| drop(std::fs::remove_dir(self.path.join(folder))));
            if let Some((elsewhere, _)) = &self.renamed {
                let _ = std::fs::rename(elsewhere, &self.path);
            }
        }
    }

    /// Makes a folder that is empty or does not exist; none is left if it cannot be written.
    fn begin(path: &Path, bytes: u64) -> Result<Self, Failure> {
        let made: Vec<&Path> = path.ancestors().take_while(|path| !register::exists(path)).collect();
        let made = made.into_iter().filter(|path| !path.as_os_str().is_empty());
        std::fs::create_dir_all(path).map_err(unwritable(path))?;
        let used = || Failure::Input(format!("{}: another process works in this folder", path.display()));
        let register = Register::lock(path, true)?.filter(|register| register.names().len() == 1).ok_or_else(used)?;
        Self::with_room(path, bytes, register).inspect_err(|_| {
            let _ = std::fs::remove_file(path.join(REGISTER));
            // What others have put there meanwhile stays.
            made.for_each(|folder| drop(std::fs::remove_dir(folder)));
        })
    }

    /// Proves that files of so many bytes can be written.
    fn with_room(path: &Path, bytes: u64, register: Register) -> Result<Self, Failure> {
        let failed = |error: io::Error| {
            Failure::Computation(format!("{}: cannot write {bytes} bytes there: {error}", path.display()))
        };
        register.claim(PROBE).map_err(failed)?;
        let probe = path.join(PROBE);
        let written = std::fs::File::create(&probe).and_then(|mut file| {
            let block = vec![0_u8; 1 << 16];
            let mut left = bytes;
            while left > 0 {
                let now = left.min(block.len() as u64);
                file.write_all(&block[..now as usize])?;
                left -= now;
            }
            file.sync_all()
        });
        let removed = std::fs::remove_file(&probe);
        written.and(removed).map_err(failed)?;
        Ok(Self { path: path.to_owned(), prefix: String::new(), register: Arc::new(register), renamed: None })
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where people begin to read: the page, or, if there is none, the folder.
    pub fn page(&self) -> PathBuf {
        let page = self.path.join("report.html");
        if page.exists() { page } else { self.path.clone() }
    }

    /// The files that the program wrote here and in folders below, by their paths; some may have been taken away again.
    pub fn names(&self) -> BTreeSet<String> {
        let all = self.register.names();
        all.iter().filter_map(|name| name.strip_prefix(&self.prefix)).map(str::to_owned).collect()
    }

    /// A folder inside this one, made if it does not exist.
    ///
    /// # Errors
    /// [`Failure::Computation`] with the system's reason.
    pub fn within(&self, name: &str) -> Result<Self, Failure> {
        let (path, prefix) = (self.path.join(name), format!("{}{name}/", self.prefix));
        std::fs::create_dir_all(&path).map_err(unwritable(&path))?;
        Ok(Self { path, prefix, register: Arc::clone(&self.register), renamed: None })
    }

    /// Says that the program is about to write a file, by its path below this folder.
    ///
    /// # Errors
    /// [`Failure::Computation`] for a file that is there and was not written by the program, and with the system's
    /// reason.
    pub fn claim(&self, name: &str) -> Result<(), Failure> {
        self.register.claim(&format!("{}{name}", self.prefix)).map_err(unwritable(&self.path.join(name)))
    }

    /// Writes one file atomically: at any time it holds the old content or the new one, never a part.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        self.claim(name)?;
        let (path, temporary) = (self.path.join(name), self.path.join(format!("{name}{UNFINISHED}")));
        let written = std::fs::File::create(&temporary)
            .and_then(|mut file| file.write_all(content.as_ref()).and_then(|()| file.sync_all()))
            .and_then(|()| std::fs::rename(&temporary, &path));
        written.map_err(unwritable(&path))
    }

    /// Writes a figure as SVG.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn draw(&self, figure: &Figure) -> Result<(), Failure> {
        self.write(&format!("{}.svg", figure.name), &figure.svg)
    }
}

/// The text for stdout after the files of a command were written into its folder, if it has one. A text for people
/// names them; files that could not be written do not lose the text.
///
/// # Errors
/// [`Failure::Incomplete`] with the text if a file could not be written.
pub fn printed_with_files(
    text: String,
    as_json: bool,
    folder: Option<&Folder>,
    write: impl FnOnce(&Folder) -> Result<(), Failure>,
) -> Result<String, Failure> {
    let Some(folder) = folder else { return Ok(text) };
    match write(folder) {
        Ok(()) if as_json => Ok(text),
        Ok(()) => Ok(text + &line("files", &folder.page().display().to_string())),
        Err(failure) => {
            let reason = format!("{failure}; the report above is complete");
            Err(Failure::Incomplete { text, reason, status: 1 })
        }
    }
}

/// Whether a file on the list of a folder is more than a preparation.
fn is_result(name: &str) -> bool {
    ![REGISTER, START, RUN, PROBE].contains(&name) && !FILES.contains(&name)
}

/// Why a folder with results is refused.
fn what_it_holds(path: &Path) -> String {
    let beside = "--out with another folder keeps it, --overwrite renames it";
    if !path.join(SCENE).exists() {
        return format!("holds results ({beside})");
    }
    let Ok(Some(kind)) = RunKind::of(path) else { return format!("holds a run without {RUN} ({beside})") };
    let command = resume_command(path, kind);
    match path.join(REPORT).exists() {
        true => format!("holds results of a run; `{command}` continues it with larger limits ({beside})"),
        false => format!("holds a run that has not ended; continue it with `{command}` ({beside})"),
    }
}

/// A word as it is typed in a shell.
pub fn quoted(word: String) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+,:@%".contains(c);
    match word.chars().all(plain) && !word.is_empty() {
        true => word,
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// The command that continues a run, as it is typed in a shell.
pub fn resume_command(folder: &Path, kind: RunKind) -> String {
    let program = std::env::args().next().map_or_else(String::new, |program| quoted(program) + " ");
    format!("{program}{}--resume {}", kind.command(), quoted(folder.display().to_string()))
}

/// The command that continues a run, with the options of the present command that the folder does not hold.
pub fn continuation(folder: &Path, arguments: &Arguments) -> String {
    let mut command = resume_command(folder, arguments.command.kind());
    for (given, option) in
        [(arguments.series.vtk_history, " --vtk-history"), (arguments.results.no_checks, " --no-checks")]
    {
        command += if given { option } else { "" };
    }
    command
}

/// The first free `DIR.1`, `DIR.2`, …
fn free_name(path: &Path) -> Result<PathBuf, Failure> {
    let unnamed =
        || Failure::Input(format!("{}: --overwrite renames the folder, which needs its name", path.display()));
    let name = path.file_name().ok_or_else(unnamed)?;
    let numbered = |number: u32| {
        let mut name = name.to_owned();
        name.push(format!(".{number}"));
        path.with_file_name(name)
    };
    (1..).map(numbered).find(|path| !register::exists(path)).ok_or_else(unnamed)
}

/// A failure to write at a place.
fn unwritable(path: &Path) -> impl Fn(io::Error) -> Failure {
    move |error| Failure::Computation(format!("{}: {error}", path.display()))
}

/// The error about a file or a folder.
pub fn file_error(path: &Path, reason: impl ToString) -> SceneError {
    SceneError::File { path: path.display().to_string(), reason: reason.to_string() }
}

/// A value as JSON, one field per line.
///
/// # Errors
/// [`Failure::Computation`] if a value cannot be written.
pub fn json(value: &(impl Serialize + ?Sized)) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map(|text| text + "\n").map_err(|error| Failure::Computation(error.to_string()))
}
