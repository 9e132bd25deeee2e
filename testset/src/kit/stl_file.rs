//! Binary STL files read back.

use std::collections::HashMap;

/// Corners of a triangle with their coordinates.
pub type Corners = [[f32; 3]; 3];

/// The triangles of a binary STL file.
///
/// # Panics
/// When the length of the file is not that of its triangles, or a normal is not that of its corners.
pub fn triangles(bytes: &[u8]) -> Vec<Corners> {
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    let count = u32::from_le_bytes(bytes[80..84].try_into().expect("four bytes")) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count, "{count} triangles");
    let triangle = |index: usize| {
        let vector = |part: usize| std::array::from_fn(|axis| number(84 + 50 * index + 12 * part + 4 * axis));
        let corners: Corners = [vector(1), vector(2), vector(3)];
        let (normal, twice) = (vector(0).map(f64::from), twice_the_area(&corners));
        let length = twice.iter().map(|x| x * x).sum::<f64>().sqrt();
        let along: f64 = normal.iter().zip(twice).map(|(n, x)| n * x).sum();
        assert!(length > 0.0 && (along / length - 1.0).abs() < 1e-5, "the normal of triangle {index}: {normal:?}");
        corners
    };
    (0..count).map(triangle).collect()
}

/// The vector product of two edges.
fn twice_the_area(corners: &Corners) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let (u, v): ([f64; 3], [f64; 3]) =
        (std::array::from_fn(|axis| b[axis] - a[axis]), std::array::from_fn(|axis| c[axis] - a[axis]));
    let cross = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    [cross(1, 2), cross(2, 0), cross(0, 1)]
}

/// Number of edges of a triangulation, and of those that are not shared by exactly two triangles which pass them in
/// opposite directions. Corners are the same where their coordinates are, bit by bit.
pub fn edges(triangles: &[Corners]) -> (usize, usize) {
    let mut passes: HashMap<[[u32; 3]; 2], [usize; 2]> = HashMap::new();
    for corners in triangles {
        let corners = corners.map(|corner| corner.map(f32::to_bits));
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let (edge, direction) = if corners[from] < corners[to] { ([from, to], 0) } else { ([to, from], 1) };
            passes.entry(edge.map(|corner| corners[corner])).or_default()[direction] += 1;
        }
    }
    (passes.len(), passes.values().filter(|passes| **passes != [1, 1]).count())
}

/// The volume inside, by the divergence theorem; positive if all triangles are counterclockwise from outside.
pub fn volume(triangles: &[Corners]) -> f64 {
    let part = |corners: &Corners| -> f64 {
        corners[0].iter().zip(twice_the_area(corners)).map(|(&x, n)| f64::from(x) * n / 6.0).sum()
    };
    triangles.iter().map(part).sum()
}
