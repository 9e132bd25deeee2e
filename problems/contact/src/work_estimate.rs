//! Floating-point operations of the contact solvers, estimated from sizes alone: what decides between them.
//!
//! ```text
//! piece of n dofs of a box:   values v ≈ 268 000·(n/1536)^1.48,   2 v²/n operations, 4 v per solve
//! whole body:                 v ≈ φ k^−0.48·268 000·(n/1536)^1.48,  2.8 v²/n operations,  18 m² t² more for m contact rows
//! dense matrix of n rows:     ⅔ n³ operations per factor, 8/3 n³ for two inverses
//! ```
//! k: cubes side by side that the body is as large and as thick as; t: nodes along their edges; φ = 0.65 for bricks,
//! 1.25 for tetrahedra of second order. The laws were measured from 7³ to 10³ nodes, and on parts of 20 000 to 200 000
//! displacements. The decision must not depend on time or load, so that a run can be repeated.

use crate::body::elasticity::Material;
use crate::body::mesh::CellKind;
use crate::equilibrium::{ContactProblem, Work};
use crate::scene::{BodySize, Geometry, Scene, SceneSize};
use crate::solvers::SolverKind;

/// Products with F after which total FETI gives up where bodies are too large to be condensed. The Newton steps of
/// direct condensation may cost as many operations.
pub(crate) const MAX_PRODUCTS: usize = 20_000;
/// Values of the factor of a whole body over the law of pieces, of bricks and of tetrahedra of second order.
const FILL: [f64; 2] = [0.65, 1.25];
/// Operations of the factor of a whole body, over v²/n.
const WHOLE: f64 = 2.8;
/// Operations of m contact rows as its border, over m² times the 3 t² rows of a separator.
const BORDER: f64 = 6.0;
/// Operations of total FETI over those of direct condensation up to which it may go on: what it finds has residuals
/// that know of all rounding.
const PATIENCE: f64 = 1.6;
/// Newton steps on condensed bodies with all nodes closed that a state is expected to cost: few nodes are, and of the
/// rows of those that slide two thirds are factored.
const EXPECTED_STEPS: f64 = 1.5;
/// Newton steps on condensed bodies that are always allowed: nine tenths of the states need fewer.
const MIN_STEPS: usize = 60;
/// Operations per second on two cores: of large dense blocks, of the factors of pieces, of solves, which wait for
/// memory, and of solves for many right sides at once.
const FACTORING: f64 = 3.0e10;
const TORN_FACTORING: f64 = 1.5e10;
const SOLVING: f64 = 2.0e9;
const SOLVING_COLUMNS: f64 = 7.0e9;
/// Products with F of a state with its adjoint, for cubes of bricks in one body.
const EXPECTED_PRODUCTS: f64 = 60.0;
/// Its factors for pieces of meshes, whose boundaries are rough, for tetrahedra, whose products take longer as well,
/// for pairs of bodies, and for nearly incompressible material.
const ROUGH: f64 = 1.7;
const TETRAHEDRA: f64 = 1.6;
const PAIRS: f64 = 1.5;
const INCOMPRESSIBLE: f64 = 4.0;
/// Share of the products of a state that a column of a Jacobian takes.
const COLUMN_SHARE: f64 = 0.45;

/// Values of the Cholesky factor of a box with `dofs` dofs.
pub(crate) fn factor_values(dofs: f64) -> f64 {
    268_000.0 * (dofs / 1536.0).powf(1.48)
}

/// Values of the Cholesky factor of a whole body.
pub(crate) fn body_factor_values(body: &BodySize) -> f64 {
    FILL[usize::from(body.is_second_order)] * body.cubes.powf(-0.48) * factor_values(3.0 * body.nodes)
}

/// Estimated operations of the parts of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorkEstimate {
    /// Factorisation of all subdomains.
    pub torn_factorization: f64,
    /// One product with the dual operator F.
    pub product: f64,
    /// Condensation of all bodies and their compliances.
    pub condensation: f64,
    /// One Newton step on condensed bodies with all nodes closed.
    pub condensed_step: f64,
    /// One solution with the factors of all bodies.
    pub solution: f64,
}

impl WorkEstimate {
    /// The estimate for a scene.
    pub fn of(scene: &Scene) -> Self {
        let size = SceneSize::of(scene);
        let factorization = |values: f64, dofs: f64| 2.0 * values * values / dofs;
        let rows = size.contact_nodes * if scene.has_friction() { 3.0 } else { 1.0 };
        // Bricks stand on a foundation, which two dense inverses take off again.
        let inverses = |body: &BodySize| {
            if body.is_second_order { 0.0 } else { 8.0 / 3.0 * (3.0 * body.contact_nodes).powi(3) }
        };
        let border = |body: &BodySize| {
            let (rows, thickness) = (3.0 * body.contact_nodes, (body.nodes / body.cubes).cbrt());
            BORDER * rows.powi(2) * 3.0 * thickness.powi(2)
        };
        let factor = |body: &BodySize| WHOLE * body_factor_values(body).powi(2) / (3.0 * body.nodes);
        let whole = |body: &BodySize| factor(body) + border(body) + inverses(body);
        let piece = |body: &BodySize| 3.0 * body.piece_nodes;
        Self {
            torn_factorization: size.sum(|body| body.pieces * factorization(factor_values(piece(body)), piece(body))),
            product: size.sum(|body| body.pieces * 4.0 * factor_values(piece(body))),
            condensation: size.sum(whole),
            condensed_step: 2.0 / 3.0 * rows.powi(3),
            solution: size.sum(|body| 4.0 * body_factor_values(body)),
        }
    }

    /// Products with F that total FETI may take before direct condensation takes its place.
    pub(crate) fn most_products(&self) -> usize {
        (PATIENCE * (self.condensation + EXPECTED_STEPS * self.condensed_step) / self.product) as usize
    }

    /// Seconds of a state with its adjoint and so many columns of a Jacobian by direct condensation and by total FETI,
    /// on two cores of 2025, roughly.
    pub(crate) fn seconds(&self, problem: &ContactProblem, columns: usize) -> [f64; 2] {
        let (products, columns) = (expected_products(problem), columns as f64);
        let direct = (self.condensation + EXPECTED_STEPS * self.condensed_step) / FACTORING;
        let torn = self.torn_factorization / TORN_FACTORING + products * self.product / SOLVING;
        // By direct condensation, a column takes a solution for the contact nodes and another one for all nodes.
        let of_columns = [2.0 * self.solution, COLUMN_SHARE * products * self.product];
        [direct + columns * of_columns[0] / SOLVING_COLUMNS, torn + columns * of_columns[1] / SOLVING_COLUMNS]
    }

    /// Newton steps on condensed bodies that cost as much as so many products with F; at least those of a usual state.
    pub(crate) fn condensed_steps_per_products(&self, products: usize) -> usize {
        ((products as f64 * self.product / self.condensed_step) as usize).max(MIN_STEPS)
    }

    /// Operations of the work behind a state that a solver found, attempts of total FETI before it included.
    pub fn operations(&self, solver: SolverKind, work: &Work) -> f64 {
        let torn = if work.dual_operator_applications > 0 { self.torn_factorization } else { 0.0 };
        let condensation = if solver == SolverKind::Direct { self.condensation } else { 0.0 };
        let condensed = condensation + work.dense_factorizations as f64 * self.condensed_step;
        torn + work.dual_operator_applications as f64 * self.product + condensed
    }
}

/// Products with F that total FETI is expected to take for a state with its adjoint. They grow with the condition of
/// the subdomains: with the proportions of the cells, and with the root of the root of the contrast of the materials.
fn expected_products(problem: &ContactProblem) -> f64 {
    let scene = &problem.scene;
    let is_mesh = scene.bodies.iter().any(|body| matches!(body.geometry, Geometry::Mesh(_)));
    let has_tetrahedra = problem.bodies.iter().any(|body| body.mesh.cells().any(|cell| cell.kind == CellKind::Tet10));
    let has_pairs = scene.contacts.iter().any(|contact| contact.master_face().is_some());
    let is_incompressible = problem.materials().any(|material| material.compressible_neighbour().is_some());
    let factors =
        [(is_mesh, ROUGH), (has_tetrahedra, TETRAHEDRA), (has_pairs, PAIRS), (is_incompressible, INCOMPRESSIBLE)];
    let moduli = || problem.materials().map(Material::young_modulus);
    let contrast = moduli().fold(0.0, f64::max) / moduli().fold(f64::INFINITY, f64::min);
    let factor: f64 = factors.iter().filter(|(applies, _)| *applies).map(|(_, factor)| factor).product();
    EXPECTED_PRODUCTS * factor * (0.5 * problem.aspect()).max(1.0) * contrast.sqrt().sqrt()
}
