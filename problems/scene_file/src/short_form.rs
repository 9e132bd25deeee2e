//! Scenes in the short form: one optimized body, a block or a mesh, below an obstacle or an elastic block.

use crate::bodies::body;
use crate::mesh_file::MeshFile;
use crate::scene_parts::{Parts, required};
use crate::shapes::{counter_surface, heights};
use crate::{ContactSection, MeshBodySection, SceneFile};
use contact::body::load_size;
use contact::body::mesh::{BlockFace, Mesh, bounding_box};
use contact::error::SceneError;
use contact::names::find;
use contact::scene::{Block, BodyFace, BodyScene, CounterSurface, Geometry, Master, MeshGeometry, NormalKind, Scene};
use contact::shape::ShapedFace;
use std::path::Path;
use std::sync::Arc;

/// The contact of the short form.
fn contact_table(file: &SceneFile) -> Result<&ContactSection, SceneError> {
    required("contact", file.contact.one(), "a table, [contact], without [[body]]")
}

/// A refused field as a file in the short form calls it: both blocks have the same base and bricks, and the bottom of
/// the upper one is the counter surface.
pub(crate) fn named(file: &SceneFile, error: SceneError) -> SceneError {
    let SceneError::OutOfRange { field, value, allowed } = error else { return error };
    let own = ["lower.", "upper."].iter().find_map(|body| field.strip_prefix(body)).filter(|_| file.body.is_none());
    let field = match own {
        Some(rest) if rest.starts_with("bricks") || rest.starts_with("subdomains") => format!("mesh.{rest}"),
        Some(rest) if rest.starts_with("size") => rest.to_owned(),
        Some(rest) if rest.starts_with("bottom") => rest.replacen("bottom", "counter_surface", 1),
        _ => field.clone(),
    };
    let allowed = match own {
        Some("top") => allowed.replacen("above the bottom", "above the counter surface", 1),
        _ => allowed,
    };
    SceneError::out_of_range(field, value, allowed)
}

/// The scene of one or two blocks.
pub(crate) fn block_scene(file: &SceneFile, folder: &Path) -> Result<Parts, SceneError> {
    let block = "a table, for a block (or [body] with a mesh, or [[body]])";
    let size = *required("size", file.size.as_ref(), "the lengths of the base of a block (or [body] with a mesh)")?;
    let lower = required("lower", file.lower.as_ref(), block)?;
    let surface = required("surface", file.surface.as_ref(), block)?;
    let admissible = required("admissible", file.admissible.as_ref(), block)?;
    let counter = required("counter_surface", file.counter_surface.as_ref(), "a table, for what lies above the block")?;
    let contact = contact_table(file)?;
    if file.lattice.is_some() {
        return Err(SceneError::out_of_range("lattice", "a table", "none for a block, which surface shapes"));
    }
    if let Some(face) = &contact.face {
        let mut faces = BlockFace::ALL.map(BlockFace::name);
        faces.sort_unstable();
        find("contact.face", face, faces.into_iter())?;
    }
    if surface.face != ShapedFace::Top {
        return Err(SceneError::out_of_range("surface.face", "\"bottom\"", "\"top\" without [[body]]"));
    }
    let (heights, start) = heights((surface, admissible), size, folder)?;
    let subdomains = file.mesh.subdomains.unwrap_or_else(|| file.mesh.bricks.map(default_subdomains));
    let own = Block::new(size, heights.start, file.mesh.bricks, subdomains);
    let counter = counter_surface("counter_surface", counter, Some(size), folder)?;
    let geometry = Geometry::Block(own.clone());
    let mut bodies = vec![BodyScene {
        shape: Some(heights),
        ..body("lower", geometry, (lower.material.clone(), &[]), &lower.supports, &lower.loads)?
    }];
    let master = match &file.upper {
        None => Master::Obstacle(counter),
        Some(_) if !counter.has_heights() && contact.normal == Some(NormalKind::Surface) => {
            let allowed = "a height over x1 and x2 below an upper body, whose lower surface it is";
            return Err(SceneError::out_of_range("counter_surface", "a surface in space", allowed));
        }
        Some(_) if !counter.has_heights() => {
            let allowed = "\"surface\" with a counter surface that is no height over x1 and x2";
            return Err(SceneError::out_of_range("contact.normal", "\"x3\"", allowed));
        }
        Some(upper) => {
            let geometry =
                Geometry::Block(Block { bottom: counter, top: CounterSurface::Plane { height: upper.top }, ..own });
            bodies.push(body("upper", geometry, (upper.material.clone(), &[]), &upper.supports, &upper.loads)?);
            Master::Body(BodyFace::new(1, "bottom"))
        }
    };
    let contacts = vec![contact.scene("top", file.friction, master)];
    Ok(Parts { scene: Scene { name: file.name.clone(), bodies, contacts }, start, notes: Vec::new() })
}

/// The scene of a mesh.
pub(crate) fn mesh_scene(
    file: &SceneFile,
    section: &MeshBodySection,
    folder: &Path,
    mesh: impl FnOnce() -> Result<MeshFile, SceneError>,
) -> Result<Parts, SceneError> {
    for (field, given) in [
        ("size", file.size.is_some()),
        ("lower", file.lower.is_some()),
        ("upper", file.upper.is_some()),
        ("surface", file.surface.is_some()),
        ("admissible", file.admissible.is_some()),
    ] {
        if given {
            let allowed = "none beside [body], which has a mesh and a lattice";
            return Err(SceneError::out_of_range(field, "a value", allowed));
        }
    }
    let MeshFile { mesh, mut notes } = mesh()?;
    let contact = contact_table(file)?;
    let face = required("contact.face", contact.face.as_ref(), "the physical surface of the mesh that may touch")?;
    let lattice = required("lattice", file.lattice.as_ref(), "a table, for the shapes of a mesh")?;
    let counter = required("counter_surface", file.counter_surface.as_ref(), "a table, for what the mesh touches")?;
    let mesh = Arc::new(mesh);
    let geometry = Geometry::Mesh(MeshGeometry { mesh: Arc::clone(&mesh), pieces: section.pieces });
    let material = (section.material.clone(), section.materials.as_slice());
    let own = body("body", geometry, material, &section.supports, &section.loads)?;
    notes.extend(doubts_of_unit(&mesh, &own)?);
    let obstacle = Master::Obstacle(counter_surface("counter_surface", counter, None, folder)?);
    let scene = Scene {
        name: file.name.clone(),
        bodies: vec![BodyScene { shape: Some(lattice.shape(&mesh)?), ..own }],
        contacts: vec![contact.scene(face, file.friction, obstacle)],
    };
    Ok(Parts { scene, start: None, notes })
}

/// Extents of a body, mm, outside which its unit is doubtful.
const USUAL_EXTENTS: [f64; 2] = [1.0, 2e4];
/// Nominal strain above which loads, unit or elastic constants are doubtful: linear elasticity ends before.
const USUAL_STRAIN: f64 = 0.05;

/// Signs of a mesh in another unit than the scene says: an unusual extent, and loads that strain the body too much.
pub(crate) fn doubts_of_unit(mesh: &Mesh, body: &BodyScene) -> Result<Vec<String>, SceneError> {
    let [least, most] = bounding_box(mesh.nodes());
    let mut extents = [0, 1, 2].map(|axis| most[axis] - least[axis]);
    extents.sort_by(f64::total_cmp);
    let mut doubts = Vec::new();
    if extents[2] < USUAL_EXTENTS[0] || extents[2] > USUAL_EXTENTS[1] {
        doubts.push(format!(
            "the body is {:.3e} mm long: is body.unit the unit of the mesh? (\"mm\", \"cm\", \"m\" or \"inch\")",
            extents[2]
        ));
    }
    let (load, section) = (load_size(mesh, &body.loads)?, extents[0] * extents[1]);
    let strain = load / section / body.material.young_modulus();
    if strain > USUAL_STRAIN {
        doubts.push(format!(
            "the loads, {load:.3e} N in all, over the section of the body, {section:.3e} mm^2, strain it by {:.1e} %: are \
             body.unit, the loads (N, MPa) and young_modulus (MPa) what they should be?",
            100.0 * strain
        ));
    }
    Ok(doubts)
}

/// 2 subdomains per edge, or, where 2 does not divide the bricks, the divisor that leaves closest to six bricks.
pub fn default_subdomains(bricks: usize) -> usize {
    if bricks.is_multiple_of(2) {
        return 2;
    }
    let divisors = (1..=bricks).filter(|count| bricks.is_multiple_of(*count));
    let distance = |count: &usize| {
        let bricks = (bricks / count) as f64 / 6.0;
        bricks.max(1.0 / bricks)
    };
    divisors.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tearing_of_meshes_that_two_does_not_divide() {
        assert_eq!([12, 35, 25, 9, 7, 13, 1].map(default_subdomains), [2, 5, 5, 1, 1, 1, 1]);
    }
}
