//! The commands of the pages that start a study.

use std::path::Path;
use testset::kit::run_commands;

fn binary(name: &str) -> Option<&'static str> {
    Some(match name {
        "accuracy" => env!("CARGO_BIN_EXE_accuracy"),
        "headline" => env!("CARGO_BIN_EXE_headline"),
        "scaling" => env!("CARGO_BIN_EXE_scaling"),
        "stability" => env!("CARGO_BIN_EXE_stability"),
        _ => return None,
    })
}

#[test]
fn commands_of_all_pages() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (ran, parsed) = run_commands(&root, "studies", binary);
    assert!(ran >= 1 && parsed >= 1, "{ran} commands ran, {parsed} were parsed: pages have lost their commands");
}
