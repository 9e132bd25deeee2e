//! Matrices of one subdomain: stiffness, generalised inverse, rigid modes, interior factor.
//!
//! ```text
//! K⁺ = (K + ρ N Nᵀ)⁻¹,  N = orthonormal basis of R restricted to three fixing nodes:   K K⁺ K = K
//! ```
//! A nearly incompressible subdomain has a second stiffness matrix, of a compressible material of the same shear
//! modulus. The preconditioner takes a jump of displacements half and half, and such halves change the volume of a
//! subdomain although no motion of the body has to: with K itself, they would count λ/μ times too much. The factor c is
//! a stiffness against contact forces, which the volume does not resist either.
//!
//! Where the factor loses many digits, forces are balanced before and displacements after K⁺: (I − RRᵀ) K⁺ (I − RRᵀ) is
//! another generalised inverse, whose displacements are no larger than the deformation. Forces out of balance would
//! bend a thin plate over its three fixing nodes by many times of what the forces together do, and lose all digits.
//!
//! Reference: \[BrzobohatyDostalKozubekKovarMarkopoulos2011\].

use crate::body::elasticity::Material;
use crate::body::{Body, MOTIONS, Piece, PiecePattern};
use crate::error::ContactError;
use crate::linear::cholesky::{NumericFactor, SymbolicFactor};
use crate::linear::entry::{Entry, vectorized};
use crate::linear::right_side::RightSide;
use crate::linear::symmetric::{LowerPattern, Submatrix, SymmetricBlock};
use crate::linear::vector::{add_scaled, dot};
use crate::tfeti::torn::rigid_modes::{orthonormal_modes, orthonormalise};
use std::sync::Arc;

/// Interior dofs of a class of subdomains and the analysis of their matrix.
#[derive(Debug)]
pub struct InteriorClass {
    /// The principal submatrix of the interior dofs.
    pub submatrix: Submatrix,
    /// Its symbolic factor; none if there are no interior dofs.
    pub symbolic: Option<Arc<SymbolicFactor>>,
    /// Dofs with rows of B or B_c, ascending.
    pub boundary: Vec<usize>,
    /// The block K_BB.
    pub boundary_block: SymmetricBlock,
    /// The block K_IB.
    pub coupling: SymmetricBlock,
    /// The block K_BI.
    pub coupling_transposed: SymmetricBlock,
}

impl InteriorClass {
    /// The class of given interior dofs; `order`: elimination order of all dofs.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the symbolic analysis fails.
    pub fn new(pattern: &LowerPattern, interior: &[bool], order: Vec<usize>) -> Result<Self, ContactError> {
        let submatrix = Submatrix::new(pattern, interior);
        let boundary: Vec<usize> = (0..interior.len()).filter(|&dof| !interior[dof]).collect();
        let order: Vec<usize> = order.into_iter().filter_map(|dof| submatrix.kept.binary_search(&dof).ok()).collect();
        let symbolic = (!order.is_empty()).then(|| SymbolicFactor::new(Arc::clone(&submatrix.pattern), order));
        Ok(Self {
            symbolic: symbolic.transpose()?.map(Arc::new),
            boundary_block: SymmetricBlock::new(pattern, &boundary, &boundary),
            coupling: SymmetricBlock::new(pattern, &submatrix.kept, &boundary),
            coupling_transposed: SymmetricBlock::new(pattern, &boundary, &submatrix.kept),
            boundary,
            submatrix,
        })
    }
}

/// What the loads of a subdomain do to it.
#[derive(Debug, Clone)]
pub struct SubdomainLoad {
    /// K⁺ f, mm; empty for an unloaded subdomain.
    pub displacement: Vec<f64>,
    /// Resultants Rᵀ f along its rigid modes, N.
    pub resultants: [f64; MOTIONS],
}

/// The matrices and rigid motions of one subdomain; they do not depend on loads.
#[derive(Debug)]
pub struct SubdomainFactors {
    /// Values of the stiffness matrix K over [`PiecePattern::lower`].
    pub stiffness: Vec<f64>,
    /// Values of the stiffness matrix of the compressible neighbour of a nearly incompressible material.
    compressible: Option<Vec<f64>>,
    /// Factor of K + ρNNᵀ.
    pub inverse: NumericFactor,
    /// Factor of the interior matrix of [`SubdomainFactors::boundary_stiffness`], if the preconditioner needs it.
    pub interior: Option<NumericFactor>,
    /// Orthonormal rigid modes, six columns.
    pub modes: Vec<Vec<f64>>,
    /// |K⁺K x − x|/|x| modulo rigid motions for a probe x: the digits that the condition of K takes.
    pub forward_error: f64,
}

/// Largest relative residual of K K⁺ K x = K x accepted at factor time.
const GENERALISED_INVERSE: f64 = 1e-8;

/// Forward error of the factor from which K⁺ is balanced. Bricks with edges 1 : 10 have 1e-12, 1 : 100 have 1e-8.
const LOST_DIGITS: f64 = 1e-10;

impl SubdomainFactors {
    /// Assembles and factors one subdomain: a piece of a body at given positions of its nodes.
    ///
    /// `interior`: class to factor for the Dirichlet preconditioner.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when a matrix is not positive definite or K K⁺ K = K fails,
    /// [`ContactError::ResistsRigidMotions`].
    pub fn new(
        (body, piece): (&Body, &Piece),
        symbolic: &Arc<SymbolicFactor>,
        positions: &[[f64; 3]],
        interior: Option<&InteriorClass>,
    ) -> Result<Self, ContactError> {
        let pattern = &*piece.pattern;
        let stiffness = piece.assemble(&body.solid, positions, |material| *material);
        piece.check_kernel(&body.name, positions, &stiffness)?;
        let near = |material: &Material| material.compressible_neighbour().unwrap_or(*material);
        let is_near = body.solid.materials().iter().any(|material| material.compressible_neighbour().is_some());
        let compressible = is_near.then(|| piece.assemble(&body.solid, positions, near));
        let coordinates: Vec<[f64; 3]> = piece.positions(positions).collect();
        let modes = orthonormal_modes(&coordinates);
        let regularised = regularise(pattern, &stiffness, &modes);
        let inverse = symbolic.factorize(&regularised)?;
        let forward_error = check_generalised_inverse(pattern, &stiffness, &inverse, &modes)?;
        let interior = match interior.and_then(|class| class.symbolic.as_ref().map(|symbolic| (class, symbolic))) {
            Some((class, symbolic)) => {
                let factored = symbolic.factorize(&class.submatrix.gather(compressible.as_ref().unwrap_or(&stiffness)));
                // Rows may leave a motion of the interior free. The regularised matrix has definite submatrices.
                let definite = |_| symbolic.factorize(&class.submatrix.gather(&regularised));
                Some(factored.or_else(definite)?)
            }
            None => None,
        };
        Ok(Self { stiffness, compressible, inverse, interior, modes, forward_error })
    }

    /// What consistent nodal loads, N, do to the subdomain.
    pub fn loaded(&self, mut load: Vec<f64>) -> SubdomainLoad {
        let resultants = std::array::from_fn(|mode| dot(&self.modes[mode], &load));
        match load.iter().any(|&force| force != 0.0) {
            true => self.solve(&mut load),
            false => load.clear(),
        }
        SubdomainLoad { displacement: load, resultants }
    }

    /// The resultants Rᵀ x.
    pub(crate) fn resultants_of<V: Entry>(&self, x: &[V]) -> [V; MOTIONS] {
        let mut resultants = [V::ZERO; MOTIONS];
        vectorized(
            #[inline(always)]
            || {
                for (resultant, mode) in resultants.iter_mut().zip(&self.modes) {
                    mode.iter().zip(x).for_each(|(&value, x)| resultant.accumulate(value, x));
                }
            },
        );
        resultants
    }

    /// x ← K⁺ x, in the precision of x.
    pub(crate) fn solve<V: RightSide>(&self, x: &mut [V]) {
        self.balance(x);
        V::solve(&self.inverse, x);
        self.balance(x);
    }

    /// x ← (I − RRᵀ) x where the factor loses many digits.
    pub(crate) fn balance<V: Entry>(&self, x: &mut [V]) {
        if self.forward_error <= LOST_DIGITS {
            return;
        }
        for mode in &self.modes {
            let mut amplitude = V::ZERO;
            mode.iter().zip(&*x).for_each(|(&entry, x)| amplitude.add_scaled(entry, x));
            mode.iter().zip(&mut *x).for_each(|(&entry, x)| x.add_scaled(-entry, &amplitude));
        }
    }

    /// The stiffness that a body offers to displacements of its boundary: K, or that of the compressible neighbour. The
    /// preconditioner and the factor c are made of it.
    pub fn boundary_stiffness(&self) -> &[f64] {
        self.compressible.as_ref().unwrap_or(&self.stiffness)
    }

    /// Number of numeric factorisations this subdomain took.
    pub fn factorizations(&self) -> usize {
        1 + usize::from(self.interior.is_some())
    }
}

/// Values of K + ρNNᵀ.
fn regularise(pattern: &PiecePattern, stiffness: &[f64], modes: &[Vec<f64>]) -> Vec<f64> {
    let dofs: Vec<usize> = pattern.fixing.iter().flat_map(|node| 3 * node..3 * node + 3).collect();
    let mut restricted: Vec<Vec<f64>> = modes.iter().map(|mode| dofs.iter().map(|&dof| mode[dof]).collect()).collect();
    orthonormalise(&mut restricted);
    let rho = pattern.mean_diagonal(stiffness);
    let mut values = stiffness.to_vec();
    for (first, &row) in dofs.iter().enumerate() {
        for (second, &column) in dofs.iter().enumerate() {
            if row >= column {
                let product: f64 = restricted.iter().map(|mode| mode[first] * mode[second]).sum();
                let position = pattern.lower.position(row, column).expect("invariant: fixing nodes are coupled");
                values[position] += rho * product;
            }
        }
    }
    values
}

/// Probes K K⁺ K x = K x with one fixed vector; returns the forward error of K⁺.
fn check_generalised_inverse(
    pattern: &PiecePattern,
    stiffness: &[f64],
    inverse: &NumericFactor,
    modes: &[Vec<f64>],
) -> Result<f64, ContactError> {
    let dimension = pattern.lower.dimension();
    let probe: Vec<f64> = (0..dimension).map(|index| (1.7 * index as f64 + 0.3).sin()).collect();
    let (mut image, mut again) = (vec![0.0; dimension], vec![0.0; dimension]);
    pattern.lower.multiply(stiffness, &probe, &mut image);
    let mut solution = image.clone();
    inverse.solve_in_place(&mut solution);
    pattern.lower.multiply(stiffness, &solution, &mut again);
    add_scaled(&mut again, -1.0, &image);
    let error = (dot(&again, &again) / dot(&image, &image)).sqrt();
    if error.is_nan() || error > GENERALISED_INVERSE {
        return Err(ContactError::Factorization {
            what: "generalised inverse of a subdomain".into(),
            reason: format!("|K K⁺ K x − K x|/|K x| = {error:.2e}, allowed: {GENERALISED_INVERSE:.0e}"),
        });
    }
    add_scaled(&mut solution, -1.0, &probe);
    for mode in modes {
        let amplitude = dot(mode, &solution);
        add_scaled(&mut solution, -amplitude, mode);
    }
    Ok((dot(&solution, &solution) / dot(&probe, &probe)).sqrt())
}
