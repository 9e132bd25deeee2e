//! The rows of B: gluing and supports (B_E), then contact. They are orthonormal; geometry does not enter.
//!
//! ```text
//! gluing of m copies:  (m − 1) Helmert rows;   supports: one row per copy (no gluing of that dof)
//! contact:             (mean over copies of the lower body − mean over copies of the upper body)/ν,  ν = |normal row|
//! λ_physical = λ/ν,  jump_physical = ν·jump:   all rows of a node share ν, so the friction cone keeps its form
//! ```
//! B_D Bᵀ = I with stiffness weights between bodies: B_D gives the softer body the larger share.

use crate::body::mesh::{Grid, Tearing};
use crate::equilibrium::ContactBoundary;
use crate::error::ContactError;
use crate::lattice;
use crate::linear::csr::Csr;
use crate::linear::entry::Entry;
use crate::scene::{BodyScene, Scene};
use crate::tfeti::torn::vectors::RowVector;

/// B, B_D and their transposes over torn dofs; the same for all shapes.
#[derive(Debug)]
pub struct Constraints {
    /// B: rows × torn dofs.
    pub rows: Csr,
    /// Bᵀ.
    pub transposed: Csr,
    /// B_D: rows × torn dofs; B_D Bᵀ = I.
    pub weighted: Csr,
    /// B_Dᵀ.
    pub weighted_transposed: Csr,
    /// Number of rows of B_E; contact rows follow in packed order.
    pub equality_count: usize,
    /// Number of gluing rows among them.
    pub gluing_count: usize,
    /// ν of every contact node.
    pub normalisation: Vec<f64>,
}

/// What the rows need to know of one body.
pub struct BodyRows<'a> {
    /// The grid.
    pub grid: &'a Grid,
    /// Its subdomains.
    pub tearing: &'a Tearing,
    /// Its supports.
    pub scene: &'a BodyScene,
    /// First torn dof of every subdomain.
    pub offsets: &'a [usize],
}

impl BodyRows<'_> {
    /// Torn dofs of the copies of a block node, first component.
    fn copies(&self, position: [usize; 3]) -> Vec<usize> {
        let copies = self.tearing.copies(position);
        copies.into_iter().map(|(subdomain, node)| self.offsets[subdomain] + 3 * node).collect()
    }
}

impl Constraints {
    /// All rows of a scene.
    pub fn new(scene: &Scene, bodies: &[BodyRows<'_>], boundary: &ContactBoundary, torn_dofs: usize) -> Self {
        let mut rows = Vec::new();
        let mut gluing_count = 0;
        for body in bodies {
            gluing_count += equality_rows(body, &mut rows);
        }
        let equality_count = rows.len();
        let mut weighted = rows.clone();
        let mut normalisation = Vec::with_capacity(boundary.points.len());
        for point in &boundary.points {
            let mut scale = None;
            for component in std::iter::once(2).chain(point.tangents.iter().copied()) {
                let parts = contact_parts(scene, bodies, point.position, component);
                let squared: f64 = parts.iter().map(|part| 1.0 / part.copies.len() as f64).sum();
                let nu = *scale.get_or_insert(squared.sqrt());
                let (row, weights) = contact_row(&parts, nu);
                rows.push(row);
                weighted.push(weights);
            }
            normalisation.push(scale.unwrap_or(1.0));
        }
        let rows = Csr::from_rows(torn_dofs, rows);
        let weighted = Csr::from_rows(torn_dofs, weighted);
        Self {
            transposed: rows.transpose(),
            weighted_transposed: weighted.transpose(),
            rows,
            weighted,
            equality_count,
            gluing_count,
            normalisation,
        }
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.rows.row_count()
    }

    /// The zero vector over all rows.
    pub fn zeros(&self) -> RowVector {
        RowVector::new(vec![0.0; self.row_count()], self.equality_count)
    }

    /// A product with rows of B or B_D, as a vector over all rows.
    pub(crate) fn multiply<V: Entry>(&self, rows: &Csr, torn: &[V]) -> RowVector<V> {
        let mut result = vec![V::ZERO; self.row_count()];
        rows.multiply(torn, &mut result);
        RowVector::new(result, self.equality_count)
    }

    /// Given values, one per row.
    ///
    /// # Errors
    /// [`ContactError::ForeignState`] when their number is not that of the rows.
    pub fn row_vector(&self, values: &[f64]) -> Result<RowVector, ContactError> {
        let (expected, found) = (self.row_count(), values.len());
        if expected != found {
            return Err(ContactError::ForeignState { what: "multipliers", expected, found });
        }
        Ok(RowVector::new(values.to_vec(), self.equality_count))
    }

    /// ν of the node of every packed contact row.
    pub fn contact_scales<'a>(&'a self, boundary: &'a ContactBoundary) -> impl Iterator<Item = f64> + 'a {
        let nodes = boundary.points.iter().zip(&self.normalisation);
        nodes.flat_map(|(point, &nu)| std::iter::repeat_n(nu, point.row_count()))
    }
}

/// Appends the rows of supports and gluing of one body; returns the number of gluing rows.
fn equality_rows(body: &BodyRows<'_>, rows: &mut Vec<Row>) -> usize {
    let mut gluing_count = 0;
    for node in lattice::points([0; 3], body.grid.nodes()) {
        let copies = body.copies(node);
        for (component, held) in body.scene.held(body.grid, node).into_iter().enumerate() {
            if held {
                rows.extend(copies.iter().map(|first| vec![(first + component, 1.0)]));
                continue;
            }
            for last in 1..copies.len() {
                let scale = 1.0 / ((last * (last + 1)) as f64).sqrt();
                let mut row: Row = copies[..last].iter().map(|first| (first + component, scale)).collect();
                row.push((copies[last] + component, -(last as f64) * scale));
                rows.push(row);
                gluing_count += 1;
            }
        }
    }
    gluing_count
}

/// Entries (torn dof, value) of one row.
type Row = Vec<(usize, f64)>;

/// The copies of one body in a contact row.
struct ContactPart {
    sign: f64,
    copies: Vec<usize>,
    compliance: f64,
}

/// The bodies whose dof `component` is free at a contact node.
fn contact_parts(scene: &Scene, bodies: &[BodyRows<'_>], [i, j]: [usize; 2], component: usize) -> Vec<ContactPart> {
    let mut parts = Vec::with_capacity(2);
    for (index, body) in bodies.iter().enumerate() {
        let (layer, sign) = if index == 0 { (scene.mesh[2], 1.0) } else { (0, -1.0) };
        let position = [i, j, layer];
        if !body.scene.held(body.grid, position)[component] {
            let copies = body.copies(position).into_iter().map(|first| first + component).collect();
            parts.push(ContactPart { sign, copies, compliance: 1.0 / body.scene.material.young_modulus() });
        }
    }
    parts
}

/// A row of B and of B_D.
fn contact_row(parts: &[ContactPart], nu: f64) -> (Row, Row) {
    // Row entries s/(mν); weights ω s/(mν) with Σ ω/(mν²) = 1 and ω proportional to the body's compliance.
    let total: f64 = parts.iter().map(|part| part.compliance / (part.copies.len() as f64 * nu * nu)).sum();
    let (mut row, mut weights) = (Vec::new(), Vec::new());
    for part in parts {
        let entry = part.sign / (part.copies.len() as f64 * nu);
        for &dof in &part.copies {
            row.push((dof, entry));
            weights.push((dof, entry * part.compliance / total));
        }
    }
    (row, weights)
}
