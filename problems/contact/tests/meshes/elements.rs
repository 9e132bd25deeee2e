//! Elements of the tests' own: internal forces, volumes and loads, independent of those of the library.

use crate::grid::Point;
use contact::body::mesh::{Cell, CellFace, CellKind, Mesh};

/// Reference coordinates of the corners of a hexahedron.
const CORNERS: [Point; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Gradients of the barycentric coordinates of the reference tetrahedron.
const SLOPES: [Point; 4] = [[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Edges of a tetrahedron in the order of its middle nodes.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// a + s b.
pub fn plus(a: Point, s: f64, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] + s * b[axis])
}

/// An integration point of a cell: shape functions, their gradients in space, its volume.
pub struct VolumePoint {
    pub values: Vec<f64>,
    pub gradients: Vec<Point>,
    pub volume: f64,
}

/// Values and reference gradients of the shape functions of a hexahedron.
fn hexahedron(xi: Point) -> Vec<(f64, Point)> {
    let shape = |corner: &Point| {
        let [a, b, c]: Point = std::array::from_fn(|axis| 1.0 + corner[axis] * xi[axis]);
        (a * b * c / 8.0, [corner[0] * b * c / 8.0, a * corner[1] * c / 8.0, a * b * corner[2] / 8.0])
    };
    CORNERS.iter().map(shape).collect()
}

/// Values and reference gradients of the shape functions of a tetrahedron of second order.
fn tetrahedron(l: [f64; 4]) -> Vec<(f64, Point)> {
    let vertex = |v: usize| (l[v] * (2.0 * l[v] - 1.0), SLOPES[v].map(|slope| (4.0 * l[v] - 1.0) * slope));
    let edge = |[a, b]: [usize; 2]| {
        let gradient = plus(SLOPES[b].map(|slope| 4.0 * l[a] * slope), 4.0 * l[b], SLOPES[a]);
        (4.0 * l[a] * l[b], gradient)
    };
    (0..4).map(vertex).chain(EDGES.into_iter().map(edge)).collect()
}

/// The integration points of a cell: 2³ Gauss points, or the four points of the rule of degree 2 for tetrahedra.
pub fn points(kind: CellKind, x: &[Point]) -> Vec<VolumePoint> {
    let rule: Vec<(Vec<(f64, Point)>, f64)> = match kind {
        CellKind::Hex8 => CORNERS.iter().map(|corner| (hexahedron(corner.map(|s| s / 3.0_f64.sqrt())), 1.0)).collect(),
        CellKind::Tet10 => {
            let root = 5.0_f64.sqrt();
            let at = |v: usize| std::array::from_fn(|k| if k == v { 5.0 + 3.0 * root } else { 5.0 - root } / 20.0);
            (0..4).map(|v| (tetrahedron(at(v)), 1.0 / 24.0)).collect()
        }
    };
    rule.into_iter().map(|(shapes, weight)| in_space(&shapes, weight, x)).collect()
}

fn in_space(shapes: &[(f64, Point)], weight: f64, x: &[Point]) -> VolumePoint {
    let mut tangents = [[0.0; 3]; 3];
    for ((_, gradient), x) in shapes.iter().zip(x) {
        (0..3).for_each(|k| tangents[k] = plus(tangents[k], gradient[k], *x));
    }
    let determinant = dot(tangents[0], cross(tangents[1], tangents[2]));
    let dual: [Point; 3] = std::array::from_fn(|k| cross(tangents[(k + 1) % 3], tangents[(k + 2) % 3]));
    let spatial = |(_, gradient): &(f64, Point)| {
        let sum = (0..3).fold([0.0; 3], |sum, k| plus(sum, gradient[k], dual[k]));
        sum.map(|entry| entry / determinant)
    };
    VolumePoint {
        values: shapes.iter().map(|shape| shape.0).collect(),
        gradients: shapes.iter().map(spatial).collect(),
        volume: determinant * weight,
    }
}

fn cell_points(cell: &Cell<'_>, positions: &[Point]) -> Vec<VolumePoint> {
    let x: Vec<Point> = cell.nodes.iter().map(|&node| positions[node as usize]).collect();
    points(cell.kind, &x)
}

/// Volume of a mesh.
pub fn volume(mesh: &Mesh, positions: &[Point]) -> f64 {
    mesh.cells().flat_map(|cell| cell_points(&cell, positions)).map(|point| point.volume).sum()
}

/// Forces that the displacements u need at all nodes: ∫ σ(u) ∇N dV, of Young's modulus and Poisson's ratio.
pub fn internal_forces(
    mesh: &Mesh,
    positions: &[Point],
    u: &[Point],
    [young_modulus, poisson_ratio]: [f64; 2],
) -> Vec<Point> {
    let mu = young_modulus / (2.0 * (1.0 + poisson_ratio));
    let lambda = 2.0 * mu * poisson_ratio / (1.0 - 2.0 * poisson_ratio);
    let mut forces = vec![[0.0; 3]; mesh.node_count()];
    for cell in mesh.cells() {
        for point in cell_points(&cell, positions) {
            let mut slopes = [[0.0; 3]; 3];
            for (&node, gradient) in cell.nodes.iter().zip(&point.gradients) {
                (0..3).for_each(|i| slopes[i] = plus(slopes[i], u[node as usize][i], *gradient));
            }
            let dilatation = slopes[0][0] + slopes[1][1] + slopes[2][2];
            let stress = |i: usize, j: usize| {
                mu * (slopes[i][j] + slopes[j][i]) + if i == j { lambda * dilatation } else { 0.0 }
            };
            let stress: [Point; 3] = std::array::from_fn(|i| std::array::from_fn(|j| point.volume * stress(i, j)));
            for (&node, gradient) in cell.nodes.iter().zip(&point.gradients) {
                let force = stress.map(|row| dot(row, *gradient));
                forces[node as usize] = plus(forces[node as usize], 1.0, force);
            }
        }
    }
    forces
}

/// Forces of a constant force per volume.
pub fn body_forces(mesh: &Mesh, positions: &[Point], force: Point) -> Vec<Point> {
    let mut forces = vec![[0.0; 3]; mesh.node_count()];
    for cell in mesh.cells() {
        for point in cell_points(&cell, positions) {
            for (&node, value) in cell.nodes.iter().zip(&point.values) {
                forces[node as usize] = plus(forces[node as usize], value * point.volume, force);
            }
        }
    }
    forces
}

/// Forces of a constant traction on flat faces with straight edges.
pub fn traction_forces(mesh: &Mesh, positions: &[Point], faces: &[CellFace], traction: Point) -> Vec<Point> {
    let mut forces = vec![[0.0; 3]; mesh.node_count()];
    let mut add = |node: u32, area: f64| forces[node as usize] = plus(forces[node as usize], area, traction);
    for &face in faces {
        let nodes: Vec<u32> = mesh.face_nodes(face).collect();
        let at = |corner: usize| positions[nodes[corner] as usize];
        let way = |from: usize, to: usize| plus(at(to), -1.0, at(from));
        if nodes.len() == 6 {
            // On straight edges ∫N is a third of the area in the middles and nothing at the vertices.
            let area = 0.5 * norm(cross(way(0, 1), way(0, 2)));
            nodes[3..].iter().for_each(|&node| add(node, area / 3.0));
        } else {
            // |a × b| of a flat bilinear face is bilinear, a quarter of |edge × edge| at a corner, and ∫N_i N_j over
            // the reference square is 4/9 for a corner itself, 2/9 for neighbours, 1/9 across.
            let corner = |c: usize| norm(cross(way(c, (c + 1) % 4), way(c, (c + 3) % 4)));
            for c in 0..4 {
                let area = 4.0 * corner(c) + 2.0 * (corner((c + 1) % 4) + corner((c + 3) % 4)) + corner((c + 2) % 4);
                add(nodes[c], area / 36.0);
            }
        }
    }
    forces
}
