//! A page that is printed: A4, sections of full width, then sections in two columns; no script.

use crate::page::{Section, head, headed, warned};
use maud::{DOCTYPE, html};

/// A page for paper that needs no other file. It does not cut anything off: a caller that wants one sheet gives it no
/// more than a sheet holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PaperPage {
    /// Text of the heading.
    pub title: String,
    /// What the page says, in a sentence or two.
    pub lead: String,
    /// When, where and by what it was made; one line.
    pub origin: String,
    /// A page with more, beside it, and what it is called.
    pub more: (String, String),
    /// What a reader has to know before everything else.
    pub warnings: Vec<String>,
    /// Sections of the width of the page.
    pub wide: Vec<Section>,
    /// Sections in two columns.
    pub columns: Vec<Section>,
}

impl PaperPage {
    /// The page as HTML; every text is escaped.
    pub fn html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                (head(&self.title, STYLE))
                body {
                    h1 { (self.title) }
                    p.lead { (self.lead) }
                    p.origin { (self.origin) " " a href=(self.more.0) { (self.more.1) } }
                    (warned(&self.warnings))
                    @for section in &self.wide { section { (headed(section)) } }
                    div.columns { @for section in &self.columns { section { (headed(section)) } } }
                }
            }
        };
        page.into_string()
    }
}

const STYLE: &str = include_str!("paper.css");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{Block, with_section};

    #[test]
    fn texts_are_escaped_and_sections_can_be_replaced() {
        let page = |text: &str| PaperPage {
            title: "T & U".into(),
            more: ("report.html".into(), "more".into()),
            warnings: vec!["large <strain>".into()],
            wide: vec![Section::new("Gain", vec![Block::Text("a < b".into())])],
            columns: vec![Section::new("Limits", vec![Block::Text(text.into())])],
            ..PaperPage::default()
        };
        let html = page("old").html();
        assert!(html.contains("T &amp; U") && html.contains("a &lt; b") && html.contains("large &lt;strain&gt;"));
        assert!(html.contains("<a href=\"report.html\">more</a>") && !html.contains("<script"));
        let new = Section::new("Limits", vec![Block::Text("new".into())]);
        assert_eq!(with_section(&html, &new), Some(page("new").html()));
    }
}
