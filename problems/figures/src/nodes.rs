//! Text that a browser shows over the nodes of a plane grid: SVG titles on cells that are not seen.

use super::canvas::{Canvas, escaped};
use super::chart::Frame;
use super::scale::number;
use std::fmt::Write;

/// Most nodes of a panel that have a text of their own, some 130 bytes each; larger grids have none.
const MAX_NAMED_NODES: usize = 5000;

/// Nodes n₁ × n₂ at equal distances over a rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlaneGrid {
    pub counts: [usize; 2],
    pub origin: [f64; 2],
    pub size: [f64; 2],
}

impl PlaneGrid {
    /// Position of node (i, j), text.
    pub fn position(&self, node: [usize; 2]) -> String {
        let [x, y] = std::array::from_fn(|axis| {
            number(self.origin[axis] + self.size[axis] * node[axis] as f64 / (self.counts[axis] - 1) as f64)
        });
        format!("({x}, {y})")
    }

    /// The number, the place and some text for every node, index i·n₂ + j.
    pub fn name_nodes(&self, canvas: &mut Canvas, frame: Frame, text: impl Fn(usize) -> String) {
        let [n1, n2] = self.counts;
        if n1 * n2 > MAX_NAMED_NODES {
            return;
        }
        let cell = [frame.width / (n1 - 1) as f64, frame.height / (n2 - 1) as f64];
        // In units of cells, the second axis upwards; a node is in the middle of its cell.
        let mut group = format!(
            "<g class=\"nodes\" fill=\"none\" pointer-events=\"all\" transform=\"matrix({:.4} 0 0 {:.4} {:.3} {:.3})\">\n",
            cell[0],
            -cell[1],
            frame.left - 0.5 * cell[0],
            frame.top + frame.height + 0.5 * cell[1]
        );
        for node in 0..n1 * n2 {
            let place = [node / n2, node % n2];
            let text = format!("node ({}, {}) at {}: {}", place[0], place[1], self.position(place), text(node));
            // Titles know no superscripts.
            let text = escaped(&text.replace("^{", "^").replace('}', ""));
            let _ = writeln!(group, "<path d=\"M{} {}h1v1h-1z\"><title>{text}</title></path>", place[0], place[1]);
        }
        canvas.raw(&group);
        canvas.raw("</g>\n");
    }
}
