//! The contact problem of one shape in the multipliers, whatever method solves it.
//!
//! ```text
//! w = B u − g = d − Fλ + Gᵀa,    d = B K⁺ f − g,    g: c_E, then the gaps less what supports prescribe
//! residual:  (c w_E,  λ − Π(λ + c w)),     G λ = e in every iterate
//! ```
//! Every contact node may have a compliance of its own, which is part of F then: a problem on the way to the one
//! without.

use crate::equilibrium::certificate::projection_residual;
use crate::equilibrium::law::{Friction, Linearization};
use crate::equilibrium::{ContactBoundary, ContactRows, ForceUnit};
use crate::error::ContactError;
use crate::linear::sums::Sums;
use crate::linear::vector::{add_scaled, norm};
use crate::tfeti::dual::active_rows::ActiveRows;
use crate::tfeti::dual::active_set::ActiveSet;
use crate::tfeti::dual::coarse_space::CoarseSpace;
use crate::tfeti::dual::iterate::{Iterate, TornSolution};
use crate::tfeti::dual::operator::{DualOperator, Precision};
use crate::tfeti::dual::preconditioner::Preconditioner;
use crate::tfeti::torn::RowVector;

/// Everything that a method works with, for one shape.
#[derive(Debug, Clone)]
pub struct TornContact<'a> {
    /// The dual operator F.
    pub(crate) operator: DualOperator<'a>,
    /// The rows G with the resultants e.
    pub(crate) space: &'a CoarseSpace,
    pub(crate) preconditioner: Preconditioner<'a>,
    pub(crate) boundary: &'a ContactBoundary,
    /// The jumps d without forces.
    pub(crate) constant: RowVector,
    /// The contact rows of the shape.
    pub(crate) rows: &'a ContactRows,
    /// The typical stiffness c, N/mm.
    pub(crate) stiffness: f64,
    /// c times the compliance of each contact node besides that of the bodies; 0 in the problem to be solved.
    yielding: f64,
    /// Force that residuals are relative to, N.
    pub(crate) load: f64,
    /// What this force should be once the contact forces are known; none in the problem of a state.
    pub(crate) unit: Option<ForceUnit>,
    /// Precision of products with search directions.
    pub(crate) precision: Precision,
}

impl<'a> TornContact<'a> {
    /// The problem of a factored shape with its contact rows; `stiffness` is c (N/mm), `load` scales residuals (N).
    pub fn new(
        operator: DualOperator<'a>,
        space: &'a CoarseSpace,
        preconditioner: Preconditioner<'a>,
        rows: &'a ContactRows,
        [stiffness, load]: [f64; 2],
        precision: Precision,
    ) -> Self {
        let (boundary, constraints) = (&operator.model.problem.boundary, &operator.model.constraints);
        let mut constant = operator.gather(operator.loaded_displacement());
        constant.iter_mut().zip(&constraints.prescribed).for_each(|(jump, prescribed)| *jump -= prescribed);
        let approaches = rows.prescribed_approaches(boundary, &operator.model.problem.bodies);
        let approaches = approaches.into_iter().zip(constraints.contact_scales(boundary));
        constant.contact_mut().iter_mut().zip(approaches).for_each(|(jump, (approach, nu))| *jump += approach / nu);
        Self {
            operator,
            space,
            preconditioner,
            boundary,
            constant,
            rows,
            stiffness,
            yielding: 0.0,
            load,
            unit: None,
            precision,
        }
    }

    /// The problem in a unit of forces that fits those of an iterate, where they are small in the present one, with the
    /// rigid motions of the iterate, by which the subdomains are moved there: jumps that are differences of large
    /// displacements have lost the digits that count in a small unit.
    pub(crate) fn finer(&self, iterate: &Iterate) -> Option<(Self, Vec<f64>)> {
        let load = self.unit?.finer(self.boundary, &self.contact_forces(&iterate.multipliers), self.load)?;
        let mut finer = Self { load, unit: None, ..self.clone() };
        add_scaled(&mut finer.constant, 1.0, &self.space.jumps(&iterate.amplitudes));
        Some((finer, iterate.amplitudes.clone()))
    }

    /// The contact forces of multipliers, packed, N.
    pub(crate) fn contact_forces(&self, multipliers: &RowVector) -> Vec<f64> {
        let scales = self.operator.model.constraints.contact_scales(self.boundary);
        multipliers.contact().iter().zip(scales).map(|(multiplier, nu)| multiplier / nu).collect()
    }

    /// The problem without compliances of its contact nodes, changed by the compliance δ/c of each of them. Its c is
    /// that of the bodies and the nodes in series.
    pub(crate) fn yielding(&self, delta: f64) -> Self {
        let stiffness = self.stiffness / (1.0 + delta);
        Self { stiffness, yielding: delta / (1.0 + delta), ..self.clone() }
    }

    /// The product F λ.
    pub(crate) fn apply(&self, multipliers: &RowVector) -> RowVector {
        let mut image = self.operator.apply(multipliers);
        if self.yielding > 0.0 {
            add_scaled(image.contact_mut(), self.yielding / self.stiffness, multipliers.contact());
        }
        image
    }

    /// |v|₂ of a vector over rows of B_E, over all rows, or over unknowns of an active set.
    pub(crate) fn norm(&self, v: &[f64]) -> f64 {
        let sums: &dyn Sums = &self.operator.model.sums();
        sums.norm(v)
    }

    /// The zero vector over all rows.
    pub(crate) fn zeros(&self) -> RowVector {
        self.operator.model.constraints.zeros()
    }

    /// The iterate of given multipliers, their image and amplitudes.
    pub(crate) fn iterate(&self, multipliers: RowVector, image: RowVector, amplitudes: Vec<f64>) -> Iterate {
        let mut jumps = self.space.jumps(&amplitudes);
        for ((jump, d), image) in jumps.iter_mut().zip(self.constant.iter()).zip(image.iter()) {
            *jump += d - image;
        }
        Iterate { multipliers, image, amplitudes, jumps }
    }

    /// The state of bodies that nothing loads and nothing penetrates: no forces, no displacements.
    pub(crate) fn at_rest(&self) -> TornSolution {
        let iterate = self.iterate(self.zeros(), self.zeros(), vec![0.0; self.space.resultants().len()]);
        let residual = self.residual(&iterate);
        self.solution(iterate, residual, 0)
    }

    /// What a method returns that ends at an iterate.
    pub(crate) fn solution(&self, iterate: Iterate, residual: f64, steps: usize) -> TornSolution {
        let linearizations = self.linearize(&iterate);
        TornSolution { iterate, linearizations, residual, steps }
    }

    /// |(c w_E, λ − Π(λ + c w))|₂ over the load.
    pub(crate) fn residual(&self, iterate: &Iterate) -> f64 {
        let glued = self.stiffness * self.norm(iterate.jumps.split().0);
        glued.hypot(norm(&self.law_residual(iterate))) / self.load
    }

    /// |G λ − e|₂ over the load.
    pub(crate) fn imbalance(&self, multipliers: &RowVector) -> f64 {
        norm(&self.space.defect(multipliers)) / self.load
    }

    /// λ − Π(λ + c w) over the packed contact rows.
    pub(crate) fn law_residual(&self, iterate: &Iterate) -> Vec<f64> {
        projection_residual(self.boundary, iterate.multipliers.contact(), iterate.jumps.contact(), self.stiffness)
    }

    /// The projection arguments x = λ + c w over the packed contact rows.
    pub(crate) fn arguments(&self, iterate: &Iterate) -> Vec<f64> {
        let mut arguments = iterate.multipliers.contact().to_vec();
        add_scaled(&mut arguments, self.stiffness, iterate.jumps.contact());
        arguments
    }

    /// The derivative selected at every contact node.
    pub(crate) fn linearize(&self, iterate: &Iterate) -> Vec<Linearization> {
        let arguments = self.arguments(iterate);
        let points = self.boundary.points.iter();
        points.map(|point| point.linearization(&arguments[point.rows()])).collect()
    }

    /// The rows of given derivatives.
    pub(crate) fn active_rows(&self, linearizations: Vec<Linearization>, friction: Friction) -> ActiveRows<'_> {
        let equality_count = self.operator.model.constraints.equality_count;
        ActiveRows::new(self.boundary, equality_count, linearizations, self.stiffness, friction)
    }

    /// The active set of given derivatives.
    ///
    /// # Errors
    /// [`ContactError::Unheld`] when it leaves a rigid motion free.
    pub(crate) fn active_set(
        &self,
        linearizations: Vec<Linearization>,
        friction: Friction,
    ) -> Result<ActiveSet<'_>, ContactError> {
        ActiveSet::new(self.space, self.active_rows(linearizations, friction))
    }

    /// d − F λ for an image F λ.
    pub(crate) fn rest(&self, image: &RowVector) -> RowVector {
        let mut rest = self.constant.clone();
        add_scaled(&mut rest, -1.0, image);
        rest
    }

    /// P (Qᵀ F T + Δ) y for unknowns y of an active set, and F T y.
    pub(crate) fn reduced_product(&self, active: &ActiveSet<'_>, unknowns: &[f64]) -> (Vec<f64>, RowVector) {
        let product = self.apply(&active.rows.trial(unknowns));
        let mut reduced = active.rows.test_transposed(&product);
        active.rows.add_compliance(unknowns, &mut reduced, 1.0);
        active.project(&mut reduced);
        (reduced, product)
    }

    /// P (Qᵀ M Q + Z) v.
    pub(crate) fn projected_precondition(&self, active: &ActiveSet<'_>, v: &[f64]) -> Vec<f64> {
        let mut z = self.precondition(&active.rows, v);
        active.project(&mut z);
        z
    }

    /// (Qᵀ M Q + Z) v. Where contact nodes yield, M has the stiffness of the bodies and the nodes in series.
    pub(crate) fn precondition(&self, rows: &ActiveRows<'_>, v: &[f64]) -> Vec<f64> {
        let share = (1.0 - self.yielding).sqrt();
        let mut residual = rows.test(v);
        residual.contact_mut().iter_mut().for_each(|entry| *entry *= share);
        let mut force = self.preconditioner.apply(&residual);
        force.contact_mut().iter_mut().for_each(|entry| *entry *= share);
        let mut z = rows.test_transposed(&force);
        rows.add_spring(v, &mut z);
        z
    }
}
