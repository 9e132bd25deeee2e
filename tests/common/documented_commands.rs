//! Runs the commands of all pages that start a binary of one package.

use crate::pages::{self, Command};
use std::path::{Path, PathBuf};
use std::process::{self, Output};

/// A folder with the example scenes where the pages expect them.
fn playground(root: &Path, page: &str) -> PathBuf {
    let name = page.replace(['/', '.'], "-");
    let folder = std::env::temp_dir().join(format!("nonsmooth-{name}-{}", process::id()));
    let scenes = folder.join("problems/scenes");
    std::fs::create_dir_all(&scenes).unwrap();
    for entry in std::fs::read_dir(root.join("problems/scenes")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, scenes.join(path.file_name().unwrap())).unwrap();
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
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {}: {error}", command.place, command.line());
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
        std::fs::write(folder.join(target), output.stdout).unwrap();
    }
}

/// Runs the commands of all pages of the repository at `root` that start a binary of `package`, each in a folder that holds
/// nothing but the example scenes; `binary` knows where a binary lies. How many ran, and how many had only their options parsed.
pub fn run_all(root: &Path, package: &str, binary: fn(&str) -> Option<&'static str>) -> (usize, usize) {
    let (mut ran, mut parsed) = (0, 0);
    for page in pages::all(root) {
        let folder = playground(root, &format!("{package}-{}", page.name));
        for command in &page.commands {
            if !command.line().starts_with("cargo run ") || command.cargo_option("-p") != Some(package) {
                continue;
            }
            let program = command.cargo_option("--bin").and_then(binary);
            let program = program.unwrap_or_else(|| panic!("{}: {}: no such binary", command.place, command.line()));
            run(command, program, &folder);
            *(if command.slow { &mut parsed } else { &mut ran }) += 1;
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
    (ran, parsed)
}
