//! A scene: bodies, materials, supports, loads, obstacle, friction, mesh, shape. Units: N, mm, MPa.

mod counter_surface;
mod definition;
mod height_grid;
mod presets;

pub use counter_surface::CounterSurface;
pub use definition::{BodyScene, Load, Scene, Support, UpperBody};
pub use height_grid::HeightGrid;
pub use presets::{hertz, signorini};
