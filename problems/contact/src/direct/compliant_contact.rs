//! The contact problem of condensed bodies in contact forces and rigid motions.
//!
//! ```text
//! w(λ, a) = d − C λ + R a,   Rᵀ λ = e,   λ = Π(λ + w)          C in units of 1/c, forces in units of the load
//! ```
//! c is the mean normal stiffness of the contact nodes: the stiffness of what a contact force moves when all other
//! nodes rest. The entries of C are no unit: where a body is nearly free to move, they are larger than any approach of
//! contact nodes that matters, and residuals relative to them would say nothing. C is the sum of the bodies'
//! compliances over the packed rows, R a the jumps of their free rigid motions. Motions that no contact node feels are
//! left out: no force depends on them.

use crate::direct::compliant_body::ContactBody;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{ContactProblem, ContactRows};
use crate::linear::dense::multiply;
use crate::linear::vector::{add_scaled, dot};
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Singular value of R up to which a motion counts as untouched by contact. The motions of a body have length 1; the
/// largest singular value is no measure, since it is rounding where contact touches no motion.
const UNTOUCHED: f64 = 1e-10;

/// The contact problem in forces and rigid motions, dimensionless. Its unknowns are one vector: the packed forces λ
/// over the load, then the amplitudes a of the rigid motions that contact feels.
#[derive(Debug)]
pub struct CompliantContact {
    /// The discrete problem: contact nodes, friction, layout of the packed rows.
    pub problem: Arc<ContactProblem>,
    /// C, symmetric, rows × rows; shared by load cases.
    pub compliance: Arc<Mat<f64>>,
    /// R: jumps of the rigid motions, rows × motions, with orthonormal columns.
    pub motions: Mat<f64>,
    /// e: what contact must carry along the motions.
    pub resultant: Vec<f64>,
    /// Unit of forces, N.
    pub load: f64,
    /// Unit of compliances, mm/N.
    pub unit: f64,
    pub(super) bodies: Vec<ContactBody>,
    /// The contact rows of the shape.
    pub(super) rows: Arc<ContactRows>,
    /// Where the bodies are.
    pub(super) placement: Placement,
    /// From the amplitudes of R to those of the bodies' own motions.
    basis: DMatrix<f64>,
    /// From the bodies' own amplitudes to those of R.
    inverse_basis: DMatrix<f64>,
}

/// Where the bodies are when the amplitudes are 0.
#[derive(Debug, Clone)]
pub(super) struct Placement {
    /// d: jumps less gaps under loads and prescribed displacements alone, per row, the rigid motions so far included.
    constant: Vec<f64>,
    /// The amplitudes of these motions.
    offset: Vec<f64>,
}

impl CompliantContact {
    /// The problem of some bodies with given contact rows and their compliance in its unit; units: of forces, the load,
    /// N; of compliances, mm/N.
    pub fn new(
        problem: Arc<ContactProblem>,
        bodies: Vec<ContactBody>,
        (rows, compliance): (Arc<ContactRows>, Arc<Mat<f64>>),
        [load, unit]: [f64; 2],
    ) -> Self {
        let boundary = &problem.boundary;
        let count = boundary.row_count;
        let mut constant = rows.prescribed_approaches(boundary, &problem.bodies);
        for ContactBody { load, rows, .. } in &bodies {
            rows.add_jumps(&load.free, 1.0, &mut constant);
        }
        constant.iter_mut().for_each(|d| *d /= unit * load);
        let [motions, basis, inverse_basis] = touched_motions(&bodies, count);
        let own: Vec<f64> = bodies.iter().flat_map(ContactBody::resultants).collect();
        let resultant = (basis.transpose() * DVector::from_vec(own) / load).iter().copied().collect();
        let motions = Mat::from_fn(count, motions.ncols(), |i, k| motions[(i, k)]);
        let offset = vec![0.0; motions.ncols()];
        let placement = Placement { constant, offset };
        Self { placement, problem, compliance, motions, resultant, load, unit, bodies, rows, basis, inverse_basis }
    }

    /// Changes the unit of forces, N, and that of given unknowns.
    pub(super) fn rescale(&mut self, load: f64, unknowns: &mut [f64]) {
        let factor = self.load / load;
        let placed = self.placement.constant.iter_mut().chain(&mut self.placement.offset);
        placed.chain(&mut self.resultant).chain(unknowns).for_each(|value| *value *= factor);
        self.load = load;
    }

    /// Number of packed rows.
    pub fn row_count(&self) -> usize {
        self.compliance.nrows()
    }

    /// d: jumps less gaps under loads and prescribed displacements alone, per row, dimensionless.
    pub fn constant(&self) -> &[f64] {
        &self.placement.constant
    }

    /// w = d − (C + δ) λ + R a.
    pub fn jumps(&self, unknowns: &[f64], delta: f64) -> Vec<f64> {
        let (forces, amplitudes) = unknowns.split_at(self.row_count());
        let product = multiply(&self.compliance, forces);
        let rigid = multiply(&self.motions, amplitudes);
        let constant = self.constant();
        (0..self.row_count()).map(|i| constant[i] - product[i] - delta * forces[i] + rigid[i]).collect()
    }

    /// (λ − Π(x), Rᵀλ − e) and x = λ + w/(1 + δ).
    pub fn residual(&self, unknowns: &[f64], delta: f64) -> (Vec<f64>, Vec<f64>) {
        let boundary = &self.problem.boundary;
        let forces = &unknowns[..self.row_count()];
        let jumps = self.jumps(unknowns, delta);
        let arguments: Vec<f64> = forces.iter().zip(&jumps).map(|(force, jump)| force + jump / (1.0 + delta)).collect();
        let mut residual = vec![0.0; self.row_count()];
        for node in &boundary.points {
            let range = node.rows();
            node.project(&arguments[range.clone()], &mut residual[range]);
        }
        residual.iter_mut().zip(forces).for_each(|(projected, force)| *projected = force - *projected);
        for (column, load) in self.resultant.iter().enumerate() {
            residual.push(dot(self.motions.col_as_slice(column), forces) - load);
        }
        (residual, arguments)
    }

    /// Moves the bodies by the rigid motions of given unknowns: d := d + R a, a := 0. Jumps of nodes in contact are
    /// small numbers then, and no longer differences of large ones. Returns the placement before.
    pub(super) fn recentre(&mut self, unknowns: &mut [f64]) -> Placement {
        let before = self.placement.clone();
        let (_, amplitudes) = unknowns.split_at_mut(self.compliance.nrows());
        add_scaled(&mut self.placement.constant, 1.0, &multiply(&self.motions, amplitudes));
        add_scaled(&mut self.placement.offset, 1.0, amplitudes);
        amplitudes.fill(0.0);
        before
    }

    /// Relative residual that the rounding of d and R a causes.
    pub(super) fn rounding(&self, unknowns: &[f64]) -> f64 {
        let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        f64::EPSILON * largest(self.constant()).max(largest(&multiply(&self.motions, &unknowns[self.row_count()..])))
    }

    /// Derivatives of Π selected at given arguments x.
    pub fn linearize(&self, arguments: &[f64]) -> Vec<Linearization> {
        let points = self.problem.boundary.points.iter();
        points.map(|node| node.linearization(&arguments[node.rows()])).collect()
    }

    /// Amplitudes of the bodies' own motions, in mm for dimensionless amplitudes times `unit`.
    pub(super) fn own_amplitudes(&self, amplitudes: &[f64], unit: f64) -> Vec<Vec<f64>> {
        let scaled = DVector::from_iterator(amplitudes.len(), amplitudes.iter().map(|a| a * unit));
        let own = &self.basis * scaled;
        let mut own = own.iter().copied();
        self.bodies.iter().map(|body| own.by_ref().take(body.stiff().motions.len()).collect()).collect()
    }

    /// Resultants along R of those along the bodies' own motions.
    pub(super) fn resultants_of(&self, own: &DVector<f64>) -> Vec<f64> {
        (self.basis.transpose() * own).iter().copied().collect()
    }

    /// Forces, N, and contact displacements of all bodies less the prescribed ones, mm, of given unknowns.
    pub fn dimensional(&self, unknowns: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (forces, amplitudes) = unknowns.split_at(self.row_count());
        let forces: Vec<f64> = forces.iter().map(|force| force * self.load).collect();
        let amplitudes: Vec<f64> =
            amplitudes.iter().zip(&self.placement.offset).map(|(a, offset)| a + offset).collect();
        let own = self.own_amplitudes(&amplitudes, self.unit * self.load);
        let parts = self.bodies.iter().zip(&own);
        let displacements = parts.flat_map(|(body, own)| body.displacement(&forces, own, true)).collect();
        (forces, displacements)
    }

    /// Forces, N, and amplitudes of the bodies' own motions, mm, of given unknowns: what a similar shape begins with.
    pub(super) fn own_unknowns(&self, unknowns: &[f64]) -> Vec<f64> {
        let (forces, amplitudes) = unknowns.split_at(self.row_count());
        let amplitudes: Vec<f64> =
            amplitudes.iter().zip(&self.placement.offset).map(|(a, offset)| a + offset).collect();
        let own = self.own_amplitudes(&amplitudes, self.unit * self.load);
        forces.iter().map(|force| force * self.load).chain(own.into_iter().flatten()).collect()
    }

    /// Unknowns from the [`own_unknowns`](Self::own_unknowns) of a similar shape; none of another number.
    pub(super) fn unknowns_near(&self, own: &[f64]) -> Option<Vec<f64>> {
        let (forces, amplitudes) = own.split_at_checked(self.row_count())?;
        let scaled = amplitudes.iter().map(|amplitude| amplitude / (self.unit * self.load));
        let scaled: Vec<f64> = scaled.collect();
        let forces = forces.iter().map(|force| force / self.load);
        (scaled.len() == self.inverse_basis.ncols()).then(|| {
            let amplitudes = &self.inverse_basis * DVector::from_vec(scaled);
            forces.chain(amplitudes.iter().copied()).collect()
        })
    }
}

/// R with orthonormal columns, the map from its amplitudes to those of the bodies' own motions, and the map back.
/// Singular values come from the triangular factor, which keeps the small ones.
fn touched_motions(bodies: &[ContactBody], rows: usize) -> [DMatrix<f64>; 3] {
    let columns = bodies.iter().map(|body| body.stiff().motions.len()).sum();
    let mut motions = DMatrix::<f64>::zeros(rows, columns);
    let own = bodies.iter().flat_map(|body| body.stiff().motions.iter().map(move |motion| (&body.rows, motion)));
    for (mut column, (rows, motion)) in motions.column_iter_mut().zip(own) {
        rows.add_jumps(motion, 1.0, column.as_mut_slice());
    }
    let none = || [DMatrix::zeros(rows, 0), DMatrix::zeros(columns, 0), DMatrix::zeros(0, columns)];
    if columns == 0 {
        return none();
    }
    let decomposition = motions.clone().qr().r().svd(false, true);
    let values = &decomposition.singular_values;
    let Some(right) = &decomposition.v_t else { return none() };
    let touched: Vec<usize> = (0..values.len()).filter(|&k| values[k] > UNTOUCHED).collect();
    let basis = DMatrix::from_fn(columns, touched.len(), |i, k| right[(touched[k], i)] / values[touched[k]]);
    let inverse = DMatrix::from_fn(touched.len(), columns, |k, i| right[(touched[k], i)] * values[touched[k]]);
    [motions * &basis, basis, inverse]
}
