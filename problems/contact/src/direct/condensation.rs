//! One body condensed onto its contact nodes by a sparse Cholesky factorisation with the contact dofs last.
//!
//! ```text
//! K + σ I_c = L Lᵀ,   S = L₂₂ L₂₂ᵀ − σ I,   f̂_c = (S + σ I) x_c with (K + σ I_c) x = f
//! ```
//! The shift σ on the contact dofs holds the motions that supports leave free; it is taken off again exactly.

use crate::body::local_pattern::LocalPattern;
use crate::body::mesh::{Block, Grid};
use crate::body::shape_load::nodal_loads;
use crate::error::ContactError;
use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
use crate::linear::dense::{DenseLu, multiply};
use crate::linear::vector::add_scaled;
use crate::scene::BodyScene;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, Par};
use std::sync::Arc;

/// What all shapes of a body share.
#[derive(Debug)]
pub struct CondensationPattern {
    /// Sparsity and assembly of the body's stiffness matrix.
    pub(super) pattern: LocalPattern,
    symbolic: Arc<SymbolicFactor>,
    /// First dof of every contact node.
    contact: Vec<usize>,
    /// Whether supports hold a dof of the body.
    pub(super) held: Vec<bool>,
}

#[derive(Debug)]
pub struct CondensedBody {
    /// S over contact dofs 3·node + component, N/mm.
    pub(crate) schur: Mat<f64>,
    /// f̂_c, the loads condensed onto the contact dofs, N.
    pub(crate) load: Vec<f64>,
    factor: NumericFactor,
    /// The loads over the whole body, N; 0 at held dofs.
    pub(super) full_load: Vec<f64>,
    /// First dof of every contact node.
    pub(super) contact: Vec<usize>,
    shift: f64,
}

impl CondensationPattern {
    /// The pattern of a body whose contact nodes lie in layer `layer` of its grid.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the analysis fails.
    pub fn new(grid: &Grid, scene: &BodyScene, layer: usize) -> Result<Self, ContactError> {
        let pattern = LocalPattern::new(grid.cells, &[]);
        let nodes: Vec<usize> = grid.columns().map(|(i, j)| grid.node([i, j, layer])).collect();
        let symbolic = pattern.symbolic(&nodes)?;
        let mut held = Vec::with_capacity(3 * grid.node_count());
        for node in 0..grid.node_count() {
            held.extend(scene.held(grid, pattern.shape.local_position(node)));
        }
        Ok(Self { pattern, symbolic, contact: nodes.into_iter().map(|node| 3 * node).collect(), held })
    }

    /// Condenses one shape.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the stiffness matrix is not positive definite.
    pub fn condense(&self, block: &Block, scene: &BodyScene) -> Result<CondensedBody, ContactError> {
        let mut values = self.pattern.assemble(&scene.material, |brick| block.brick(brick));
        let mut full_load = nodal_loads(block, &self.pattern.shape, &scene.loads);
        let shift = self.impose(&mut values, &mut full_load);
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
        let mut solution = full_load.clone();
        factor.solve_in_place(&mut solution);
        let load = multiply(&schur, &contact_part(&self.contact, &solution));
        for dof in 0..size {
            schur[(dof, dof)] -= shift;
        }
        Ok(CondensedBody { schur, load, factor, full_load, contact: self.contact.clone(), shift })
    }

    /// Decouples held dofs and adds the shift; returns the shift.
    fn impose(&self, values: &mut [f64], load: &mut [f64]) -> f64 {
        let lower = &self.pattern.pattern;
        for column in 0..lower.dimension() {
            for position in lower.starts()[column] + 1..lower.starts()[column + 1] {
                if self.held[column] || self.held[lower.rows()[position]] {
                    values[position] = 0.0;
                }
            }
            if self.held[column] {
                load[column] = 0.0;
            }
        }
        let diagonal = |dof: usize| lower.starts()[dof];
        let dofs = || self.contact.iter().flat_map(|&first| first..first + 3);
        let shift = dofs().map(|dof| values[diagonal(dof)]).sum::<f64>() / (3 * self.contact.len()) as f64;
        for dof in dofs() {
            values[diagonal(dof)] += shift;
        }
        shift
    }
}

impl CondensedBody {
    /// S⁻¹f: displacements (mm) of the contact nodes under forces f (N) on them alone, for a body that supports hold.
    pub fn deflection(&self, forces: &[f64]) -> Vec<f64> {
        let mut displacement = forces.to_vec();
        DenseLu::new(&self.schur).solve_in_place(&mut displacement);
        displacement
    }

    /// What forces on the whole body, N, one column per load case, put on the contact dofs, N; held dofs do not count.
    pub fn condense_loads(&self, mut forces: Mat<f64>, held: &[bool]) -> Mat<f64> {
        for column in 0..forces.ncols() {
            for (force, _) in forces.col_as_slice_mut(column).iter_mut().zip(held).filter(|(_, held)| **held) {
                *force = 0.0;
            }
        }
        self.factor.solve_columns_in_place(&mut forces);
        let size = self.load.len();
        let mut loads = Mat::<f64>::zeros(size, forces.ncols());
        for column in 0..forces.ncols() {
            let contact = contact_part(&self.contact, forces.col_as_slice(column));
            let mut load = multiply(&self.schur, &contact);
            add_scaled(&mut load, self.shift, &contact);
            loads.col_as_slice_mut(column).copy_from_slice(&load);
        }
        loads
    }

    /// Extends contact displacements to the body under `load` (0 at held dofs); `forces` act on the contact dofs.
    pub fn extend(&self, contact_displacement: &[f64], forces: &[f64], load: &[f64]) -> Vec<f64> {
        let mut u = load.to_vec();
        for (node, &first) in self.contact.iter().enumerate() {
            for component in 0..3 {
                let dof = 3 * node + component;
                u[first + component] += forces[dof] + self.shift * contact_displacement[dof];
            }
        }
        self.factor.solve_in_place(&mut u);
        u
    }
}

fn contact_part(contact: &[usize], values: &[f64]) -> Vec<f64> {
    contact.iter().flat_map(|&first| values[first..first + 3].iter().copied()).collect()
}
