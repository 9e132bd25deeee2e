//! Consistent nodal loads, and their derivatives with respect to the positions of nodes.
//!
//! ```text
//! f_v = ∫_face N_v t dA   or   ∫ N_v b dV;     t = F/A + ω × (x − c),  J ω = M + (x_F − c) × F   for a force and a moment
//! ```
//! The forces are computed for numbers with derivatives: their derivative along velocities of the nodes is exact.

use crate::body::elasticity::facet::{FacePoint, integrate, length};
use crate::body::loaded::{Loaded, Traction};
use crate::body::mesh::{CellFace, Mesh};
use crate::body::{Body, Piece};
use crate::error::SceneError;
use crate::scalar::{Dual, Scalar};
use crate::scene::Load;
use std::collections::BTreeMap;

/// Constants of a traction t₀ + ω × (x − c).
#[derive(Debug, Clone, Copy)]
struct Linear<T> {
    mean: [T; 3],
    spin: [T; 3],
    centre: [T; 3],
}

/// Sums over a face that the constants are computed from: area, first moments, second moments x_i x_j.
type Moments<T> = [T; 10];

/// Places of x_i x_j among the moments.
const SECOND: [[usize; 3]; 3] = [[4, 5, 6], [5, 7, 8], [6, 8, 9]];

/// Positions of the nodes as numbers of some kind.
trait Positions<T>: Fn(u32) -> [T; 3] {}
impl<T, F: Fn(u32) -> [T; 3]> Positions<T> for F {}

/// A visitor of nodal forces.
trait Forces<T>: FnMut(u32, [T; 3]) {}
impl<T, F: FnMut(u32, [T; 3])> Forces<T> for F {}

fn face_positions<T>(mesh: &Mesh, face: CellFace, x: &impl Positions<T>) -> (Vec<u32>, Vec<[T; 3]>) {
    mesh.face_nodes(face).map(|node| (node, x(node))).unzip()
}

fn cross<T: Scalar>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

fn constant<T: Scalar>(vector: [f64; 3]) -> [T; 3] {
    vector.map(T::constant)
}

impl Traction {
    /// The constants of a linear traction over all its faces; none for tractions that depend on the point alone.
    fn linear<T: Scalar>(&self, mesh: &Mesh, faces: &[CellFace], x: &impl Positions<T>) -> Option<Linear<T>> {
        let Self::Resultant { .. } = self else { return None };
        let mut moments = [T::constant(0.0); 10];
        for &face in faces {
            add_moments(&face_positions(mesh, face, x).1, &mut moments);
        }
        self.of_moments(&moments)
    }

    fn of_moments<T: Scalar>(&self, moments: &Moments<T>) -> Option<Linear<T>> {
        let Self::Resultant { force, moment, point } = self else { return None };
        let area = moments[0];
        let centre: [T; 3] = std::array::from_fn(|axis| moments[1 + axis] / area);
        let second = |i: usize, j: usize| moments[SECOND[i][j]] - area * centre[i] * centre[j];
        let trace = second(0, 0) + second(1, 1) + second(2, 2);
        let inertia: [[T; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { trace - second(i, j) } else { T::constant(0.0) - second(i, j) })
        });
        let arm = |axis: usize| point.map_or(T::constant(0.0), |point| T::constant(point[axis]) - centre[axis]);
        let turned = cross(std::array::from_fn(arm), constant(*force));
        let about: [T; 3] = std::array::from_fn(|axis| T::constant(moment[axis]) + turned[axis]);
        let mean = force.map(|force| T::constant(force) / area);
        Some(Linear { mean, spin: solve(&inertia, about), centre })
    }

    /// The traction at a point times its area.
    fn at<T: Scalar>(&self, point: &FacePoint<'_, T>, linear: Option<&Linear<T>>) -> [T; 3] {
        let times = |traction: [T; 3]| {
            let area = length(point.area);
            traction.map(|traction| traction * area)
        };
        match (self, linear) {
            (Self::Pressure(pressure), _) => point.area.map(|area| T::constant(-pressure) * area),
            (Self::Constant(traction), _) => times(constant(*traction)),
            (Self::Formula(formulas), _) => times(formulas.each_ref().map(|formula| formula.value(point.position))),
            (Self::Resultant { .. }, Some(Linear { mean, spin, centre })) => {
                let turned = cross(*spin, std::array::from_fn(|axis| point.position[axis] - centre[axis]));
                times(std::array::from_fn(|axis| mean[axis] + turned[axis]))
            }
            (Self::Resultant { .. }, None) => [T::constant(f64::NAN); 3],
        }
    }
}

/// Adds area, first and second moments of a face.
fn add_moments<T: Scalar>(positions: &[[T; 3]], moments: &mut Moments<T>) {
    integrate(positions, |point| {
        let (area, x) = (length(point.area), point.position);
        moments[0] += area;
        for i in 0..3 {
            moments[1 + i] += area * x[i];
            for j in i..3 {
                moments[SECOND[i][j]] += area * x[i] * x[j];
            }
        }
    });
}

/// The solution of a system of three equations by Cramer's rule.
fn solve<T: Scalar>(matrix: &[[T; 3]; 3], right: [T; 3]) -> [T; 3] {
    let columns: [[T; 3]; 3] = std::array::from_fn(|j| std::array::from_fn(|i| matrix[i][j]));
    let determinant = |a: [T; 3], b: [T; 3], c: [T; 3]| {
        let [x, y, z] = cross(b, c);
        a[0] * x + a[1] * y + a[2] * z
    };
    let [a, b, c] = columns;
    let whole = determinant(a, b, c);
    [determinant(right, b, c) / whole, determinant(a, right, c) / whole, determinant(a, b, right) / whole]
}

/// Nodal forces of one face.
fn face_forces<T: Scalar>(traction: &Traction, linear: Option<&Linear<T>>, positions: &[[T; 3]]) -> Vec<[T; 3]> {
    let mut forces = vec![[T::constant(0.0); 3]; positions.len()];
    integrate(positions, |point| {
        let force = traction.at(&point, linear);
        for (sum, &value) in forces.iter_mut().zip(point.values) {
            (0..3).for_each(|axis| sum[axis] += force[axis] * T::constant(value));
        }
    });
    forces
}

/// Visits the nodal forces of all loads of a body on the cells that `is_own` names.
fn visit<T: Scalar>(body: &Body, is_own: impl Fn(u32) -> bool, x: &impl Positions<T>, add: impl Forces<T>) {
    visit_loads((&body.mesh, &body.loads), is_own, x, add);
}

fn visit_loads<T: Scalar>(
    (mesh, loads): (&Mesh, &[Loaded]),
    is_own: impl Fn(u32) -> bool,
    x: &impl Positions<T>,
    mut add: impl Forces<T>,
) {
    for load in loads {
        match load {
            Loaded::Faces(faces, traction) => {
                let mut linear = None;
                for &face in faces.iter().filter(|face| is_own(face.cell)) {
                    if linear.is_none() {
                        linear = traction.linear(mesh, faces, x);
                    }
                    let (nodes, positions) = face_positions(mesh, face, x);
                    let forces = face_forces(traction, linear.as_ref(), &positions);
                    nodes.into_iter().zip(forces).for_each(|(node, force)| add(node, force));
                }
            }
            Loaded::Cells(cells, force) => {
                for &cell in cells.iter().filter(|cell| is_own(**cell)) {
                    for (node, weight) in mesh.node_volumes(cell as usize, x) {
                        add(node, force.map(|force| T::constant(force) * weight));
                    }
                }
            }
        }
    }
}

/// Σ|f_v| of some loads over the nodes of a mesh, N: what acts on it, roughly. Loads are called `body.loads[i]` in
/// messages.
///
/// # Errors
/// [`SceneError::OutOfRange`] for names that the mesh does not have, and for numbers and formulas without sense.
pub fn load_size(mesh: &Mesh, loads: &[Load]) -> Result<f64, SceneError> {
    let loaded = |(index, load): (usize, &Load)| Loaded::new(&format!("body.loads[{index}]"), load, mesh);
    let loaded = loads.iter().enumerate().map(loaded).collect::<Result<Vec<_>, _>>()?;
    let mut forces = vec![[0.0; 3]; mesh.node_count()];
    visit_loads(
        (mesh, &loaded),
        |_| true,
        &|node: u32| mesh.nodes()[node as usize],
        |node, force: [f64; 3]| {
            (0..3).for_each(|axis| forces[node as usize][axis] += force[axis]);
        },
    );
    Ok(forces.iter().map(|f| f[0].hypot(f[1]).hypot(f[2])).sum())
}

/// The loads of a body at a shape: nodes with forces (N), several per node.
pub fn nodal_forces(body: &Body, positions: &[[f64; 3]]) -> Vec<(u32, [f64; 3])> {
    let mut forces = Vec::new();
    visit(body, |_| true, &|node: u32| positions[node as usize], |node, force| forces.push((node, force)));
    forces
}

/// The loads of a body over the dofs of one of its pieces, N.
pub fn piece_loads(body: &Body, piece: &Piece, positions: &[[f64; 3]]) -> Vec<f64> {
    let mut forces = vec![0.0; piece.dof_count()];
    let is_own = |cell: u32| piece.cells.binary_search(&cell).is_ok();
    let add = |node: u32, force: [f64; 3]| piece.add_force(node, force, &mut forces);
    visit(body, is_own, &|node: u32| positions[node as usize], add);
    forces
}

/// Adds the changes of the loads over the dofs of a piece while the nodes move with some velocities.
pub fn add_moved_loads(
    body: &Body,
    piece: &Piece,
    positions: &[[f64; 3]],
    velocity: impl Fn(u32) -> [f64; 3],
    forces: &mut [f64],
) {
    let is_own = |cell: u32| piece.cells.binary_search(&cell).is_ok();
    let x = |node: u32| {
        let (x, v) = (positions[node as usize], velocity(node));
        std::array::from_fn(|axis| Dual::new(x[axis], v[axis]))
    };
    let add = |node: u32, force: [Dual; 3]| piece.add_force(node, force.map(|f| f.derivative), forces);
    visit(body, is_own, &x, add);
}

/// Whether a load depends on the positions of nodes that move.
fn depends(mesh: &Mesh, load: &Loaded, moves: &impl Fn(u32) -> bool) -> bool {
    match load {
        Loaded::Faces(faces, _) => faces.iter().any(|face| mesh.face_nodes(*face).any(moves)),
        Loaded::Cells(cells, _) => cells.iter().any(|cell| mesh.cell(*cell as usize).nodes.iter().any(|n| moves(*n))),
    }
}

/// Whether loads of a body depend on the positions of nodes that move.
pub fn loads_depend(body: &Body, moves: impl Fn(u32) -> bool) -> bool {
    body.loads.iter().any(|load| depends(&body.mesh, load, &moves))
}

/// The derivative of Σ p·f, the work of the loads on the cells that `is_own` names on displacements p, with respect to
/// the positions of nodes. Loads that depend on no node that moves are left out.
pub fn load_sensitivities(
    body: &Body,
    is_own: &impl Fn(u32) -> bool,
    positions: &[[f64; 3]],
    p: &impl Fn(u32) -> [f64; 3],
    moves: &impl Fn(u32) -> bool,
) -> BTreeMap<u32, [f64; 3]> {
    let mut sensitivities = BTreeMap::new();
    let mesh = &*body.mesh;
    for load in body.loads.iter().filter(|load| depends(mesh, load, moves)) {
        match load {
            Loaded::Faces(faces, traction) => {
                let own: Vec<CellFace> = faces.iter().copied().filter(|face| is_own(face.cell)).collect();
                if !own.is_empty() {
                    face_sensitivities(mesh, traction, (faces, &own), positions, p, &mut sensitivities);
                }
            }
            Loaded::Cells(cells, force) => {
                for &cell in cells.iter().filter(|cell| is_own(**cell)) {
                    let nodes = mesh.cell(cell as usize).nodes;
                    let works: Vec<f64> = nodes.iter().map(|&node| dot(p(node), *force)).collect();
                    moved(nodes, positions, &mut sensitivities, |x| {
                        let x = |node: u32| x[nodes.iter().position(|other| *other == node).unwrap_or(0)];
                        mesh.node_volumes(cell as usize, &x).zip(&works).map(|((_, v), work)| v.derivative * work).sum()
                    });
                }
            }
        }
    }
    sensitivities
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

/// Adds to the sensitivities of some nodes what `derivative` makes of their positions, each coordinate moved by itself.
fn moved(
    nodes: &[u32],
    positions: &[[f64; 3]],
    sensitivities: &mut BTreeMap<u32, [f64; 3]>,
    derivative: impl Fn(&[[Dual; 3]]) -> f64,
) {
    let mut x: Vec<[Dual; 3]> = nodes.iter().map(|&node| positions[node as usize].map(Dual::constant)).collect();
    for (index, &node) in nodes.iter().enumerate() {
        for axis in 0..3 {
            x[index][axis].derivative = 1.0;
            sensitivities.entry(node).or_default()[axis] += derivative(&x);
            x[index][axis].derivative = 0.0;
        }
    }
}

/// Adds ∂(Σ p·f) of the own faces of a load: at fixed constants of a linear traction, then by way of the constants.
fn face_sensitivities(
    mesh: &Mesh,
    traction: &Traction,
    (faces, own): (&[CellFace], &[CellFace]),
    positions: &[[f64; 3]],
    p: &impl Fn(u32) -> [f64; 3],
    sensitivities: &mut BTreeMap<u32, [f64; 3]>,
) {
    let fixed = traction.linear(mesh, faces, &|node: u32| positions[node as usize]);
    let dual = |linear: &Linear<f64>| Linear {
        mean: linear.mean.map(Dual::constant),
        spin: linear.spin.map(Dual::constant),
        centre: linear.centre.map(Dual::constant),
    };
    let constants = fixed.as_ref().map(dual);
    for &face in own {
        let nodes: Vec<u32> = mesh.face_nodes(face).collect();
        let p: Vec<[f64; 3]> = nodes.iter().map(|&node| p(node)).collect();
        moved(&nodes, positions, sensitivities, |x| {
            let forces = face_forces(traction, constants.as_ref(), x);
            forces.iter().zip(&p).map(|(force, p)| dot(force.map(|f| f.derivative), *p)).sum()
        });
    }
    if fixed.is_none() {
        return;
    }
    // ∂(Σ p·f)/∂(moments), then ∂(moments)/∂x of all faces.
    let mut moments = [0.0; 10];
    for &face in faces {
        add_moments(&face_positions(mesh, face, &|node: u32| positions[node as usize]).1, &mut moments);
    }
    let slopes: [f64; 10] = std::array::from_fn(|moment| {
        let mut dual: Moments<Dual> = moments.map(Dual::constant);
        dual[moment].derivative = 1.0;
        let linear = traction.of_moments(&dual);
        let work = |face: &CellFace| {
            let (nodes, x) = face_positions(mesh, *face, &|node: u32| positions[node as usize].map(Dual::constant));
            let forces = face_forces(traction, linear.as_ref(), &x);
            nodes.iter().zip(forces).map(|(&node, force)| dot(force.map(|f| f.derivative), p(node))).sum::<f64>()
        };
        own.iter().map(work).sum()
    });
    for &face in faces {
        let nodes: Vec<u32> = mesh.face_nodes(face).collect();
        moved(&nodes, positions, sensitivities, |x| {
            let mut moments = [Dual::constant(0.0); 10];
            add_moments(x, &mut moments);
            moments.iter().zip(slopes).map(|(moment, slope)| moment.derivative * slope).sum()
        });
    }
}
