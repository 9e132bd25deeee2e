//! What a scene file leaves open: comments that ask.

/// What a draft may leave to the user.
pub(super) const ASKED: [&str; 5] = ["contact", "obstacle", "support", "load", "shape"];

/// What the text of a scene leaves open, with the numbers of the lines: comments that begin with `# contact: `,
/// `# obstacle: `, `# support: `, `# load: ` or `# shape: `, until they are deleted.
pub fn open_questions(text: &str) -> Vec<String> {
    let asks = |line: &str| {
        let words = line.trim_start().strip_prefix("# ")?;
        let asked =
            ASKED.iter().find(|asked| words.strip_prefix(**asked).is_some_and(|rest| rest.starts_with(": ")))?;
        let rest = words.strip_prefix(*asked)?.strip_prefix(": ")?;
        Some(format!("{asked}: {rest}"))
    };
    let found = text.lines().enumerate().filter_map(|(index, line)| Some((index + 1, asks(line)?)));
    found.map(|(line, asked)| format!("line {line} leaves open: {asked}")).collect()
}

#[cfg(test)]
mod tests {
    use super::open_questions;

    #[test]
    fn questions_are_found_with_their_lines() {
        let text =
            "name = \"a\"\n# load: which face?\n  # support: what holds it?\n# loads = []\n#load: no\n# contacts: no\n";
        let expected = ["line 2 leaves open: load: which face?", "line 3 leaves open: support: what holds it?"];
        assert_eq!(open_questions(text), expected);
    }
}
