//! Factorisation of the bodies of a torn scene at one shape.

use crate::body::loads::piece_loads;
use crate::equilibrium::Configuration;
use crate::error::ContactError;
use crate::linear::parallel;
use crate::shelf::Factored;
use crate::tfeti::torn::cluster_factors::ClusterFactors;
use crate::tfeti::torn::factored_body::FactoredBody;
use crate::tfeti::torn::factors::{SubdomainFactors, SubdomainLoad};
use crate::tfeti::torn::model::{LoadedBody, TornModel, TornSubdomain};
use crate::tfeti::torn::system::TornSystem;
use std::sync::Arc;

impl TornModel {
    /// Factors the subdomains of a shape. Bodies that no control shapes are factored at the first call and shared
    /// afterwards. What solvers on the same shelf still hold is taken over. Factorisations are counted
    /// over all processes.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] from a subdomain.
    pub fn factorize(&self, configuration: &Configuration) -> Result<TornSystem, ContactError> {
        let map = &self.problem.map;
        let loaded = |body: usize| Ok((body, self.loaded_body(body, &configuration.positions[body])?));
        let mut all: Vec<(usize, LoadedBody)> = Vec::new();
        let mut factored = 0;
        for body in map.shaped_bodies() {
            let (body, (found, count)) = loaded(body)?;
            factored += count;
            all.push((body, found));
        }
        if self.fixed.get().is_none() {
            let bodies = (0..self.problem.bodies.len()).filter(|&body| !map.shapes(body)).map(loaded);
            let bodies = bodies.collect::<Result<Vec<_>, ContactError>>()?;
            factored += bodies.iter().map(|(_, (_, count))| count).sum::<usize>();
            // Another thread may have been first; its factors are the same.
            let _ = self.fixed.set(bodies.into_iter().map(|(body, (found, _))| (body, found)).collect());
        }
        all.extend(self.fixed.get().into_iter().flatten().cloned());
        all.sort_by_key(|(body, _)| *body);
        let bodies = || all.iter().map(|(_, found)| found);
        let part = |((index, part), load): (&(usize, Arc<SubdomainFactors>), &SubdomainLoad)| {
            (*index, Arc::clone(part), load.clone())
        };
        let mut parts: Vec<(usize, Arc<SubdomainFactors>, SubdomainLoad)> =
            bodies().flat_map(|(body, loads)| body.factors.parts.iter().zip(loads)).map(part).collect();
        parts.sort_by_key(|(index, ..)| *index);
        let mut clusters: Vec<(usize, Arc<ClusterFactors>)> =
            bodies().flat_map(|(body, _)| body.factors.clusters.clone()).collect();
        clusters.sort_by_key(|(index, _)| *index);
        let factorizations = self.distribution.sum_of_processes(factored as f64) as usize;
        let forward_error = parts.iter().map(|(_, part, _)| part.forward_error).fold(0.0, f64::max);
        let (parts, loads) = parts.into_iter().map(|(_, part, load)| (part, load)).unzip();
        Ok(TornSystem {
            parts,
            loads,
            bodies: bodies().map(|(body, _)| Arc::clone(body)).collect(),
            starts: Arc::clone(&self.starts),
            rows: self.rows_of(&configuration.rows),
            clusters: clusters.into_iter().map(|(_, cluster)| cluster).collect(),
            cluster_starts: Arc::clone(&self.cluster_starts),
            factorizations,
            forward_error: self.distribution.largest(forward_error),
        })
    }

    /// A body at given positions, from the shelf or factored, and the number of factorisations that it took.
    fn loaded_body(&self, body: usize, positions: &Arc<Vec<[f64; 3]>>) -> Result<(LoadedBody, usize), ContactError> {
        let known = self.shelf.find(&self.keys[body], positions);
        // Factorisation is the work of all processes: each takes over what it has only where all have it.
        let missing = self.distribution.largest(f64::from(u8::from(known.is_none())));
        let (factored, count) = match known.filter(|_| missing == 0.0) {
            Some(known) => (known, 0),
            None => {
                let factors = self.factorize_body(body, positions)?;
                let count = factors.factorizations();
                let factored = Arc::new(Factored { positions: Arc::clone(positions), factors });
                self.shelf.put(&self.keys[body], &factored);
                (factored, count)
            }
        };
        let parts = &factored.factors.parts;
        let load = |number: usize| {
            let (index, part) = &parts[number];
            let (body, piece) = self.piece(*index);
            part.loaded(piece_loads(body, piece, positions))
        };
        let loads = parallel::map(parts.len(), &load);
        Ok(((factored, loads), count))
    }

    /// The factors of the subdomains and clusters of a body in this process.
    fn factorize_body(&self, body: usize, positions: &[[f64; 3]]) -> Result<FactoredBody, ContactError> {
        let members = self.subdomains.iter().enumerate().filter(|(_, subdomain)| subdomain.body == body);
        let own: Vec<(usize, &TornSubdomain)> = members.collect();
        let factor = |number: usize| {
            let (index, subdomain) = own[number];
            let (body, piece) = self.piece(index);
            let interior = subdomain.interior.as_deref();
            let factors = SubdomainFactors::new((body, piece), &subdomain.symbolic, positions, interior)?;
            Ok((index, Arc::new(factors)))
        };
        let parts: Result<Vec<(usize, Arc<SubdomainFactors>)>, ContactError> =
            parallel::map(own.len(), &factor).into_iter().collect();
        let factored =
            parts.and_then(|parts| Ok(FactoredBody { clusters: self.join_body(body, positions, &parts)?, parts }));
        self.distribution.agreed(factored)
    }

    /// What joins the clusters of a body in this process, from its factored subdomains; nothing for single subdomains.
    fn join_body(
        &self,
        body: usize,
        positions: &[[f64; 3]],
        parts: &[(usize, Arc<SubdomainFactors>)],
    ) -> Result<Vec<(usize, Arc<ClusterFactors>)>, ContactError> {
        if !self.numbering.is_joined() {
            return Ok(vec![]);
        }
        let clusters = 0..self.cluster_starts.len() - 1;
        let own: Vec<usize> =
            clusters.filter(|&cluster| self.subdomains[self.cluster_starts[cluster]].body == body).collect();
        let join = |number: usize| {
            let cluster = own[number];
            let members = self.cluster_starts[cluster]..self.cluster_starts[cluster + 1];
            let places = |index: usize| self.piece(index).1.positions(positions).collect::<Vec<[f64; 3]>>();
            let coordinates: Vec<Vec<[f64; 3]>> = members.clone().map(places).collect();
            let first = parts.partition_point(|(index, _)| *index < members.start);
            let parts: Vec<Arc<SubdomainFactors>> =
                parts[first..first + members.len()].iter().map(|(_, part)| Arc::clone(part)).collect();
            let stiffness = self.piece(members.start).1.pattern.mean_diagonal(&parts[0].stiffness);
            let factors = ClusterFactors::new(&self.constraints.joined[cluster], &parts, &coordinates, stiffness)?;
            Ok((cluster, Arc::new(factors)))
        };
        parallel::map(own.len(), &join).into_iter().collect()
    }
}
