//! A finished figure: its SVG text with the texts that a page needs around it.

use super::canvas::Canvas;

/// A figure as SVG.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Name of the figure, for files; without an ending.
    pub name: String,
    /// Title above the figure; it states what is seen.
    pub title: String,
    /// The figure as SVG text.
    pub svg: String,
    /// Left, top, width and height of its parts, in points: on a narrow page they stand one below the other. Without
    /// parts, the figure is shown as a whole.
    pub parts: Vec<[u32; 4]>,
}

impl Figure {
    pub(super) fn new(name: &str, title: &str, mut canvas: Canvas) -> Self {
        let parts = std::mem::take(&mut canvas.parts);
        Self { name: name.to_owned(), title: title.to_owned(), svg: canvas.finish(name, title), parts }
    }
}
