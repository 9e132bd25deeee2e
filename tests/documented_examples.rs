//! Every `cargo run --example` of the pages runs and succeeds.

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
