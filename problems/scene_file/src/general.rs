//! The scene of a file with lists of bodies and of contacts.

use crate::either::Either;
use crate::mesh_file::{self, MeshFile};
use crate::scene_parts::{Parts, required};
use crate::shapes::{counter_surface, heights};
use crate::short_form::{default_subdomains, doubts_of_unit};
use crate::{BlockSection, FaceSection, MeshSection, PairSection, PartSection, SceneFile, bodies};
use contact::error::SceneError;
use contact::names::{find, find_face};
use contact::scene::{
    AreaKind, Block, BodyFace, BodyScene, ContactKind, ContactScene, CounterSurface, Geometry, Master, MeshGeometry,
    NormalKind, Scene,
};
use contact::shape::{LatticeShape, ShapedFace};
use std::path::Path;
use std::sync::Arc;

/// The scene of a file whose bodies are a list.
pub(crate) fn general_scene(file: &SceneFile, bodies: &[PartSection], folder: &Path) -> Result<Parts, SceneError> {
    for (field, given) in [
        ("size", file.size.is_some()),
        ("lower", file.lower.is_some()),
        ("upper", file.upper.is_some()),
        ("counter_surface", file.counter_surface.is_some()),
        ("surface", file.surface.is_some()),
        ("admissible", file.admissible.is_some()),
        ("lattice", file.lattice.is_some()),
        ("mesh", file.mesh != MeshSection::default()),
    ] {
        if given {
            let allowed = "none beside [[body]]: bodies have their own block with bricks, surface, admissible and \
                           lattice, contacts their own obstacle";
            return Err(SceneError::out_of_range(field, "a value", allowed));
        }
    }
    let Either::Several(pairs) = &file.contact else {
        return Err(SceneError::out_of_range(
            "contact",
            "a table",
            "[[contact]] beside [[body]]: one table per contact",
        ));
    };
    let (mut found, mut start, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    let mut starts_elsewhere = false;
    for (index, section) in bodies.iter().enumerate() {
        let at = format!("body[{index}]");
        let (body, controls) = part(&at, section, folder, &mut notes)?;
        starts_elsewhere |= controls.is_some();
        start.extend(
            controls.unwrap_or_else(|| body.shape.as_ref().map_or_else(Vec::new, LatticeShape::start_controls)),
        );
        found.push(body);
    }
    let mut contacts = Vec::new();
    for (index, section) in pairs.iter().enumerate() {
        contacts.push(pair(&format!("contact[{index}]"), section, (file, &found), folder, &mut notes)?);
    }
    if !contacts.is_empty() && contacts.iter().all(ContactScene::is_tied) {
        let allowed = "at least one contact that may open: without one, no shape has a contact pressure";
        return Err(SceneError::out_of_range("contact", "glued faces alone", allowed));
    }
    let scene = Scene { name: file.name.clone(), bodies: found, contacts };
    Ok(Parts { scene, start: starts_elsewhere.then_some(start), notes })
}

/// A body, and its controls at the start where they are not those of the scene.
fn part(
    at: &str,
    section: &PartSection,
    folder: &Path,
    notes: &mut Vec<String>,
) -> Result<(BodyScene, Option<Vec<f64>>), SceneError> {
    let refused = |field: &str, allowed: &str| {
        Err::<(), _>(SceneError::out_of_range(format!("{at}.{field}"), "a value", allowed))
    };
    let shaped = match (&section.surface, &section.block) {
        (Some(_), None) => {
            refused("surface", "a lattice for a mesh: a surface shapes blocks only")?;
            None
        }
        (Some(surface), Some(block)) => {
            let field = format!("{at}.admissible");
            let admissible = required(&field, section.admissible.as_ref(), "a table, for the bounds of the surface")?;
            Some(heights((surface, admissible), block.size, folder)?)
        }
        (None, _) => {
            if section.admissible.is_some() {
                refused("admissible", "none without a surface")?;
            }
            None
        }
    };
    let geometry = match (&section.block, &section.mesh) {
        (Some(block), None) => Geometry::Block(block_of(at, block, shaped.as_ref().map(|(shape, _)| shape), folder)?),
        (None, Some(file)) => {
            let MeshFile { mesh, notes: own } = mesh_file::read(&folder.join(file), section.unit)?;
            notes.extend(own);
            Geometry::Mesh(MeshGeometry { mesh: Arc::new(mesh), pieces: section.pieces })
        }
        (Some(_), Some(_)) => {
            return Err(SceneError::out_of_range(at, "block and mesh", "a block or a mesh, not both"));
        }
        (None, None) => return Err(SceneError::out_of_range(at, "neither block nor mesh", "a block or a mesh")),
    };
    let given = (section.material.clone(), section.materials.as_slice());
    let mut body = bodies::body(&section.name, geometry, given, &section.supports, &section.loads)?;
    let mut start = None;
    match (shaped, &section.lattice) {
        (Some(_), Some(_)) => refused("lattice", "a surface or a lattice, not both")?,
        (Some((shape, controls)), None) => (body.shape, start) = (Some(shape), controls),
        (None, Some(lattice)) => body.shape = Some(lattice.shape(&body.mesh()?.0)?),
        (None, None) => {}
    }
    if let Geometry::Mesh(geometry) = &body.geometry {
        notes.extend(doubts_of_unit(&geometry.mesh, &body)?);
    }
    Ok((body, start))
}

fn block_of(at: &str, block: &BlockSection, shaped: Option<&LatticeShape>, folder: &Path) -> Result<Block, SceneError> {
    let face = |name: &str, face: ShapedFace, given: Option<&crate::CounterSection>| {
        let (field, shaped) = (format!("{at}.block.{name}"), shaped.filter(|shape| shape.face() == Some(face)));
        match (given, shaped) {
            (Some(_), Some(_)) => {
                Err(SceneError::out_of_range(field, "a table", "none: the surface of the body shapes this face"))
            }
            (Some(section), None) => counter_surface(&field, section, Some(block.size), folder),
            (None, Some(shape)) => Ok(CounterSurface::Plane { height: shape.start }),
            (None, None) if face == ShapedFace::Bottom => Ok(CounterSurface::Plane { height: 0.0 }),
            (None, None) => {
                let allowed = "a table such as { form = \"plane\", height = 10.0 }";
                Err(SceneError::out_of_range(field, "missing", allowed))
            }
        }
    };
    let subdomains = block.subdomains.unwrap_or_else(|| block.bricks.map(default_subdomains));
    for (axis, (bricks, count)) in block.bricks.iter().zip(subdomains).enumerate() {
        if !bricks.is_multiple_of(count) {
            let allowed = format!("a divisor of the {bricks} bricks per edge");
            return Err(SceneError::out_of_range(format!("{at}.block.subdomains[{axis}]"), count, allowed));
        }
    }
    Ok(Block {
        corner: block.corner.unwrap_or_default(),
        size: block.size,
        bricks: block.bricks,
        subdomains,
        bottom: face("bottom", ShapedFace::Bottom, block.bottom.as_ref())?,
        top: face("top", ShapedFace::Top, block.top.as_ref())?,
    })
}

fn pair(
    at: &str,
    section: &PairSection,
    (file, bodies): (&SceneFile, &[BodyScene]),
    folder: &Path,
    notes: &mut Vec<String>,
) -> Result<ContactScene, SceneError> {
    let face = |field: &str, section: &FaceSection| {
        let names = bodies.iter().map(|body| body.name.as_str());
        Ok::<_, SceneError>(BodyFace::new(find(&format!("{at}.{field}.body"), &section.body, names)?, &*section.face))
    };
    let refused =
        |field: &str, allowed: &str| Err(SceneError::out_of_range(format!("{at}.{field}"), "a value", allowed));
    let (slave, master) = match (&section.slave, &section.master, &section.faces, &section.obstacle) {
        (Some(slave), Some(master), None, None) => (face("slave", slave)?, Master::Body(face("master", master)?)),
        (Some(slave), None, None, Some(obstacle)) => {
            let surface = counter_surface(&format!("{at}.obstacle"), obstacle, None, folder)?;
            (face("slave", slave)?, Master::Obstacle(surface))
        }
        (None, None, Some([first, second]), None) => {
            let both = [face("faces[0]", first)?, face("faces[1]", second)?];
            let size = |index: usize| facet_size(&format!("{at}.faces[{index}]"), bodies, &both[index]);
            let sizes = [size(0)?, size(1)?];
            let [first, second] = both;
            let (slave, master) = if sizes[1] < sizes[0] { (second, first) } else { (first, second) };
            notes.push(format!(
                "{at}: the slave is the face \"{}\" of {}, the softer and finer side",
                slave.face, bodies[slave.body].name
            ));
            (slave, Master::Body(master))
        }
        (_, _, Some(_), _) => return refused("faces", "faces alone, without slave, master and obstacle"),
        (_, Some(_), _, Some(_)) => return refused("obstacle", "a master or an obstacle, not both"),
        _ => {
            let allowed = "slave and master, faces, or slave and obstacle";
            return Err(SceneError::out_of_range(at, "a contact without its sides", allowed));
        }
    };
    if section.tied && section.friction.is_some() {
        return refused("friction", "none between glued faces");
    }
    if section.tied && section.obstacle.is_some() {
        return refused("tied", "two bodies: supports hold a face that is glued to an obstacle");
    }
    let area = if section.normal == NormalKind::X3 { AreaKind::Projected } else { AreaKind::Surface };
    Ok(ContactScene {
        slave,
        master,
        kind: if section.tied { ContactKind::Tied } else { ContactKind::Unilateral },
        normal: section.normal,
        area: section.area.unwrap_or(area),
        friction: if section.tied { 0.0 } else { section.friction.unwrap_or(file.friction) },
        friction_by_region: section.regions.iter().map(|part| (part.region.clone(), part.friction)).collect(),
        interference: section.interference.unwrap_or_default(),
        clearance: section.clearance,
        geometry: section.geometry,
    })
}

/// Young's modulus times the mean width of the facets of a face, N/mm.
fn facet_size(at: &str, bodies: &[BodyScene], face: &BodyFace) -> Result<f64, SceneError> {
    let body = &bodies[face.body];
    let (mesh, _) = body.mesh()?;
    let mut lengths = Vec::new();
    for face in find_face(&format!("{at}.face"), &face.face, &mesh)? {
        let (nodes, corners) = mesh.face_with_corners(*face);
        for place in 0..corners {
            let [a, b] = [place, (place + 1) % corners].map(|place| mesh.nodes()[nodes[place] as usize]);
            lengths.push((0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt());
        }
    }
    Ok(lengths.iter().sum::<f64>() / lengths.len().max(1) as f64 * body.material.young_modulus())
}
