//! Fields that must be there, and bodies by their names.

use contact::error::SceneError;
use contact::names::find;
use contact::scene::BodyScene;

/// A field that a scene must have here.
pub(crate) fn required<'f, T>(field: &str, value: Option<&'f T>, allowed: &str) -> Result<&'f T, SceneError> {
    value.ok_or_else(|| SceneError::out_of_range(field, "missing", allowed))
}

/// The number of the body with the name in a field; the only body where there is no name.
pub(crate) fn body_number(field: &str, name: Option<&String>, bodies: &[BodyScene]) -> Result<usize, SceneError> {
    let names = bodies.iter().map(|body| body.name.as_str());
    match name {
        Some(name) => find(field, name, names),
        None if bodies.len() == 1 => Ok(0),
        None => {
            let allowed = format!("one of {}", names.collect::<Vec<_>>().join(", "));
            Err(SceneError::out_of_range(field, "missing", allowed))
        }
    }
}
