//! Parts of a face within which its surface has a tangent plane everywhere.

use crate::mortar::vector::{dot, length};
use crate::mortar::{Facet, doubled_area};
use std::collections::HashMap;

/// Facets that meet at more than 30° do not belong to one smooth surface.
const SMOOTH: f64 = 0.866_025_403_784_438_6;

/// The part of every facet, numbered from zero, and their number.
pub(crate) fn smooth_parts(facets: &[Facet], normals: &[[f64; 3]]) -> (Vec<usize>, usize) {
    let mut by_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    for (number, facet) in facets.iter().enumerate() {
        edges(facet).for_each(|edge| by_edge.entry(edge).or_default().push(number));
    }
    let mut neighbours = vec![Vec::new(); facets.len()];
    for pair in by_edge.values() {
        if let [a, b] = pair[..]
            && dot(normals[a], normals[b]) >= SMOOTH
        {
            neighbours[a].push(b);
            neighbours[b].push(a);
        }
    }
    let (mut part, mut count) = (vec![usize::MAX; facets.len()], 0);
    for first in 0..facets.len() {
        if part[first] != usize::MAX {
            continue;
        }
        let mut open = vec![first];
        part[first] = count;
        while let Some(facet) = open.pop() {
            for &next in &neighbours[facet] {
                if part[next] == usize::MAX {
                    part[next] = count;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    (part, count)
}

/// The edges of a facet, each with its smaller node first.
pub(crate) fn edges(facet: &Facet) -> impl Iterator<Item = [u32; 2]> + '_ {
    let corners = facet.corners();
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)])
}

/// The unit normal of a facet, zero where it has no area.
pub(crate) fn normal(corners: &[[f64; 3]]) -> [f64; 3] {
    let area = doubled_area(corners);
    let size = length(area);
    if size > 0.0 { area.map(|x| x / size) } else { [0.0; 3] }
}
