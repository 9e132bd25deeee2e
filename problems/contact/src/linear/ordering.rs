//! Nested dissection of a graph of points in space, in elimination order.
//!
//! ```text
//! points are split at the median along their longest extent: those before it, those from it on;
//! separator: points from the median on that have a neighbour before it       order: before, behind, separator
//! ```
//! On a grid, separators are planes. The order is a postorder of its elimination tree, which the factorisation relies
//! on when trailing unknowns must stay last.

/// Neighbours of every point, each without itself.
pub type Graph = [Vec<u32>];

/// Parts of up to this many points are eliminated in the order of their numbers.
const LEAF: usize = 8;

/// The points in nested dissection order, with those of `last` (each once) at the end, in their order.
pub fn nested_dissection(points: &[[f64; 3]], graph: &Graph, last: &[usize]) -> Vec<usize> {
    let mut side = vec![0_u32; points.len()];
    last.iter().for_each(|&point| side[point] = u32::MAX);
    let free: Vec<u32> = (0..points.len() as u32).filter(|&point| side[point as usize] == 0).collect();
    let mut order = Vec::with_capacity(points.len());
    let mut dissection = Dissection { points, graph, side, parts: 0 };
    dissection.part(free, &mut order);
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

/// The state of a dissection: `side` marks the points before the median by the number of their part.
struct Dissection<'a> {
    points: &'a [[f64; 3]],
    graph: &'a Graph,
    side: Vec<u32>,
    parts: u32,
}

impl Dissection<'_> {
    /// Appends the points of a part in elimination order.
    fn part(&mut self, mut part: Vec<u32>, order: &mut Vec<usize>) {
        let points = self.points;
        let axis = longest_axis(part.iter().map(|&point| points[point as usize]));
        let along = || part.iter().map(|&point| points[point as usize][axis]);
        let lowest = along().fold(f64::INFINITY, f64::min);
        let length = along().fold(f64::NEG_INFINITY, f64::max) - lowest;
        // Coordinates that differ by rounding are equal: planes of a grid stay together.
        let key = |point: u32| ((points[point as usize][axis] - lowest) / length * 1e9).round();
        if part.len() <= LEAF || length <= 0.0 {
            part.sort_unstable();
            return order.extend(part.iter().map(|&point| point as usize));
        }
        part.sort_unstable_by(|&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
        let median = key(part[part.len() / 2]);
        let first = part.partition_point(|&point| key(point) < median);
        self.parts += 1;
        let number = self.parts;
        part[..first].iter().for_each(|&point| self.side[point as usize] = number);
        let touches =
            |point: &u32| self.graph[*point as usize].iter().any(|&other| self.side[other as usize] == number);
        let (mut separator, behind): (Vec<u32>, Vec<u32>) = part.split_off(first).into_iter().partition(touches);
        if part.is_empty() || behind.is_empty() {
            // Nothing is separated: the part is thin along every axis.
            part.extend(behind);
            part.extend(separator);
            part.sort_unstable();
            return order.extend(part.iter().map(|&point| point as usize));
        }
        self.part(part, order);
        self.part(behind, order);
        separator.sort_unstable();
        order.extend(separator.into_iter().map(|point| point as usize));
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
