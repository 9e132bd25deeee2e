//! Meshes given as numpy arrays, as Gmsh files have them.

use exchange::gmsh::{CellKind, FacetKind, GmshCell, GmshFacet, GmshMesh};
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Nodes (n × 3), cells (m × 8, 10 or 4, numbers of nodes) and named facets (k × 3 or 4, numbers of their corners).
#[derive(FromPyObject)]
pub struct MeshArrays<'py>(
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, i64>,
    Vec<(String, PyReadonlyArray2<'py, i64>)>,
);

impl MeshArrays<'_> {
    /// The mesh. Cells and facets are named by their places in the arrays.
    ///
    /// # Errors
    /// `ValueError` for arrays of another shape, numbers of nodes that do not exist, and nodes of no cell.
    pub fn mesh(&self) -> PyResult<GmshMesh> {
        let Self(nodes, cells, faces) = self;
        let (nodes, cells) = (nodes.as_array(), cells.as_array());
        if nodes.ncols() != 3 {
            return Err(refused(format!("nodes has shape {:?}, expected (n, 3)", nodes.shape())));
        }
        let kind = match cells.ncols() {
            8 => CellKind::Hex8,
            10 => CellKind::Tet10,
            4 => CellKind::Tet4,
            _ => {
                return Err(refused(format!(
                    "cells has shape {:?}, expected (m, 8), (m, 10) or (m, 4)",
                    cells.shape()
                )));
            }
        };
        let count = nodes.nrows();
        let mut mesh = GmshMesh {
            nodes: nodes.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect(),
            node_tags: (1..=count as u64).collect(),
            ..GmshMesh::default()
        };
        let mut used = vec![false; count];
        for (tag, row) in cells.rows().into_iter().enumerate() {
            let nodes = row.iter().map(|&node| place(node, count, "cells", tag)).collect::<PyResult<Vec<usize>>>()?;
            nodes.iter().for_each(|&node| used[node] = true);
            mesh.cells.push(GmshCell { kind, nodes, tag: tag as u64 });
        }
        if let Some(node) = used.iter().position(|used| !used) {
            return Err(refused(format!("node {node} belongs to no cell; allowed: nodes of cells alone")));
        }
        for (name, facets) in faces {
            let (facets, what) = (facets.as_array(), format!("faces[{name:?}]"));
            let kind = match facets.ncols() {
                3 => FacetKind::Tri3,
                4 => FacetKind::Quad4,
                _ => return Err(refused(format!("{what} has shape {:?}, expected (k, 3) or (k, 4)", facets.shape()))),
            };
            let first = mesh.facets.len();
            for (tag, row) in facets.rows().into_iter().enumerate() {
                let nodes = row.iter().map(|&node| place(node, count, &what, tag)).collect::<PyResult<_>>()?;
                mesh.facets.push(GmshFacet { kind, nodes, tag: tag as u64 });
            }
            mesh.surfaces.insert(name.clone(), (first..mesh.facets.len()).collect());
        }
        Ok(mesh)
    }
}

/// A number of a node.
fn place(node: i64, count: usize, what: &str, row: usize) -> PyResult<usize> {
    let found = usize::try_from(node).ok().filter(|node| *node < count);
    found.ok_or_else(|| refused(format!("{what}[{row}] names node {node}, allowed: 0 to {}", count.saturating_sub(1))))
}

fn refused(reason: String) -> PyErr {
    PyValueError::new_err(reason)
}
