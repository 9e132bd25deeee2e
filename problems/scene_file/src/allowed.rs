//! What a field may hold: as words for messages and tables, and as a test.

use crate::schema::Node;
use serde_json::Value;

/// What is allowed at a place, in words.
pub(super) fn words(node: &Node<'_>) -> String {
    let unit = node.text("x-unit").filter(|unit| unit != "1").map_or_else(String::new, |unit| format!(" ({unit})"));
    if let Some(items) = node.items() {
        let count = node.length().map_or_else(|| "a list".to_owned(), |count| format!("{count} entries"));
        let one_of = if items.names().is_empty() { "" } else { "one of " };
        return format!("{count}, each {one_of}{}{unit}", words(&items));
    }
    let names = node.names();
    if !names.is_empty() {
        return names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    }
    let forms = node.forms();
    if !forms.is_empty() {
        let names: Vec<String> = forms.iter().map(|(form, _)| format!("form = \"{form}\"")).collect();
        return format!("a table with {}", names.join(" or "));
    }
    let kind = if node.is("integer") {
        "an integer"
    } else if node.is("number") {
        "a finite number"
    } else if node.is("boolean") {
        "true or false"
    } else if node.is("string") {
        "a text"
    } else {
        "a table"
    };
    let or_text = if node.is("integer") && node.is("string") { " or a text" } else { "" };
    format!("{kind}{}{or_text}{unit}", range(node))
}

/// Moduli of bounds that tell something of a field; others only keep numbers away from overflow.
const TELLING: std::ops::RangeInclusive<f64> = 1e-6..=1e5;

/// What is allowed at a place, as briefly as a list of fields needs it: without the bounds that keep numbers from
/// overflow.
pub(super) fn brief(node: &Node<'_>) -> String {
    format!(
        "{}{}",
        values(node, ""),
        node.text("x-unit").filter(|unit| unit != "1").map_or_else(String::new, |unit| format!(", {unit}"))
    )
}

/// Values at a place, with the ending of their number; lists in lists with the lengths of both.
fn values(node: &Node<'_>, plural: &str) -> String {
    if let Some(items) = node.items() {
        return match node.length() {
            Some(count) if items.items().is_some() => format!("{count}×{}", values(&items, "s")),
            Some(count) => format!("{count} {}", values(&items, "s")),
            None => format!("list of {}", values(&items, "s")),
        };
    }
    let kind = match (node.is("integer"), node.is("number"), node.is("string"), node.is("boolean")) {
        (true, _, true, _) => format!("integer{plural} or text{plural}"),
        (true, ..) => format!("integer{plural}"),
        (_, true, ..) => format!("number{plural}"),
        (.., true) => "true/false".to_owned(),
        (_, _, true, _) if node.names().is_empty() => format!("text{plural}"),
        _ => return words(node),
    };
    kind + &brief_range(node)
}

/// The telling bounds of a number.
fn brief_range(node: &Node<'_>) -> String {
    let telling = |value: &f64| *value == 0.0 || TELLING.contains(&value.abs());
    let bound = |word: &str| node.keyword(word).and_then(Value::as_f64).filter(telling).map(short);
    let low = bound("minimum").map(|low| (low, "≥")).or_else(|| bound("exclusiveMinimum").map(|low| (low, ">")));
    let high = bound("maximum").map(|high| (high, "≤")).or_else(|| bound("exclusiveMaximum").map(|high| (high, "<")));
    match (low, high) {
        (Some((low, "≥")), Some((high, "≤"))) => format!(" {low}…{high}"),
        (low, high) => {
            [low, high].into_iter().flatten().map(|(value, sign)| format!(" {sign}{value}")).collect::<String>()
        }
    }
}

/// The range of a number, in words.
pub(super) fn range(node: &Node<'_>) -> String {
    let bound =
        |word: &str, sign: &str| node.keyword(word).and_then(Value::as_f64).map(|x| format!("{sign} {}", short(x)));
    let bounds: Vec<String> =
        [bound("exclusiveMinimum", ">"), bound("minimum", "≥"), bound("exclusiveMaximum", "<"), bound("maximum", "≤")]
            .into_iter()
            .flatten()
            .collect();
    if bounds.is_empty() { String::new() } else { format!(" {}", bounds.join(" and ")) }
}

fn short(value: f64) -> String {
    if value.abs() >= 1e6 || (value != 0.0 && value.abs() < 1e-3) { format!("{value:e}") } else { value.to_string() }
}

/// The names among which the field at a path chooses, each with its meaning; none for a field of another kind.
pub fn choices(path: &str) -> Vec<(&'static str, String)> {
    let Some(node) = field(path) else { return vec![] };
    let described = node.inner["oneOf"].as_array();
    let meaning = |name: &str| described?.iter().find(|choice| choice["const"] == name)?["description"].as_str();
    node.names()
        .into_iter()
        .map(|name| (name, meaning(name).unwrap_or_default().trim_end_matches('.').into()))
        .collect()
}

/// What the documentation of a field says of its default.
pub(super) fn default(path: &str) -> String {
    let meaning = field(path).and_then(|node| node.text("description")).unwrap_or_default();
    meaning.split_once("Default ").map_or("none", |(_, words)| words.trim_end_matches('.')).to_owned()
}

/// The field at a path.
fn field(path: &str) -> Option<Node<'static>> {
    path.split('.').try_fold(Node::root(), |node, name| match name.split_once('[') {
        None => node.field(name),
        // Entries of a list are alike.
        Some((name, _)) => node.field(name)?.items(),
    })
}

/// Whether a number lies in the range of a place.
pub(super) fn contains(node: &Node<'_>, value: f64) -> bool {
    let bound = |word: &str| node.keyword(word).and_then(Value::as_f64);
    value.is_finite()
        && bound("minimum").is_none_or(|low| value >= low)
        && bound("exclusiveMinimum").is_none_or(|low| value > low)
        && bound("maximum").is_none_or(|high| value <= high)
        && bound("exclusiveMaximum").is_none_or(|high| value < high)
}
