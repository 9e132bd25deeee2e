//! Pictures in the folder of `--out`: SVG always, PNG from a program that was built with the feature `png`.

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn pictures_are_svg_and_with_the_feature_png_as_well() {
    let binaries = [
        (env!("CARGO_BIN_EXE_toy2d"), ["--start", "-3,5"], &["landscape"][..]),
        (env!("CARGO_BIN_EXE_membrane2d"), ["--max-evaluations", "3"], &["displacement", "reaction"]),
    ];
    for (binary, arguments, pictures) in binaries {
        let folder = std::env::temp_dir().join(format!("nonsmooth-pictures-{}-{}", std::process::id(), pictures[0]));
        let output =
            Command::new(binary).args(arguments).args(["--cells", "12", "--out"]).arg(&folder).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        let found = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let found: BTreeSet<String> =
            found.filter(|name| !name.ends_with(".json") && !name.ends_with(".txt")).collect();
        let endings: &[&str] = if cfg!(feature = "png") { &["svg", "png"] } else { &["svg"] };
        let expected = |name| endings.iter().map(move |ending| format!("{name}.{ending}"));
        assert_eq!(found, pictures.iter().flat_map(expected).collect());
        // One line for all pictures, and only where there is something to get.
        assert_eq!(said.lines().filter(|line| line.contains("--features png")).count(), 2 - endings.len(), "{said}");
        #[cfg(feature = "png")]
        for name in pictures {
            let picture = std::fs::read(folder.join(format!("{name}.png"))).unwrap();
            assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n") && picture.len() > 5000, "{name}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
