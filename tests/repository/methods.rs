//! Engine and mechanics consist of parts: a type whose methods call each other across many files is none. A method of a
//! type that calls a method of the same type in another file is an arrow between these files; in `src/bundle`, `src/qp`
//! and the contact problem no circle of arrows is allowed, and no type with methods in more than three files. Nor has
//! a type of the engine more than 32 methods. Traits do not count: they are the interfaces between parts.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Files with methods of one type.
const MAX_FILES: usize = 3;
/// Methods of one type of the engine.
const MAX_METHODS: usize = 32;

/// Methods of a type in one file, with the text of the blocks that define them.
#[derive(Default)]
struct Block {
    names: BTreeSet<String>,
    text: String,
}

/// By type, then by file.
type Methods = BTreeMap<String, BTreeMap<PathBuf, Block>>;

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of sources").map(|entry| entry.expect("an entry").path());
    entries.flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] }).collect()
}

/// The name of the type of an inherent implementation, from the line that opens it; none for implementations of traits.
fn inherent(line: &str) -> Option<String> {
    let rest = line.strip_prefix("impl")?;
    let rest = if rest.starts_with('<') { rest.split_once("> ")?.1 } else { rest.trim_start() };
    let head = rest.split('{').next()?;
    if head.contains(" for ") {
        return None;
    }
    head.split(['<', ' ']).next().filter(|name| !name.is_empty()).map(str::to_owned)
}

fn methods(folder: &Path) -> Methods {
    let mut methods = Methods::new();
    for file in rust_files(folder) {
        let text = fs::read_to_string(&file).expect("a source");
        let mut open: Option<String> = None;
        for line in text.lines() {
            if let Some(name) = inherent(line) {
                open = Some(name);
            } else if line == "}" {
                open = None;
            }
            let Some(name) = &open else { continue };
            let block = methods.entry(name.clone()).or_default().entry(file.clone()).or_default();
            block.text.push_str(line);
            block.text.push('\n');
            if let Some((_, rest)) = line.split_once("fn ").filter(|(before, _)| !before.contains("//")) {
                block.names.insert(rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect());
            }
        }
    }
    methods
}

/// Whether a text calls a method on `self` or on the type.
fn calls(text: &str, name: &str) -> bool {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.into_iter().any(|line| line.contains(&format!("self.{name}(")) || line.contains(&format!("Self::{name}(")))
}

/// The files that a file of a type leads to.
fn arrows(files: &BTreeMap<PathBuf, Block>) -> BTreeMap<&PathBuf, BTreeSet<&PathBuf>> {
    let target = |from: &PathBuf, block: &Block| {
        let others = files.iter().filter(|(file, _)| *file != from);
        let called = others.filter(|(_, other)| other.names.iter().any(|name| calls(&block.text, name)));
        called.map(|(file, _)| file).collect()
    };
    files.iter().map(|(file, block)| (file, target(file, block))).collect()
}

fn reaches<'a>(arrows: &BTreeMap<&'a PathBuf, BTreeSet<&'a PathBuf>>, from: &'a PathBuf, to: &PathBuf) -> bool {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        for next in arrows.get(file).into_iter().flatten().copied() {
            if next == to {
                return true;
            }
            if seen.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

/// Checks the types of a folder, among them one of a name.
fn check(folder: &str, known: &str, max_methods: usize) {
    let methods = methods(Path::new(folder));
    assert!(methods.contains_key(known) && methods.len() > 15, "{} types", methods.len());
    for (name, files) in &methods {
        let count: usize = files.values().map(|block| block.names.len()).sum();
        assert!(count <= max_methods, "{name} has {count} methods");
        assert!(files.len() <= MAX_FILES, "{name} has methods in {:?}", files.keys());
        let arrows = arrows(files);
        for file in files.keys() {
            assert!(
                !reaches(&arrows, file, file),
                "methods of {name} call each other in a circle through {}",
                file.display()
            );
        }
    }
}

#[test]
fn types_of_the_engine_are_parts() {
    check("src/bundle", "Run", MAX_METHODS);
    check("src/qp", "WorkingSet", MAX_METHODS);
}

#[test]
fn types_of_the_mechanics_are_parts() {
    check("problems/contact/src", "TornContact", usize::MAX);
}

#[test]
fn a_circle_of_methods_is_seen() {
    let block = |names: &[&str], text: &str| Block {
        names: names.iter().map(|name| (*name).to_owned()).collect(),
        text: text.to_owned(),
    };
    let files = BTreeMap::from([
        (PathBuf::from("a.rs"), block(&["one"], "fn one(&self) { self.two() }")),
        (PathBuf::from("b.rs"), block(&["two"], "fn two(&self) { self.one() }")),
    ]);
    let file = PathBuf::from("a.rs");
    assert!(reaches(&arrows(&files), &file, &file));
    assert_eq!(inherent("impl<'r, O: Oracle> Run<'r, O> {").as_deref(), Some("Run"));
    assert_eq!(inherent("impl Proposer for PlainCuts {"), None);
}
