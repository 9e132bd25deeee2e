//! `new`: a first scene for a mesh, beside it.

use crate::commands::failure::Failure;
use crate::commands::folder::{file_error, quoted};
use std::io::Write;
use std::path::{Path, PathBuf};

/// What the arguments of a program ask for, if they ask for a new scene: `new MESH`.
pub fn asked(binary: &str, arguments: &[String]) -> Option<Result<String, Failure>> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["new", mesh] if !mesh.starts_with('-') => Some(new_scene(Path::new(mesh)).map(|scene| next(binary, &scene))),
        ["new", ..] => Some(Err(Failure::Input(format!(
            "{binary} new MESH.msh needs one mesh, a Gmsh file; it writes MESH.toml beside it"
        )))),
        _ => None,
    }
}

/// Writes a first scene for a mesh beside it; the path of the scene.
///
/// # Errors
/// [`Failure::Input`] for what is no mesh, for a scene that exists, and with the system's reason for a file that cannot
/// be written.
pub fn new_scene(mesh: &Path) -> Result<PathBuf, Failure> {
    let scene = mesh.with_extension("toml");
    let text = scene_file::draft(mesh)?;
    let exists = || Failure::Input(format!("{} exists, and is not overwritten: move it first", scene.display()));
    let mut file = match std::fs::File::create_new(&scene) {
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => return Err(exists()),
        made => made.map_err(|error| file_error(&scene, error))?,
    };
    file.write_all(text.as_bytes()).and_then(|()| file.sync_all()).map_err(|error| file_error(&scene, error))?;
    Ok(scene)
}

/// What to do with a new scene.
fn next(binary: &str, scene: &Path) -> String {
    let path = quoted(scene.display().to_string());
    let stem = scene.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let folder = quoted(format!("results/{stem}_look"));
    format!(
        "{path}: a first scene, from the names and forms of the faces; its comments say why, and what it leaves open\n\
         next: {binary} {path} look --out {folder}\n"
    )
}
