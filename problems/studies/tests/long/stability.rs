//! The whole matrix of stiff and extreme cases.

use studies::stability::{Case, Counts, Outcome, Report, all, random_scenes};

#[test]
fn every_case_is_solved_refused_or_a_known_limit_as_expected() {
    let report = Report::new(all().iter().map(Case::run).collect());
    let broken = report.records.iter().filter(|record| record.outcome == Outcome::Broken);
    let broken: Vec<String> =
        broken.map(|record| format!("{}: {}: {}", record.group, record.name, record.remark)).collect();
    assert!(broken.is_empty(), "{broken:#?}");
    // The numbers of docs/stability.md.
    assert_eq!(report.counts, Counts { solved: 149, refused: 13, limits: 10, broken: 0 });
}

/// The numbers of docs/stability.md.
#[test]
fn random_scenes_have_states_that_the_default_finds() {
    let counts = random_scenes(1, 2000).counts;
    assert_eq!(
        [counts.scenes, counts.wrong, counts.panics, counts.beyond_cost, counts.disagreeing],
        [2000, 0, 0, 0, 0]
    );
    assert_eq!([counts.solvable, counts.solved], [1788; 2]);
    assert_eq!([counts.frictionless_solvable, counts.frictionless_solved], [663; 2]);
}
