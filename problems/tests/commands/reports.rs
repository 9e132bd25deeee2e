//! What `--out DIR` delivers: reports, pictures, files for ParaView; and nothing of it without being asked.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder that is removed with the test.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("nonsmooth-reports-{}-{name}", std::process::id()));
        let _absent = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn read(&self, file: &str) -> String {
        std::fs::read_to_string(self.0.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn output(folder: &Path, binary: &str, arguments: &[&str]) -> Output {
    let path = match binary {
        "contact3d" => env!("CARGO_BIN_EXE_contact3d"),
        "hertz3d" => env!("CARGO_BIN_EXE_hertz3d"),
        _ => env!("CARGO_BIN_EXE_signorini3d"),
    };
    Command::new(path).args(arguments).arg("--json").current_dir(folder).env_remove("RUST_LOG").output().unwrap()
}

/// Runs a binary in a folder; its JSON.
fn run(folder: &Path, binary: &str, arguments: &[&str]) -> Value {
    let output = output(folder, binary, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Every figure exists as SVG (and as PNG, if the program can), is well-formed, and stands in the page, which loads nothing else.
fn check_page(scratch: &Scratch, folder: &str, figures: &[&str]) -> String {
    let found = names(&scratch.0.join(folder).join("figures"));
    let endings: &[&str] = if cfg!(feature = "png") { &["svg", "png"] } else { &["svg"] };
    let expected =
        figures.iter().flat_map(|name| endings.iter().map(move |ending| format!("{name}.{ending}"))).collect();
    assert_eq!(found, expected, "{folder}");
    for name in figures {
        let svg = scratch.read(&format!("{folder}/figures/{name}.svg"));
        assert!(roxmltree::Document::parse(&svg).is_ok(), "{name}");
    }
    let page = scratch.read(&format!("{folder}/report.html"));
    assert_eq!(page.matches("data:image/svg+xml;base64,").count(), figures.len());
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    for loaded in ["http://", "https://", "<link", "<script", "src=\"figures"] {
        assert!(!page.contains(loaded), "{folder}: {loaded}");
    }
    page
}

const OPTIMIZATION: [&str; 4] = ["pressure", "von_mises", "surface", "convergence"];

#[test]
fn an_optimization_delivers_page_pictures_and_fields() {
    let scratch = Scratch::new("optimize");
    let result = run(&scratch.0, "signorini3d", &["--mesh", "4", "--max-evaluations", "6", "--out", "run"]);
    let page = check_page(&scratch, "run", &OPTIMIZATION);
    // Numbers of the page are those of the JSON.
    for (key, digits) in [("objective_start", 10), ("objective", 10)] {
        let value = format!("{:.digits$e}", result[key].as_f64().unwrap());
        assert!(page.contains(&value), "{key}: {value}");
    }
    for words in ["evaluation limit reached", "aggregate subgradient", "least value for this total force", "[surface]"]
    {
        assert!(page.contains(words), "{words}");
    }
    let expected = ["initial", "optimal"]
        .into_iter()
        .flat_map(|name| [format!("{name}_bodies.vtu"), format!("{name}_contact.vtu")]);
    let expected: BTreeSet<String> = expected.chain(["fields.pvd".to_owned()]).collect();
    assert_eq!(names(&scratch.0.join("run/vtk")), expected);
    // Every file that the page names exists.
    let table = page.split("<th>holds</th>").nth(1).unwrap();
    let rows: Vec<&str> = table.split("<tr><td>").skip(1).map(|row| row.split("</td>").next().unwrap()).collect();
    assert!(rows.len() >= 10, "{rows:?}");
    for row in rows {
        // "figures/pressure.svg, .png" and "vtk/fields.pvd, *.vtu" name a kind of files after the first.
        let named = row.split(", ").filter(|name| !name.starts_with(['.', '*', '…']));
        for file in named {
            assert!(scratch.0.join("run").join(file).exists(), "{file}");
        }
    }
}

#[test]
fn an_evaluation_of_two_bodies_delivers_them_too() {
    let scratch = Scratch::new("evaluate");
    let result = run(&scratch.0, "hertz3d", &["evaluate", "--mesh", "4", "--out", "state"]);
    let page = check_page(&scratch, "state", &["pressure", "von_mises", "surface"]);
    assert!(page.contains(&format!("{:.10e}", result["objective"].as_f64().unwrap())));
    let written: Value = serde_json::from_str(&scratch.read("state/evaluation.json")).unwrap();
    assert_eq!(written["subgradient"], result["subgradient"]);
    assert!(scratch.read("state/vtk/shape_contact.vtu").contains("sensitivity"));
    assert!(scratch.read("state/pressure_shape.csv").lines().count() == 26);
}

#[test]
fn a_comparison_delivers_its_own_page_and_those_of_both_runs() {
    let scratch = Scratch::new("compare");
    let arguments = ["compare", "--mesh", "4", "--max-evaluations", "5", "--out", "both"];
    let result = run(&scratch.0, "signorini3d", &arguments);
    let page = check_page(&scratch, "both", &["pressure", "von_mises", "surface"]);
    for sentence in result["conclusion"].as_array().unwrap() {
        assert!(page.contains(sentence.as_str().unwrap()), "{sentence}");
    }
    for part in ["with_friction", "without_friction"] {
        check_page(&scratch, &format!("both/{part}"), &OPTIMIZATION);
    }
}

#[test]
fn what_is_not_asked_for_is_not_made() {
    let scratch = Scratch::new("quiet");
    let scene = include_str!("../../scenes/signorini.toml");
    let mesh = ["--mesh", "4"];
    // No folder: no file.
    run(&scratch.0, "signorini3d", &["--mesh", "4", "--max-evaluations", "2"]);
    assert!(names(&scratch.0).is_empty());
    // A folder without pictures, fields and page: text and tables only.
    let quiet = format!("{scene}\n[output]\nfolder = \"run\"\npictures = false\nvtk = false\nreport = false\n");
    std::fs::write(scratch.0.join("quiet.toml"), quiet).unwrap();
    run(&scratch.0, "contact3d", &["quiet.toml", "evaluate", mesh[0], mesh[1]]);
    assert_eq!(names(&scratch.0.join("run")), ["evaluation.json", "pressure_shape.csv"].map(String::from).into());
}

#[test]
fn no_command_replaces_the_report_of_an_optimization_by_the_way() {
    let scratch = Scratch::new("kept");
    run(&scratch.0, "signorini3d", &["--mesh", "4", "--max-evaluations", "6", "--out", "run"]);
    let report = scratch.read("run/report.html");
    for arguments in [
        &["evaluate", "--mesh", "4", "--out", "run"][..],
        &["verify", "--mesh", "4", "--out", "run"],
        &["--resume", "run", "--max-evaluations", "3"],
    ] {
        let output = output(&scratch.0, "signorini3d", arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains("run") || message.contains("at least the 6 evaluations"), "{message}");
    }
    assert_eq!(scratch.read("run/report.html"), report);
    // The scene that the folder keeps does not send other commands there.
    run(&scratch.0, "contact3d", &["run/scene.toml", "evaluate"]);
    assert_eq!(scratch.read("run/report.html"), report);
    // A second run with the same folder replaces the first, and says so.
    let again = output(&scratch.0, "signorini3d", &["--mesh", "4", "--max-evaluations", "2", "--out", "run"]);
    assert!(again.status.success() && String::from_utf8_lossy(&again.stderr).contains("is replaced"));
}

#[test]
fn a_verification_leaves_its_table() {
    let scratch = Scratch::new("verify");
    let result = run(&scratch.0, "signorini3d", &["verify", "--mesh", "4", "--out", "table"]);
    let written: Value = serde_json::from_str(&scratch.read("table/verification.json")).unwrap();
    assert_eq!(written["smooth_step"], result["smooth_step"]);
    assert!(scratch.read("table/verification.txt").contains("nearest kink"));
}

#[test]
fn growing_meshes_stand_in_the_page_with_their_own_numbers() {
    let scratch = Scratch::new("stages");
    let arguments = ["--continuation", "2,4", "--max-evaluations", "3", "--out", "run"];
    let result = run(&scratch.0, "signorini3d", &arguments);
    let page = check_page(&scratch, "run", &OPTIMIZATION);
    assert!(page.contains("3 + 3 evaluations on growing meshes") && page.contains("Growing meshes"));
    for stage in result["stages"].as_array().unwrap() {
        assert!(page.contains(&format!("{:.4e}", stage["objective"].as_f64().unwrap())), "{stage}");
    }
}
