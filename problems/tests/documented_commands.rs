//! Every command of the pages works: those of the binaries run here, in a folder that holds nothing but the example scenes;
//! those of the examples run in `tests/documented_examples.rs`; commands that build and test are those of the project's own
//! checks, or name targets that exist. A command of no kind known here fails the test.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

#[path = "../../tests/common/pages.rs"]
mod pages;

use pages::Command;
use std::path::{Path, PathBuf};
use std::process::{self, Output};

/// Commands around the build that no test can run (a test runs inside one of them).
const AROUND_THE_BUILD: [&str; 7] = [
    "rustc --version",
    "cargo fetch --locked",
    "cargo build --release --locked",
    "cargo build --release --locked --offline",
    "cargo package -p nonsmooth -p problems --locked",
    "cargo doc --workspace --no-deps --locked",
    "cargo doc --workspace --no-deps --locked --open",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn binary(name: &str) -> Option<&'static str> {
    Some(match name {
        "accuracy" => env!("CARGO_BIN_EXE_accuracy"),
        "contact3d" => env!("CARGO_BIN_EXE_contact3d"),
        "hertz3d" => env!("CARGO_BIN_EXE_hertz3d"),
        "membrane2d" => env!("CARGO_BIN_EXE_membrane2d"),
        "scaling" => env!("CARGO_BIN_EXE_scaling"),
        "signorini3d" => env!("CARGO_BIN_EXE_signorini3d"),
        "stability" => env!("CARGO_BIN_EXE_stability"),
        "toy2d" => env!("CARGO_BIN_EXE_toy2d"),
        _ => return None,
    })
}

/// A folder with the example scenes where the pages expect them.
fn playground(page: &str) -> PathBuf {
    let name = page.replace(['/', '.'], "-");
    let folder = std::env::temp_dir().join(format!("nonsmooth-{name}-{}", process::id()));
    let scenes = folder.join("problems/scenes");
    std::fs::create_dir_all(&scenes).unwrap();
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).unwrap() {
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

/// Whether `cargo test` with a target of one of the packages names one that exists.
fn is_a_test_that_exists(command: &Command) -> bool {
    let folder = match command.cargo_option("-p") {
        Some("problems") => root().join("problems"),
        None | Some("nonsmooth") => root(),
        Some(_) => return false,
    };
    let tests = folder.join("tests");
    command
        .cargo_option("--test")
        .is_some_and(|name| tests.join(format!("{name}.rs")).exists() || tests.join(name).join("main.rs").exists())
}

/// Whether a command builds or tests the project in a way that is checked elsewhere.
fn is_part_of_the_build(command: &Command, own_checks: &str) -> bool {
    let line = command.line();
    let own = own_checks.lines().any(|check| check == line);
    let test = line.starts_with("cargo test ") && is_a_test_that_exists(command);
    own || test || AROUND_THE_BUILD.contains(&line.as_str())
}

#[test]
fn commands_of_all_pages() {
    let own_checks = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let (mut ran, mut parsed) = (0, 0);
    for page in pages::all(&root()) {
        let folder = playground(&page.name);
        for command in &page.commands {
            let runs = command.line().starts_with("cargo run ");
            let program = command.cargo_option("--bin");
            match program.and_then(binary) {
                Some(program) if runs && command.cargo_option("-p") == Some("problems") => {
                    run(command, program, &folder);
                    *(if command.slow { &mut parsed } else { &mut ran }) += 1;
                }
                _ if runs && program.is_none() && command.cargo_option("--example").is_some() => {}
                _ if is_part_of_the_build(command, &own_checks) => {}
                _ => panic!("{}: {}: no test knows this command", command.place, command.line()),
            }
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
    assert!(ran >= 12 && parsed >= 6, "{ran} commands ran, {parsed} were parsed: pages have lost their commands");
}
