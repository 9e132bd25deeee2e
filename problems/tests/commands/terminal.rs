//! What the binaries say to people: help; terminals without colours.

use testset::kit::{self, command, errors};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");
const HERTZ: &str = env!("CARGO_BIN_EXE_hertz3d");

fn printed(program: &str, arguments: &[&str]) -> String {
    let output = kit::run(program, arguments);
    assert!(output.status.success(), "{}", errors(&output));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_help_has_defaults_and_ends_with_examples() {
    for (program, example) in [(CONTACT, "contact3d SCENE.toml --out"), (HERTZ, "hertz3d --out")] {
        let help = printed(program, &["--help"]);
        let (options, examples) = help.split_once("Examples:").unwrap();
        assert!(options.matches("[default: ").count() >= 17 && examples.contains(example), "{help}");
    }
    // Lines break where the terminal ends.
    let help = printed(HERTZ, &["--help"]).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("Bricks of each body: per edge, or along x1, x2 and x3 [default: [12, 12, 12]]"), "{help}");
}

/// Only words that cannot be broken are longer than the terminal is wide.
#[test]
fn the_help_fits_the_terminal() {
    for program in [CONTACT, HERTZ] {
        let output = command(program, &["--help"]).env("COLUMNS", "40").output().unwrap();
        let help = String::from_utf8(output.stdout).unwrap();
        for line in help.lines().filter(|line| line.chars().count() > 40 && !line.starts_with("Usage:")) {
            let longest = line.split_whitespace().map(|word| word.chars().count()).max().unwrap();
            let indent = line.chars().take_while(|character| *character == ' ').count();
            assert!(indent + longest > 40 || line.trim_start().starts_with('-'), "{line:?}");
        }
    }
}

#[test]
fn no_escape_sequence_is_written() {
    for arguments in [&["--mesh", "2", "--max-evaluations", "2"][..], &["--help"], &["--friction", "x"]] {
        for colours in ["1", ""] {
            let output =
                command(HERTZ, arguments).env("NO_COLOR", colours).env("CLICOLOR_FORCE", "1").output().unwrap();
            assert!(!output.stdout.contains(&0x1b) && !output.stderr.contains(&0x1b), "{}", errors(&output));
        }
    }
}
