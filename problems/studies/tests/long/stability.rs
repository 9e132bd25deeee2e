//! The whole matrix of stiff and extreme cases.

use studies::stability::{Case, Counts, Outcome, Report, all};

#[test]
fn every_case_is_solved_refused_or_a_known_limit_as_expected() {
    let report = Report::new(all().iter().map(Case::run).collect());
    let broken = report.records.iter().filter(|record| record.outcome == Outcome::Broken);
    let broken: Vec<String> =
        broken.map(|record| format!("{}: {}: {}", record.group, record.name, record.remark)).collect();
    assert!(broken.is_empty(), "{broken:#?}");
    // The numbers of docs/stability.md.
    assert_eq!(report.counts, Counts { solved: 148, refused: 14, limits: 10, broken: 0 });
}
