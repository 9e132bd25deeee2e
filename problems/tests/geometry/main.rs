//! Meshes, true normals and lattices, against an independent reference and against blocks.

mod block_as_mesh;
mod lug_nose;
mod published;
mod refusals;
mod scenes;
