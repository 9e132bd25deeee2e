//! A face of a mesh as a rigid obstacle: feet of points on the curved surface behind its facets.
//!
//! ```text
//! on a plane, cylinder, cone or sphere: the exact foot.  Elsewhere, on a patch Y(ξ) with the normals m of its corners:
//!     Y(ξ) + g m(ξ) = x,   m = Σ N_k m_k/|Σ N_k m_k|      so that gap and normal are continuous across edges
//!     [Y_ξ + g m_ξ, Y_η + g m_η, m] (ξ′, g′) = x′,   m′ = m_ξ ξ′
//! beside the rim of a smooth part:  the nearest point q of its edges,  ∇d = v = (x − q)/|x − q|
//!     ∇²d = (I − v vᵀ)/d − t tᵀ/(d (1 − (x − q)·q″))
//! ```
//! Of all these points the nearest counts.

use crate::error::SceneError;
use crate::mortar::vector::{length, plus};
use crate::mortar::{NO_MIDDLE, NODES, Primitive};
use crate::patches::CurvedFace;
use crate::scalar::Dual;
use crate::scene::foot::Foot;
use crate::scene::side::Side;
use crate::scene::surface_patch::{Rim, SurfacePatch};
use rstar::{AABB, PointDistance, RTree, RTreeObject};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::Arc;

/// Distances that agree to this part are equal; the facet of least number counts.
const EQUAL: f64 = 1e-12;

/// A face of a mesh; an obstacle only. Its copies share the mesh.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct MeshSurface {
    surface: Arc<Surface>,
    side: Side,
    /// Where the origin of its nodes lies, mm.
    origin: [f64; 3],
}

/// What a [`MeshSurface`] is made of.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Parts {
    nodes: Vec<[f64; 3]>,
    facets: Vec<Vec<u32>>,
    side: Side,
    origin: [f64; 3],
}

#[derive(Debug)]
struct Surface {
    nodes: Vec<[f64; 3]>,
    facets: Vec<Vec<u32>>,
    /// Those of its smooth parts.
    primitives: Vec<Option<(Primitive, f64)>>,
    tree: RTree<Leaf>,
}

/// A facet in the tree of boxes.
#[derive(Debug)]
struct Leaf {
    number: usize,
    part: usize,
    patch: SurfacePatch,
    bounds: AABB<[f64; 3]>,
}

impl RTreeObject for Leaf {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.bounds
    }
}

impl PointDistance for Leaf {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        self.bounds.distance_2(point)
    }
}

impl TryFrom<Parts> for MeshSurface {
    type Error = SceneError;

    fn try_from(parts: Parts) -> Result<Self, SceneError> {
        let surface = Self::new("mesh", parts.nodes, parts.facets, parts.side)?;
        Ok(Self { origin: parts.origin, ..surface })
    }
}

impl From<MeshSurface> for Parts {
    fn from(surface: MeshSurface) -> Self {
        let Surface { nodes, facets, .. } = &*surface.surface;
        Self { nodes: nodes.clone(), facets: facets.clone(), side: surface.side, origin: surface.origin }
    }
}

impl PartialEq for MeshSurface {
    fn eq(&self, other: &Self) -> bool {
        let own = |surface: &Self| (surface.side, surface.origin);
        let is_same = Arc::ptr_eq(&self.surface, &other.surface);
        own(self) == own(other)
            && (is_same || (&self.surface.nodes, &self.surface.facets) == (&other.surface.nodes, &other.surface.facets))
    }
}

impl MeshSurface {
    /// The surface of facets between nodes (mm): triangles and quadrilaterals by three or four corners counterclockwise
    /// from outside, triangles of second degree by six nodes, corners first. Facets without area do not count. `side`
    /// says whether the body lies outside; `field` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for nodes that are missing or not finite, other numbers of nodes, no facet with an
    /// area, and facets that run around an edge in the same sense, so that their outsides differ.
    pub fn new(field: &str, nodes: Vec<[f64; 3]>, facets: Vec<Vec<u32>>, side: Side) -> Result<Self, SceneError> {
        if let Some(index) = nodes.iter().position(|x| !x.iter().all(|x| x.is_finite())) {
            let value = format!("{:?}", nodes[index]);
            return Err(SceneError::out_of_range(format!("{field}: node {}", index + 1), value, "finite numbers (mm)"));
        }
        let mut given = Vec::with_capacity(facets.len());
        for own in &facets {
            let corners = if own.len() == 6 { 3 } else { own.len() };
            let valid = matches!(corners, 3 | 4) && own.iter().all(|&node| (node as usize) < nodes.len());
            let allowed = format!("3, 4 or 6 nodes below {}", nodes.len());
            SceneError::require(valid, format!("{field}: facet"), format!("{own:?}"), allowed)?;
            let places: Vec<[f64; 3]> = own[..corners].iter().map(|&node| nodes[node as usize]).collect();
            if length(crate::mortar::doubled_area(&places)) > 0.0 {
                given.push((own.clone(), corners));
            }
        }
        SceneError::require(!given.is_empty(), format!("{field}: facets"), "none", "at least one facet with an area")?;
        check_senses(field, &nodes, &given)?;
        let curved = CurvedFace::of_facets(field, &nodes, given)?;
        let surface = Surface::new(&curved, nodes, facets);
        Ok(Self { surface: Arc::new(surface), side, origin: [0.0; 3] })
    }

    /// The surface translated by a vector, mm.
    #[must_use]
    pub(super) fn moved(&self, by: [f64; 3]) -> Self {
        Self { origin: plus(self.origin, 1.0, by), ..self.clone() }
    }

    /// The foot of a point.
    pub(super) fn foot(&self, x: [f64; 3]) -> Result<Foot, &'static str> {
        let x = plus(x, -1.0, self.origin);
        let mut best: Option<(f64, usize, Foot)> = None;
        for (leaf, square) in self.surface.tree.nearest_neighbor_iter_with_distance_2(&x) {
            let reach = best.as_ref().map_or(f64::INFINITY, |(distance, ..)| distance * (1.0 + EQUAL));
            if square > reach * reach {
                break;
            }
            for foot in self.surface.feet(leaf, x, self.side) {
                let (distance, number) = (foot.gap.abs(), leaf.number);
                let is_better = best.as_ref().is_none_or(|(least, first, _)| {
                    let difference = distance - least;
                    if difference.abs() <= EQUAL * least { number < *first } else { difference < 0.0 }
                });
                if is_better {
                    best = Some((distance, number, foot));
                }
            }
        }
        best.map(|(.., foot)| foot).ok_or("no nearest point of the mesh was found")
    }
}

/// Refuses facets whose outsides differ.
fn check_senses(field: &str, nodes: &[[f64; 3]], facets: &[(Vec<u32>, usize)]) -> Result<(), SceneError> {
    let mut senses = HashMap::new();
    for (own, corners) in facets {
        for k in 0..*corners {
            let (from, to) = (own[k], own[(k + 1) % corners]);
            if senses.insert([from, to], ()).is_some() {
                let value = format!("from {:?} to {:?}", nodes[from as usize], nodes[to as usize]);
                let allowed = "once in each sense: of two facets, the outsides differ, or more than two share the edge";
                return Err(SceneError::out_of_range(format!("{field}: an edge"), value, allowed));
            }
        }
    }
    Ok(())
}

impl Surface {
    fn new(curved: &CurvedFace, nodes: Vec<[f64; 3]>, facets: Vec<Vec<u32>>) -> Self {
        let x = |number: u32| match (number as usize).checked_sub(nodes.len()) {
            Some(middle) => curved.points[middle].place,
            None => nodes[number as usize],
        };
        let corners = |facet: usize| curved.facets[facet].corners().iter().map(|&node| x(node)).collect::<Vec<_>>();
        let flat: Vec<[f64; 3]> =
            (0..curved.facets.len()).map(|facet| unit(crate::mortar::doubled_area(&corners(facet)))).collect();
        let mut part_of = vec![0; flat.len()];
        for (number, part) in curved.parts.iter().enumerate() {
            part.facets.iter().for_each(|&facet| part_of[facet] = number);
        }
        let rims = rims(curved, &part_of, &flat);
        let primitives: Vec<_> = curved.parts.iter().map(|part| part.primitive).collect();
        let means = mean_normals(curved, &part_of, &flat);
        let leaves = (0..curved.facets.len()).map(|number| {
            let (own, part) = (curved.facets[number].corners(), part_of[number]);
            let mut places = [[0.0; 3]; NODES];
            own.iter().enumerate().for_each(|(k, &node)| places[k] = x(node));
            let middles = curved.quadratic_facets[number].middles;
            let used = middles.iter().enumerate().filter(|(_, middle)| **middle != NO_MIDDLE);
            used.for_each(|(k, &middle)| places[4 + k] = x(middle));
            let normal = |&node: &u32| match (&primitives[part], curved.parts[part].normals.get(&node)) {
                (Some((primitive, sign)), _) => primitive.parts(x(node)).1.map(|n| sign * n),
                (None, Some(normal)) => *normal,
                (None, None) => means[&(part, node)],
            };
            let mut normals = [[0.0; 3]; 4];
            own.iter().enumerate().for_each(|(k, node)| normals[k] = normal(node));
            let patch = SurfacePatch { count: own.len(), places, normals, rims: rims[number] };
            Leaf { number, part, bounds: patch.bounds(), patch }
        });
        Self { tree: RTree::bulk_load(leaves.collect()), primitives, nodes, facets }
    }

    /// The feet of a point on a facet and on its rims.
    fn feet<'a>(&'a self, leaf: &'a Leaf, x: [f64; 3], side: Side) -> impl Iterator<Item = Foot> + 'a {
        let of_patch = leaf.patch.project(x).and_then(|projection| match &self.primitives[leaf.part] {
            Some((primitive, sign)) => primitive_foot(primitive, *sign, x, side),
            None => Some(projection.foot(side)),
        });
        of_patch.into_iter().chain(leaf.patch.rim_feet(x, side))
    }
}

/// The foot on a primitive; none where it has no normal.
fn primitive_foot(primitive: &Primitive, sign: f64, x: [f64; 3], side: Side) -> Option<Foot> {
    let (value, normal) = primitive.parts(x);
    let mut second = [[0.0; 3]; 3];
    for axis in 0..3 {
        let varied = std::array::from_fn(|k| Dual::new(x[k], f64::from(u8::from(k == axis))));
        let slopes = primitive.parts(varied).1.map(|n| n.derivative);
        (0..3).for_each(|i| second[i][axis] = sign * slopes[i]);
    }
    let valid = second.as_flattened().iter().chain(&normal).all(|part| part.is_finite());
    valid.then(|| Foot::of_distance(sign * value, normal.map(|n| sign * n), second, side))
}

/// The mean unit normals of the facets of a part about each of its corners.
fn mean_normals(curved: &CurvedFace, part_of: &[usize], flat: &[[f64; 3]]) -> HashMap<(usize, u32), [f64; 3]> {
    let mut sums: HashMap<(usize, u32), [f64; 3]> = HashMap::new();
    for (number, facet) in curved.facets.iter().enumerate() {
        for &node in facet.corners() {
            let sum = sums.entry((part_of[number], node)).or_default();
            *sum = plus(*sum, 1.0, flat[number]);
        }
    }
    sums.into_iter().map(|(key, sum)| (key, unit(sum))).collect()
}

/// What lies beyond every edge of every facet: its own smooth part, another one, or nothing.
fn rims(curved: &CurvedFace, part_of: &[usize], flat: &[[f64; 3]]) -> Vec<[Rim; 4]> {
    let edges = |facet: usize| {
        let own = curved.facets[facet].corners();
        (0..own.len()).map(move |k| (k, own[k], own[(k + 1) % own.len()]))
    };
    let all = || (0..curved.facets.len()).flat_map(|facet| edges(facet).map(move |edge| (facet, edge)));
    let owner: HashMap<[u32; 2], usize> = all().map(|(facet, (_, from, to))| ([from, to], facet)).collect();
    let mut rims = vec![[Rim::Inner; 4]; curved.facets.len()];
    for (facet, (k, from, to)) in all() {
        rims[facet][k] = match owner.get(&[to, from]) {
            None => Rim::Open,
            Some(&other) if part_of[other] == part_of[facet] => Rim::Inner,
            Some(&other) => Rim::Sharp(unit(plus(flat[facet], 1.0, flat[other]))),
        };
    }
    rims
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let size = length(vector);
    if size > 0.0 { vector.map(|part| part / size) } else { vector }
}
