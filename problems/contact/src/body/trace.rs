//! What contact rows see of a body whose contact faces have middle nodes: weighted displacements of their corners.
//!
//! ```text
//! w_j = u_j + P_j Σ_m d_jm û_m,   û_m = u_m − ½(u_a + u_b)             a, b: the ends of the edge of middle node m
//! d_jm = Σ_f c_f A_f / Σ_f A_f over the facets f about corner j,       c_f = 3/5 on an edge of j, −1/5 opposite to j
//! ```
//! On plane facets that is ∫ψ_j u / ∫ψ_j with the dual basis ψ_j of the linear functions and displacements u of second
//! degree: a constant pressure is the load that belongs to it, and middle nodes are free. A_f: area of the triangle of
//! the corners. P_j: onto the directions in which supports leave corner j free; along the others w_j is what supports
//! prescribe to the corner. A middle node that supports hold along a direction in which they do not hold both ends, as
//! on the edge of a curved support, has no part in w. Faces of cells of first order have no middle nodes: w_j = u_j.

use crate::body::mesh::{CellFace, Mesh, narrow};
use crate::body::support::{beyond, onto};
use crate::mortar::vector::{cross, dot, length, plus};
use std::collections::{BTreeMap, BTreeSet};

/// Weight of a middle node in the corners of its edge, on one facet.
const ON_EDGE: f64 = 0.6;
/// Weight of a middle node in the corner opposite to its edge, on one facet.
const OPPOSITE: f64 = -0.2;

/// The contact faces of a body with middle nodes; nothing where there are none.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Trace {
    /// Corners with middle nodes about them, ascending by their nodes.
    corners: Vec<Corner>,
    /// Ascending by their nodes.
    middles: Vec<Middle>,
    facets: Vec<TraceFacet>,
}

/// A corner with the middle nodes in its weighted displacement.
#[derive(Debug, PartialEq)]
struct Corner {
    node: u32,
    /// Directions in which supports leave it free.
    free: Vec<[f64; 3]>,
    /// By their places among the middles, ascending.
    middles: Vec<u32>,
}

/// A middle node with the ends of its edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Middle {
    pub node: u32,
    pub ends: [u32; 2],
}

/// A facet: places of its corners and of the middles that follow them.
#[derive(Debug, PartialEq)]
struct TraceFacet {
    nodes: [u32; 3],
    corners: [u32; 3],
    middles: [Option<u32>; 3],
}

/// The weights d of a shape, per corner and middle node in its weighted displacement; also their changes and
/// sensitivities.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct TraceWeights(Vec<Vec<f64>>);

impl Trace {
    /// The trace of some faces of a mesh, for the directions in which supports hold a node and leave it free.
    pub(crate) fn new<'h>(
        mesh: &Mesh,
        faces: &[CellFace],
        held: impl Fn(u32) -> &'h [[f64; 3]],
        free: impl Fn(u32) -> Vec<[f64; 3]>,
    ) -> Self {
        Self::of(faces.iter().map(|&face| mesh.face_nodes(face).collect()).collect(), held, free)
    }

    /// The trace of facets with given nodes.
    fn of<'h>(
        nodes: BTreeSet<Vec<u32>>,
        held: impl Fn(u32) -> &'h [[f64; 3]],
        free: impl Fn(u32) -> Vec<[f64; 3]>,
    ) -> Self {
        let facets: Vec<&[u32]> = nodes.iter().map(Vec::as_slice).filter(|nodes| nodes.len() == 6).collect();
        let mut ends: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
        for nodes in &facets {
            for edge in 0..3 {
                let own = [nodes[edge], nodes[(edge + 1) % 3]];
                let is_held =
                    |end: u32| held(nodes[3 + edge]).iter().all(|&direction| beyond(held(end), direction).is_none());
                if own.into_iter().all(is_held) {
                    ends.insert(nodes[3 + edge], own);
                }
            }
        }
        let middles: Vec<Middle> = ends.into_iter().map(|(node, ends)| Middle { node, ends }).collect();
        let middle = |node: u32| middles.binary_search_by_key(&node, |middle| middle.node).ok().map(narrow);
        let mut about: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for nodes in &facets {
            let own: Vec<u32> = nodes[3..].iter().filter_map(|&node| middle(node)).collect();
            nodes[..3].iter().for_each(|&corner| about.entry(corner).or_default().extend(&own));
        }
        let corner = |(node, middles): (u32, BTreeSet<u32>)| Corner {
            node,
            free: free(node),
            middles: middles.into_iter().collect(),
        };
        let corners: Vec<Corner> = about.into_iter().map(corner).collect();
        let place = |node: u32| corners.partition_point(|corner| corner.node < node) as u32;
        let facet = |nodes: &&[u32]| TraceFacet {
            nodes: [nodes[0], nodes[1], nodes[2]],
            corners: [nodes[0], nodes[1], nodes[2]].map(place),
            middles: [nodes[3], nodes[4], nodes[5]].map(middle),
        };
        let facets = facets.iter().map(facet).collect();
        Self { corners, middles, facets }
    }

    /// Whether contact rows see the displacements of the nodes themselves.
    pub(crate) fn is_empty(&self) -> bool {
        self.middles.is_empty()
    }

    fn corner(&self, node: u32) -> Option<usize> {
        self.corners.binary_search_by_key(&node, |corner| corner.node).ok()
    }

    /// The corners with middle nodes about them.
    pub(crate) fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.corners.iter().map(|corner| corner.node)
    }

    /// The middle nodes in the weighted displacement of a node, with their weights d.
    pub(crate) fn terms<'a>(
        &'a self,
        weights: &'a TraceWeights,
        node: u32,
    ) -> impl Iterator<Item = (Middle, f64)> + 'a {
        let place = self.corner(node);
        place.into_iter().flat_map(move |place| {
            let middles = self.corners[place].middles.iter().map(|&middle| self.middles[middle as usize]);
            middles.zip(weights.0[place].iter().copied())
        })
    }

    /// The nodes in the weighted displacement of a node, ascending; at least the node itself.
    pub(crate) fn support(&self, node: u32) -> BTreeSet<u32> {
        let mut nodes = BTreeSet::from([node]);
        for &middle in self.corner(node).into_iter().flat_map(|place| &self.corners[place].middles) {
            let Middle { node, ends } = self.middles[middle as usize];
            nodes.extend([node, ends[0], ends[1]]);
        }
        nodes
    }

    /// P v of a node: the part of a vector along the directions in which its weighted displacement has middle nodes.
    pub(crate) fn projected(&self, node: u32, vector: [f64; 3]) -> [f64; 3] {
        self.corner(node).map_or(vector, |place| onto(&self.corners[place].free, vector))
    }

    /// Whether the displacement of a node in rows is its own alone.
    pub(crate) fn is_nodal(&self, node: u32) -> bool {
        self.corner(node).is_none_or(|place| self.corners[place].middles.is_empty())
    }

    /// The weights of a shape.
    pub(crate) fn weights(&self, positions: &[[f64; 3]]) -> TraceWeights {
        let (mut sums, whole) = self.sums(|facet| area(facet.nodes.map(|node| positions[node as usize])).0);
        for (own, whole) in sums.0.iter_mut().zip(&whole) {
            own.iter_mut().for_each(|weight| *weight /= whole);
        }
        sums
    }

    /// Σ c_f A_f per corner and middle, and Σ A_f per corner, for given areas of the facets.
    fn sums(&self, area: impl Fn(&TraceFacet) -> f64) -> (TraceWeights, Vec<f64>) {
        let mut sums: Vec<Vec<f64>> = self.corners.iter().map(|corner| vec![0.0; corner.middles.len()]).collect();
        let mut whole = vec![0.0; self.corners.len()];
        for facet in &self.facets {
            let area = area(facet);
            for (corner, &place) in facet.corners.iter().enumerate() {
                whole[place as usize] += area;
                for (term, factor) in self.terms_of(facet, corner) {
                    sums[place as usize][term] += factor * area;
                }
            }
        }
        (TraceWeights(sums), whole)
    }

    /// The terms of a corner of a facet that its middles are, with c.
    fn terms_of(&self, facet: &TraceFacet, corner: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = &self.corners[facet.corners[corner] as usize].middles;
        let term = move |(edge, middle): (usize, Option<u32>)| {
            let factor = if edge == (corner + 1) % 3 { OPPOSITE } else { ON_EDGE };
            Some((own.binary_search(&middle?).ok()?, factor))
        };
        facet.middles.into_iter().enumerate().filter_map(term)
    }

    /// The changes of the weights along velocities of the nodes.
    pub(crate) fn changes(
        &self,
        weights: &TraceWeights,
        positions: &[[f64; 3]],
        velocity: impl Fn(u32) -> [f64; 3],
    ) -> TraceWeights {
        let (_, whole) = self.sums(|facet| area(facet.nodes.map(|node| positions[node as usize])).0);
        let (mut changes, moved) = self.sums(|facet| {
            let slopes = area(facet.nodes.map(|node| positions[node as usize])).1;
            facet.nodes.iter().zip(slopes).map(|(&node, slope)| dot(slope, velocity(node))).sum()
        });
        for (((own, weights), whole), moved) in changes.0.iter_mut().zip(&weights.0).zip(whole).zip(moved) {
            own.iter_mut().zip(weights).for_each(|(change, weight)| *change = (*change - weight * moved) / whole);
        }
        changes
    }

    /// From sensitivities of the weights to those of the positions of nodes: `add(node, sensitivity)`.
    pub(crate) fn pull_back(
        &self,
        weights: &TraceWeights,
        positions: &[[f64; 3]],
        sensitivities: &TraceWeights,
        mut add: impl FnMut(u32, [f64; 3]),
    ) {
        let (_, whole) = self.sums(|facet| area(facet.nodes.map(|node| positions[node as usize])).0);
        let products = sensitivities.0.iter().zip(&weights.0);
        let by_whole: Vec<f64> = products.map(|(own, d)| own.iter().zip(d).map(|(s, d)| s * d).sum()).collect();
        for facet in &self.facets {
            let of_corner = |(corner, &place): (usize, &u32)| {
                let place = place as usize;
                let terms = self.terms_of(facet, corner).map(|(term, factor)| factor * sensitivities.0[place][term]);
                (terms.sum::<f64>() - by_whole[place]) / whole[place]
            };
            let by_area: f64 = facet.corners.iter().enumerate().map(of_corner).sum();
            let slopes = area(facet.nodes.map(|node| positions[node as usize])).1;
            facet.nodes.iter().zip(slopes).for_each(|(&node, slope)| add(node, slope.map(|s| by_area * s)));
        }
    }

    /// w of a node.
    pub(crate) fn value(&self, weights: &TraceWeights, node: u32, u: &impl Fn(u32) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        self.terms(weights, node).for_each(|(middle, weight)| sum = plus(sum, weight, middle.value(u)));
        plus(u(node), 1.0, self.projected(node, sum))
    }

    /// Adds what a force on w of a node is on the nodes: `add(node, force)`.
    pub(crate) fn spread(
        &self,
        weights: &TraceWeights,
        node: u32,
        force: [f64; 3],
        add: &mut impl FnMut(u32, [f64; 3]),
    ) {
        add(node, force);
        let part = self.projected(node, force);
        self.terms(weights, node).for_each(|(middle, weight)| middle.spread(part.map(|f| weight * f), add));
    }

    /// The displacements along one direction whose w is 1 at a node and 0 at all other corners: `add(node, value)`.
    pub(crate) fn hat(&self, node: u32, mut add: impl FnMut(u32, f64)) {
        add(node, 1.0);
        let middles = self.corner(node).into_iter().flat_map(|place| &self.corners[place].middles);
        let middles = middles.map(|&middle| self.middles[middle as usize]);
        middles.filter(|middle| middle.ends.contains(&node)).for_each(|middle| add(middle.node, 0.5));
    }

    /// As [`spread`](Self::spread) for numbers in place of forces, without regard to supports.
    pub(crate) fn spread_scalar(&self, weights: &TraceWeights, node: u32, number: f64, add: &mut impl FnMut(u32, f64)) {
        add(node, number);
        for (middle, weight) in self.terms(weights, node) {
            add(middle.node, weight * number);
            middle.ends.into_iter().for_each(|end| add(end, -0.5 * weight * number));
        }
    }

    /// The place that a force on w of a node acts at: Σ of the positions of its nodes, weighted as displacements.
    pub(crate) fn place(&self, weights: &TraceWeights, node: u32, positions: &[[f64; 3]]) -> [f64; 3] {
        let position = |node: u32| positions[node as usize];
        let terms = self.terms(weights, node);
        terms.fold(position(node), |place, (middle, weight)| plus(place, weight, middle.value(&position)))
    }

    /// Numbers per corner and middle, computed from the node of the corner and the middle.
    pub(crate) fn map(&self, value: impl Fn(u32, Middle) -> f64) -> TraceWeights {
        let of_corner = |corner: &Corner| {
            corner.middles.iter().map(|&middle| value(corner.node, self.middles[middle as usize])).collect()
        };
        TraceWeights(self.corners.iter().map(of_corner).collect())
    }
}

impl Middle {
    /// û of a vector field.
    pub(crate) fn value(self, u: &impl Fn(u32) -> [f64; 3]) -> [f64; 3] {
        let (own, [a, b]) = (u(self.node), self.ends.map(u));
        std::array::from_fn(|axis| own[axis] - 0.5 * (a[axis] + b[axis]))
    }

    /// What a force on û is on the nodes.
    pub(crate) fn spread(self, force: [f64; 3], add: &mut impl FnMut(u32, [f64; 3])) {
        add(self.node, force);
        self.ends.into_iter().for_each(|end| add(end, force.map(|f| -0.5 * f)));
    }
}

/// The area of a triangle, and its derivatives by the corners.
fn area([x, y, z]: [[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
    let (first, second) = (plus(y, -1.0, x), plus(z, -1.0, x));
    let normal = cross(first, second);
    let size = length(normal);
    let half = normal.map(|n| 0.5 * n / size);
    let (of_second, of_third) = (cross(second, half), cross(half, first));
    let of_first = std::array::from_fn(|axis| -of_second[axis] - of_third[axis]);
    (0.5 * size, [of_first, of_second, of_third])
}

#[cfg(test)]
mod tests {
    use super::*;
    use testset::kit::Random;

    const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// Three facets about node 0; supports hold nodes 2 and 3 and the middle node 8 between them along x₁, and the
    /// middle node 9 between 0 and 3 along x₂.
    fn trace() -> Trace {
        let facets = [[0, 1, 2, 5, 6, 7], [0, 2, 3, 7, 8, 9], [0, 3, 4, 9, 10, 11]];
        let held = |node: u32| -> &'static [[f64; 3]] {
            match node {
                2 | 3 | 8 => &AXES[..1],
                9 => &AXES[1..2],
                _ => &[],
            }
        };
        let free = |node: u32| if [2, 3].contains(&node) { AXES[1..].to_vec() } else { AXES.to_vec() };
        Trace::of(facets.into_iter().map(|nodes| nodes.to_vec()).collect(), held, free)
    }

    fn places(random: &mut Random) -> Vec<[f64; 3]> {
        (0..12).map(|_| std::array::from_fn(|_| random.signed())).collect()
    }

    #[test]
    fn linear_displacements_are_those_of_the_corners() {
        let (trace, mut random) = (trace(), Random(3));
        let (positions, corners) = (places(&mut random), places(&mut random));
        let weights = trace.weights(&positions);
        let mut u = corners.clone();
        for middle in &trace.middles {
            let [a, b] = middle.ends.map(|end| corners[end as usize]);
            u[middle.node as usize] = std::array::from_fn(|axis| 0.5 * (a[axis] + b[axis]));
        }
        for corner in trace.corners() {
            let own = trace.value(&weights, corner, &|node| u[node as usize]);
            assert!((0..3).all(|axis| (own[axis] - corners[corner as usize][axis]).abs() < 1e-15));
        }
        // A support holds the middle node 9, but not the ends of its edge.
        let is_middle = |node: u32| trace.middles.iter().any(|middle| middle.node == node);
        assert!(!is_middle(9) && is_middle(8));
    }

    /// On one facet: ∫ψ N/∫ψ = 3/5, 3/5, −1/5 for ψ = 4λ − 1 and N = 4λ_a λ_b.
    #[test]
    fn forces_do_the_work_of_displacements() {
        let (trace, mut random) = (trace(), Random(5));
        let positions = places(&mut random);
        let weights = trace.weights(&positions);
        let terms = trace.terms(&weights, 1).map(|(_, d)| d).zip([0.6, 0.6, -0.2]);
        terms.for_each(|(d, expected)| assert!((d - expected).abs() < 1e-15, "{d}"));
        let (u, force) = (places(&mut random), places(&mut random)[0]);
        for corner in trace.corners() {
            let own = trace.value(&weights, corner, &|node| u[node as usize]);
            let mut work = dot(own, force);
            trace.spread(&weights, corner, force, &mut |node, share| work -= dot(u[node as usize], share));
            assert!(work.abs() < 1e-14, "{work}");
        }
    }

    #[test]
    fn changes_are_differences_and_the_pull_back_is_their_transpose() {
        let (trace, mut random) = (trace(), Random(7));
        let (positions, velocities) = (places(&mut random), places(&mut random));
        let weights = trace.weights(&positions);
        let at = |s: f64| {
            let moved = positions.iter().zip(&velocities);
            let moved: Vec<[f64; 3]> = moved.map(|(x, v)| std::array::from_fn(|axis| x[axis] + s * v[axis])).collect();
            trace.weights(&moved)
        };
        let changes = trace.changes(&weights, &positions, |node| velocities[node as usize]);
        let step = 1e-5;
        let (ahead, behind) = (at(step), at(-step));
        let by = trace.map(|corner, middle| (f64::from(corner) + 2.0 * f64::from(middle.node)).sin());
        let mut sum = 0.0;
        for (((ahead, behind), changes), by) in ahead.0.iter().zip(&behind.0).zip(&changes.0).zip(&by.0) {
            for (((ahead, behind), change), by) in ahead.iter().zip(behind).zip(changes).zip(by) {
                assert!(((ahead - behind) / (2.0 * step) - change).abs() < 1e-8, "{change}");
                sum += change * by;
            }
        }
        let mut pulled = 0.0;
        trace.pull_back(&weights, &positions, &by, |node, own| pulled += dot(own, velocities[node as usize]));
        assert!((pulled - sum).abs() < 1e-13 * sum.abs().max(1.0), "{pulled} {sum}");
    }
}
