//! Tables in Markdown, as the pages in `docs` hold them.

/// A table: the names of its columns as they are printed, "first | second", and its rows.
pub fn table(head: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let lines: String = rows.into_iter().map(|cells| format!("| {} |\n", cells.join(" | "))).collect();
    format!("| {head} |\n|{}\n{lines}", "---|".repeat(head.split(" | ").count()))
}

/// A table below its title; nothing without rows.
pub fn section(title: &str, head: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut rows = rows.into_iter().peekable();
    if rows.peek().is_none() { String::new() } else { format!("\n### {title}\n\n{}", table(head, rows)) }
}

/// What stands in a cell, a dash if there is nothing.
pub fn or_dash<T>(value: Option<T>, show: impl Fn(T) -> String) -> String {
    value.map_or_else(|| "–".into(), show)
}

/// Seconds with two digits after the point, four below a tenth.
pub fn seconds(seconds: f64) -> String {
    if seconds < 0.1 { format!("{seconds:.4}") } else { format!("{seconds:.2}") }
}
