//! Journals: a run is continued to the same bits, and what does not fit is refused or said.
use crate::common::{cb3, crescent, distance_1, plane, v};
use nonsmooth::journal::RecordedAnswer;
use nonsmooth::{
    Answer, BundleTrust, BundleTrustConfig, Evaluation, FnObjective, Journal, JournalError, Journaled,
    NonsmoothObjective, OracleError, Polyhedron, Report, Request, StopRule, Termination, Vector,
};
use std::cell::Cell;
use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A folder that is removed with the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("nonsmooth-restart-{}-{name}", std::process::id()));
        let _absent = fs::remove_dir_all(&path);
        Self(path)
    }

    fn journal(&self) -> PathBuf {
        self.0.join("journal.jsonl")
    }

    fn held(&self) -> usize {
        Journal::read(&self.0).unwrap().map_or(0, |journal| journal.entries.len())
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _absent = fs::remove_dir_all(&self.0);
    }
}

/// (x − 3)² + |y|, with all that an oracle can do: an answer that depends on the restart data, early answers above the
/// target, failures, panics, and a count of its evaluations.
#[derive(Default)]
struct Moody {
    evaluations: Cell<usize>,
    /// Evaluations of this invocation that fail and that panic.
    fails: Option<usize>,
    panics: Option<usize>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct Memory {
    steps: f64,
    trail: Vec<f64>,
}

impl NonsmoothObjective for Moody {
    type WarmStart = Memory;

    fn dimension(&self) -> usize {
        2
    }

    fn evaluate(&self, request: &Request<'_, Memory>) -> Result<Answer<Memory>, OracleError> {
        self.evaluations.set(self.evaluations.get() + 1);
        let now = Some(self.evaluations.get());
        assert!(self.panics != now, "no answer today");
        if self.fails == now {
            return Err(OracleError::OutsideDomain { reason: "x is too bold".into() });
        }
        let (x, y) = (request.point[0], request.point[1]);
        let start = request.warm_start.map_or((0.0, 0.1), |memory| (memory.steps, memory.trail[0]));
        // Rounding in which restart data show.
        let value = (x - 3.0).powi(2) + y.abs() + 1e-13 * (start.0 + start.1).sin();
        let warm_start = Memory { steps: start.0 + 1.0, trail: vec![start.1 * 0.7 + x / 3.0, -0.0, 1e-310] };
        let subgradient = v(&[2.0 * (x - 3.0), y.signum()]);
        let evaluation = Evaluation { error_bound: 1e-13, ..Evaluation::exact(value, subgradient, warm_start) };
        let hopeless = request.descent_target.is_some_and(|target| value > target + 1e-3);
        Ok(if hopeless { Answer::NoDescent(evaluation) } else { Answer::Accurate(evaluation) })
    }
}

fn method(set: Option<&Polyhedron>) -> BundleTrust<'static> {
    let method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    if let Some(set) = set { method.constraints(set.clone()) } else { method }
}

/// All that a run found; numbers are printed so that different bits give different text.
fn found(report: &Report) -> String {
    let mut report = report.clone();
    report.seconds = 0.0;
    report.history.iter_mut().for_each(|record| record.seconds = 0.0);
    serde_json::to_string(&report).unwrap()
}

/// Interrupts after every number of evaluations, continues, and compares bit by bit.
fn resume_equals_uninterrupted<O: NonsmoothObjective<WarmStart = ()>>(
    name: &str,
    theta: &O,
    set: Option<&Polyhedron>,
    start: &[f64],
) {
    let whole = method(set).minimize(theta, v(start)).unwrap();
    for evaluations in 1..=whole.counts.evaluations {
        let folder = Folder::new(name);
        let stopped = Journaled::open(theta, &*folder, name).unwrap();
        method(set).stop_when(StopRule::Evaluations(evaluations)).minimize(&stopped, v(start)).unwrap();
        let journaled = Journaled::open(theta, &*folder, name).unwrap();
        assert_eq!(journaled.held(), evaluations);
        let mut resumed = method(set).minimize(&journaled, v(start)).unwrap();
        journaled.complete(&mut resumed);
        assert_eq!(found(&resumed), found(&whole), "interrupted after {evaluations} evaluations");
        let files = fs::read_dir(&*folder).unwrap().count();
        assert_eq!(files, 1, "an objective without warm start keeps no restart data");
    }
}

#[test]
fn resume_equals_uninterrupted_convex() {
    resume_equals_uninterrupted("convex", &cb3(), None, &[2.0, 2.0]);
}

#[test]
fn resume_equals_uninterrupted_nonconvex() {
    resume_equals_uninterrupted("nonconvex", &crescent(), None, &[-1.2, 1.0]);
}

#[test]
fn resume_equals_uninterrupted_constrained() {
    let set = plane(&[1.0, -2.0, 0.5], 1.0, 4.0);
    resume_equals_uninterrupted("constrained", &distance_1(v(&[0.3, 1.0, -2.0])), Some(&set), &[3.0, -3.0, 1.0]);
}

/// A run of the moody oracle with its journal.
fn moody(folder: &Path, oracle: &Moody, evaluations: usize) -> (Report, usize) {
    let config = BundleTrustConfig { max_evaluations: evaluations, ..BundleTrustConfig::default() };
    let journaled = Journaled::open(oracle, folder, "moody").unwrap();
    let mut report = BundleTrust::new(config).unwrap().minimize(&journaled, v(&[-2.0, 1.7])).unwrap();
    journaled.complete(&mut report);
    (report, journaled.held())
}

/// The limit is raised from one invocation to the next; the oracle gets the restart data that it had.
#[test]
fn restart_data_failures_and_panics_survive_and_nothing_is_evaluated_twice() {
    let limit = 14;
    let oracle = || Moody { fails: Some(3), panics: Some(5), ..Moody::default() };
    let uninterrupted = Folder::new("moody-whole");
    let (whole, _) = moody(&uninterrupted, &oracle(), limit);
    assert_eq!((whole.counts.evaluations, whole.counts.failed, whole.warnings.len()), (limit, 2, 0), "{whole}");
    let direct = BundleTrust::new(BundleTrustConfig { max_evaluations: limit, ..BundleTrustConfig::default() });
    assert_eq!(found(&direct.unwrap().minimize(&oracle(), v(&[-2.0, 1.7])).unwrap()), found(&whole));
    let entries = Journal::read(&*uninterrupted).unwrap().unwrap().entries;
    let failure = RecordedAnswer::Failed("outside the domain: x is too bold".into());
    assert_eq!(entries[2].answer, failure);
    assert!(entries.iter().any(|entry| matches!(entry.answer, RecordedAnswer::Evaluated { no_descent: true, .. })));
    for first in 1..limit {
        let folder = Folder::new("moody");
        moody(&folder, &oracle(), first);
        let left = |number: usize| number.checked_sub(first).filter(|number| *number > 0);
        let second = Moody { fails: left(3), panics: left(5), ..Moody::default() };
        let (resumed, held) = moody(&folder, &second, limit);
        assert_eq!((held, second.evaluations.get()), (first, limit - first));
        assert_eq!(found(&resumed), found(&whole), "continued after {first} evaluations");
        assert!(resumed.history.windows(2).all(|pair| pair[0].seconds <= pair[1].seconds));
        assert!(resumed.seconds >= resumed.history[limit - 1].seconds);
        let again = Journal::read(&*folder).unwrap().unwrap().entries;
        let untimed = |entries: &[nonsmooth::journal::Entry]| {
            let mut entries = entries.to_vec();
            entries.iter_mut().for_each(|entry| entry.seconds = 0.0);
            entries
        };
        assert_eq!(untimed(&again), untimed(&entries));
        assert!(fs::read_dir(&*folder).unwrap().count() <= 3, "restart data of two evaluations at most are kept");
    }
}

#[test]
fn a_torn_last_line_is_cut_off_wherever_it_ends() {
    let folder = Folder::new("torn");
    let (whole, _) = moody(&folder, &Moody::default(), 6);
    let bytes = fs::read(folder.journal()).unwrap();
    let last = bytes[..bytes.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
    moody(&folder, &Moody::default(), 5);
    for end in [last, last + 1, (last + bytes.len()) / 2, bytes.len() - 1] {
        let torn = Folder::new("torn-again");
        moody(&torn, &Moody::default(), 5);
        let mut text = fs::read(torn.journal()).unwrap();
        text.extend(&bytes[last..end]);
        fs::write(torn.journal(), text).unwrap();
        let (resumed, held) = moody(&torn, &Moody::default(), 6);
        assert_eq!((held, torn.held()), (5, 6));
        assert_eq!(found(&resumed), found(&whole), "torn at byte {end}");
    }
    // The first line may be torn as well: then there is nothing to continue.
    fs::write(folder.journal(), &bytes[..10]).unwrap();
    assert_eq!(Journal::read(&*folder).unwrap(), None);
    assert_eq!(moody(&folder, &Moody::default(), 6).1, 0);
    assert_eq!(folder.held(), 6);
}

#[test]
fn foreign_journals_are_refused_and_left_alone() {
    let folder = Folder::new("foreign");
    moody(&folder, &Moody::default(), 3);
    let text = fs::read_to_string(folder.journal()).unwrap();
    let refused = |identity: &str, dimension: usize| {
        let objective = FnObjective::new(dimension, |x: &Vector| (0.0, x.clone()));
        Journaled::open(objective, &*folder, identity).err().unwrap()
    };
    let error = refused("noisy", 2);
    assert!(
        matches!(&error, JournalError::Identity { found, expected, .. } if found == "moody" && expected == "noisy")
    );
    assert!(["journal.jsonl", "\"moody\"", "\"noisy\""].iter().all(|word| error.to_string().contains(word)), "{error}");
    assert!(matches!(refused("moody", 3), JournalError::Dimension { found: 2, expected: 3, .. }));
    for (old, new, line) in [
        ("{\"journal\":3", "{\"journal\":99", None),
        ("\"evaluation\":2", "\"evaluation\":7", Some(3)),
        ("\"point\":[", "\"point\":[1.0,", Some(2)),
        ("\"answer\"", "\"reply\"", Some(2)),
        ("{\"journal\":3", "[1, 2", Some(1)),
    ] {
        let changed = text.replacen(old, new, 1);
        fs::write(folder.journal(), &changed).unwrap();
        match (refused("moody", 2), line) {
            (JournalError::Version { found: 99, .. }, None) => {}
            (JournalError::Line { line: found, .. }, Some(line)) => assert_eq!(found, line, "{new}"),
            (error, _) => panic!("{new}: {error}"),
        }
        assert_eq!(fs::read_to_string(folder.journal()).unwrap(), changed);
    }
    assert!(matches!(Journaled::open(cb3(), folder.journal(), "x"), Err(JournalError::File { .. })));
}

#[test]
fn other_requests_and_lost_restart_data_are_computed_again_with_a_warning() {
    let folder = Folder::new("other");
    let (whole, _) = moody(&folder, &Moody::default(), 8);
    let journaled = Journaled::open(Moody::default(), &*folder, "moody").unwrap();
    let config = BundleTrustConfig { max_evaluations: 4, first_step: Some(0.3), ..BundleTrustConfig::default() };
    BundleTrust::new(config).unwrap().minimize(&journaled, v(&[-2.0, 1.7])).unwrap();
    // What the first run no longer needed is gone: the restart data of its start.
    let warnings = journaled.warnings();
    assert!(warnings.len() == 2 && warnings[0].contains("evaluation 2 of the journal"), "{warnings:?}");
    assert!(warnings[1].contains("the restart data of evaluation 1"), "{warnings:?}");
    assert_eq!(folder.held(), 4);
    let lost = Folder::new("lost");
    moody(&lost, &Moody::default(), 5);
    for entry in fs::read_dir(&*lost).unwrap() {
        let path = entry.unwrap().path();
        if path != lost.journal() {
            fs::write(path, "{\"steps\":1.0,").unwrap();
        }
    }
    let (resumed, _) = moody(&lost, &Moody::default(), 8);
    assert!(resumed.warnings[0].contains("the restart data of evaluation"), "{:?}", resumed.warnings);
    assert!((resumed.value - whole.value).abs() < 1e-3);
}

/// Θ = −∞ ends a run; the journal has a form for it, and for what is no number.
#[test]
fn numbers_that_json_lacks_survive() {
    let folder = Folder::new("infinite");
    let run = |sleepy: bool| {
        let calls = Cell::new(0);
        let theta = FnObjective::new(1, |x: &Vector| {
            assert!(!sleepy, "the journal knows all answers");
            calls.set(calls.get() + 1);
            let value = [x[0], f64::NAN, f64::NEG_INFINITY][calls.get() - 1];
            (value, Vector::from_element(1, 1.0))
        });
        let journaled = Journaled::open(&theta, &*folder, "falling").unwrap();
        let report = method(None).minimize(&journaled, v(&[1.0])).unwrap();
        assert_eq!(journaled.warnings(), Vec::<String>::new());
        report
    };
    let first = run(false);
    assert_eq!((&first.termination, first.counts.failed), (&Termination::UnboundedBelow, 1));
    assert_eq!(found(&run(true)), found(&first));
}

#[test]
fn an_interrupted_evaluation_ends_the_run_and_is_asked_again() {
    let (theta, folder, calls) = (crescent(), Folder::new("interrupted"), Cell::new(0));
    let start = v(&[-1.0, 2.0]);
    let whole = method(None).minimize(&theta, start.clone()).unwrap();
    let interrupted = FnObjective::new(2, |x: &Vector| {
        calls.set(calls.get() + 1);
        if calls.get() == 6 {
            return Err(OracleError::Interrupted);
        }
        let evaluation = theta.evaluate(&Request::tight(x)).unwrap().into_evaluation();
        Ok((evaluation.value, evaluation.subgradient))
    });
    let journaled = Journaled::open(&interrupted, &*folder, "crescent").unwrap();
    let report = method(None).minimize(&journaled, start.clone()).unwrap();
    assert_eq!((report.termination, report.counts.evaluations), (Termination::StoppedByObserver, 5));
    assert_eq!((report.history.len(), report.counts.failed, folder.held()), (5, 0, 5));
    assert_eq!(report.value, whole.history[4].center_value);
    let journaled = Journaled::open(&interrupted, &*folder, "crescent").unwrap();
    let mut resumed = method(None).minimize(&journaled, start).unwrap();
    journaled.complete(&mut resumed);
    assert_eq!(found(&resumed), found(&whole));
    assert_eq!(calls.get(), whole.counts.evaluations + 1);
}
