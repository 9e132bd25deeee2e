//! Numbers and texts of TOML.

/// A part of a unit vector without rounding errors.
pub(super) fn tidy(part: f64) -> f64 {
    let rounded = (part * 1e9).round() / 1e9;
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// Part of a direction below which a component comes from the facets of a mesh.
const OF_FACETS: f64 = 1e-6;

/// A direction as a unit vector, without components that come from the facets of a mesh alone.
pub(super) fn straight(vector: [f64; 3]) -> [f64; 3] {
    let unit = |vector: [f64; 3]| {
        let size = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
        vector.map(|part| part / size)
    };
    unit(unit(vector).map(|part| if part.abs() < OF_FACETS { 0.0 } else { part }))
}

/// A number of two digits.
pub(super) fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// A number of TOML without rounding errors: nine decimals.
pub(super) fn plain(part: f64) -> String {
    let part = tidy(part);
    if part == part.trunc() && part.abs() < 1e15 { format!("{part:.1}") } else { format!("{part}") }
}

pub(super) fn vector(vector: [f64; 3]) -> String {
    format!("[{}]", vector.map(plain).join(", "))
}

/// A direction, whose digits must not bend it.
pub(super) fn unit_vector(vector: [f64; 3]) -> String {
    let digits = |part: f64| if (part - tidy(part)).abs() < 1e-12 { plain(part) } else { format!("{part}") };
    format!("[{}]", vector.map(digits).join(", "))
}

/// A text in a comment, whose line it must not end.
pub(super) fn commented(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// A text of TOML.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
