//! The change of shape as a table for the workshop: points of the start, outward normals, amounts to remove.
//!
//! ```text
//! amount(x) = n(x)·(x − y),  y the point nearest to x on the same face in the new shape
//! ```
//! x is a node of the start and n its outward normal, the mean over the triangles of the face. Nodes may move along the
//! face: what counts is the distance of the surfaces. A positive amount is removed, a negative one added.

use crate::commands::export::files::OutputFile;
use crate::commands::export::mesh::divided;
use crate::commands::numbers::{exact, number};
use crate::commands::report::faces_by_names;
use crate::commands::scene_words::stem;
use crate::commands::vectors::{cross, dot, minus, sum};
use contact::body::mesh::{CellFace, Mesh};
use contact::equilibrium::ContactProblem;
use contact::scene::ContactScene;
use std::collections::{BTreeMap, HashSet};

/// A face of a mesh as triangles between its nodes.
struct Sheet {
    triangles: Vec<[u32; 3]>,
    /// The triangles at every node of the face.
    of_node: BTreeMap<u32, Vec<usize>>,
}

impl Sheet {
    fn new(mesh: &Mesh, faces: &[CellFace]) -> Self {
        let triangles: Vec<[u32; 3]> = faces.iter().flat_map(|face| divided(mesh, *face)).collect();
        let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (index, triangle) in triangles.iter().enumerate() {
            triangle.iter().for_each(|node| of_node.entry(*node).or_default().push(index));
        }
        Self { triangles, of_node }
    }

    /// The unit normal at a node: the mean over its triangles, weighted by their areas.
    fn normal(&self, node: u32, places: &[[f64; 3]]) -> [f64; 3] {
        let own = self.of_node[&node].iter().map(|&triangle| {
            let [a, b, c] = self.triangles[triangle].map(|node| places[node as usize]);
            cross(minus(b, a), minus(c, a))
        });
        let all = own.fold([0.0; 3], sum);
        let length = dot(all, all).sqrt();
        // Normals that cancel leave no side to remove anything on.
        all.map(|part| if length > 0.0 { part / length } else { 0.0 })
    }

    /// The point of the face nearest to x, where the node has moved from x. No point beyond the node is nearer, so that
    /// the triangles that reach into the ball around x up to the node are enough.
    fn nearest(&self, node: u32, x: [f64; 3], places: &[[f64; 3]]) -> [f64; 3] {
        let mut best = places[node as usize];
        let reach = square(minus(best, x));
        let (mut known, mut open) = (HashSet::new(), self.of_node[&node].clone());
        known.extend(open.iter().copied());
        while let Some(triangle) = open.pop() {
            let point = nearest_in(self.triangles[triangle].map(|node| places[node as usize]), x);
            let distance = square(minus(point, x));
            if distance > reach {
                continue;
            }
            if distance < square(minus(best, x)) {
                best = point;
            }
            let neighbours = self.triangles[triangle].iter().flat_map(|node| &self.of_node[node]);
            open.extend(neighbours.filter(|other| known.insert(**other)));
        }
        best
    }
}

/// A face that may touch, or that has moved.
pub struct ChangedFace {
    pub body: usize,
    /// Its names; none for the rest of the skin.
    pub names: Vec<String>,
    pub nodes: Vec<ChangedNode>,
}

/// A node of a changed face.
pub struct ChangedNode {
    pub node: u32,
    from: [f64; 3],
    normal: [f64; 3],
    /// What is to be removed there; negative: to be added, mm.
    pub amount: f64,
    to: [f64; 3],
}

/// The change of all optimized bodies from the start: of the faces that may touch, and of all others that move.
pub fn changed_faces(problem: &ContactProblem, controls: &[f64]) -> Vec<ChangedFace> {
    let (start, end) = (problem.start_positions(), problem.map.positions(controls));
    let mut changed = Vec::new();
    let shaped = problem.scene.bodies.iter().enumerate().filter(|(_, body)| body.shape.is_some());
    for (body, _) in shaped {
        let (mesh, start, end) = (&problem.bodies[body].mesh, &start[body], &end[body]);
        for (names, faces) in faces_by_names(mesh) {
            let sheet = Sheet::new(mesh, &faces);
            let mut sides = problem.scene.contacts.iter().flat_map(ContactScene::faces);
            let touches = sides.any(|side| side.body == body && names.contains(&side.face));
            if !touches && sheet.of_node.keys().all(|&node| start[node as usize] == end[node as usize]) {
                continue;
            }
            let of_node = |&node: &u32| {
                let (from, to) = (start[node as usize], end[node as usize]);
                let normal = sheet.normal(node, start);
                let amount = dot(normal, minus(from, sheet.nearest(node, from, end)));
                ChangedNode { node, from, normal, amount, to }
            };
            changed.push(ChangedFace { body, nodes: sheet.of_node.keys().map(of_node).collect(), names });
        }
    }
    changed
}

/// The largest amounts to remove and to add, mm, with the names of their faces.
pub fn largest(changed: &[ChangedFace]) -> [(f64, &[String]); 2] {
    let amounts = || changed.iter().flat_map(|face| face.nodes.iter().map(|node| (node.amount, face.names.as_slice())));
    [1.0, -1.0].map(|sign| {
        let own = amounts().map(|(amount, names)| (sign * amount, names));
        own.fold((0.0, &[][..]), |most, next| if next.0 > most.0 { next } else { most })
    })
}

/// The changed faces as a table.
pub fn table(problem: &ContactProblem, controls: &[f64]) -> OutputFile {
    let changed = changed_faces(problem, controls);
    let several = problem.bodies.len() > 1;
    let head = "face,node,start_x1_mm,start_x2_mm,start_x3_mm,normal_1,normal_2,normal_3,remove_mm,x1_mm,x2_mm,x3_mm";
    let mut table = if several { format!("body,{head}\n") } else { format!("{head}\n") };
    for ChangedFace { body, names, nodes } in &changed {
        for ChangedNode { node, from, normal, amount, to } in nodes {
            let numbers = from.iter().chain(normal).chain([amount]).chain(to).copied().map(exact);
            let numbers: Vec<String> = numbers.collect();
            let lead = if several { format!("{},", stem(&problem.scene, *body)) } else { String::new() };
            table += &format!("{lead}{},{node},{}\n", quoted(&names.join("; ")), numbers.join(","));
        }
    }
    let count: usize = changed.iter().map(|face| face.nodes.len()).sum();
    let [removed, added] = largest(&changed).map(|(amount, _)| amount);
    let what = format!(
        "the change from the start at {count} points: at most {} mm to remove, {} mm to add",
        number(removed),
        number(added)
    );
    OutputFile::text("change.csv", table, what)
}

/// A name as a field of a table.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// The point of a triangle nearest to x: of its plane, or of its nearest side.
fn nearest_in([a, b, c]: [[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    let normal = cross(minus(b, a), minus(c, a));
    let inside = |from: [f64; 3], to: [f64; 3]| dot(cross(minus(to, from), minus(x, from)), normal) >= 0.0;
    let area = square(normal);
    if area > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        let height = dot(minus(x, a), normal) / area;
        return std::array::from_fn(|axis| x[axis] - height * normal[axis]);
    }
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| {
        let along = minus(to, from);
        let share = dot(minus(x, from), along) / square(along);
        // A side without length is a point.
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        std::array::from_fn(|axis| from[axis] + share * along[axis])
    });
    let distance = |point: &[f64; 3]| square(minus(*point, x));
    sides.into_iter().reduce(|best, other| if distance(&other) < distance(&best) { other } else { best }).unwrap_or(a)
}

fn square(a: [f64; 3]) -> f64 {
    dot(a, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact::body::mesh::CellKind;

    /// A plate of n × n hexahedra on x₃ = 0, and its upper face.
    fn plate(n: usize) -> (Mesh, Sheet) {
        let node = |i: usize, j: usize, k: usize| (i * (n + 1) + j) * 2 + k;
        let places = (0..2 * (n + 1) * (n + 1)).map(|index| {
            let column = index / 2;
            [(column / (n + 1)) as f64, (column % (n + 1)) as f64, (index % 2) as f64]
        });
        let cells: Vec<(CellKind, Vec<usize>)> = (0..n * n)
            .map(|cell| {
                let (i, j) = (cell / n, cell % n);
                let square = |k| [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)];
                (CellKind::Hex8, [square(0), square(1)].concat())
            })
            .collect();
        let mesh = Mesh::new(places.collect(), cells).expect("a mesh");
        let is_top = |face: &CellFace| mesh.face_nodes(*face).all(|node| node % 2 == 1);
        let top: Vec<CellFace> = mesh.skin().into_iter().filter(is_top).collect();
        let sheet = Sheet::new(&mesh, &top);
        (mesh, sheet)
    }

    fn amounts(sheet: &Sheet, start: &[[f64; 3]], end: &[[f64; 3]]) -> Vec<f64> {
        let amount = |&node: &u32| {
            let from = start[node as usize];
            dot(sheet.normal(node, start), minus(from, sheet.nearest(node, from, end)))
        };
        sheet.of_node.keys().map(amount).collect()
    }

    #[test]
    fn nodes_that_slide_along_their_face_remove_nothing() {
        let (mesh, sheet) = plate(6);
        let centre = 3.0;
        let slid = |x: &[f64; 3]| {
            let share = ((x[0] - centre).powi(2) + (x[1] - centre).powi(2)) / 18.0;
            [x[0] + 2.3 * (1.0 - share), x[1] - 1.7 * (1.0 - share), x[2]]
        };
        let end: Vec<[f64; 3]> = mesh.nodes().iter().map(slid).collect();
        assert!(amounts(&sheet, mesh.nodes(), &end).iter().all(|amount| amount.abs() < 1e-12));
        let lower: Vec<[f64; 3]> = end.iter().map(|x| [x[0], x[1], x[2] - 0.25]).collect();
        for (found, node) in amounts(&sheet, mesh.nodes(), &lower).iter().zip(sheet.of_node.keys()) {
            assert!((found - 0.25).abs() < 1e-12, "{found} at node {node}");
        }
    }

    #[test]
    fn amounts_are_distances_of_the_surfaces_and_positive_where_something_is_removed() {
        let (mesh, sheet) = plate(10);
        let bent = |height: f64| move |x: &[f64; 3]| [x[0], x[1], x[2] + height + 0.05 * (x[0] - 5.0)];
        let [start, end] = [0.0, 0.3].map(|height| mesh.nodes().iter().map(bent(height)).collect::<Vec<_>>());
        // Planes inclined by 0.05, 0.3 above each other.
        let distance = 0.3 / 1.0025_f64.sqrt();
        let found = amounts(&sheet, &start, &end);
        let inner = found.iter().filter(|amount| (**amount + distance).abs() < 1e-12).count();
        assert!(inner >= 10 * 11, "{found:?}");
        assert!(amounts(&sheet, &end, &start).iter().all(|amount| *amount > 0.9 * distance));
    }
}
