//! Runs the commands of all pages that start a binary of one package.

use crate::kit::pages::{self, Command};
use crate::kit::{errors, scratch};
use std::path::Path;
use std::process::{self, Output};
use tempfile::TempDir;

/// A folder with the example scenes where the pages expect them.
fn playground(root: &Path) -> TempDir {
    let folder = scratch();
    let scenes = folder.path().join("problems/scenes");
    std::fs::create_dir_all(&scenes).expect("a folder for the scenes");
    for entry in std::fs::read_dir(root.join("problems/scenes")).expect("the example scenes") {
        let entry = entry.expect("an entry");
        std::fs::copy(entry.path(), scenes.join(entry.file_name())).expect("a copy of a scene");
    }
    folder
}

fn start(command: &Command, program: &str, more: &[&str], folder: &Path) -> Output {
    let variables = command.variables.iter().map(|(name, value)| (name, value));
    let output = process::Command::new(program)
        .args(command.arguments())
        .args(more)
        .envs(variables)
        .current_dir(folder)
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{}: {}: {}", command.place, command.line(), errors(&output));
    assert!(!output.stdout.is_empty(), "{}: {}: prints nothing", command.place, command.line());
    output
}

/// Runs the command of a binary; a slow one only gets its options checked.
fn run(command: &Command, program: &str, folder: &Path) {
    if command.slow {
        // Beside the parser, a contact binary checks which options go together, and the scene.
        let contact = ["hertz3d", "signorini3d", "contact3d"].iter().any(|name| program.ends_with(name));
        start(command, program, &[if contact { "--print-scene" } else { "--help" }], folder);
        return;
    }
    let output = start(command, program, &[], folder);
    if let Some(target) = &command.target {
        std::fs::write(folder.join(target), output.stdout).expect("the target of the redirection");
    }
}

/// Runs the commands of all pages of the repository at `root` that start a binary of `package`, the commands of a page
/// in a folder that holds nothing but the example scenes. `binary` knows where a binary lies. Returns how many commands
/// ran, and of how many only the options were parsed.
///
/// # Panics
/// When a command fails, prints nothing, or names no binary of the package.
pub fn run_commands(root: &Path, package: &str, binary: fn(&str) -> Option<&'static str>) -> (usize, usize) {
    let (mut ran, mut parsed) = (0, 0);
    for page in pages::all(root) {
        let folder = playground(root);
        for command in &page.commands {
            let Some(name) = command.binary(package) else { continue };
            let program =
                binary(name).unwrap_or_else(|| panic!("{}: {}: no such binary", command.place, command.line()));
            run(command, program, folder.path());
            *(if command.slow { &mut parsed } else { &mut ran }) += 1;
        }
    }
    (ran, parsed)
}
