//! A face of a mesh with the middles of its edges on the surface that the mesh approximates.

use super::{fit, quadric, smooth_parts};
use crate::body::mesh::{CellFace, Mesh, narrow};
use crate::error::SceneError;
use crate::mortar::vector::{dot, length, plus};
use crate::mortar::{Facet, NO_MIDDLE, Primitive, QuadraticFacet, Remainder};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Distance of a middle node from the chord, as a part of its length, that is rounding of files.
const STRAIGHT: f64 = 1e-9;

/// A middle farther from its chord than this part of its length is no middle of an arc.
const FOLDED: f64 = 0.25;

/// Of a surface of third degree, z = c x³, a quadric over two rings of width h leaves 2/5 c (2h)³ = 3.2 c h³, and a
/// patch over one facet max |t (t − 1/2) (t − 1)| c h³ = 0.048 c h³. The share is taken twice, for the error of the
/// middles.
const ONE_RING: f64 = 2.0 * 0.048 / 3.2;

/// A point that is no node of the mesh: the middle of an edge on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MiddlePoint {
    /// The ends of the edge.
    pub ends: [u32; 2],
    /// Where it lies in the mesh as given.
    pub place: [f64; 3],
}

/// The facets of a face with their middles.
#[derive(Debug, Clone)]
pub(crate) struct CurvedFace {
    /// The facets.
    pub facets: Vec<Facet>,
    /// One per facet.
    pub quadratic_facets: Vec<QuadraticFacet>,
    /// Points that are no nodes, numbered after the nodes of the mesh.
    pub points: Vec<MiddlePoint>,
    /// How far a facet may lie from the true surface, mm: the distance of its nodes from their primitive; else what
    /// the distance of the nodes around from their quadric tells; where nothing can be fitted, that of its nodes from
    /// the mean plane.
    pub residuals: Vec<f64>,
    /// Whether any middle lies off its chord.
    pub is_curved: bool,
    /// Its smooth parts.
    pub parts: Vec<SmoothPart>,
}

/// Facets that meet at 30° at most.
#[derive(Debug, Clone)]
pub(crate) struct SmoothPart {
    /// The numbers of its facets.
    pub facets: Vec<usize>,
    /// The surface that all its nodes lie on, with 1 where its outside is that of the facets, else −1.
    pub primitive: Option<(Primitive, f64)>,
    /// The unit normals of corners by quadrics through the nodes around; none with a primitive.
    pub normals: HashMap<u32, [f64; 3]>,
}

/// A smooth part of a face under work.
struct Part<'a> {
    places: &'a [[f64; 3]],
    /// Its facets with all nodes of the mesh on them.
    facets: Vec<(usize, Facet, Vec<u32>)>,
    normals: Vec<[f64; 3]>,
}

impl CurvedFace {
    /// Finds the middles of all edges of a face of a body; `name` stands in messages.
    ///
    /// # Errors
    /// As [`of_facets`](Self::of_facets).
    pub(crate) fn new(name: &str, mesh: &Mesh, faces: &[CellFace]) -> Result<Self, SceneError> {
        Self::of_facets(name, mesh.nodes(), faces.iter().map(|face| mesh.face_with_corners(*face)))
    }

    /// Finds the middles of all edges of facets, each given by its nodes, corners first, and the number of its corners.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a middle node of the file so far from its edge that the facet folds.
    pub(crate) fn of_facets(
        name: &str,
        places: &[[f64; 3]],
        facets: impl IntoIterator<Item = (Vec<u32>, usize)>,
    ) -> Result<Self, SceneError> {
        let given = facets.into_iter().filter_map(|(nodes, corners)| Some((Facet::new(&nodes[..corners])?, nodes)));
        let (facets, nodes): (Vec<Facet>, Vec<Vec<u32>>) = given.unzip();
        let x = |node: u32| places[node as usize];
        let normal = |facet: &Facet| {
            smooth_parts::normal(&facet.corners().iter().map(|&node| x(node)).collect::<Vec<[f64; 3]>>())
        };
        let normals: Vec<[f64; 3]> = facets.iter().map(normal).collect();
        let (part_of, count) = smooth_parts::smooth_parts(&facets, &normals);
        let mut quadratic_facets = vec![None; facets.len()];
        let mut this = Self {
            quadratic_facets: Vec::new(),
            points: Vec::new(),
            residuals: vec![0.0; facets.len()],
            is_curved: false,
            parts: Vec::with_capacity(count),
            facets,
        };
        for part in 0..count {
            let own: Vec<usize> = (0..this.facets.len()).filter(|&facet| part_of[facet] == part).collect();
            let facets = own.iter().map(|&facet| (facet, this.facets[facet], nodes[facet].clone())).collect();
            let part = Part { places, facets, normals: own.iter().map(|&facet| normals[facet]).collect() };
            part.check_middles(name)?;
            this.add(&part, &mut quadratic_facets);
        }
        this.quadratic_facets = quadratic_facets.into_iter().flatten().collect();
        Ok(this)
    }

    /// The face with its points numbered `by` higher, after those of other faces.
    pub(crate) fn shifted(mut self, mesh: &Mesh, by: usize) -> Self {
        let is_point = |number: &&mut u32| **number != NO_MIDDLE && **number as usize >= mesh.node_count();
        let middles = self.quadratic_facets.iter_mut().flat_map(|quadratic| &mut quadratic.middles);
        middles.filter(is_point).for_each(|number| *number += narrow(by));
        self
    }

    fn add(&mut self, part: &Part<'_>, quadratic_facets: &mut [Option<QuadraticFacet>]) {
        let x = |node: u32| part.places[node as usize];
        let first = narrow(part.places.len());
        let curved_edges = part.curved_edges();
        let mut points: BTreeSet<u32> = part.corners().collect();
        points.extend(curved_edges.iter().flat_map(|edges| edges.values().copied()));
        let points: Vec<[f64; 3]> = points.into_iter().map(x).collect();
        let primitive = fit::primitive(&points, &part.normals);
        let is_plane = matches!(primitive, Some(Primitive::Plane { .. }));
        let fits = if primitive.is_none() { part.fitted_normals() } else { HashMap::new() };
        let plane = fit::plane(&points);
        let mut known: HashMap<[u32; 2], u32> = HashMap::new();
        for (facet, corners, _) in &part.facets {
            let (mut middles, mut folded) = ([NO_MIDDLE; 4], 0.0_f64);
            for (middle, edge) in middles.iter_mut().zip(smooth_parts::edges(corners)) {
                *middle = *known.entry(edge).or_insert_with(|| {
                    // In a plane, edges may be curved, and the surface is not.
                    if let Some(node) = curved_edges.as_ref().filter(|_| !is_plane).and_then(|edges| edges.get(&edge)) {
                        return *node;
                    }
                    let ends = edge.map(x);
                    let chord: [f64; 3] = std::array::from_fn(|axis| 0.5 * (ends[0][axis] + ends[1][axis]));
                    let place = match (&primitive, edge.map(|node| fits.get(&node))) {
                        (Some(primitive), _) if !is_plane => primitive.project(chord),
                        (None, [Some(first), Some(second)]) => quadric::middle(ends, [first.normal, second.normal]),
                        (_, _) => chord,
                    };
                    let arm = length(plus(place, -1.0, chord));
                    let is_arc = arm <= FOLDED * length(plus(ends[1], -1.0, ends[0]));
                    if !is_arc {
                        folded = folded.max(arm);
                    }
                    self.points.push(MiddlePoint { ends: edge, place: if is_arc { place } else { chord } });
                    first + narrow(self.points.len()) - 1
                });
            }
            let place = |number: u32| match number.checked_sub(first) {
                Some(own) => self.points[own as usize].place,
                None => x(number),
            };
            self.is_curved |=
                smooth_parts::edges(corners).zip(middles).any(|(edge, middle)| is_off(edge.map(x), place(middle)));
            let mut start = [[0.0; 3]; 8];
            corners.corners().iter().enumerate().for_each(|(k, &node)| start[k] = x(node));
            middles.iter().enumerate().filter(|(_, m)| **m != NO_MIDDLE).for_each(|(k, &m)| start[4 + k] = place(m));
            let residual = |node: &u32| match (&primitive, fits.get(node)) {
                (None, Some(fit)) => ONE_RING * fit.residual,
                (primitive, _) => primitive.unwrap_or(plane).distance(x(*node)).abs(),
            };
            self.residuals[*facet] = corners.corners().iter().map(residual).fold(folded, f64::max);
            let remainder = primitive.filter(|_| !is_plane).map(|primitive| Remainder { primitive, start });
            quadratic_facets[*facet] = Some(QuadraticFacet { middles, remainder });
        }
        let normals = fits.into_iter().map(|(node, fit)| (node, fit.normal)).collect();
        let facets = part.facets.iter().map(|(facet, ..)| *facet).collect();
        let primitive = primitive.map(|primitive| (primitive, part.sense(&primitive)));
        self.parts.push(SmoothPart { facets, primitive, normals });
    }
}

/// From the middle of a chord to that of its edge.
fn arm([a, b]: [[f64; 3]; 2], middle: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| middle[axis] - 0.5 * (a[axis] + b[axis]))
}

/// Whether the middle of an edge lies off its chord.
pub(crate) fn is_off([a, b]: [[f64; 3]; 2], middle: [f64; 3]) -> bool {
    length(arm([a, b], middle)) > STRAIGHT * length(plus(b, -1.0, a))
}

impl Part<'_> {
    /// Refuses middle nodes of the file so far from their edges that facets fold.
    fn check_middles(&self, name: &str) -> Result<(), SceneError> {
        let Some(edges) = self.curved_edges() else { return Ok(()) };
        let x = |node: u32| self.places[node as usize];
        for (edge, middle) in edges {
            let [a, b] = edge.map(x);
            let share = length(arm([a, b], x(middle))) / length(plus(b, -1.0, a));
            let value = format!("a middle node at {:?}, {share:.2} of the length of its edge beside it", x(middle));
            SceneError::require(share <= FOLDED, name, value, "middle nodes within a quarter of that length")?;
        }
        Ok(())
    }

    fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.facets.iter().flat_map(|(_, facet, _)| facet.corners().iter().copied())
    }

    /// 1 where the outside of the facets is that of a primitive, else −1.
    fn sense(&self, primitive: &Primitive) -> f64 {
        let along = |((_, facet, _), normal): (&(usize, Facet, Vec<u32>), &[f64; 3])| {
            dot(primitive.parts(self.places[facet.corners()[0] as usize]).1, *normal)
        };
        let sum: f64 = self.facets.iter().zip(&self.normals).map(along).sum();
        if sum < 0.0 { -1.0 } else { 1.0 }
    }

    /// The middle nodes of the mesh by their edges, where any of them lies off its chord.
    fn curved_edges(&self) -> Option<BTreeMap<[u32; 2], u32>> {
        let mut edges = BTreeMap::new();
        for (_, facet, nodes) in &self.facets {
            let middles = &nodes[facet.corners().len()..];
            smooth_parts::edges(facet).zip(middles).for_each(|(edge, &middle)| _ = edges.insert(edge, middle));
        }
        let x = |node: u32| self.places[node as usize];
        edges.iter().any(|(edge, &middle)| is_off(edge.map(x), x(middle))).then_some(edges)
    }

    /// The normals of all corners by quadrics over two rings of facets.
    fn fitted_normals(&self) -> HashMap<u32, quadric::FittedNormal> {
        let x = |node: u32| self.places[node as usize];
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
