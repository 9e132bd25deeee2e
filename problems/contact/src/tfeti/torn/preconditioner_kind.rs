//! Which preconditioner: known to the torn bodies, since it decides what is factored.

/// Preconditioner of the dual operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "PreconditionerName", transform = crate::schema::names_only))]
#[non_exhaustive]
pub enum PreconditionerKind {
    /// Schur complements of the subdomains: fewest products with F.
    #[default]
    Dirichlet,
    /// Stiffness of the subdomain boundaries: no interior factorisation.
    Lumped,
    /// The identity, scaled.
    None,
}
