//! A self-contained HTML page: text, tables, figures and listings; nothing is loaded from elsewhere, so that it opens offline.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Heading.
    pub title: String,
    /// What the page says, in a sentence or two.
    pub lead: String,
    /// Its parts, in order.
    pub sections: Vec<Section>,
}

/// A part of a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// What it holds, in order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A list of short statements.
    List(Vec<String>),
    /// A table; the first column names its rows.
    Table {
        /// Names of the columns.
        head: Vec<String>,
        /// As many cells each as there are columns.
        rows: Vec<Vec<String>>,
    },
    /// A picture.
    Figure {
        /// The picture as SVG.
        svg: String,
        /// What is seen.
        caption: String,
    },
    /// Text of fixed width behind a line that opens it.
    Listing {
        /// What it is.
        title: String,
        /// The text.
        text: String,
    },
}

impl Section {
    /// A section with its pieces.
    pub fn new(title: &str, blocks: Vec<Block>) -> Self {
        Self { title: title.to_owned(), blocks }
    }
}

impl Block {
    /// A table from anything that reads as text.
    pub fn table<H: ToString, C: ToString>(
        head: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = Vec<C>>,
    ) -> Self {
        Self::Table {
            head: head.into_iter().map(|cell| cell.to_string()).collect(),
            rows: rows.into_iter().map(|row| row.iter().map(ToString::to_string).collect()).collect(),
        }
    }
}

impl Page {
    /// The page as HTML; every text is escaped.
    pub fn html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.title) }
                    p.lead { (self.lead) }
                    nav { @for (index, section) in self.sections.iter().enumerate() { a href={ "#part" (index) } { (section.title) } " " } }
                    @for (index, section) in self.sections.iter().enumerate() {
                        section id={ "part" (index) } {
                            h2 { (section.title) }
                            @for block in &section.blocks { (block.markup()) }
                        }
                    }
                }
            }
        };
        page.into_string()
    }
}

impl Block {
    fn markup(&self) -> Markup {
        match self {
            Self::Text(text) => html! { p { (text) } },
            Self::List(items) => html! { ul { @for item in items { li { (item) } } } },
            Self::Table { head, rows } => html! {
                table {
                    thead { tr { @for cell in head { th { (cell) } } } }
                    tbody { @for row in rows { tr { @for cell in row { td { (cell) } } } } }
                }
            },
            // As an image of its own: names inside one picture cannot meet those of another.
            Self::Figure { svg, caption } => html! {
                figure {
                    img alt=(caption) src={ "data:image/svg+xml;base64," (STANDARD.encode(svg)) };
                    figcaption { (caption) }
                }
            },
            Self::Listing { title, text } => html! { details { summary { (title) } pre { (text) } } },
        }
    }
}

const STYLE: &str = "
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff }
h1 { font-size: 1.6rem } h2 { font-size: 1.2rem; margin-top: 2.2rem; border-bottom: 1px solid #ccc }
.lead { font-size: 1.1rem } nav a { margin-right: 1rem }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums }
th, td { border-bottom: 1px solid #ddd; padding: .25rem .8rem; text-align: right; vertical-align: top }
th:first-child, td:first-child { text-align: left; padding-left: 0 }
figure { margin: 1rem 0 } figure img { max-width: 100%; height: auto } figcaption { color: #555; font-size: .9rem }
pre { background: #f6f6f6; padding: .8rem; overflow-x: auto; font-size: .85rem } summary { cursor: pointer }
@media print { nav { display: none } details { display: block } }
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped_and_nothing_is_loaded_from_elsewhere() {
        let blocks = vec![
            Block::Text("a < b & \"c\"".into()),
            Block::List(vec!["<i>".into()]),
            Block::table(["quantity", "value"], [vec!["Θ <script>", "1"]]),
            Block::Figure { svg: "<svg/>".into(), caption: "pressure > 0".into() },
            Block::Listing { title: "scene".into(), text: "</pre>".into() },
        ];
        let page = Page { title: "T & U".into(), lead: "l".into(), sections: vec![Section::new("Part", blocks)] };
        let html = page.html();
        assert!(html.starts_with("<!DOCTYPE html>") && html.contains("T &amp; U") && html.contains("a &lt; b &amp;"));
        assert!(html.contains("Θ &lt;script&gt;") && !html.contains("<script") && html.contains("&lt;/pre&gt;"));
        assert!(html.contains(&format!("data:image/svg+xml;base64,{}", STANDARD.encode("<svg/>"))));
        assert!(!html.contains("http:") && !html.contains("https:") && !html.contains("<link"));
    }
}
