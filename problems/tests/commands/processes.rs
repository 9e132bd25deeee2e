//! Several processes, played by threads: the first runs a command, the others follow it. The package `problems-mpi`
//! tests the same with real ones.

use crate::rank::Rank;
use contact::communication::Communication;
use problems::commands::processes::run_together;
use problems::commands::{Arguments, execute, execute_among};
use scene_file::SceneFile;
use serde_json::Value;
use std::sync::Arc;
use testset::kit::{scratch, text};

fn arguments(options: &[&str]) -> Arguments {
    Arguments::try_parse_from([&["contact3d"], options, &["--json"]].concat()).unwrap()
}

type Opened = Result<(SceneFile, Option<std::path::PathBuf>), problems::commands::Failure>;

fn open() -> Opened {
    Ok((SceneFile::parse(include_str!("../../scenes/signorini.toml"), "signorini.toml")?, None))
}

/// The scene of [`open`] with eight clusters of subdomains.
fn clustered() -> Opened {
    let (mut file, path) = open()?;
    file.solver.clusters = Some(8);
    Ok((file, path))
}

/// What the first of so many processes says: JSON, or the message and the exit status of its failure.
fn together(count: usize, options: &[&str]) -> Result<Value, (String, u8)> {
    together_on(open, count, options)
}

/// As [`together`], with another scene.
fn together_on(open: fn() -> Opened, count: usize, options: &[&str]) -> Result<Value, (String, u8)> {
    let arguments = arguments(options);
    let handles: Vec<_> = Rank::all(count)
        .map(|rank| {
            let arguments = arguments.clone();
            std::thread::spawn(move || {
                let communication: Arc<dyn Communication> = Arc::new(rank);
                let build = "the build of the test";
                run_together(&communication, build, |processes| execute_among(open, &arguments, processes)).unwrap()
            })
        })
        .collect();
    let mut results: Vec<_> = handles.into_iter().map(|handle| handle.join().unwrap()).collect();
    assert!(results[1..].iter().all(Option::is_none), "only the first process says something");
    let text = results.remove(0).unwrap().map_err(|failure| (failure.to_string(), failure.status()));
    text.map(|text| serde_json::from_str(&text).unwrap())
}

/// A report without times, and without what several processes have used.
fn found(mut report: Value) -> Value {
    for entry in report["course"].as_array_mut().into_iter().flatten() {
        entry["seconds"].take();
    }
    let fields = report.as_object_mut().unwrap();
    fields.remove("seconds");
    fields.remove("processes");
    report
}

fn alone(options: &[&str]) -> Value {
    alone_on(open, options)
}

fn alone_on(open: fn() -> Opened, options: &[&str]) -> Value {
    found(serde_json::from_str(&execute(open, &arguments(options)).unwrap()).unwrap())
}

#[test]
fn several_processes_find_what_one_finds_to_the_last_bit() {
    let optimize = ["optimize", "--single", "--mesh", "4", "--max-evaluations", "5", "--solver"];
    let commands = [
        ["evaluate", "--diagnose", "--mesh", "4", "--solver", "auto"].as_slice(),
        &[&optimize[..], &["newton"]].concat(),
        &[&optimize[..], &["direct"]].concat(),
    ];
    for options in commands {
        let expected = alone(options);
        for count in [1, 2, 3] {
            let report = together(count, options).unwrap();
            assert_eq!(report["processes"]["processes"], count);
            assert_eq!(found(report), expected, "{options:?} by {count} processes");
        }
    }
}

#[test]
fn the_first_process_exports_alone() {
    let folder = scratch();
    let out = folder.path().join("out");
    let options = ["export", "--mesh", "4", "--friction-problem", "--csv", "--overwrite", "--out", text(&out)];
    let expected = alone(&options);
    let files = || ["change.csv", "friction/stiffness.mtx"].map(|name| std::fs::read(out.join(name)).unwrap());
    let written = files();
    assert_eq!(found(together(3, &options).unwrap()), expected);
    assert_eq!(files(), written);
}

#[test]
fn another_number_of_processes_continues_a_run() {
    let folder = scratch();
    let folder = folder.path().join("run");
    let run = ["--mesh", "4", "--solver", "newton", "--max-evaluations"];
    let expected = alone(&[&run[..], &["6"]].concat());
    together(3, &[&run[..], &["3", "--out", text(&folder)]].concat()).unwrap();
    let report = together(2, &["--resume", text(&folder), "--max-evaluations", "6"]).unwrap();
    assert_eq!(report["resumed_evaluations"], 3);
    for key in ["objective", "controls", "termination", "certificate", "course"] {
        assert_eq!(found(report.clone())[key], expected[key], "{key}");
    }
}

#[test]
fn clusters_change_rounding_alone_and_nothing_by_the_number_of_processes() {
    // 64 subdomains of 2³ bricks in eight clusters of 2³ subdomains.
    let options = ["evaluate", "--mesh", "8", "--subdomains", "4", "--solver", "newton"];
    let expected = alone_on(clustered, &options);
    for count in [1, 2, 3] {
        assert_eq!(found(together_on(clustered, count, &options).unwrap()), expected, "{count} processes");
    }
    let plain = alone(&options);
    let [with, without] = [&expected, &plain].map(|report| report["objective"].as_f64().unwrap());
    assert!(with != without, "the clusters were not used");
    assert!((with / without - 1.0).abs() < 1e-10, "{with:e} {without:e}");
    let gradients = [&expected, &plain].map(|report| {
        let entries = report["subgradient"].as_array().unwrap();
        entries
            .iter()
            .flat_map(|entry| entry.as_array().map_or_else(|| vec![entry], |row| row.iter().collect()))
            .map(|entry| entry.as_f64().unwrap())
            .collect::<Vec<f64>>()
    });
    let difference = testset::kit::relative_difference(&gradients[0], &gradients[1]);
    assert!(difference < 1e-8, "{difference:e}");
}

#[test]
fn a_run_with_clusters_is_continued_with_them() {
    let folder = scratch();
    let folder = folder.path().join("run");
    let run = ["--mesh", "8", "--subdomains", "4", "--solver", "newton", "--max-evaluations"];
    let expected = alone_on(clustered, &[&run[..], &["2"]].concat());
    together_on(clustered, 3, &[&run[..], &["1", "--out", text(&folder)]].concat()).unwrap();
    // The scene of the folder names the clusters; the one that is opened is not read.
    let report = together(2, &["--resume", text(&folder), "--max-evaluations", "2"]).unwrap();
    assert_eq!(report["resumed_evaluations"], 1);
    for key in ["objective", "controls", "course"] {
        assert_eq!(found(report.clone())[key], expected[key], "{key}");
    }
}

#[test]
fn clusters_that_the_subdomains_or_processes_do_not_make_are_refused() {
    let refused = |count: usize, options: &[&str]| together_on(clustered, count, options).unwrap_err();
    let (message, status) = refused(1, &["evaluate", "--mesh", "6", "--subdomains", "3"]);
    assert!(message.contains("solver.clusters = 8") && message.contains("subdomains need more cells"), "{message}");
    assert_eq!(status, 2);
    let (message, status) = refused(1, &["evaluate", "--mesh", "4", "--subdomains", "4"]);
    assert!(message.contains("solver.clusters = 8") && message.contains("subdomains need more cells"), "{message}");
    assert_eq!(status, 2);
    let (message, _) = refused(1, &["evaluate", "--mesh", "4", "--solver", "direct"]);
    assert!(message.contains("solver.clusters = 8") && message.contains("direct"), "{message}");
    let (message, status) = refused(9, &["evaluate", "--mesh", "4", "--subdomains", "4"]);
    assert!(
        message.contains("number of processes = 9") && message.contains("at most 8, as many as there are clusters"),
        "{message}"
    );
    assert_eq!(status, 2);
}

#[test]
fn a_refusal_and_a_failure_are_those_of_a_single_process() {
    for options in [["evaluate", "--mesh", "4", "--load-factor", "-1"], ["verify", "--mesh", "6", "--subdomains", "4"]]
    {
        let expected = execute(open, &arguments(&options)).unwrap_err();
        assert_eq!(together(2, &options).unwrap_err(), (expected.to_string(), expected.status()));
    }
    let (message, status) = together(9, &["evaluate", "--mesh", "4"]).unwrap_err();
    assert!(message.contains("number of processes = 9") && message.contains("at most 8"), "{message}");
    assert_eq!(status, 2);
}

#[test]
fn a_process_of_another_build_is_refused_by_the_first() {
    let handles = Rank::all(3).enumerate().map(|(number, rank)| {
        std::thread::spawn(move || {
            let communication: Arc<dyn Communication> = Arc::new(rank);
            let build = if number == 2 { "version 2" } else { "version 1" };
            run_together(&communication, build, |_| ())
        })
    });
    let mut results: Vec<_> = handles.collect::<Vec<_>>().into_iter().map(|handle| handle.join().unwrap()).collect();
    let failure = results.remove(0).unwrap_err();
    assert_eq!(failure.status(), 2);
    let message = failure.to_string();
    assert!(message.contains("process 2 runs version 2, process 0 runs version 1"), "{message}");
    assert!(results.into_iter().all(|result| matches!(result, Ok(None))));
}
