//! What people, programs and browsers are told of one result: the same numbers, the most important ones first.

use crate::reports::{cells, number};
use serde_json::Value;
use std::path::Path;
use testset::kit::{self, text};

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");
const HERTZ: &str = env!("CARGO_BIN_EXE_hertz3d");
const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// What a command prints, in a locale with UTF-8.
fn printed(program: &str, arguments: &[&str]) -> String {
    let output = kit::command(program, arguments).env("LC_ALL", "C.UTF-8").output().unwrap();
    assert!(output.status.success(), "{}", kit::errors(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The values behind a name in a text: one, or a start and an end.
fn values(page: &str, name: &str) -> Vec<f64> {
    let line = page.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
    let line = line.unwrap_or_else(|| panic!("{name} in {page}")).trim();
    line.split(" -> ").map(|value| value.split(' ').next().unwrap().parse().unwrap()).collect()
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// A page without its scripts, whose packed bytes are letters by chance.
fn words(page: &str) -> String {
    let parts = page.split("<script");
    parts.map(|part| part.split_once("</script>").map_or(part, |(_, rest)| rest)).collect()
}

/// A body that does not reach its counterpart: its objective is zero at every shape.
fn idle(folder: &Path) -> String {
    let file = folder.join("nocontact.toml");
    std::fs::write(&file, crate::compare::NEVER_TOUCHES).unwrap();
    text(&file).to_owned()
}

#[test]
fn text_json_and_page_of_one_result_agree_number_by_number() {
    let scratch = kit::scratch();
    let out = scratch.path().join("run");
    let json = kit::json(SIGNORINI, &["--mesh", "4", "--max-evaluations", "4", "--json", "--out", text(&out)]);
    let (words, page) = (read(&out, "report.txt"), read(&out, "report.html"));
    // Name for people, places in JSON, relative rounding of six and of two digits.
    let facts: [(&str, &[&str], f64); 17] = [
        ("peak contact pressure", &["/peak_pressure/0", "/peak_pressure/1"], 1e-5),
        ("objective Θ", &["/objective_start", "/objective"], 1e-5),
        ("total normal force", &["/total_normal_force/0", "/total_normal_force/1"], 1e-5),
        ("open contact nodes", &["/status/0/open", "/status/1/open"], 0.0),
        ("residual: equilibrium", &["/residuals/0/equilibrium", "/residuals/1/equilibrium"], 0.05),
        ("residual: complementarity", &["/residuals/0/complementarity", "/residuals/1/complementarity"], 0.05),
        ("residual: dissipation", &["/residuals/0/dissipation", "/residuals/1/dissipation"], 0.05),
        ("margin of the nearest kink", &["/kinks/0/smallest_margin", "/kinks/1/smallest_margin"], 0.05),
        ("evaluations", &["/evaluations"], 0.0),
        ("time of the whole run", &["/seconds"], 1e-5),
        ("serious steps", &["/serious_steps"], 0.0),
        ("null steps", &["/null_steps"], 0.0),
        ("Jacobians", &["/jacobians"], 0.0),
        ("aggregate subgradient", &["/certificate/aggregate_norm"], 0.05),
        ("aggregate error", &["/certificate/aggregate_error"], 0.05),
        ("active cuts", &["/certificate/active_cuts"], 0.0),
        ("noise", &["/certificate/noise"], 0.05),
    ];
    for (name, places, rounding) in facts {
        let shown = cells(&page, name);
        let told = values(&words, name);
        assert_eq!(told.len(), places.len(), "{name}: {told:?}");
        for (index, place) in places.iter().enumerate() {
            let expected = json.pointer(place).and_then(Value::as_f64).unwrap_or_else(|| panic!("{place}"));
            for found in [told[index], number(&shown[index])] {
                assert!((found - expected).abs() <= rounding * expected.abs(), "{name}: {found}, not {expected}");
            }
        }
    }
    // The root of the sum is a pressure: its fourth power is the objective of JSON.
    let root = values(&words, "(Σσ⁴)^(1/4)");
    assert!((root[1].powi(4) / json["objective"].as_f64().unwrap() - 1.0).abs() < 1e-4, "{root:?}");
    assert!(!page.contains("MPa^{") && !words.contains("MPa^") && words.contains("MPa⁴"));
}

#[test]
fn the_first_two_lines_say_what_was_found_and_whether_it_is_confirmed() {
    let run = ["--mesh", "4", "--max-evaluations", "4"];
    let short = printed(SIGNORINI, &run);
    let json = kit::json(SIGNORINI, &[&run[..], &["--json"]].concat());
    let lines: Vec<&str> = short.lines().collect();
    let peaks = [0, 1].map(|end| json["peak_pressure"][end].as_f64().unwrap());
    let after = lines[0].split("a better shape was found: peak pressure ").nth(1).unwrap_or_else(|| panic!("{short}"));
    let told: Vec<f64> = after.split([' ', ';']).filter_map(|word| word.trim_end_matches(',').parse().ok()).collect();
    assert!((told[0] / peaks[0] - 1.0).abs() < 1e-5 && (told[1] / peaks[1] - 1.0).abs() < 1e-5, "{}", lines[0]);
    assert!((told[2] / (peaks[0] / peaks[1]) - 1.0).abs() < 0.01, "{}", lines[0]);
    // The reduction of the objective is that of its root.
    let ratio = json["objective_start"].as_f64().unwrap() / json["objective"].as_f64().unwrap();
    assert!((told[5] / ratio.powf(0.25) - 1.0).abs() < 0.01 && after.contains("(Σσ⁴)^(1/4)"), "{}", lines[0]);
    assert_eq!(lines[1], "Not confirmed: evaluation limit reached; allow more evaluations and continue");
    let inner = ["subproblems", "fallback", "predicted decrease", "noise", "weight", "aggregate", "left out", "trial"];
    let long = printed(SIGNORINI, &[&run[..], &["--verbose"]].concat());
    for word in inner {
        assert!(!short.contains(word) && long.contains(word), "{word}: {short}");
    }
    assert!(short.contains("time of the whole run"), "{short}");
}

#[test]
fn a_confirmed_run_says_so() {
    let text = printed(SIGNORINI, &["--mesh", "4"]);
    assert!(text.lines().nth(1).unwrap().starts_with("Confirmed stationary"), "{text}");
    let shape = printed(SIGNORINI, &["evaluate", "--mesh", "4"]);
    let lines: Vec<&str> = shape.lines().collect();
    assert!(lines[0].contains("peak pressure ") && lines[1].starts_with("contact nodes: "), "{shape}");
    let test = printed(SIGNORINI, &["verify", "--mesh", "4"]);
    assert!(test.starts_with("the subgradient is right: "), "{test}");
}

#[test]
fn a_run_that_changes_nothing_says_so() {
    let scratch = kit::scratch();
    let (file, out) = (idle(scratch.path()), scratch.path().join("run"));
    let told = printed(CONTACT, &[&file, "--max-evaluations", "3", "--out", text(&out)]);
    assert!(told.lines().next().unwrap().contains("no better shape was found than the start"), "{told}");
    let page = words(&read(&out, "report.html"));
    for wrong in ["times less", "optimized shape", "NaN"] {
        assert!(!told.contains(wrong) && !page.contains(wrong), "{wrong}");
    }
    let rows = ["study", "--vary", "friction=0,0.3", "--optimize", "--max-evaluations", "3"];
    let study = printed(CONTACT, &[&[file.as_str()], &rows[..]].concat());
    assert!(study.contains("2 of 2, 0 failed, 2 found no better shape"), "{study}");
}

#[test]
fn tables_of_comma_separated_values_have_units_and_no_noise() {
    let scratch = kit::scratch();
    let out = scratch.path().join("run");
    kit::json(SIGNORINI, &["--mesh", "4", "--max-evaluations", "3", "--json", "--out", text(&out)]);
    let nodes = read(&out, "pressure_optimal.csv");
    let head = "x1_mm,x2_mm,x3_mm,pressure_MPa,traction_1_MPa,traction_2_MPa,traction_3_MPa,remaining_gap_mm,area_mm2,\
                normal_1,normal_2,normal_3,status";
    assert_eq!(nodes.lines().next(), Some(head));
    let history = read(&out, "history.csv");
    let head = "evaluation,kind,value_MPa^4,center_value_MPa^4,predicted_decrease_MPa^4,aggregate_norm,aggregate_error_MPa^4,seconds";
    assert_eq!(history.lines().next(), Some(head));
    for cell in nodes.lines().chain(history.lines()).skip(1).flat_map(|line| line.split(',')) {
        let Ok(value) = cell.parse::<f64>() else { continue };
        let digits = cell.split('e').next().unwrap().trim_start_matches(['-', '0', '.']);
        assert!(digits.chars().filter(char::is_ascii_digit).count() <= 17, "{cell}");
        assert!(value != 0.0 || !cell.starts_with('-'), "{cell}");
    }
}

#[test]
fn the_page_shows_the_places_of_heights_and_the_way_to_export() {
    let scratch = kit::scratch();
    let out = scratch.path().join("run");
    kit::json(HERTZ, &["--mesh", "4", "--max-evaluations", "2", "--json", "--out", text(&out)]);
    let page = read(&out, "report.html");
    assert!(!page.contains("yields first"));
    let heights = page.split("<h2>Control heights").nth(1).unwrap().split("</table>").next().unwrap();
    let head: Vec<&str> = heights.split("<th>").skip(2).map(|cell| cell.split("</th>").next().unwrap()).collect();
    assert!(head[0] == "0" && head[head.len() - 1] == "10.0000", "{head:?}");
    let controls = kit::read_json(&out.join("controls.json"));
    assert_eq!(head.len(), controls[0].as_array().unwrap().len());
    assert!(
        (number(&cells(heights, "10.0000")[0]) - controls.as_array().unwrap().last().unwrap()[0].as_f64().unwrap())
            .abs()
            < 1e-3
    );
    assert!(page.contains("contact3d") && page.contains("export --run"));
    let scene = out.join("scene.toml");
    let to = scratch.path().join("files");
    kit::json(
        CONTACT,
        &[text(&scene), "export", "--run", text(&out), "--stl", "--step", "--csv", "--out", text(&to), "--json"],
    );
}
