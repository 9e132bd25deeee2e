//! `fields`: what a scene file may hold, type by type.

use crate::commands::failure::Failure;

/// What the arguments of a program ask for, if they ask for the fields of scene files: `fields`, `fields TYPE`.
pub fn asked(binary: &str, arguments: &[String]) -> Option<Result<String, Failure>> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["fields"] => Some(scene_file::field_tables(None).map_err(Failure::from)),
        ["fields", kind] if !kind.starts_with('-') => Some(scene_file::field_tables(Some(kind)).map_err(Failure::from)),
        ["fields", ..] => {
            Some(Err(Failure::Input(format!("{binary} fields [TYPE] takes one type at most, such as body or contact"))))
        }
        _ => None,
    }
}
