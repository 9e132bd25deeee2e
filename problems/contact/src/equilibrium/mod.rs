//! Unilateral contact with Coulomb friction: boundary, rows of a shape, law, rigid motions, certificates, problem and
//! state.

mod boundary;
mod cell_shapes;
pub(crate) mod certificate;
mod configuration;
mod contact_geometry;
mod contact_moduli;
pub(crate) mod contact_part;
mod contact_solver;
pub(crate) mod diagnosis;
mod facet_noise;
mod facets;
pub(crate) mod law;
pub(crate) mod modes;
pub(crate) mod node_rows;
mod pair_rows;
mod pair_sides;
mod preview;
pub(crate) mod problem;
pub(crate) mod row_work;
mod rows;
mod solved_body;
mod stage;
mod state;
mod status;
mod value_error;

pub use crate::shape::Positions;
pub use boundary::{ContactBoundary, ContactPoint, Side};
pub use certificate::{Kink, MAX_RESIDUAL, Residuals, WEAKLY_ACTIVE};
pub use configuration::Configuration;
pub(crate) use configuration::ForceUnit;
pub use contact_geometry::ContactGeometry;
pub use contact_solver::{ContactSolver, Sensitivities, Tangents, TangentsOf};
pub use diagnosis::Diagnosis;
pub use facet_noise::{FacetPressure, facet_pressures};
pub use facets::ContactFacets;
pub use node_rows::{NodeRows, RowChange, RowSensitivities};
pub use preview::{BodyPreview, Preview};
pub use problem::ContactProblem;
pub use rows::ContactRows;
pub use solved_body::SolvedBody;
pub use stage::{Stage, TARGET as STAGE_TARGET};
pub(crate) use state::Failed;
pub use state::{ContactForces, ContactState, ContactWarmStart, SolverState, StageSeconds, Work};
pub use status::{ContactStatus, StatusCounts};
pub use value_error::ValueError;
