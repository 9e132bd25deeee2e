//! What sources and pages refer to exists: equations and sections of `docs/method.md`, entries of
//! `docs/references.bib`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Sources and pages below `folder`, without build products and hidden folders.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("an entry").path();
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !hidden && !path.ends_with("target") {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "md") {
            found.push(path);
        }
    }
    found
}

/// The lines in which references stand, with their place: comments of sources, all lines of pages.
fn lines() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for path in files(root) {
        let name = path.strip_prefix(root).expect("below the root").display().to_string();
        let text = fs::read_to_string(&path).expect("a readable file");
        for (number, line) in text.lines().enumerate() {
            if name.ends_with(".md") || line.trim_start().starts_with("//") {
                found.push((format!("{name}:{}", number + 1), line.to_owned()));
            }
        }
    }
    found
}

fn read(page: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page)).expect("a page of the repository")
}

/// Whether a text is an equation number: one digit, a dot, one digit.
fn is_number(text: &str) -> bool {
    matches!(text.as_bytes(), [a, b'.', b] if a.is_ascii_digit() && b.is_ascii_digit())
}

/// Equation numbers in brackets, but not arguments of calls and not those of the paper.
fn bracketed(line: &str) -> Vec<&str> {
    let start =
        |at: usize| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') && !line[..at].ends_with("paper ");
    let inside = |at: usize| line[at + 1..].split_once(')').map(|(inside, _)| inside);
    let places = line.match_indices('(').map(|(at, _)| at).filter(|at| start(*at));
    places.filter_map(inside).filter(|inside| is_number(inside)).collect()
}

/// Numbers of sections that follow the words "method.md".
fn sections(line: &str) -> Vec<&str> {
    let Some((_, after)) = line.split_once("method.md") else { return Vec::new() };
    let Some((_, after)) = after.split_once("section") else { return Vec::new() };
    let words = after.trim_start_matches('s').split_whitespace();
    let numbers = words
        .map(|word| word.trim_end_matches(['.', ',', ';', ':', ')']))
        .take_while(|word| *word == "and" || word.chars().all(|c| c.is_ascii_digit()));
    numbers.filter(|word| *word != "and").collect()
}

/// Citation keys of a line, the family names and the year in brackets; in documentation comments with `\[` and `\]`.
fn citations(line: &str) -> Vec<String> {
    let plain = line.replace("\\[", "[").replace("\\]", "]");
    let inside = plain.split('[').skip(1).filter_map(|rest| rest.split_once(']').map(|(inside, _)| inside));
    let is_key = |text: &&str| {
        let (family, year) = text.split_at_checked(text.len().saturating_sub(4)).unwrap_or_default();
        family.starts_with(|c: char| c.is_ascii_uppercase())
            && family.chars().all(|c| c.is_ascii_alphabetic())
            && year.chars().all(|c| c.is_ascii_digit())
    };
    inside.filter(is_key).map(str::to_owned).collect()
}

#[test]
fn every_equation_and_section_exists() {
    let method = read("docs/method.md");
    let is_formula = |line: &&str| line.starts_with("    ") && line.ends_with(')');
    let formulas: Vec<&str> = method.lines().filter(is_formula).filter_map(|line| bracketed(line).pop()).collect();
    let equations: BTreeSet<&str> = formulas.iter().copied().collect();
    assert_eq!(equations.len(), formulas.len(), "a number stands for two equations: {formulas:?}");
    let headings = method.lines().filter_map(|line| line.strip_prefix("## "));
    let headings: BTreeSet<&str> = headings.filter_map(|line| line.split_once('.').map(|(number, _)| number)).collect();
    let (mut missing, mut checked) = (Vec::new(), 0);
    for (place, line) in lines() {
        let numbers = bracketed(&line).into_iter().filter(|number| !equations.contains(number));
        let numbers = numbers.chain(sections(&line).into_iter().filter(|number| !headings.contains(number)));
        missing.extend(numbers.map(|number| format!("{place}: {number}")));
        checked += bracketed(&line).len() + sections(&line).len();
    }
    assert_eq!(missing, Vec::<String>::new(), "not in docs/method.md");
    assert!(checked > 50, "only {checked} references found");
}

#[test]
fn every_citation_has_an_entry_and_every_entry_is_cited() {
    let bibliography = read("docs/references.bib");
    let heads = bibliography.lines().filter(|line| line.starts_with('@'));
    let keys: Vec<&str> = heads.filter_map(|line| line.split_once('{')?.1.strip_suffix(',')).collect();
    let entries: BTreeSet<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    assert_eq!(entries.len(), keys.len(), "a key stands for two entries");
    let mut cited = BTreeSet::new();
    let mut missing = Vec::new();
    for (place, line) in lines() {
        for key in citations(&line) {
            if !entries.contains(&key) {
                missing.push(format!("{place}: {key}"));
            }
            cited.insert(key);
        }
    }
    assert_eq!(missing, Vec::<String>::new(), "not in docs/references.bib");
    assert_eq!(entries.difference(&cited).collect::<Vec<_>>(), Vec::<&String>::new(), "cited nowhere");
}
