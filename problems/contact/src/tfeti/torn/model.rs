//! The torn scene: what is fixed for a run, and the factored system of one shape.

use crate::body::elasticity::traction::face_weights;
use crate::body::local_pattern::{LocalPattern, fixing_nodes};
use crate::body::mesh::{Block, Subdomain, Tearing};
use crate::body::shape_load::loaded_faces;
use crate::communication::Communication;
use crate::equilibrium::modes::motions;
use crate::equilibrium::{Configuration, ContactProblem};
use crate::error::ContactError;
use crate::lattice;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::entry::Entry;
use crate::linear::vector::dot;
use crate::scene::BodyScene;
use crate::tfeti::torn::coarse_pattern::CoarsePattern;
use crate::tfeti::torn::constraints::{BodyRows, Constraints};
use crate::tfeti::torn::factors::{InteriorClass, SubdomainFactors, SubdomainRigid};
use crate::tfeti::torn::preconditioner_kind::PreconditionerKind;
use crate::tfeti::torn::vectors::TornVector;
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
    /// Its first torn dof.
    pub first_dof: usize,
    interior: Option<Arc<InteriorClass>>,
}

/// Everything that does not depend on the shape: tearing, rows, patterns, and the factors of bodies that keep their shape.
#[derive(Debug)]
pub struct TornModel {
    /// The problem that was torn.
    pub problem: Arc<ContactProblem>,
    /// All subdomains, lower body first.
    pub subdomains: Vec<TornSubdomain>,
    /// Rows of B.
    pub constraints: Constraints,
    /// Pattern shared by all subdomains.
    pub pattern: LocalPattern,
    /// Pattern of the coarse matrices.
    pub coarse: Arc<CoarsePattern>,
    symbolic: Arc<SymbolicFactor>,
    fixed: OnceLock<Vec<TornPart>>,
    /// The process this model lives in.
    pub communication: Arc<dyn Communication>,
    /// Number of torn dofs.
    pub dof_count: usize,
}

/// One subdomain of one shape.
#[derive(Debug, Clone)]
pub struct TornPart {
    /// Rigid motions, known to every process.
    pub rigid: Arc<SubdomainRigid>,
    /// Factors, on the process that works on the subdomain.
    pub factors: Option<Arc<SubdomainFactors>>,
}

/// The factored subdomains of one shape.
#[derive(Debug)]
pub struct TornSystem {
    /// All subdomains, lower body first.
    pub parts: Vec<TornPart>,
    /// Numeric factorisations done for this shape, by all processes.
    pub factorizations: usize,
    /// Largest [`SubdomainFactors::forward_error`] of all subdomains.
    pub forward_error: f64,
}

impl TornModel {
    /// Tears the bodies of a problem and builds its rows.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a symbolic analysis fails.
    pub fn new(
        problem: Arc<ContactProblem>,
        preconditioner: PreconditionerKind,
        communication: Arc<dyn Communication>,
    ) -> Result<Self, ContactError> {
        let tearing = Tearing::new(&problem.grid, problem.scene.subdomains);
        let size = tearing.subdomains[0].dof_count();
        let per_body = tearing.subdomains.len();
        let offsets: Vec<usize> = (0..per_body * problem.bodies().count()).map(|index| index * size).collect();
        let dof_count = offsets.len() * size;
        let rows: Vec<BodyRows<'_>> = problem
            .bodies()
            .zip(offsets.chunks_exact(per_body))
            .map(|(scene, offsets)| BodyRows { grid: &problem.grid, tearing: &tearing, scene, offsets })
            .collect();
        let constraints = Constraints::new(&problem.scene, &rows, &problem.boundary, dof_count);
        let counts = problem.scene.subdomains;
        let coarse = Arc::new(CoarsePattern::new(&constraints.rows, constraints.equality_count, counts, size)?);
        let cells = tearing.subdomains[0].cells;
        let fixing = fixing_nodes(cells);
        let pattern = LocalPattern::new(cells, &fixing);
        let symbolic = pattern.symbolic(&fixing)?;
        let mut classes = HashMap::new();
        let mut subdomains = Vec::with_capacity(offsets.len());
        for (index, &first_dof) in offsets.iter().enumerate() {
            let interior = match preconditioner {
                PreconditionerKind::Dirichlet => {
                    Some(interior_class(&mut classes, &pattern, &constraints, first_dof..first_dof + size)?)
                }
                PreconditionerKind::Lumped | PreconditionerKind::None => None,
            };
            let place = tearing.subdomains[index % per_body].clone();
            subdomains.push(TornSubdomain { body: index / per_body, place, first_dof, interior });
        }
        Ok(Self {
            problem,
            subdomains,
            constraints,
            pattern,
            coarse,
            symbolic,
            fixed: OnceLock::new(),
            communication,
            dof_count,
        })
    }

    /// Factors the subdomains of the given blocks (lower, then upper). The upper body keeps its shape: it is factored at the first call
    /// and shared afterwards. Factorisations are counted over all processes.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] from a subdomain.
    pub fn factorize(&self, blocks: &[Block]) -> Result<TornSystem, ContactError> {
        let mut parts = self.factorize_body(0, &self.problem.scene.lower, &blocks[0])?;
        let mut factored = parts.len();
        if let (Some(upper), Some(block)) = (&self.problem.scene.upper, blocks.get(1)) {
            if self.fixed.get().is_none() {
                let upper = self.factorize_body(1, &upper.body, block)?;
                factored += upper.len();
                // Another thread may have been first; its factors are the same.
                let _ = self.fixed.set(upper);
            }
            parts.extend(self.fixed.get().into_iter().flatten().cloned());
        }
        let count = |index: usize| {
            let factors = parts[index].factors.iter().filter(|_| index < factored);
            factors.map(|factors| factors.factorizations() as f64).collect()
        };
        let factorizations = self.share_pieces(count).concat().into_iter().sum::<f64>() as usize;
        let error = |index: usize| parts[index].factors.iter().map(|factors| factors.forward_error).collect();
        let forward_error = self.share_pieces(error).concat().into_iter().fold(0.0, f64::max);
        Ok(TornSystem { parts, factorizations, forward_error })
    }

    fn factorize_body(&self, body: usize, scene: &BodyScene, block: &Block) -> Result<Vec<TornPart>, ContactError> {
        let owned = self.owned();
        let parts: Result<Vec<TornPart>, ContactError> = self
            .subdomains
            .par_iter()
            .enumerate()
            .filter(|(_, subdomain)| subdomain.body == body)
            .map(|(index, subdomain)| {
                let place = &subdomain.place;
                let coordinates: Vec<[f64; 3]> =
                    (0..place.node_count()).map(|node| block.coordinates(place.block_position(node))).collect();
                let load = loads(scene, place, block);
                let rigid = Arc::new(SubdomainRigid::new(&coordinates, &load));
                if !owned.contains(&index) {
                    return Ok(TornPart { rigid, factors: None });
                }
                let factors = SubdomainFactors::new(
                    &self.pattern,
                    &self.symbolic,
                    &scene.material,
                    Arc::clone(&rigid),
                    |local| block.brick(lattice::add(local, place.first_cell)),
                    &load,
                    subdomain.interior.as_deref(),
                )?;
                Ok(TornPart { rigid, factors: Some(Arc::new(factors)) })
            })
            .collect();
        // A process that goes on alone would wait for the others forever.
        let failure = self.communication.agree(parts.as_ref().err().map(ToString::to_string));
        match failure {
            Some(reason) if parts.is_ok() => {
                Err(ContactError::Factorization { what: "subdomain of another process".into(), reason })
            }
            _ => parts,
        }
    }

    /// The class of a subdomain by its interior dofs: those without rows; none if the preconditioner needs none.
    pub fn interior(&self, subdomain: usize) -> Option<&InteriorClass> {
        self.subdomains[subdomain].interior.as_deref()
    }

    /// Completes a torn vector, or a block of columns, at the dofs with rows: those of other processes' subdomains are filled in.
    pub fn share_interface<V: Entry>(&self, torn: &mut [V]) {
        if self.communication.size() == 1 {
            return;
        }
        let transposed = &self.constraints.transposed;
        self.share_dofs(torn, |dof| transposed.row(dof).next().is_some());
    }

    /// Completes a torn vector at all dofs.
    pub fn share_torn(&self, torn: &mut TornVector) {
        if self.communication.size() > 1 {
            self.share_dofs(&mut torn.0, |_| true);
        }
    }

    fn share_dofs<V: Entry>(&self, torn: &mut [V], shared: impl Fn(usize) -> bool) {
        let size = self.pattern.pattern.dimension();
        let owned = self.owned();
        let dofs = |subdomain: usize| (size * subdomain..size * (subdomain + 1)).filter(|&dof| shared(dof));
        let values = |dof: usize| (0..V::WIDTH).map(move |column| (dof, column));
        let piece = |subdomain| dofs(subdomain).flat_map(values).map(|(dof, column)| torn[dof].get(column)).collect();
        let mut pieces: Vec<Vec<f64>> = (0..self.subdomains.len())
            .map(|subdomain| if owned.contains(&subdomain) { piece(subdomain) } else { vec![] })
            .collect();
        pieces = self.complete(&pieces);
        for (subdomain, piece) in pieces.iter().enumerate().filter(|(subdomain, _)| !owned.contains(subdomain)) {
            for ((dof, column), value) in dofs(subdomain).flat_map(values).zip(piece) {
                torn[dof].set(column, *value);
            }
        }
    }

    /// What `own` gives for the subdomains, by the processes that work on them, in the order of the subdomains.
    pub fn share_pieces(&self, own: impl Fn(usize) -> Vec<f64>) -> Vec<Vec<f64>> {
        let owned = self.owned();
        let piece = |subdomain| if owned.contains(&subdomain) { own(subdomain) } else { vec![] };
        let pieces: Vec<Vec<f64>> = (0..self.subdomains.len()).map(piece).collect();
        self.complete(&pieces)
    }

    /// The subdomains of this process.
    fn owned(&self) -> std::ops::Range<usize> {
        let (rank, size, count) = (self.communication.rank(), self.communication.size(), self.subdomains.len());
        rank * count / size..(rank + 1) * count / size
    }

    /// Pieces of all subdomains from those of the own ones.
    fn complete(&self, pieces: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let own = &pieces[self.owned()];
        let lengths: Vec<f64> = own.iter().map(|piece| piece.len() as f64).collect();
        let lengths = self.communication.gather_any(&lengths).concat();
        let mut values = self.communication.gather_any(&own.concat()).concat().into_iter();
        lengths.iter().map(|&length| values.by_ref().take(length as usize).collect()).collect()
    }

    /// The zero vector over torn dofs.
    pub fn zeros(&self) -> TornVector {
        TornVector(vec![0.0; self.dof_count])
    }

    /// Coarse amplitudes of the motions that nothing holds: Rᵀ of their displacement on every subdomain.
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
                    let basis = motions(point, rigid.centre, rigid.length);
                    for component in 0..3 {
                        displacement.push(basis.iter().zip(coefficients).map(|(b, c)| b[component] * c).sum::<f64>());
                    }
                }
                amplitudes.extend(part.rigid.modes.iter().map(|mode| dot(mode, &displacement)));
            }
            amplitudes
        };
        grounded.iter().map(amplitudes).collect()
    }

    /// Mean over the contact nodes of the stiffness diagonals of the bodies in series, N/mm.
    pub fn contact_stiffness(&self, system: &TornSystem) -> f64 {
        let size = self.pattern.pattern.dimension();
        let starts = self.pattern.pattern.starts();
        let points = &self.problem.boundary.points;
        let row_entries =
            |start: usize| self.constraints.rows.row(self.constraints.equality_count + start).map(|(dof, _)| dof);
        let mut torn = self.zeros();
        for dof in points.iter().flat_map(|point| row_entries(point.start)) {
            if let Some(factors) = &system.parts[dof / size].factors {
                torn.0[dof] = factors.boundary_stiffness()[starts[dof % size]];
            }
        }
        self.share_interface(&mut torn.0);
        let mut diagonals = vec![0.0; 2 * points.len()];
        for (point, diagonal) in points.iter().zip(diagonals.chunks_exact_mut(2)) {
            for dof in row_entries(point.start) {
                diagonal[self.subdomains[dof / size].body] += torn.0[dof];
            }
        }
        let series = |diagonal: &[f64]| match self.problem.scene.upper {
            Some(_) => 1.0 / (1.0 / diagonal[0] + 1.0 / diagonal[1]),
            None => diagonal[0],
        };
        diagonals.chunks_exact(2).map(series).sum::<f64>() / points.len() as f64
    }
}

/// Consistent nodal loads of a subdomain.
fn loads(body: &BodyScene, place: &Subdomain, block: &Block) -> Vec<f64> {
    let mut load = vec![0.0; place.dof_count()];
    for scene_load in &body.loads {
        for face in loaded_faces(&block.grid, scene_load.face, Some(place)) {
            let weights = face_weights(&face.map(|node| block.coordinates(node)));
            for (node, weight) in face.into_iter().zip(weights) {
                let first = 3 * place.local_node(lattice::subtract(node, place.first_cell));
                for (component, traction) in scene_load.traction.iter().enumerate() {
                    load[first + component] += weight * traction;
                }
            }
        }
    }
    load
}

/// The interior class of one subdomain, shared among subdomains with the same interior dofs.
fn interior_class(
    classes: &mut HashMap<Vec<bool>, Arc<InteriorClass>>,
    pattern: &LocalPattern,
    constraints: &Constraints,
    dofs: std::ops::Range<usize>,
) -> Result<Arc<InteriorClass>, ContactError> {
    let marked: Vec<bool> = dofs.map(|dof| constraints.transposed.row(dof).next().is_none()).collect();
    if let Some(class) = classes.get(&marked) {
        return Ok(Arc::clone(class));
    }
    let class = Arc::new(InteriorClass::new(&pattern.pattern, &marked, pattern.elimination_order(&[]))?);
    classes.insert(marked, Arc::clone(&class));
    Ok(class)
}
