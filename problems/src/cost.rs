//! Costs of the contact pressure σ_i = λ_N,i / A_i; method.md (3.4).

use crate::contact::ContactBoundary;
use crate::contact_shape::ContactState;
use crate::error::SceneError;
use nonsmooth::{Cost, CostGradient, Vector};

/// A function of the contact pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum PressureMeasure {
    /// Σσ^p, MPa^p.
    Norm {
        /// The exponent p > 1.
        exponent: f64,
    },
    /// max σ, MPa; nonsmooth on its own, with one subgradient at the first node of largest pressure.
    Peak,
}

/// J(α, y) as a measure of the contact pressure.
#[derive(Debug, Clone)]
pub struct PressureCost {
    measure: PressureMeasure,
    areas: Vec<f64>,
    dual_dimension: usize,
}

impl PressureCost {
    /// The cost on a contact boundary.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless the exponent is finite and > 1.
    pub fn new(measure: PressureMeasure, boundary: &ContactBoundary) -> Result<Self, SceneError> {
        if let PressureMeasure::Norm { exponent } = measure
            && !(exponent > 1.0 && exponent.is_finite())
        {
            return Err(SceneError::out_of_range("exponent of the pressure norm", exponent, "a finite number > 1"));
        }
        let areas = boundary.points.iter().map(|point| point.area).collect();
        Ok(Self { measure, areas, dual_dimension: boundary.dual_dimension() })
    }

    /// σ per contact node, MPa.
    pub fn pressures(&self, state: &ContactState) -> Vec<f64> {
        state.forces.normal.iter().zip(&self.areas).map(|(force, area)| force / area).collect()
    }
}

impl Cost<ContactState> for PressureCost {
    fn value(&self, _control: &Vector, state: &ContactState) -> f64 {
        let pressures = self.pressures(state);
        match self.measure {
            PressureMeasure::Norm { exponent } => pressures.iter().map(|p| p.max(0.0).powf(exponent)).sum(),
            PressureMeasure::Peak => pressures.into_iter().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    fn gradient(&self, control: &Vector, state: &ContactState) -> CostGradient {
        let pressures = self.pressures(state);
        let mut dual = Vector::zeros(self.dual_dimension);
        match self.measure {
            PressureMeasure::Norm { exponent } => {
                for (index, (pressure, area)) in pressures.iter().zip(&self.areas).enumerate() {
                    dual[index] = exponent * pressure.max(0.0).powf(exponent - 1.0) / area;
                }
            }
            PressureMeasure::Peak => {
                let mut peak = 0;
                for (index, pressure) in pressures.iter().enumerate() {
                    if *pressure > pressures[peak] {
                        peak = index;
                    }
                }
                dual[peak] = 1.0 / self.areas[peak];
            }
        }
        CostGradient { control: Vector::zeros(control.len()), state: dual }
    }
}
