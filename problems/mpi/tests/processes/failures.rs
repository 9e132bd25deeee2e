//! A failure of one process anywhere ends all: none hangs, one message says why, and the run can be continued.

use super::{PROGRAM, ended, errors, scene, started, together};
use serde_json::Value;
use std::path::Path;
use testset::kit::{Random, scratch, text};

const FAILING: &str = env!("CARGO_BIN_EXE_contact3d-mpi-failing");

/// Kinds of failures, each with the exit status that it leads to.
const KINDS: [(&str, i32); 5] = [("panic", 101), ("kill", 137), ("exit", 3), ("memory", 134), ("flat", 1)];

const RUN: [&str; 10] =
    ["--mesh", "4", "--solver", "newton", "--threads", "1", "--max-evaluations", "3", "--json", "--out"];

/// Failures of an ordinary run of the test.
const FEW: usize = 24;

/// Lets one process fail; whether it did.
fn fails(rank: usize, processes: usize, call: usize, (kind, status): (&str, i32), folder: &Path) -> bool {
    let scene = scene("signorini");
    let mut command = started(FAILING, processes, &[&[text(&scene)], &RUN[..], &[text(folder)]].concat());
    command.env("FAILING_PROCESS", format!("{rank} {call} {kind}"));
    let output = ended(command);
    let place = format!("process {rank} of {processes}, call {call}, {kind}: {}", errors(&output));
    // A call that does not happen fails nowhere; the first process announces its heights and does not hear others.
    if output.status.success() {
        assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok(), "{place}");
        return false;
    }
    assert_eq!(output.status.code(), Some(status), "{place}");
    let said = errors(&output);
    let messages = said.lines().filter(|line| line.starts_with("error:") || line.starts_with("memory allocation"));
    assert_eq!(messages.count(), usize::from(kind != "kill" && kind != "exit"), "{place}");
    true
}

/// So many failures at places that a seed decides; one in four folders that are left is continued to the same end.
fn many(count: usize, seed: u64) {
    let (folder, scene) = (scratch(), scene("signorini"));
    let whole = folder.path().join("whole");
    let expected = together(2, &[&[text(&scene)], &RUN[..], &[text(&whole)]].concat());
    let mut random = Random(seed);
    let (mut failed, mut continued, mut number) = (0, 0, 0);
    while failed < count {
        number += 1;
        let (kind, processes) = (KINDS[number % KINDS.len()], 2 + random.below(3));
        // Half of the failures happen while the run begins.
        let call = random.below(if number.is_multiple_of(2) { 60 } else { 1500 });
        let kept = folder.path().join(number.to_string());
        failed += usize::from(fails(random.below(processes), processes, call, kind, &kept));
        assert!(number < 4 * count, "{failed} failures in {number} runs");
        let begun = number % 4 == 0 && kept.join("start.json").exists() && kept.join("scene.toml").exists();
        if begun && kind.0 == "flat" {
            // The journal holds the failure as what came of the evaluation, as for a single process.
            let output = ended(started(PROGRAM, 2, &["--resume", text(&kept), "--json"]));
            assert!(output.status.success() || errors(&output).contains("Cholesky"), "{}", errors(&output));
            continued += 1;
        } else if begun {
            let report = together(2, &["--resume", text(&kept), "--json"]);
            for key in ["objective", "controls", "evaluations", "certificate"] {
                assert_eq!(report[key], expected[key], "{key} after failure {number}");
            }
            continued += 1;
        }
    }
    assert!(continued > 0, "no folder was continued");
    eprintln!("{failed} failures in {number} runs; {continued} folders continued by {PROGRAM}");
}

/// The program exchanges values between all pairs of processes before its command, and panics if one is wrong.
#[test]
fn parcels_of_any_size_arrive() {
    let scene = scene("signorini");
    for processes in [2, 4] {
        let output = ended(started(FAILING, processes, &[text(&scene), "evaluate", "--mesh", "4"]));
        assert!(output.status.success(), "{}", errors(&output));
    }
}

/// FAILURES of the environment says how many.
#[test]
fn failures_end_all_processes() {
    let count = std::env::var("FAILURES").map_or(FEW, |count| count.parse().expect("FAILURES: a number"));
    // Most of their time is waiting for `mpirun`.
    std::thread::scope(|scope| (1..=4).for_each(|seed| drop(scope.spawn(move || many(count / 4, seed)))));
}
