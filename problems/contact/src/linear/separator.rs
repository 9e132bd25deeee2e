//! Small separators of a graph of points in space.
//!
//! ```text
//! halves along directions and along distances in the graph ─ boundary of a half ─ refined by moves ─ the smallest one
//! move of v from the separator S to a side:   S ← S \ {v} ∪ {neighbours of v on the other side}
//! ```
//! Moves are made in the order of their gain, each point once, past worse separators; the best one on the way is kept
//! (Fiduccia and Mattheyses). Coordinates that differ by rounding are equal, so that planes of a grid stay together.

use crate::linear::parallel;
use std::collections::{BinaryHeap, VecDeque};

/// Where a point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    One,
    Other,
    Separator,
}

/// Largest share of the points that a side may have.
const LARGEST_SHARE: f64 = 0.6;
/// Weight of unequal sides in the cost of a separator.
const UNEQUAL: f64 = 1.2;
/// Passes of moves.
const PASSES: usize = 8;
/// Parts of fewer points are halved along the axes alone.
const SMALL: usize = 300;
/// Parts of at least so many points are worth several threads.
const LARGE: usize = 3000;
/// Moves without a better separator after which a pass ends: a share of the points, within limits.
const PATIENCE: [usize; 3] = [20, 60, 400];
/// Directions of the halves, along the axes first.
const DIRECTIONS: [[f64; 3]; 9] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
];

/// The edges among some points, by their places.
#[derive(Debug)]
pub(super) struct LocalGraph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl LocalGraph {
    /// The edges of a graph among some of its points.
    pub(super) fn induced(graph: &[Vec<u32>], points: &[u32]) -> Self {
        Self::of(graph.len(), points, |point| &graph[point as usize])
    }

    /// The edges among some of its points.
    pub(super) fn part(&self, points: &[u32]) -> Self {
        Self::of(self.len(), points, |point| self.of_point(point))
    }

    fn of<'g>(count: usize, points: &[u32], neighbours: impl Fn(u32) -> &'g [u32]) -> Self {
        let mut places = vec![u32::MAX; count];
        points.iter().zip(0..).for_each(|(&point, place)| places[point as usize] = place);
        let mut found = Self { starts: vec![0], neighbours: Vec::new() };
        for &point in points {
            let own = neighbours(point).iter().map(|&other| places[other as usize]);
            found.neighbours.extend(own.filter(|&place| place != u32::MAX));
            found.starts.push(found.neighbours.len() as u32);
        }
        found
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn of_point(&self, point: u32) -> &[u32] {
        &self.neighbours[self.starts[point as usize] as usize..self.starts[point as usize + 1] as usize]
    }

    /// The points that hang together, part by part, each ascending.
    pub(super) fn components(&self) -> Vec<Vec<u32>> {
        let mut number = vec![usize::MAX; self.len()];
        let mut count = 0;
        for first in 0..self.len() as u32 {
            if number[first as usize] != usize::MAX {
                continue;
            }
            number[first as usize] = count;
            let mut open = vec![first];
            while let Some(point) = open.pop() {
                for &other in self.of_point(point) {
                    if number[other as usize] == usize::MAX {
                        number[other as usize] = count;
                        open.push(other);
                    }
                }
            }
            count += 1;
        }
        let mut parts = vec![Vec::new(); count];
        number.iter().zip(0..).for_each(|(&number, point)| parts[number].push(point));
        parts
    }

    /// Numbers of edges from a point.
    fn distances(&self, from: u32) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; self.len()];
        distances[from as usize] = 0.0;
        let mut open = VecDeque::from([from]);
        while let Some(point) = open.pop_front() {
            for &other in self.of_point(point) {
                if distances[other as usize].is_infinite() {
                    distances[other as usize] = distances[point as usize] + 1.0;
                    open.push_back(other);
                }
            }
        }
        distances
    }

    /// Distances from a point at the rim, and their differences from those of the point opposite.
    fn levels(&self) -> [Vec<f64>; 2] {
        let farthest = |distances: &[f64]| {
            (0..distances.len()).fold(0, |far, point| if distances[point] > distances[far] { point } else { far })
                as u32
        };
        let first = self.distances(farthest(&self.distances(0)));
        let second = self.distances(farthest(&first));
        let differences = first.iter().zip(&second).map(|(first, second)| first - second).collect();
        [second, differences]
    }
}

/// The sides of a separator of a connected graph; a side is empty where nothing is separated.
pub(super) fn separated(graph: &LocalGraph, points: &[[f64; 3]]) -> Vec<Side> {
    let is_small = points.len() < SMALL;
    let directions = if is_small { &DIRECTIONS[..3] } else { &DIRECTIONS[..] };
    let levels = if is_small { Vec::new() } else { graph.levels().to_vec() };
    let count = directions.len() + levels.len();
    let candidate = |index: usize| {
        let keys = directions.get(index).map(|&direction| along(points, direction));
        let keys = keys.as_ref().unwrap_or_else(|| &levels[index - directions.len()]);
        let mut separator = Separator::new(graph, halves(graph, keys));
        separator.refine();
        separator
    };
    let found =
        if points.len() >= LARGE { parallel::map(count, &candidate) } else { (0..count).map(candidate).collect() };
    let best = found.into_iter().reduce(|best, next| if next.cost() < best.cost() { next } else { best });
    best.map_or_else(Vec::new, |best| best.sides)
}

/// Coordinates along a direction, in billionths of the extent.
fn along(points: &[[f64; 3]], direction: [f64; 3]) -> Vec<f64> {
    let coordinates = points.iter().map(|point| point.iter().zip(direction).map(|(x, d)| x * d).sum::<f64>());
    let coordinates: Vec<f64> = coordinates.collect();
    let lowest = coordinates.iter().copied().fold(f64::INFINITY, f64::min);
    let length = coordinates.iter().copied().fold(f64::NEG_INFINITY, f64::max) - lowest;
    let scale = if length > 0.0 { 1e9 / length } else { 0.0 };
    coordinates.into_iter().map(|x| ((x - lowest) * scale).round()).collect()
}

/// The points before the median and those from it on, with the smaller boundary as separator.
fn halves(graph: &LocalGraph, keys: &[f64]) -> Vec<Side> {
    let mut sorted = keys.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let is_before = |key: f64| if sorted[0] < median { key < median } else { key <= median };
    let mut sides: Vec<Side> = keys.iter().map(|&key| if is_before(key) { Side::One } else { Side::Other }).collect();
    let boundary = |own: Side, opposite: Side| -> Vec<u32> {
        let touches = |&point: &u32| {
            sides[point as usize] == own && graph.of_point(point).iter().any(|&other| sides[other as usize] == opposite)
        };
        (0..sides.len() as u32).filter(touches).collect()
    };
    let [before, behind] = [boundary(Side::One, Side::Other), boundary(Side::Other, Side::One)];
    let separator = if before.len() < behind.len() { before } else { behind };
    separator.into_iter().for_each(|point| sides[point as usize] = Side::Separator);
    sides
}

/// A separator that is being refined.
struct Separator<'a> {
    graph: &'a LocalGraph,
    sides: Vec<Side>,
    /// Points on each side, and of the separator.
    counts: [usize; 3],
}

/// A move with its gain: points that leave the separator less those that enter it. Ties go to the larger number.
type Move = (i64, u32, Side);

impl<'a> Separator<'a> {
    fn new(graph: &'a LocalGraph, sides: Vec<Side>) -> Self {
        let mut counts = [0; 3];
        sides.iter().for_each(|side| counts[*side as usize] += 1);
        Self { graph, sides, counts }
    }

    /// The size of the separator, more for unequal sides; infinite for sides beyond the largest share.
    fn cost(&self) -> f64 {
        let [one, other, separator] = self.counts;
        let share = one.max(other) as f64 / self.sides.len() as f64;
        if share > LARGEST_SHARE || one == 0 || other == 0 {
            return f64::INFINITY;
        }
        separator as f64 * (1.0 + UNEQUAL * (share - 0.5).powi(2))
    }

    fn gain(&self, point: u32, to: Side) -> i64 {
        let enters = |&&other: &&u32| self.sides[other as usize] == opposite(to);
        1 - self.graph.of_point(point).iter().filter(enters).count() as i64
    }

    fn set(&mut self, point: u32, side: Side) -> Side {
        let before = std::mem::replace(&mut self.sides[point as usize], side);
        self.counts[before as usize] -= 1;
        self.counts[side as usize] += 1;
        before
    }

    /// Passes of moves until one brings nothing.
    fn refine(&mut self) {
        for _pass in 0..PASSES {
            let before = self.cost();
            self.pass();
            if self.cost() >= before {
                break;
            }
        }
    }

    /// One pass of moves; ends at the best separator on its way.
    fn pass(&mut self) {
        let mut moved = vec![false; self.sides.len()];
        let mut moves: BinaryHeap<Move> = BinaryHeap::new();
        for point in (0..self.sides.len() as u32).filter(|&point| self.sides[point as usize] == Side::Separator) {
            moves.extend([Side::One, Side::Other].map(|to| (self.gain(point, to), point, to)));
        }
        // What changed, with the side before; the best separator is the one after so many changes.
        let (mut log, mut best, mut kept, mut since): (Vec<(u32, Side)>, _, _, _) = (Vec::new(), self.cost(), 0, 0);
        let [share, least, most] = PATIENCE;
        let patience = (self.sides.len() / share).clamp(least, most);
        while let Some((gain, point, to)) = moves.pop() {
            if self.sides[point as usize] != Side::Separator || moved[point as usize] {
                continue;
            }
            let now = self.gain(point, to);
            if now != gain {
                if now < gain {
                    moves.push((now, point, to));
                }
                continue;
            }
            if self.overfills(to) {
                continue;
            }
            self.make((point, to), &mut moved, &mut moves, &mut log);
            let cost = self.cost();
            (best, kept, since) = if cost < best { (cost, log.len(), 0) } else { (best, kept, since + 1) };
            if since > patience {
                break;
            }
        }
        for (point, side) in log.drain(kept..).rev() {
            self.set(point, side);
        }
    }

    /// Whether one more point makes a side larger than allowed.
    fn overfills(&self, to: Side) -> bool {
        let own = self.counts[to as usize];
        (own + 1) as f64 > LARGEST_SHARE * self.sides.len() as f64 && own >= self.counts[opposite(to) as usize]
    }

    /// Moves a point out of the separator, and its neighbours on the other side into it.
    fn make(
        &mut self,
        (point, to): (u32, Side),
        moved: &mut [bool],
        moves: &mut BinaryHeap<Move>,
        log: &mut Vec<(u32, Side)>,
    ) {
        log.push((point, self.set(point, to)));
        moved[point as usize] = true;
        for &other in self.graph.of_point(point) {
            if self.sides[other as usize] != opposite(to) {
                continue;
            }
            log.push((other, self.set(other, Side::Separator)));
            if !moved[other as usize] {
                moves.extend([Side::One, Side::Other].map(|to| (self.gain(other, to), other, to)));
            }
            for &near in self.graph.of_point(other) {
                if self.sides[near as usize] == Side::Separator && !moved[near as usize] {
                    moves.push((self.gain(near, to), near, to));
                }
            }
        }
    }
}

/// The other side.
fn opposite(side: Side) -> Side {
    if side == Side::One { Side::Other } else { Side::One }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use testset::kit::Random;

    /// A ring of points with random chords.
    fn ring(count: u32, chords: u32, seed: u64) -> Vec<Vec<u32>> {
        let mut random = Random(seed);
        let mut graph = vec![Vec::new(); count as usize];
        let mut join = |a: u32, b: u32| {
            if a != b && !graph[a as usize].contains(&b) {
                graph[a as usize].push(b);
                graph[b as usize].push(a);
            }
        };
        (0..count).for_each(|point| join(point, (point + 1) % count));
        for _chord in 0..chords {
            let [a, b] = [(); 2].map(|()| ((random.signed() + 1.0) * 0.5 * f64::from(count)) as u32 % count);
            join(a, b);
        }
        graph
    }

    proptest! {
        #[test]
        fn no_edge_joins_the_sides(count in 3_u32..400, chords in 0_u32..60, seed in 1_u64..1000) {
            let graph = ring(count, chords, seed);
            let all: Vec<u32> = (0..count).collect();
            let graph = LocalGraph::induced(&graph, &all);
            let mut random = Random(seed + 1);
            let points: Vec<[f64; 3]> =
                (0..count).map(|_| std::array::from_fn(|_| random.signed())).collect();
            let sides = separated(&graph, &points);
            for point in 0..count {
                for &other in graph.of_point(point) {
                    let pair = [sides[point as usize], sides[other as usize]];
                    prop_assert!(!(pair.contains(&Side::One) && pair.contains(&Side::Other)));
                }
            }
        }
    }

    #[test]
    fn a_ring_is_cut_at_two_points() {
        let graph = ring(40, 0, 1);
        let graph = LocalGraph::induced(&graph, &(0..40).collect::<Vec<u32>>());
        let angle = |point: u32| f64::from(point) * std::f64::consts::TAU / 40.0;
        let points: Vec<[f64; 3]> = (0..40).map(|point| [angle(point).cos(), angle(point).sin(), 0.0]).collect();
        let sides = separated(&graph, &points);
        assert_eq!(sides.iter().filter(|side| **side == Side::Separator).count(), 2);
        assert!(sides.iter().filter(|side| **side == Side::One).count().abs_diff(19) <= 5);
    }
}
