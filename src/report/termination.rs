//! Why a run ended.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Why a run ended, with the numbers behind it. Only [`Stationary`](Self::Stationary) is a confirmed solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Termination {
    /// Aggregate subgradient and aggregate error are small, and every active cut lies next to the center or Θ is
    /// declared convex.
    Stationary {
        /// Radius of the active cuts relative to the size of the variables.
        radius: f64,
        /// If Θ is declared convex: how far Θ can lie above its minimum within reach, in units of Θ. Every variable
        /// reaches as far as the one does that lies farthest from zero or from its start.
        #[serde(default)]
        gap: Option<f64>,
    },
    /// The model promises less than the tolerance, again after local restarts or because Θ looks convex, but some
    /// active cuts lie away from the center: optimal if Θ is convex there, probably stationary otherwise.
    StationaryUnconfirmed {
        /// Radius of the active cuts relative to the size of the variables.
        radius: f64,
        /// A variable, counted from 0, about which the subgradients say nothing: along it, they do not cancel, and its
        /// unit hides what is left to gain.
        #[serde(default)]
        undecided: Option<usize>,
    },
    /// No direction reduces the violation of the nonlinear constraints: to first order there is no feasible point
    /// nearby.
    Infeasible {
        /// The violation: the largest c_j⁺ over ‖∇c_j‖*, a length.
        violation: f64,
    },
    /// The run ended by itself at a point that violates a nonlinear constraint.
    Violated {
        /// The constraint that is violated most, counted from 0.
        constraint: usize,
        /// The violation of the constraint, c_j or |c_j| of an equality.
        violation: f64,
        /// How the run ended there.
        end: String,
    },
    /// The point is feasible and no model finds anything lower, but the gradients of the active constraints cancel or
    /// vanish: multipliers need not exist, and nothing is confirmed.
    DegenerateConstraints {
        /// Radius of the active cuts relative to the size of the variables.
        radius: f64,
    },
    /// The decrease that the model promises is below the noise of the oracle.
    NoiseLimit {
        /// The decrease that noise and model leave open, in units of Θ: a bound of Θ(x̂) − min Θ within reach if Θ is
        /// convex.
        estimate: f64,
    },
    /// The step has become too short to change the variables while the model still promises decrease: values and
    /// subgradients contradict each other.
    StepTooShort {
        /// The decrease still promised.
        predicted_decrease: f64,
    },
    /// The largest number of evaluations was used.
    EvaluationLimit,
    /// The largest number of steps was used.
    IterationLimit,
    /// The time was used.
    TimeLimit,
    /// An observer asked to stop.
    StoppedByObserver,
    /// The caller took the report of a run that had not ended.
    Unfinished,
    /// A stopping rule of the caller holds.
    StopRule {
        /// The rule, as text.
        rule: String,
    },
    /// Θ falls beyond all measure of its first values.
    UnboundedBelow,
    /// The oracle failed again and again next to the best point.
    OracleFailing {
        /// Failures in a row.
        failures: usize,
        /// Text of the last one.
        last: String,
    },
    /// An answer of the oracle contradicts an earlier one; see
    /// [`OracleError::Contradiction`](crate::OracleError::Contradiction).
    OracleContradiction {
        /// Description of the contradiction between the two answers.
        reason: String,
    },
    /// The subproblem could not be solved.
    SubproblemFailed {
        /// Description of the failure.
        reason: String,
    },
}

impl Termination {
    /// Whether the run found a stationary point and confirmed it.
    pub fn is_confirmed(&self) -> bool {
        matches!(self, Self::Stationary { .. })
    }

    /// Whether the run ended at a point that the model calls stationary, confirmed or not.
    pub fn is_stationary(&self) -> bool {
        matches!(self, Self::Stationary { .. } | Self::StationaryUnconfirmed { .. })
    }

    /// What to try next. `convex`: whether the problem was declared convex.
    pub(super) fn advice(&self, convex: bool) -> &'static str {
        match self {
            Self::Stationary { .. } => "the certificate can be re-checked offline",
            Self::StationaryUnconfirmed { undecided: Some(_), .. } => "give typical sizes of the variables, or bounds",
            Self::StationaryUnconfirmed { .. } if convex => {
                "the cuts leave no bound: check that objective and constraints are convex, or start again from here"
            }
            Self::StationaryUnconfirmed { .. } => {
                "optimal if the problem is convex; otherwise start again from here, or from elsewhere, and compare"
            }
            Self::Infeasible { .. } => "start elsewhere, or relax the constraints",
            Self::Violated { .. } => "start elsewhere, and check the derivatives of the constraint",
            Self::DegenerateConstraints { .. } => {
                "write the constraints so that their gradients do not vanish or oppose each other"
            }
            Self::NoiseLimit { .. } => {
                if convex {
                    "a more accurate oracle is needed to get further, or the objective is not convex"
                } else {
                    "a more accurate oracle is needed to get further"
                }
            }
            Self::StepTooShort { .. } => "check the subgradients with `verify` at the best point",
            Self::EvaluationLimit => "allow more evaluations and continue",
            Self::IterationLimit => "allow more iterations and continue",
            Self::TimeLimit => "allow more time and continue",
            Self::StoppedByObserver | Self::Unfinished | Self::StopRule { .. } => {
                "continue when wanted: nothing is lost"
            }
            Self::UnboundedBelow => "add bounds on the variables",
            Self::OracleFailing { .. } => "make the oracle robust near the best point, or restrict the admissible set",
            Self::OracleContradiction { .. } => "return the same outputs in the same order at every point",
            Self::SubproblemFailed { .. } => "check the scale of the variables and of the constraint rows",
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stationary { gap: Some(gap), .. } => {
                write!(
                    f,
                    "confirmed stationary: the cuts of the convex objective leave {gap:.1e} to its minimum within reach"
                )
            }
            Self::Stationary { radius: 0.0, gap: None } => {
                write!(
                    f,
                    "confirmed stationary by the derivatives at the point itself (a local optimum need not be the best)"
                )
            }
            Self::Stationary { radius, gap: None } => {
                write!(f, "confirmed stationary by cuts within relative distance {radius:.1e}")
            }
            Self::StationaryUnconfirmed { undecided: Some(variable), .. } => {
                write!(
                    f,
                    "stationary by the model alone: nothing can be said about variable {variable} (counted from 0)"
                )
            }
            Self::StationaryUnconfirmed { radius, .. } => {
                write!(f, "stationary by the model alone: active cuts reach out to relative distance {radius:.1e}")
            }
            Self::Infeasible { violation } => {
                write!(
                    f,
                    "infeasible: the violation of the constraints is stationary, at a distance of about {violation:.1e}"
                )
            }
            Self::Violated { constraint, violation, end } => {
                write!(f, "constraint {constraint} (counted from 0) is violated by {violation:.1e}; {end}")
            }
            Self::DegenerateConstraints { .. } => {
                write!(f, "degenerate constraints: nothing lower was found, but no multipliers confirm it")
            }
            Self::NoiseLimit { estimate } => write!(f, "noise limit: values are uncertain by about {estimate:.1e}"),
            Self::StepTooShort { predicted_decrease } => {
                write!(f, "step too short: a decrease of {predicted_decrease:.1e} is still predicted but never found")
            }
            Self::EvaluationLimit => write!(f, "evaluation limit reached"),
            Self::IterationLimit => write!(f, "iteration limit reached"),
            Self::TimeLimit => write!(f, "time limit reached"),
            Self::Unfinished => write!(f, "not ended: the caller stopped asking for steps"),
            Self::StoppedByObserver => write!(f, "interrupted on request"),
            Self::StopRule { rule } => write!(f, "stopping rule holds: {rule}"),
            Self::UnboundedBelow => write!(f, "the objective is unbounded below"),
            Self::OracleFailing { failures, last } => {
                write!(f, "the oracle failed {failures} times in a row near the best point; last: {last}")
            }
            Self::OracleContradiction { reason } => write!(f, "the oracle contradicts its earlier answers: {reason}"),
            Self::SubproblemFailed { reason } => write!(f, "the subproblem failed: {reason}"),
        }
    }
}
