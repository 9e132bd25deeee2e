//! What a shape is rated by: functions of the contact pressures, and functions of the displacements.
//!
//! ```text
//! pressures:      h(σ) with a convex h, an outer function of the composite model               method.md (3.4), (3.5), (3.6)
//! displacements:  J(α, u), whose gradient ∂J/∂u is a load in the adjoint problem               method.md (3.7), (3.8), (5.5)
//! ```

mod extreme;
mod field;
mod field_measure;
mod field_piece;
mod limit;
mod outputs;
mod pressure;
mod pressure_measure;
mod region;
mod volume;

pub use field::FieldCost;
pub use field_measure::FieldMeasure;
pub use field_piece::{FieldGradient, FieldPiece};
pub use limit::{Limit, LimitSide, LimitedQuantity};
pub use outputs::PressureOutputs;
pub use pressure::PressureCost;
pub use pressure_measure::{ContactAreas, NodeWeight, PressureMeasure, PressureRoot};
pub use region::{Region, RegionCells};
pub(crate) use volume::{volume, volume_gradient, volume_slope};

/// The function of a contact state that is minimised.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// A function of the contact pressures.
    Pressure(PressureMeasure),
    /// A function of the displacements.
    Field(FieldMeasure),
    /// The volume of the bodies that controls shape, mm³.
    Volume,
}
