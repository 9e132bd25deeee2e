//! What `--out DIR` delivers: reports, pictures, files for ParaView; and nothing of it without being asked.

use crate::binary;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Output;
use testset::kit;

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn output(folder: &Path, name: &str, arguments: &[&str]) -> Output {
    let mut command = kit::command(binary(name).unwrap(), arguments);
    command.arg("--json").current_dir(folder).output().unwrap()
}

/// Runs a binary in a folder; its JSON.
fn run(folder: &Path, name: &str, arguments: &[&str]) -> Value {
    kit::parsed(&output(folder, name, arguments))
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// Every figure exists as SVG (and as PNG, if the program can), is well-formed, and stands in the page, which loads nothing else.
fn check_page(scratch: &Path, folder: &str, figures: &[&str]) -> String {
    let found = names(&scratch.join(folder).join("figures"));
    let endings: &[&str] = if cfg!(feature = "png") { &["svg", "png"] } else { &["svg"] };
    let expected =
        figures.iter().flat_map(|name| endings.iter().map(move |ending| format!("{name}.{ending}"))).collect();
    assert_eq!(found, expected, "{folder}");
    for name in figures {
        let svg = read(scratch, &format!("{folder}/figures/{name}.svg"));
        assert!(roxmltree::Document::parse(&svg).is_ok(), "{name}");
    }
    let page = read(scratch, &format!("{folder}/report.html"));
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
    let folder = kit::scratch();
    let scratch = folder.path();
    let result = run(scratch, "signorini3d", &["--mesh", "4", "--max-evaluations", "6", "--out", "run"]);
    let page = check_page(scratch, "run", &OPTIMIZATION);
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
    let expected: BTreeSet<String> = expected.chain(["fields.pvd", "view.py"].map(str::to_owned)).collect();
    assert_eq!(names(&scratch.join("run/vtk")), expected);
    // Every file that the page names exists.
    let table = page.split("<th>holds</th>").nth(1).unwrap();
    let rows: Vec<&str> = table.split("<tr><td>").skip(1).map(|row| row.split("</td>").next().unwrap()).collect();
    assert!(rows.len() >= 10, "{rows:?}");
    for row in rows {
        // "figures/pressure.svg, .png" and "vtk/fields.pvd, *.vtu" name a kind of files after the first.
        let named = row.split(", ").filter(|name| !name.starts_with(['.', '*', '…']));
        for file in named {
            assert!(scratch.join("run").join(file).exists(), "{file}");
        }
    }
}

#[test]
fn an_evaluation_of_two_bodies_delivers_them_too() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let result = run(scratch, "hertz3d", &["evaluate", "--mesh", "4", "--out", "state"]);
    let page = check_page(scratch, "state", &["pressure", "von_mises", "surface"]);
    assert!(page.contains(&format!("{:.10e}", result["objective"].as_f64().unwrap())));
    let written = kit::read_json(&scratch.join("state/evaluation.json"));
    assert_eq!(written["subgradient"], result["subgradient"]);
    assert!(read(scratch, "state/vtk/shape_contact.vtu").contains("sensitivity"));
    assert!(read(scratch, "state/pressure_shape.csv").lines().count() == 26);
}

#[test]
fn a_comparison_delivers_its_own_page_and_those_of_both_runs() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let arguments = ["compare", "--mesh", "4", "--max-evaluations", "5", "--out", "both"];
    let result = run(scratch, "signorini3d", &arguments);
    let page = check_page(scratch, "both", &["pressure", "von_mises", "surface"]);
    for sentence in result["conclusion"].as_array().unwrap() {
        assert!(page.contains(sentence.as_str().unwrap()), "{sentence}");
    }
    for part in ["with_friction", "without_friction"] {
        check_page(scratch, &format!("both/{part}"), &OPTIMIZATION);
    }
}

#[test]
fn what_is_not_asked_for_is_not_made() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let scene = include_str!("../../scenes/signorini.toml");
    let mesh = ["--mesh", "4"];
    // No folder: no file.
    run(scratch, "signorini3d", &["--mesh", "4", "--max-evaluations", "2"]);
    assert!(names(scratch).is_empty());
    // A folder without pictures, fields and page: text and tables only.
    let quiet = format!("{scene}\n[output]\nfolder = \"run\"\npictures = false\nvtk = false\nreport = false\n");
    std::fs::write(scratch.join("quiet.toml"), quiet).unwrap();
    run(scratch, "contact3d", &["quiet.toml", "evaluate", mesh[0], mesh[1]]);
    let expected = ["evaluation.json", "nonsmooth-files.txt", "pressure_shape.csv"];
    assert_eq!(names(&scratch.join("run")), expected.map(String::from).into());
}

#[test]
fn no_command_replaces_the_report_of_an_optimization_by_the_way() {
    let folder = kit::scratch();
    let scratch = folder.path();
    run(scratch, "signorini3d", &["--mesh", "4", "--max-evaluations", "6", "--out", "run"]);
    let report = read(scratch, "run/report.html");
    for arguments in [
        &["evaluate", "--mesh", "4", "--out", "run"][..],
        &["verify", "--mesh", "4", "--out", "run"],
        &["--resume", "run", "--max-evaluations", "3"],
    ] {
        let output = output(scratch, "signorini3d", arguments);
        let message = kit::errors(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains("run") || message.contains("at least the 6 evaluations"), "{message}");
    }
    assert_eq!(read(scratch, "run/report.html"), report);
    // The scene that the folder keeps does not send other commands there.
    run(scratch, "contact3d", &["run/scene.toml", "evaluate"]);
    assert_eq!(read(scratch, "run/report.html"), report);
}

#[test]
fn a_verification_leaves_its_table() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let result = run(scratch, "signorini3d", &["verify", "--mesh", "4", "--out", "table"]);
    let written = kit::read_json(&scratch.join("table/verification.json"));
    assert_eq!(written["smooth_step"], result["smooth_step"]);
    assert!(read(scratch, "table/verification.txt").contains("nearest kink"));
}

#[test]
fn growing_meshes_stand_in_the_page_with_their_own_numbers() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let arguments = ["--continuation", "2,4", "--max-evaluations", "3", "--out", "run"];
    let result = run(scratch, "signorini3d", &arguments);
    let page = check_page(scratch, "run", &OPTIMIZATION);
    assert!(page.contains("3 + 3 evaluations in several runs") && page.contains("Runs"));
    for stage in result["stages"].as_array().unwrap() {
        assert!(page.contains(&format!("{:.4e}", stage["objective"].as_f64().unwrap())), "{stage}");
    }
}
