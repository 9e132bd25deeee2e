//! Both kinds of cells and both formulations: kernels, patch states, derivatives against dual numbers, stresses.

use super::facet::{AreaKind, integrate, length, tributary_areas};
use super::packed::lower_start;
use super::stiffness::stress;
use super::stress::{COMPONENTS, SymmetricTensor, stress_at, von_mises};
use super::{CellNodes, Formulation, Material, hex8, tet10};
use crate::scalar::{Dual, Scalar};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;

/// A hexahedron without parallel faces, and a tetrahedron with curved edges.
fn distorted() -> [CellNodes<f64>; 2] {
    let hexahedron = hex8::CORNERS.map(|s| {
        let [i, j, k] = s.map(|s| 0.5 * (s + 1.0));
        [2.0 * i + 0.1 * j * k, 1.5 * j - 0.2 * i * k, k * (1.0 + 0.2 * i - 0.1 * j + 0.15 * i * j) + 0.1 * i]
    });
    let vertices = [[0.0, 0.0, 0.0], [2.0, 0.1, 0.2], [0.3, 1.5, -0.1], [0.2, 0.4, 1.2]];
    let tetrahedron = std::array::from_fn(|v| match v.checked_sub(4) {
        None => vertices[v],
        Some(edge) => {
            let [a, b] = tet10::EDGES[edge];
            std::array::from_fn(|axis| {
                0.5 * (vertices[a][axis] + vertices[b][axis]) + 0.05 * (1.3 * (3 * edge + axis) as f64 + 0.4).sin()
            })
        }
    });
    [CellNodes::Hex8(hexahedron), CellNodes::Tet10(tetrahedron)]
}

fn materials() -> [Material; 2] {
    let material = Material::new(1.1e5, 0.33).expect("valid material");
    [material, material.with_formulation(Formulation::MeanDilatation)]
}

/// Every cell with every formulation.
fn cases() -> impl Iterator<Item = (CellNodes<f64>, Material)> {
    distorted().into_iter().flat_map(|cell| materials().map(|material| (cell, material)))
}

fn mapped<S: Copy, T>(cell: &CellNodes<S>, mut map: impl FnMut(usize, [S; 3]) -> [T; 3]) -> CellNodes<T> {
    let mut index = 0;
    let mut next = |x: [S; 3]| {
        index += 1;
        map(index - 1, x)
    };
    match cell {
        CellNodes::Hex8(nodes) => CellNodes::Hex8(nodes.map(&mut next)),
        CellNodes::Tet10(nodes) => CellNodes::Tet10(nodes.map(&mut next)),
    }
}

/// The cell with one coordinate that moves at unit speed.
fn moving(cell: &CellNodes<f64>, node: usize, axis: usize) -> CellNodes<Dual> {
    mapped(cell, |v, x| std::array::from_fn(|i| Dual::new(x[i], f64::from(u8::from(v == node && i == axis)))))
}

fn dofs(cell: &CellNodes<f64>) -> usize {
    3 * cell.positions().len()
}

fn wave(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|i| (seed * (i as f64 + 1.0)).sin()).collect()
}

/// u = h x + shift at the nodes.
fn linear(cell: &CellNodes<f64>, h: &Matrix3<f64>, shift: [f64; 3]) -> Vec<f64> {
    let displacement = |x: &[f64; 3]| <[f64; 3]>::from(h * Vector3::from(*x) + Vector3::from(shift));
    cell.positions().iter().flat_map(displacement).collect()
}

/// K u of a matrix given by its lower triangle.
fn product<T: Scalar>(lower: &[T], u: &[f64]) -> Vec<T> {
    let entry = |i: usize, j: usize| lower[lower_start(i.max(j)) + i.min(j)];
    let row = |i: usize| {
        let mut sum = T::constant(0.0);
        u.iter().enumerate().for_each(|(j, &u)| sum += entry(i, j) * T::constant(u));
        sum
    };
    (0..u.len()).map(row).collect()
}

/// Stress, gradients of the shape functions and volume at every integration point.
fn stresses(cell: &CellNodes<f64>, material: &Material, u: &[f64]) -> Vec<(SymmetricTensor, Vec<[f64; 3]>, f64)> {
    match cell {
        CellNodes::Hex8(nodes) => {
            let points = hex8::gauss_points(nodes);
            points.iter().map(|p| (stress_at(p, &points, material, u), p.gradients.to_vec(), p.volume)).collect()
        }
        CellNodes::Tet10(nodes) => {
            let points = tet10::gauss_points(nodes);
            points.iter().map(|p| (stress_at(p, &points, material, u), p.gradients.to_vec(), p.volume)).collect()
        }
    }
}

fn full(stress: &SymmetricTensor) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for ((row, column), value) in COMPONENTS.iter().zip(stress) {
        (matrix[(*row, *column)], matrix[(*column, *row)]) = (*value, *value);
    }
    matrix
}

fn six(matrix: &Matrix3<f64>) -> SymmetricTensor {
    COMPONENTS.map(|index| matrix[index])
}

fn close(found: f64, exact: f64, bound: f64) {
    assert!((found - exact).abs() <= bound, "{found} {exact}, difference {:.1e} above {bound:.1e}", found - exact);
}

#[test]
fn rigid_motions_carry_no_force() {
    for (cell, material) in cases() {
        let matrix = cell.stiffness(&material);
        for axis in 0..3 {
            let spin = Vector3::from_fn(|i, _| f64::from(u8::from(i == axis)));
            let rotation = linear(&cell, &spin.cross_matrix(), [0.0; 3]);
            let translation = linear(&cell, &Matrix3::zeros(), spin.into());
            for force in product(&matrix, &rotation).into_iter().chain(product(&matrix, &translation)) {
                close(force, 0.0, 1e-13 * material.young_modulus() * 10.0);
            }
        }
    }
}

#[test]
fn rigid_motions_are_the_whole_kernel() {
    for (cell, material) in cases() {
        let (matrix, size) = (cell.stiffness(&material), dofs(&cell));
        let dense = nalgebra::DMatrix::from_fn(size, size, |i, j| matrix[lower_start(i.max(j)) + i.min(j)]);
        let mut values: Vec<f64> = dense.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        let largest = values[size - 1];
        // A tetrahedron of second order has 24 strains at its four points, as many as motions that are not rigid.
        assert!(values[5].abs() < 1e-12 * largest && values[6] > 1e-4 * largest, "{values:?}");
    }
}

#[test]
fn constant_strain_has_its_stress_everywhere_and_the_forces_of_it() {
    let h = Matrix3::new(1e-3, 2e-4, -3e-4, 5e-4, -7e-4, 1e-4, 0.0, 6e-4, 4e-4);
    for (cell, material) in cases() {
        let u = linear(&cell, &h, [0.3, -0.2, 0.1]);
        let tensor = std::array::from_fn(|i| std::array::from_fn(|j| h[(i, j)]));
        let exact = stress(&tensor, (material.lame_lambda(), material.shear_modulus()));
        let points = stresses(&cell, &material, &u);
        // Rounding of displacements of size 0.3 over lengths of size 1.
        let bound = 1e-13 * material.young_modulus();
        for stress in points.iter().map(|(stress, ..)| *stress).chain([cell.stress(&material, &u)]) {
            COMPONENTS.iter().zip(stress).for_each(|(&(i, j), stress)| close(stress, exact[i][j], bound));
        }
        for (dof, force) in product(&cell.stiffness(&material), &u).into_iter().enumerate() {
            let traction = |g: &[f64; 3]| (0..3).map(|j| exact[dof % 3][j] * g[j]).sum::<f64>();
            close(force, points.iter().map(|(_, g, volume)| volume * traction(&g[dof / 3])).sum(), 10.0 * bound);
        }
    }
}

#[test]
fn forces_and_energy_of_the_stress_are_those_of_the_stiffness() {
    for (cell, material) in cases() {
        let u = wave(dofs(&cell), 1.7);
        let forces = product(&cell.stiffness(&material), &u);
        let points = stresses(&cell, &material, &u);
        let largest = forces.iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
        for (dof, &force) in forces.iter().enumerate() {
            let own = |(stress, g, volume): &(SymmetricTensor, Vec<[f64; 3]>, f64)| {
                volume * (full(stress).row(dof % 3) * Vector3::from(g[dof / 3]))[0]
            };
            close(points.iter().map(own).sum(), force, 1e-13 * largest * 24.0);
        }
    }
}

#[test]
fn derivatives_by_positions_are_those_of_dual_numbers() {
    for (cell, material) in cases() {
        let (u, q) = (wave(dofs(&cell), 0.7), wave(dofs(&cell), 1.3));
        let closed = cell.position_derivative(&material, &u, &q);
        let volumes = cell.volume_derivative();
        for (node, closed) in closed.iter().enumerate() {
            for axis in 0..3 {
                let moved = moving(&cell, node, axis);
                let forces = product(&moved.stiffness(&material), &u);
                let exact: f64 = forces.iter().zip(&q).map(|(force, q)| force.derivative * q).sum();
                close(closed[axis], exact, 1e-12 * exact.abs().max(1e5));
                close(volumes[node][axis], moved.volume().derivative, 1e-13 * cell.volume());
            }
        }
    }
}

#[test]
fn forces_of_moved_nodes_do_the_work_of_the_derivative_by_positions() {
    for (cell, material) in cases() {
        let (u, q, velocities) = (wave(dofs(&cell), 0.7), wave(dofs(&cell), 1.3), wave(dofs(&cell), 2.1));
        let mut forces = vec![0.0; u.len()];
        cell.add_moved_forces(&material, &u, std::iter::once((velocities.as_slice(), forces.as_mut_slice())));
        let work: f64 = forces.iter().zip(&q).map(|(force, q)| force * q).sum();
        let derivative = cell.position_derivative(&material, &u, &q);
        let exact: f64 = derivative.iter().flatten().zip(&velocities).map(|(slope, v)| slope * v).sum();
        close(work, exact, 1e-12 * exact.abs().max(1e6));
    }
}

#[test]
fn node_volumes_sum_to_the_volume_and_to_its_first_moments() {
    for cell in distorted() {
        let weights = cell.node_volumes();
        close(weights.iter().sum(), cell.volume(), 1e-14 * cell.volume());
        for (node, weight) in weights.iter().enumerate() {
            for axis in 0..3 {
                // ∫ N dV changes by ∫ N div x′ dV: dual numbers against a difference of second order.
                let moved = moving(&cell, node, axis).node_volumes()[node].derivative;
                let shifted = |step: f64| {
                    mapped(&cell, |v, x| {
                        std::array::from_fn(|i| x[i] + if v == node && i == axis { step } else { 0.0 })
                    })
                    .node_volumes()[node]
                };
                close((shifted(1e-4) - shifted(-1e-4)) / 2e-4, moved, 1e-7 * weight.abs().max(1.0));
            }
        }
    }
}

/// σ_vM at the centre by its definition, from a central difference of the displacement gradient in dual numbers.
fn dual_von_mises(cell: &CellNodes<Dual>, mu: f64, u: &[Dual]) -> Dual {
    fn gradient<const N: usize>(point: &super::GaussPoint<Dual, N>, u: &[Dual]) -> [[Dual; 3]; 3] {
        let mut gradient = [[Dual::constant(0.0); 3]; 3];
        for (v, g) in point.gradients.iter().enumerate() {
            for i in 0..3 {
                for j in 0..3 {
                    gradient[i][j] += u[3 * v + i] * g[j];
                }
            }
        }
        gradient
    }
    let gradient = match cell {
        CellNodes::Hex8(nodes) => gradient(&hex8::centre(nodes), u),
        CellNodes::Tet10(nodes) => gradient(&tet10::centre(nodes), u),
    };
    let s = |i: usize, j: usize| Dual::constant(mu) * (gradient[i][j] + gradient[j][i]);
    let square = |x: Dual| x * x;
    let normal = square(s(0, 0) - s(1, 1)) + square(s(1, 1) - s(2, 2)) + square(s(2, 2) - s(0, 0));
    let shear = square(s(0, 1)) + square(s(1, 2)) + square(s(0, 2));
    (Dual::constant(0.5) * normal + Dual::constant(3.0) * shear).sqrt()
}

#[test]
fn derivatives_of_the_von_mises_stress_are_those_of_dual_numbers() {
    let mu = 4.1e4;
    for cell in distorted() {
        let u: Vec<f64> = wave(dofs(&cell), 1.7).iter().map(|u| 1e-3 * u).collect();
        let stressed = cell.stressed(mu, &u);
        assert_eq!(stressed.stress.to_bits(), cell.von_mises(mu, &u).to_bits());
        let constant: Vec<Dual> = u.iter().map(|&u| Dual::constant(u)).collect();
        for dof in 0..u.len() {
            let mut moved = constant.clone();
            moved[dof].derivative = 1.0;
            let exact = dual_von_mises(&mapped(&cell, |_, x| x.map(Dual::constant)), mu, &moved);
            close(stressed.stress, exact.value, 1e-13 * exact.value);
            close(stressed.by_displacement[dof / 3][dof % 3], exact.derivative, 1e-13 * 10.0 * mu);
            let exact = dual_von_mises(&moving(&cell, dof / 3, dof % 3), mu, &constant);
            close(stressed.by_position[dof / 3][dof % 3], exact.derivative, 1e-12 * stressed.stress);
        }
    }
}

#[test]
fn the_von_mises_stress_is_that_of_the_stress_in_both_formulations() {
    for (cell, material) in cases() {
        let u = wave(dofs(&cell), 1.7);
        let shown = von_mises(&cell.stress(&material, &u));
        close(cell.von_mises(material.shear_modulus(), &u), shown, 1e-12 * shown);
        let nothing = cell.stressed(material.shear_modulus(), &vec![0.0; u.len()]);
        let slopes = nothing.by_displacement.iter().chain(&nothing.by_position).flatten();
        assert!(nothing.stress == 0.0 && slopes.into_iter().all(|slope| *slope == 0.0));
    }
}

#[test]
fn von_mises_of_pure_states() {
    assert_eq!(von_mises(&[7.0, 7.0, 7.0, 0.0, 0.0, 0.0]), 0.0);
    for axis in 0..3 {
        let (mut pull, mut shear) = ([0.0; 6], [0.0; 6]);
        (pull[axis], shear[3 + axis]) = (-40.0, 40.0);
        close(von_mises(&pull), 40.0, 1e-13);
        close(von_mises(&shear), 40.0 * 3.0_f64.sqrt(), 1e-13);
    }
}

#[test]
fn areas_of_faces() {
    let rectangle = [[0.0, 0.0, 0.0], [3.0, 0.0, 4.0], [3.0, 2.0, 4.0], [0.0, 2.0, 0.0]];
    tributary_areas(&rectangle, AreaKind::Surface).into_iter().for_each(|area| close(area, 2.5, 1e-14));
    tributary_areas(&rectangle, AreaKind::Projected).into_iter().for_each(|area| close(area, 1.5, 1e-14));
    // A triangle with straight edges: the corners take a third each, the shape functions of its middles a third each.
    let triangle = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.5, 0.0], [0.0, 1.5, 0.0]];
    tributary_areas(&triangle, AreaKind::Surface).into_iter().for_each(|area| close(area, 1.0, 1e-14));
    let mut weights = [0.0; 6];
    integrate(&triangle, |point| {
        weights.iter_mut().zip(point.values).for_each(|(sum, value)| *sum += value * length(point.area));
    });
    weights.iter().zip([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).for_each(|(weight, exact)| close(*weight, exact, 1e-14));
}

#[test]
fn a_curved_triangle_has_the_area_of_its_paraboloid() {
    // x3 = h over the unit triangle at the middles alone: x3 = 4h (ξ(1 − ξ) + η(1 − η) − ξη) of second order.
    let h = 0.1;
    let triangle = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, h], [0.5, 0.5, h], [0.0, 0.5, h]];
    let mut area = 0.0;
    integrate(&triangle, |point| area += length(point.area));
    let (count, mut exact) = (2000, 0.0);
    for i in 0..count {
        for j in 0..count - i {
            // Centroids of small triangles, one per half square.
            for (shift, inside) in [(1.0 / 3.0, true), (2.0 / 3.0, i + j + 1 < count)] {
                let (xi, eta) = ((i as f64 + shift) / count as f64, (j as f64 + shift) / count as f64);
                let slopes = [4.0 * h * (1.0 - 2.0 * xi - eta), 4.0 * h * (1.0 - 2.0 * eta - xi)];
                let element = (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt();
                exact += if inside { element / (2.0 * (count * count) as f64) } else { 0.0 };
            }
        }
    }
    // The rule is exact for polynomials of degree 4; the root is not one: its error is of the sixth power of the slope.
    close(area, exact, 2e-4);
}

proptest! {
    #[test]
    fn rigid_motions_carry_no_stress(
        spin in prop::array::uniform3(-1.0_f64..1.0), shift in prop::array::uniform3(-5.0_f64..5.0),
    ) {
        for (cell, material) in cases() {
            let u = linear(&cell, &Vector3::from(spin).cross_matrix(), shift);
            for value in cell.stress(&material, &u) {
                // Rounding of displacements up to 8 over lengths of size 1.
                prop_assert!(value.abs() < 1e-13 * material.young_modulus() * 10.0, "{value}");
            }
        }
    }

    #[test]
    fn von_mises_does_not_see_rotations(
        stress in prop::array::uniform6(-1e3_f64..1e3), angles in prop::array::uniform3(-3.0_f64..3.0),
    ) {
        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let turned = rotation.matrix() * full(&stress) * rotation.matrix().transpose();
        prop_assert!((von_mises(&six(&turned)) - von_mises(&stress)).abs() < 1e-10);
    }

    #[test]
    fn stresses_and_forces_turn_with_the_cell(
        angles in prop::array::uniform3(-3.0_f64..3.0), seed in 0.1_f64..3.0,
    ) {
        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let turn = |x: [f64; 3]| <[f64; 3]>::from(rotation * Vector3::from(x));
        let turn_all = |u: &[f64]| u.as_chunks::<3>().0.iter().flat_map(|u| turn(*u)).collect::<Vec<f64>>();
        for (cell, material) in cases() {
            let u = wave(dofs(&cell), seed);
            let (turned, turned_u) = (mapped(&cell, |_, x| turn(x)), turn_all(&u));
            let expected = rotation.matrix() * full(&cell.stress(&material, &u)) * rotation.matrix().transpose();
            prop_assert!((full(&turned.stress(&material, &turned_u)) - expected).abs().max() < 1e-6);
            let forces = turn_all(&product(&cell.stiffness(&material), &u));
            for (found, exact) in product(&turned.stiffness(&material), &turned_u).iter().zip(forces) {
                prop_assert!((found - exact).abs() < 1e-6, "{found} {exact}");
            }
        }
    }
}
