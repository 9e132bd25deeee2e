//! The sizes of files, functions and lines, and how comments begin. The directions of dependency of
//! docs/architecture.md are those of the package graph.

use std::fs;
use std::path::{Path, PathBuf};

/// Longest file allowed, lines.
const LONGEST_FILE: usize = 450;

/// Longest function allowed, lines from `fn` to the closing brace.
const LONGEST_FUNCTION: usize = 60;

/// Longest line allowed, characters.
const LONGEST_LINE: usize = 120;

/// All Rust files below `folder`, without build products.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("an entry").path();
        if path.is_dir() && !path.ends_with("target") {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// Files of the repository with their text.
fn texts() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let name = |path: &Path| path.strip_prefix(root).expect("below the root").display().to_string();
    let read = |path: PathBuf| (name(&path), fs::read_to_string(&path).expect("a readable source"));
    sources(root).into_iter().map(read).collect()
}

#[test]
fn files_are_short() {
    let long = |(name, text): &(String, String)| {
        let lines = text.lines().count();
        (lines > LONGEST_FILE).then(|| format!("{name}: {lines} lines"))
    };
    let texts = texts();
    assert!(texts.len() > 200, "{} files found", texts.len());
    assert_eq!(
        texts.iter().filter_map(long).collect::<Vec<_>>(),
        Vec::<String>::new(),
        "allowed: {LONGEST_FILE} lines"
    );
}

/// Functions of a formatted text as (line, length): each ends with the first brace at its own indentation.
fn functions(text: &str) -> Vec<(usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let code = line.trim_start();
        let indent = line.len() - code.len();
        let heads = ["fn ", "pub fn ", "pub(crate) fn ", "pub(super) fn ", "const fn ", "pub const fn "];
        // A declaration without a body ends its signature with a semicolon.
        let signature = lines[start..].iter().find(|line| line.ends_with(['{', '}', ';']));
        let has_body = signature.is_some_and(|line| !line.ends_with(';'));
        if heads.iter().any(|head| code.starts_with(head)) && has_body {
            let closing = format!("{}}}", " ".repeat(indent));
            let end = lines[start..]
                .iter()
                .position(|line| *line == closing || (line.ends_with('}') && *line == lines[start]));
            found.extend(end.map(|end| (start + 1, end + 1)));
        }
    }
    found
}

#[test]
fn functions_are_short() {
    let (mut long, mut count) = (Vec::new(), 0);
    for (name, text) in texts() {
        for (line, length) in functions(&text) {
            count += 1;
            if length > LONGEST_FUNCTION {
                long.push(format!("{name}:{line}: {length} lines"));
            }
        }
    }
    assert!(count > 2000, "{count} functions found");
    assert_eq!(long, Vec::<String>::new(), "allowed: {LONGEST_FUNCTION} lines");
}

/// Lines of a text that are too long, and comments that begin with a reference to their neighbour. Exempt from the
/// length are string literals, tables, and blocks of text in a comment: their columns are aligned.
fn badly_written(text: &str) -> Vec<(usize, &'static str)> {
    let (mut found, mut block) = (Vec::new(), None);
    for (index, line) in text.lines().enumerate() {
        let comment = line.trim_start().strip_prefix("//").map(|rest| rest.trim_start_matches(['/', '!']).trim_start());
        if let Some(fence) = comment.and_then(|comment| comment.strip_prefix("```")) {
            block = if block.is_none() { Some(fence) } else { None };
        }
        let aligned = match comment {
            Some(comment) => block == Some("text") || comment.starts_with('|'),
            None => line.contains('"') || line.ends_with('\\'),
        };
        if line.chars().count() > LONGEST_LINE && !aligned {
            found.push((index + 1, "too long"));
        }
        if comment.is_some_and(|comment| comment.starts_with("The same")) && begins(text, index) {
            found.push((index + 1, "a comment that begins with \"The same\""));
        }
    }
    found
}

/// Whether a comment begins in a line: the line before is none, or an empty one.
fn begins(text: &str, index: usize) -> bool {
    let before = index.checked_sub(1).and_then(|before| text.lines().nth(before)).map_or("", str::trim_start);
    !before.starts_with("//") || before.trim_start_matches(['/', '!']).trim().is_empty()
}

#[test]
fn lines_are_short_and_comments_stand_alone() {
    let mut wrong = Vec::new();
    for (name, text) in texts() {
        wrong.extend(badly_written(&text).iter().map(|(line, fault)| format!("{name}:{line}: {fault}")));
    }
    assert_eq!(wrong, Vec::<String>::new(), "allowed: {LONGEST_LINE} characters");
}

#[test]
fn a_long_line_and_a_dependent_comment_are_found() {
    let (long, table) =
        (format!("let a = {};", "b".repeat(LONGEST_LINE)), format!("// | {} |", "b".repeat(LONGEST_LINE)));
    let text = format!(
        "{long}\n{table}\nlet c = 1;\n/// The same again.\nlet d = 1;\n//! First. This is\n//! The same line.\n"
    );
    let lines: Vec<usize> = badly_written(&text).iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [1, 4]);
}
