//! A self-contained HTML page: text, tables, figures and listings; nothing is loaded from elsewhere, so that it opens
//! offline.
//!
//! Figures stand in the page as SVG on a light ground, so that they look the same in a dark page. The page holds
//! everything without its scripts. One repeats the title of what the pointer is on below the figure, where it can be
//! read at once and without a mouse. Another one draws views in three dimensions by the library three.js, which the
//! page brings along.

use crate::figure::Figure;
use crate::packing::{base64, compressed};
use crate::space::SpaceView;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::sync::OnceLock;

/// An HTML page that needs no other file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Text of the heading.
    pub title: String,
    /// What the page says, in a sentence or two.
    pub lead: String,
    /// When, where and by what it was made; one line.
    pub origin: String,
    /// What a reader has to know before everything else.
    pub warnings: Vec<String>,
    /// Its parts, in order.
    pub sections: Vec<Section>,
}

/// A part of a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Text of the heading.
    pub title: String,
    /// What it holds, in order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Block {
    /// A paragraph of plain text.
    Text(String),
    /// A list of short statements.
    List(Vec<String>),
    /// A table; the first column names its rows.
    Table {
        /// Names of the columns.
        head: Vec<String>,
        /// As many cells each as there are columns; the last cell of a row that has fewer spans the rest.
        rows: Vec<Vec<String>>,
    },
    /// A figure with its caption.
    Picture {
        /// Figure that is embedded as SVG.
        figure: Figure,
        /// What is to be seen in it.
        caption: String,
    },
    /// Two pictures of the same things, of which one is shown at a time; both are printed.
    Choice {
        /// What each of them is called, and the picture.
        figures: Box<[(String, Figure); 2]>,
        /// What is to be seen in them.
        caption: String,
    },
    /// Bodies that the reader turns, where there are scripts; not printed.
    Space {
        /// The bodies with their values.
        view: SpaceView,
        /// What is to be seen in it.
        caption: String,
    },
    /// Files beside the page, with what they hold.
    Files(Vec<File>),
    /// Text of fixed width behind a line that opens it.
    Listing {
        /// Line that is always visible.
        title: String,
        /// Preformatted text that is shown on request.
        text: String,
    },
}

/// A file beside the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Its path from the page on; the parts are joined by `/`.
    pub path: String,
    /// Description of the file's content.
    pub what: String,
}

impl Section {
    /// A section with its pieces.
    pub fn new(title: &str, blocks: Vec<Block>) -> Self {
        Self { title: title.to_owned(), blocks }
    }
}

/// A written page with another section in place of that with the same heading; none if it has none.
pub fn with_section(html: &str, section: &Section) -> Option<String> {
    let heading = headed(section).into_string();
    let (title, _) = heading.split_once("</h2>")?;
    let start = html.find(&format!("{title}</h2>"))?;
    let length = html[start..].find("</section>")?;
    Some(format!("{}{heading}{}", &html[..start], &html[start + length..]))
}

/// The head of a page with its style.
pub(super) fn head(title: &str, style: &str) -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta name="viewport" content="width=device-width, initial-scale=1";
            title { (title) }
            style { (PreEscaped(style)) }
        }
    }
}

/// What a reader has to know before everything else.
pub(super) fn warned(warnings: &[String]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            div.warnings role="note" {
                strong { "Warnings" }
                ul { @for warning in warnings { li { (warning) } } }
            }
        }
    }
}

/// The heading of a section with its pieces.
pub(super) fn headed(section: &Section) -> Markup {
    html! {
        h2 { (section.title) }
        @for block in &section.blocks { (block.markup()) }
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
                (head(&self.title, STYLE))
                body {
                    h1 { (self.title) }
                    p.lead { (self.lead) }
                    @if !self.origin.is_empty() { p.origin { (self.origin) } }
                    (warned(&self.warnings))
                    nav { @for (index, section) in self.sections.iter().enumerate() { a href={ "#part" (index) } { (section.title) } " " } }
                    @for (index, section) in self.sections.iter().enumerate() {
                        section id={ "part" (index) } {
                            (headed(section))
                        }
                    }
                    @if self.sections.iter().flat_map(|section| &section.blocks).any(Block::is_space) {
                        (PreEscaped(format!("<!-- Views in three dimensions are drawn by three.js.\n\n{LICENCE}-->")))
                        script #space-library type="application/octet-stream" { (PreEscaped(library())) }
                    }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string()
    }
}

impl Block {
    fn is_space(&self) -> bool {
        matches!(self, Self::Space { .. })
    }

    fn markup(&self) -> Markup {
        match self {
            Self::Text(text) => html! { p { (text) } },
            Self::List(items) => html! { ul { @for item in items { li { (item) } } } },
            Self::Table { head, rows } => html! {
                div.wide { table class=[(head.len() >= MANY_COLUMNS).then_some("many")] {
                    thead { tr { @for cell in head { th { (cell) } } } }
                    tbody { @for row in rows { tr { @for (column, cell) in row.iter().enumerate() {
                        (table_cell(cell, column, row.len(), head.len()))
                    } } } }
                } }
            },
            Self::Picture { figure, caption } => html! {
                figure { (card(figure)) (told(&[figure])) figcaption { (caption) } }
            },
            Self::Choice { figures, caption } => {
                let name = &figures[0].1.name;
                let id = |index: usize| format!("{name}-choice-{index}");
                html! {
                    figure.choice {
                        @for (index, (label, _)) in figures.iter().enumerate() {
                            input type="radio" name={ (name) "-choice" } id=(id(index)) checked[index == 0];
                            label for=(id(index)) { (label) }
                        }
                        @for (_, figure) in figures.iter() { (card(figure)) }
                        (told(&[&figures[0].1, &figures[1].1]))
                        figcaption { (caption) }
                    }
                }
            }
            Self::Space { view, caption } => html! {
                figure.space hidden {
                    div.space-view {}
                    script type="application/octet-stream" { (PreEscaped(&view.data)) }
                    figcaption { (caption) }
                }
                noscript { p { "The view in three dimensions needs scripts. The pictures show the same fields." } }
            },
            Self::Files(files) => html! {
                div.wide { table.files {
                    thead { tr { th { "file" } th { "holds" } } }
                    tbody { @for File { path, what } in files {
                        tr { td { a href=(address(path)) { (path) } } td { (what) } }
                    } }
                } }
            },
            Self::Listing { title, text } => html! { details { summary { (title) } pre { (text) } } },
        }
    }
}

/// Columns from which on a table is set smaller.
const MANY_COLUMNS: usize = 9;

/// Characters from which on a cell is a text that may be broken, and no number.
const LONG_CELL: usize = 20;

/// A cell of a row of so many cells, in a table of so many columns.
fn table_cell(cell: &str, column: usize, cells: usize, columns: usize) -> Markup {
    let spanned = if column + 1 == cells && cells < columns { Some(columns - column) } else { None };
    let long = (column > 0 && cell.chars().count() >= LONG_CELL).then_some("long");
    html! { td class=[long] colspan=[spanned] { (cell) } }
}

/// A figure on its light ground; on a narrow page its parts, which show the same drawing, stand in its place.
fn card(figure: &Figure) -> Markup {
    html! {
        div class=(if figure.parts.len() > 1 { "card parted" } else { "card" }) {
            (PreEscaped(&figure.svg))
            @if figure.parts.len() > 1 {
                div.parts {
                    p { (figure.title) }
                    @for [left, top, width, height] in &figure.parts {
                        svg width=(width) height=(height) viewBox={ (left) " " (top) " " (width) " " (height) }
                            font-family="Ubuntu, sans-serif" { use href={ "#" (figure.name) } {} }
                    }
                }
            }
        }
    }
}

/// Where the script writes the title of what the pointer is on; nothing for figures without such titles.
fn told(figures: &[&Figure]) -> Markup {
    // Every figure has one title of its own.
    let any = figures.iter().any(|figure| figure.svg.matches("<title>").count() > 1);
    html! { @if any { output.told {} } }
}

/// A relative address: what is no letter, digit or one of `/._-` is written as bytes.
fn address(path: &str) -> String {
    let byte = |byte: u8| match byte {
        b'/' | b'.' | b'_' | b'-' => char::from(byte).to_string(),
        byte if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
        byte => format!("%{byte:02X}"),
    };
    path.bytes().map(byte).collect()
}

/// The script of views in three dimensions with its library, as the script of the page unpacks it.
pub(super) fn library() -> &'static str {
    static LIBRARY: OnceLock<String> = OnceLock::new();
    LIBRARY.get_or_init(|| base64(&compressed(&[include_bytes!("../assets/viewer.min.js")])))
}

/// The licence of the library.
const LICENCE: &str = include_str!("../assets/THREE-LICENSE");

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_cells_may_be_broken_and_short_rows_are_filled() {
        let reason = "no equilibrium: the load has a resultant along x1";
        let rows = [vec!["1", "2", "3"], vec!["4", reason]];
        let html =
            Page { sections: vec![Section::new("t", vec![Block::table(["a", "b", "c"], rows)])], ..Page::default() }
                .html();
        let expected = format!("<tr><td>4</td><td class=\"long\" colspan=\"2\">{reason}</td></tr>");
        assert!(html.contains("<tr><td>1</td><td>2</td><td>3</td></tr>") && html.contains(&expected), "{html}");
    }

    #[test]
    fn a_section_of_a_written_page_is_replaced_by_its_heading() {
        let section = |title: &str, text: &str| Section::new(title, vec![Block::Text(text.into())]);
        let page = |text: &str| {
            let sections = vec![section("a", "b"), section("x < y", text), section("c", "<h2>x &lt; y</h2>")];
            Page { sections, ..Page::default() }.html()
        };
        assert_eq!(with_section(&page("old"), &section("x < y", "new")), Some(page("new")));
        assert_eq!(with_section(&page("old"), &section("y", "new")), None);
    }

    #[test]
    fn pages_with_views_in_three_dimensions_have_their_library_once_with_its_licence() {
        let view = |data: &str| Block::Space { view: SpaceView { data: data.into() }, caption: "<c>".into() };
        let page = |blocks| Page { sections: vec![Section::new("t", blocks)], ..Page::default() }.html();
        let html = page(vec![view("AAAA"), view("BBBB")]);
        assert!(html.contains(">AAAA</script>") && html.contains(">BBBB</script>") && html.contains("&lt;c&gt;"));
        assert_eq!((html.matches(library()).count(), html.matches("<noscript>").count()), (1, 2));
        assert!(html.contains("three.js authors") && html.contains("WITHOUT WARRANTY OF ANY KIND"));
        assert!(!html.contains("http:") && !html.contains("https:"));
        let without = page(vec![]);
        assert!(!without.contains("three.js") && without.len() < 20_000);
    }

    #[test]
    fn texts_are_escaped_and_nothing_is_loaded_from_elsewhere() {
        let figure = |name: &str| Figure {
            name: name.into(),
            title: "t".into(),
            svg: format!("<svg><title>t</title><path><title>{name}</title></path></svg>"),
            parts: if name == "one" { vec![[0, 30, 100, 50], [100, 30, 20, 50]] } else { vec![] },
        };
        let blocks = vec![
            Block::Text("a < b & \"c\"".into()),
            Block::List(vec!["<i>".into()]),
            Block::table(["quantity", "value"], [vec!["Θ <script>", "1"]]),
            Block::Picture { figure: figure("one"), caption: "pressure > 0".into() },
            Block::Choice {
                figures: Box::new([("left".into(), figure("two")), ("right".into(), figure("three"))]),
                caption: String::new(),
            },
            Block::Files(vec![File { path: "a/b c.svg".into(), what: "<what>".into() }]),
            Block::Listing { title: "scene".into(), text: "</pre>".into() },
        ];
        let page = Page {
            title: "T & U".into(),
            lead: "l".into(),
            origin: "today".into(),
            warnings: vec!["large <strain>".into()],
            sections: vec![Section::new("Part", blocks)],
        };
        let html = page.html();
        assert!(html.starts_with("<!DOCTYPE html>") && html.contains("T &amp; U") && html.contains("a &lt; b &amp;"));
        assert!(
            html.contains("Θ &lt;script&gt;") && html.matches("<script").count() == 1 && html.contains("&lt;/pre&gt;")
        );
        assert!(["one", "two", "three"].iter().all(|name| html.contains(&figure(name).svg)));
        assert!(html.matches("<use href=\"#one\">").count() == 2 && html.contains("viewBox=\"100 30 20 50\""));
        assert!(html.matches("type=\"radio\"").count() == 2 && html.matches("<output").count() == 2);
        assert!(html.contains("<a href=\"a/b%20c.svg\">a/b c.svg</a>") && html.contains("large &lt;strain&gt;"));
        assert!(!html.contains("http:") && !html.contains("https:") && !html.contains("<link"));
    }
}
