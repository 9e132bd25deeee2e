//! `tolerance`: first derivatives against states, closed forms, units, threads, pages, and what is refused.

use crate::binary;
use contact::equilibrium::FormErrors;
use contact::solvers::Processes;
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::{Case, SceneFile};
use serde_json::Value;
use std::path::Path;
use testset::kit::{self, json, scratch, text};

fn contact3d() -> &'static str {
    binary("contact3d").unwrap()
}

fn scene(name: &str) -> String {
    format!("{}/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

const HERTZ: [&str; 5] = ["tolerance", "--mesh", "4", "--subdomains", "1"];

/// Waves on the curved nose of a lug with friction, under two loads, of which one also moves it.
#[test]
fn first_derivatives_are_those_of_states() {
    let text = std::fs::read_to_string(scene("lug_cases.toml")).unwrap();
    let (head, tail) = text.split_once("# The load leans to one side.").unwrap();
    let (_, last) = tail.split_once("[[case]]\nname = \"right\"").unwrap();
    let peak = "\n[[limit]]\nquantity = \"peak-pressure\"\nat_most = 1e4\n";
    let file = SceneFile::parse(&format!("{head}[[case]]\nname = \"right\"{last}{peak}"), "lug").unwrap();
    let case = Case::new(&file, Path::new(&scene(""))).unwrap();
    let errors = FormErrors { controls: case.start_controls(), wavelength: 20.0 };
    let objective = case.with_form_errors(&errors, &Processes::alone()).unwrap();
    let waves = objective.solver().problem().map.control_count();
    assert_eq!(waves, FormErrors::WAVES);
    let nominal = Vector::zeros(waves);
    let states = objective.cases().solve(&nominal, None, Accuracy::TIGHTEST).unwrap();
    let model = objective.first_order(&nominal, &states).unwrap();
    let change = seeded_direction(waves, 5) * 1e-4;
    let slope = model.slope(&change);
    // Differences of second order fall by four with every half; what is off in first order falls by two.
    let differences = |times: f64| -> Vec<f64> {
        let control = &change * times;
        let states = objective.cases().solve(&control, None, Accuracy::TIGHTEST).unwrap();
        let model = model.at(&slope, times);
        let value = (model.value - objective.value(&states)).abs();
        let weighted = objective.weighted_values(&states);
        let limits = objective.limited_values(&control, &states);
        let others = model.weighted.iter().chain(&model.limits).zip(weighted.iter().chain(&limits));
        std::iter::once(value).chain(others.map(|(model, state)| (model - state).abs())).collect()
    };
    let [whole, half] = [1.0, 0.5].map(differences);
    // Θ, two measures, two peaks, the volume, two stresses.
    assert_eq!(whole.len(), 8);
    for (quantity, (whole, half)) in whole.iter().zip(&half).enumerate() {
        let ratio = whole / half;
        assert!((3.6..4.4).contains(&ratio), "{quantity}: {whole:e} {half:e}");
    }
}

/// Waves that are much longer than the block move its upper face as a whole. A block of height H = 5 on a rigid
/// support, pressed to the height 4.99, has V/V₀ = 1 ± a/H and the pressure E (1 − 4.99/H), with the derivative
/// 4.99 E/H².
#[test]
fn long_waves_have_closed_forms() {
    let folder = scratch();
    let file = folder.path().join("block.toml");
    let block = r#"
        name = "block"
        friction = 0.0
        [[body]]
        material = { young_modulus = 1e5, poisson_ratio = 0.3 }
        block = { size = [10.0, 10.0], bricks = [4, 4, 2], subdomains = [1, 1, 1] }
        supports = [
            { face = "x1-min", held = ["u1"] }, { face = "x2-min", held = ["u2"] }, { face = "bottom", held = ["u3"] },
        ]
        lattice = { heights = "top", control_points = [3, 3], start = { form = "plane", height = 5.0 }, thickness = 4.0 }
        [[contact]]
        slave = { face = "top" }
        interference = 0.01
        obstacle = { form = "plane", height = 5.0 }
        [[limit]]
        quantity = "relative-volume"
        at_most = 1.0002
        [[limit]]
        quantity = "peak-pressure"
        at_most = 300.0
        [objective]
        quantity = "peak-pressure"
    "#;
    std::fs::write(&file, block).unwrap();
    let options = ["tolerance", "--amplitude", "0.002", "--wavelength", "1e14", "--samples", "200", "--json"];
    let found = json(contact3d(), &[&[text(&file)], &options[..]].concat());
    let row = |name: &str| {
        let rows = found["rows"].as_array().unwrap();
        rows.iter().find(|row| row["quantity"].as_str().unwrap().contains(name)).unwrap().clone()
    };
    let near = |value: &Value, expected: f64, share: f64| {
        assert!((value.as_f64().unwrap() / expected - 1.0).abs() < share, "{value} {expected}");
    };
    let volume = row("relative-volume");
    ["percentile_95", "worst", "worst_state"].iter().for_each(|key| near(&volume[*key], 1.0 + 0.002 / 5.0, 1e-9));
    assert!(volume["allowed"].is_null());
    // Signs are random: about half of the shapes are smaller, within four standard deviations.
    let kept = volume["kept"].as_f64().unwrap();
    assert!((kept - 0.5).abs() < 4.0 * 0.5 / 200.0_f64.sqrt(), "{kept}");
    let (height, slope) = (5.0, 1e5 * 4.99 / 25.0);
    let pressure = |height: f64| 1e5 * (1.0 - 4.99 / height);
    let (objective, limit) = (row("Θ"), row("limit: peak-pressure"));
    near(&objective["nominal"], pressure(height), 1e-7);
    near(&objective["worst"], pressure(height) + 0.002 * slope, 1e-7);
    near(&objective["worst_state"], pressure(height + 0.002), 1e-7);
    // The search ends at a millionth of ten amplitudes, 2e-8 mm; the bound has an allowance of a millionth.
    near(&limit["allowed"]["amplitude"], (300.0 - pressure(height)) / slope, 1e-4);
    near(&found["allowed"]["amplitude"], 0.05 * pressure(height) / slope, 1e-4);
    let curvature = 2.0 * slope / height;
    let second = 0.5 * curvature * 0.002_f64.powi(2);
    near(&objective["model_error"], second / (slope * 0.002), 0.01);
}

#[test]
fn results_do_not_depend_on_threads() {
    let scene = scene("hertz.toml");
    let options = ["--amplitude", "0.02", "--wavelength", "20", "--samples", "50", "--json"];
    let found = ["1", "3"].map(|threads| {
        json(contact3d(), &[&[scene.as_str()], &HERTZ[..], &options[..], &["--threads", threads][..]].concat())
    });
    assert_eq!(found[0], found[1]);
    let other = json(contact3d(), &[&[scene.as_str()], &HERTZ[..], &options[..], &["--seed", "2"][..]].concat());
    assert_ne!(found[0]["rows"], other["rows"]);
}

/// The nodes of a mesh file in other units.
fn scaled(mesh: &str, factor: f64) -> String {
    let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
    let (nodes, tail) = rest.split_once("$EndNodes").unwrap();
    let line = |line: &str| match line.split(' ').map(str::parse::<f64>).collect::<Result<Vec<_>, _>>() {
        Ok(place) if place.len() == 3 => {
            place.iter().map(|x| format!("{:?}", x * factor)).collect::<Vec<_>>().join(" ")
        }
        _ => line.to_owned(),
    };
    format!("{head}$Nodes\n{}\n$EndNodes{tail}", nodes.trim_end().lines().map(line).collect::<Vec<_>>().join("\n"))
}

#[test]
fn results_do_not_depend_on_the_unit_of_the_mesh() {
    let folder = scratch();
    let mesh = std::fs::read_to_string(scene("lug_hex8.msh")).unwrap();
    let file = std::fs::read_to_string(scene("lug_hex8.toml")).unwrap();
    let found = [("mm", 1.0), ("m", 1e-3)].map(|(unit, factor)| {
        std::fs::write(folder.path().join("lug_hex8.msh"), scaled(&mesh, factor)).unwrap();
        let path = folder.path().join("lug.toml");
        std::fs::write(&path, file.replacen("[[body]]", &format!("[[body]]\nunit = \"{unit}\""), 1)).unwrap();
        let options = ["tolerance", "--amplitude", "0.01", "--wavelength", "20", "--samples", "40", "--json"];
        json(contact3d(), &[&[text(&path)], &options[..]].concat())
    });
    let rows = |found: &Value| found["rows"].as_array().unwrap().clone();
    for (one, other) in rows(&found[0]).iter().zip(rows(&found[1])) {
        for key in ["nominal", "median", "percentile_95", "worst", "worst_state"] {
            let [one, other] = [one, &other].map(|row| row[key].as_f64().unwrap());
            assert!((one / other - 1.0).abs() < 1e-8, "{key}: {one} {other}");
        }
    }
}

#[test]
fn the_pages_of_an_optimization_take_the_result() {
    let folder = scratch();
    let (out, scene) = (folder.path().join("run"), scene("hertz.toml"));
    let mesh = ["--mesh", "4", "--subdomains", "1", "--set", "output.pictures=false", "--set", "output.vtk=false"];
    let optimize = ["--max-evaluations", "3", "--single", "--out", text(&out)];
    kit::run(contact3d(), &[&[scene.as_str()], &mesh[..], &optimize[..]].concat());
    let page = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    for name in ["report.html", "summary.html"] {
        assert!(page(name).contains("Not computed. The command: contact3d "), "{name}");
    }
    let own = out.join("scene.toml");
    let errors = ["--amplitude", "0.02", "--wavelength", "20", "--samples", "40"];
    let command = [&[text(&own), "tolerance", "--run", text(&out)], &errors[..]].concat();
    let printed = String::from_utf8(kit::run(contact3d(), &command).stdout).unwrap();
    assert!(printed.contains("up to a form error of") && printed.contains("worst state"), "{printed}");
    for name in ["report.html", "summary.html"] {
        let written = page(name);
        assert!(written.contains("<h2>Form error</h2>") && !written.contains("Not computed. The command"), "{name}");
    }
    let known = kit::read_json(&out.join("form_error.json"));
    assert_eq!(known["controls"].as_array().unwrap().len(), 36);
    // A run that is continued without a further evaluation keeps it, one that finds another shape does not.
    kit::run(contact3d(), &["--resume", text(&out)]);
    assert!(!page("report.html").contains("Not computed. The command"));
    kit::run(contact3d(), &["--resume", text(&out), "--max-evaluations", "6"]);
    assert!(page("report.html").contains("Not computed. The command"));
}

#[test]
fn what_means_nothing_is_refused() {
    let scene = scene("hertz.toml");
    let refused = |options: &[&str], words: &[&str]| {
        kit::refused(contact3d(), &[&[scene.as_str()], &HERTZ[..], options].concat(), words);
    };
    let all = ["--amplitude", "0.02", "--wavelength", "20"];
    refused(&["--wavelength", "20"], &["--amplitude"]);
    refused(&["--amplitude", "-1", "--wavelength", "20"], &["--amplitude", "a finite number > 0"]);
    refused(&["--amplitude", "0.02", "--wavelength", "inf"], &["--wavelength", "a finite number > 0"]);
    refused(&[&all[..], &["--samples", "19"]].concat(), &["--samples", "20 to 100000"]);
    refused(&[&all[..], &["--run", "x", "--controls", "y"]].concat(), &["--controls is allowed without --run"]);
    refused(&[&all[..], &["--run", "x", "--out", "y"]].concat(), &["--out is allowed without --run"]);
    let words = ["--amplitude 5: ", "is inverted", "a smaller one is needed"];
    refused(&["--amplitude", "5", "--wavelength", "10"], &words);
    // Four bricks along 10 mm.
    let words =
        ["wavelength of the form error = 9.9", "at least 10.0000 mm: 4 facets of the shaped faces, 2.5000 mm each"];
    refused(&["--amplitude", "0.02", "--wavelength", "9.9"], &words);
}
