//! Bad input and interruptions: one message, by process 0, and the exit status of a single process.

use super::{PATIENCE, PROGRAM, begun, end_of, ended, errors, mpirun, scene, started};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use testset::kit::{scratch, text};

/// Asserts that a command ends with status 2 and one message with these words.
fn refused(command: Command, words: &[&str]) {
    let output = ended(command);
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(said.matches("error:").count(), 1, "{said}");
    assert!(words.iter().all(|word| said.contains(word)) && output.stdout.is_empty(), "{said}");
}

#[test]
fn bad_input_is_refused_once() {
    let scene = scene("signorini");
    let scene = text(&scene);
    let evaluate = [scene, "evaluate", "--mesh", "4"];
    let too_many = ["number of processes = 9", "at most 8"];
    refused(started(PROGRAM, 9, &evaluate), &too_many);
    // Where total FETI may follow later, it is refused before any work.
    refused(started(PROGRAM, 9, &[scene, "--mesh", "4"]), &too_many);
    refused(started(PROGRAM, 3, &[scene, "--mesh", "none"]), &["--mesh"]);
    refused(started(PROGRAM, 3, &["no_such.toml", "evaluate"]), &["no_such.toml"]);
    refused(started(PROGRAM, 2, &[scene, "--resume", scene]), &["--resume"]);
    // A load in the opposite direction pulls the body off the obstacle.
    let reversed = [&evaluate[..], &["--solver", "newton", "--load-factor", "-1"]].concat();
    let output = ended(started(PROGRAM, 2, &reversed));
    assert_eq!(errors(&output).matches("error:").count(), 1, "{}", errors(&output));
    assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
}

#[test]
fn processes_of_different_builds_are_refused() {
    let folder = scratch();
    let other = folder.path().join("contact3d-mpi");
    let mut bytes = std::fs::read(PROGRAM).unwrap();
    bytes.push(0);
    std::fs::write(&other, bytes).unwrap();
    std::fs::set_permissions(&other, std::fs::metadata(PROGRAM).unwrap().permissions()).unwrap();
    let scene = scene("signorini");
    let mut command = mpirun();
    command.args(["-n", "2", PROGRAM, text(&scene), "evaluate", ":", "-n", "1", text(&other), text(&scene)]);
    refused(command, &["process 2 runs version", "process 0 runs version", "the same build"]);
}

#[test]
fn an_interruption_of_the_first_process_ends_the_run_with_its_report() {
    let (folder, scene) = (scratch(), scene("signorini"));
    let [number, out] = ["number", "out"].map(|name| folder.path().join(name));
    // The shell tells the number of the first process, which takes its place.
    let script = format!("test $OMPI_COMM_WORLD_RANK = 0 && echo $$ > '{}'; exec \"$@\"", text(&number));
    let run = ["--mesh", "6", "--solver", "newton", "--optimizer", "bundle", "--json", "--out", text(&out)];
    let mut command = mpirun();
    command.args(["-n", "2", "sh", "-c", &script, "sh", PROGRAM, text(&scene)]).args(run);
    let child = begun(command);
    let journal = out.join("journal.jsonl");
    let clock = Instant::now();
    while std::fs::read_to_string(&journal).unwrap_or_default().lines().count() < 3 {
        assert!(clock.elapsed() < PATIENCE, "no evaluation in {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
    let process = std::fs::read_to_string(&number).unwrap();
    assert!(Command::new("kill").args(["-INT", process.trim()]).status().unwrap().success());
    let output = end_of(child);
    assert_eq!(output.status.code(), Some(130), "{}", errors(&output));
    assert!(errors(&output).contains("error: interrupted; continue with"), "{}", errors(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["evaluations"].as_u64() >= Some(2) && out.join("report.json").exists(), "{report}");
}

#[test]
fn a_build_without_mpi_is_told_what_to_install() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("build.sh");
    let output = Command::new("bash").arg(script).env("MPICC", "/nonexistent").output().unwrap();
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("an MPI library with its compiler mpicc (libopenmpi-dev, openmpi-bin)"), "{said}");
    assert!(said.contains("apt-get install libopenmpi-dev openmpi-bin libclang-dev clang"), "{said}");
}
