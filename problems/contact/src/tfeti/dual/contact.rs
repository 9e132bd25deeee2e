//! The contact problem of one shape in the multipliers, whatever method solves it.
//!
//! ```text
//! w = B u − g = d − Fλ + Gᵀa,    d = B K⁺ f − g,    g: c_E, then the gaps less what supports prescribe
//! residual:  (c w_E,  λ − Π(λ + c w)),     G λ = e in every iterate
//! ```

use crate::equilibrium::certificate::projection_residual;
use crate::equilibrium::law::{Friction, Linearization};
use crate::equilibrium::{ContactBoundary, ContactRows};
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
#[derive(Debug)]
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
    /// Force that residuals are relative to, N.
    pub(crate) load: f64,
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
        let approaches = rows.prescribed_approaches(boundary).into_iter().zip(constraints.contact_scales(boundary));
        constant.contact_mut().iter_mut().zip(approaches).for_each(|(jump, (approach, nu))| *jump += approach / nu);
        Self { operator, space, preconditioner, boundary, constant, rows, stiffness, load, precision }
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
        let product = self.operator.apply(&active.rows.trial(unknowns));
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

    /// (Qᵀ M Q + Z) v.
    pub(crate) fn precondition(&self, rows: &ActiveRows<'_>, v: &[f64]) -> Vec<f64> {
        let mut z = rows.test_transposed(&self.preconditioner.apply(&rows.test(v)));
        rows.add_spring(v, &mut z);
        z
    }
}
