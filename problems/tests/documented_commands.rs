//! Every command in the guides runs and succeeds, in a folder that holds nothing but the example scenes.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::path::{Path, PathBuf};
use std::process::Command;

const PREFIX: &str = "cargo run --release -p problems --bin ";

/// Commands of the fenced blocks of a page, without the prefix that builds them.
fn commands(page: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(page)).unwrap();
    let mut inside = false;
    let mut commands = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = !inside && line == "```sh";
        } else if inside {
            let command =
                line.strip_prefix(PREFIX).unwrap_or_else(|| panic!("{page}: {line:?} is not run by this test"));
            commands.push(command.split_whitespace().filter(|word| *word != "--").map(str::to_owned).collect());
        }
    }
    commands
}

fn binary(name: &str) -> &'static str {
    match name {
        "contact3d" => env!("CARGO_BIN_EXE_contact3d"),
        "hertz3d" => env!("CARGO_BIN_EXE_hertz3d"),
        "signorini3d" => env!("CARGO_BIN_EXE_signorini3d"),
        _ => panic!("{name} is no binary of the guides"),
    }
}

fn playground(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("nonsmooth-{name}-{}", std::process::id()));
    let scenes = folder.join("problems/scenes");
    std::fs::create_dir_all(&scenes).unwrap();
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, scenes.join(path.file_name().unwrap())).unwrap();
    }
    folder
}

fn run_all(page: &str) {
    let commands = commands(page);
    assert!(commands.len() >= 3, "{page}: {} commands", commands.len());
    let folder = playground(page);
    for command in commands {
        // A redirection at the end of a command is what a shell would do with its output.
        let (words, target) = match command.iter().position(|word| word == ">") {
            Some(at) => (&command[..at], command.get(at + 1)),
            None => (&command[..], None),
        };
        let output = Command::new(binary(&words[0])).args(&words[1..]).current_dir(&folder).output().unwrap();
        assert!(output.status.success(), "{page}: {words:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!output.stdout.is_empty(), "{page}: {words:?}");
        if let Some(target) = target {
            std::fs::write(folder.join(target), output.stdout).unwrap();
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn commands_about_scenes() {
    run_all("scenes.md");
}

#[test]
fn commands_about_long_runs() {
    run_all("long_runs.md");
}
