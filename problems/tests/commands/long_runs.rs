//! Long runs: killed, interrupted and limited runs continue to the same bits; failing folders end no run.

#![cfg(unix)]
use nonsmooth::Journal;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::time::{Duration, Instant};
use testset::kit::{self, text};

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");

fn command(arguments: &[&str]) -> Command {
    kit::command(SIGNORINI, arguments)
}

fn succeeded(arguments: &[&str]) -> Value {
    kit::json(SIGNORINI, arguments)
}

fn refused(arguments: &[&str], words: &[&str]) {
    kit::refused(SIGNORINI, arguments, words);
}

/// What a run printed, whatever its exit status.
fn printed(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {}", kit::errors(output)))
}

/// The course of a run without its times.
fn course(report: &Value) -> String {
    let entries = report["course"].as_array().cloned().unwrap_or_default();
    entries.iter().map(|entry| format!("\n{} {} {}", entry["objective"], entry["kind"], entry["origin"])).collect()
}

/// All that a run found, as text: numbers are printed so that different bits give different text.
fn found(report: &Value) -> String {
    let keys = ["objective", "controls", "evaluations", "serious_steps", "null_steps", "termination", "certificate"];
    keys.map(|key| report[key].to_string()).join("\n") + &course(report)
}

/// Whole lines of a journal, the first not counted.
fn journaled(folder: &Path) -> usize {
    let text = std::fs::read_to_string(folder.join("journal.jsonl")).unwrap_or_default();
    text.matches('\n').count().saturating_sub(1)
}

/// Waits until the journal in the folder holds so many evaluations.
fn wait_for(child: &mut Child, folder: &Path, evaluations: usize) {
    let clock = Instant::now();
    while journaled(folder) < evaluations {
        assert!(child.try_wait().unwrap().is_none(), "the run ended before {evaluations} evaluations");
        assert!(clock.elapsed() < Duration::from_secs(60), "no {evaluations} evaluations in a minute");
        std::thread::sleep(Duration::from_millis(1));
    }
}

const RUN: [&str; 7] = ["--mesh", "6", "--optimizer", "bundle", "--max-evaluations", "20", "--json"];

/// Jacobians are read on resumption; those that are lost or torn are computed again, to the same bits.
#[test]
fn runs_with_jacobians_resume_to_the_same_bits_whatever_became_of_their_files() {
    let scene = ["--mesh", "6", "--json"];
    for solver in ["newton", "direct"] {
        let scene = [&scene[..], &["--solver", solver]].concat();
        let whole = succeeded(&scene);
        assert_eq!(whole["termination"]["confirmed"], true);
        assert!(whole["jacobians"].as_u64() > Some(5));
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        succeeded(&[&scene[..], &["--max-evaluations", "6", "--out", text(&folder)]].concat());
        let file = |evaluation: usize| folder.join(format!("linearization_{evaluation}.bin"));
        let torn = std::fs::read(file(3)).unwrap();
        std::fs::write(file(3), &torn[..torn.len() / 2]).unwrap();
        std::fs::remove_file(file(5)).unwrap();
        let resumed = succeeded(&["--resume", text(&folder), "--max-evaluations", "150", "--json"]);
        assert_eq!(found(&resumed), found(&whole));
        assert_eq!(resumed["resumed_evaluations"], 6);
        let said = resumed["warnings"].to_string();
        for evaluation in [3, 5] {
            assert!(said.contains(&format!("the Jacobian of evaluation {evaluation} is lost")), "{said}");
        }
        assert_eq!(std::fs::read(file(3)).unwrap(), torn);
    }
}

/// SIGKILL twice, at different places; the end is that of a run that was left alone, bit by bit.
#[test]
fn killed_runs_resume_to_the_same_bits_and_lose_one_evaluation_at_most() {
    let whole = succeeded(&RUN);
    for places in [[1, 2], [4, 11], [9, 14]] {
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        let first = [&RUN[..], &["--out", text(&folder)]].concat();
        let resume = ["--resume", text(&folder), "--json"];
        let mut kept = 0;
        for (arguments, evaluations) in [(&first[..], places[0]), (&resume[..], places[1])] {
            let mut child = command(arguments).env("RUST_LOG", "problems=debug").spawn().unwrap();
            wait_for(&mut child, &folder, evaluations);
            child.kill().unwrap();
            let output = child.wait_with_output().unwrap();
            let begun = kit::errors(&output).matches("evaluation begins").count();
            let lines = journaled(&folder);
            assert!(lines >= evaluations && kept + begun <= lines + 1, "{kept} + {begun} begun, {lines} kept");
            kept = lines;
            assert!(!folder.join("report.json").exists());
        }
        let resumed = succeeded(&resume);
        assert_eq!(found(&resumed), found(&whole));
        assert_eq!(resumed["resumed_evaluations"], kept);
        // Those about the final state only, none about the journal.
        assert_eq!(resumed["warnings"], whole["warnings"]);
        assert!(resumed["seconds"].as_f64().unwrap() > 0.0);
    }
}

/// Several starts: the best one is reported with its own start, and a resumed run repeats them.
#[test]
fn several_starts_are_reported_by_the_best_and_resumed() {
    let options = ["--mesh", "6", "--starts", "3", "--json"];
    let whole = succeeded(&options);
    let runs = whole["stages"].as_array().unwrap();
    let [objectives, starts] = ["objective", "objective_start"]
        .map(|key| runs.iter().map(|run| run[key].as_f64().unwrap()).collect::<Vec<f64>>());
    assert!(starts[0] != starts[1] && starts[1] != starts[2], "{starts:?}");
    let best = (0..3).min_by(|a, b| objectives[*a].total_cmp(&objectives[*b])).unwrap();
    assert_eq!(whole["objective"], objectives[best]);
    assert!((whole["objective_start"].as_f64().unwrap() / starts[best] - 1.0).abs() < 1e-9);
    assert!((1..=3).contains(&whole["optima"].as_u64().unwrap()));
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    succeeded(&[&options[..], &["--max-evaluations", "4", "--out", text(&folder)]].concat());
    let resumed = succeeded(&["--resume", text(&folder), "--max-evaluations", "150", "--json"]);
    assert_eq!(found(&resumed), found(&whole));
    refused(&["--starts", "2", "--continuation", "2,4"], &["--starts", "1 with optimizer.continuation"]);
}

#[test]
fn both_kinds_of_restart_data_resume() {
    let scene = ["--mesh", "4", "--solver", "direct", "--json"];
    let whole = succeeded(&[&scene[..], &["--max-evaluations", "12"]].concat());
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    succeeded(&[&scene[..], &["--max-evaluations", "5", "--out", text(&folder)]].concat());
    let resumed = succeeded(&["--resume", text(&folder), "--max-evaluations", "12", "--json"]);
    assert_eq!(found(&resumed), found(&whole));
}

#[test]
fn an_interrupted_run_reports_says_how_to_resume_and_resumes() {
    let limit = ["--mesh", "6", "--max-evaluations", "40", "--json"];
    let whole = succeeded(&limit);
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let mut child = command(&[&limit[..], &["--out", text(&folder)]].concat()).spawn().unwrap();
    wait_for(&mut child, &folder, 3);
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let message = kit::errors(&output);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains(&format!("--resume {}", text(&folder))), "{message}");
    let report = printed(&output);
    assert_eq!(report["termination"]["reason"], "stopped_by_observer");
    assert_eq!(report["termination"]["text"], "interrupted on request");
    assert_eq!(std::fs::read(folder.join("report.json")).unwrap(), output.stdout);
    let journal = Journal::read(&folder).unwrap().unwrap();
    assert_eq!(journal.entries.len() as u64, report["evaluations"].as_u64().unwrap());
    assert_eq!(journal.dimension, report["controls"].as_array().unwrap().len());
    assert_eq!(found(&succeeded(&["--resume", text(&folder), "--json"])), found(&whole));
}

#[test]
fn limits_end_a_run_with_a_report_and_can_be_raised() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let timed = succeeded(&["--mesh", "6", "--time-limit", "0.05", "--no-checks", "--json", "--out", text(&folder)]);
    assert_eq!(timed["termination"]["reason"], "time_limit");
    let page = std::fs::read_to_string(folder.join("report.txt")).unwrap();
    assert!(page.contains(&format!(" {SIGNORINI} --resume {} --no-checks\n", text(&folder))), "{page}");
    let done = timed["evaluations"].as_u64().unwrap();
    let limit = (done + 3).to_string();
    let larger = ["--max-evaluations", &limit, "--time-limit", "60", "--no-checks", "--json"];
    let resumed = succeeded(&[&["--resume", text(&folder)], &larger[..]].concat());
    assert!(resumed["left_out"].to_string().contains("--no-checks"), "{}", resumed["left_out"]);
    assert_eq!(resumed["termination"]["reason"], "evaluation_limit");
    assert_eq!(resumed["resumed_evaluations"], done);
    assert_eq!(found(&resumed), found(&succeeded(&["--mesh", "6", "--max-evaluations", &limit, "--json"])));
}

/// Status 1, words on stderr, nothing on stdout.
fn failed(output: &Output, words: &[&str]) {
    let message = kit::errors(output);
    assert!(output.status.code() == Some(1) && output.stdout.is_empty(), "{}: {message}", output.status);
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn folders_that_cannot_be_written_are_noticed_at_the_start() {
    let scratch = kit::scratch();
    std::fs::write(scratch.path().join("file"), "").unwrap();
    for place in ["file/below", "file"] {
        let place = scratch.path().join(place);
        failed(&kit::run(SIGNORINI, &["--mesh", "4", "--out", text(&place)]), &[text(&place), "Not a directory"]);
    }
    // A limit on the size of files stands for a full disk: the system refuses the bytes in the same way.
    let script = "ulimit -f 64; exec \"$0\" --mesh 4 --out \"$1\"";
    let full = scratch.path().join("made/full");
    failed(&kit::run("sh", &["-c", script, SIGNORINI, text(&full)]), &["cannot write", "bytes there"]);
    assert!(!scratch.path().join("made").exists(), "a refusal leaves nothing");
}

#[test]
fn output_that_cannot_be_printed_is_a_failure() {
    let script = "\"$0\" evaluate --mesh 4 --json > /dev/full";
    failed(&kit::run("sh", &["-c", script, SIGNORINI]), &["stdout", "No space left"]);
    let mut child = command(&["evaluate", "--mesh", "4", "--json"]).spawn().unwrap();
    drop(child.stdout.take());
    failed(&child.wait_with_output().unwrap(), &["stdout", "Broken pipe"]);
}

/// Everything in a folder, with its content.
fn everything(folder: &Path) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(everything(&path))
        } else {
            found.push((path.clone(), std::fs::read(&path).unwrap()))
        }
    }
    found.sort();
    found
}

#[test]
fn folders_with_files_of_others_are_refused_and_results_are_renamed() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let run = ["--mesh", "3", "--max-evaluations", "3", "--json", "--out", text(&folder)];
    let overwrite = [&run[..], &["--overwrite"]].concat();
    let evaluate = ["evaluate", "--mesh", "3", "--json", "--overwrite", "--out", text(&folder)];
    std::fs::create_dir_all(folder.join("figures")).unwrap();
    for name in ["scene.toml", "report.json", ".hidden", "figures/pressure.svg"] {
        std::fs::write(folder.join(name), "mine").unwrap();
        let before = everything(&folder);
        for arguments in [&run[..], &overwrite, &evaluate] {
            refused(arguments, &[name, "not written by this program"]);
        }
        assert_eq!(everything(&folder), before);
        std::fs::remove_file(folder.join(name)).unwrap();
    }
    succeeded(&run);
    let before = everything(&folder);
    refused(&run, &["holds results", "--overwrite"]);
    for name in ["notes.txt", "vtk/mine.vtu"] {
        std::fs::write(folder.join(name), "mine").unwrap();
        refused(&overwrite, &[name, "not written by this program"]);
        std::fs::remove_file(folder.join(name)).unwrap();
    }
    assert_eq!(everything(&folder), before);
    for number in 1..=2 {
        succeeded(if number == 1 { &overwrite } else { &evaluate });
        let renamed = scratch.path().join(format!("run.{number}"));
        assert_eq!(everything(&renamed).len(), before.len());
    }
    // What is wrong with the input is found before a folder is touched.
    refused(&[&evaluate[..], &["--controls", "none.json"]].concat(), &["--controls", "none.json"]);
    assert!(!scratch.path().join("run.3").exists() && folder.join("evaluation.json").exists());
    // So is a scene without equilibrium, or what was begun is taken back.
    let before = everything(scratch.path());
    let loose = ["--mesh", "3", "--load-factor", "-1"];
    let new = scratch.path().join("new");
    for command in [&["compare"][..], &["--continuation", "2,3"], &["evaluate"]] {
        let options = if command[0] == "--continuation" { &loose[2..] } else { &loose[..] };
        refused(&[command, options, &["--overwrite", "--out", text(&folder)]].concat(), &["no equilibrium"]);
        refused(&[command, options, &["--out", text(&new)]].concat(), &["no equilibrium"]);
        assert!(everything(scratch.path()) == before && !new.exists(), "{command:?}");
    }
}

#[test]
fn a_changed_scene_and_another_version_are_refused_on_resume() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let options = ["--mesh", "3", "--optimizer", "bundle", "--json", "--max-evaluations"];
    let scene = scenes.join("flat_punch.toml");
    let contact = |arguments: &[&str]| kit::run(env!("CARGO_BIN_EXE_contact3d"), arguments);
    let whole = kit::parsed(&contact(&[&[text(&scene)][..], &options, &["6"]].concat()));
    kit::parsed(&contact(&[&[text(&scene)][..], &options, &["4", "--out", text(&folder)]].concat()));
    let before = everything(&folder);
    let resume = ["--resume", text(&folder), "--json", "--max-evaluations", "6"];
    let changes = [
        ("scene.toml", "friction = ", "friction = 1", "friction"),
        ("obstacle.csv", ",", ",1", "obstacle.csv"),
        ("start.json", ".", "1.", "start.json"),
        ("journal.jsonl", env!("CARGO_PKG_VERSION"), "0.0.7", "--new-version"),
    ];
    for (name, right, wrong, word) in changes {
        let original = std::fs::read_to_string(folder.join(name)).unwrap();
        assert!(original.contains(right), "{name}");
        std::fs::write(folder.join(name), original.replacen(right, wrong, 1)).unwrap();
        let changed = everything(&folder);
        let output = contact(&resume);
        let message = kit::errors(&output);
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(message.contains("journal.jsonl") && message.contains(word), "{name}: {message}");
        assert_eq!(everything(&folder), changed);
        if word == "--new-version" {
            let resumed = kit::parsed(&contact(&[&resume[..], &["--new-version"]].concat()));
            assert_eq!((found(&resumed), &resumed["resumed_evaluations"]), (found(&whole), &serde_json::json!(4)));
        } else {
            std::fs::write(folder.join(name), original).unwrap();
            assert_eq!(everything(&folder), before);
        }
    }
}

#[test]
fn a_folder_that_vanishes_does_not_take_the_run_along() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let mut child = command(&[&RUN[..], &["--out", text(&folder)]].concat()).spawn().unwrap();
    wait_for(&mut child, &folder, 2);
    std::fs::rename(&folder, scratch.path().join("elsewhere")).unwrap();
    let output = child.wait_with_output().unwrap();
    let message = kit::errors(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains(text(&folder)) && message.contains("complete"), "{message}");
    let report = printed(&output);
    assert_eq!(found(&report), found(&succeeded(&RUN)));
    let about_the_journal = report["warnings"].to_string().matches("not in the journal").count();
    assert_eq!(about_the_journal, 1, "{}", report["warnings"]);
}

#[test]
fn what_is_no_run_is_not_resumed_and_no_run_is_lost() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    refused(&["--resume", text(&folder)], &["holds no run"]);
    refused(&["--resume", text(&folder), "--mesh", "6"], &["--resume", "--max-evaluations"]);
    refused(&["evaluate", "--resume", text(&folder)], &["--resume", "optimize"]);
    refused(&["--time-limit", "-1"], &["--time-limit", "-1"]);
    let first = ["--mesh", "4", "--max-evaluations", "3", "--json", "--out", text(&folder)];
    succeeded(&first);
    std::fs::remove_file(folder.join("report.json")).unwrap();
    refused(&first, &["has not ended", "--resume"]);
    let journal = folder.join("journal.jsonl");
    let lines = std::fs::read_to_string(&journal).unwrap();
    std::fs::write(&journal, lines.replacen("\"evaluation\":2", "\"evaluation\":7", 1)).unwrap();
    refused(&["--resume", text(&folder)], &["journal.jsonl", "line 3"]);
    std::fs::write(&journal, lines).unwrap();
    // The journal of another scene would answer for it.
    let scene = folder.join("scene.toml");
    let stated = std::fs::read_to_string(&scene).unwrap();
    let friction = stated.lines().find(|line| line.starts_with("friction = ")).unwrap();
    std::fs::write(&scene, stated.replacen(friction, "friction = 0.125", 1)).unwrap();
    refused(&["--resume", text(&folder)], &["journal.jsonl", "another objective", "0.125"]);
    std::fs::write(&scene, stated).unwrap();
    succeeded(&["--resume", text(&folder), "--json"]);
}

/// Neither lost restart data nor a journal that does not fit end a run; both are said.
#[test]
fn what_the_folder_lacks_is_computed_again_with_a_warning() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let whole = succeeded(&["--mesh", "4", "--max-evaluations", "8", "--json"]);
    succeeded(&["--mesh", "4", "--max-evaluations", "5", "--json", "--out", text(&folder)]);
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.file_name().unwrap().to_str().unwrap().starts_with("warm_start_") {
            std::fs::remove_file(path).unwrap();
        }
    }
    let resume = ["--resume", text(&folder), "--max-evaluations", "8", "--json"];
    let resumed = succeeded(&resume);
    assert!(resumed["warnings"].to_string().contains("restart data"), "{}", resumed["warnings"]);
    let objectives = [&whole, &resumed].map(|report| report["objective"].as_f64().unwrap());
    assert!((objectives[0] - objectives[1]).abs() <= 1e-7 * objectives[0], "{objectives:?}");
    let journal = folder.join("journal.jsonl");
    let lines: Vec<String> = std::fs::read_to_string(&journal).unwrap().lines().map(str::to_owned).collect();
    let elsewhere = lines[4].replacen("\"point\":[", "\"point\":[1", 1);
    std::fs::write(&journal, [lines[..4].join("\n"), elsewhere, lines[5..].join("\n"), String::new()].join("\n"))
        .unwrap();
    let resumed = succeeded(&resume);
    assert!(resumed["warnings"].to_string().contains("evaluation 4 of the journal"), "{}", resumed["warnings"]);
    assert_eq!(resumed["evaluations"], 8);
    assert_eq!(journaled(&folder), 8);
}

#[test]
fn nothing_is_said_unless_asked_for() {
    let arguments = ["--mesh", "4", "--max-evaluations", "3", "--json"];
    assert_eq!(kit::errors(&kit::run(SIGNORINI, &arguments)), "");
    let logged = |level: &str| {
        let output = command(&arguments).env("RUST_LOG", level).output().unwrap();
        (output.status.code(), kit::errors(&output))
    };
    let (code, text) = logged("info");
    assert!(
        code == Some(0) && text.matches("evaluation done").count() == 3 && !text.contains("contact state"),
        "{text}"
    );
    assert!(logged("contact=debug").1.contains("contact state"));
    let (code, text) = logged("problems=loud");
    assert!(code == Some(2) && text.contains("RUST_LOG"), "{text}");
}

#[test]
fn coarse_to_fine_reports_its_stages_and_resumes() {
    let arguments = ["--continuation", "4,6", "--max-evaluations", "8", "--json"];
    let whole = succeeded(&arguments);
    let stages = whole["stages"].as_array().unwrap();
    assert_eq!(stages.len(), 2);
    assert_eq!(stages[1]["mesh"], serde_json::json!([6, 6, 6]));
    assert_eq!(stages[1]["objective"], whole["objective"]);
    let alone = succeeded(&["--mesh", "6", "--max-evaluations", "1", "--json"]);
    assert!(stages[1]["objective_start"].as_f64().unwrap() < 0.5 * alone["objective_start"].as_f64().unwrap());
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let mut child = command(&[&arguments[..], &["--out", text(&folder)]].concat()).spawn().unwrap();
    wait_for(&mut child, &folder.join("stage_6"), 3);
    child.kill().unwrap();
    let _killed = child.wait().unwrap();
    let resumed = succeeded(&["--resume", text(&folder), "--json"]);
    assert_eq!(found(&resumed), found(&whole));
    refused(&["--continuation", "6,4"], &["continuation", "growing"]);
    refused(&["--continuation", "4,6", "--mesh", "6"], &["--mesh", "--continuation"]);
}

/// A build with other fields of the optimizer writes the same run in another way.
#[test]
fn a_run_of_a_build_with_other_fields_goes_on() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let small = ["--mesh", "3", "--max-evaluations", "2", "--json"];
    succeeded(&[&small[..], &["--out", text(&folder)]].concat());
    let journal = folder.join("journal.jsonl");
    let written = std::fs::read_to_string(&journal).unwrap();
    let older = written.replacen(r#"\"optimizer\":{"#, r#"\"optimizer\":{\"method\":\"composite\","#, 1);
    assert!(older != written, "{written}");
    std::fs::write(&journal, older).unwrap();
    let resumed = succeeded(&["--resume", text(&folder), "--max-evaluations", "4", "--json"]);
    assert_eq!(resumed["resumed_evaluations"], 2);
    let at_once = succeeded(&["--mesh", "3", "--max-evaluations", "4", "--json"]);
    assert_eq!(resumed["objective"], at_once["objective"]);
}
