//! One body condensed onto its contact nodes by a sparse Cholesky factorisation with the contact dofs last.
//!
//! ```text
//! K + σ I_c = L Lᵀ,   S = L₂₂ L₂₂ᵀ − σ I,   f̂_c = (S + σ I) x_c with (K + σ I_c) x = f
//! prescribed u_D:     u = u_D + v,  v = 0 at held dofs,  K v = (f − K u_D) − Bᵀλ;   forces and displacements: of v
//! ```
//! The shift σ on the contact dofs holds the motions that supports leave free; it is taken off again exactly. All is
//! computed in the [`Coordinates`] of the body.

use crate::body::loads::piece_loads;
use crate::body::{Body, Piece, TraceWeights};
use crate::direct::coordinates::Coordinates;
use crate::error::ContactError;
use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
use crate::linear::dense::{DenseLu, multiply};
use crate::linear::vector::add_scaled;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, Par};
use std::sync::Arc;

/// What all shapes of a body share.
#[derive(Debug)]
pub struct CondensationPattern {
    /// The whole body.
    pub(super) piece: Piece,
    pub(super) coordinates: Coordinates,
    symbolic: Arc<SymbolicFactor>,
    /// The nodes in contact rows, ascending, by their places in the piece.
    pub(super) contact: Vec<usize>,
    /// These nodes by their numbers in the mesh.
    contact_nodes: Vec<u32>,
}

/// A condensed body without loads.
#[derive(Debug)]
pub struct CondensedBody {
    pub(super) pattern: Arc<CondensationPattern>,
    /// The trace of the body at the shape.
    pub(super) weights: TraceWeights,
    /// S over contact dofs 3·node + component, N/mm.
    pub(crate) schur: Mat<f64>,
    pub(super) factor: NumericFactor,
    pub(super) shift: f64,
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
        let (coordinates, symbolic) = Coordinates::new(body, &piece, &contact)?;
        Ok(Self { coordinates, piece, symbolic, contact, contact_nodes })
    }

    /// Condenses one shape.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the stiffness matrix is not positive definite,
    /// [`ContactError::ResistsRigidMotions`].
    pub fn condense(self: &Arc<Self>, body: &Body, positions: &[[f64; 3]]) -> Result<CondensedBody, ContactError> {
        let stiffness = self.piece.assemble(&body.solid, positions, |material| *material);
        self.piece.check_kernel(&body.name, positions, &stiffness)?;
        let weights = body.trace.weights(positions);
        let mut values = self.coordinates.matrix((body, &self.piece), &weights, stiffness);
        let shift = self.impose(&mut values);
        let factor = self.symbolic.factorize(&values)?;
        let size = 3 * self.contact.len();
        let lower = factor.trailing_block(size);
        let mut schur = Mat::<f64>::zeros(size, size);
        matmul(
            schur.as_mut(),
            BlockStructure::Rectangular,
            Accum::Replace,
            lower.as_ref(),
            BlockStructure::TriangularLower,
            lower.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        for dof in 0..size {
            schur[(dof, dof)] -= shift;
        }
        Ok(CondensedBody { pattern: Arc::clone(self), weights, schur, factor, shift })
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
        self.coordinates.lift(body, &self.piece)
    }

    /// Decouples held dofs and adds the shift; returns the shift.
    fn impose(&self, values: &mut [f64]) -> f64 {
        let (lower, held) = (&self.coordinates.lower, &self.coordinates.axes.held);
        for column in 0..lower.dimension() {
            for position in lower.starts()[column] + 1..lower.starts()[column + 1] {
                if held[column] || held[lower.rows()[position]] {
                    values[position] = 0.0;
                }
            }
        }
        let diagonal = |dof: usize| lower.starts()[dof];
        let dofs = || self.contact.iter().flat_map(|&node| 3 * node..3 * node + 3);
        let shift = dofs().map(|dof| values[diagonal(dof)]).sum::<f64>() / (3 * self.contact.len()) as f64;
        for dof in dofs() {
            values[diagonal(dof)] += shift;
        }
        shift
    }

    /// The entries of a vector over the body that belong to the contact nodes.
    pub(super) fn contact_part(&self, values: &[f64]) -> Vec<f64> {
        self.contact.iter().flat_map(|&node| values[3 * node..3 * node + 3].iter().copied()).collect()
    }

    /// Whether supports hold a contact dof.
    pub(super) fn holds(&self, dof: usize) -> bool {
        self.coordinates.axes.held[3 * self.contact[dof / 3] + dof % 3]
    }
}

impl CondensedBody {
    /// f − K u_D over the whole body, N, for its loads f and prescribed displacements u_D; 0 at held dofs.
    pub(super) fn loads(&self, body: &Body, positions: &[[f64; 3]], lift: &[f64]) -> Vec<f64> {
        let mut load = piece_loads(body, &self.pattern.piece, positions);
        self.pattern.coordinates.forces(&body.trace, &self.weights, &mut load);
        self.unbalanced(body, positions, lift, load)
    }

    /// f − K v, N, for displacements v and forces f in the coordinates of the body; 0 at held dofs, which supports
    /// carry.
    pub(super) fn unbalanced(&self, body: &Body, positions: &[[f64; 3]], v: &[f64], mut force: Vec<f64>) -> Vec<f64> {
        let CondensationPattern { piece, coordinates, .. } = &*self.pattern;
        if v.iter().any(|entry| *entry != 0.0) {
            let (mut u, mut image) = (v.to_vec(), vec![0.0; v.len()]);
            coordinates.displacements(&body.trace, &self.weights, &mut u);
            let stiffness = piece.assemble(&body.solid, positions, |material| *material);
            piece.pattern.lower.multiply(&stiffness, &u, &mut image);
            coordinates.forces(&body.trace, &self.weights, &mut image);
            add_scaled(&mut force, -1.0, &image);
        }
        coordinates.hold(&mut force);
        force
    }

    /// S⁻¹f: displacements (mm) of the contact nodes under forces f (N) on them alone, for a body that supports hold.
    pub fn deflection(&self, forces: &[f64]) -> Vec<f64> {
        let mut displacement = forces.to_vec();
        DenseLu::new(&self.schur).solve_in_place(&mut displacement);
        displacement
    }

    /// What forces on the whole body, N, 0 at held dofs, one column per load case, put on the contact dofs, N.
    pub fn condense_loads(&self, mut forces: Mat<f64>) -> Mat<f64> {
        self.factor.solve_columns_in_place(&mut forces);
        let mut loads = Mat::<f64>::zeros(self.schur.nrows(), forces.ncols());
        for column in 0..forces.ncols() {
            let contact = self.pattern.contact_part(forces.col_as_slice(column));
            let mut load = multiply(&self.schur, &contact);
            add_scaled(&mut load, self.shift, &contact);
            loads.col_as_slice_mut(column).copy_from_slice(&load);
        }
        loads
    }

    /// Extends contact displacements to the body under `load` (0 at held dofs); `forces` act on the contact dofs.
    pub(super) fn extend(&self, contact_displacement: &[f64], forces: &[f64], load: &[f64]) -> Vec<f64> {
        let mut u = load.to_vec();
        for (index, &node) in self.pattern.contact.iter().enumerate() {
            for component in 0..3 {
                let dof = 3 * index + component;
                u[3 * node + component] += forces[dof] + self.shift * contact_displacement[dof];
            }
        }
        self.factor.solve_in_place(&mut u);
        u
    }

    /// Loads over the whole body and forces on the contact dofs, N, together.
    pub(super) fn full_force(&self, load: &[f64], forces: &[f64]) -> Vec<f64> {
        let mut full = load.to_vec();
        for (&node, force) in self.pattern.contact.iter().zip(forces.chunks_exact(3)) {
            add_scaled(&mut full[3 * node..3 * node + 3], 1.0, force);
        }
        full
    }
}
