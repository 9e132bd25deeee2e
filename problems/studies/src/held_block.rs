//! Linear elasticity on one block whose displacements are given on all of its boundary.

use contact::body::Body;
use contact::body::elasticity::{GaussPoint, Material, hex8};
use contact::body::mesh::Mesh;
use contact::error::SceneError;
use contact::scene::{BodyScene, Geometry, MeshGeometry};
use problems::commands::Failure;
use std::sync::Arc;

/// Gauss points and weights on [−1, 1], exact to degree five.
const RULE: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Shape functions, their gradients and the weight at one point of a brick.
pub struct Sample {
    pub values: [f64; 8],
    pub point: GaussPoint<f64, 8>,
    pub x: [f64; 3],
}

/// Shape functions at ξ ∈ [−1, 1]³, with their gradients there.
fn shape_functions(xi: [f64; 3]) -> ([f64; 8], [[f64; 3]; 8]) {
    let factors = |s: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| 1.0 + s[axis] * xi[axis]) };
    let values = hex8::CORNERS.map(|s| factors(s).iter().product::<f64>() / 8.0);
    let gradients = hex8::CORNERS.map(|s| {
        let f = factors(s);
        [s[0] * f[1] * f[2] / 8.0, s[1] * f[0] * f[2] / 8.0, s[2] * f[0] * f[1] / 8.0]
    });
    (values, gradients)
}

/// The samples of a brick of a mesh.
pub fn samples(mesh: &Mesh, brick: usize) -> Vec<Sample> {
    let nodes: [[f64; 3]; 8] = std::array::from_fn(|v| mesh.nodes()[mesh.cell(brick).nodes[v] as usize]);
    let mut samples = Vec::with_capacity(RULE.len().pow(3));
    for (first, u) in RULE {
        for (second, v) in RULE {
            for (third, w) in RULE {
                let (values, gradients) = shape_functions([first, second, third]);
                let point = GaussPoint::new(&nodes, &gradients, u * v * w);
                let x = std::array::from_fn(|axis| nodes.iter().zip(values).map(|(node, n)| n * node[axis]).sum());
                samples.push(Sample { values, point, x });
            }
        }
    }
    samples
}

/// A vector per place.
type Field<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];

/// A body of bricks of one material without supports and loads.
pub fn body(mesh: Mesh, material: Material) -> Result<Body, SceneError> {
    let mesh = Arc::new(mesh);
    let geometry = Geometry::Mesh(MeshGeometry { mesh: Arc::clone(&mesh), pieces: Some(1) });
    Body::new(&BodyScene::new("block", geometry, material), mesh, &[], 1)
}

/// Number of free dofs and the nodal displacements under a body force: the free part of
/// K u = f − K u_D, and the given displacements u_D on the boundary.
///
/// # Errors
/// [`Failure::Computation`] when the stiffness matrix cannot be factored.
pub fn solution(body: &Body, (force, given): (Field<'_>, Field<'_>)) -> Result<(usize, Vec<f64>), Failure> {
    let (mesh, whole) = (&*body.mesh, body.whole());
    let mut values = whole.assemble(&body.solid, mesh.nodes(), |material| *material);
    let size = whole.dof_count();
    let mut right = vec![0.0; size];
    for (brick, cell) in mesh.cells().enumerate() {
        for sample in samples(mesh, brick) {
            for (component, force) in force(sample.x).into_iter().enumerate() {
                for (&node, value) in cell.nodes.iter().zip(&sample.values) {
                    right[3 * node as usize + component] += sample.point.volume * value * force;
                }
            }
        }
    }
    let (mut prescribed, mut held) = (vec![0.0; size], vec![false; size]);
    for node in mesh.skin().into_iter().flat_map(|face| mesh.face_nodes(face)) {
        for (component, value) in given(mesh.nodes()[node as usize]).into_iter().enumerate() {
            let dof = 3 * node as usize + component;
            (prescribed[dof], held[dof]) = (value, true);
        }
    }
    let lower = &whole.pattern.lower;
    let mut image = vec![0.0; size];
    lower.multiply(&values, &prescribed, &mut image);
    for dof in 0..size {
        right[dof] = if held[dof] { 0.0 } else { right[dof] - image[dof] };
    }
    for column in 0..size {
        for position in lower.starts()[column] + 1..lower.starts()[column + 1] {
            if held[column] || held[lower.rows()[position]] {
                values[position] = 0.0;
            }
        }
    }
    let solved = whole.pattern.symbolic(&[]).and_then(|symbolic| symbolic.solve_refined(&values, &mut right));
    solved.map_err(Failure::computation)?;
    let free = held.iter().filter(|held| !**held).count();
    Ok((free, right.iter().zip(&prescribed).map(|(free, prescribed)| free + prescribed).collect()))
}
