//! `contact3d-mpi` under `mpirun`, against the command of a single process, which runs inside the test.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod equal;
#[cfg(feature = "failures")]
mod failures;
mod refused;

use problems::commands::{Arguments, Failure, execute};
use scene_file::SceneFile;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_contact3d-mpi");

/// Longest time of a run of these tests; those that hang take longer.
const PATIENCE: Duration = Duration::from_secs(300);

/// A scene of the repository.
fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(format!("{name}.toml"))
}

/// `mpirun` with more processes than processors, quiet about the exit status, also for the superuser of a container.
fn mpirun() -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--oversubscribe", "-q"]);
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    // A program that ends by a signal tells where, without the words of the MPI library.
    command.env("OMPI_MCA_opal_signal", "").env_remove("RUST_BACKTRACE").env_remove("RUST_LOG");
    command
}

/// A program in so many processes.
fn started(program: &str, processes: usize, arguments: &[&str]) -> Command {
    let mut command = mpirun();
    command.args(["-n", &processes.to_string(), program]).args(arguments);
    command
}

/// The output of a command that must not hang.
fn ended(command: Command) -> Output {
    end_of(begun(command))
}

/// A command that runs, and is heard.
fn begun(mut command: Command) -> Child {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// The output of a command that runs and must not hang.
fn end_of(mut child: Child) -> Output {
    let clock = Instant::now();
    let [stdout, stderr] = [drain(child.stdout.take().unwrap()), drain(child.stderr.take().unwrap())];
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if clock.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("{child:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    Output { status, stdout: stdout.join().unwrap(), stderr: stderr.join().unwrap() }
}

/// Reads what a process says while it runs.
fn drain(mut pipe: impl std::io::Read + Send + 'static) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).unwrap();
        bytes
    })
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The JSON of a command in several processes.
fn together(processes: usize, arguments: &[&str]) -> Value {
    let output = ended(started(PROGRAM, processes, arguments));
    assert!(output.status.success(), "{arguments:?}: {}", errors(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The JSON of the same command in this process alone.
fn alone(scene: Option<&Path>, options: &[&str]) -> Result<Value, Failure> {
    let arguments = Arguments::try_parse_from([&["contact3d"], options].concat()).unwrap();
    let open = || {
        let scene = scene.unwrap();
        Ok((SceneFile::read(scene)?, Some(scene.to_owned())))
    };
    Ok(serde_json::from_str(&execute(open, &arguments)?).unwrap())
}

/// A report without what differs between two equal runs: times, and what several processes have used.
fn without_times(mut report: Value) -> Value {
    fn strip(value: &mut Value) {
        match value {
            Value::Object(fields) => {
                fields.remove("seconds");
                fields.remove("processes");
                fields.values_mut().for_each(strip);
            }
            Value::Array(values) => values.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut report);
    report
}
