//! Any number of processes and threads ends at the bits of one.

use super::{PROGRAM, alone, ended, errors, mpirun, scene, started, together, without_times};
use std::fs::read;
use std::path::Path;
use testset::kit::{scratch, text};

#[test]
fn an_evaluation_has_the_same_bits_on_any_number_of_processes_and_threads() {
    let cases = [
        ("signorini", vec!["--solver", "newton", "--mesh", "6", "--diagnose"]),
        ("signorini", vec!["--solver", "augmented-lagrangian", "--mesh", "4"]),
        ("hertz", vec!["--solver", "newton", "--mesh", "4", "--friction", "0"]),
        ("signorini", vec!["--solver", "direct", "--mesh", "4"]),
        ("hertz", vec!["--mesh", "4"]),
        ("lug_tet10", vec!["--solver", "newton"]),
    ];
    for (name, options) in cases {
        let scene = scene(name);
        let options = [&["evaluate", "--json"], &options[..]].concat();
        let expected = without_times(alone(Some(&scene), &options).unwrap());
        for (processes, threads) in [(1, "1"), (2, "2"), (3, "1"), (4, "1")] {
            let report = together(processes, &[&[text(&scene)], &options[..], &["--threads", threads]].concat());
            assert_eq!(report["processes"]["processes"], processes, "{report}");
            assert_eq!(report["processes"]["peak_memory"].as_array().unwrap().len(), processes);
            assert_eq!(without_times(report), expected, "{name} {options:?}: {processes} processes, {threads} threads");
        }
    }
}

#[test]
fn what_several_processes_use_is_told() {
    let scene = scene("signorini");
    let arguments = [text(&scene), "evaluate", "--mesh", "4", "--solver", "newton"];
    let usage = together(2, &[&arguments[..], &["--json"]].concat())["processes"].clone();
    assert!(usage["products"].as_u64() > Some(10) && usage["bytes_per_product"].as_f64() > Some(100.0), "{usage}");
    assert!(usage["messages_per_product"].as_f64() >= Some(1.0), "{usage}");
    let output = ended(started(PROGRAM, 2, &arguments));
    let page = String::from_utf8(output.stdout).unwrap();
    assert_eq!(page.matches("processes                     2; ").count(), 1, "{page}");
    let output = ended(started(PROGRAM, 2, &[&arguments[..5], &["direct"]].concat()));
    let page = String::from_utf8(output.stdout).unwrap();
    assert!(page.contains("processes                     2, each of which repeats the direct condensation"), "{page}");
}

/// Options of a short optimization.
const RUN: [&str; 7] = ["optimize", "--single", "--mesh", "4", "--solver", "newton", "--json"];

/// Files of a run that hold no times.
const FILES: [&str; 5] =
    ["controls.json", "certificate.json", "pressure_optimal.csv", "vtk/fields.pvd", "vtk/optimal_bodies.vtu"];

fn same_files(folders: [&Path; 2]) {
    let mut compared = 0;
    for name in FILES {
        let [first, second] = folders.map(|folder| read(folder.join(name)).ok());
        compared += usize::from(first.is_some());
        assert!(first == second, "{name}");
    }
    assert_eq!(compared, FILES.len(), "files found");
}

#[test]
fn an_optimization_and_its_resumption_have_the_same_bits_and_files() {
    let (folder, scene) = (scratch(), scene("signorini"));
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let run = [&RUN[..], &["--max-evaluations", "7"]].concat();
    let expected = alone(Some(&scene), &[&run[..], &["--out", text(&whole)]].concat()).unwrap();
    let expected = without_times(expected);
    for processes in [2, 4] {
        let report = together(processes, &[&[text(&scene)], &run[..]].concat());
        assert_eq!(without_times(report), expected, "{processes} processes");
    }
    // Begun by two processes, continued by four, ended by one.
    together(2, &[&[text(&scene)], &RUN[..], &["--max-evaluations", "3", "--out", text(&parts)]].concat());
    let resume = ["--resume", text(&parts), "--json", "--max-evaluations"];
    let second = together(4, &[&resume[..], &["5"]].concat());
    assert_eq!((&second["evaluations"], &second["resumed_evaluations"]), (&5.into(), &3.into()));
    let last = without_times(alone(None, &[&resume[..], &["7"]].concat()).unwrap());
    for key in ["objective", "controls", "evaluations", "termination", "certificate", "course", "peak_pressure"] {
        assert_eq!(last[key], expected[key], "{key}");
    }
    same_files([&whole, &parts]);
}

#[test]
fn the_other_commands_have_the_same_results() {
    let (folder, scene) = (scratch(), scene("signorini"));
    let kept = folder.path().join("kept");
    let optimize = ["--max-evaluations", "4", "--mesh", "4", "--solver", "newton", "--json"];
    let commands: [&[&str]; 4] = [
        &["verify", "--mesh", "4", "--json", "--solver", "newton"],
        &[&["compare"], &optimize[..]].concat(),
        &[
            "optimize",
            "--continuation",
            "2,4",
            "--subdomains",
            "2",
            "--max-evaluations",
            "3",
            "--json",
            "--solver",
            "newton",
        ],
        &["optimize", "--starts", "2", "--mesh", "2", "--max-evaluations", "3", "--json", "--optimizer", "bundle"],
    ];
    for command in commands {
        let expected = without_times(alone(Some(&scene), command).unwrap());
        let report = without_times(together(2, &[&[text(&scene)], command].concat()));
        assert_eq!(report, expected, "{command:?}");
    }
    together(2, &[&[text(&scene), "optimize"], &optimize[..], &["--out", text(&kept)]].concat());
    let recheck = ["recheck", text(&kept), "--mesh", "4", "--json"];
    let report = together(2, &[&[text(&scene)], &recheck[..]].concat());
    assert_eq!(report, alone(Some(&scene), &recheck).unwrap());
}

#[test]
fn only_the_first_process_needs_the_files_and_the_arguments() {
    let folder = scratch();
    std::fs::copy(scene("signorini"), folder.path().join("here.toml")).unwrap();
    let elsewhere = scratch();
    let mut command = mpirun();
    let options = ["here.toml", "evaluate", "--mesh", "4", "--json", "--solver", "newton"];
    command.args(["-n", "1", "--wdir", text(folder.path()), PROGRAM]).args(options);
    command.args([":", "-n", "1", "--wdir", text(elsewhere.path()), PROGRAM, "--bad"]);
    let output = ended(command);
    assert!(output.status.success(), "{}", errors(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(without_times(report), without_times(alone(Some(&scene("signorini")), &options[1..]).unwrap()));
}
