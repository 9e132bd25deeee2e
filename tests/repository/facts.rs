//! Numbers that several pages state are those of `docs/facts.toml`; the pages keep their budgets of words.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use testset::kit::facts;

/// Words of all pages, of one, and of README.md: what a reader can be expected to look through.
const MOST_WORDS: [usize; 3] = [42_000, 4_000, 1_000];

/// Pages by their paths.
fn pages() -> BTreeMap<String, String> {
    fn add(found: &mut BTreeMap<String, String>, root: &Path, folder: &Path) {
        for entry in fs::read_dir(folder).unwrap() {
            let path: PathBuf = entry.unwrap().path();
            if path.is_dir() && folder != root {
                add(found, root, &path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                let name = path.strip_prefix(root).unwrap().display().to_string();
                found.insert(name, fs::read_to_string(path).unwrap());
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = BTreeMap::new();
    add(&mut found, root, root);
    add(&mut found, root, &root.join("docs"));
    found
}

/// A text on one line.
fn plain(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Numbers that stand in a text where the phrase has `{}`.
fn stated<'t>(text: &'t str, before: &str, after: &str) -> Vec<&'t str> {
    let starts = text.match_indices(before).map(|(at, _)| &text[at + before.len()..]);
    let numbers = starts.filter_map(|rest| rest.split_once(after).map(|(number, _)| number));
    numbers.filter(|number| number.len() < 24 && number.starts_with(|c: char| c.is_ascii_digit())).collect()
}

#[test]
fn pages_state_the_measured_facts() {
    let texts: BTreeMap<String, String> = pages().into_iter().map(|(name, text)| (name, plain(&text))).collect();
    let mut names = Vec::new();
    for fact in facts::facts() {
        assert!(fact.stated.len() >= 2, "{}: a fact is stated at two places or more", fact.name);
        assert!(!names.contains(&fact.name), "{}: twice", fact.name);
        let is_path = fact.measured.contains('/') && !fact.measured.contains(' ');
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(&fact.measured);
        assert!(!is_path || path.exists(), "{}: there is no {}", fact.name, fact.measured);
        for place in &fact.stated {
            let (page, phrase) = place.split_once(": ").expect("PAGE: text");
            let (before, after) = phrase.split_once("{}").expect("a text with {}");
            assert!(before.len() + after.len() >= 10, "{place}: too few words around the number");
            let text = texts.get(page).unwrap_or_else(|| panic!("{place}: no such page"));
            assert!(stated(text, before, after).contains(&fact.value.as_str()), "{place}: not {}", fact.value);
            // These words with another number, on any page.
            for (other, text) in &texts {
                let others: Vec<&str> =
                    stated(text, before, after).into_iter().filter(|found| *found != fact.value).collect();
                assert!(others.is_empty(), "{other}: {phrase} with {others:?} in place of {}", fact.value);
            }
        }
        names.push(fact.name);
    }
    assert!(names.len() >= 15, "{} facts", names.len());
}

#[test]
fn pages_keep_their_budgets_of_words() {
    let words: BTreeMap<String, usize> =
        pages().into_iter().map(|(name, text)| (name, text.split_whitespace().count())).collect();
    let [all, one, readme] = MOST_WORDS;
    let long: Vec<_> = words.iter().filter(|(_, count)| **count > one).collect();
    assert!(long.is_empty(), "more than {one} words: {long:?}");
    assert!(words["README.md"] <= readme, "README.md has {} words", words["README.md"]);
    let total: usize = words.values().sum();
    assert!(total <= all, "{total} words on all pages");
}

/// Codes of warnings, as a file makes them.
fn codes(file: &str) -> Vec<String> {
    let source = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let source = source.split("#[cfg(test)]").next().unwrap_or_default();
    let makes = |line: &&str| line.contains("code: \"") || line.trim_start().starts_with("warn(");
    let texts = source.lines().filter(makes).flat_map(|line| line.split('"').skip(1).step_by(2));
    let is_code = |text: &&str| !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    texts.filter(is_code).map(str::to_owned).collect()
}

#[test]
fn every_code_of_a_warning_has_its_remedy_on_the_page() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/warnings.md")).unwrap();
    let first_cells = page.lines().filter_map(|line| line.strip_prefix("| `")?.split_once(" |"));
    let listed: Vec<&str> = first_cells.flat_map(|(cell, _)| cell.trim_end_matches('`').split("`, `")).collect();
    let mut made = Vec::new();
    for file in ["contact/src/plausibility.rs", "contact/src/standstill.rs", "src/commands/optimize/summary.rs"] {
        made.extend(codes(&format!("problems/{file}")));
    }
    // Of Python: a run whose checks failed.
    made.push("not-checked".to_owned());
    assert!(made.len() >= 18, "{made:?}");
    for code in &made {
        assert!(listed.contains(&code.as_str()), "docs/warnings.md does not list {code}");
    }
    for code in listed {
        assert!(made.iter().any(|own| own == code), "docs/warnings.md lists {code}, which nothing makes");
    }
}
