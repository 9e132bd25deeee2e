//! A condensed body as a compliance, with the rigid motions that its own supports leave free.
//!
//! ```text
//! S u = f − Bᵀλ   ⇔   u = C (f − Bᵀλ) + N a,   Nᵀ (f − Bᵀλ) = 0,   C = S⁺ = (S + s N Nᵀ)⁻¹ − N Nᵀ/s,   Nᵀ N = I
//! ```
//! B: the share of the body in the jumps of the packed rows: the weights of its nodes times the directions.

use crate::body::Body;
use crate::direct::condensation::CondensedBody;
use crate::equilibrium::modes::{OwnMotion, RigidScene};
use crate::equilibrium::{ContactBoundary, ContactPoint, ContactRows};
use crate::linear::dense::{DenseLu, multiply};
use crate::linear::vector::{add_scaled, dot, norm};
use crate::shelf::Factored;
use faer::Mat;
use std::sync::Arc;

/// A condensed body with its compliance, without loads.
#[derive(Debug)]
pub struct CompliantBody {
    pub(super) condensed: CondensedBody,
    /// C over the contact dofs, mm/N.
    pub(super) compliance: Mat<f64>,
    /// N: orthonormal contact displacements of the free motions.
    pub(super) motions: Vec<Vec<f64>>,
    /// The coefficients of these motions.
    coefficients: Vec<OwnMotion>,
}

/// What loads and prescribed displacements do to a compliant body.
#[derive(Debug)]
pub struct BodyLoad {
    /// u_D, mm: what supports prescribe at held dofs of the whole body, 0 at free ones.
    pub(super) lift: Vec<f64>,
    /// The loads over the whole body less K u_D, N; 0 at held dofs.
    pub(super) full: Vec<f64>,
    /// f̂_c, the same condensed onto the contact dofs, N.
    pub(super) contact: Vec<f64>,
    /// Displacement of the contact dofs under them alone, C f̂, mm.
    pub(super) free: Vec<f64>,
}

/// B of a body by rows: entries (contact dof, value); rows that it does not take part in are empty.
#[derive(Debug)]
pub struct BodyRows(Vec<Vec<(usize, f64)>>);

/// A body of a shape with its share in the jumps.
#[derive(Debug)]
pub struct ContactBody {
    pub(super) body: Arc<Factored<CompliantBody>>,
    pub(super) load: Arc<BodyLoad>,
    pub(super) rows: BodyRows,
}

impl CompliantBody {
    /// The compliance of a condensed body; the body at its positions is number `number` of a rigid scene.
    pub fn new(
        condensed: CondensedBody,
        (body, rigid): (&Body, &RigidScene),
        number: usize,
        positions: &[[f64; 3]],
    ) -> Self {
        let (motions, coefficients): (Vec<Vec<f64>>, Vec<OwnMotion>) =
            orthonormal(contact_motions((&condensed, body), rigid, number, positions)).into_iter().unzip();
        let schur = &condensed.schur;
        let size = schur.nrows();
        let scale = (0..size).map(|dof| schur[(dof, dof)]).sum::<f64>() / size as f64;
        let mut matrix = schur.clone();
        for motion in &motions {
            for (j, right) in motion.iter().enumerate() {
                add_scaled(matrix.col_as_slice_mut(j), scale * right, motion);
            }
        }
        let mut compliance = DenseLu::new(&matrix).inverse();
        for motion in &motions {
            for (j, right) in motion.iter().enumerate() {
                add_scaled(compliance.col_as_slice_mut(j), -right / scale, motion);
            }
        }
        Self { condensed, compliance, motions, coefficients }
    }

    /// The loads of a body at its positions: number `number` of a rigid scene. The condensed load takes over the
    /// resultants of the loads, of which condensation keeps fewer digits.
    pub fn loaded(&self, body: &Body, rigid: &RigidScene, number: usize, positions: &[[f64; 3]]) -> BodyLoad {
        let pattern = &self.condensed.pattern;
        let lift = pattern.lift(body);
        let full = self.condensed.loads(body, positions, &lift);
        let condensed = self.condensed.condense_loads(Mat::from_fn(full.len(), 1, |dof, _| full[dof]));
        let mut contact = condensed.col_as_slice(0).to_vec();
        for (motion, coefficients) in self.motions.iter().zip(&self.coefficients) {
            let lost = rigid.resultant(number, coefficients) - dot(motion, &contact);
            add_scaled(&mut contact, lost, motion);
        }
        BodyLoad { free: multiply(&self.compliance, &contact), lift, full, contact }
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
                    let turned = pattern.coordinates.axes.turn_at(pattern.contact[place], *direction);
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
        self.stiff().motions.iter().map(|motion| dot(motion, &self.load.contact))
    }

    /// Forces on the contact dofs, N, of packed multipliers.
    pub(super) fn contact_forces(&self, multipliers: &[f64]) -> Vec<f64> {
        self.rows.forces(multipliers, self.load.free.len())
    }

    /// Displacements of the contact dofs, mm, under packed multipliers and with given amplitudes of the free motions;
    /// with or without the loads.
    pub(super) fn displacement(&self, multipliers: &[f64], amplitudes: &[f64], loaded: bool) -> Vec<f64> {
        let mut u = multiply(&self.stiff().compliance, &self.contact_forces(multipliers));
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
    pub(super) fn extend_under(&self, body: &Body, contact: &[f64], multipliers: &[f64], load: &[f64]) -> Vec<f64> {
        let condensed = &self.stiff().condensed;
        let mut u = condensed.extend(contact, &self.contact_forces(multipliers), load);
        condensed.pattern.coordinates.displacements(&body.trace, &condensed.weights, &mut u);
        u
    }

    /// C r̂ for packed multipliers, over the contact dofs, mm: how far one step of refinement moves them.
    pub(super) fn refinement(&self, body: &Body, positions: &[[f64; 3]], multipliers: &[f64]) -> Vec<f64> {
        let (forces, condensed) = (self.contact_forces(multipliers), &self.stiff().condensed);
        let displacement = self.displacement(multipliers, &vec![0.0; self.stiff().motions.len()], true);
        let u = condensed.extend(&displacement, &forces, &self.load.full);
        let rest = condensed.unbalanced(body, positions, &u, condensed.full_force(&self.load.full, &forces));
        let rest = Mat::from_fn(rest.len(), 1, |dof, _| rest[dof]);
        multiply(&self.stiff().compliance, condensed.condense_loads(rest).col_as_slice(0))
    }
}

/// A free motion over the contact dofs, 0 at held ones, with its coefficients.
type ContactMotion = (Vec<f64>, OwnMotion);

/// The free motions of a body.
fn contact_motions(
    (condensed, body): (&CondensedBody, &Body),
    rigid: &RigidScene,
    number: usize,
    positions: &[[f64; 3]],
) -> Vec<ContactMotion> {
    let pattern = &condensed.pattern;
    let motion = |coefficients: OwnMotion| {
        let at = |&place: &usize| {
            let point = body.trace.place(&condensed.weights, pattern.piece.nodes[place], positions);
            pattern.coordinates.axes.turn_at(place, rigid.displacement(number, &coefficients, point))
        };
        let mut values: Vec<f64> = pattern.contact.iter().flat_map(at).collect();
        let dofs = values.iter_mut().enumerate().filter(|(dof, _)| pattern.holds(*dof));
        dofs.for_each(|(_, value)| *value = 0.0);
        (values, coefficients)
    };
    rigid.own_motions(number).into_iter().map(motion).collect()
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
pub(super) fn contact_stiffness(boundary: &ContactBoundary, bodies: &[ContactBody]) -> f64 {
    let of_body = |body: &ContactBody, row: usize| {
        let entries = body.rows.row(row);
        let square: f64 = entries.iter().map(|(_, value)| value * value).sum();
        let schur = &body.stiff().condensed.schur;
        let product = entries.iter().flat_map(|(i, a)| entries.iter().map(move |(j, b)| a * b * schur[(*i, *j)]));
        (square > 0.0).then(|| product.sum::<f64>() / square)
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
