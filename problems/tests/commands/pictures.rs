//! Pictures in the folder of `--out`.

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn pictures_are_svg() {
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
        assert_eq!(found, pictures.iter().map(|name| format!("{name}.svg")).collect());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
