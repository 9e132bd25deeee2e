//! Every `cargo run --example` of the pages runs and succeeds; every link and every path that they name exists.

#[path = "common/pages.rs"]
mod pages;

use std::path::{Path, PathBuf};
use std::process::Command;

/// The built example, beside this test's folder; built now if the test was built alone.
fn executable(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("the path of this test");
    let profile = test.parent().and_then(Path::parent).expect("PROFILE/deps/TEST");
    let file = profile.join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if !file.exists() {
        let release = if profile.ends_with("release") { &["--release"][..] } else { &[] };
        let build = ["build", "--quiet", "--locked", "--offline", "-p", "nonsmooth", "--example", name];
        let status = Command::new(env!("CARGO")).args(build).args(release).status().expect("cargo starts");
        assert!(status.success(), "example {name} cannot be built");
    }
    file
}

#[test]
fn examples_of_all_pages() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut ran = 0;
    for page in pages::all(root) {
        for command in &page.commands {
            let Some(name) = command.cargo_option("--example") else { continue };
            assert!(root.join("examples").join(name).with_extension("rs").exists(), "{}: no {name}", command.place);
            if command.slow {
                continue;
            }
            let output = Command::new(executable(name)).args(command.arguments()).output().expect("an example starts");
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: {}: {error}", command.place, command.line());
            assert!(!output.stdout.is_empty(), "{}: {}: prints nothing", command.place, command.line());
            ran += 1;
        }
    }
    assert!(ran >= 6, "{ran} examples ran: pages have lost their commands");
}

/// Targets of the links `](target)` of a text, without those to other sites and to places within the page.
fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next());
    targets.filter(|target| !target.is_empty() && !target.contains("://")).collect()
}

/// Paths from the root of the repository that a text names as code.
fn paths(text: &str) -> Vec<&str> {
    let plain = |span: &&str| span.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c));
    let folders = ["docs/", "src/", "examples/", "tests/", "problems/src/", "problems/tests/", "problems/scenes/"];
    let code = text.split('`').skip(1).step_by(2).filter(plain);
    code.filter(|span| folders.iter().any(|folder| span.starts_with(folder))).collect()
}

#[test]
fn links_and_paths_of_all_pages_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut checked = 0;
    for page in pages::all(root) {
        let file = root.join(&page.name);
        let text = std::fs::read_to_string(&file).expect("a readable page");
        let folder = file.parent().expect("a folder");
        for target in links(&text) {
            assert!(folder.join(target).exists(), "{}: the link {target} leads nowhere", page.name);
            checked += 1;
        }
        for path in paths(&text) {
            assert!(root.join(path).exists(), "{}: there is no {path}", page.name);
            checked += 1;
        }
    }
    assert!(checked >= 60, "only {checked} links and paths found");
}
