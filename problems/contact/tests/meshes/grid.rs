//! Meshes made by code: a grid of boxes as hexahedra, or each box as six tetrahedra, mapped to a body.
//!
//! Places of the grid are on [0, 1]³ before they are distorted and mapped. The names of the six sides are those of
//! blocks; a map takes them along.

use contact::body::mesh::{CellFace, CellKind, Mesh};
use std::collections::HashMap;

/// A point or a vector.
pub type Point = [f64; 3];

/// Both kinds of cells.
pub const KINDS: [CellKind; 2] = [CellKind::Hex8, CellKind::Tet10];

/// Names of the sides: axis by axis, the near one first.
const SIDES: [[&str; 2]; 3] = [["x1-min", "x1-max"], ["x2-min", "x2-max"], ["bottom", "top"]];

/// Corners of a box in the order of a hexahedron.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// Orders of the axes along which the paths from the first to the last corner of a box go, and whether the tetrahedron
/// of the path's corners has a positive volume: together they fill the box, and neighbours fit.
const PATHS: [([usize; 3], bool); 6] = [
    ([0, 1, 2], true),
    ([1, 2, 0], true),
    ([2, 0, 1], true),
    ([1, 0, 2], false),
    ([0, 2, 1], false),
    ([2, 1, 0], false),
];

/// Edges of a tetrahedron in the order of its middle nodes.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// The mesh of a body: `boxes` per axis; vertices moved by up to about `distortion` of a box, within the sides. Edges
/// are straight.
pub fn mesh(kind: CellKind, boxes: [usize; 3], distortion: f64, map: impl Fn(Point) -> Point) -> Mesh {
    build(kind, boxes, distortion, map, false)
}

/// As [`mesh`], but middle nodes are mapped like all others, so that edges are curved where the map is.
pub fn curved(kind: CellKind, boxes: [usize; 3], distortion: f64, map: impl Fn(Point) -> Point) -> Mesh {
    build(kind, boxes, distortion, map, true)
}

fn build(kind: CellKind, boxes: [usize; 3], distortion: f64, map: impl Fn(Point) -> Point, curves: bool) -> Mesh {
    let counts = boxes.map(|count| count + 1);
    let index = |place: [usize; 3]| (place[0] * counts[1] + place[1]) * counts[2] + place[2];
    let mut places: Vec<[usize; 3]> = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            places.extend((0..counts[2]).map(|k| [i, j, k]));
        }
    }
    let mut points: Vec<Point> = places.iter().map(|place| distorted(*place, boxes, distortion)).collect();
    if !curves {
        points.iter_mut().for_each(|point| *point = map(*point));
    }
    let firsts = places.iter().filter(|place| (0..3).all(|axis| place[axis] < boxes[axis]));
    let mut cells: Vec<Vec<usize>> = Vec::new();
    for first in firsts {
        let corner = |corner: [usize; 3]| index(std::array::from_fn(|axis| first[axis] + corner[axis]));
        match kind {
            CellKind::Hex8 => cells.push(CORNERS.map(corner).to_vec()),
            CellKind::Tet10 => cells.extend(PATHS.map(|path| tetrahedron(path).map(corner).to_vec())),
        }
    }
    let sides = sides(kind, &cells, &places, boxes);
    if kind == CellKind::Tet10 {
        add_middles(&mut cells, &mut points);
    }
    if curves {
        points.iter_mut().for_each(|point| *point = map(*point));
    }
    let mesh = Mesh::new(points, cells.into_iter().map(|cell| (kind, cell))).unwrap();
    sides.into_iter().fold(mesh, |mesh, (name, faces)| mesh.with_face(name, faces).unwrap())
}

/// The vertices of the tetrahedron of a path.
fn tetrahedron((axes, positive): ([usize; 3], bool)) -> [[usize; 3]; 4] {
    let mut vertices = [[0; 3]; 4];
    for (step, axis) in axes.into_iter().enumerate() {
        vertices[step + 1] = vertices[step];
        vertices[step + 1][axis] = 1;
    }
    if !positive {
        vertices.swap(1, 2);
    }
    vertices
}

/// A place of the grid, moved along every axis across which it is inside: as good as at random, and the same each time.
fn distorted(place: [usize; 3], boxes: [usize; 3], distortion: f64) -> Point {
    let [i, j, k] = place.map(|index| index as f64);
    std::array::from_fn(|axis| {
        let inside = place[axis] > 0 && place[axis] < boxes[axis];
        let random = (12.9 * i + 78.2 * j + 37.7 * k + 4.1 * axis as f64 + 1.3).sin();
        (place[axis] as f64 + if inside { distortion * random } else { 0.0 }) / boxes[axis] as f64
    })
}

/// The faces of the cells on the six sides.
fn sides(
    kind: CellKind,
    cells: &[Vec<usize>],
    places: &[[usize; 3]],
    boxes: [usize; 3],
) -> Vec<(&'static str, Vec<CellFace>)> {
    let mut sides: HashMap<&'static str, Vec<CellFace>> = HashMap::new();
    for (cell, nodes) in cells.iter().enumerate() {
        for (face, locals) in kind.faces().iter().enumerate() {
            let corners = &locals[..kind.corner_count()];
            for axis in 0..3 {
                for (end, level) in [0, boxes[axis]].into_iter().enumerate() {
                    if corners.iter().all(|&local| places[nodes[local]][axis] == level) {
                        let face = CellFace { cell: cell as u32, face: face as u8 };
                        sides.entry(SIDES[axis][end]).or_default().push(face);
                    }
                }
            }
        }
    }
    sides.into_iter().collect()
}

/// Gives tetrahedra the nodes in the middles of their edges.
fn add_middles(cells: &mut [Vec<usize>], points: &mut Vec<Point>) {
    let mut known: HashMap<[usize; 2], usize> = HashMap::new();
    for cell in cells {
        for [a, b] in EDGES.map(|[a, b]| [cell[a].min(cell[b]), cell[a].max(cell[b])]) {
            let middle = *known.entry([a, b]).or_insert_with(|| {
                points.push(std::array::from_fn(|axis| 0.5 * (points[a][axis] + points[b][axis])));
                points.len() - 1
            });
            cell.push(middle);
        }
    }
}

/// A box of some size with its first corner at the origin.
pub fn boxed(size: Point) -> impl Fn(Point) -> Point {
    move |place| std::array::from_fn(|axis| size[axis] * place[axis])
}

/// A part of a spherical shell about the origin, `angle` wide both ways, between two radii; its top is the outer one.
pub fn shell(radii: [f64; 2], angle: f64) -> impl Fn(Point) -> Point {
    move |[s, t, r]| {
        let [a, b] = [s, t].map(|place| (angle * (place - 0.5)).tan());
        let length = (radii[0] + (radii[1] - radii[0]) * r) / (1.0 + a * a + b * b).sqrt();
        [length * a, length * b, length]
    }
}

/// A part of a cylinder about the axis x₂, `angle` wide, `width` long, between two radii; its top is the outer one.
pub fn sector(radii: [f64; 2], angle: f64, width: f64) -> impl Fn(Point) -> Point {
    move |[s, t, r]| {
        let (sine, cosine) = (angle * (s - 0.5)).sin_cos();
        let radius = radii[0] + (radii[1] - radii[0]) * r;
        [radius * sine, width * t, radius * cosine]
    }
}
