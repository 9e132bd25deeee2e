//! A case of the matrix, how it ended, and its line in the table.

use crate::markdown::{or_dash, section};

/// How a case ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CaseOutcome {
    /// Solved to its certificate; the independent paths agree.
    Solved,
    /// Refused with a typed error that names the cause.
    Refused,
    /// A known limit: not solved, or not by every path, for the cause stated.
    Limit,
    /// Not what was expected.
    #[default]
    Broken,
}

impl CaseOutcome {
    fn name(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Refused => "refused",
            Self::Limit => "limit",
            Self::Broken => "**broken**",
        }
    }
}

/// What was found out about a case.
#[derive(Debug, Clone, Default)]
pub struct Record {
    /// The group of the case.
    pub group: &'static str,
    /// Its name within the group.
    pub name: String,
    /// How it ended.
    pub outcome: CaseOutcome,
    /// Cause of a refusal or limit, what broke, or a finding.
    pub remark: String,
    /// Steps and products of total FETI, then of direct condensation.
    pub work: Vec<String>,
    /// Largest relative residual of both.
    pub residual: Option<f64>,
    /// Largest difference of contact forces between the two, over the largest force.
    pub force_difference: Option<f64>,
    /// Largest difference of shape sensitivities, over the largest.
    pub subgradient_difference: Option<f64>,
    /// Contraction factor of the slip bounds at the state, exact (from the condensed matrices).
    pub contraction: Option<f64>,
    /// Condition number of Newton's matrix on the contact displacements.
    pub condition: Option<f64>,
}

impl Record {
    /// A record without contact solvers.
    pub fn plain(outcome: CaseOutcome, remark: String) -> Self {
        Self { outcome, remark, ..Self::default() }
    }

    /// One line for the terminal.
    pub fn progress(&self) -> String {
        format!("{:9} {}: {} {}", self.outcome.name(), self.group, self.name, self.remark)
    }

    fn cells(&self) -> Vec<String> {
        let number = |value| or_dash(value, |value: f64| format!("{value:.1e}"));
        let escaped = |text: &str| text.replace('|', "\\|").replace('\n', " ");
        vec![
            escaped(&self.name),
            self.outcome.name().into(),
            if self.work.is_empty() { "–".into() } else { self.work.join("; ") },
            number(self.residual),
            number(self.force_difference),
            number(self.subgradient_difference),
            or_dash(self.contraction, |value| format!("{value:.3}")),
            number(self.condition),
            escaped(&self.remark),
        ]
    }
}

/// One line of the matrix.
pub struct Case {
    /// The group of cases to which the case belongs.
    pub group: &'static str,
    /// Name within the group.
    pub name: String,
    run: Box<dyn Fn() -> Record + Send + Sync>,
}

impl Case {
    /// A case; the record that `run` makes gets group and name from here.
    pub fn new(group: &'static str, name: impl Into<String>, run: impl Fn() -> Record + Send + Sync + 'static) -> Self {
        Self { group, name: name.into(), run: Box::new(run) }
    }

    /// Runs the case and records its outcome.
    pub fn run(&self) -> Record {
        Record { group: self.group, name: self.name.clone(), ..(self.run)() }
    }
}

/// Numbers of solved, refused, limited and broken cases.
pub fn counts(records: &[Record]) -> [usize; 4] {
    [CaseOutcome::Solved, CaseOutcome::Refused, CaseOutcome::Limit, CaseOutcome::Broken]
        .map(|outcome| records.iter().filter(|record| record.outcome == outcome).count())
}

/// All records as Markdown tables, one per group.
pub fn markdown(records: &[Record]) -> String {
    let [solved, refused, limits, broken] = counts(records);
    let mut text = format!(
        "{} cases: {solved} solved to their certificates, {refused} refused with reason, {limits} known limits, {broken} \
         broken.\n",
        records.len(),
    );
    let head = "case | outcome | steps: products (TFETI; direct) | largest residual | Δ forces | Δ subgradient | \
                contraction | condition | remark";
    let groups = records.chunk_by(|one, next| one.group == next.group);
    text.extend(groups.map(|group| section(group[0].group, head, group.iter().map(Record::cells))));
    text
}
