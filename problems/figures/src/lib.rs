//! Figures as SVG and, from the same text, as PNG: without other programs, system libraries or system fonts.
//!
//! ```text
//! numbers ─ Map, Solids, Surfaces, Convergence, Landscape, LogPlot ─ Figure ─┬─ svg
//!                                                                         └─ png (resvg, fonts of its own)
//! scale (ticks), chart (axes by plotters), levels (filled areas), oblique (bodies), canvas (SVG text)
//! ```
//! The module knows numbers only: no mechanics, no optimizer, no command line. The same input gives the same bytes.
//! In titles, captions and units `^{…}` is a superscript. The font has Latin and Greek letters, ₀ … ₉, ∂, √, ∞ and the usual
//! signs; ⟨ ⟩ ‖ ∇ → come from a second one.

mod canvas;
mod chart;
mod colours;
mod convergence;
mod error;
mod landscape;
mod levels;
mod log_plot;
mod map;
mod oblique;
pub mod page;
mod panels;
mod png;
mod scale;
mod solid;
mod surfaces;

pub use convergence::{Convergence, Step};
pub use error::FigureError;
pub use landscape::{Landscape, Visit};
pub use log_plot::{LogPlot, Series};
pub use map::{Map, MapPanel};
pub use solid::{SolidBlock, SolidPanel, Solids};
pub use surfaces::{SurfacePanel, Surfaces};

/// A figure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// For files, without an ending.
    pub name: String,
    /// What is seen.
    pub title: String,
    /// The figure as SVG text.
    pub svg: String,
}

impl Figure {
    fn new(name: &str, title: &str, canvas: canvas::Canvas) -> Self {
        Self { name: name.to_owned(), title: title.to_owned(), svg: canvas.finish(title) }
    }

    /// The figure as a PNG file with `scale` pixels per point of the SVG; 2 suits screens, 4 suits print.
    ///
    /// # Errors
    /// [`FigureError::Scale`] for a factor that gives no pixel or more than 100 million, [`FigureError::Drawing`] if the SVG
    /// text was changed into something that is none.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, FigureError> {
        png::png(&self.svg, scale)
    }
}
