//! What a shape is rated by: [`Quantity`] names it, and it is computed on the mesh of a problem.
//!
//! ```text
//! pressures:   h(σ) with a convex h, an outer function of the composite model                  method.md (3.4), (3.5), (3.6)
//! states:      J(x, λ, u), whose derivatives by λ and u are the dual of the adjoint problem    method.md (3.7), (3.8), (5.5)
//! shapes:      V(x) and the mass
//! ```

mod contact_work;
mod extreme;
mod limit;
mod outputs;
mod piece;
mod pressure;
mod pressure_measure;
mod quantity;
mod reaction;
mod region;
mod row_terms;
mod shape_function;
mod state_cost;
mod state_view;
mod stress_norm;
mod wanted_pressure;

pub use limit::{Limit, LimitSide, Reported};
pub use outputs::PressureOutputs;
pub use piece::{StateGradient, StatePiece};
pub use pressure::PressureCost;
pub use pressure_measure::{NodeWeight, PressureMeasure, PressureRoot};
pub use quantity::Quantity;
pub use region::{Region, RegionCells};
pub use shape_function::ShapeFunction;
pub use state_cost::StateCost;
pub use state_view::StateView;
pub use wanted_pressure::WantedPressure;
