//! Scientific figures as SVG, and HTML pages that hold them: without other programs, system libraries or system fonts.
//!
//! ```text
//! numbers ─┬─ Map, Classes, Lines, LogPlot, Landscape, Convergence ─┬─ Figure ─┬─ svg
//!          └─ Solids, Surfaces, Sketch ───────────────────────────┘          └─ png (feature `png`: resvg, fonts of its own)
//! scale (ticks), chart (axes), panel_layout (panels), marks (legends), nodes (texts over nodes), levels (filled areas),
//! oblique (bodies), canvas (SVG text)
//! ```
//! The package knows numbers only: no mechanics, no optimizer, no command line. The same input gives the same bytes. In
//! titles, captions and units `^{…}` is a superscript. The font of PNG files has Latin and Greek letters, ₀ … ₉, ∂, √,
//! ∞ and the usual signs; ⟨ ⟩ ‖ ∇ → come from a second one.

mod canvas;
mod chart;
mod classes;
mod colours;
mod convergence;
mod error;
mod figure;
mod landscape;
mod levels;
mod lines;
mod log_plot;
mod map;
mod marks;
mod nodes;
mod oblique;
pub mod page;
mod panel_layout;
mod panels;
#[cfg(feature = "png")]
mod png;
mod scale;
mod sketch;
mod solid;
mod surfaces;

pub use classes::{ClassPanel, Classes};
pub use convergence::{Convergence, Step};
pub use error::FigureError;
pub use figure::Figure;
pub use landscape::{Landscape, Visit};
pub use lines::{Curve, LinePanel, Lines};
pub use log_plot::{LogPlot, Series};
pub use map::{ColourScales, Map, MapPanel};
pub use scale::{nice_below, number};
pub use sketch::{Sign, Sketch, SketchBody, SketchMark};
pub use solid::{SolidBlock, SolidPanel, Solids};
pub use surfaces::{SurfacePanel, Surfaces};
