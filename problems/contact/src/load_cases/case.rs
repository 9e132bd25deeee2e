//! One load case, and how several are rated together.

use crate::contact_shape::ContactShape;
use crate::cost::Quantity;
use crate::equilibrium::ContactProblem;
use nonsmooth::OracleError;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// How the measures J_k of several cases with weights w_k make one objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "OverName", transform = crate::schema::names_only))]
pub enum Over {
    /// max w_k J_k: the case that is worst.
    #[default]
    Worst,
    /// Σ w_k J_k.
    Sum,
}

/// A load case: its contact problem with a solver, and what it counts.
#[derive(Debug)]
pub struct LoadCase {
    /// What reports call it; empty for the only case of a scene.
    pub name: String,
    /// The factor w > 0 of its measure.
    pub weight: f64,
    /// The map from controls to states under its loads.
    pub shape: ContactShape,
    /// What is minimised in it: the same for all cases.
    pub quantity: Quantity,
}

/// A case without its solver.
#[derive(Debug, Clone)]
pub struct WeightedCase<'a> {
    /// As [`LoadCase::name`].
    pub name: &'a str,
    /// As [`LoadCase::weight`].
    pub weight: f64,
    /// As [`LoadCase::quantity`].
    pub quantity: Quantity,
    /// The discrete problem of the case.
    pub problem: &'a ContactProblem,
}

/// A state of one case that could not be found.
#[derive(Debug, Error)]
#[error("case \"{name}\": {source}")]
pub struct CaseFailed {
    /// The name of the case.
    pub name: String,
    /// Why there is no state.
    pub source: OracleError,
}

/// A failure with the name of its case, where there are several.
pub(super) fn named(name: &str, error: OracleError) -> OracleError {
    match error {
        _ if name.is_empty() => error,
        OracleError::Interrupted => error,
        OracleError::OutsideDomain { reason } => {
            OracleError::OutsideDomain { reason: format!("case \"{name}\": {reason}") }
        }
        source => OracleError::Failed(Box::new(CaseFailed { name: name.to_owned(), source })),
    }
}
