//! Bodies in space on a drawing: layers of faces, each filled as a whole, with mesh lines and edges on it.

use super::canvas::{Canvas, INK, Place, Stroke};
use super::layers::Faces;
use super::regions::{area, borders, lines, ring, sides};
use super::view::{Point, Projection, dot};
use std::collections::{BTreeMap, BTreeSet};

/// Most faces of a panel between which mesh lines are drawn.
const MAX_MESHED_FACES: usize = 1500;
/// Angle of neighbouring faces from which the side between them is an edge of the body.
const MIN_EDGE_ANGLE: f64 = 40.0_f64.to_radians();
/// Twice the least area of a face that is drawn, square points.
const MIN_AREA: f64 = 1e-6;
/// Colour of skins.
const PLAIN: &str = "#e6e6e6";
/// Lines between faces.
const MESH: Stroke<'_> = Stroke { colour: "#4d4d4d", width: 0.35, dashed: false };
/// Edges and outlines of bodies.
const EDGE: Stroke<'_> = Stroke { colour: INK, width: 0.7, dashed: false };

/// Triangles and quadrilaterals around a body, or on a surface.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Skin {
    pub points: Vec<Point>,
    /// Counterclockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
    /// Whether faces that are turned away from the viewer are seen as well.
    pub two_sided: bool,
}

/// Skins one over the other; what is nearer covers the rest.
pub(super) fn paint(canvas: &mut Canvas, projection: &Projection, skins: &[Skin]) {
    let (mut places, mut depths) = (Vec::new(), Vec::new());
    let (mut faces, mut edges) = (Vec::new(), BTreeSet::new());
    for skin in skins {
        let first = places.len();
        places.extend(skin.points.iter().map(|&point| projection.place(point)));
        depths.extend(skin.points.iter().map(|&point| projection.depth(point)));
        let (seen, at_edges) = skin.seen(&places[first..]);
        faces.extend(seen.into_iter().map(|face| face.iter().map(|point| first + point).collect::<Vec<_>>()));
        edges.extend(at_edges.into_iter().map(|side| side.map(|point| first + point)));
    }
    let depth = |face: &Vec<usize>| face.iter().map(|&point| depths[point]).sum::<f64>() / face.len() as f64;
    faces.sort_by(|a: &Vec<usize>, b| depth(a).total_cmp(&depth(b)));
    let layers = Faces { faces: &faces, places: &places, depths: &depths }.layers();
    let meshed = layers.iter().map(Vec::len).sum::<usize>() <= MAX_MESHED_FACES;
    for (number, layer) in layers.iter().enumerate() {
        let own: Vec<Vec<usize>> = layer.iter().map(|&face| faces[face].clone()).collect();
        let mut here = vec![false; places.len()];
        own.iter().flatten().for_each(|&point| here[point] = true);
        // Neighbours in higher layers will be drawn again: here they leave no seam.
        let higher = layers[number + 1..].iter().flatten().map(|&face| faces[face].clone());
        let filled = own.iter().cloned().chain(higher.filter(|face| face.iter().any(|&point| here[point])));
        let outlines = borders(filled.map(|face| ring(&face, &places)));
        canvas.area(PLAIN, outlines.iter().map(Vec::as_slice));
        let (edges, mesh): (Vec<_>, Vec<_>) = sides(&own).into_keys().partition(|side| edges.contains(side));
        if meshed {
            canvas.lines(&lines(&mesh, &places), MESH);
        }
        canvas.lines(&lines(&edges, &places), EDGE);
    }
}

impl Skin {
    /// The skin of a body; one that is open has two sides.
    pub fn new(points: &[Point], faces: &[Vec<usize>]) -> Self {
        let two_sided = sides(faces).values().any(|faces| faces.len() == 1);
        Self { points: points.to_vec(), faces: faces.to_vec(), two_sided }
    }

    /// The faces that are seen if nothing covers them, and their sides that are edges or lie on the outline.
    fn seen(&self, places: &[Place]) -> (Vec<Vec<usize>>, BTreeSet<[usize; 2]>) {
        let sides = sides(&self.faces);
        // The second coordinate of a drawing points downwards.
        let turned: Vec<bool> = self.faces.iter().map(|face| area(face, places) < -MIN_AREA).collect();
        let mut seen = Vec::new();
        for (face, turned) in self.faces.iter().zip(&turned).filter(|(_, turned)| **turned || self.two_sided) {
            seen.push(if *turned { face.clone() } else { face.iter().rev().copied().collect() });
        }
        (seen, edges(self, &sides, &turned))
    }
}

/// Sides of one face, of faces at an angle, and between what is turned towards the viewer and what is not.
fn edges(skin: &Skin, sides: &BTreeMap<[usize; 2], Vec<usize>>, turned: &[bool]) -> BTreeSet<[usize; 2]> {
    let normals: Vec<Point> = skin.faces.iter().map(|face| normal(&skin.points, face)).collect();
    let is_edge = |faces: &[usize]| match *faces {
        [a, b] => turned[a] != turned[b] || dot(normals[a], normals[b]) < MIN_EDGE_ANGLE.cos(),
        _ => true,
    };
    sides.iter().filter(|(_, faces)| is_edge(faces)).map(|(side, _)| *side).collect()
}

/// The direction of length one that a face points to; of a face without area, zero.
fn normal(points: &[Point], face: &[usize]) -> Point {
    let step = |k: usize| -> Point { std::array::from_fn(|axis| points[face[k]][axis] - points[face[0]][axis]) };
    let mut normal = [0.0; 3];
    for k in 1..face.len() - 1 {
        let (a, b) = (step(k), step(k + 1));
        for axis in 0..3 {
            let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
            normal[axis] += a[next] * b[last] - a[last] * b[next];
        }
    }
    let length = dot(normal, normal).sqrt();
    normal.map(|part| if length > 0.0 { part / length } else { 0.0 })
}
