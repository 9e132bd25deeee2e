//! kill −9 at any moment, resume, and the run ends bit by bit as the uninterrupted one.
//!
//! The test runs itself again as a child that keeps a journal; SIGKILL ends it at moments that differ from child to
//! child, the next child continues from the folder. Run without the usual harness: `main` is both sides.
#![allow(clippy::unwrap_used, missing_docs)]

use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Journal, Journaled, NonsmoothObjective, Report, Vector};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use testset::Problem;

const CHILD: &str = "--run-with-journal-in";
/// A nonconvex and a convex problem of the collection.
const PROBLEMS: [&str; 2] = ["EVD52", "Wong1"];
/// Kills that must have met a run between its first evaluation and its end.
const KILLS: usize = 3;
/// Time that an evaluation takes in the child.
const EVALUATION: Duration = Duration::from_millis(4);

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|argument| argument == CHILD) {
        return child(&arguments[at + 1], Path::new(&arguments[at + 2]));
    }
    for name in PROBLEMS {
        killed_and_resumed_equals_uninterrupted(name);
        println!("test killed_and_resumed_equals_uninterrupted {name} ... ok");
    }
}

/// Runs or resumes, and leaves the bits of the result beside the journal.
fn child(name: &str, folder: &Path) {
    let report = optimize(&testset::find(name).unwrap(), Some(folder), EVALUATION);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    std::fs::write(folder.join("result.tmp"), bits(&report)).unwrap();
    std::fs::rename(folder.join("result.tmp"), folder.join("result")).unwrap();
}

/// One run from the start, or from the journal in the folder.
fn optimize(problem: &Problem, folder: Option<&Path>, pause: Duration) -> Report {
    let theta = FnObjective::new(problem.dimension, |x: &Vector| {
        std::thread::sleep(pause);
        let (value, gradient) = problem.evaluate(x.as_slice());
        (value, Vector::from_vec(gradient))
    });
    let Some(folder) = folder else { return minimize(&theta, &problem.start) };
    let theta = Journaled::open(theta, folder, &problem.name).unwrap();
    let mut report = minimize(&theta, &problem.start);
    theta.complete(&mut report);
    report
}

fn minimize<O: NonsmoothObjective>(theta: &O, start: &[f64]) -> Report {
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    method.minimize(theta, Vector::from_column_slice(start)).unwrap()
}

/// Solution, value, end and history without times, numbers as bits.
fn bits(report: &Report) -> String {
    let word = |x: f64| format!("{:016x}", x.to_bits());
    let point: Vec<String> = report.solution.iter().map(|x| word(*x)).collect();
    let mut text = format!("{} {} {}\n", report.termination, word(report.value), point.join(" "));
    for record in &report.history {
        let numbers = [record.value.unwrap(), record.center_value, record.weight, record.step_length];
        text += &format!("{} {:?} {}\n", record.evaluation, record.kind, numbers.map(word).join(" "));
    }
    text
}

fn killed_and_resumed_equals_uninterrupted(name: &str) {
    let folder = std::env::temp_dir().join(format!("nonsmooth-kill-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let whole = bits(&optimize(&testset::find(name).unwrap(), None, Duration::ZERO));
    let (mut met, mut seed) = (vec![], u64::from(std::process::id()));
    let mut longest = 40;
    while !folder.join("result").exists() {
        let mut child = spawn(name, &folder);
        if met.len() < KILLS {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            std::thread::sleep(Duration::from_millis((seed >> 33) % longest));
            // A slow machine gets more time, so that every child does some work in the end.
            longest += 10;
            if let Some(evaluations) = kill(&mut child, &folder)
                && !met.contains(&evaluations)
            {
                met.push(evaluations);
            }
        }
        let status = child.wait().unwrap();
        assert!(met.len() < KILLS || status.success() || was_killed(status), "{name}: child ended with {status}");
    }
    assert_eq!(met.len(), KILLS, "{name}: the run ended before {KILLS} kills met it, at {met:?} evaluations");
    assert_eq!(std::fs::read_to_string(folder.join("result")).unwrap(), whole, "{name}: killed at {met:?}");
    std::fs::remove_dir_all(&folder).unwrap();
}

fn spawn(name: &str, folder: &PathBuf) -> Child {
    let executable = std::env::current_exe().unwrap();
    Command::new(executable).arg(CHILD).arg(name).arg(folder).stdout(Stdio::null()).spawn().unwrap()
}

/// Kills the child; returns the number of evaluations in the journal that it leaves, none if there are none or if it
/// had ended.
fn kill(child: &mut Child, folder: &Path) -> Option<usize> {
    child.kill().unwrap();
    let status = child.wait().unwrap();
    let journal = Journal::read(folder).unwrap().filter(|_| was_killed(status));
    journal.map(|journal| journal.entries.len()).filter(|evaluations| *evaluations > 0)
}

#[cfg(unix)]
fn was_killed(status: std::process::ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    status.signal() == Some(9)
}

#[cfg(not(unix))]
fn was_killed(status: std::process::ExitStatus) -> bool {
    !status.success()
}
