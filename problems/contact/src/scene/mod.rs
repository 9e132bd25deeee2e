//! A scene: bodies, materials, supports, loads, counter surface, contact, shape. Units: N, mm, MPa.

mod body;
mod contact;
mod counter_surface;
mod definition;
pub(crate) mod foot;
mod height_grid;
pub(crate) mod jet;
mod presets;
mod size;

pub use body::{BodyScene, Held, Load, LoadKind, Support};
pub use contact::{AreaKind, ContactScene, NormalKind};
pub use counter_surface::{CounterSurface, Side};
pub use definition::{Blocks, Geometry, MeshGeometry, Scene, UpperBody};
pub use foot::Foot;
pub use height_grid::HeightGrid;
pub use presets::{hertz, signorini};
pub use size::SceneSize;
