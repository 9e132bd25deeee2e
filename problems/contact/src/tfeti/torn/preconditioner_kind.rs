//! Which preconditioner: known to the torn bodies, since it decides what is factored.

/// Which preconditioner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "PreconditionerName", transform = crate::schema::names_only))]
#[non_exhaustive]
pub enum PreconditionerKind {
    /// Schur complements: fewest products with F.
    #[default]
    Dirichlet,
    /// Boundary stiffness: no interior factorisation.
    Lumped,
    /// The identity, scaled.
    None,
}
