//! The generalised inverse of a cluster: subdomains that B_c holds together, with one set of six rigid motions.
//!
//! ```text
//! K u + B_cᵀ μ = f,   B_c u = 0:        u = K⁺(f − B_cᵀ μ) + R α,        G_c μ = Rᵀ f,    G_c = Rᵀ B_cᵀ
//! W = [√σ K⁺B_cᵀ   R/√σ],   A = [ σ B_c K⁺ B_cᵀ   G_cᵀ ]        K̂⁺ = K⁺ − W A⁻¹ Wᵀ                      method.md (4.10)
//!                               [ G_c          − N Nᵀ ]
//! ```
//! N: amplitudes α of the six rigid motions of the cluster, orthonormal; G_cᵀ N = 0. Forces f in balance on the
//! cluster, Nᵀ Rᵀ f = 0, give Nᵀ α = 0, and u solves the two equations. σ is a mean diagonal of K, so that A has no
//! unit. G_c G_cᵀ + N Nᵀ is regular exactly if the cluster has no motion but these six.
//!
//! References: \[KlawonnRheinbach2010\], \[RihaBrzobohatyMarkopoulosMecaKozubek2016\].

use crate::body::MOTIONS;
use crate::error::ContactError;
use crate::linear::dense::{DenseLu, multiply_columns};
use crate::linear::entry::{Entry, LANES, Row, vectorized};
use crate::linear::right_side::RightSide;
use crate::linear::vector::dot;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::factors::SubdomainFactors;
use crate::tfeti::torn::rigid_modes::{orthonormal_modes, orthonormalise};
use faer::Mat;
use std::sync::Arc;

/// What joins the subdomains of one cluster.
#[derive(Debug)]
pub struct ClusterFactors {
    members: Vec<MemberFactors>,
    /// A⁻¹ with its first rows and columns times √σ and the others over √σ: it takes B_c K⁺ f and Rᵀ f to μ and −α.
    inverse: Mat<f64>,
    /// Number of rows of B_c.
    row_count: usize,
}

/// The part of one subdomain.
#[derive(Debug)]
struct MemberFactors {
    /// K⁺ e for the dofs e with rows of B_c, one after the other.
    columns: Vec<f64>,
    /// The part of N: motion by motion of the cluster, its amplitudes along the modes of the subdomain.
    motions: [[f64; MOTIONS]; MOTIONS],
}

/// Pivot ratio of G_c G_cᵀ + N Nᵀ that counts as singular.
const SINGULAR: f64 = 1e-12;

/// Amplitudes of the six rigid motions of a cluster along the orthonormal modes of its subdomains, orthonormal.
fn motions(coordinates: &[Vec<[f64; 3]>], modes: &[&[Vec<f64>]]) -> Vec<Vec<f64>> {
    let whole = orthonormal_modes(&coordinates.concat());
    let amplitudes = |motion: &Vec<f64>| {
        let mut first = 0;
        let parts = modes.iter().flat_map(|modes| {
            let part = &motion[first..first + modes[0].len()];
            first += part.len();
            modes.iter().map(move |mode| dot(mode, part))
        });
        parts.collect::<Vec<f64>>()
    };
    let mut motions: Vec<Vec<f64>> = whole.iter().map(amplitudes).collect();
    orthonormalise(&mut motions);
    motions
}

/// The rows G_c of a cluster.
fn rigid_rows(rows: &ClusterRows, modes: &[&[Vec<f64>]]) -> Mat<f64> {
    let mut matrix = Mat::<f64>::zeros(MOTIONS * modes.len(), rows.count);
    for (index, (member, modes)) in rows.members.iter().zip(modes).enumerate() {
        for &(row, place, value) in &member.entries {
            for (motion, mode) in modes.iter().enumerate() {
                matrix[(MOTIONS * index + motion, row)] += value * mode[member.dofs[place]];
            }
        }
    }
    matrix
}

/// The matrix N Nᵀ of the held motions.
fn held(motions: &[Vec<f64>]) -> Mat<f64> {
    let size = motions[0].len();
    Mat::from_fn(size, size, |row, column| motions.iter().map(|motion| motion[row] * motion[column]).sum())
}

/// Whether the rows of a cluster leave it no more than the six rigid motions; `coordinates` of its nodes.
pub fn moves_as_one_body(rows: &ClusterRows, coordinates: &[Vec<[f64; 3]>]) -> bool {
    let modes: Vec<Vec<Vec<f64>>> = coordinates.iter().map(|nodes| orthonormal_modes(nodes)).collect();
    let modes: Vec<&[Vec<f64>]> = modes.iter().map(Vec::as_slice).collect();
    let rigid = rigid_rows(rows, &modes);
    let matrix = multiply_columns(&rigid, &rigid.transpose().to_owned()) + held(&motions(coordinates, &modes));
    DenseLu::new(&matrix).pivot_ratio() > SINGULAR
}

impl ClusterFactors {
    /// Joins factored subdomains; `coordinates` of their nodes, `stiffness`: σ, N/mm.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when A is singular.
    pub fn new(
        rows: &ClusterRows,
        parts: &[Arc<SubdomainFactors>],
        coordinates: &[Vec<[f64; 3]>],
        stiffness: f64,
    ) -> Result<Self, ContactError> {
        let modes: Vec<&[Vec<f64>]> = parts.iter().map(|part| part.modes.as_slice()).collect();
        let (motions, rigid) = (motions(coordinates, &modes), rigid_rows(rows, &modes));
        let (count, amplitudes) = (rows.count, MOTIONS * parts.len());
        let mut matrix = Mat::<f64>::zeros(count + amplitudes, count + amplitudes);
        let mut members = Vec::with_capacity(parts.len());
        for (index, (member, part)) in rows.members.iter().zip(parts).enumerate() {
            let columns = columns(part, &member.dofs);
            let size = part.modes[0].len();
            for &(row, left, first) in &member.entries {
                for &(column, right, second) in &member.entries {
                    matrix[(row, column)] += stiffness * first * second * columns[right * size + member.dofs[left]];
                }
            }
            let part = |motion: usize| std::array::from_fn(|mode| motions[motion][MOTIONS * index + mode]);
            members.push(MemberFactors { columns, motions: std::array::from_fn(part) });
        }
        let held = held(&motions);
        for row in 0..amplitudes {
            (0..count).for_each(|column| {
                matrix[(count + row, column)] = rigid[(row, column)];
                matrix[(column, count + row)] = rigid[(row, column)];
            });
            (0..amplitudes).for_each(|column| matrix[(count + row, count + column)] = -held[(row, column)]);
        }
        let factor = DenseLu::new(&matrix);
        let ratio = factor.pivot_ratio();
        if !ratio.is_finite() || ratio <= f64::EPSILON {
            let (what, reason) =
                ("generalised inverse of a cluster".into(), "the matrix of its rows is singular".into());
            return Err(ContactError::Factorization { what, reason });
        }
        let mut inverse = Mat::<f64>::identity(count + amplitudes, count + amplitudes);
        factor.solve_columns_in_place(&mut inverse);
        let scale = |index: usize| if index < count { stiffness.sqrt() } else { stiffness.sqrt().recip() };
        // Rounding alone makes the inverse differ from its transpose.
        let inverse = Mat::from_fn(count + amplitudes, count + amplitudes, |row, column| {
            0.5 * scale(row) * scale(column) * (inverse[(row, column)] + inverse[(column, row)])
        });
        Ok(Self { members, inverse, row_count: count })
    }

    /// μ and −α for forces f of which K⁺ f and Rᵀ f are given, subdomain by subdomain.
    pub fn reactions<V: RightSide>(&self, rows: &ClusterRows, free: &[&[V]], resultants: &[[V; MOTIONS]]) -> Vec<V> {
        let mut right = vec![V::Double::ZERO; self.inverse.nrows()];
        for (member, free) in rows.members.iter().zip(free) {
            for &(row, place, value) in &member.entries {
                right[row].add_scaled(value, &free[member.dofs[place]].double());
            }
        }
        let resultants = resultants.as_flattened().iter().map(RightSide::double);
        right[self.row_count..].iter_mut().zip(resultants).for_each(|(right, resultant)| *right = resultant);
        let mut result = vec![V::Double::ZERO; right.len()];
        vectorized(
            #[inline(always)]
            || {
                for (column, right) in right.iter().enumerate() {
                    let values = self.inverse.col(column).iter();
                    result.iter_mut().zip(values).for_each(|(result, value)| result.accumulate(*value, right));
                }
            },
        );
        result.into_iter().map(V::rounded).collect()
    }

    /// x −= K⁺ B_cᵀ μ − R α on one subdomain, for what [`ClusterFactors::reactions`] returns.
    pub fn join<V: Entry>(
        &self,
        rows: &ClusterRows,
        index: usize,
        part: &SubdomainFactors,
        reactions: &[V],
        x: &mut [V],
    ) {
        let (member, factors) = (&rows.members[index], &self.members[index]);
        let mut forces = vec![V::ZERO; member.dofs.len()];
        for &(row, place, value) in &member.entries {
            forces[place].add_scaled(-value, &reactions[row]);
        }
        let own = &reactions[self.row_count + MOTIONS * index..][..MOTIONS];
        let mut amplitudes: Vec<V> = own.to_vec();
        amplitudes.iter_mut().for_each(|amplitude| amplitude.scale(-1.0));
        vectorized(
            #[inline(always)]
            || {
                let columns = factors.columns.chunks_exact(x.len()).chain(part.modes.iter().map(Vec::as_slice));
                for (column, factor) in columns.zip(forces.iter().chain(&amplitudes)) {
                    x.iter_mut().zip(column).for_each(|(x, &value)| x.accumulate(value, factor));
                }
            },
        );
    }

    /// Amplitudes along the modes of a subdomain for one of the six motions of the cluster.
    pub fn motion_of(&self, index: usize, motion: usize) -> &[f64; MOTIONS] {
        &self.members[index].motions[motion]
    }

    /// Amplitudes along the modes of a subdomain for those of the cluster.
    pub fn amplitudes_of(&self, index: usize, cluster: &[f64]) -> [f64; MOTIONS] {
        let motions = &self.members[index].motions;
        std::array::from_fn(|mode| motions.iter().zip(cluster).map(|(motion, a)| motion[mode] * a).sum())
    }

    /// Adds resultants along the modes of a subdomain to those along the motions of the cluster.
    pub fn add_resultants<V: Entry>(&self, index: usize, own: &[V], cluster: &mut [V]) {
        for (sum, motion) in cluster.iter_mut().zip(&self.members[index].motions) {
            motion.iter().zip(own).for_each(|(&value, own)| sum.add_scaled(value, own));
        }
    }
}

/// K⁺ e of some dofs e, one after the other.
fn columns(part: &SubdomainFactors, dofs: &[usize]) -> Vec<f64> {
    let size = part.modes[0].len();
    let mut columns = vec![0.0; size * dofs.len()];
    for (group, columns) in dofs.chunks(LANES).zip(columns.chunks_mut(size * LANES)) {
        let mut block = vec![Row::<f64, 1>::ZERO; size];
        group.iter().enumerate().for_each(|(column, &dof)| block[dof].set(column, 1.0));
        part.solve(&mut block);
        for (column, values) in columns.chunks_exact_mut(size).enumerate() {
            values.iter_mut().zip(&block).for_each(|(value, row)| *value = row.get(column));
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tfeti::torn::scene_rows;

    /// Two bricks side by side along the first axis, glued at some of the four nodes between them.
    fn two_bricks(glued: &[usize]) -> (ClusterRows, Vec<Vec<[f64; 3]>>) {
        let corner = |node: usize| [node & 1, (node >> 1) & 1, node >> 2].map(|index| index as f64);
        let first: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let second: Vec<[f64; 3]> = first.iter().map(|[x, y, z]| [x + 1.0, *y, *z]).collect();
        let half = 0.5_f64.sqrt();
        let row =
            |node: usize| (0..3).map(move |c| vec![(3 * (2 * node + 1) + c, half), (24 + 3 * 2 * node + c, -half)]);
        let rows: Vec<scene_rows::SparseRow> = glued.iter().flat_map(|&node| row(node)).collect();
        (ClusterRows::new(&rows, &[0, 24, 48]), vec![first, second])
    }

    #[test]
    fn only_three_nodes_off_a_line_make_one_body() {
        for (glued, one) in
            [(&[0, 1, 2][..], true), (&[0, 1, 2, 3], true), (&[0, 3], false), (&[1], false), (&[], false)]
        {
            let (rows, coordinates) = two_bricks(glued);
            assert_eq!(moves_as_one_body(&rows, &coordinates), one, "{glued:?}");
        }
    }
}
