//! Faces of structured grids of points.

/// Quadrilaterals between the points of a grid, n₁ × n₂ points with index i·n₂ + j: counterclockwise where the first
/// axis points to the right and the second upwards.
///
/// ```
/// assert_eq!(figures::grid_faces([2, 3]), [[0, 3, 4, 1], [1, 4, 5, 2]]);
/// ```
pub fn grid_faces([n1, n2]: [usize; 2]) -> Vec<Vec<usize>> {
    let cells = (1..n1).flat_map(|i| (1..n2).map(move |j| (i - 1) * n2 + j - 1));
    cells.map(|first| vec![first, first + n2, first + n2 + 1, first + 1]).collect()
}

/// The skin of a block of points, n₁ × n₂ × n₃ points with index (i·n₂ + j)·n₃ + k, at least 2 along every axis:
/// quadrilaterals, counterclockwise seen from outside where the axes are right-handed.
///
/// ```
/// assert_eq!(figures::box_faces([2, 2, 2]).len(), 6);
/// ```
pub fn box_faces(nodes: [usize; 3]) -> Vec<Vec<usize>> {
    // Axis a side is normal to, at its end or beginning; first × second axis of the side points outwards.
    let sides = [
        (2, true, [0, 1]),
        (2, false, [1, 0]),
        (0, true, [1, 2]),
        (0, false, [2, 1]),
        (1, true, [2, 0]),
        (1, false, [0, 2]),
    ];
    let side = |(normal, end, axes): (usize, bool, [usize; 2])| {
        let counts = axes.map(|axis| nodes[axis]);
        let point = move |index: usize| {
            let mut place = [0; 3];
            place[normal] = if end { nodes[normal] - 1 } else { 0 };
            place[axes[0]] = index / counts[1];
            place[axes[1]] = index % counts[1];
            (place[0] * nodes[1] + place[1]) * nodes[2] + place[2]
        };
        grid_faces(counts).into_iter().map(move |face| face.into_iter().map(point).collect())
    };
    sides.into_iter().flat_map(side).collect()
}
