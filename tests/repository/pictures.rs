//! Pictures of the pages: `docs/pictures/make.py` makes each of them, and a page shows it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Files of a folder of the repository with one of these extensions.
fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|own| extensions.iter().any(|one| own == *one))).collect()
}

#[test]
fn every_picture_has_an_entry_in_the_script_and_a_page_that_shows_it() {
    let pictures = files("docs/pictures", &["png", "svg"]);
    let pictures: BTreeSet<String> =
        pictures.iter().map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pictures/make.py");
    let script = fs::read_to_string(script).unwrap();
    // Entries of pictures are tuples, those of runs are lists.
    let entries = script.lines().filter_map(|line| line.strip_prefix("    \"")?.split_once("\": ("));
    let made: BTreeSet<String> = entries.map(|(name, _)| name.to_owned()).collect();
    assert_eq!(made, pictures, "entries of docs/pictures/make.py against files");
    let mut shown = BTreeSet::new();
    for page in files("", &["md"]).into_iter().chain(files("docs", &["md"])) {
        let text = fs::read_to_string(page).unwrap();
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target);
        let targets =
            targets.filter_map(|target| target.strip_prefix("docs/").unwrap_or(target).strip_prefix("pictures/"));
        shown.extend(targets.map(str::to_owned));
    }
    assert_eq!(shown, pictures, "pictures on pages against files");
}
