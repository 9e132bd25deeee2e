//! The commands of the pages: README.md, problems/README.md and docs/*.md.
//!
//! Pages name the binaries of the package `problems` as they are installed: `contact3d SCENE`.
//!
//! A fenced block with the info `sh` holds commands that the tests run, one with `sh slow` commands that take too long
//! for that: the tests have their options parsed. `#` begins a comment. Blocks of another kind hold no command that
//! begins with `cargo` or `git`, except those marked `text`: output, or usage.

use std::path::{Path, PathBuf};

/// The binaries that `cargo install --path problems` installs.
pub const INSTALLED: [&str; 4] = ["contact3d", "hertz3d", "signorini3d", "toy2d"];

/// One page of the repository.
#[derive(Debug)]
pub struct Page {
    /// Path below the root of the repository.
    pub name: String,
    /// Its commands, in order.
    pub commands: Vec<Command>,
}

/// One command of a page.
#[derive(Debug)]
pub struct Command {
    /// Where it stands, for messages.
    pub place: String,
    /// Too long for a test.
    pub slow: bool,
    /// Variables set for it.
    pub variables: Vec<(String, String)>,
    /// Its words, without the redirection.
    pub words: Vec<String>,
    /// File that takes its output.
    pub target: Option<String>,
}

impl Command {
    /// The value of an option of cargo, that is, before `--`.
    pub fn cargo_option(&self, option: &str) -> Option<&str> {
        let options = self.words.split(|word| word == "--").next()?;
        let at = options.iter().position(|word| word == option)?;
        options.get(at + 1).map(String::as_str)
    }

    /// The binary of a package that the command starts: one that is installed, or one that cargo runs.
    pub fn binary(&self, package: &str) -> Option<&str> {
        let first = self.words[0].as_str();
        if package == "problems" && INSTALLED.contains(&first) {
            return Some(first);
        }
        let runs = self.line().starts_with("cargo run ") && self.cargo_option("-p") == Some(package);
        runs.then(|| self.cargo_option("--bin").unwrap_or_else(|| panic!("{}: no --bin", self.place)))
    }

    /// What the program gets, from cargo or directly.
    pub fn arguments(&self) -> &[String] {
        if INSTALLED.contains(&self.words[0].as_str()) {
            return &self.words[1..];
        }
        let separator = self.words.iter().position(|word| word == "--");
        separator.map_or(&[], |at| &self.words[at + 1..])
    }

    /// The command as one line.
    pub fn line(&self) -> String {
        self.words.join(" ")
    }
}

/// All pages of the repository with this root.
///
/// # Panics
/// When a page cannot be read, or holds a block that is not closed or not marked as it should be.
pub fn all(root: &Path) -> Vec<Page> {
    let folder = std::fs::read_dir(root.join("docs")).expect("the folder docs");
    let mut files: Vec<PathBuf> = folder.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    files.sort();
    files.extend([root.join("README.md"), root.join("problems/README.md")]);
    files.iter().map(|path| page(root, path)).collect()
}

fn page(root: &Path, path: &Path) -> Page {
    let name = path.strip_prefix(root).expect("below the root").display().to_string();
    let text = std::fs::read_to_string(path).expect("a readable page");
    let mut block: Option<&str> = None;
    let mut commands = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let place = format!("{name}, line {}", number + 1);
        if let Some(info) = line.trim_start().strip_prefix("```") {
            block = if block.is_none() { Some(info) } else { None };
            continue;
        }
        let Some(info) = block else { continue };
        if info == "sh" || info == "sh slow" {
            commands.extend(command(line, place, info == "sh slow"));
        } else {
            let command = line.starts_with("cargo ") || line.starts_with("git ");
            assert!(
                info == "text" || !command,
                "{place}: a command in a block that is not ```sh or ```sh slow: {line}"
            );
        }
    }
    assert!(block.is_none(), "{name}: a block is not closed");
    Page { name, commands }
}

fn command(line: &str, place: String, slow: bool) -> Option<Command> {
    let code = line.split_once('#').map_or(line, |(code, _comment)| code);
    let mut words: Vec<String> = code.split_whitespace().map(str::to_owned).collect();
    if words.is_empty() {
        return None;
    }
    let mut variables = Vec::new();
    while let Some((variable, value)) = words[0].split_once('=') {
        variables.push((variable.to_owned(), value.to_owned()));
        words.remove(0);
        assert!(!words.is_empty(), "{place}: only variables");
    }
    let target = words.iter().position(|word| word == ">").map(|at| {
        assert_eq!(at + 2, words.len(), "{place}: a redirection ends a command");
        let target = words.remove(at + 1);
        words.truncate(at);
        target
    });
    for special in ["|", "&&", ";", "<", "\\"] {
        assert!(!words.iter().any(|word| word == special), "{place}: one command per line, without {special}");
    }
    Some(Command { place, slow, variables, words, target })
}
