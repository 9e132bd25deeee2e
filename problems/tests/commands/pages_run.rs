//! The commands of the pages that start a binary of this package.

use crate::documented_commands::run_all;
use std::path::Path;

fn binary(name: &str) -> Option<&'static str> {
    Some(match name {
        "contact3d" => env!("CARGO_BIN_EXE_contact3d"),
        "hertz3d" => env!("CARGO_BIN_EXE_hertz3d"),
        "membrane2d" => env!("CARGO_BIN_EXE_membrane2d"),
        "signorini3d" => env!("CARGO_BIN_EXE_signorini3d"),
        "toy2d" => env!("CARGO_BIN_EXE_toy2d"),
        _ => return None,
    })
}

#[test]
fn commands_of_all_pages() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (ran, parsed) = run_all(&root, "problems", binary);
    assert!(ran >= 8 && parsed >= 4, "{ran} commands ran, {parsed} were parsed: pages have lost their commands");
}
