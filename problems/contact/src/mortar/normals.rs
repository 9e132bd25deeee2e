//! Vector areas of the nodes of a surface and their derivatives.
//!
//! ```text
//! N_i = Σ_facets ∫ N_i (a × b),   n_i = N_i/|N_i|,   n_i′ = (I − n_i n_iᵀ) N_i′/|N_i|
//! ```

use super::facet::{Local, Patch};
use super::planar::CORNERS;
use super::vector::{cross, dot, length, plus};

/// A point of a rule over a facet: weighted shape functions, and slopes of the shape functions along ξ and η.
struct RulePoint {
    weighted: [f64; 4],
    slopes: [[f64; 2]; 4],
}

fn quadrilateral(corner: usize) -> RulePoint {
    let [xi, eta] = CORNERS[corner].map(|s| s / 3.0_f64.sqrt());
    RulePoint {
        weighted: CORNERS.map(|[s, t]| (1.0 + s * xi) * (1.0 + t * eta) / 4.0),
        slopes: CORNERS.map(|[s, t]| [s * (1.0 + t * eta) / 4.0, t * (1.0 + s * xi) / 4.0]),
    }
}

/// The integral over a flat triangle: a third of its area at each corner.
const TRIANGLE: RulePoint = RulePoint {
    weighted: [1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 0.0],
    slopes: [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]],
};

fn rule(facet: &Local) -> Vec<RulePoint> {
    if facet.corners().len() == 4 { (0..4).map(quadrilateral).collect() } else { vec![TRIANGLE] }
}

impl RulePoint {
    /// ∂/∂ξ and ∂/∂η of a field with these values at the corners.
    fn tangents(&self, corners: &[[f64; 3]; 4]) -> [[f64; 3]; 2] {
        [0, 1].map(|k| (0..4).fold([0.0; 3], |sum, v| plus(sum, self.slopes[v][k], corners[v])))
    }
}

/// The vector areas N_i.
pub fn vector_areas(patch: &Patch) -> Vec<[f64; 3]> {
    let mut areas = vec![[0.0; 3]; patch.nodes.len()];
    for facet in &patch.facets {
        let corners = facet.pick(&patch.positions);
        for point in rule(facet) {
            let [a, b] = point.tangents(&corners);
            for (&node, &factor) in facet.corners().iter().zip(&point.weighted) {
                areas[node] = plus(areas[node], factor, cross(a, b));
            }
        }
    }
    areas
}

/// Unit vectors along the vector areas; zero where there is none.
pub fn unit(area: [f64; 3]) -> [f64; 3] {
    let size = length(area);
    if size > 0.0 { area.map(|component| component / size) } else { [0.0; 3] }
}

/// (I − n nᵀ) v/|N|: the derivative of the unit vector, which is its own transpose.
pub fn turned(area: [f64; 3], change: [f64; 3]) -> [f64; 3] {
    let (size, normal) = (length(area), unit(area));
    if size > 0.0 { plus(change, -dot(normal, change), normal).map(|component| component / size) } else { [0.0; 3] }
}

/// Changes of the normals for velocities of the nodes.
pub fn changes(patch: &Patch, areas: &[[f64; 3]], velocities: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; areas.len()];
    for facet in &patch.facets {
        let (corners, moved) = (facet.pick(&patch.positions), facet.pick(velocities));
        if moved == [[0.0; 3]; 4] {
            continue;
        }
        for point in rule(facet) {
            let ([a, b], [da, db]) = (point.tangents(&corners), point.tangents(&moved));
            let change = plus(cross(da, b), 1.0, cross(a, db));
            for (&node, &factor) in facet.corners().iter().zip(&point.weighted) {
                sums[node] = plus(sums[node], factor, change);
            }
        }
    }
    areas.iter().zip(sums).map(|(&area, change)| turned(area, change)).collect()
}

/// Transpose of [`changes`]: add the sensitivities to the positions.
pub fn pull_back(patch: &Patch, areas: &[[f64; 3]], normals: &[[f64; 3]], positions: &mut [[f64; 3]]) {
    let forces: Vec<_> = areas.iter().zip(normals).map(|(&area, &normal)| turned(area, normal)).collect();
    for facet in &patch.facets {
        let corners = facet.pick(&patch.positions);
        for point in rule(facet) {
            let [a, b] = point.tangents(&corners);
            let weights = facet.corners().iter().zip(&point.weighted);
            let force = weights.fold([0.0; 3], |sum, (&node, &factor)| plus(sum, factor, forces[node]));
            let (by_a, by_b) = (cross(b, force), cross(force, a));
            for (&node, slopes) in facet.corners().iter().zip(&point.slopes) {
                positions[node] = plus(plus(positions[node], slopes[0], by_a), slopes[1], by_b);
            }
        }
    }
}
