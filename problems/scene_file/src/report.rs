//! Reports of a scene file: quantities that are told.

use crate::quantity::{Details, Lookup, QuantityName};
use contact::cost::Reported;
use contact::error::SceneError;
use contact::names::find;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A quantity that is told for every shape, beside objective and limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReportSection {
    /// What is told.
    pub quantity: QuantityName,
    /// What tables call it. Default the name of the quantity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The name of the case in which it is told. Default all cases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// What the quantity needs.
    #[serde(flatten)]
    pub details: Details,
}

/// The reports of a file, for cases with these names.
///
/// # Errors
/// [`SceneError::OutOfRange`] for a case that does not exist, for two reports with the same words, and as
/// [`Details::quantity`].
pub(crate) fn reports(
    sections: &[ReportSection],
    cases: &[&str],
    lookup: &Lookup<'_>,
) -> Result<Vec<Reported>, SceneError> {
    let mut reports: Vec<Reported> = Vec::new();
    for (index, section) in sections.iter().enumerate() {
        let field = |name: &str| format!("report[{index}].{name}");
        if let Some(case) = &section.case {
            find(&field("case"), case, cases.iter().copied())?;
        }
        let quantity = section.details.quantity(section.quantity, (&field, false), lookup)?;
        let (label, case) = (section.label.clone(), section.case.clone());
        let report = Reported { quantity, label, case };
        if reports.iter().any(|other| other.title() == report.title()) {
            let allowed = "a label that no other report of the case has";
            return Err(SceneError::out_of_range(field("label"), report.title(), allowed));
        }
        reports.push(report);
    }
    Ok(reports)
}
