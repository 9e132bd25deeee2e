//! A mesh: nodes, cells, named faces and node sets.

use crate::body::elasticity::CellNodes;
use crate::body::elasticity::facet::{AreaKind, tributary_areas};
use crate::body::mesh::CellKind;
use crate::error::SceneError;
use crate::scalar::Scalar;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A face of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct CellFace {
    /// The cell.
    pub cell: u32,
    /// Its face, in the order of [`CellKind::faces`].
    pub face: u8,
}

/// A cell: its kind and nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell<'a> {
    /// What it is.
    pub kind: CellKind,
    /// Its nodes in the order of the kind.
    pub nodes: &'a [u32],
}

/// Nodes, cells and their names. The positions of the nodes are those of the reference shape. Meshes are equal whatever
/// their files are called.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Mesh {
    nodes: Vec<[f64; 3]>,
    kinds: Vec<CellKind>,
    starts: Vec<u32>,
    connectivity: Vec<u32>,
    /// Names of volumes, and the volume of every cell.
    volumes: Vec<String>,
    volume_of: Vec<u16>,
    faces: BTreeMap<String, Vec<CellFace>>,
    node_sets: BTreeMap<String, Vec<u32>>,
    /// Named faces between cells, each by one of its two cells; their nodes are node sets.
    inner_faces: BTreeMap<String, Vec<CellFace>>,
    /// Tags of physical groups by dimension and name, where the mesh comes from a file that has them.
    group_tags: BTreeMap<(usize, String), u32>,
    /// The file of the mesh, and the names that it gives to no elements.
    file: Option<String>,
    empty_names: BTreeSet<String>,
    /// The piece of every cell, where the mesh brings its own.
    pieces: Option<Vec<u32>>,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        fn cells(mesh: &Mesh) -> impl PartialEq + '_ {
            (&mesh.nodes, &mesh.kinds, &mesh.starts, &mesh.connectivity, &mesh.volume_of, &mesh.pieces)
        }
        fn names(mesh: &Mesh) -> impl PartialEq + '_ {
            (&mesh.volumes, &mesh.faces, &mesh.node_sets, &mesh.inner_faces, &mesh.group_tags)
        }
        cells(self) == cells(other) && names(self) == names(other)
    }
}

/// The name of the only volume of a mesh without named volumes.
pub const WHOLE: &str = "body";

impl Mesh {
    /// A mesh of one volume, without names.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for positions that are not finite, a mesh without cells, a cell with another number
    /// of nodes than its kind has, with a node that does not exist or with one node twice.
    pub fn new<C: AsRef<[usize]>>(
        nodes: Vec<[f64; 3]>,
        cells: impl IntoIterator<Item = (CellKind, C)>,
    ) -> Result<Self, SceneError> {
        if let Some(node) = nodes.iter().position(|x| x.iter().any(|x| !x.is_finite())) {
            let value = format!("{:?}", nodes[node]);
            return Err(SceneError::out_of_range(format!("position of node {node}"), value, "finite numbers (mm)"));
        }
        let mut mesh = Self {
            nodes,
            kinds: Vec::new(),
            starts: vec![0],
            connectivity: Vec::new(),
            volumes: vec![WHOLE.into()],
            volume_of: Vec::new(),
            faces: BTreeMap::new(),
            node_sets: BTreeMap::new(),
            inner_faces: BTreeMap::new(),
            group_tags: BTreeMap::new(),
            file: None,
            empty_names: BTreeSet::new(),
            pieces: None,
        };
        for (number, (kind, nodes)) in cells.into_iter().enumerate() {
            mesh.push(number, kind, nodes.as_ref())?;
        }
        SceneError::require(!mesh.kinds.is_empty(), "cells of a mesh", 0, "at least one")?;
        mesh.volume_of = vec![0; mesh.kinds.len()];
        Ok(mesh)
    }

    fn push(&mut self, number: usize, kind: CellKind, nodes: &[usize]) -> Result<(), SceneError> {
        let (name, count) = (format!("nodes of cell {number} ({})", kind.name()), self.nodes.len());
        SceneError::require(nodes.len() == kind.node_count(), &name, nodes.len(), kind.node_count().to_string())?;
        let repeated = |(index, node): (usize, &usize)| nodes[..index].contains(node) || *node >= count;
        if nodes.iter().enumerate().any(repeated) {
            let allowed = format!("different nodes from 0 to {}", count.saturating_sub(1));
            return Err(SceneError::out_of_range(name, format!("{nodes:?}"), allowed));
        }
        self.connectivity.extend(nodes.iter().map(|&node| narrow(node)));
        self.starts.push(narrow(self.connectivity.len()));
        self.kinds.push(kind);
        Ok(())
    }

    /// Gives a name to some faces of cells.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a face that does not exist.
    pub fn with_face(mut self, name: impl Into<String>, faces: Vec<CellFace>) -> Result<Self, SceneError> {
        let name = name.into();
        self.check_faces(&name, &faces)?;
        self.faces.insert(name, faces);
        Ok(self)
    }

    /// Gives a name to some faces between cells, each by one of its two cells, and to their nodes. Nodes that have this
    /// name already keep it.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a face that does not exist.
    pub fn with_inner_face(mut self, name: impl Into<String>, faces: Vec<CellFace>) -> Result<Self, SceneError> {
        let name = name.into();
        self.check_faces(&name, &faces)?;
        let named = self.node_sets.get(&name).cloned().unwrap_or_default();
        let nodes = faces.iter().flat_map(|face| self.face_nodes(*face)).chain(named.iter().copied()).collect();
        if named.is_empty() {
            self.inner_faces.insert(name.clone(), faces);
        }
        self.with_node_set(name, nodes)
    }

    fn check_faces(&self, name: &str, faces: &[CellFace]) -> Result<(), SceneError> {
        let exists = |face: &CellFace| {
            self.kinds.get(face.cell as usize).is_some_and(|kind| usize::from(face.face) < kind.faces().len())
        };
        if let Some(bad) = faces.iter().find(|face| !exists(face)) {
            let allowed = format!("faces of the {} cells", self.kinds.len());
            return Err(SceneError::out_of_range(format!("face \"{name}\""), format!("{bad:?}"), allowed));
        }
        Ok(())
    }

    /// Gives a name to some nodes.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a node that does not exist.
    pub fn with_node_set(mut self, name: impl Into<String>, mut nodes: Vec<u32>) -> Result<Self, SceneError> {
        let (name, count) = (name.into(), self.nodes.len());
        if let Some(bad) = nodes.iter().find(|node| **node as usize >= count) {
            return Err(SceneError::out_of_range(format!("node set \"{name}\""), bad, format!("nodes below {count}")));
        }
        nodes.sort_unstable();
        nodes.dedup();
        self.node_sets.insert(name, nodes);
        Ok(self)
    }

    /// Gives every cell its volume by number, and the volumes their names.
    ///
    /// # Errors
    /// [`SceneError`] unless there is a number below the number of names for every cell.
    pub fn with_volumes(mut self, names: Vec<String>, volume_of: Vec<u16>) -> Result<Self, SceneError> {
        check_count("volumes of cells", self.kinds.len(), volume_of.len())?;
        if let Some(bad) = volume_of.iter().find(|volume| usize::from(**volume) >= names.len()) {
            return Err(SceneError::out_of_range("volume of a cell", bad, format!("numbers below {}", names.len())));
        }
        (self.volumes, self.volume_of) = (names, volume_of);
        Ok(self)
    }

    /// Remembers the file of the mesh and the names that it gives to no elements, for messages.
    #[must_use]
    pub fn from_file(mut self, file: impl Into<String>, empty_names: BTreeSet<String>) -> Self {
        (self.file, self.empty_names) = (Some(file.into()), empty_names);
        self
    }

    /// Remembers the tags of physical groups by dimension (0 for those of nodes) and name.
    #[must_use]
    pub fn with_group_tags(mut self, tags: BTreeMap<(usize, String), u32>) -> Self {
        self.group_tags = tags;
        self
    }

    /// Divides the cells into pieces, numbered from 0 without gap.
    ///
    /// # Errors
    /// [`SceneError`] unless there is a number for every cell and a cell for every number.
    pub fn with_pieces(mut self, pieces: Vec<u32>) -> Result<Self, SceneError> {
        check_count("pieces of cells", self.kinds.len(), pieces.len())?;
        let count = pieces.iter().copied().max().map_or(0, |last| last as usize + 1);
        let mut seen = vec![false; count.min(pieces.len() + 1)];
        pieces.iter().for_each(|&piece| seen.get_mut(piece as usize).into_iter().for_each(|seen| *seen = true));
        if seen.len() < count || seen.contains(&false) {
            let allowed = "numbers from 0 on without gap";
            return Err(SceneError::out_of_range("pieces of cells", format!("{count} numbers"), allowed));
        }
        self.pieces = Some(pieces);
        Ok(self)
    }

    /// The mesh with other reference positions.
    #[must_use]
    pub fn moved(mut self, change: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        self.nodes.iter_mut().for_each(|x| *x = change(*x));
        self
    }

    /// Reference positions of the nodes, mm.
    pub fn nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.kinds.len()
    }

    /// A cell.
    pub fn cell(&self, cell: usize) -> Cell<'_> {
        let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        Cell { kind: self.kinds[cell], nodes: &self.connectivity[range] }
    }

    /// All cells in order.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = Cell<'_>> {
        (0..self.cell_count()).map(|cell| self.cell(cell))
    }

    /// Names of the volumes.
    pub fn volumes(&self) -> &[String] {
        &self.volumes
    }

    /// The volume of a cell by its number.
    pub fn volume_of(&self, cell: usize) -> usize {
        usize::from(self.volume_of[cell])
    }

    /// Named faces.
    pub fn faces(&self) -> &BTreeMap<String, Vec<CellFace>> {
        &self.faces
    }

    /// Named sets of nodes, each ascending.
    pub fn node_sets(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.node_sets
    }

    /// Named faces between cells, each by one of its two cells; their nodes are among [`Self::node_sets`].
    pub fn inner_faces(&self) -> &BTreeMap<String, Vec<CellFace>> {
        &self.inner_faces
    }

    /// The file of the mesh, if it comes from one.
    pub fn file(&self) -> Option<&str> {
        self.file.as_deref()
    }

    /// Names that the file of the mesh gives to no elements: nothing can be asked of them.
    pub fn empty_names(&self) -> &BTreeSet<String> {
        &self.empty_names
    }

    /// Tags of physical groups by dimension (0 for those of nodes) and name, where the mesh comes from a file that has
    /// them.
    pub fn group_tags(&self) -> &BTreeMap<(usize, String), u32> {
        &self.group_tags
    }

    /// The piece of every cell, where the mesh brings its own.
    pub fn pieces(&self) -> Option<&[u32]> {
        self.pieces.as_deref()
    }

    /// Nodes of a face of a cell: corners counterclockwise seen from outside, then the middles of the edges.
    pub fn face_nodes(&self, face: CellFace) -> impl ExactSizeIterator<Item = u32> + '_ {
        let cell = self.cell(face.cell as usize);
        cell.kind.faces()[usize::from(face.face)].iter().map(move |&local| cell.nodes[local])
    }

    /// Nodes of a face of a cell, and how many of them are its corners.
    pub fn face_with_corners(&self, face: CellFace) -> (Vec<u32>, usize) {
        (self.face_nodes(face).collect(), self.kinds[face.cell as usize].corner_count())
    }

    /// Area of a face of a cell, mm².
    pub fn face_area(&self, face: CellFace, positions: &[[f64; 3]]) -> f64 {
        let nodes: Vec<[f64; 3]> = self.face_nodes(face).map(|node| positions[node as usize]).collect();
        tributary_areas(&nodes, AreaKind::Surface).into_iter().sum()
    }

    /// The area vector of a face by its corners, mm²: ∫n dA with the outward normal n, for nodes at positions in mm.
    pub fn face_vector(&self, face: CellFace, positions: &[[f64; 3]]) -> [f64; 3] {
        let (nodes, corners) = self.face_with_corners(face);
        let edge = |to: usize, from: usize| -> [f64; 3] {
            let [to, from] = [to, from].map(|corner| positions[nodes[corner] as usize]);
            std::array::from_fn(|axis| to[axis] - from[axis])
        };
        // Half the cross product of two sides, or of the diagonals.
        let (a, b) = if corners == 3 { (edge(1, 0), edge(2, 0)) } else { (edge(2, 0), edge(3, 1)) };
        std::array::from_fn(|i| 0.5 * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]))
    }

    /// Positions of the nodes of a cell, as numbers of any kind.
    pub(crate) fn cell_at<T>(&self, cell: usize, position: impl Fn(u32) -> [T; 3]) -> CellNodes<T> {
        let Cell { kind, nodes } = self.cell(cell);
        let at = |v: usize| position(nodes[v]);
        match kind {
            CellKind::Hex8 => CellNodes::Hex8(std::array::from_fn(at)),
            CellKind::Tet10 => CellNodes::Tet10(std::array::from_fn(at)),
        }
    }

    /// Positions of the nodes of a cell.
    pub fn cell_nodes(&self, cell: usize, positions: &[[f64; 3]]) -> CellNodes<f64> {
        self.cell_at(cell, |node| positions[node as usize])
    }

    /// ∫N dV of every node of a cell, mm³.
    pub(crate) fn node_volumes<T: Scalar>(
        &self,
        cell: usize,
        position: &impl Fn(u32) -> [T; 3],
    ) -> impl Iterator<Item = (u32, T)> {
        let volumes = self.cell_at(cell, position).node_volumes();
        self.cell(cell).nodes.iter().copied().zip(volumes)
    }

    /// Values of the nodes of a cell, one node after the other.
    pub fn cell_values(&self, cell: usize, values: &[[f64; 3]]) -> Vec<f64> {
        self.cell(cell).nodes.iter().flat_map(|&node| values[node as usize]).collect()
    }

    /// Mean position of the nodes of a cell.
    pub fn centre(&self, cell: usize, positions: &[[f64; 3]]) -> [f64; 3] {
        let nodes = self.cell(cell).nodes;
        let mean = |axis: usize| nodes.iter().map(|&node| positions[node as usize][axis]).sum::<f64>();
        std::array::from_fn(|axis| mean(axis) / nodes.len() as f64)
    }

    /// Volume of all cells, mm³.
    pub fn volume(&self, positions: &[[f64; 3]]) -> f64 {
        (0..self.cell_count()).map(|cell| self.cell_nodes(cell, positions).volume()).sum()
    }

    /// ∂(volume)/∂x per node, mm².
    pub fn volume_derivative(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut result = vec![[0.0; 3]; self.node_count()];
        for cell in 0..self.cell_count() {
            let derivative = self.cell_nodes(cell, positions).volume_derivative();
            for (&node, derivative) in self.cell(cell).nodes.iter().zip(derivative) {
                (0..3).for_each(|axis| result[node as usize][axis] += derivative[axis]);
            }
        }
        result
    }
}

/// Least and largest coordinates of some points, mm.
pub fn bounding_box(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[least, most], x| {
        [std::array::from_fn(|axis| least[axis].min(x[axis])), std::array::from_fn(|axis| most[axis].max(x[axis]))]
    })
}

/// The smallest side of the box around some points, mm.
pub fn smallest_extent(points: &[[f64; 3]]) -> f64 {
    let [least, most] = bounding_box(points);
    (0..3).map(|axis| most[axis] - least[axis]).fold(f64::INFINITY, f64::min)
}

/// Indices of meshes have 32 bits.
pub(crate) fn narrow(index: usize) -> u32 {
    u32::try_from(index).expect("invariant: meshes have fewer than 2³² entries")
}

fn check_count(what: &str, expected: usize, found: usize) -> Result<(), SceneError> {
    match expected == found {
        true => Ok(()),
        false => Err(SceneError::WrongCount { what: what.into(), expected, found }),
    }
}
