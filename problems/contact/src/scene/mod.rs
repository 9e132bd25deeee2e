//! A scene: bodies with geometry, materials, supports, loads and shape; contacts with obstacles or between bodies.
//! Units: N, mm, MPa.

mod body;
mod contact;
mod counter_surface;
mod definition;
pub(crate) mod foot;
mod geometry;
mod height_grid;
pub(crate) mod jet;
mod loads;
mod mesh_surface;
mod nearest_place;
mod presets;
mod profile;
mod revolution;
mod side;
mod size;
mod surface_feet;
mod surface_patch;

pub use body::BodyScene;
pub use contact::{AreaKind, BodyFace, ContactKind, ContactScene, FaceGeometry, Master, NormalKind};
pub use counter_surface::CounterSurface;
pub(crate) use definition::Opposite;
pub use definition::Scene;
pub use foot::Foot;
pub use geometry::{Block, Geometry, MeshGeometry};
pub use height_grid::HeightGrid;
pub use loads::{Held, Load, LoadKind, Support};
pub use mesh_surface::MeshSurface;
pub use presets::{hertz, signorini};
pub use profile::Profile;
pub use revolution::{Meridian, Revolution};
pub use side::Side;
pub use size::{BodySize, SceneSize};
