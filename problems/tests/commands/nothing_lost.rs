//! Runs that are killed at random moments, processes that meet in one folder, and disks that fill: no evaluation is
//! lost, no file is replaced, and every run ends at the bits of one that was left alone.
//!
//! `NOTHING_LOST=all cargo test --release -p problems --test commands nothing_lost -- --nocapture` makes 200 kills, 50
//! meetings and fills 20 disks; without the variable a few of each. Moments are drawn from a seed, in parts of the time
//! that a run takes.

#![cfg(target_os = "linux")]
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Output};
use std::time::{Duration, Instant};
use testset::kit::{self, Random, text};

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");

/// The commands that write: the options that begin a run, and the command word of both beginning and resuming.
const WRITERS: [(&[&str], &[&str]); 3] = [
    (&[], &["--mesh", "3", "--max-evaluations", "12"]),
    (&["compare"], &["--mesh", "3", "--max-evaluations", "6"]),
    (&[], &["--continuation", "2,4", "--max-evaluations", "8"]),
];

/// As many as are asked for, or a sample.
fn count(all: usize, sample: usize) -> usize {
    if std::env::var("NOTHING_LOST").is_ok_and(|value| value == "all") { all } else { sample }
}

/// What a command found, without times and without what tells a resumed run from another.
fn found(output: &Value) -> String {
    let keys =
        ["objective", "controls", "jacobians", "evaluations", "termination", "certificate", "shapes", "terminations"];
    keys.map(|key| output[key].to_string()).join("\n")
}

/// A command with what it finds and how long it takes when it is left alone.
struct Writer {
    word: &'static [&'static str],
    options: &'static [&'static str],
    found: String,
    time: Duration,
}

impl Writer {
    fn new(which: usize) -> Self {
        let (word, options) = WRITERS[which % WRITERS.len()];
        let scratch = kit::scratch();
        let mut this = Self { word, options, found: String::new(), time: Duration::ZERO };
        let clock = Instant::now();
        this.found = found(&kit::parsed(&this.begin(&scratch.path().join("run"), &[]).output().unwrap()));
        this.time = clock.elapsed();
        this
    }

    fn begin(&self, folder: &Path, more: &[&str]) -> Command {
        kit::command(SIGNORINI, &[self.word, self.options, &["--json", "--out", text(folder)], more].concat())
    }

    /// Resumes the run that the folder holds, or begins it if it was not begun.
    fn go_on(&self, folder: &Path) -> Command {
        if !folder.join("scene.toml").exists() {
            return self.begin(folder, &[]);
        }
        kit::command(SIGNORINI, &[self.word, &["--resume", text(folder), "--json"]].concat())
    }

    /// A moment of a run, from its beginning to its end. Early ones are more frequent: what is resumed ends earlier.
    fn moment(&self, random: &mut Random) -> Duration {
        self.time.mul_f64(random.unit().powi(2))
    }

    /// The end of a run is that of one that was left alone, also after the interruptions that it has had.
    fn ends_alike(&self, folder: &Path) {
        let output = self.go_on(folder).output().unwrap();
        assert_eq!(found(&kit::parsed(&output)), self.found, "{}", kit::errors(&output));
        assert!(!kit::errors(&output).contains("warning"), "{}", kit::errors(&output));
        let written = std::fs::read(folder.join("report.json")).unwrap();
        assert!(written == output.stdout, "report.json is not what was printed");
    }
}

fn writers() -> [Writer; 3] {
    [0, 1, 2].map(Writer::new)
}

/// Whole lines of all journals of a folder.
fn journaled(folder: &Path) -> usize {
    ["", "with_friction", "without_friction", "stage_2", "stage_4"]
        .map(|part| {
            std::fs::read_to_string(folder.join(part).join("journal.jsonl")).unwrap_or_default().matches('\n').count()
        })
        .iter()
        .sum()
}

/// Kills a process after some time; whether it had not ended before.
fn kill_after(mut child: Child, delay: Duration) -> bool {
    std::thread::sleep(delay);
    let ended = child.try_wait().unwrap().is_some();
    child.kill().unwrap();
    child.wait().unwrap();
    !ended
}

#[test]
fn killed_runs_lose_nothing() {
    let (writers, mut random) = (writers(), Random(12));
    let (mut kills, mut runs) = (0, 0);
    while kills < count(200, 6) {
        let writer = &writers[runs % writers.len()];
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        let mut kept = 0;
        for _kill in 0..=random.below(3) {
            let child = writer.go_on(&folder).spawn().unwrap();
            kills += usize::from(kill_after(child, writer.moment(&mut random)));
            let now = journaled(&folder);
            assert!(now >= kept, "{kept} lines were kept, {now} are left");
            kept = now;
        }
        writer.ends_alike(&folder);
        // What is there then is known to be the program's own, and is not replaced.
        kit::refused(SIGNORINI, &["--out", text(&folder)], &["holds results", "--overwrite"]);
        runs += 1;
    }
    println!("{kills} kills; {runs} runs ended at the same bits");
}

/// Exactly one of two processes works in a folder; the other one is refused, and changes nothing.
#[test]
fn two_processes_never_share_a_folder() {
    let (writers, mut random) = (writers(), Random(34));
    let (meetings, mut at_once) = (count(50, 6), 0);
    for meeting in 0..meetings {
        let writer = &writers[meeting % writers.len()];
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        let resumed = meeting % 2 == 1;
        if resumed {
            kill_after(writer.begin(&folder, &[]).spawn().unwrap(), writer.time.mul_f64(0.5));
        }
        // A resumed run may be resumed again when it has ended, so that the second one must come before.
        let delay = writer.time.mul_f64(0.3 * random.unit() * f64::from(u8::from(random.below(2) == 0)));
        let first = writer.go_on(&folder).spawn().unwrap();
        std::thread::sleep(delay);
        let second = if resumed { writer.go_on(&folder) } else { writer.begin(&folder, &[]) }.output().unwrap();
        let outputs = [first.wait_with_output().unwrap(), second];
        let (done, refused): (Vec<&Output>, Vec<&Output>) = outputs.iter().partition(|output| output.status.success());
        for output in &refused {
            let message = kit::errors(output);
            assert_eq!(output.status.code(), Some(2), "{message}");
            at_once += usize::from(message.contains("another process"));
            let words = ["another process", "holds results", "has not ended"];
            assert!(words.iter().any(|word| message.contains(word)), "{message}");
        }
        assert!(!done.is_empty() && (resumed || done.len() == 1), "{} of two processes ended", done.len());
        assert!(done.iter().all(|output| found(&kit::parsed(output)) == writer.found));
        writer.ends_alike(&folder);
    }
    println!("{meetings} meetings, {at_once} of them at the same time");
    assert!(2 * at_once >= meetings);
}

/// Two processes that begin in one folder within a millisecond: one works, and the other one is told so.
#[test]
fn beginnings_at_one_moment_are_one_beginning_and_one_refusal() {
    let mut random = Random(78);
    for _meeting in 0..count(1000, 100) {
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        let mut run = kit::command(SIGNORINI, &["evaluate", "--mesh", "2", "--json", "--out", text(&folder)]);
        let first = run.spawn().unwrap();
        std::thread::sleep(Duration::from_secs_f64(1e-3 * random.unit()));
        let outputs = [run.output().unwrap(), first.wait_with_output().unwrap()];
        let (done, refused): (Vec<&Output>, Vec<&Output>) = outputs.iter().partition(|output| output.status.success());
        let message = refused.iter().map(|output| kit::errors(output)).collect::<String>();
        // The first one may have ended on a busy machine.
        let is_told = ["another process works", "holds results"].iter().any(|words| message.contains(words));
        assert!(done.len() == 1 && is_told, "{message}");
    }
}

/// Limits the size of files of a process that is running: the system refuses more bytes as on a full disk.
fn limit(child: &Child, bytes: &str) {
    let arguments = ["--pid", &child.id().to_string(), &format!("--fsize={bytes}:")];
    assert!(Command::new("prlimit").args(arguments).status().unwrap().success());
}

/// The disk fills at some moment, and in every third case has room again later: the run goes on, says what is missing,
/// and is resumed to the same bits.
#[test]
fn full_disks_are_reported_and_lose_nothing() {
    let (writers, mut random) = (writers(), Random(56));
    let (disks, mut incomplete) = (count(20, 3), 0);
    for disk in 0..disks {
        let writer = &writers[disk % writers.len()];
        let scratch = kit::scratch();
        let folder = scratch.path().join("run");
        let child = writer.begin(&folder, &[]).spawn().unwrap();
        std::thread::sleep(writer.time.mul_f64(0.9 * random.unit()));
        if folder.join("scene.toml").exists() {
            limit(&child, &random.below(20_000).to_string());
            if disk % 3 == 2 {
                std::thread::sleep(writer.time.mul_f64(0.3 * random.unit()));
                limit(&child, "unlimited");
            }
        }
        let output = child.wait_with_output().unwrap();
        let message = kit::errors(&output);
        match output.status.code() {
            Some(0) => assert!(folder.join("report.json").exists(), "{message}"),
            Some(1) => {
                assert!(message.contains("File too large"), "{message}");
                incomplete += 1;
            }
            other => panic!("exit status {other:?}: {message}"),
        }
        writer.ends_alike(&folder);
    }
    println!("{disks} disks filled, {incomplete} runs ended with status 1");
    assert!(3 * incomplete >= disks);
}
