//! The torn scene: what is fixed for a run, and the factored system of a shape. A process holds its subdomains only.

use crate::body::local_pattern::{LocalPattern, fixing_nodes};
use crate::body::mesh::{Block, Subdomain, Tearing};
use crate::body::shape_load::nodal_loads;
use crate::communication::Communication;
use crate::equilibrium::{Configuration, ContactProblem};
use crate::error::ContactError;
use crate::lattice;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::linear::vector::{dot, norm};
use crate::scene::BodyScene;
use crate::tfeti::torn::cluster_factors::{ClusterFactors, moves_as_one_body};
use crate::tfeti::torn::cluster_rows::ClusterRows;
use crate::tfeti::torn::coarse_pattern::CoarsePattern;
use crate::tfeti::torn::constraints::Constraints;
use crate::tfeti::torn::distribution::Distribution;
use crate::tfeti::torn::factors::{InteriorClass, SubdomainFactors};
use crate::tfeti::torn::interface::Interface;
use crate::tfeti::torn::numbering::Numbering;
use crate::tfeti::torn::options::TornOptions;
use crate::tfeti::torn::preconditioner_kind::PreconditionerKind;
use crate::tfeti::torn::row_sums::RowSums;
use crate::tfeti::torn::scene_rows::BodyRows;
use crate::tfeti::torn::system::TornSystem;
use crate::tfeti::torn::vectors::{RowVector, TornVector};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// One subdomain in the torn scene.
#[derive(Debug)]
pub struct TornSubdomain {
    /// 0 for the lower, 1 for the upper body.
    pub body: usize,
    /// Its place in the block.
    pub place: Subdomain,
    /// Its first dof in the torn vectors of its process.
    pub first_dof: usize,
    interior: Option<Arc<InteriorClass>>,
}

/// Everything that does not depend on the shape: tearing, rows, patterns, and the factors of bodies of fixed shape.
#[derive(Debug)]
pub struct TornModel {
    /// The problem that was torn.
    pub problem: Arc<ContactProblem>,
    /// The subdomains of this process, in the order of all subdomains.
    pub subdomains: Vec<TornSubdomain>,
    /// Bodies and places of all subdomains.
    pub numbering: Numbering,
    /// Which process works on which subdomains.
    pub distribution: Arc<Distribution>,
    /// Which process works on which clusters of subdomains: what has rigid motions of its own.
    pub clusters: Arc<Distribution>,
    /// The rows of B.
    pub constraints: Arc<Constraints>,
    /// Dofs that this process shares with others.
    pub interface: Interface,
    /// Pattern shared by all subdomains.
    pub pattern: LocalPattern,
    /// Pattern of the coarse matrices.
    pub coarse: Arc<CoarsePattern>,
    symbolic: Arc<SymbolicFactor>,
    /// Factors of the upper body.
    fixed: OnceLock<FactoredBody>,
    /// Number of torn dofs of all processes.
    pub total_dofs: usize,
}

/// The factors of the subdomains and clusters of a body in this process.
#[derive(Debug, Clone)]
struct FactoredBody {
    parts: Vec<Arc<SubdomainFactors>>,
    clusters: Vec<Arc<ClusterFactors>>,
}

/// Work on a subdomain of the upper body relative to one of the lower body, whose shape changes: products alone, no
/// factors and no sums for the derivative.
const FIXED_WEIGHT: f64 = 0.5;

impl TornModel {
    /// Tears the bodies of a problem and builds the rows of this process.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails, [`ContactError::Clusters`] for clusters that do
    /// not divide the subdomains, or whose subdomains the rows of B_c do not hold together.
    pub fn new(problem: Arc<ContactProblem>, options: TornOptions) -> Result<Self, ContactError> {
        let TornOptions { preconditioner, clusters: shape, communication } = options;
        let counts = problem.scene.subdomains;
        let boxes = cluster_counts(counts, shape)?;
        let tearing = Tearing::new(&problem.grid, counts);
        let size = tearing.subdomains[0].dof_count();
        let numbering = Numbering::new(&tearing, counts, shape, problem.bodies().count());
        let members = numbering.members();
        let [clusters, distribution] = distributions(communication, &numbering);
        let offsets = |body| (0..tearing.subdomains.len()).map(|index| size * numbering.number(body, index)).collect();
        let bodies: Vec<BodyRows<'_>> = problem
            .bodies()
            .enumerate()
            .map(|(body, scene)| BodyRows {
                grid: &problem.grid,
                tearing: &tearing,
                scene,
                offsets: offsets(body),
                cluster_size: size * members,
            })
            .collect();
        let (constraints, interface) =
            Constraints::new(&problem.scene, &bodies, &problem.boundary, size, &distribution);
        check_motions(&constraints, &numbering, &distribution, shape)?;
        let coarse =
            Arc::new(CoarsePattern::new(&constraints, &interface, &numbering, &clusters, boxes, size * members)?);
        let cells = tearing.subdomains[0].cells;
        let fixing = fixing_nodes(cells);
        let pattern = LocalPattern::new(cells, &fixing);
        let symbolic = pattern.symbolic(&fixing)?;
        let mut classes = HashMap::new();
        let subdomain = |(index, number): (usize, usize)| {
            let first_dof = size * index;
            let interior = match preconditioner {
                PreconditionerKind::Dirichlet => {
                    let joined = &constraints.joined[index / members].members[index % members].dofs;
                    Some(interior_class(&mut classes, &pattern, &constraints, first_dof..first_dof + size, joined)?)
                }
                PreconditionerKind::Lumped | PreconditionerKind::None => None,
            };
            let (body, place) = numbering.place(number);
            Ok(TornSubdomain { body, place: place.clone(), first_dof, interior })
        };
        let subdomains = distribution.agreed(distribution.owned().enumerate().map(subdomain).collect())?;
        Ok(Self {
            problem,
            subdomains,
            total_dofs: size * numbering.count(),
            numbering,
            distribution,
            clusters,
            constraints: Arc::new(constraints),
            interface,
            pattern,
            coarse,
            symbolic,
            fixed: OnceLock::new(),
        })
    }

    /// Number of dofs of other processes that rows of this one need: values received per product with B.
    pub fn ghost_count(&self) -> usize {
        self.interface.torn_count() - self.interface.owned_count()
    }

    /// Factors the subdomains of the given blocks (lower, then upper). The upper body keeps its shape: it is factored
    /// at the first call and shared afterwards. Factorisations are counted over all processes.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] from a subdomain.
    pub fn factorize(&self, blocks: &[Block]) -> Result<TornSystem, ContactError> {
        let lower = self.factorize_body(0, &self.problem.scene.lower, &blocks[0])?;
        let count = |body: &FactoredBody| body.parts.iter().map(|part| part.factorizations()).sum::<usize>();
        let mut factored = count(&lower);
        if let (Some(upper), Some(block), None) = (&self.problem.scene.upper, blocks.get(1), self.fixed.get()) {
            let upper = self.factorize_body(1, &upper.body, block)?;
            factored += count(&upper);
            // Another thread may have been first; its factors are the same.
            let _ = self.fixed.set(upper);
        }
        let bodies = || std::iter::once(&lower).chain(self.fixed.get());
        let mut parts: Vec<_> = bodies().map(|body| body.parts.iter().cloned()).collect();
        let mut clusters: Vec<_> = bodies().map(|body| body.clusters.iter().cloned()).collect();
        let parts: Vec<Arc<SubdomainFactors>> =
            self.subdomains.iter().filter_map(|subdomain| parts[subdomain.body].next()).collect();
        let first = self.subdomains.iter().step_by(self.numbering.members());
        let clusters = first.filter_map(|subdomain| clusters[subdomain.body].next()).collect();
        let factorizations = self.distribution.sum_of_processes(factored as f64) as usize;
        let forward_error = parts.iter().map(|part| part.forward_error).fold(0.0, f64::max);
        let forward_error = self.distribution.largest(forward_error);
        Ok(TornSystem { parts, clusters, factorizations, forward_error })
    }

    /// The factors of the subdomains and clusters of a body in this process.
    fn factorize_body(&self, body: usize, scene: &BodyScene, block: &Block) -> Result<FactoredBody, ContactError> {
        let factor = |subdomain: &TornSubdomain| {
            let (place, coordinates) = (&subdomain.place, coordinates(&subdomain.place, block));
            let factors = SubdomainFactors::new(
                &self.pattern,
                &self.symbolic,
                &scene.material,
                &coordinates,
                |local| block.brick(lattice::add(local, place.first_cell)),
                &nodal_loads(block, place, &scene.loads),
                subdomain.interior.as_deref(),
            )?;
            Ok(Arc::new(factors))
        };
        let own = self.subdomains.par_iter().filter(|subdomain| subdomain.body == body);
        let parts: Result<Vec<Arc<SubdomainFactors>>, ContactError> = own.map(factor).collect();
        let factored =
            parts.and_then(|parts| Ok(FactoredBody { clusters: self.join_body(body, block, &parts)?, parts }));
        self.distribution.agreed(factored)
    }

    /// What joins the clusters of a body in this process, from its factored subdomains; nothing for single subdomains.
    fn join_body(
        &self,
        body: usize,
        block: &Block,
        parts: &[Arc<SubdomainFactors>],
    ) -> Result<Vec<Arc<ClusterFactors>>, ContactError> {
        let members = self.numbering.members();
        if members == 1 {
            return Ok(vec![]);
        }
        let own = self.subdomains.par_chunks(members).zip(&self.constraints.joined);
        let own: Vec<_> = own.filter(|(subdomains, _)| subdomains[0].body == body).collect();
        let join = |((subdomains, rows), parts): (&(&[TornSubdomain], &ClusterRows), &[Arc<SubdomainFactors>])| {
            let coordinates: Vec<Vec<[f64; 3]>> =
                subdomains.iter().map(|subdomain| coordinates(&subdomain.place, block)).collect();
            let stiffness = self.pattern.mean_diagonal(&parts[0].stiffness);
            ClusterFactors::new(rows, parts, &coordinates, stiffness).map(Arc::new)
        };
        own.par_iter().zip(parts.par_chunks(members)).map(join).collect()
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
        let Configuration { blocks, rigid, grounded, .. } = configuration;
        let amplitudes = |motion: &Vec<f64>| {
            let mut amplitudes = Vec::with_capacity(6 * self.subdomains.len());
            for (subdomain, part) in self.subdomains.iter().zip(&system.parts) {
                let coefficients = &motion[6 * subdomain.body..6 * subdomain.body + 6];
                let place = &subdomain.place;
                let mut displacement = Vec::with_capacity(place.dof_count());
                for node in 0..place.node_count() {
                    let point = blocks[subdomain.body].coordinates(place.block_position(node));
                    let basis = rigid.frames[subdomain.body].motions(point);
                    for component in 0..3 {
                        displacement.push(basis.iter().zip(coefficients).map(|(b, c)| b[component] * c).sum::<f64>());
                    }
                }
                amplitudes.extend(part.modes.iter().map(|mode| dot(mode, &displacement)));
            }
            let mut amplitudes = self.clusters.gather(&system.cluster_resultants(amplitudes), 6);
            let length = norm(&amplitudes);
            amplitudes.iter_mut().for_each(|amplitude| *amplitude /= length);
            amplitudes
        };
        grounded.iter().map(amplitudes).collect()
    }

    /// Mean over the contact nodes of the stiffness diagonals of the bodies in series, N/mm.
    pub fn contact_stiffness(&self, system: &TornSystem) -> f64 {
        let size = self.pattern.pattern.dimension();
        let starts = self.pattern.pattern.starts();
        let points = &self.problem.boundary.points;
        let own = self.constraints.own_contact_rows(&self.distribution);
        // Per body: the sum of the diagonals at the copies of a node, in its normal row.
        let of_body = |body: usize| {
            let mut torn = self.zeros();
            for (subdomain, part) in self.subdomains.iter().zip(&system.parts).filter(|(own, _)| own.body == body) {
                let diagonal = &mut torn.0[subdomain.first_dof..subdomain.first_dof + size];
                for (dof, diagonal) in diagonal.iter_mut().enumerate() {
                    *diagonal = part.boundary_stiffness()[starts[dof]];
                }
            }
            self.interface.complete(&self.distribution, &mut torn.0);
            let first = self.constraints.equality_count;
            let sum = |&row: &usize| vec![self.constraints.rows.row(first + row).map(|(dof, _)| torn.0[dof]).sum()];
            self.constraints.complete_contact(&own.iter().map(sum).collect::<Vec<_>>(), &self.distribution).concat()
        };
        let diagonals: Vec<Vec<f64>> = (0..self.problem.bodies().count()).map(of_body).collect();
        let series = |row: usize| match &diagonals[..] {
            [lower, upper] => 1.0 / (1.0 / lower[row] + 1.0 / upper[row]),
            bodies => bodies[0][row],
        };
        points.iter().map(|point| series(point.start)).sum::<f64>() / points.len() as f64
    }
}

/// Which process works on which clusters, and on which subdomains.
fn distributions(communication: Arc<dyn Communication>, numbering: &Numbering) -> [Arc<Distribution>; 2] {
    let members = numbering.members();
    let weight = |cluster| if numbering.place(cluster * members).0 == 0 { 1.0 } else { FIXED_WEIGHT };
    let weights: Vec<f64> = (0..numbering.cluster_count()).map(weight).collect();
    let clusters = Arc::new(Distribution::new(communication, &weights));
    let subdomains = if members == 1 { Arc::clone(&clusters) } else { Arc::new(clusters.refined(members)) };
    [clusters, subdomains]
}

fn cluster_counts(counts: [usize; 3], shape: [usize; 3]) -> Result<[usize; 3], ContactError> {
    if (0..3).any(|axis| shape[axis] == 0 || !counts[axis].is_multiple_of(shape[axis])) {
        let reason = format!("their numbers have to divide the {counts:?} subdomains of a body");
        return Err(ContactError::Clusters { shape, reason });
    }
    Ok(std::array::from_fn(|axis| counts[axis] / shape[axis]))
}

/// Refuses clusters with other motions than those of a rigid body. Whether nodes hold subdomains together does not
/// depend on the shape of the body; bricks of edge one stand for all.
fn check_motions(
    constraints: &Constraints,
    numbering: &Numbering,
    distribution: &Distribution,
    shape: [usize; 3],
) -> Result<(), ContactError> {
    let members = numbering.members();
    if members == 1 {
        return Ok(());
    }
    let nodes = |number: usize| {
        let place = numbering.place(number).1;
        (0..place.node_count()).map(|node| place.block_position(node).map(|index| index as f64)).collect()
    };
    let first = distribution.owned().start;
    let loose = constraints.joined.par_iter().enumerate().any(|(index, rows)| {
        let numbers = first + members * index..first + members * (index + 1);
        !moves_as_one_body(rows, &numbers.map(nodes).collect::<Vec<_>>())
    });
    let reason = "their inner nodes do not hold the subdomains together; subdomains need more bricks".to_string();
    match distribution.communication().agree(loose.then_some(reason)) {
        Some(reason) => Err(ContactError::Clusters { shape, reason }),
        None => Ok(()),
    }
}

/// Coordinates of the nodes of a subdomain.
fn coordinates(place: &Subdomain, block: &Block) -> Vec<[f64; 3]> {
    (0..place.node_count()).map(|node| block.coordinates(place.block_position(node))).collect()
}

/// The interior class of one subdomain, shared among subdomains with the same interior dofs: those without rows of B
/// and B_c. `joined`: its dofs with rows of B_c. They have no jumps between subdomains: contact rows alone move them in
/// the preconditioner.
fn interior_class(
    classes: &mut HashMap<Vec<bool>, Arc<InteriorClass>>,
    pattern: &LocalPattern,
    constraints: &Constraints,
    dofs: std::ops::Range<usize>,
    joined: &[usize],
) -> Result<Arc<InteriorClass>, ContactError> {
    let mut marked: Vec<bool> = dofs.map(|dof| constraints.transposed.row(dof).next().is_none()).collect();
    joined.iter().for_each(|&dof| marked[dof] = false);
    if let Some(class) = classes.get(&marked) {
        return Ok(Arc::clone(class));
    }
    let class = Arc::new(InteriorClass::new(&pattern.pattern, &marked, pattern.elimination_order(&[]))?);
    classes.insert(marked, Arc::clone(&class));
    Ok(class)
}
