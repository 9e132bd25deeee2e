//! A first scene for a mesh, from the names and the form of its faces: commented, to be changed.
//!
//! Names say which faces touch, which are held, which are loaded. What only the user can know stays open: a comment
//! such as `# load: …` asks for it, and lines below it propose what fits the part. [`open_questions`] finds them again.

mod face;
mod lattice;
mod obstacle;
mod open;
mod roles;
mod text;
mod write;

pub use open::open_questions;

use crate::draft::face::Face;
use crate::draft::roles::Roles;
use crate::{UnitName, mesh_file};
use contact::body::mesh::{Mesh, bounding_box};
use contact::error::SceneError;
use std::path::Path;

/// Longest side, in the unit of the file, below which lengths are taken for metres.
const METRES: f64 = 1.0;

/// The text of a scene for a mesh in a Gmsh file, to be saved beside it.
///
/// ```
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");
/// let text = scene_file::draft(format!("{folder}/lug_tet10.msh").as_ref())?;
/// let scene = scene_file::SceneFile::parse(&text, "draft")?;
/// let case = scene_file::Case::new(&scene, folder.as_ref())?;
/// assert_eq!(case.scene.contacts[0].slave.face, "nose");
/// # Ok::<(), contact::error::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError`] for a file that is no mesh of one body, and for a mesh that names fewer than two faces.
pub fn draft(file: &Path) -> Result<String, SceneError> {
    let read = mesh_file::read(file, UnitName::Mm)?;
    let longest = sides(&read.mesh).into_iter().fold(0.0, f64::max);
    let unit = if longest < METRES { UnitName::M } else { UnitName::Mm };
    let mesh = read.mesh.moved(|x| x.map(|x| unit.millimetres() * x));
    let faces = mesh.faces().iter().map(|(name, faces)| Face::new(&mesh, name, faces));
    let faces = faces.collect::<Result<Vec<_>, _>>()?;
    if faces.len() < 2 {
        let value = format!("{:?}", mesh.faces().keys().collect::<Vec<_>>());
        let allowed = "at least two physical surfaces, one that touches and one that is loaded or held (Gmsh: \
                       addPhysicalGroup(2, [tags], name=\"contact\"))";
        return Err(SceneError::out_of_range(format!("{}: named faces", file.display()), value, allowed));
    }
    let name =
        |path: Option<&std::ffi::OsStr>| path.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let part = write::Part {
        stem: &name(file.file_stem()),
        file: &name(file.file_name()),
        unit,
        volumes: mesh.volumes(),
        smallest_side: sides(&mesh).into_iter().fold(f64::INFINITY, f64::min),
        faces: &faces,
    };
    Ok(write::scene(&part, &Roles::new(&faces)))
}

/// Lengths of the box around a mesh.
fn sides(mesh: &Mesh) -> [f64; 3] {
    let [low, high] = bounding_box(mesh.nodes());
    std::array::from_fn(|axis| high[axis] - low[axis])
}
