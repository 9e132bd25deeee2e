//! Files do not use each other in circles. A file uses another one by `use crate::…`, `use super::…` or a path
//! `crate::…`; a name that a module hands on counts where it is defined.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of sources.
const SOURCES: [&str; 10] = [
    "src",
    "problems/contact/src",
    "problems/exchange/src",
    "problems/figures/src",
    "problems/mpi/src",
    "problems/scene_file/src",
    "problems/src",
    "problems/studies/src",
    "python/src",
    "testset/src",
];

/// A module or an item in one: the names of its ancestors and its own.
type Place = Vec<String>;

/// A file: its name, the places that it uses, and those that it hands on.
#[derive(Default)]
struct Source {
    file: String,
    used: Vec<Place>,
    handed_on: Vec<Place>,
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of sources").map(|entry| entry.expect("an entry").path());
    let of = |path: PathBuf| if path.is_dir() { rust_files(&path) } else { vec![path] };
    let files = entries.filter(|path| !path.ends_with("bin")).flat_map(of);
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// `a::{b,c::{d,e}}` as `a::b`, `a::c::d`, `a::c::e`.
fn expanded(tree: &str) -> Vec<String> {
    let Some(open) = tree.find('{') else { return vec![tree.to_owned()] };
    let (before, inner) = (&tree[..open], &tree[open + 1..tree.len() - 1]);
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for letter in inner.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        match parts.last_mut() {
            Some(part) if letter != ',' || depth > 0 => part.push(letter),
            _ => parts.push(String::new()),
        }
    }
    parts.iter().filter(|part| !part.is_empty()).flat_map(|part| expanded(&format!("{before}{part}"))).collect()
}

/// The place of a path such as `super::a::B` in a module; none outside of the package.
fn place(path: &str, module: &[String], modules: &BTreeSet<Place>) -> Option<Place> {
    let names: Vec<String> = path.split("::").filter(|name| *name != "self").map(str::to_owned).collect();
    let ups = names.iter().take_while(|name| *name == "super").count();
    let child = [module, &names[..1.min(names.len())]].concat();
    match names.first().map(String::as_str) {
        Some("crate") => Some(names[1..].to_vec()),
        _ if ups > 0 || path.starts_with("self") => Some([&module[..module.len() - ups], &names[ups..]].concat()),
        _ => modules.contains(&child).then(|| [module, &names].concat()),
    }
}

/// What a text uses and hands on; its unit tests are left out.
fn source(file: String, text: &str, module: &[String], modules: &BTreeSet<Place>) -> Source {
    let code = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut lines = code.lines().map(str::trim).filter(|line| !line.starts_with("//"));
    let mut source = Source { file, ..Source::default() };
    while let Some(line) = lines.next() {
        let statement = line
            .split_once("use ")
            .filter(|(before, _)| ["", "pub"].contains(&before.trim_end()) || before.ends_with(") "));
        let Some((before, tree)) = statement else {
            let path = |rest: &str| {
                rest.chars().take_while(|letter| letter.is_alphanumeric() || "_:".contains(*letter)).collect()
            };
            let paths: Vec<String> = line.split("crate::").skip(1).map(path).collect();
            source.used.extend(paths.iter().filter_map(|path| place(&format!("crate::{path}"), module, modules)));
            continue;
        };
        let mut tree = tree.to_owned();
        while !tree.ends_with(';') {
            tree += lines.next().unwrap_or(";");
        }
        let tree: String = tree.trim_end_matches(';').replace(" as ", "@").split_whitespace().collect();
        for path in expanded(&tree) {
            let found = place(path.split('@').next().unwrap_or_default(), module, modules);
            if before.is_empty() { source.used.extend(found) } else { source.handed_on.extend(found) }
        }
    }
    source
}

/// The file that defines what stands at a place.
fn defining<'a>(at: &[String], sources: &'a BTreeMap<Place, Source>) -> Option<&'a str> {
    let source = (0..=at.len()).rev().find_map(|length| sources.get(&at[..length]).map(|source| (length, source)));
    let (length, source) = source?;
    let on = source.handed_on.iter().find(|place| length < at.len() && place.last() == at.get(length) && **place != at);
    on.map_or(Some(&source.file), |place| defining(place, sources))
}

/// All files that a file uses, directly or by others.
fn reached<'a>(file: &'a str, uses: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> BTreeSet<&'a str> {
    let (mut found, mut open) = (BTreeSet::new(), vec![file]);
    while let Some(file) = open.pop() {
        open.extend(uses[file].iter().copied().filter(|next| found.insert(*next)));
    }
    found
}

#[test]
fn no_file_is_in_a_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut in_circles, mut count) = (Vec::new(), 0);
    for folder in SOURCES {
        let files = rust_files(&root.join(folder));
        let module = |path: &Path| -> Place {
            let path = path.strip_prefix(root.join(folder)).expect("below its folder").with_extension("");
            let names = path.iter().map(|name| name.to_string_lossy().into_owned());
            names.filter(|name| !["lib", "mod"].contains(&name.as_str())).collect()
        };
        let modules: BTreeSet<Place> = files.iter().map(|path| module(path)).collect();
        let read = |path: &PathBuf| {
            let name = path.strip_prefix(root).expect("below the root").display().to_string();
            let text = fs::read_to_string(path).expect("a readable source");
            (module(path), source(name, &text, &module(path), &modules))
        };
        let sources: BTreeMap<Place, Source> = files.iter().map(read).collect();
        let uses: BTreeMap<&str, BTreeSet<&str>> = sources
            .values()
            .map(|source| {
                let used = source.used.iter().filter_map(|place| defining(place, &sources));
                (source.file.as_str(), used.filter(|file| *file != source.file).collect())
            })
            .collect();
        let files = uses.keys().filter(|file| reached(file, &uses).contains(*file));
        in_circles.extend(files.map(|file| (*file).to_owned()));
        count += uses.values().map(BTreeSet::len).sum::<usize>();
    }
    assert!(count > 1000, "{count} uses found");
    assert_eq!(in_circles, Vec::<String>::new(), "files in circles");
}
