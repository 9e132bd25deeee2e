//! One body condensed onto its contact nodes by a sparse Cholesky factorisation, with the rows of the contact nodes as
//! its border.
//!
//! ```text
//! K̂ = K + σ BᵀB (foundation)  or  K + ρ Σ_i e_i e_iᵀ (springs),    Ĉ = B K̂⁻¹ Bᵀ,    w = B u
//! prescribed u_D:   u = u_D + v,  v = 0 at held dofs,  K v = (f − K u_D) − Bᵀλ;      displacements: of v
//! ```
//! B: the displacements w that contact rows see ([`Trace`](crate::body::Trace)), three rows per contact node, 0 at held
//! dofs. Where w are the displacements of the contact nodes themselves, an elastic foundation under them makes K
//! regular; it keeps the digits of bodies that bend as easily as bricks of extreme proportions let them. Elsewhere BᵀB
//! would couple many nodes: one spring per rigid motion that the supports leave free, at single dofs far from each
//! other, holds the body, and loads in equilibrium put no force on it. All is computed in the coordinates of the nodes
//! in which supports hold axes ([`NodalAxes`]).

use crate::body::elasticity::Material;
use crate::body::loads::piece_loads;
use crate::body::{Body, NodalAxes, Piece, TraceWeights};
use crate::error::ContactError;
use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
use crate::linear::vector::add_scaled;
use faer::Mat;
use nalgebra::Matrix3;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Values of a factor above which it is given back when that of another shape is computed: two of them are more than a
/// machine that holds one may have.
const LARGE_FACTOR: usize = 1 << 25;
/// Sizes of the rows of the motions that differ by rounding.
const EQUAL_SIZES: f64 = 1e-9;

/// What all shapes of a body share.
#[derive(Debug)]
pub struct CondensationPattern {
    /// The whole body.
    pub(super) piece: Piece,
    pub(super) axes: NodalAxes,
    symbolic: Arc<SymbolicFactor>,
    /// The nodes in contact rows, ascending, by their places in the piece.
    pub(super) contact: Vec<usize>,
    /// These nodes by their numbers in the mesh.
    contact_nodes: Vec<u32>,
    /// The factor that was computed last, of any shape.
    latest: Mutex<Weak<Slot>>,
}

/// A factor; none after it has been given back.
type Slot = Mutex<Option<Arc<NumericFactor>>>;

/// A condensed body without loads.
#[derive(Debug)]
pub struct CondensedBody {
    pub(super) pattern: Arc<CondensationPattern>,
    /// The trace of the body at the shape.
    pub(super) weights: TraceWeights,
    /// Ĉ over contact dofs 3·node + component, mm/N.
    pub(super) compliance: Mat<f64>,
    /// σ, N/mm; none where springs hold the body.
    pub(super) foundation: Option<f64>,
    /// B by rows: dof of the body, value.
    rows: Vec<Vec<(usize, f64)>>,
    /// The factor of K̂.
    factor: Arc<Slot>,
    /// K̂.
    matrix: Vec<f64>,
    /// The stiffness of every contact node, N/mm: where the others stand on the foundation, else the diagonal of K.
    pub(super) local: Vec<[[f64; 3]; 3]>,
}

impl CondensationPattern {
    /// The pattern of a body with given nodes in contact rows, ascending.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the analysis fails.
    pub fn new(body: &Body, contact: &[u32]) -> Result<Self, ContactError> {
        let piece = body.whole();
        let known = contact.iter().filter_map(|&node| Some((node, piece.local(node)?)));
        let (contact_nodes, contact): (Vec<u32>, Vec<usize>) = known.unzip();
        let (axes, symbolic) = (NodalAxes::new(body, &piece), piece.pattern.symbolic(&[])?);
        Ok(Self { axes, piece, symbolic, contact, contact_nodes, latest: Mutex::default() })
    }

    /// Condenses one shape; `motions`: the free rigid motions over the dofs of the body, independent, 0 at held dofs.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the stiffness matrix is not positive definite,
    /// [`ContactError::ResistsRigidMotions`].
    pub fn condense(
        self: &Arc<Self>,
        body: &Body,
        positions: &[[f64; 3]],
        motions: &[Vec<f64>],
    ) -> Result<CondensedBody, ContactError> {
        let mut values = self.piece.assemble(&body.solid, positions, |material| *material);
        self.piece.check_kernel(&body.name, positions, &values)?;
        let diagonal = if body.trace.is_empty() { Vec::new() } else { self.diagonal(body, positions, &values) };
        self.axes.turn_matrix(&self.piece.pattern.lower, &mut values);
        self.hold(&mut values);
        let foundation = body.trace.is_empty().then(|| self.stand_on_foundation(&mut values));
        if foundation.is_none() {
            let stiffness = self.piece.pattern.mean_diagonal(&values);
            let starts = self.piece.pattern.lower.starts();
            sprung(motions).into_iter().for_each(|dof| values[starts[dof]] += stiffness);
        }
        let weights = body.trace.weights(positions);
        let rows = self.rows(body, &weights);
        self.give_latest_back(LARGE_FACTOR);
        let (factor, compliance) = self.symbolic.factorize_bordered(&values, &rows)?;
        let local = foundation.map_or(diagonal, |foundation| on_foundation(&compliance, foundation));
        let (pattern, factor) = (Arc::clone(self), Arc::new(Mutex::new(Some(Arc::new(factor)))));
        *self.latest.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(&factor);
        Ok(CondensedBody { pattern, weights, compliance, foundation, rows, factor, matrix: values, local })
    }

    /// Gives the factor back that was computed last, where it has more than so many values.
    pub(super) fn give_latest_back(&self, most: usize) {
        let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner).upgrade();
        if let Some(slot) = latest {
            slot.lock().unwrap_or_else(PoisonError::into_inner).take_if(|factor| factor.value_count() > most);
        }
    }

    /// The place of a node of the mesh among the nodes in contact rows.
    pub(super) fn contact_place(&self, node: u32) -> Option<usize> {
        self.contact_nodes.binary_search(&node).ok()
    }

    /// The nodes in contact rows by their numbers in the mesh.
    pub(super) fn contact_nodes(&self) -> &[u32] {
        &self.contact_nodes
    }

    /// u_D, mm: what supports prescribe at held dofs, 0 at free ones.
    pub(super) fn lift(&self, body: &Body) -> Vec<f64> {
        self.axes.lift(&self.piece, |node| body.prescribed(node))
    }

    /// Forces along the axes in the coordinates of the body, with 0 at held dofs, which supports carry.
    pub(super) fn free_forces(&self, forces: &mut [f64]) {
        self.axes.turn(forces);
        self.release(forces);
    }

    /// Sets forces on held dofs to 0.
    fn release(&self, forces: &mut [f64]) {
        forces.iter_mut().zip(&self.axes.held).filter(|(_, held)| **held).for_each(|(force, _)| *force = 0.0);
    }

    /// Adds a foundation, the mean diagonal of K there, at the free contact dofs; returns it, N/mm.
    fn stand_on_foundation(&self, values: &mut [f64]) -> f64 {
        let starts = self.piece.pattern.lower.starts();
        let dofs = || self.contact.iter().flat_map(|&node| 3 * node..3 * node + 3);
        let foundation = dofs().map(|dof| values[starts[dof]]).sum::<f64>() / (3 * self.contact.len()) as f64;
        dofs().filter(|&dof| !self.axes.held[dof]).for_each(|dof| values[starts[dof]] += foundation);
        foundation
    }

    /// Decouples held dofs.
    fn hold(&self, values: &mut [f64]) {
        let (lower, held) = (&self.piece.pattern.lower, &self.axes.held);
        for column in 0..lower.dimension() {
            for position in lower.starts()[column] + 1..lower.starts()[column + 1] {
                if held[column] || held[lower.rows()[position]] {
                    values[position] = 0.0;
                }
            }
        }
    }

    /// The blocks of K on the diagonal at the contact nodes, turned; a nearly incompressible material is replaced by
    /// its compressible neighbour, since volume does not resist contact forces.
    fn diagonal(&self, body: &Body, positions: &[[f64; 3]], stiffness: &[f64]) -> Vec<[[f64; 3]; 3]> {
        let is_near = body.solid.materials().iter().any(|material| material.compressible_neighbour().is_some());
        let near = |material: &Material| material.compressible_neighbour().unwrap_or(*material);
        let other = is_near.then(|| self.piece.assemble(&body.solid, positions, near));
        let (values, starts) = (other.as_deref().unwrap_or(stiffness), self.piece.pattern.lower.starts());
        let entry = |node: usize, row: usize, column: usize| {
            values[starts[3 * node + row.min(column)] + row.max(column) - row.min(column)]
        };
        let of_node = |&node: &usize| {
            let block: [[f64; 3]; 3] = std::array::from_fn(|row| std::array::from_fn(|j| entry(node, row, j)));
            let half = block.map(|row| self.axes.turn_at(node, row));
            let columns: [[f64; 3]; 3] = std::array::from_fn(|j| half.map(|row| row[j]));
            columns.map(|column| self.axes.turn_at(node, column))
        };
        self.contact.iter().map(of_node).collect()
    }

    /// B by rows.
    fn rows(&self, body: &Body, weights: &TraceWeights) -> Vec<Vec<(usize, f64)>> {
        let mut rows = Vec::with_capacity(3 * self.contact.len());
        for (place, &node) in self.contact.iter().enumerate() {
            for axis in 0..3 {
                let mut entries: BTreeMap<usize, f64> = BTreeMap::new();
                if !self.holds(3 * place + axis) {
                    let unit = std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 });
                    let along = self.axes.turn_back_at(node, unit);
                    body.trace.spread(weights, self.contact_nodes[place], along, &mut |node, share| {
                        let node = self.piece.local(node).expect("invariant: nodes of the trace are in the body");
                        for (axis, value) in self.axes.turn_at(node, share).into_iter().enumerate() {
                            *entries.entry(3 * node + axis).or_default() += value;
                        }
                    });
                }
                let free = entries.into_iter().filter(|(dof, value)| *value != 0.0 && !self.axes.held[*dof]);
                rows.push(free.collect());
            }
        }
        rows
    }

    /// Whether supports hold a contact dof.
    pub(super) fn holds(&self, dof: usize) -> bool {
        self.axes.held[3 * self.contact[dof / 3] + dof % 3]
    }
}

/// The stiffness of every contact node where the others stand on a foundation, of Ĉ; 0 along held dofs.
fn on_foundation(compliance: &Mat<f64>, foundation: f64) -> Vec<[[f64; 3]; 3]> {
    let of_node = |node: usize| {
        let held = |axis: usize| compliance[(3 * node + axis, 3 * node + axis)] == 0.0;
        let entry = |row: usize, column: usize| {
            let is_held = row == column && held(row);
            if is_held { 1.0 / foundation } else { compliance[(3 * node + row, 3 * node + column)] }
        };
        let inverse = Matrix3::from_fn(entry).try_inverse().unwrap_or_else(Matrix3::zeros);
        std::array::from_fn(|row| {
            std::array::from_fn(|column| inverse[(row, column)] - if row == column { foundation } else { 0.0 })
        })
    };
    (0..compliance.nrows() / 3).map(of_node).collect()
}

/// One dof per motion: where the motions are largest, those at other such dofs left out.
fn sprung(motions: &[Vec<f64>]) -> Vec<usize> {
    let mut rest = motions.to_vec();
    let mut dofs = Vec::new();
    for _motion in motions {
        let size = |dof: usize| rest.iter().map(|motion| motion[dof] * motion[dof]).sum::<f64>();
        let count = rest.first().map_or(0, Vec::len);
        let largest = (0..count).map(size).fold(0.0, f64::max);
        let Some(dof) = (0..count).find(|&dof| size(dof) >= (1.0 - EQUAL_SIZES) * largest) else { break };
        let row: Vec<f64> = rest.iter().map(|motion| motion[dof] / largest.sqrt()).collect();
        // The combination of the motions that moves this dof is taken out of all.
        for place in 0..count {
            let share: f64 = rest.iter().zip(&row).map(|(motion, part)| motion[place] * part).sum();
            rest.iter_mut().zip(&row).for_each(|(motion, part)| motion[place] -= share * part);
        }
        dofs.push(dof);
    }
    dofs
}

impl CondensedBody {
    /// f − K u_D over the whole body, N, for its loads f and prescribed displacements u_D; 0 at held dofs.
    pub(super) fn loads(&self, body: &Body, positions: &[[f64; 3]], lift: &[f64]) -> Vec<f64> {
        let mut load = piece_loads(body, &self.pattern.piece, positions);
        self.pattern.axes.turn(&mut load);
        self.unbalanced(body, positions, lift, load)
    }

    /// f − K v, N, for displacements v and forces f in the coordinates of the body; 0 at held dofs, which supports
    /// carry.
    pub(super) fn unbalanced(&self, body: &Body, positions: &[[f64; 3]], v: &[f64], mut force: Vec<f64>) -> Vec<f64> {
        let CondensationPattern { piece, axes, .. } = &*self.pattern;
        if v.iter().any(|entry| *entry != 0.0) {
            let (mut u, mut image) = (v.to_vec(), vec![0.0; v.len()]);
            axes.turn_back(&mut u);
            let stiffness = piece.assemble(&body.solid, positions, |material| *material);
            piece.pattern.lower.multiply(&stiffness, &u, &mut image);
            axes.turn(&mut image);
            add_scaled(&mut force, -1.0, &image);
        }
        self.pattern.release(&mut force);
        force
    }

    /// B u over the contact dofs.
    pub(super) fn contact_part(&self, u: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|entries| entries.iter().map(|&(dof, value)| value * u[dof]).sum()).collect()
    }

    /// Adds Bᵀ of forces on the contact dofs to forces on the whole body.
    pub(super) fn add_contact_forces(&self, contact: &[f64], forces: &mut [f64]) {
        for (force, entries) in contact.iter().zip(&self.rows) {
            entries.iter().for_each(|&(dof, value)| forces[dof] += value * force);
        }
    }

    /// K̂⁻¹ f in place, for forces on the whole body, 0 at held dofs, one column per load.
    pub(super) fn solve(&self, forces: &mut Mat<f64>) {
        self.factor().solve_columns_in_place(forces);
    }

    /// The factor of K̂, computed again after it has been given back.
    fn factor(&self) -> Arc<NumericFactor> {
        let lock = || self.factor.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = &*lock() {
            return Arc::clone(known);
        }
        // No lock is held while another one is waited for.
        self.pattern.give_latest_back(LARGE_FACTOR);
        *self.pattern.latest.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(&self.factor);
        let mut factor = lock();
        let again = || {
            let found = self.pattern.symbolic.factorize_bordered(&self.matrix, &self.rows);
            Arc::new(found.expect("invariant: the matrix has been factored before").0)
        };
        Arc::clone(factor.get_or_insert_with(again))
    }
}
