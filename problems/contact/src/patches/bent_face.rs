//! A face of a mesh with the middles of its edges on the surface that the mesh approximates.

use super::{fit, quadric, smooth_parts};
use crate::body::mesh::{CellFace, Mesh};
use crate::mortar::vector::{length, plus};
use crate::mortar::{Bend, Facet, Remainder};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Distance of a middle node from the chord, as a part of its length, that is rounding of files.
const STRAIGHT: f64 = 1e-9;

/// A middle farther from its chord than this part of its length is no middle of an arc.
const FOLDED: f64 = 0.25;

/// A point that is no node of the mesh: the middle of an edge on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MiddlePoint {
    /// The ends of the edge.
    pub ends: [u32; 2],
    /// Where it lies in the mesh as given.
    pub place: [f64; 3],
}

/// The facets of a face with their bends.
#[derive(Debug, Clone)]
pub(crate) struct BentFace {
    /// The facets.
    pub facets: Vec<Facet>,
    /// One per facet.
    pub bends: Vec<Bend>,
    /// Points that are no nodes, numbered after the nodes of the mesh and those of other faces.
    pub points: Vec<MiddlePoint>,
    /// The number of the first of them.
    next: u32,
    /// How far a facet may lie from the true surface, mm, as the fit shows it: the distance of its nodes from their
    /// primitive, or of the nodes around from their quadric.
    pub residuals: Vec<f64>,
    /// Whether any middle lies off its chord.
    pub is_bent: bool,
}

/// A smooth part of a face under work.
struct Part<'a> {
    mesh: &'a Mesh,
    /// Its facets with all nodes of the mesh on them.
    facets: Vec<(usize, Facet, Vec<u32>)>,
    normals: Vec<[f64; 3]>,
}

impl BentFace {
    /// Finds the middles of all edges of a face; `next`: the number of the first new point.
    pub(crate) fn new(mesh: &Mesh, faces: &[CellFace], next: u32) -> Self {
        let given = faces.iter().filter_map(|face| {
            let (nodes, corners) = mesh.face_with_corners(*face);
            Some((Facet::new(&nodes[..corners])?, nodes))
        });
        let (facets, nodes): (Vec<Facet>, Vec<Vec<u32>>) = given.unzip();
        let x = |node: u32| mesh.nodes()[node as usize];
        let normal = |facet: &Facet| {
            smooth_parts::normal(&facet.corners().iter().map(|&node| x(node)).collect::<Vec<[f64; 3]>>())
        };
        let normals: Vec<[f64; 3]> = facets.iter().map(normal).collect();
        let (part_of, count) = smooth_parts::smooth_parts(&facets, &normals);
        let mut bends = vec![None; facets.len()];
        let mut this = Self {
            bends: Vec::new(),
            points: Vec::new(),
            next,
            residuals: vec![0.0; facets.len()],
            is_bent: false,
            facets,
        };
        for part in 0..count {
            let own: Vec<usize> = (0..this.facets.len()).filter(|&facet| part_of[facet] == part).collect();
            let facets = own.iter().map(|&facet| (facet, this.facets[facet], nodes[facet].clone())).collect();
            let part = Part { mesh, facets, normals: own.iter().map(|&facet| normals[facet]).collect() };
            this.add(&part, next, &mut bends);
        }
        this.bends = bends.into_iter().flatten().collect();
        this
    }

    /// The places of its points.
    pub(crate) fn own_points(&self) -> impl Iterator<Item = &[f64; 3]> {
        self.points.iter().map(|point| &point.place)
    }

    /// The bends with points numbered from `first` on, as if there were no other face.
    pub(crate) fn own_bends(&self, first: usize) -> Vec<Bend> {
        let own = |number: u32| match number {
            u32::MAX => number,
            _ if number >= self.next => number - self.next + first as u32,
            _ => number,
        };
        self.bends.iter().map(|bend| Bend { middles: bend.middles.map(own), ..*bend }).collect()
    }

    fn add(&mut self, part: &Part<'_>, next: u32, bends: &mut [Option<Bend>]) {
        let x = |node: u32| part.mesh.nodes()[node as usize];
        let bent_nodes = part.bent_nodes();
        let mut points: BTreeSet<u32> = part.corners().collect();
        points.extend(bent_nodes.iter().flat_map(|edges| edges.values().copied()));
        let points: Vec<[f64; 3]> = points.into_iter().map(x).collect();
        let primitive = fit::primitive(&points, &part.normals);
        let fits = if primitive.is_none() { part.fitted_normals() } else { HashMap::new() };
        let mut known: HashMap<[u32; 2], u32> = HashMap::new();
        for (facet, corners, _) in &part.facets {
            let mut middles = [u32::MAX; 4];
            for (middle, edge) in middles.iter_mut().zip(smooth_parts::edges(corners)) {
                *middle = *known.entry(edge).or_insert_with(|| {
                    if let Some(node) = bent_nodes.as_ref().and_then(|edges| edges.get(&edge)) {
                        return *node;
                    }
                    let ends = edge.map(x);
                    let chord: [f64; 3] = std::array::from_fn(|axis| 0.5 * (ends[0][axis] + ends[1][axis]));
                    let place = match (&primitive, edge.map(|node| fits.get(&node))) {
                        (Some(primitive), _) => primitive.project(chord),
                        (None, [Some(first), Some(second)]) => quadric::middle(ends, [first.normal, second.normal]),
                        (None, _) => chord,
                    };
                    let long = length(plus(ends[1], -1.0, ends[0]));
                    let is_arc = length(plus(place, -1.0, chord)) <= FOLDED * long;
                    self.points.push(MiddlePoint { ends: edge, place: if is_arc { place } else { chord } });
                    next + self.points.len() as u32 - 1
                });
            }
            let place = |number: u32| match number.checked_sub(next) {
                Some(own) => self.points[own as usize].place,
                None => x(number),
            };
            self.is_bent |=
                smooth_parts::edges(corners).zip(middles).any(|(edge, middle)| is_off(edge.map(x), place(middle)));
            let mut start = [[0.0; 3]; 8];
            corners.corners().iter().enumerate().for_each(|(k, &node)| start[k] = x(node));
            middles.iter().enumerate().filter(|(_, m)| **m != u32::MAX).for_each(|(k, &m)| start[4 + k] = place(m));
            let residual = |node: &u32| match (&primitive, fits.get(node)) {
                (Some(primitive), _) => primitive.distance(x(*node)).abs(),
                (None, Some(fit)) => fit.residual,
                (None, None) => 0.0,
            };
            self.residuals[*facet] = corners.corners().iter().map(residual).fold(0.0, f64::max);
            let curved = primitive.filter(|primitive| !matches!(primitive, crate::mortar::Primitive::Plane { .. }));
            let remainder = curved.map(|primitive| Remainder { primitive, start });
            bends[*facet] = Some(Bend { middles, remainder });
        }
    }
}

/// Whether the middle of an edge lies off its chord.
fn is_off([a, b]: [[f64; 3]; 2], middle: [f64; 3]) -> bool {
    let arm: [f64; 3] = std::array::from_fn(|axis| middle[axis] - 0.5 * (a[axis] + b[axis]));
    length(arm) > STRAIGHT * length(plus(b, -1.0, a))
}

impl Part<'_> {
    fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.facets.iter().flat_map(|(_, facet, _)| facet.corners().iter().copied())
    }

    /// The middle nodes of the mesh by their edges, where any of them lies off its chord.
    fn bent_nodes(&self) -> Option<BTreeMap<[u32; 2], u32>> {
        let mut edges = BTreeMap::new();
        for (_, facet, nodes) in &self.facets {
            let middles = &nodes[facet.corners().len()..];
            smooth_parts::edges(facet).zip(middles).for_each(|(edge, &middle)| _ = edges.insert(edge, middle));
        }
        let x = |node: u32| self.mesh.nodes()[node as usize];
        edges.iter().any(|(edge, &middle)| is_off(edge.map(x), x(middle))).then_some(edges)
    }

    /// The normals of all corners by quadrics over two rings of facets.
    fn fitted_normals(&self) -> HashMap<u32, quadric::FittedNormal> {
        let x = |node: u32| self.mesh.nodes()[node as usize];
        let mut around: BTreeMap<u32, (BTreeSet<u32>, [f64; 3])> = BTreeMap::new();
        for ((_, facet, _), normal) in self.facets.iter().zip(&self.normals) {
            for &corner in facet.corners() {
                let own = around.entry(corner).or_default();
                own.0.extend(facet.corners());
                own.1 = plus(own.1, 1.0, *normal);
            }
        }
        let fit = |(&node, (ring, normal)): (&u32, &(BTreeSet<u32>, [f64; 3]))| {
            let two: BTreeSet<u32> = ring.iter().flat_map(|other| around[other].0.iter().copied()).collect();
            let points: Vec<[f64; 3]> = two.into_iter().filter(|other| *other != node).map(x).collect();
            let size = length(*normal);
            (size > 0.0).then(|| quadric::fitted_normal(x(node), normal.map(|n| n / size), &points)).flatten()
        };
        around.iter().filter_map(|entry| Some((*entry.0, fit(entry)?))).collect()
    }
}
