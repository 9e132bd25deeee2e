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

/// Every figure exists as SVG, is well-formed, and stands in the page, which loads
/// nothing else; every file that the page names exists, and so does every name inside it, once.
fn check_page(scratch: &Path, folder: &str, figures: &[&str]) -> String {
    let found = names(&scratch.join(folder).join("figures"));
    let expected = figures.iter().map(|name| format!("{name}.svg")).collect();
    assert_eq!(found, expected, "{folder}");
    let page = read(scratch, &format!("{folder}/report.html"));
    for name in figures {
        let svg = read(scratch, &format!("{folder}/figures/{name}.svg"));
        assert!(roxmltree::Document::parse(&svg).is_ok(), "{name}");
        assert!(page.contains(&svg), "{folder}: {name}");
    }
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    // The name of the SVG language is an address that nothing is loaded from.
    let addresses = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for loaded in ["http://", "https://", "<link", "src=", "@import", "url("] {
        assert!(!addresses.contains(loaded), "{folder}: {loaded}");
    }
    let attributes = |name: &str| -> Vec<String> {
        let start = format!(" {name}=\"");
        page.split(&start).skip(1).map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
    };
    let ids = attributes("id");
    assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "{folder}: {ids:?}");
    let links = attributes("href");
    assert!(links.iter().any(|link| link == "nonsmooth-files.txt"), "{folder}: {links:?}");
    for link in links {
        match link.strip_prefix('#') {
            Some(name) => assert!(ids.iter().any(|id| id == name), "{folder}: {link}"),
            None => assert!(scratch.join(folder).join(&link).exists(), "{folder}: {link}"),
        }
    }
    page
}

/// The cells of a row of a table, by the beginning of the row's name.
pub fn cells(page: &str, name: &str) -> Vec<String> {
    let row = page.split(&format!("<tr><td>{name}")).nth(1).unwrap_or_else(|| panic!("{name}"));
    let row = row.split("</tr>").next().unwrap();
    row.split("<td>").skip(1).map(|cell| cell.split("</td>").next().unwrap().to_owned()).collect()
}

/// A cell as a number; it may have the minus sign of print and a unit behind it.
pub fn number(cell: &str) -> f64 {
    let text = cell.replace('−', "-").replace(" %", "");
    text.parse().unwrap_or_else(|_| panic!("{cell}"))
}

const SHAPES: [&str; 5] = ["pressure", "pressure_own_scales", "pressure_cuts", "status", "surface_map"];

/// Of a single shape: one scale is its own.
fn alone() -> Vec<&'static str> {
    SHAPES.into_iter().filter(|name| *name != "pressure_own_scales").collect()
}

fn optimization() -> Vec<&'static str> {
    SHAPES.into_iter().chain(["convergence"]).collect()
}

#[test]
fn an_optimization_delivers_page_pictures_and_fields() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let result = run(scratch, "signorini3d", &["--mesh", "4", "--max-evaluations", "6", "--out", "run"]);
    let page = check_page(scratch, "run", &optimization());
    for words in
        ["evaluation limit reached", "aggregate subgradient", "least objective for this total force", "[body.lattice]"]
    {
        assert!(page.contains(words), "{words}");
    }
    let expected = ["initial", "optimal"]
        .into_iter()
        .flat_map(|name| [format!("{name}_bodies.vtu"), format!("{name}_contact.vtu")]);
    let expected: BTreeSet<String> = expected.chain(["fields.pvd", "view.py"].map(str::to_owned)).collect();
    assert_eq!(names(&scratch.join("run/vtk")), expected);
    let field = std::fs::read_to_string(scratch.join("run/vtk/optimal_bodies.vtu")).unwrap();
    assert!(field.contains("Name=\"objective\"") && !field.contains("\"String\""), "{}", &field[..600]);
    // Warnings stand before everything else.
    let first = page.find("<nav>").unwrap();
    for warning in result["warnings"].as_array().unwrap() {
        let text = warning["text"].as_str().unwrap();
        assert!(page[..first].contains(text), "{text}");
    }
    assert!(!result["warnings"].as_array().unwrap().is_empty());
    // The date, as ISO 8601, the versions and the machine.
    let origin = page.split("<p class=\"origin\">").nth(1).unwrap().split("</p>").next().unwrap();
    assert!(origin.contains("Written 20") && origin.contains("Z by problems"), "{origin}");
    assert!(origin.contains(std::env::consts::ARCH) && origin.contains("threads"), "{origin}");
}

#[test]
fn the_table_of_the_result_says_what_the_files_say() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let result = run(scratch, "hertz3d", &["--mesh", "4", "--max-evaluations", "3", "--out", "run"]);
    let page = read(scratch, "run/report.html");
    let table = kit::read_json(&scratch.join("run/key_numbers.json"));
    let rows = table["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &table["columns"][1]), (11, &Value::from("best found")));
    for row in rows {
        let values: Vec<f64> = row["values"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
        let shown = cells(&page, row["quantity"].as_str().unwrap());
        for (value, cell) in values.iter().zip(&shown) {
            // Six digits.
            assert!((number(cell) - value).abs() <= 1e-5 * value.abs(), "{row}: {cell}");
        }
        let change = 100.0 * (values[1] / values[0] - 1.0);
        assert!((row["change_percent"].as_f64().unwrap() - change).abs() < 1e-9 * change.abs().max(1.0), "{row}");
        assert!((number(&shown[2]) - change).abs() < 0.051, "{row}: {}", shown[2]);
    }
    let values = |key: &str| &rows.iter().find(|row| row["key"] == key).unwrap()["values"];
    // The states of the table are solved anew, without the start that the run had: they agree up to rounding.
    let agree = |a: &Value, b: &Value| (a.as_f64().unwrap() / b.as_f64().unwrap() - 1.0).abs() < 1e-13;
    assert!(agree(&values("objective")[0], &result["objective_start"]), "{}", values("objective"));
    assert!(agree(&values("objective")[1], &result["objective"]), "{} {}", values("objective"), result["objective"]);
    let peaks = [0, 1].map(|end| (&values("peak_pressure")[end], &result["peak_pressure"][end]));
    assert!(peaks.iter().all(|(table, result)| agree(table, result)), "{peaks:?}");
    // Closed nodes of the table of nodes carry the contact area; the upper body does not change.
    assert_eq!(values("volume_upper")[0], values("volume_upper")[1]);
    let nodes = read(scratch, "run/pressure_optimal.csv");
    let closed = nodes.lines().skip(1).filter(|line| !line.ends_with("Open"));
    // Tributary areas of 4 × 4 bricks on 10 mm × 10 mm: halves on edges.
    let share = |x: &str| if ["0", "10"].contains(&x) { 0.5 } else { 1.0 };
    let area = |line: &str| line.split(',').take(2).map(share).product::<f64>() * 2.5 * 2.5;
    let area: f64 = closed.map(area).sum();
    assert!((values("contact_area")[1].as_f64().unwrap() - area).abs() < 1e-9 * area);
    assert!(values("friction_work")[0].as_f64().unwrap() > 0.0);
}

#[test]
fn the_text_over_the_node_of_the_peak_is_its_pressure() {
    let folder = kit::scratch();
    let scratch = folder.path();
    run(scratch, "hertz3d", &["evaluate", "--mesh", "4", "--out", "state"]);
    let table = read(scratch, "state/pressure_shape.csv");
    let lines = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let nodes: Vec<(f64, f64, f64)> =
        lines.map(|line| (line[0].parse().unwrap(), line[1].parse().unwrap(), line[3].parse().unwrap())).collect();
    let svg = read(scratch, "state/figures/pressure.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let titles: Vec<&str> = document
        .descendants()
        .filter(|node| node.attribute("class") == Some("nodes"))
        .flat_map(|group| group.descendants().filter(|node| node.has_tag_name("title")).filter_map(|node| node.text()))
        .collect();
    assert_eq!(titles.len(), nodes.len());
    for (index, ((x1, x2, pressure), title)) in nodes.iter().zip(&titles).enumerate() {
        let words = format!("node {index} at ({x1}, {x2}): ");
        let value = title.strip_prefix(&words).unwrap_or_else(|| panic!("{title}, not {words}"));
        let value = value.strip_suffix(" MPa").unwrap();
        // Four digits; large and small numbers as a power of ten, which a text without superscripts writes with ^.
        let value = value.replace('−', "-").replace("·10^", "e");
        assert!((value.parse::<f64>().unwrap() - pressure).abs() <= 5e-4 * pressure.abs(), "{title}: {pressure}");
    }
    let peak = nodes.iter().max_by(|a, b| a.2.total_cmp(&b.2)).unwrap();
    let marked = format!("largest {:.0} MPa at ({}, {})", peak.2, peak.0, peak.1);
    assert!(svg.contains(&marked), "{marked}");
}

#[test]
fn a_scene_without_friction_shows_none() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let arguments = ["evaluate", "--mesh", "4", "--friction", "0", "--out", "state"];
    run(scratch, "signorini3d", &arguments);
    let page = check_page(scratch, "state", &alone());
    let svg = read(scratch, "state/figures/status.svg");
    assert!(svg.contains(">closed<") && !svg.contains("slip") && !svg.contains("traction"));
    assert!(!page.contains("friction work"));
}

#[test]
fn the_page_says_what_holds_and_loads_the_bodies() {
    let folder = kit::scratch();
    let scratch = folder.path();
    run(scratch, "hertz3d", &["evaluate", "--mesh", "2", "--out", "state"]);
    let page = read(scratch, "state/report.html");
    let section = page.split("<h2>Supports and loads").nth(1).unwrap().split("<h2>").next().unwrap();
    // Supports and loads of problems/scenes/hertz.toml; the top has 100 mm².
    for words in [
        "held: u₁ = 0",
        "held: u₃ = 0",
        "load (0, 0, −2000) MPa, in all 200000 N",
        "load (500, 0, −2000) MPa",
        "E = 210000 MPa, ν = 0.29",
        "top of lower on bottom of upper, friction 0.3",
    ] {
        assert!(section.contains(words), "{words}: {section}");
    }
}

#[test]
fn the_page_says_everything_without_its_script_and_stays_small() {
    let folder = kit::scratch();
    let scratch = folder.path();
    run(scratch, "signorini3d", &["--max-evaluations", "2", "--out", "run"]);
    let page = check_page(scratch, "run", &optimization());
    // 3 MB are promised at 12³ bricks, 0.7 are needed.
    assert!(page.len() < 1_000_000, "{}", page.len());
    let script = page.split("<script>").nth(1).unwrap().split("</script>").next().unwrap();
    // Beside it stand the packed numbers and the packed library of the view in three dimensions.
    let packed = page.matches("type=\"application/octet-stream\"").count();
    assert_eq!((page.matches("<script>").count(), page.matches("<script").count()), (1, 1 + packed));
    // What it shows at figures are titles of the page: it holds no numbers, makes nothing, and hides nothing.
    let script = script.split("// Views in three dimensions").next().unwrap();
    for word in ["innerHTML", "createElement", "hidden", "display", "fetch"] {
        assert!(!script.contains(word), "{word}");
    }
    assert!(page.matches("<title>node ").count() > 4 * 13 * 13);
    // The choice between two scales is made by the style alone.
    assert_eq!(page.matches("type=\"radio\"").count(), 2);
    assert!(page.contains("prefers-color-scheme: dark") && page.contains("@media print"));
}

#[test]
fn an_evaluation_of_two_bodies_delivers_them_too() {
    let folder = kit::scratch();
    let scratch = folder.path();
    let result = run(scratch, "hertz3d", &["evaluate", "--mesh", "4", "--out", "state"]);
    let page = check_page(scratch, "state", &alone());
    let shown = number(&cells(&page, "objective Θ")[0]);
    assert!((shown / result["objective"].as_f64().unwrap() - 1.0).abs() < 1e-5, "{shown}");
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
    let page = check_page(scratch, "both", &SHAPES);
    for sentence in result["conclusion"].as_array().unwrap() {
        assert!(page.contains(sentence.as_str().unwrap()), "{sentence}");
    }
    for part in ["with_friction", "without_friction"] {
        check_page(scratch, &format!("both/{part}"), &optimization());
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
    let page = check_page(scratch, "run", &optimization());
    for stage in result["stages"].as_array().unwrap() {
        let row = cells(&page, &format!("stage {}", stage["mesh"][0]));
        assert!((number(&row[2]) / stage["objective"].as_f64().unwrap() - 1.0).abs() < 1e-5, "{stage}: {row:?}");
        assert_eq!(row[3], stage["evaluations"].to_string());
    }
}
