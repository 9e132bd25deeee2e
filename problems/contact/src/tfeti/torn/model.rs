//! The torn scene: what is fixed for a run, and the factored system of a shape. A process holds its subdomains only.

use crate::body::MOTIONS;
use crate::body::{Body, Piece};
use crate::communication::Communication;
use crate::equilibrium::row_work::NodeValues;
use crate::equilibrium::{Configuration, ContactProblem, ContactRows};
use crate::error::ContactError;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::linear::parallel;
use crate::linear::vector::{dot, norm};
use crate::shelf::Factored;
use crate::tfeti::torn::cluster_factors::moves_as_one_body;
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::coarse_pattern::CoarsePattern;
use crate::tfeti::torn::constraints::{Constraints, TornRows};
use crate::tfeti::torn::distribution::Distribution;
use crate::tfeti::torn::factored_body::{FactoredBody, OwnParts, TornKey, TornShelf};
use crate::tfeti::torn::factors::{InteriorClass, SubdomainLoad};
use crate::tfeti::torn::interface::Interface;
use crate::tfeti::torn::numbering::Numbering;
use crate::tfeti::torn::options::TornOptions;
use crate::tfeti::torn::preconditioner_kind::PreconditionerKind;
use crate::tfeti::torn::row_sums::RowSums;
use crate::tfeti::torn::system::TornSystem;
use crate::tfeti::torn::vectors::{RowVector, TornVector};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// One subdomain in the torn scene.
#[derive(Debug)]
pub struct TornSubdomain {
    /// The body, and its piece.
    pub body: usize,
    pub piece: usize,
    pub(super) symbolic: Arc<SymbolicFactor>,
    pub(super) interior: Option<Arc<InteriorClass>>,
}

/// Everything that does not depend on the shape: tearing, rows, patterns, and the factors of bodies of fixed shape.
#[derive(Debug)]
pub struct TornModel {
    /// The problem that was torn.
    pub problem: Arc<ContactProblem>,
    /// The subdomains of this process, in the order of all subdomains.
    pub subdomains: Vec<TornSubdomain>,
    /// First dof of every subdomain of this process in its torn vectors, then their number.
    pub starts: Arc<[usize]>,
    /// Bodies and pieces of all subdomains.
    pub numbering: Numbering,
    /// Which process works on which subdomains.
    pub distribution: Arc<Distribution>,
    /// Which process works on which clusters of subdomains: what has rigid motions of its own.
    pub clusters: Arc<Distribution>,
    /// First subdomain of every cluster of this process, then their number.
    pub(super) cluster_starts: Arc<[usize]>,
    /// What of B is the same for all shapes.
    pub constraints: Arc<Constraints>,
    /// Dofs that this process shares with others.
    pub interface: Interface,
    /// Pattern of the coarse matrices.
    pub coarse: Arc<CoarsePattern>,
    /// What the factors of the bodies depend on beside positions.
    pub(super) keys: Vec<Arc<TornKey>>,
    pub(super) shelf: Arc<TornShelf>,
    /// The bodies of fixed shape, by number.
    pub(super) fixed: OnceLock<Vec<(usize, LoadedBody)>>,
    /// Rows of B where they are the same for all shapes.
    fixed_rows: OnceLock<Arc<TornRows>>,
}

/// A factored body with what the loads of its subdomains in this process do to them.
pub(super) type LoadedBody = (Arc<Factored<FactoredBody>>, Vec<SubdomainLoad>);

/// Work on a subdomain of a body of fixed shape relative to one whose shape changes: products alone, no factors and no
/// sums for the derivative.
const FIXED_WEIGHT: f64 = 0.5;

/// Symbolic factors and interior classes by what they depend on.
#[derive(Default)]
struct Analyses {
    symbolic: HashMap<usize, Arc<SymbolicFactor>>,
    interior: HashMap<(usize, Vec<bool>), Arc<InteriorClass>>,
}

impl TornModel {
    /// Tears the bodies of a problem and builds the rows of this process.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails, [`ContactError::Clusters`] for clusters whose
    /// subdomains the rows of B_c do not hold together.
    pub fn new(problem: Arc<ContactProblem>, options: TornOptions) -> Result<Self, ContactError> {
        let TornOptions { preconditioner, clusters, communication, shelf } = options;
        let numbering = Numbering::new(&problem.bodies, clusters);
        let [clusters, distribution] = distributions(communication, &numbering, &problem);
        let rows = problem.rows(&problem.start_positions())?;
        let start = (&rows, problem.geometry.is_fixed());
        let (constraints, interface) =
            Constraints::new(&problem.bodies, &problem.boundary, &numbering, &distribution, start);
        check_motions(&constraints, &numbering, &distribution, &problem.bodies)?;
        let centres = cluster_centres(&numbering, &problem.bodies);
        let coarse = Arc::new(CoarsePattern::new(&constraints, &interface, &numbering, &clusters, &centres)?);
        let own = distribution.owned();
        let first = numbering.starts()[own.start];
        let starts: Arc<[usize]> = numbering.starts()[own.start..=own.end].iter().map(|start| start - first).collect();
        let own_clusters = clusters.owned();
        let cluster_starts: Arc<[usize]> = numbering.cluster_starts()[own_clusters.start..=own_clusters.end]
            .iter()
            .map(|number| number - own.start)
            .collect();
        let mut analyses = Analyses::default();
        let subdomain = |number: usize| {
            let (body, piece) = numbering.place(number);
            let pattern = &problem.bodies[body].pieces[piece].pattern;
            let symbolic = analyses.symbolic(pattern)?;
            let dofs = starts[number - own.start]..starts[number - own.start + 1];
            let interior = match preconditioner {
                PreconditionerKind::Dirichlet => Some(analyses.interior(pattern, &constraints.touched[dofs])?),
                PreconditionerKind::Lumped | PreconditionerKind::None => None,
            };
            Ok(TornSubdomain { body, piece, symbolic, interior })
        };
        let subdomains = distribution.agreed(own.clone().map(subdomain).collect())?;
        let mut model = Self {
            problem,
            subdomains,
            starts,
            numbering,
            distribution,
            clusters,
            cluster_starts,
            constraints: Arc::new(constraints),
            interface,
            coarse,
            keys: Vec::new(),
            shelf,
            fixed: OnceLock::new(),
            fixed_rows: OnceLock::new(),
        };
        model.keys = (0..model.problem.bodies.len()).map(|body| Arc::new(model.key(body))).collect();
        Ok(model)
    }

    /// What the factors of a body depend on beside positions.
    fn key(&self, body: usize) -> TornKey {
        let subdomain = |(index, own): (usize, &TornSubdomain)| {
            let touched = || self.constraints.touched[self.starts[index]..self.starts[index + 1]].to_vec();
            (index, own.piece, own.interior.as_ref().map(|_| touched()))
        };
        let subdomains = self.subdomains.iter().enumerate().filter(|(_, own)| own.body == body);
        let cluster = |(index, rows): (usize, &ClusterRows)| {
            (index, self.cluster_starts[index]..self.cluster_starts[index + 1], rows.clone())
        };
        let joined = self.constraints.joined.iter().enumerate().filter(|_| self.numbering.is_joined());
        let clusters = joined.filter(|(index, _)| self.subdomains[self.cluster_starts[*index]].body == body);
        let own =
            OwnParts { subdomains: subdomains.map(subdomain).collect(), clusters: clusters.map(cluster).collect() };
        TornKey::new(Arc::clone(&self.problem.bodies), body, own)
    }

    /// Number of torn dofs of all processes.
    pub fn total_dofs(&self) -> usize {
        self.numbering.dof_count()
    }

    /// The body and the piece of a subdomain of this process.
    pub fn piece(&self, index: usize) -> (&Body, &Piece) {
        let TornSubdomain { body, piece, .. } = &self.subdomains[index];
        (&self.problem.bodies[*body], &self.problem.bodies[*body].pieces[*piece])
    }

    /// B and B_D of a shape.
    pub(super) fn rows_of(&self, rows: &ContactRows) -> Arc<TornRows> {
        let build =
            || Arc::new(self.constraints.rows_of((&self.problem.bodies, rows), &self.interface, &self.distribution));
        if self.problem.geometry.is_fixed() { Arc::clone(self.fixed_rows.get_or_init(build)) } else { build() }
    }

    /// The class of a subdomain by its interior dofs: those without rows; none if the preconditioner needs none.
    pub fn interior(&self, subdomain: usize) -> Option<&InteriorClass> {
        self.subdomains[subdomain].interior.as_deref()
    }

    /// B u or B_D u for torn displacements u, or for a block of columns; their ghosts are filled in.
    pub fn rows_times<V: Entry>(&self, rows: &Csr, torn: &mut [V]) -> RowVector<V> {
        self.interface.complete(&self.distribution, torn);
        self.constraints.multiply(rows, torn, &self.distribution)
    }

    /// Displacements at the sides of the rows, weighted as the rows see them, from those of the nodes.
    pub(crate) fn weighted(&self, rows: &ContactRows, nodal: &NodeValues) -> NodeValues {
        let mut values = nodal.clone();
        for (number, (body, weights)) in self.problem.bodies.iter().zip(&rows.traces).enumerate() {
            for corner in body.trace.corners().filter(|corner| nodal.0[number].contains_key(corner)) {
                let own = body.trace.value(weights, corner, &|node| nodal.of(number, node));
                values.0[number].insert(corner, own);
            }
        }
        values
    }

    /// Forces on the nodes from those on the sides of the rows: the transpose of [`weighted`](Self::weighted).
    pub(crate) fn nodal_forces(&self, rows: &ContactRows, sides: &NodeValues) -> NodeValues {
        let mut values = NodeValues::zeros(self.problem.bodies.len());
        for (number, (body, weights)) in self.problem.bodies.iter().zip(&rows.traces).enumerate() {
            let mut own: Vec<(u32, [f64; 3])> = sides.0[number].iter().map(|(node, force)| (*node, *force)).collect();
            own.sort_unstable_by_key(|(node, _)| *node);
            for (node, force) in own {
                body.trace.spread(weights, node, force, &mut |node, share| values.add_to(number, node, share));
            }
        }
        values
    }

    /// The mean over the copies of torn displacements at every node in contact rows, along the axes; known to all
    /// processes.
    pub(crate) fn contact_displacements(&self, torn: &TornVector) -> NodeValues {
        let owned = self.distribution.owned();
        let first = self.numbering.starts()[owned.start];
        let mut pieces = vec![Vec::new(); owned.len()];
        for (index, (_, _, copies)) in self.constraints.contact_copies.iter().enumerate() {
            for &copy in copies {
                let subdomain = self.numbering.owner(copy);
                if owned.contains(&subdomain) {
                    let values = (0..3).map(|axis| torn.0[copy - first + axis] / copies.len() as f64);
                    pieces[subdomain - owned.start].extend(std::iter::once(index as f64).chain(values));
                }
            }
        }
        let mut sums = NodeValues::zeros(self.problem.bodies.len());
        for [index, values @ ..] in self.distribution.complete(pieces).iter().flat_map(|piece| piece.as_chunks::<4>().0)
        {
            let (body, node, _) = self.constraints.contact_copies[*index as usize];
            let sum = sums.0[body].entry(node).or_insert([0.0; 3]);
            (0..3).for_each(|axis| sum[axis] += values[axis]);
        }
        sums
    }

    /// Calls `add(dof, force)` with what vectors at nodes in contact rows are on the dofs of this process: the
    /// transpose of [`contact_displacements`](Self::contact_displacements).
    pub(crate) fn spread_contact(&self, vectors: &NodeValues, mut add: impl FnMut(usize, f64)) {
        let owned = self.distribution.owned();
        let first = self.numbering.starts()[owned.start];
        for (body, node, copies) in &self.constraints.contact_copies {
            let Some(vector) = vectors.0[*body].get(node) else { continue };
            for &copy in copies.iter().filter(|copy| owned.contains(&self.numbering.owner(**copy))) {
                (0..3).for_each(|axis| add(copy - first + axis, vector[axis] / copies.len() as f64));
            }
        }
    }

    /// Inner products of vectors over rows.
    pub fn sums(&self) -> RowSums<'_> {
        RowSums { constraints: &self.constraints, distribution: &self.distribution }
    }

    /// The zero vector over the torn dofs of this process and their ghosts.
    pub fn zeros(&self) -> TornVector {
        TornVector(vec![0.0; self.interface.torn_count()])
    }

    /// Coarse amplitudes of motions that nothing holds: Rᵀ of their displacement on all subdomains, of unit length.
    pub fn grounded_amplitudes(&self, system: &TornSystem, configuration: &Configuration) -> Vec<Vec<f64>> {
        let Configuration { positions, rigid, grounded, .. } = configuration;
        let amplitudes = |motion: &Vec<f64>| {
            let mut amplitudes = Vec::with_capacity(MOTIONS * self.subdomains.len());
            for (index, (subdomain, part)) in self.subdomains.iter().zip(&system.parts).enumerate() {
                let body = subdomain.body;
                let coefficients = &motion[MOTIONS * body..MOTIONS * (body + 1)];
                let points = self.piece(index).1.positions(&positions[body]);
                let displacement: Vec<f64> =
                    points.flat_map(|point| rigid.displacement(body, coefficients, point)).collect();
                amplitudes.extend(part.modes.iter().map(|mode| dot(mode, &displacement)));
            }
            let mut amplitudes = self.clusters.gather(&system.cluster_resultants(amplitudes), MOTIONS);
            let length = norm(&amplitudes);
            amplitudes.iter_mut().for_each(|amplitude| *amplitude /= length);
            amplitudes
        };
        grounded.iter().map(amplitudes).collect()
    }

    /// Mean over the contact nodes of the stiffness diagonals of the bodies in series, N/mm.
    pub fn contact_stiffness(&self, system: &TornSystem) -> f64 {
        let points = &self.problem.boundary.points;
        let own = self.constraints.own_contact_rows(&self.distribution);
        let scales: Vec<f64> = self.constraints.contact_scales(&self.problem.boundary).collect();
        // Per body: the diagonals at the copies of a node, in its normal row.
        let of_body = |body: usize| {
            let mut torn = self.zeros();
            for (index, part) in
                system.parts.iter().enumerate().filter(|(index, _)| self.subdomains[*index].body == body)
            {
                let starts = self.piece(index).1.pattern.lower.starts();
                let diagonal = &mut torn.0[system.dofs(index)];
                for (dof, diagonal) in diagonal.iter_mut().enumerate() {
                    *diagonal = part.boundary_stiffness()[starts[dof]];
                }
            }
            self.interface.complete(&self.distribution, &mut torn.0);
            let first = self.constraints.equality_count;
            // Entries of a row are d/(mν): their squares times m²ν² weigh the diagonals, one sum per copy.
            let sum = |&row: &usize| {
                let entries = || system.rows.rows.row(first + row).filter(|(place, _)| torn.0[*place] > 0.0);
                let square: f64 = entries().map(|(_, value)| value * value).sum();
                let weighted: f64 = entries().map(|(place, value)| value * value * torn.0[place]).sum();
                let copies = if square > 0.0 { 1.0 / (square * scales[row] * scales[row]) } else { 0.0 };
                vec![if square > 0.0 { copies * weighted / square } else { 0.0 }]
            };
            self.constraints.complete_contact(&own.iter().map(sum).collect::<Vec<_>>(), &self.distribution).concat()
        };
        let diagonals: Vec<Vec<f64>> = (0..self.problem.bodies.len()).map(of_body).collect();
        let series = |row: usize| {
            let own: Vec<f64> = diagonals.iter().map(|body| body[row]).filter(|diagonal| *diagonal > 0.0).collect();
            match own[..] {
                [only] => only,
                _ => 1.0 / own.iter().map(|diagonal| 1.0 / diagonal).sum::<f64>(),
            }
        };
        points.iter().map(|point| series(point.start)).sum::<f64>() / points.len() as f64
    }
}

impl Analyses {
    /// The symbolic factor of a pattern.
    fn symbolic(&mut self, pattern: &Arc<crate::body::PiecePattern>) -> Result<Arc<SymbolicFactor>, ContactError> {
        let key = Arc::as_ptr(pattern) as usize;
        if let Some(known) = self.symbolic.get(&key) {
            return Ok(Arc::clone(known));
        }
        let symbolic = pattern.symbolic(&pattern.fixing)?;
        self.symbolic.insert(key, Arc::clone(&symbolic));
        Ok(symbolic)
    }

    /// The interior class of one subdomain, shared among subdomains with the same interior dofs: those without rows of
    /// B and B_c. Dofs with rows of B_c have no jumps between subdomains: contact rows alone move them in the
    /// preconditioner.
    fn interior(
        &mut self,
        pattern: &Arc<crate::body::PiecePattern>,
        touched: &[bool],
    ) -> Result<Arc<InteriorClass>, ContactError> {
        let marked: Vec<bool> = touched.iter().map(|touched| !touched).collect();
        let key = (Arc::as_ptr(pattern) as usize, marked);
        if let Some(class) = self.interior.get(&key) {
            return Ok(Arc::clone(class));
        }
        let class = Arc::new(InteriorClass::new(&pattern.lower, &key.1, pattern.elimination_order(&[]))?);
        self.interior.insert(key, Arc::clone(&class));
        Ok(class)
    }
}

/// Which process works on which clusters, and on which subdomains.
fn distributions(
    communication: Arc<dyn Communication>,
    numbering: &Numbering,
    problem: &ContactProblem,
) -> [Arc<Distribution>; 2] {
    // Subdomains of different sizes take work in proportion to their nodes, roughly.
    let nodes = |number: usize| {
        let (body, piece) = numbering.place(number);
        let weight = if problem.map.shapes(body) { 1.0 } else { FIXED_WEIGHT };
        weight * problem.bodies[body].pieces[piece].nodes.len() as f64
    };
    let weight = |cluster| numbering.members(cluster).map(nodes).sum();
    let weights: Vec<f64> = (0..numbering.cluster_count()).map(weight).collect();
    let clusters = Arc::new(Distribution::new(communication, &weights));
    let subdomains = match numbering.is_joined() {
        true => Arc::new(clusters.refined(numbering.cluster_starts())),
        false => Arc::clone(&clusters),
    };
    [clusters, subdomains]
}

/// Means of the nodes of the clusters at the reference shape.
fn cluster_centres(numbering: &Numbering, bodies: &[Body]) -> Vec<[f64; 3]> {
    let centre = |cluster: usize| {
        let nodes = numbering.members(cluster).flat_map(|number| {
            let (body, piece) = numbering.place(number);
            bodies[body].pieces[piece].positions(bodies[body].mesh.nodes()).collect::<Vec<_>>()
        });
        let (sum, count) = nodes.fold(([0.0; 3], 0.0), |(sum, count), x| {
            (std::array::from_fn(|axis: usize| sum[axis] + x[axis]), count + 1.0)
        });
        sum.map(|sum: f64| sum / count)
    };
    (0..numbering.cluster_count()).map(centre).collect()
}

/// Refuses clusters with other motions than those of a rigid body, by their reference shape.
fn check_motions(
    constraints: &Constraints,
    numbering: &Numbering,
    distribution: &Distribution,
    bodies: &[Body],
) -> Result<(), ContactError> {
    if !numbering.is_joined() {
        return Ok(());
    }
    let nodes = |number: usize| {
        let (body, piece) = numbering.place(number);
        bodies[body].pieces[piece].positions(bodies[body].mesh.nodes()).collect::<Vec<_>>()
    };
    let own = distribution.owned();
    let first = if own.is_empty() { 0 } else { numbering.cluster_of(own.start) };
    let loose = parallel::map(constraints.joined.len(), &|index| {
        let places: Vec<_> = numbering.members(first + index).map(nodes).collect();
        !moves_as_one_body(&constraints.joined[index], &places)
    });
    let loose = loose.contains(&true);
    let reason = "their inner nodes do not hold the subdomains together; subdomains need more cells".to_string();
    match distribution.communication().agree(loose.then_some(reason)) {
        Some(reason) => Err(ContactError::Clusters { count: numbering.cluster_count(), reason }),
        None => Ok(()),
    }
}
