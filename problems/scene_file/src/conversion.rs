//! From the bodies and contacts of a scene file to a scene.

use crate::bodies::default_subdomains;
use crate::lookup::body_number;
use crate::mesh_check::doubts_of_unit;
use crate::mesh_file::MeshFile;
use crate::shapes::obstacle;
use crate::{BlockSection, BodySection, ContactSection, FaceSection, SceneFile, UnitName, loading};
use contact::error::SceneError;
use contact::names::find_face;
use contact::scene::{
    AreaKind, Block, BodyFace, BodyScene, ContactKind, ContactScene, CounterSurface, Geometry, Master, MeshGeometry,
    NormalKind, Scene,
};
use contact::shape::{LatticeShape, ShapedFace};
use std::path::Path;
use std::sync::Arc;

/// A scene with what goes beside it.
pub(crate) struct Parts {
    pub scene: Scene,
    /// Controls at the start, mm, where they are not those of the scene.
    pub start: Option<Vec<f64>>,
    /// What is to be said of files before any work.
    pub notes: Vec<String>,
}

/// Where files and meshes of a scene file come from.
pub(crate) struct Sources<'a> {
    /// The folder of files that the scene names.
    pub folder: &'a Path,
    /// The mesh that `body.mesh` names, in this unit.
    pub mesh: &'a dyn Fn(&str, UnitName) -> Result<MeshFile, SceneError>,
}

/// The scene of a file.
pub(crate) fn scene_of(file: &SceneFile, sources: &Sources<'_>) -> Result<Parts, SceneError> {
    let (mut found, mut start, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    let mut starts_elsewhere = false;
    for (index, section) in file.body.iter().enumerate() {
        let at = format!("body[{index}]");
        let name = section.name(&at, file.body.len())?;
        let (body, controls) = body(&at, &name, section, sources, &mut notes)?;
        starts_elsewhere |= controls.is_some();
        start.extend(
            controls.unwrap_or_else(|| body.shape.as_ref().map_or_else(Vec::new, LatticeShape::start_controls)),
        );
        found.push(body);
    }
    let mut contacts = Vec::new();
    for (index, section) in file.contact.iter().enumerate() {
        contacts.push(contact(&format!("contact[{index}]"), section, (file, &found), sources.folder, &mut notes)?);
    }
    if !contacts.is_empty() && contacts.iter().all(ContactScene::is_tied) {
        let allowed = "at least one contact that may open: without one, no shape has a contact pressure";
        return Err(SceneError::out_of_range("contact", "glued faces alone", allowed));
    }
    let scene = Scene { name: file.name.clone(), bodies: found, contacts };
    Ok(Parts { scene, start: starts_elsewhere.then_some(start), notes })
}

/// A body, and its controls at the start where they are not those of the scene.
fn body(
    at: &str,
    name: &str,
    section: &BodySection,
    sources: &Sources<'_>,
    notes: &mut Vec<String>,
) -> Result<(BodyScene, Option<Vec<f64>>), SceneError> {
    let heights = section.lattice.as_ref().and_then(|lattice| Some((lattice, lattice.heights?)));
    let shaped = match (heights, &section.block) {
        (Some((lattice, face)), Some(block)) => Some(lattice.height_shape(face, block.size, sources.folder)?),
        (Some(_), None) => {
            let allowed = "none for a mesh: heights are those of a face of a block";
            return Err(SceneError::out_of_range(format!("{at}.lattice.heights"), "a face", allowed));
        }
        (None, _) => None,
    };
    let geometry = match (&section.block, &section.mesh) {
        (Some(block), None) => {
            let shape = shaped.as_ref().map(|(shape, _)| shape);
            Geometry::Block(block_of(&format!("{at}.block"), block, shape, sources.folder)?)
        }
        (None, Some(file)) => {
            let MeshFile { mesh, notes: own } = (sources.mesh)(file, section.unit)?;
            notes.extend(own);
            Geometry::Mesh(MeshGeometry { mesh: Arc::new(mesh), pieces: section.pieces })
        }
        (Some(_), Some(_)) => {
            return Err(SceneError::out_of_range(at, "block and mesh", "a block or a mesh, not both"));
        }
        (None, None) => return Err(SceneError::out_of_range(at, "neither block nor mesh", "a block or a mesh")),
    };
    let mut body = BodyScene {
        materials: section.materials.iter().map(|own| own.material()).collect::<Result<_, SceneError>>()?,
        supports: loading::supports(at, &section.supports)?,
        loads: loading::loads(at, &section.loads)?,
        ..BodyScene::new(name, geometry, section.material.material()?)
    };
    let mut start = None;
    match (shaped, &section.lattice) {
        (Some((shape, controls)), _) => (body.shape, start) = (Some(shape), controls),
        (None, Some(lattice)) => body.shape = Some(lattice.shape(&body.mesh()?.0)?),
        (None, None) => {}
    }
    if let Geometry::Mesh(geometry) = &body.geometry {
        notes.extend(doubts_of_unit(at, &geometry.mesh, &body)?);
    }
    Ok((body, start))
}

fn block_of(at: &str, block: &BlockSection, shaped: Option<&LatticeShape>, folder: &Path) -> Result<Block, SceneError> {
    let face = |name: &str, face: ShapedFace, given: Option<&crate::ObstacleSection>| {
        let (field, shaped) = (format!("{at}.{name}"), shaped.filter(|shape| shape.face() == Some(face)));
        match (given, shaped) {
            (Some(_), Some(_)) => {
                Err(SceneError::out_of_range(field, "a table", "none: the lattice of the body shapes this face"))
            }
            (Some(section), None) => obstacle(&field, section, Some(([0.0; 2], block.size)), folder),
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
            return Err(SceneError::out_of_range(format!("{at}.subdomains[{axis}]"), count, allowed));
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

fn contact(
    at: &str,
    section: &ContactSection,
    (file, bodies): (&SceneFile, &[BodyScene]),
    folder: &Path,
    notes: &mut Vec<String>,
) -> Result<ContactScene, SceneError> {
    let refused =
        |field: &str, allowed: &str| Err(SceneError::out_of_range(format!("{at}.{field}"), "a value", allowed));
    let (slave, master) = sides(at, section, bodies, folder, notes)?;
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

/// Slave and master of a contact.
fn sides(
    at: &str,
    section: &ContactSection,
    bodies: &[BodyScene],
    folder: &Path,
    notes: &mut Vec<String>,
) -> Result<(BodyFace, Master), SceneError> {
    let face = |field: &str, section: &FaceSection| {
        let body = body_number(&format!("{at}.{field}.body"), section.body.as_ref(), bodies)?;
        Ok::<_, SceneError>(BodyFace::new(body, &*section.face))
    };
    let refused =
        |field: &str, allowed: &str| Err(SceneError::out_of_range(format!("{at}.{field}"), "a value", allowed));
    match (&section.slave, &section.master, &section.faces, &section.obstacle) {
        (Some(slave), Some(master), None, None) => Ok((face("slave", slave)?, Master::Body(face("master", master)?))),
        (Some(slave), None, None, Some(section)) => {
            let slave = face("slave", slave)?;
            let base = bodies[slave.body].block().map(|block| (block.corner, block.size));
            Ok((slave, Master::Obstacle(obstacle(&format!("{at}.obstacle"), section, base, folder)?)))
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
            Ok((slave, Master::Body(master)))
        }
        (_, _, Some(_), _) => refused("faces", "faces alone, without slave, master and obstacle"),
        (_, Some(_), _, Some(_)) => refused("obstacle", "a master or an obstacle, not both"),
        _ => {
            let allowed = "slave and master, faces, or slave and obstacle";
            Err(SceneError::out_of_range(at, "a contact without its sides", allowed))
        }
    }
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
