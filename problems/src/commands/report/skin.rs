//! The skin of a body as pictures show it.

use contact::body::mesh::{CellFace, Mesh};
use std::collections::{BTreeMap, HashMap};

/// The nodes of the skin, and its faces by their places: corners counterclockwise seen from outside.
pub struct Skin {
    pub nodes: Vec<u32>,
    pub faces: Vec<Vec<usize>>,
}

impl Skin {
    pub fn new(mesh: &Mesh) -> Self {
        Self::of(mesh, &mesh.skin())
    }

    /// A part of the skin.
    pub fn of(mesh: &Mesh, faces: &[CellFace]) -> Self {
        let corners = |face: &CellFace| {
            let (nodes, count) = mesh.face_with_corners(*face);
            nodes.into_iter().take(count).collect::<Vec<u32>>()
        };
        let faces: Vec<Vec<u32>> = faces.iter().map(corners).collect();
        let mut nodes: Vec<u32> = faces.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| nodes.partition_point(|other| other < node);
        let faces = faces.iter().map(|face| face.iter().map(place).collect()).collect();
        Self { nodes, faces }
    }
}

/// The faces of the skin by the names that they have: those of one set of names together, those without a name last.
pub fn faces_by_names(mesh: &Mesh) -> Vec<(Vec<String>, Vec<CellFace>)> {
    let mut names: HashMap<CellFace, Vec<String>> = HashMap::new();
    for (name, faces) in mesh.faces() {
        for face in faces {
            names.entry(*face).or_default().push(name.clone());
        }
    }
    let mut found: BTreeMap<Vec<String>, Vec<CellFace>> = BTreeMap::new();
    for face in mesh.skin() {
        found.entry(names.remove(&face).unwrap_or_default()).or_default().push(face);
    }
    let nameless = found.remove(&Vec::new());
    found.into_iter().chain(nameless.map(|faces| (Vec::new(), faces))).collect()
}

/// Least and largest coordinates of some points along an axis.
pub fn extent(points: impl IntoIterator<Item = [f64; 3]>, axis: usize) -> [f64; 2] {
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    points.into_iter().fold(start, |[least, most], x| [least.min(x[axis]), most.max(x[axis])])
}
