//! Scientific figures as SVG, and HTML pages that hold them: without other programs, system libraries or system fonts.
//! Plotting libraries draw axes and curves only, no maps and status plans, and PNG needs some forty packages.
//!
//! ```text
//! numbers ─┬─ Map, Classes, Lines, Convergence ─── Figure (SVG)
//!          └─ Space ─ SpaceView: a view in three dimensions, which the script of a page draws (assets/viewer.js)
//! scale (ticks), chart (axes), panel_layout (panels), marks (legends), plan (meshes in a plane), levels (areas),
//! view (direction of view), regions (borders of areas), canvas (SVG text), packing (numbers of a SpaceView)
//! ```
//! Bodies, surfaces and plans are points with triangles and quadrilaterals between them; [`grid_faces`] and
//! [`box_faces`] are those of structured grids.
//!
//! The package knows numbers only: no mechanics, no optimizer, no command line. The same input gives the same bytes. In
//! titles, captions and units `^{…}` is a superscript.

mod canvas;
mod chart;
mod classes;
mod colours;
mod convergence;
mod error;
mod figure;
mod grids;
mod levels;
mod lines;
mod map;
mod marks;
mod packing;
pub mod page;
mod panel_layout;
mod paper;
mod plan;
mod regions;
mod scale;
mod space;
mod view;

pub use classes::{ClassPanel, Classes};
pub use convergence::{Convergence, Step};
pub use error::FigureError;
pub use figure::Figure;
pub use grids::{box_faces, grid_faces};
pub use lines::{Curve, LinePanel, Lines};
pub use map::{ColourScales, Map, MapPanel};
pub use paper::PaperPage;
pub use scale::{nice_below, number};
pub use space::{Space, SpaceBody, SpaceField, SpaceShape, SpaceState, SpaceView};
pub use view::View;
