//! Stopping rules of the caller, combined with `|` and `&`.

use super::record::IterationRecord;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::{BitAnd, BitOr};

/// A condition on the history after which the run ends.
///
/// ```
/// use nonsmooth::StopRule;
/// let stalled = StopRule::Stalled { evaluations: 10, relative: 1e-3 };
/// let rule = StopRule::ValueBelow(1.5) | (StopRule::Evaluations(20) & stalled);
/// assert!(rule.holds(&[]).is_none());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StopRule {
    /// The best value is at most this.
    ValueBelow(f64),
    /// At least so many evaluations are done.
    Evaluations(usize),
    /// At least so many seconds have passed.
    Seconds(f64),
    /// The best value fell by less than `relative`·|value| in the last `evaluations` evaluations.
    Stalled {
        /// Length of the window.
        evaluations: usize,
        /// Relative decrease that counts as progress.
        relative: f64,
    },
    /// The model predicts a decrease of at most this, in units of Θ.
    PredictedDecreaseBelow(f64),
    /// One of the rules holds.
    Any(Vec<StopRule>),
    /// All rules hold.
    All(Vec<StopRule>),
}

impl StopRule {
    /// The text of the rule that holds for a history, if it does.
    pub fn holds(&self, history: &[IterationRecord]) -> Option<String> {
        let last = history.last()?;
        let holds = match self {
            Self::ValueBelow(target) => last.center_value <= *target,
            Self::Evaluations(limit) => last.evaluation >= *limit,
            Self::Seconds(limit) => last.seconds >= *limit,
            Self::PredictedDecreaseBelow(limit) => history.len() > 1 && last.predicted_decrease <= *limit,
            Self::Stalled { evaluations, relative } => {
                history.len() > *evaluations && {
                    let before = history[history.len() - 1 - evaluations].center_value;
                    before - last.center_value < relative * last.center_value.abs()
                }
            }
            Self::Any(rules) => return rules.iter().find_map(|rule| rule.holds(history)),
            Self::All(rules) => rules.iter().all(|rule| rule.holds(history).is_some()),
        };
        holds.then(|| self.to_string())
    }
}

impl BitOr for StopRule {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        match self {
            Self::Any(mut rules) => {
                rules.push(other);
                Self::Any(rules)
            }
            first => Self::Any(vec![first, other]),
        }
    }
}

impl BitAnd for StopRule {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        match self {
            Self::All(mut rules) => {
                rules.push(other);
                Self::All(rules)
            }
            first => Self::All(vec![first, other]),
        }
    }
}

impl fmt::Display for StopRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let join = |f: &mut fmt::Formatter<'_>, rules: &[Self], separator: &str| {
            let texts: Vec<String> = rules.iter().map(|rule| format!("({rule})")).collect();
            write!(f, "{}", texts.join(separator))
        };
        match self {
            Self::ValueBelow(target) => write!(f, "value ≤ {target}"),
            Self::Evaluations(limit) => write!(f, "evaluations ≥ {limit}"),
            Self::Seconds(limit) => write!(f, "seconds ≥ {limit}"),
            Self::PredictedDecreaseBelow(limit) => write!(f, "predicted decrease ≤ {limit}"),
            Self::Stalled { evaluations, relative } => {
                write!(f, "relative decrease below {relative} in {evaluations} evaluations")
            }
            Self::Any(rules) => join(f, rules, " or "),
            Self::All(rules) => join(f, rules, " and "),
        }
    }
}
