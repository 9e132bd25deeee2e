//! Nested dissection of a graph of points in space, in elimination order.
//!
//! ```text
//! part = one side, other side, separator (no edge joins the sides)        order: one side, other side, separator
//! ```
//! The order is a postorder of its elimination tree, which the factorisation relies on when trailing unknowns must stay
//! last.

use crate::linear::parallel::join;
use crate::linear::separator::{LocalGraph, Side, separated};

/// Neighbours of every point, each without itself.
pub type Graph = [Vec<u32>];

/// Parts of up to this many points are eliminated in the order of their numbers.
const LEAF: usize = 8;
/// Parts of at least so many points are worth a second thread.
const WORTH_A_THREAD: usize = 500;

/// The points in nested dissection order, with those of `last` (each once) at the end, in their order.
pub fn nested_dissection(points: &[[f64; 3]], graph: &Graph, last: &[usize]) -> Vec<usize> {
    let mut is_last = vec![false; points.len()];
    last.iter().for_each(|&point| is_last[point] = true);
    let free: Vec<u32> = (0..points.len() as u32).filter(|&point| !is_last[point as usize]).collect();
    let part = Dissected { graph: LocalGraph::induced(graph, &free), points: free };
    let mut order: Vec<usize> = part.dissect(points).into_iter().map(|point| point as usize).collect();
    order.extend(last);
    postordered(graph, order, last.len())
}

/// The axis along which points extend most; of extents that differ by rounding, the first.
pub fn longest_axis(points: impl Iterator<Item = [f64; 3]>) -> usize {
    let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for point in points {
        for (extent, x) in extent.iter_mut().zip(point) {
            *extent = [extent[0].min(x), extent[1].max(x)];
        }
    }
    let length = |axis: usize| extent[axis][1] - extent[axis][0];
    (1..3).fold(0, |best, axis| if length(axis) > length(best) * (1.0 + 1e-9) { axis } else { best })
}

/// Points that are dissected, ascending, and the edges between them by their places among the points.
struct Dissected {
    points: Vec<u32>,
    graph: LocalGraph,
}

impl Dissected {
    /// The points in elimination order.
    fn dissect(self, places: &[[f64; 3]]) -> Vec<u32> {
        if self.points.len() <= LEAF {
            return self.points;
        }
        let parts = self.graph.components();
        if parts.len() > 1 {
            return parts.iter().flat_map(|part| self.part(part).dissect(places)).collect();
        }
        let own: Vec<[f64; 3]> = self.points.iter().map(|&point| places[point as usize]).collect();
        let sides = separated(&self.graph, &own);
        let on = |side: Side| -> Vec<u32> {
            (0..self.points.len() as u32).filter(|&place| sides[place as usize] == side).collect()
        };
        let [one, other] = [on(Side::One), on(Side::Other)];
        if one.is_empty() || other.is_empty() {
            // Nothing is separated.
            return self.points;
        }
        let separator = on(Side::Separator).into_iter().map(|place| self.points[place as usize]);
        let separator: Vec<u32> = separator.collect();
        let is_large = self.points.len() >= WORTH_A_THREAD;
        let (one, other) = (self.part(&one), self.part(&other));
        drop(self);
        let (mut order, other) = join(is_large, || one.dissect(places), || other.dissect(places));
        order.extend(other);
        order.extend(separator);
        order
    }

    /// The part of some points, given by their places, ascending.
    fn part(&self, places: &[u32]) -> Self {
        let points = places.iter().map(|&place| self.points[place as usize]).collect();
        Self { points, graph: self.graph.part(places) }
    }
}

/// An order with the same fill that is a postorder of its elimination tree; the last `kept` points stay in their
/// places.
fn postordered(graph: &Graph, order: Vec<usize>, kept: usize) -> Vec<usize> {
    let count = order.len();
    let mut place = vec![0; count];
    order.iter().enumerate().for_each(|(index, &point)| place[point] = index);
    // Elimination tree by Liu's algorithm with path compression.
    let (mut parent, mut ancestor) = (vec![usize::MAX; count], vec![usize::MAX; count]);
    for column in 0..count {
        for &neighbour in &graph[order[column]] {
            let mut node = place[neighbour as usize];
            while node < column {
                let next = std::mem::replace(&mut ancestor[node], column);
                if next == usize::MAX {
                    parent[node] = column;
                    break;
                }
                if next == column {
                    break;
                }
                node = next;
            }
        }
    }
    let mut children = vec![Vec::new(); count];
    let mut roots = Vec::new();
    let fixed = count - kept;
    for node in (0..count).rev() {
        match parent[node] {
            usize::MAX => roots.push(node),
            parent => children[parent].push(node),
        }
    }
    let mut result = Vec::with_capacity(count);
    let mut stack: Vec<(usize, bool)> = roots.into_iter().map(|root| (root, false)).collect();
    while let Some((node, seen)) = stack.pop() {
        if seen {
            if node < fixed {
                result.push(order[node]);
            }
            continue;
        }
        stack.push((node, true));
        stack.extend(children[node].iter().map(|&child| (child, false)));
    }
    result.extend(&order[fixed..]);
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Points of a grid, all neighbours within one step.
    fn grid(counts: [usize; 3]) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
        let index = |[i, j, k]: [usize; 3]| (i * counts[1] + j) * counts[2] + k;
        let all: Vec<[usize; 3]> = (0..counts.iter().product())
            .map(|n| [n / (counts[1] * counts[2]), n / counts[2] % counts[1], n % counts[2]])
            .collect();
        let near = |a: &[usize; 3], b: &[usize; 3]| a != b && (0..3).all(|axis| a[axis].abs_diff(b[axis]) <= 1);
        let graph = all.iter().map(|a| all.iter().filter(|b| near(a, b)).map(|b| index(*b) as u32).collect());
        (all.iter().map(|x| x.map(|x| x as f64)).collect(), graph.collect())
    }

    #[test]
    fn every_point_appears_once() {
        for counts in [[1, 1, 1], [2, 3, 4], [8, 8, 8], [37, 2, 5]] {
            let (points, graph) = grid(counts);
            let mut order = nested_dissection(&points, &graph, &[]);
            order.sort_unstable();
            assert_eq!(order, (0..points.len()).collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_last_separator_of_a_grid_is_a_plane() {
        let (points, graph) = grid([9, 4, 4]);
        let order = nested_dissection(&points, &graph, &[]);
        assert!(order[9 * 16 - 16..].iter().all(|&point| points[point][0] == 4.0));
    }

    proptest! {
        #[test]
        fn orders_are_postorders_and_keep_the_last_points(
            counts in prop::array::uniform3(1_usize..6), shift in 0_usize..50,
        ) {
            let (points, mut graph) = grid(counts);
            let count = points.len();
            let last: Vec<usize> = (0..count.min(3)).map(|index| (index * 7 + shift) % count).collect();
            let once = |(index, point): &(usize, &usize)| !last[..*index].contains(point);
            let last: Vec<usize> = last.iter().enumerate().filter(once).map(|(_, point)| *point).collect();
            // The last points form a chain, as those of a factorisation do.
            for pair in last.windows(2) {
                graph[pair[0]].push(pair[1] as u32);
                graph[pair[1]].push(pair[0] as u32);
            }
            let order = nested_dissection(&points, &graph, &last);
            prop_assert_eq!(&order[count - last.len()..], &last[..]);
            // A second postorder changes nothing.
            prop_assert_eq!(postordered(&graph, order.clone(), last.len()), order);
        }
    }
}
