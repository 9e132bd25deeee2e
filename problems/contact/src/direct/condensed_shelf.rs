//! What solvers by direct condensation share: condensed bodies, and their compliance over the contact rows.

use crate::direct::compliant_body::{BodyRows, CompliantBody, ContactBody};
use crate::direct::condensation_key::CondensationKey;
use crate::shelf::{Factored, Shelf};
use faer::Mat;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Condensed bodies and compliances that solvers share while somebody holds them.
#[derive(Debug, Default)]
pub struct CondensedShelf {
    pub(super) bodies: Shelf<CondensationKey, CompliantBody>,
    compliances: Mutex<Vec<Known>>,
}

/// C over the packed rows, with what it depends on.
#[derive(Debug)]
struct Known {
    parts: Vec<(Weak<Factored<CompliantBody>>, Arc<BodyRows>)>,
    unit: f64,
    compliance: Weak<Mat<f64>>,
}

impl Known {
    fn is_of(&self, bodies: &[ContactBody], unit: f64) -> bool {
        let is_same = |((body, rows), own): (&(Weak<_>, Arc<BodyRows>), &ContactBody)| {
            std::ptr::eq(body.as_ptr(), Arc::as_ptr(&own.body)) && **rows == *own.rows
        };
        self.unit == unit && self.parts.len() == bodies.len() && self.parts.iter().zip(bodies).all(is_same)
    }
}

impl CondensedShelf {
    /// Σ B C Bᵀ over the packed rows in units of compliances, mm/N: that of load cases that differ in their loads alone
    /// is one matrix.
    pub(super) fn compliance(&self, bodies: &[ContactBody], rows: usize, unit: f64) -> Arc<Mat<f64>> {
        let known = {
            let mut all = self.compliances.lock().unwrap_or_else(PoisonError::into_inner);
            all.retain(|known| known.compliance.strong_count() > 0);
            all.iter().find(|known| known.is_of(bodies, unit)).and_then(|known| known.compliance.upgrade())
        };
        known.unwrap_or_else(|| {
            let mut sum = Mat::<f64>::zeros(rows, rows);
            bodies.iter().for_each(|own| own.rows.add_compliance(own.body.factors.compliance(), &mut sum));
            for column in 0..rows {
                sum.col_as_slice_mut(column).iter_mut().for_each(|c| *c /= unit);
            }
            let sum = Arc::new(sum);
            let parts = bodies.iter().map(|own| (Arc::downgrade(&own.body), Arc::clone(&own.rows))).collect();
            let known = Known { parts, unit, compliance: Arc::downgrade(&sum) };
            self.compliances.lock().unwrap_or_else(PoisonError::into_inner).push(known);
            sum
        })
    }
}
