//! A condensed body as a compliance, with the rigid motions that its own supports leave free.
//!
//! ```text
//! w = C (f̂ − Bᵀλ) + N a,   Nᵀ (f̂ − Bᵀλ) = 0                 N = B R,  Nᵀ N = I;   f̂: loads put on the contact dofs
//! springs:       C = P Ĉ P,   C f̂ = P B K̂⁻¹ (f − Bᵀ N Rᵀf),   u = K̂⁻¹ (f − Bᵀλ) + R b              P = I − N Nᵀ
//! foundation σ:  C = ((I − σ Ĉ + N Nᵀ)⁻¹ − I)/σ,   C f̂ = (P + σ C) B K̂⁻¹ f,   u = K̂⁻¹ (f − Bᵀλ + σ Bᵀ w)
//! ```
//! K̂, Ĉ: of the condensed body; R: the motions over the whole body. B of the packed rows: the share of the body in
//! their jumps, the weights of its nodes times the directions.

use crate::body::Body;
use crate::direct::condensation::{CondensationPattern, CondensedBody};
use crate::equilibrium::modes::{OwnMotion, RigidScene};
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactProblem, ContactRows};
use crate::error::ContactError;
use crate::linear::dense::{inverse, multiply, multiply_columns};
use crate::linear::vector::{add_scaled, dot, norm};
use crate::shelf::Factored;
use faer::Mat;
use std::sync::Arc;

/// A condensed body with its compliance, without loads.
#[derive(Debug)]
pub struct CompliantBody {
    /// With C.
    pub(super) condensed: CondensedBody,
    /// N: orthonormal contact displacements of the free motions.
    pub(super) motions: Vec<Vec<f64>>,
    /// R: these motions over the whole body.
    fields: Vec<Vec<f64>>,
    /// Ĉ N, mm/N; none on a foundation.
    drift: Vec<Vec<f64>>,
    /// The coefficients of these motions.
    coefficients: Vec<OwnMotion>,
}

/// What forces over the whole body do to its contact dofs, one column per load.
#[derive(Debug)]
pub(super) struct Response {
    /// C f̂, mm.
    pub(super) displacement: Mat<f64>,
    /// Nᵀ f̂, N.
    pub(super) resultants: Mat<f64>,
}

/// What loads and prescribed displacements do to a compliant body.
#[derive(Debug)]
pub struct BodyLoad {
    /// u_D, mm: what supports prescribe at held dofs of the whole body, 0 at free ones.
    pub(super) lift: Vec<f64>,
    /// The loads over the whole body less K u_D, N; 0 at held dofs.
    pub(super) full: Vec<f64>,
    /// Displacement of the contact dofs under them alone, C f̂, mm.
    pub(super) free: Vec<f64>,
    /// Nᵀ f̂, N: the resultants of the loads.
    pub(super) resultants: Vec<f64>,
}

/// B of a body by rows: entries (contact dof, value); rows that it does not take part in are empty.
#[derive(Debug, PartialEq)]
pub struct BodyRows(Vec<Vec<(usize, f64)>>);

/// A body of a shape with its share in the jumps.
#[derive(Debug)]
pub struct ContactBody {
    pub(super) body: Arc<Factored<CompliantBody>>,
    pub(super) load: Arc<BodyLoad>,
    pub(super) rows: Arc<BodyRows>,
}

impl CompliantBody {
    /// Condenses a body at its positions: number `number` of a rigid scene.
    ///
    /// # Errors
    /// As [`CondensationPattern::condense`].
    pub(super) fn new(
        pattern: &Arc<CondensationPattern>,
        (body, rigid): (&Body, &RigidScene),
        number: usize,
        positions: &[[f64; 3]],
    ) -> Result<Self, ContactError> {
        let free = rigid.own_motions(number);
        let field = |motion: &OwnMotion| field(pattern, (rigid, number), motion, positions);
        let mut condensed = pattern.condense(body, positions, &free.iter().map(field).collect::<Vec<_>>())?;
        let with_contact = |motion: &OwnMotion| (condensed.contact_part(&field(motion)), *motion);
        let (motions, coefficients): (Vec<Vec<f64>>, Vec<OwnMotion>) =
            orthonormal(free.iter().map(with_contact).collect()).into_iter().unzip();
        let mut drift = Vec::new();
        if let Some(foundation) = condensed.foundation {
            remove_foundation(&mut condensed.compliance, &motions, foundation);
        } else {
            drift.extend(motions.iter().map(|motion| multiply(&condensed.compliance, motion)));
            remove_motions(&mut condensed.compliance, &motions, &drift);
        }
        let fields = coefficients.iter().map(field).collect();
        Ok(Self { condensed, motions, fields, drift, coefficients })
    }

    /// C over the contact dofs, mm/N.
    pub(super) fn compliance(&self) -> &Mat<f64> {
        &self.condensed.compliance
    }

    /// The loads of a body at its positions: number `number` of a rigid scene, whose resultants are theirs: those of K
    /// u_D are rounding.
    pub(super) fn loaded(&self, body: &Body, rigid: &RigidScene, number: usize, positions: &[[f64; 3]]) -> BodyLoad {
        let lift = self.condensed.pattern.lift(body);
        let full = self.condensed.loads(body, positions, &lift);
        let response = self.response(Mat::from_fn(full.len(), 1, |dof, _| full[dof]));
        let resultants = self.coefficients.iter().map(|motion| rigid.resultant(number, motion)).collect();
        BodyLoad { free: response.displacement.col_as_slice(0).to_vec(), lift, full, resultants }
    }

    /// What forces over the whole body, N, 0 at held dofs, do to its contact dofs.
    pub(super) fn response(&self, mut forces: Mat<f64>) -> Response {
        let columns = forces.ncols();
        let resultant = |mode: usize, column: usize| dot(&self.fields[mode], forces.col_as_slice(column));
        let resultants = Mat::from_fn(self.fields.len(), columns, resultant);
        self.condensed.solve(&mut forces);
        let mut displacement = Mat::zeros(self.condensed.compliance.nrows(), columns);
        for column in 0..columns {
            let mut moved = self.condensed.contact_part(forces.col_as_slice(column));
            if let Some(foundation) = self.condensed.foundation {
                let forces: Vec<f64> = moved.iter().map(|moved| foundation * moved).collect();
                add_scaled(&mut moved, 1.0, &multiply(self.compliance(), &forces));
            }
            let drifts = self.drift.iter().enumerate();
            drifts.for_each(|(mode, drift)| add_scaled(&mut moved, -resultants[(mode, column)], drift));
            for motion in &self.motions {
                let share = dot(motion, &moved);
                add_scaled(&mut moved, -share, motion);
            }
            displacement.col_as_slice_mut(column).copy_from_slice(&moved);
        }
        Response { displacement, resultants }
    }

    /// What forces on the contact dofs, N, do to them.
    pub(super) fn contact_response(&self, forces: &Mat<f64>) -> Response {
        let resultant = |mode: usize, column: usize| dot(&self.motions[mode], forces.col_as_slice(column));
        let resultants = Mat::from_fn(self.motions.len(), forces.ncols(), resultant);
        Response { displacement: multiply_columns(self.compliance(), forces), resultants }
    }

    /// Displacements of the whole body, mm, under loads in equilibrium over it and on its contact dofs, N, column by
    /// column; those of the contact dofs are given, one vector per column.
    pub(super) fn extended(&self, mut forces: Mat<f64>, on_contact: &[Vec<f64>], contact: &[Vec<f64>]) -> Mat<f64> {
        for (column, (own, moved)) in on_contact.iter().zip(contact).enumerate() {
            let mut own = own.clone();
            add_scaled(&mut own, self.condensed.foundation.unwrap_or(0.0), moved);
            self.condensed.add_contact_forces(&own, forces.col_as_slice_mut(column));
        }
        self.condensed.solve(&mut forces);
        if self.condensed.foundation.is_some() {
            return forces;
        }
        for (column, contact) in contact.iter().enumerate() {
            let u = forces.col_as_slice_mut(column);
            let mut missing = contact.clone();
            add_scaled(&mut missing, -1.0, &self.condensed.contact_part(u));
            for (motion, field) in self.motions.iter().zip(&self.fields) {
                add_scaled(u, dot(motion, &missing), field);
            }
        }
        forces
    }
}

/// C of Ĉ on a foundation.
fn remove_foundation(compliance: &mut Mat<f64>, motions: &[Vec<f64>], foundation: f64) {
    let size = compliance.nrows();
    for column in 0..size {
        let target = compliance.col_as_slice_mut(column);
        target.iter_mut().for_each(|c| *c *= -foundation);
        target[column] += 1.0;
        motions.iter().for_each(|motion| add_scaled(target, motion[column], motion));
    }
    *compliance = inverse(std::mem::replace(compliance, Mat::new()));
    for column in 0..size {
        let target = compliance.col_as_slice_mut(column);
        target[column] -= 1.0;
        target.iter_mut().for_each(|c| *c /= foundation);
    }
}

/// C ← (I − N Nᵀ) C (I − N Nᵀ), given C N.
fn remove_motions(compliance: &mut Mat<f64>, motions: &[Vec<f64>], drift: &[Vec<f64>]) {
    let (size, count) = (compliance.nrows(), motions.len());
    // C − N Xᵀ − X Nᵀ with X = C N − ½ N (Nᵀ C N).
    let columns = |vectors: &[Vec<f64>]| Mat::from_fn(size, count, |row, mode| vectors[mode][row]);
    let (motions, mut shares) = (columns(motions), columns(drift));
    let inner = multiply_columns(&motions.transpose().to_owned(), &shares);
    shares -= multiply_columns(&motions, &inner) * faer::Scale(0.5);
    for column in 0..size {
        for mode in 0..count {
            let (own, share) = (motions[(column, mode)], shares[(column, mode)]);
            let target = compliance.col_as_slice_mut(column);
            add_scaled(target, -share, motions.col_as_slice(mode));
            add_scaled(target, -own, shares.col_as_slice(mode));
        }
    }
}

impl BodyRows {
    /// The rows of a shape on the contact dofs of a body.
    pub fn new(number: usize, condensed: &CondensedBody, boundary: &ContactBoundary, rows: &ContactRows) -> Self {
        let pattern = &condensed.pattern;
        let mut all = Vec::with_capacity(boundary.row_count);
        for (point, node) in boundary.points.iter().zip(&rows.nodes) {
            let sides = point.sides.iter().zip(&node.weights);
            let own = sides.filter(|(side, weight)| side.body == number && **weight != 0.0);
            let own: Vec<(usize, f64)> =
                own.filter_map(|(side, weight)| Some((pattern.contact_place(side.node)?, *weight))).collect();
            for direction in &node.directions {
                let entries = own.iter().flat_map(|&(place, weight)| {
                    let turned = pattern.axes.turn_at(pattern.contact[place], *direction);
                    (0..3).map(move |axis| (3 * place + axis, weight * turned[axis]))
                });
                all.push(entries.filter(|(dof, value)| *value != 0.0 && !pattern.holds(*dof)).collect());
            }
        }
        Self(all)
    }

    /// Entries of a row.
    pub(super) fn row(&self, row: usize) -> &[(usize, f64)] {
        &self.0[row]
    }

    /// Adds B u to values over the packed rows.
    pub(super) fn add_jumps(&self, u: &[f64], factor: f64, jumps: &mut [f64]) {
        for (jump, entries) in jumps.iter_mut().zip(&self.0) {
            *jump += factor * entries.iter().map(|(dof, value)| value * u[*dof]).sum::<f64>();
        }
    }

    /// The forces −Bᵀλ on the contact dofs.
    pub(super) fn forces(&self, multipliers: &[f64], dofs: usize) -> Vec<f64> {
        let mut forces = vec![0.0; dofs];
        for (multiplier, entries) in multipliers.iter().zip(&self.0) {
            entries.iter().for_each(|(dof, value)| forces[*dof] -= value * multiplier);
        }
        forces
    }

    /// Adds B C Bᵀ.
    pub(super) fn add_compliance(&self, compliance: &Mat<f64>, sum: &mut Mat<f64>) {
        let mut product = vec![0.0; compliance.nrows()];
        for (column, entries) in self.0.iter().enumerate() {
            product.fill(0.0);
            entries.iter().for_each(|(dof, value)| add_scaled(&mut product, *value, compliance.col_as_slice(*dof)));
            self.add_jumps(&product, 1.0, sum.col_as_slice_mut(column));
        }
    }
}

impl ContactBody {
    /// The body without loads.
    pub(super) fn stiff(&self) -> &CompliantBody {
        &self.body.factors
    }

    /// Nᵀf of the loads, N.
    pub(super) fn resultants(&self) -> impl Iterator<Item = f64> + '_ {
        self.load.resultants.iter().copied()
    }

    /// Forces on the contact dofs, N, of packed multipliers.
    pub(super) fn contact_forces(&self, multipliers: &[f64]) -> Vec<f64> {
        self.rows.forces(multipliers, self.load.free.len())
    }

    /// Displacements of the contact dofs, mm, under packed multipliers and with given amplitudes of the free motions;
    /// with or without the loads.
    pub(super) fn displacement(&self, multipliers: &[f64], amplitudes: &[f64], loaded: bool) -> Vec<f64> {
        let mut u = multiply(self.stiff().compliance(), &self.contact_forces(multipliers));
        if loaded {
            add_scaled(&mut u, 1.0, &self.load.free);
        }
        for (motion, amplitude) in self.stiff().motions.iter().zip(amplitudes) {
            add_scaled(&mut u, *amplitude, motion);
        }
        u
    }

    /// Displacements of the whole body along the axes under a load over it (0 at held dofs), from those of its contact
    /// dofs and packed multipliers.
    pub(super) fn extend_under(&self, contact: &[f64], multipliers: &[f64], load: &[f64]) -> Vec<f64> {
        let (forces, load) = (self.contact_forces(multipliers), Mat::from_fn(load.len(), 1, |dof, _| load[dof]));
        let mut u = self.stiff().extended(load, &[forces], &[contact.to_vec()]).col_as_slice(0).to_vec();
        self.stiff().condensed.pattern.axes.turn_back(&mut u);
        u
    }

    /// C r̂ for packed multipliers, over the contact dofs, mm: how far one step of refinement moves them.
    pub(super) fn refinement(&self, body: &Body, positions: &[[f64; 3]], multipliers: &[f64]) -> Vec<f64> {
        let (stiff, on_contact) = (self.stiff(), self.contact_forces(multipliers));
        let moved = self.displacement(multipliers, &vec![0.0; stiff.motions.len()], true);
        let load = Mat::from_fn(self.load.full.len(), 1, |dof, _| self.load.full[dof]);
        let u = stiff.extended(load, std::slice::from_ref(&on_contact), &[moved]);
        let mut forces = self.load.full.clone();
        stiff.condensed.add_contact_forces(&on_contact, &mut forces);
        let rest = stiff.condensed.unbalanced(body, positions, u.col_as_slice(0), forces);
        let rest = Mat::from_fn(rest.len(), 1, |dof, _| rest[dof]);
        stiff.response(rest).displacement.col_as_slice(0).to_vec()
    }
}

/// A free motion over the contact dofs, 0 at held ones, with its coefficients.
type ContactMotion = (Vec<f64>, OwnMotion);

/// A free motion of a body over its dofs, 0 at held ones.
fn field(
    pattern: &CondensationPattern,
    (rigid, number): (&RigidScene, usize),
    motion: &OwnMotion,
    positions: &[[f64; 3]],
) -> Vec<f64> {
    let at = |point: [f64; 3]| rigid.displacement(number, motion, point);
    let mut values: Vec<f64> = pattern.piece.positions(positions).flat_map(at).collect();
    pattern.free_forces(&mut values);
    values
}

/// Orthonormal motions over the contact dofs.
fn orthonormal(motions: Vec<ContactMotion>) -> Vec<ContactMotion> {
    let mut basis: Vec<ContactMotion> = Vec::new();
    for (mut motion, mut coefficients) in motions {
        // Twice, since once leaves rounding in the older directions.
        for _pass in 0..2 {
            for (older, of_older) in &basis {
                let share = dot(older, &motion);
                add_scaled(&mut motion, -share, older);
                add_scaled(&mut coefficients, -share, of_older);
            }
            let length = norm(&motion);
            motion.iter_mut().chain(&mut coefficients).for_each(|value| *value /= length);
        }
        basis.push((motion, coefficients));
    }
    basis
}

/// Mean normal stiffness of the contact nodes, bodies in series, N/mm.
pub(super) fn contact_stiffness(problem: &ContactProblem, bodies: &[ContactBody]) -> f64 {
    let boundary = &problem.boundary;
    let of_body = |body: &ContactBody, row: usize| {
        let entries = body.rows.row(row);
        let square: f64 = entries.iter().map(|(_, value)| value * value).sum();
        let CondensedBody { local, foundation, .. } = &body.stiff().condensed;
        let share = foundation.map_or_else(|| problem.diagonal_share(), |_| 1.0);
        let product = entries.iter().flat_map(|(i, a)| {
            let same = entries.iter().filter(move |(j, _)| i / 3 == j / 3);
            same.map(move |(j, b)| a * b * local[i / 3][i % 3][j % 3])
        });
        (square > 0.0).then(|| share * product.sum::<f64>() / square)
    };
    let series = |point: &ContactPoint| {
        let own: Vec<f64> = bodies.iter().filter_map(|body| of_body(body, point.start)).collect();
        match own[..] {
            [only] => only,
            _ => 1.0 / own.iter().map(|stiffness| 1.0 / stiffness).sum::<f64>(),
        }
    };
    boundary.points.iter().map(series).sum::<f64>() / boundary.points.len() as f64
}
