//! The contact surface of the lower body as facets between its nodes.

use crate::body::Body;
use crate::body::mesh::CellFace;
use crate::equilibrium::ContactBoundary;
use std::collections::HashMap;

/// The facets of the contact surface, triangles and quadrilaterals, counterclockwise seen from outside.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFacets {
    /// Corners of the facets in the mesh, ascending: contact nodes, and nodes that supports hold along their normals.
    pub nodes: Vec<u32>,
    /// The corners of every facet by their places among the nodes.
    pub facets: Vec<Vec<usize>>,
    /// The contact node at every node, by its place among the contact nodes; none where supports hold the normal.
    pub points: Vec<Option<usize>>,
}

impl ContactFacets {
    pub(crate) fn new(body: &Body, faces: &[CellFace], boundary: &ContactBoundary) -> Self {
        let corners = |face: &CellFace| {
            let (nodes, corners) = body.mesh.face_with_corners(*face);
            nodes.into_iter().take(corners).collect::<Vec<u32>>()
        };
        let mut nodes: Vec<u32> = faces.iter().flat_map(corners).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: u32| nodes.partition_point(|other| *other < node);
        let facets = faces.iter().map(|face| corners(face).into_iter().map(place).collect()).collect();
        let known: HashMap<u32, usize> =
            boundary.points.iter().enumerate().map(|(index, point)| (point.node, index)).collect();
        let points = nodes.iter().map(|node| known.get(node).copied()).collect();
        Self { nodes, facets, points }
    }

    /// Edges between the nodes (by their places, the smaller first), with the facet of those that only one facet has.
    pub fn edges(&self) -> Vec<([usize; 2], Option<usize>)> {
        let mut edges: HashMap<[usize; 2], Option<usize>> = HashMap::new();
        for (number, facet) in self.facets.iter().enumerate() {
            for (index, &from) in facet.iter().enumerate() {
                let to = facet[(index + 1) % facet.len()];
                let edge = [from.min(to), from.max(to)];
                edges.entry(edge).and_modify(|owner| *owner = None).or_insert(Some(number));
            }
        }
        let mut edges: Vec<_> = edges.into_iter().collect();
        edges.sort_unstable();
        edges
    }
}
