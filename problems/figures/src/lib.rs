//! Scientific figures as SVG, and HTML pages that hold them: without other programs, system libraries or system fonts.
//!
//! ```text
//! numbers ─ Map, Solids, Surfaces, Convergence, Landscape, LogPlot ─ Figure ─┬─ svg
//!                                                                         └─ png (feature `png`: resvg, fonts of its own)
//! scale (ticks), chart (axes), marks (legends), levels (filled areas), oblique (bodies), canvas (SVG text)
//! ```
//! The package knows numbers only: no mechanics, no optimizer, no command line. The same input gives the same bytes.
//! In titles, captions and units `^{…}` is a superscript. The font of PNG files has Latin and Greek letters, ₀ … ₉, ∂, √, ∞ and
//! the usual signs; ⟨ ⟩ ‖ ∇ → come from a second one.

mod canvas;
mod chart;
mod colours;
mod convergence;
mod error;
mod figure;
mod landscape;
mod levels;
mod log_plot;
mod map;
mod marks;
mod oblique;
pub mod page;
mod panels;
#[cfg(feature = "png")]
mod png;
mod scale;
mod solid;
mod surfaces;

pub use convergence::{Convergence, Step};
pub use error::FigureError;
pub use figure::Figure;
pub use landscape::{Landscape, Visit};
pub use log_plot::{LogPlot, Series};
pub use map::{Map, MapPanel};
pub use scale::nice_below;
pub use solid::{SolidBlock, SolidPanel, Solids};
pub use surfaces::{SurfacePanel, Surfaces};
