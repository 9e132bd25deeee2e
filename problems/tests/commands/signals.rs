//! Signals of the system: requests to end, hangups, limits on the size of files.

#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};
use testset::kit::{self, text};

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");

/// An optimization of few evaluations.
fn run(mesh: &'static str) -> [&'static str; 6] {
    ["--mesh", mesh, "--optimizer", "bundle", "--max-evaluations", "3"]
}

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// Waits for the first evaluation of the run in a folder.
fn wait_for_the_first(child: &mut Child, folder: &Path) {
    let clock = Instant::now();
    let journaled = || std::fs::read_to_string(folder.join("journal.jsonl")).unwrap_or_default().matches('\n').count();
    while journaled() < 2 {
        assert!(child.try_wait().unwrap().is_none(), "the run ended before its first evaluation");
        assert!(clock.elapsed() < Duration::from_secs(60), "no evaluation in a minute");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_request_after_the_answer_ends_the_program_at_once() {
    for signal in ["-INT", "-TERM"] {
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        // An evaluation takes many times as long as an answer.
        let mut child = kit::command(SIGNORINI, &[&run("20")[..], &["--out", text(&folder)]].concat()).spawn().unwrap();
        wait_for_the_first(&mut child, &folder);
        send(signal, &child);
        let mut errors = BufReader::new(child.stderr.take().unwrap()).lines();
        assert!(errors.any(|line| line.unwrap().contains("once more ends the program at once")));
        send(signal, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130));
        assert!(output.stdout.is_empty() && !folder.join("report.json").exists(), "the run was ended orderly");
    }
}

/// `timeout` sends its request to the program and to its group.
#[test]
fn a_request_that_is_sent_twice_at_once_is_one() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let mut child = kit::command(SIGNORINI, &[&run("20")[..], &["--out", text(&folder)]].concat()).spawn().unwrap();
    wait_for_the_first(&mut child, &folder);
    let twice = format!("kill -TERM {0}; kill -TERM {0}", child.id());
    assert!(Command::new("sh").args(["-c", &twice]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let message = kit::errors(&output);
    assert_eq!(output.status.code(), Some(130), "{message}");
    assert!(message.contains("once more ends the program") && folder.join("report.json").exists(), "{message}");
}

#[test]
fn a_run_that_ignores_hangups_outlives_its_terminal() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    // What nohup does.
    let script = "trap '' HUP; exec \"$0\" \"$@\"";
    let arguments = [&["-c", script, SIGNORINI][..], &run("12"), &["--out", text(&folder)]].concat();
    let mut child = kit::command("sh", &arguments).spawn().unwrap();
    wait_for_the_first(&mut child, &folder);
    send("-HUP", &child);
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && folder.join("report.json").exists(), "{}", kit::errors(&output));
}

#[test]
fn a_limit_on_the_size_of_files_is_a_message_and_status_1() {
    let scratch = kit::scratch();
    let page = scratch.path().join("page");
    // The shell itself writes nothing to a file.
    let script = "ulimit -f 0; exec \"$0\" evaluate --mesh 4 --json > \"$1\"";
    let output = kit::run("sh", &["-c", script, SIGNORINI, text(&page)]);
    let message = kit::errors(&output);
    assert_eq!(output.status.code(), Some(1), "{}: {message}", output.status);
    assert!(message.contains("stdout: File too large"), "{message}");
}
