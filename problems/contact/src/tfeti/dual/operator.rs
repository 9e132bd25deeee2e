//! F = B K⁺ Bᵀ and the products around it; subdomains in parallel, sums in a fixed order.

use crate::body::MOTIONS;
use crate::linear::entry::{Entry, Row};
use crate::linear::parallel::{self, for_parts};
use crate::linear::real::Real;
use crate::linear::right_side::RightSide;
use crate::linear::vector::add_scaled;
use crate::tfeti::torn::{RowVector, SubdomainFactors, TornModel, TornSystem, TornVector, parts_mut};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Precision of the products with F inside Krylov spaces; residuals and certificates of states are always double.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// All products in double precision.
    Double,
    /// Subdomain solves of search directions in single precision (1.3 to 1.7 times faster), residuals replaced by
    /// double products whenever they have fallen by four digits.
    #[default]
    Mixed,
}

/// The dual operator of one shape; counts its applications, those of its clones included.
#[doc(alias = "Delassus")]
#[derive(Debug, Clone)]
pub struct DualOperator<'a> {
    /// What does not depend on the shape.
    pub model: &'a TornModel,
    /// The factored subdomains with their loads.
    pub system: &'a TornSystem,
    applications: Arc<AtomicUsize>,
}

impl<'a> DualOperator<'a> {
    /// The operator of a factored system.
    pub fn new(model: &'a TornModel, system: &'a TornSystem) -> Self {
        Self { model, system, applications: Arc::default() }
    }

    /// Products F·x so far, in either precision.
    pub fn applications(&self) -> usize {
        self.applications.load(Ordering::Relaxed)
    }

    /// The product F λ.
    pub fn apply(&self, multipliers: &RowVector) -> RowVector {
        self.apply_with(multipliers, &|factors, part| factors.solve(part))
    }

    /// F of a search direction, in the precision asked for.
    pub fn apply_direction(&self, direction: &RowVector, precision: Precision) -> RowVector {
        match precision {
            Precision::Double => self.apply(direction),
            Precision::Mixed => self.apply_single(direction),
        }
    }

    /// F λ with the subdomain solves in single precision: relative error near 1e-6, half the memory traffic.
    fn apply_single(&self, multipliers: &RowVector) -> RowVector {
        self.apply_with(multipliers, &|factors, part| {
            factors.balance(part);
            // Brought to size one, so that no unit system leaves the range of single precision.
            let size = part.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
            if size > 0.0 {
                let mut single: Vec<f32> = part.iter().map(|&entry| (entry / size) as f32).collect();
                factors.inverse.solve_in_place_single(&mut single);
                for (entry, single) in part.iter_mut().zip(single) {
                    *entry = size * f64::from(single);
                }
                factors.balance(part);
            }
        })
    }

    /// B K⁺ Bᵀ λ for a given product with K⁺.
    fn apply_with(&self, multipliers: &RowVector, solve: &(dyn Fn(&SubdomainFactors, &mut [f64]) + Sync)) -> RowVector {
        self.applications.fetch_add(1, Ordering::Relaxed);
        let mut torn = self.model.zeros();
        self.solve_subdomains(multipliers, &mut torn.0, solve);
        self.gather(torn)
    }

    /// F Λ for a block of columns in its own precision, of which `count` are counted. `torn`: room for a torn block.
    pub(crate) fn apply_columns<E: Real, const N: usize>(
        &self,
        multipliers: &[Row<E, N>],
        torn: &mut [Row<E, N>],
        count: usize,
    ) -> RowVector<Row<E, N>> {
        self.applications.fetch_add(count, Ordering::Relaxed);
        self.solve_subdomains(multipliers, torn, &|factors, part| factors.solve(part));
        self.gather_columns(torn)
    }

    /// B K⁺ (r − BᵀΛ) for torn forces r (N) in their precision; `count` columns are counted. `torn`: workspace.
    pub(crate) fn free_jumps<E: Real, const N: usize>(
        &self,
        forces: &[Row<E, N>],
        multipliers: &[Row<E, N>],
        torn: &mut [Row<E, N>],
        count: usize,
    ) -> RowVector<Row<E, N>> {
        self.applications.fetch_add(count, Ordering::Relaxed);
        let load = |first: usize, part: &mut [Row<E, N>]| {
            self.system.rows.transposed.multiply_rows(first, multipliers, part);
            for (load, force) in part.iter_mut().zip(&forces[first..]) {
                *load = force.zip(load, |force, held| force - held);
            }
        };
        self.solve_loads(torn, &load, &|factors, part| factors.solve(part));
        self.gather_columns(torn)
    }

    /// K⁺ Bᵀ λ for a given product with K⁺.
    fn solve_subdomains<V: RightSide>(
        &self,
        multipliers: &[V],
        torn: &mut [V],
        solve: &(dyn Fn(&SubdomainFactors, &mut [V]) + Sync),
    ) {
        let load = |first: usize, part: &mut [V]| {
            self.system.rows.transposed.multiply_rows(first, multipliers, part);
        };
        self.solve_loads(torn, &load, solve);
    }

    /// K⁺ f for forces that `load` fills in subdomain by subdomain, given its first dof, and for a given product with
    /// K⁺ of a subdomain.
    fn solve_loads<V: RightSide>(
        &self,
        torn: &mut [V],
        load: &(dyn Fn(usize, &mut [V]) + Sync),
        solve: &(dyn Fn(&SubdomainFactors, &mut [V]) + Sync),
    ) {
        let (system, starts) = (self.system, &self.system.starts);
        if system.is_joined() {
            for_parts(parts_mut(torn, starts), &|index, values| load(starts[index], values));
            let torn_loads = &*torn;
            let resultants_of = |index: usize| system.parts[index].resultants_of(&torn_loads[system.dofs(index)]);
            let resultants = parallel::map(system.parts.len(), &resultants_of);
            for_parts(parts_mut(torn, starts), &|index, values| solve(&system.parts[index], values));
            system.join(&self.model.constraints.joined, &resultants, torn);
        } else {
            for_parts(parts_mut(torn, starts), &|index, values| {
                load(starts[index], values);
                solve(&system.parts[index], values);
            });
        }
    }

    /// The jumps B u.
    pub fn gather(&self, mut torn: TornVector) -> RowVector {
        self.gather_columns(&mut torn.0)
    }

    fn gather_columns<V: Entry>(&self, torn: &mut [V]) -> RowVector<V> {
        self.model.rows_times(&self.system.rows.rows, torn)
    }

    /// K⁺ l over the subdomains of this process for torn forces l, and Rᵀ l of all clusters; counted like a product
    /// with F.
    pub fn response(&self, forces: &TornVector) -> (TornVector, Vec<f64>) {
        self.applications.fetch_add(1, Ordering::Relaxed);
        let mut torn = self.model.zeros();
        let load = |first: usize, part: &mut [f64]| part.copy_from_slice(&forces.0[first..first + part.len()]);
        self.solve_loads(&mut torn.0, &load, &|factors, part| factors.solve(part));
        let parts = self.system.parts.iter().enumerate();
        let own = parts.flat_map(|(index, part)| part.resultants_of(&forces.0[self.system.dofs(index)])).collect();
        let resultants = self.model.clusters.gather(&self.system.cluster_resultants(own), MOTIONS);
        (torn, resultants)
    }

    /// The displacements K⁺ f under the loads.
    pub fn loaded_displacement(&self) -> TornVector {
        let mut torn = self.model.zeros();
        let parts = parts_mut(&mut torn.0, &self.system.starts);
        for (part, load) in parts.into_iter().zip(&self.system.loads).filter(|(_, load)| !load.displacement.is_empty())
        {
            part.copy_from_slice(&load.displacement);
        }
        let resultants: Vec<[f64; MOTIONS]> = self.system.loads.iter().map(|load| load.resultants).collect();
        self.system.join(&self.model.constraints.joined, &resultants, &mut torn.0);
        torn
    }

    /// u = K⁺(f − Bᵀλ) + R a on the subdomains of this process, from `loaded` = K⁺ f and the amplitudes of all;
    /// method.md (4.2).
    pub fn displacement(&self, mut loaded: TornVector, multipliers: &RowVector, amplitudes: &[f64]) -> TornVector {
        let mut torn = self.model.zeros();
        self.solve_subdomains(multipliers, &mut torn.0, &|factors, part| factors.solve(part));
        add_scaled(&mut loaded.0, -1.0, &torn.0);
        let own = &amplitudes[MOTIONS * self.model.clusters.owned().start..];
        for_parts(parts_mut(&mut loaded.0, &self.system.starts), &|index, values| {
            for (mode, amplitude) in self.system.parts[index].modes.iter().zip(self.system.amplitudes_of(index, own)) {
                add_scaled(values, amplitude, mode);
            }
        });
        loaded
    }
}
