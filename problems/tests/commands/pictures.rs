//! Pictures in the folder of `--out`.

use std::process::Command;

#[test]
fn pictures_are_svg() {
    let folder = std::env::temp_dir().join(format!("nonsmooth-pictures-{}", std::process::id()));
    let arguments = ["--start", "-3,5", "--cells", "12", "--out"];
    let output = Command::new(env!("CARGO_BIN_EXE_toy2d")).args(arguments).arg(&folder).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    let found = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let found: Vec<String> = found.filter(|name| !name.ends_with(".json") && !name.ends_with(".txt")).collect();
    assert_eq!(found, ["landscape.svg"]);
    std::fs::remove_dir_all(&folder).unwrap();
}
