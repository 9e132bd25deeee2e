//! The whole matrix of stiff and extreme cases.

use crate::optimizer::{Run, check, collection, mixed_units};
use studies::stability::{Case, CaseOutcome, Record, all, counts, random_scenes};

#[test]
fn every_case_is_solved_refused_or_a_known_limit_as_expected() {
    let records: Vec<Record> = all().iter().map(Case::run).collect();
    let broken = records.iter().filter(|record| record.outcome == CaseOutcome::Broken);
    let broken: Vec<String> =
        broken.map(|record| format!("{}: {}: {}", record.group, record.name, record.remark)).collect();
    assert!(broken.is_empty(), "{broken:#?}");
    // The numbers of docs/stability.md.
    let [solved, refused, limits, broken] = counts(&records);
    assert_eq!([solved + limits, refused, broken], [135, 11, 0]);
    // Cases next to the rounding floor move between the two with the last bits.
    assert!(limits <= 10, "{limits}");
}

/// The numbers of docs/stability.md.
#[test]
fn random_scenes_have_states_that_the_default_finds() {
    let counts = random_scenes(1, 2000).counts;
    let bad = ["wrong", "panics", "beyond cost", "disagreeing"].map(|name| counts[name]);
    assert_eq!((counts["scenes"], bad), (2000, [0; 4]));
    assert_eq!([counts["solvable"], counts["solved"]], [1787; 2]);
    assert_eq!([counts["solvable without friction"], counts["solved without friction"]], [663; 2]);
}

#[test]
fn the_terminations_are_true() {
    let runs = collection(|_| true);
    check(&runs, 2500);
    let unchanged: Vec<&Run> = runs.iter().filter(|run| run.rows[0] == "as they are").collect();
    let confirmed = |kind: &str| unchanged.iter().filter(|run| run.confirmed && run.rows[1].starts_with(kind)).count();
    // 22 of 22 and 34 of 44 where this was written.
    let (convex, others) = (confirmed("convex"), confirmed("not convex"));
    assert!(unchanged.len() == 44 && convex >= 21 && convex + others >= 34, "{convex} {others}");
}

/// Convex problems in units of 1 to 1e±8, whose minimisers are chosen first.
#[test]
fn the_terminations_are_true_in_mixed_units() {
    let runs = mixed_units(|_| true);
    check(&runs, 4500);
    // The shares of docs/stability.md, less two hundredths.
    for (plain, least) in [(false, 0.9), (true, 0.8)] {
        let reached = || runs.iter().filter(|run| run.reached && run.rows[0].starts_with("plain") == plain);
        let (confirmed, of) = (reached().filter(|run| run.confirmed).count(), reached().count());
        assert!(confirmed as f64 >= least * of as f64, "{plain}: {confirmed} of {of}");
    }
}
