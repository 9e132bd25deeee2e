//! Parts of a face that are one smooth surface each, with the points on it.

use super::chart::Chart;
use crate::body::mesh::{CellFace, Mesh};
use crate::mortar::{Facet, Primitive};
use crate::patches::{fit, is_off, smooth_parts};
use std::collections::{BTreeMap, BTreeSet};

/// How often a part is divided at most.
const DIVISIONS: usize = 6;

/// A part of a face.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// The nodes on the surface, ascending.
    pub points: Vec<u32>,
    pub facets: Vec<Facet>,
    /// Its parameters; none where it folds in all charts.
    pub chart: Option<Chart>,
}

/// A face with what its parts are made from.
pub(super) struct Source<'a> {
    pub mesh: &'a Mesh,
    /// Where the nodes are at the start.
    pub start: &'a [[f64; 3]],
}

/// Some facets with all nodes of the mesh on each, and their normals.
#[derive(Clone, Default)]
struct FacetGroup {
    facets: Vec<Facet>,
    nodes: Vec<Vec<u32>>,
    normals: Vec<[f64; 3]>,
}

impl FacetGroup {
    fn of(&self, which: impl Iterator<Item = usize>) -> Self {
        let mut own = Self::default();
        for facet in which {
            own.facets.push(self.facets[facet]);
            own.nodes.push(self.nodes[facet].clone());
            own.normals.push(self.normals[facet]);
        }
        own
    }

    /// Its smooth parts.
    fn smooth_parts(&self) -> Vec<Self> {
        let (part, count) = smooth_parts::smooth_parts(&self.facets, &self.normals);
        let own = |number: usize| self.of((0..part.len()).filter(|&facet| part[facet] == number));
        (0..count).map(own).collect()
    }

    /// Both halves by the component of the normals that spreads most.
    fn halves(&self) -> [Self; 2] {
        let ends = |axis: usize| {
            let along = self.normals.iter().map(|normal| normal[axis]);
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| [least.min(x), most.max(x)])
        };
        let spread = |axis: usize| ends(axis)[1] - ends(axis)[0];
        // Of axes with equal spread, up to rounding, the first.
        let axis = (1..3).fold(0, |best, axis| if spread(axis) > spread(best) + 1e-9 { axis } else { best });
        let middle = 0.5 * (ends(axis)[0] + ends(axis)[1]) - 1e-9;
        let half = |upper: bool| {
            self.of((0..self.facets.len()).filter(|&facet| (self.normals[facet][axis] >= middle) == upper))
        };
        [half(true), half(false)]
    }
}

impl Source<'_> {
    /// The parts of a face.
    pub(super) fn parts(&self, faces: &[CellFace]) -> Vec<Part> {
        let x = |node: u32| self.start[node as usize];
        let mut whole = FacetGroup::default();
        for face in faces {
            let (nodes, corners) = self.mesh.face_with_corners(*face);
            let Some(facet) = Facet::new(&nodes[..corners]) else { continue };
            whole.normals.push(smooth_parts::normal(&nodes[..corners].iter().map(|&node| x(node)).collect::<Vec<_>>()));
            whole.facets.push(facet);
            whole.nodes.push(nodes);
        }
        let mut open: Vec<(FacetGroup, usize)> =
            whole.smooth_parts().into_iter().map(|piece| (piece, DIVISIONS)).collect();
        open.reverse();
        let mut parts = Vec::new();
        while let Some((piece, divisions)) = open.pop() {
            let chart = Chart::new(&piece.facets, &piece.normals, &x);
            if chart.is_none() && divisions > 0 {
                let halves = piece.halves();
                let smaller: Vec<FacetGroup> = halves.iter().flat_map(FacetGroup::smooth_parts).collect();
                open.extend(smaller.into_iter().rev().map(|piece| (piece, divisions - 1)));
                continue;
            }
            parts.push(self.part(&piece, chart));
        }
        parts
    }

    fn part(&self, piece: &FacetGroup, chart: Option<Chart>) -> Part {
        let x = |node: u32| self.start[node as usize];
        let mut nodes: BTreeSet<u32> = piece.facets.iter().flat_map(|facet| facet.corners().iter().copied()).collect();
        let mut edges: BTreeMap<[u32; 2], Option<u32>> = BTreeMap::new();
        for (facet, all) in piece.facets.iter().zip(&piece.nodes) {
            let middles = all[facet.corners().len()..].iter().map(|&node| Some(node)).chain(std::iter::repeat(None));
            edges.extend(smooth_parts::edges(facet).zip(middles));
        }
        let file = |(edge, middle): (&[u32; 2], &Option<u32>)| middle.map(|middle| (*edge, middle));
        let is_curved = edges.iter().filter_map(file).any(|(edge, middle)| is_off(edge.map(x), x(middle)));
        let corners: Vec<[f64; 3]> = nodes.iter().map(|&node| x(node)).collect();
        // On chords of a curved surface, middle nodes lie beside it.
        if is_curved || matches!(fit::primitive(&corners, &piece.normals), Some(Primitive::Plane { .. })) {
            nodes.extend(edges.values().flatten());
        }
        Part { points: nodes.into_iter().collect(), facets: piece.facets.clone(), chart }
    }
}

/// The rectangle of some parameters, enlarged on every side by a share of it: least corner and sides.
pub(super) fn rectangle(places: &[[f64; 2]], share: f64) -> [[f64; 2]; 2] {
    let ends = [0, 1].map(|axis| {
        let along = places.iter().map(|place| place[axis]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], x| [least.min(x), most.max(x)])
    });
    let sides = ends.map(|[least, most]| most - least);
    [[0, 1].map(|axis| ends[axis][0] - share * sides[axis]), sides.map(|side| (1.0 + 2.0 * share) * side)]
}
