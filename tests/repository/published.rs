//! What publishing needs: metadata, licences and Rust versions of all packages, from `cargo metadata`.

use serde_json::Value;
use spdx::{Expression, ParseMode};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Licences that ask for no more than a notice, so that MIT or Apache-2.0 can be kept.
const PERMISSIVE: [&str; 8] =
    ["MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "Zlib", "0BSD", "Unlicense", "Unicode-3.0"];

/// Licences of data inside single packages: fonts that may be embedded, and must not be sold by themselves.
const FONTS: [(&str, &str); 2] = [("epaint_default_fonts", "OFL-1.1"), ("epaint_default_fonts", "Ubuntu-font-1.0")];
/// The licences of the project, one file each.
const LICENCES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

/// The categories in use; all of them exist in the registry.
const CATEGORIES: [&str; 6] = ["algorithms", "config", "mathematics", "science", "simulation", "visualization"];

fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// All packages that this machine builds with the default features. Cargo downloads those that only problems-mpi needs,
/// which the tests do not build.
fn metadata() -> Value {
    let version = cargo(&["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("cargo tells its host");
    let text = cargo(&["metadata", "--locked", "--format-version", "1", "--filter-platform", host]);
    serde_json::from_str(&text).expect("JSON")
}

fn entries(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn packages(metadata: &Value) -> BTreeMap<&str, &Value> {
    entries(&metadata["packages"]).iter().map(|package| (text(&package["id"]), package)).collect()
}

fn is_published(package: &Value) -> bool {
    package["source"].is_null() && package["publish"].is_null()
}

/// Packages that the published ones need to be built, themselves included; not what tests need.
fn needed(metadata: &Value) -> BTreeSet<&str> {
    let nodes: BTreeMap<&str, &Value> =
        entries(&metadata["resolve"]["nodes"]).iter().map(|node| (text(&node["id"]), node)).collect();
    let published = packages(metadata).into_iter().filter(|(_, package)| is_published(package));
    let mut open: Vec<&str> = published.map(|(id, _)| id).collect();
    let mut found = BTreeSet::new();
    while let Some(id) = open.pop() {
        if found.insert(id) {
            let built =
                |dependency: &&Value| entries(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"] != "dev");
            open.extend(entries(&nodes[id]["deps"]).iter().filter(built).map(|dependency| text(&dependency["pkg"])));
        }
    }
    found
}

/// Major, minor, patch.
fn version(text: &str) -> Vec<u64> {
    let mut numbers: Vec<u64> = text.split('.').map(|number| number.parse().expect("a number")).collect();
    numbers.resize(3, 0);
    numbers
}

/// Whether licences that are allowed satisfy an expression; a slash between two licences is an old form of `OR`.
fn satisfied(expression: &str, allowed: &dyn Fn(&str) -> bool) -> bool {
    let parsed = Expression::parse_mode(expression, ParseMode::LAX);
    let parsed = parsed.unwrap_or_else(|error| panic!("licence expression {expression:?}: {error}"));
    // Exceptions (`Apache-2.0 WITH LLVM-exception`) only take conditions away.
    parsed.evaluate(|requirement| requirement.license.id().is_some_and(|licence| allowed(licence.name)))
}

/// The packages of the registry. `problems` keeps its name in the repository (docs/release.md).
const PUBLISHED: [&str; 6] =
    ["nonsmooth", "nonsmooth-contact", "nonsmooth-exchange", "nonsmooth-figures", "nonsmooth-scene-file", "problems"];

#[test]
fn six_packages_with_all_that_a_registry_asks_for() {
    let metadata = metadata();
    let packages = packages(&metadata);
    let published: Vec<&&Value> = packages.values().filter(|package| is_published(package)).collect();
    let names: BTreeSet<&str> = published.iter().map(|package| text(&package["name"])).collect();
    assert_eq!(names, BTreeSet::from(PUBLISHED));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for package in published {
        let name = text(&package["name"]);
        assert!(text(&package["description"]).len() > 40, "{name}: description");
        assert_eq!(text(&package["license"]), "MIT OR Apache-2.0", "{name}");
        let folder = Path::new(text(&package["manifest_path"])).parent().expect("a folder");
        // The README of `problems` is also that of `contact`; parts without users of their own have none.
        if !package["readme"].is_null() {
            let readme = fs::read_to_string(folder.join(text(&package["readme"]))).expect("a README");
            let title = if name == "nonsmooth-contact" { "problems" } else { name };
            assert!(readme.starts_with(&format!("# {title}\n")), "{name}: README");
        }
        for file in LICENCES {
            let own = fs::read(folder.join(file)).unwrap_or_else(|error| panic!("{name}: {file}: {error}"));
            assert_eq!(own, fs::read(root.join(file)).expect("the licence"), "{name}: {file}");
        }
        let categories: Vec<&str> = entries(&package["categories"]).iter().map(text).collect();
        assert!(!categories.is_empty() && categories.len() <= 5, "{name}: {categories:?}");
        assert!(categories.iter().all(|category| CATEGORIES.contains(category)), "{name}: {categories:?}");
        let keywords: Vec<&str> = entries(&package["keywords"]).iter().map(text).collect();
        assert!(!keywords.is_empty() && keywords.len() <= 5, "{name}: {keywords:?}");
        let plain = |word: &&str| word.len() <= 20 && word.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        assert!(keywords.iter().all(plain), "{name}: {keywords:?}");
    }
}

/// A wheel has the licences that its metadata name.
#[test]
fn the_python_package_brings_its_licences() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for file in LICENCES {
        let own = fs::read(root.join("python/licenses").join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert_eq!(own, fs::read(root.join(file)).expect("the licence"), "{file}");
    }
}

#[test]
fn the_rust_version_is_the_newest_that_a_dependency_asks_for() {
    let metadata = metadata();
    let asked = packages(&metadata).into_values().filter(|package| !package["source"].is_null());
    let asked = asked.filter(|package| !package["rust_version"].is_null());
    let newest = asked.map(|package| (version(text(&package["rust_version"])), text(&package["name"]))).max();
    let (newest, name) = newest.expect("a dependency that names its Rust version");
    assert_eq!(version(env!("CARGO_PKG_RUST_VERSION")), newest, "{name}");
}

#[test]
fn dependencies_have_licences_that_ask_for_a_notice_only() {
    let metadata = metadata();
    let packages = packages(&metadata);
    let needed = needed(&metadata);
    assert!(needed.len() > 50 && needed.len() < packages.len(), "{} of {}", needed.len(), packages.len());
    for id in needed {
        let (name, expression) = (text(&packages[id]["name"]), text(&packages[id]["license"]));
        let allowed = |licence: &str| PERMISSIVE.contains(&licence) || FONTS.contains(&(name, licence));
        assert!(satisfied(expression, &allowed), "{name}: licence {expression:?}");
    }
}
