//! The contact surfaces as facets between their nodes.

use crate::equilibrium::ContactBoundary;
use std::collections::HashMap;

/// The facets of the slave faces of all contacts whose sides may part: triangles and quadrilaterals, counterclockwise
/// seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactFacets {
    /// The body of every corner.
    pub bodies: Vec<usize>,
    /// Corners of the facets in the meshes, contact by contact, ascending within each: contact nodes, and nodes that
    /// are none (supports hold their normals, or nothing lies opposite to them).
    pub nodes: Vec<u32>,
    /// The corners of every facet by their places among the nodes.
    pub facets: Vec<Vec<usize>>,
    /// The contact node at every corner, by its place among all contact nodes.
    pub points: Vec<Option<usize>>,
}

impl ContactFacets {
    /// From contacts with their slave bodies and the corners of their slave facets.
    pub(crate) fn new(
        contacts: impl Iterator<Item = (usize, usize, Vec<Vec<u32>>)>,
        boundary: &ContactBoundary,
    ) -> Self {
        let mut this = Self::default();
        for (contact, body, corners) in contacts {
            let first = this.nodes.len();
            let mut nodes: Vec<u32> = corners.iter().flatten().copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            let place = |node: u32| first + nodes.partition_point(|other| *other < node);
            this.facets.extend(corners.into_iter().map(|facet| facet.into_iter().map(place).collect::<Vec<usize>>()));
            let range = boundary.of_contact(contact);
            let points = range.clone().zip(&boundary.points[range]);
            let known: HashMap<u32, usize> = points.map(|(index, point)| (point.node, index)).collect();
            this.points.extend(nodes.iter().map(|node| known.get(node).copied()));
            this.bodies.extend(vec![body; nodes.len()]);
            this.nodes.extend(nodes);
        }
        this
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
