//! Which rigid amplitudes meet in the coarse matrix G Gᵀ, and the order of their elimination.
//!
//! ```text
//! amplitudes of clusters without contact rows, in nested dissection order │ amplitudes of clusters with contact rows
//! ```
//! The rows of B_E couple a cluster with its neighbours alone, and do so alike for all active sets. What an active set
//! adds lies in the trailing block, whose amplitudes all count as coupled. A cluster is a single subdomain unless the
//! tearing joins several.

use crate::body::MOTIONS;
use crate::error::ContactError;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::ordering::nested_dissection;
use crate::linear::symmetric::LowerPattern;
use crate::tfeti::torn::constraints::Constraints;
use crate::tfeti::torn::distribution::Distribution;
use crate::tfeti::torn::interface::Interface;
use crate::tfeti::torn::numbering::Numbering;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Pattern and elimination order of the coarse matrices of a scene.
#[derive(Debug)]
pub struct CoarsePattern {
    /// Lower triangle of the coarse matrix.
    pub lower: Arc<LowerPattern>,
    pub symbolic: Arc<SymbolicFactor>,
    /// Amplitudes in elimination order.
    order: Vec<usize>,
    /// Number of amplitudes of clusters without contact rows.
    interior_count: usize,
}

impl CoarsePattern {
    /// The pattern of the rows of B of all processes. `centres`: of the clusters; `distribution` is that of the
    /// clusters.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the symbolic analysis fails.
    pub fn new(
        constraints: &Constraints,
        interface: &Interface,
        numbering: &Numbering,
        distribution: &Distribution,
        centres: &[[f64; 3]],
    ) -> Result<Self, ContactError> {
        let owned = distribution.owned();
        // A process has all rows that touch its subdomains, so that it knows all their neighbours.
        let mut neighbours = vec![BTreeSet::new(); owned.len()];
        let mut touched = Vec::new();
        for row in 0..constraints.equality_count {
            touched.clear();
            let places = constraints.equality().row(row).map(|(place, _)| place);
            touched.extend(places.map(|place| numbering.cluster_of(numbering.owner(interface.dof(place)))));
            touched.sort_unstable();
            touched.dedup();
            for (index, own) in touched.iter().enumerate().filter(|(_, own)| owned.contains(own)) {
                neighbours[own - owned.start].extend(&touched[index + 1..]);
            }
        }
        let contact: BTreeSet<usize> =
            constraints.contact_subdomains.iter().map(|&subdomain| numbering.cluster_of(subdomain)).collect();
        for own in contact.iter().filter(|own| owned.contains(own)) {
            neighbours[own - owned.start].extend(contact.range(own + 1..));
        }
        let pieces = neighbours.iter().map(|numbers| numbers.iter().map(|&number: &usize| number as f64).collect());
        let neighbours: Vec<Vec<u32>> = distribution
            .complete(pieces.collect())
            .into_iter()
            .map(|numbers| numbers.into_iter().map(|number| number as u32).collect())
            .collect();
        let mut graph = neighbours.clone();
        for (own, later) in neighbours.iter().enumerate() {
            later.iter().for_each(|&other| graph[other as usize].push(own as u32));
        }
        let last: Vec<usize> = contact.iter().copied().collect();
        let dissected = nested_dissection(centres, &graph, &last);
        let amplitudes = |cluster: usize| MOTIONS * cluster..MOTIONS * (cluster + 1);
        let order: Vec<usize> = dissected.into_iter().flat_map(amplitudes).collect();
        let columns = neighbours.iter().enumerate().flat_map(|(own, later)| {
            let coupled: Vec<usize> = later.iter().flat_map(|&number| amplitudes(number as usize)).collect();
            amplitudes(own).map(move |column| (column..MOTIONS * (own + 1)).chain(coupled.iter().copied()).collect())
        });
        let lower = Arc::new(LowerPattern::from_columns(columns.collect()));
        let symbolic = Arc::new(SymbolicFactor::new(Arc::clone(&lower), order.clone())?);
        let interior_count = order.len() - MOTIONS * contact.len();
        Ok(Self { lower, symbolic, order, interior_count })
    }

    /// Number of amplitudes of clusters without contact rows: they come first in the elimination order.
    pub fn interior_count(&self) -> usize {
        self.interior_count
    }

    /// Amplitudes of the clusters with contact rows, ascending: the last ones of the elimination order.
    pub fn contact_amplitudes(&self) -> &[usize] {
        &self.order[self.interior_count..]
    }

    /// The place of an amplitude among those of the clusters with contact rows.
    ///
    /// # Panics
    /// If its cluster has no contact rows.
    pub fn contact_place(&self, amplitude: usize) -> usize {
        self.contact_amplitudes().binary_search(&amplitude).expect("invariant: contact rows touch this cluster")
    }
}
