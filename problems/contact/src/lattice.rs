//! Points (i, j, k) of a box and their indices (i·n₂ + j)·n₃ + k: nodes, bricks, subdomains.

/// The points start … start + counts − 1 of a box, in index order.
pub fn points(start: [usize; 3], counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + Clone + use<> {
    (0..counts.iter().product()).map(move |index| add(start, point(counts, index)))
}

/// The point of an index among `counts` points.
pub fn point([_, n2, n3]: [usize; 3], index: usize) -> [usize; 3] {
    [index / (n2 * n3), index / n3 % n2, index % n3]
}

/// The index of a point among `counts` points.
pub fn index([_, n2, n3]: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    (i * n2 + j) * n3 + k
}

/// The eight nodes of a brick, in the order of [`crate::body::elasticity::brick`].
pub fn corners(brick: [usize; 3]) -> [[usize; 3]; 8] {
    std::array::from_fn(|a| add(brick, [a >> 2 & 1, a >> 1 & 1, a & 1]))
}

/// The point `offset` beyond another one.
pub fn add(point: [usize; 3], offset: [usize; 3]) -> [usize; 3] {
    std::array::from_fn(|axis| point[axis] + offset[axis])
}

/// How far a point is from a smaller one.
pub fn subtract(point: [usize; 3], first: [usize; 3]) -> [usize; 3] {
    std::array::from_fn(|axis| point[axis] - first[axis])
}
