//! Text for terminals that show ASCII only.

use std::borrow::Cow;

/// The symbols of this program and their ASCII forms.
const FORMS: [(char, &str); 41] = [
    ('Θ', "Theta"),
    ('Σ', "sum "),
    ('∫', "integral of "),
    ('σ', "sigma"),
    ('ξ', "xi"),
    ('α', "alpha"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('µ', "u"),
    ('ν', "nu"),
    ('₀', "0"),
    ('₁', "1"),
    ('₂', "2"),
    ('₃', "3"),
    ('₄', "4"),
    ('²', "^2"),
    ('³', "^3"),
    ('⁴', "^4"),
    ('⁵', "^5"),
    ('⁶', "^6"),
    ('⁷', "^7"),
    ('⁸', "^8"),
    ('⁹', "^9"),
    ('⁰', "^0"),
    ('⁻', "^-"),
    ('×', "x"),
    ('·', "*"),
    ('−', "-"),
    ('–', "-"),
    ('…', "..."),
    ('≤', "<="),
    ('≥', ">="),
    ('→', "->"),
    ('±', "+-"),
    ('∞', "inf"),
    ('∂', "d"),
    ('‖', "||"),
    ('°', " deg"),
    ('’', "'"),
    ('“', "\""),
    ('”', "\""),
];

/// A text for people in a form that the locale can show: the symbols of this program have ASCII forms where the locale
/// has no UTF-8. All other letters stay as they are.
pub fn shown(text: &str) -> Cow<'_, str> {
    let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let locale = variable("LC_ALL").or_else(|| variable("LC_CTYPE")).or_else(|| variable("LANG"));
    if cfg!(unix) && !has_utf8(locale.as_deref()) { Cow::Owned(in_ascii(text)) } else { Cow::Borrowed(text) }
}

/// Whether a locale such as `C.UTF-8` has UTF-8; none is the locale `C`.
fn has_utf8(locale: Option<&str>) -> bool {
    locale.is_some_and(|name| name.to_ascii_lowercase().replace('-', "").contains("utf8"))
}

fn in_ascii(text: &str) -> String {
    let form = |symbol: char| FORMS.iter().find(|(of, _)| *of == symbol).map(|(_, form)| *form);
    let mut ascii = String::with_capacity(text.len());
    for symbol in text.chars() {
        match form(symbol) {
            Some(form) => ascii.push_str(form),
            None => ascii.push(symbol),
        }
    }
    ascii
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locales_say_whether_they_have_utf8() {
        for name in ["C.UTF-8", "de_DE.utf8", "en_US.UTF-8@euro"] {
            assert!(has_utf8(Some(name)), "{name}");
        }
        for name in [None, Some("C"), Some("POSIX"), Some("de_DE.ISO-8859-1")] {
            assert!(!has_utf8(name), "{name:?}");
        }
    }

    #[test]
    fn symbols_have_ascii_forms_and_names_stay() {
        assert_eq!(in_ascii("Θ = Σσ⁴ ≤ 3 × 10³ … in Zürich"), "Theta = sum sigma^4 <= 3 x 10^3 ... in Zürich");
    }
}
