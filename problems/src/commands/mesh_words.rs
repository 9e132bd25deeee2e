//! Meshes of a scene in words.

use contact::scene::{Geometry, Scene};

/// "12×12×12 bricks", or "1881 cells".
pub fn mesh(scene: &Scene) -> String {
    match &scene.geometry {
        Geometry::Blocks(blocks) => format!("{} bricks", joined(blocks.bricks)),
        Geometry::Mesh(geometry) => format!("{} cells", geometry.mesh.cell_count()),
    }
}

/// "2×2×2 subdomains each", or "about 5 pieces".
pub fn pieces(scene: &Scene) -> String {
    match &scene.geometry {
        Geometry::Blocks(blocks) => format!("{} subdomains each", joined(blocks.subdomains)),
        Geometry::Mesh(geometry) => format!("about {} pieces", geometry.piece_count()),
    }
}

fn joined(counts: [usize; 3]) -> String {
    counts.map(|count| count.to_string()).join("×")
}
