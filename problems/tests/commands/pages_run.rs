//! The commands of the pages that start a binary of this package.

use std::path::Path;
use testset::kit::run_commands;

#[test]
fn commands_of_all_pages() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (ran, parsed) = run_commands(&root, "problems", crate::binary);
    assert!(ran >= 8 && parsed >= 4, "{ran} commands ran, {parsed} were parsed: pages have lost their commands");
}
