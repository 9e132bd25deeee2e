//! Linear elasticity on one block whose displacements are given on all of its boundary.

use contact::body::elasticity::Material;
use contact::body::elasticity::brick::{self, GaussPoint, Nodes};
use contact::body::local_pattern::LocalPattern;
use contact::body::mesh::Block;
use problems::commands::Failure;

/// Gauss points and weights on [−1, 1], exact to degree three.
pub const TWO_POINTS: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];
/// Gauss points and weights on [−1, 1], exact to degree five.
pub const THREE_POINTS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Shape functions, their gradients and the weight at one point of a brick.
pub struct Sample {
    pub values: [f64; 8],
    pub point: GaussPoint<f64>,
    pub x: [f64; 3],
}

/// The samples of a brick for a rule along each axis.
pub fn samples(nodes: &Nodes<f64>, rule: &[(f64, f64)]) -> Vec<Sample> {
    let mut samples = Vec::with_capacity(rule.len().pow(3));
    for &(first, u) in rule {
        for &(second, v) in rule {
            for &(third, w) in rule {
                let values = brick::shape_values([first, second, third]);
                let mut point = brick::sample(nodes, [first, second, third]);
                point.volume *= u * v * w;
                let x = std::array::from_fn(|axis| nodes.iter().zip(values).map(|(node, n)| n * node[axis]).sum());
                samples.push(Sample { values, point, x });
            }
        }
    }
    samples
}

/// A vector per place.
type Field<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];

/// Number of free dofs and the nodal displacements under a body force, which a rule integrates: the free part of
/// K u = f − K u_D, and the given displacements u_D on the boundary.
///
/// # Errors
/// [`Failure::Computation`] when the stiffness matrix cannot be factored.
pub fn solution(
    (pattern, block): (&LocalPattern, &Block),
    material: &Material,
    rule: &[(f64, f64)],
    (force, given): (Field<'_>, Field<'_>),
) -> Result<(usize, Vec<f64>), Failure> {
    let mut values = pattern.assemble(material, |brick| block.brick(brick));
    let size = pattern.shape.dof_count();
    let mut right = vec![0.0; size];
    for brick in pattern.bricks() {
        let dofs = pattern.brick_dofs(brick);
        for sample in samples(&block.brick(brick), rule) {
            for (component, force) in force(sample.x).into_iter().enumerate() {
                for (a, value) in sample.values.iter().enumerate() {
                    right[dofs[3 * a + component]] += sample.point.volume * value * force;
                }
            }
        }
    }
    let cells = block.grid.cells;
    let (mut prescribed, mut held) = (vec![0.0; size], vec![false; size]);
    for node in 0..pattern.shape.node_count() {
        let position = pattern.shape.local_position(node);
        if position.iter().zip(cells).any(|(&index, cells)| index == 0 || index == cells) {
            for (component, value) in given(block.coordinates(position)).into_iter().enumerate() {
                (prescribed[3 * node + component], held[3 * node + component]) = (value, true);
            }
        }
    }
    let mut image = vec![0.0; size];
    pattern.pattern.multiply(&values, &prescribed, &mut image);
    for dof in 0..size {
        right[dof] = if held[dof] { 0.0 } else { right[dof] - image[dof] };
    }
    let lower = &pattern.pattern;
    for column in 0..size {
        for position in lower.starts()[column] + 1..lower.starts()[column + 1] {
            if held[column] || held[lower.rows()[position]] {
                values[position] = 0.0;
            }
        }
    }
    let solved = pattern.symbolic(&[]).and_then(|symbolic| symbolic.solve_refined(&values, &mut right));
    solved.map_err(Failure::computation)?;
    let free = held.iter().filter(|held| !**held).count();
    Ok((free, right.iter().zip(&prescribed).map(|(free, prescribed)| free + prescribed).collect()))
}
