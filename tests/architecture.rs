//! The directions of dependency of docs/architecture.md, and the size of files.

use std::fs;
use std::path::{Path, PathBuf};

/// Longest file allowed, lines.
const LONGEST: usize = 450;

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the repository") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// Files below `folder` whose code names one of `words`, apart from those whose path contains one of `allowed`.
fn naming(folder: &str, words: &[&str], allowed: &[&str]) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for path in sources(&root.join(folder)) {
        let text = fs::read_to_string(&path).expect("a readable source");
        let name = path.strip_prefix(root).expect("below the root").display().to_string();
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let hits = code.filter(|line| words.iter().any(|word| line.contains(word))).count();
        if hits > 0 && !allowed.iter().any(|allowed| name.contains(allowed)) {
            found.push(name);
        }
    }
    found
}

#[test]
fn the_engine_knows_no_state_and_no_mechanics() {
    let words = ["StateSolver", "Coderivative", "ReducedObjective", "problems::"];
    assert_eq!(naming("src/bundle", &words, &[]), Vec::<String>::new());
    assert_eq!(naming("src/qp", &words, &[]), Vec::<String>::new());
    assert_eq!(naming("src", &["problems::", "faer"], &[]), Vec::<String>::new());
}

#[test]
fn the_subproblem_solver_knows_no_optimizer() {
    assert_eq!(naming("src/qp", &["crate::bundle", "crate::report", "crate::objective"], &[]), Vec::<String>::new());
}

#[test]
fn mechanics_name_the_framework_in_few_places() {
    let allowed = [
        "contact_shape",
        "cost",
        "toy",
        "membrane",
        "cli",
        "scaling",
        "stability",
        "problems/src/accuracy",
        "error.rs",
        "admissible.rs",
    ];
    assert_eq!(naming("problems/src", &["nonsmooth::"], &allowed), Vec::<String>::new());
    let optimizing = ["cli", "toy", "stability", "problems/src/accuracy", "bin/"];
    assert_eq!(naming("problems/src", &["BundleTrust"], &optimizing), Vec::<String>::new());
}

#[test]
fn the_two_contact_solvers_are_independent() {
    assert_eq!(naming("problems/src/tfeti", &["crate::direct"], &[]), Vec::<String>::new());
    let tfeti = ["crate::tfeti::TornModel", "DualOperator", "CoarseSpace", "gmres"];
    assert_eq!(naming("problems/src/direct", &tfeti, &[]), Vec::<String>::new());
}

#[test]
fn only_the_linear_algebra_and_its_users_know_faer() {
    let allowed = ["src/linear", "src/direct", "src/tfeti"];
    assert_eq!(naming("problems/src", &["faer::"], &allowed), Vec::<String>::new());
}

#[test]
fn figures_pages_and_meshes_on_disk_know_numbers_only() {
    let words = ["nonsmooth::", "crate::cli", "crate::contact", "crate::fields", "crate::scene", "crate::mesh"];
    for folder in ["problems/src/figure", "problems/src/vtk"] {
        assert_eq!(naming(folder, &words, &[]), Vec::<String>::new());
    }
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/src/page.rs")).expect("a file");
    assert!(words.iter().all(|word| !page.contains(word)));
}

#[test]
fn files_are_short() {
    for folder in ["src", "problems/src", "testset/src", "tests", "problems/tests", "examples"] {
        for path in sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)) {
            let lines = fs::read_to_string(&path).expect("a readable source").lines().count();
            assert!(lines <= LONGEST, "{} has {lines} lines, allowed {LONGEST}", path.display());
        }
    }
}
