//! F = B K⁺ Bᵀ and the products around it; subdomains in parallel, sums in a fixed order.

use crate::tfeti::{TornModel, TornSystem};
use faer::Par;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The dual operator of one shape; counts its applications.
#[doc(alias = "Delassus")]
#[derive(Debug)]
pub struct DualOperator<'a> {
    /// What does not depend on the shape.
    pub model: &'a TornModel,
    /// The factored subdomains.
    pub system: &'a TornSystem,
    applications: AtomicUsize,
}

impl<'a> DualOperator<'a> {
    /// The operator of a factored system.
    pub fn new(model: &'a TornModel, system: &'a TornSystem) -> Self {
        Self { model, system, applications: AtomicUsize::new(0) }
    }

    /// Products F·x so far.
    pub fn applications(&self) -> usize {
        self.applications.load(Ordering::Relaxed)
    }

    /// F λ.
    pub fn apply(&self, multipliers: &[f64]) -> Vec<f64> {
        self.applications.fetch_add(1, Ordering::Relaxed);
        let mut torn = self.scatter(multipliers);
        self.solve_subdomains(&mut torn);
        self.gather(&torn)
    }

    /// Bᵀ λ over torn dofs.
    pub fn scatter(&self, multipliers: &[f64]) -> Vec<f64> {
        let mut torn = vec![0.0; self.model.dof_count];
        self.model.constraints.transposed.multiply(multipliers, &mut torn);
        torn
    }

    /// B u of a torn displacement.
    pub fn gather(&self, torn: &[f64]) -> Vec<f64> {
        let mut rows = vec![0.0; self.model.constraints.row_count()];
        self.model.constraints.rows.multiply(torn, &mut rows);
        rows
    }

    /// K⁺ on every subdomain, in place.
    fn solve_subdomains(&self, torn: &mut [f64]) {
        self.for_each_subdomain(torn, |factors, part| factors.inverse.solve_in_place(part, 1, Par::Seq));
    }

    fn for_each_subdomain(&self, torn: &mut [f64], work: impl Fn(&crate::tfeti::SubdomainFactors, &mut [f64]) + Sync) {
        let size = self.model.pattern.pattern.dimension();
        torn.par_chunks_mut(size).zip(&self.system.factors).for_each(|(part, factors)| work(factors, part));
    }

    /// K⁺ f over torn dofs.
    pub fn loaded_displacement(&self) -> Vec<f64> {
        let mut torn = vec![0.0; self.model.dof_count];
        self.for_each_subdomain(&mut torn, |factors, part| {
            if !factors.loaded_displacement.is_empty() {
                part.copy_from_slice(&factors.loaded_displacement);
            }
        });
        torn
    }

    /// u = K⁺(f − Bᵀλ) + R a, with or without the load; method.md (4.2).
    pub fn displacement(&self, multipliers: &[f64], amplitudes: &[f64], loaded: bool) -> Vec<f64> {
        let mut torn = self.scatter(multipliers);
        self.solve_subdomains(&mut torn);
        let size = self.model.pattern.pattern.dimension();
        torn.par_chunks_mut(size).zip(&self.system.factors).enumerate().for_each(|(index, (part, factors))| {
            part.iter_mut().for_each(|entry| *entry = -*entry);
            if loaded && !factors.loaded_displacement.is_empty() {
                for (entry, loaded) in part.iter_mut().zip(&factors.loaded_displacement) {
                    *entry += loaded;
                }
            }
            for (mode, amplitude) in factors.modes.iter().zip(&amplitudes[6 * index..]) {
                crate::linear::vector::add_scaled(part, *amplitude, mode);
            }
        });
        torn
    }
}
