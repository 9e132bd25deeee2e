//! The side of a closed surface on which a body is.

use serde::{Deserialize, Serialize};

/// On which side of a closed surface the body is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "SideName", transform = crate::schema::names_only))]
pub enum Side {
    /// Outside: the obstacle is convex.
    #[default]
    Outside,
    /// Inside: the obstacle is a socket or a bore.
    Inside,
}
