//! The whole matrix of stiff and extreme cases.

use studies::stability::{Case, CaseOutcome, Counts, StabilityReport, all, mixed_units, random_scenes, terminations};

#[test]
fn every_case_is_solved_refused_or_a_known_limit_as_expected() {
    let report = StabilityReport::new(all().iter().map(Case::run).collect());
    let broken = report.records.iter().filter(|record| record.outcome == CaseOutcome::Broken);
    let broken: Vec<String> =
        broken.map(|record| format!("{}: {}: {}", record.group, record.name, record.remark)).collect();
    assert!(broken.is_empty(), "{broken:#?}");
    // The numbers of docs/stability.md.
    let Counts { solved, refused, limits, broken } = report.counts;
    assert_eq!([solved + limits, refused, broken], [135, 11, 0]);
    // Cases next to the rounding floor move between the two with the last bits.
    assert!(limits <= 10, "{limits}");
}

/// The numbers of docs/stability.md.
#[test]
fn random_scenes_have_states_that_the_default_finds() {
    let counts = random_scenes(1, 2000).counts;
    assert_eq!(
        [counts.scenes, counts.wrong, counts.panics, counts.beyond_cost, counts.disagreeing],
        [2000, 0, 0, 0, 0]
    );
    // On one plate of 1 : 1000, total FETI alone finds a state, after more work than the default spends.
    assert_eq!([counts.solvable, counts.solved], [1786, 1785]);
    assert_eq!([counts.frictionless_solvable, counts.frictionless_solved], [663; 2]);
}

#[test]
fn the_terminations_are_true() {
    let report = terminations(|_| true).unwrap();
    assert!(report.runs >= 3000, "{}", report.runs);
    assert!(report.offenders.is_empty(), "{:#?}", report.offenders);
    // 30 of 32 and 34 of 44, as shares of what the collection holds.
    assert!(report.convex_confirmed.0 * 32 >= report.convex_confirmed.1 * 30, "{:?}", report.convex_confirmed);
    assert!(
        report.all_confirmed.0 >= 34 && report.convex_cost <= 1.2,
        "{:?} {}",
        report.all_confirmed,
        report.convex_cost
    );
}

/// Convex problems in units of 1 to 1e±8, whose minima cone programs give.
#[test]
fn the_terminations_are_true_in_mixed_units() {
    let report = mixed_units(|_| true).unwrap();
    assert!(report.runs >= 3000, "{}", report.runs);
    assert!(report.false_terminations == 0, "{:#?}", report.offenders());
}
