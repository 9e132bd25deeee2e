//! The contact solvers by name.

/// Which contact solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "SolverName", transform = crate::schema::names_only))]
#[non_exhaustive]
pub enum SolverKind {
    /// Total FETI first wherever it is sound, direct condensation where sizes or a stall ask for it.
    #[default]
    Auto,
    /// Semismooth Newton on total FETI.
    Newton,
    /// Semismooth Newton on directly condensed bodies.
    Direct,
    /// The paper's path on total FETI: successive approximations, dual QPs by SMALSE-M and MPGP.
    AugmentedLagrangian,
}
