//! Text inside XML.

use crate::vtk::VtkError;

/// A text as the value of an attribute between double quotes, or between two tags.
///
/// # Errors
/// [`VtkError::Text`] for an empty text and for control characters, which XML 1.0 forbids or readers change.
pub fn escaped(what: &'static str, text: &str) -> Result<String, VtkError> {
    if text.is_empty() || text.chars().any(forbidden) {
        let allowed = "at least one character, no control characters";
        return Err(VtkError::Text { what, text: text.to_owned(), allowed });
    }
    // The ampersand first: the other replacements bring their own.
    let named = [("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ("\"", "&quot;"), ("'", "&apos;")];
    Ok(named.iter().fold(text.to_owned(), |text, (character, name)| text.replace(character, name)))
}

/// A comment on lines of its own, or nothing for an empty text.
///
/// # Errors
/// [`VtkError::Text`] where the text would end the comment early, and for control characters other than line ends.
pub fn comment(text: &str) -> Result<String, VtkError> {
    if text.is_empty() {
        return Ok(String::new());
    }
    if text.contains("--") || text.ends_with('-') || text.chars().any(|c| c != '\n' && forbidden(c)) {
        let allowed = "no --, no - at the end, no control characters but line ends";
        return Err(VtkError::Text { what: "description", text: text.to_owned(), allowed });
    }
    Ok(format!("<!--\n{text}\n-->\n"))
}

/// Control characters and the two non-characters that XML 1.0 forbids.
fn forbidden(character: char) -> bool {
    character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}')
}
