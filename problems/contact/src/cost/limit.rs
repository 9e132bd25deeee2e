//! Limits: quantities that a shape must keep on one side of a bound, or at it, beside the objective.

use crate::cost::FieldMeasure;
use crate::error::SceneError;
use crate::names::find;
use nonsmooth::ConstraintKind;

/// What a limit bounds.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LimitedQuantity {
    /// The largest contact pressure, MPa.
    PeakPressure,
    /// Σ A min(σ/σ₀, 1), mm²: the loaded area.
    LoadedArea {
        /// The pressure σ₀ > 0 from which a node counts with its whole area, MPa.
        pressure: f64,
    },
    /// A function of the displacements, in its unit.
    Field(FieldMeasure),
    /// The volume of the lower body over that of the scene at the start.
    RelativeVolume,
    /// The volume of the lower body, mm³.
    Volume,
}

/// The side of its bound on which a quantity must stay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitSide {
    /// At most the bound.
    AtMost,
    /// At least the bound.
    AtLeast,
    /// At the bound.
    Equal,
}

/// A limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// What it bounds.
    pub quantity: LimitedQuantity,
    /// The load case in which it holds; none: in all.
    pub case: Option<String>,
    /// The side.
    pub side: LimitSide,
    /// The bound, in the unit of the quantity.
    pub bound: f64,
    /// What counts as a typical value of a quantity that may be zero, in its unit: a bound may be zero as well. 0 where
    /// no bound is.
    pub typical: f64,
}

/// Share of its scale by which a quantity that keeps its bound may be off. Steps along a curved constraint miss it by a
/// little; steps that do nothing but remove the rest would cost a state each.
const ALLOWANCE: f64 = 1e-6;

impl LimitSide {
    /// Its name in JSON, and in words with spaces.
    pub fn name(self) -> &'static str {
        match self {
            Self::AtMost => "at_most",
            Self::AtLeast => "at_least",
            Self::Equal => "equal_to",
        }
    }
}

impl LimitedQuantity {
    /// Its name in scene files and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::PeakPressure => "peak-pressure",
            Self::LoadedArea { .. } => "loaded-area",
            Self::Field(measure) => measure.name(),
            Self::RelativeVolume => "relative-volume",
            Self::Volume => "volume",
        }
    }

    /// Its unit; empty for ratios.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::PeakPressure => "MPa",
            Self::LoadedArea { .. } => "mm^{2}",
            Self::Field(measure) => measure.unit(),
            Self::RelativeVolume => "",
            Self::Volume => "mm^{3}",
        }
    }

    /// Whether the shape alone decides it, without a contact state.
    pub fn is_of_shape(&self) -> bool {
        matches!(self, Self::RelativeVolume | Self::Volume)
    }

    /// Whether it is continuously differentiable where no contact node changes its status.
    pub fn is_smooth(&self) -> bool {
        match self {
            Self::PeakPressure | Self::LoadedArea { .. } => false,
            Self::Field(measure) => measure.is_smooth(),
            Self::RelativeVolume | Self::Volume => true,
        }
    }
}

impl Limit {
    /// A limit in all load cases.
    pub fn new(quantity: LimitedQuantity, side: LimitSide, bound: f64) -> Self {
        Self { quantity, case: None, side, bound, typical: 0.0 }
    }

    /// What an excess is compared with: the bound, or a typical value where that is larger; one unit of the quantity
    /// for a bound of 0 without a typical value.
    pub fn scale(&self) -> f64 {
        let scale = self.bound.abs().max(self.typical);
        if scale > 0.0 { scale } else { 1.0 }
    }

    /// Limits with the numbers of their cases in the order of the constraints of the optimizer: peak pressures by case,
    /// then the others. A limit of no case becomes one per case; a limit of the shape stays one.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a limit of an unknown case.
    pub(crate) fn of_cases(limits: &[Self], names: &[&str]) -> Result<Vec<(Self, usize)>, SceneError> {
        let mut found = Vec::new();
        for limit in limits {
            let case = limit.case.as_ref().map(|case| find("limit.case", case, names.iter().copied())).transpose()?;
            let several = names.len() > 1 && !limit.quantity.is_of_shape();
            let cases = match case {
                Some(case) => case..case + 1,
                None if several => 0..names.len(),
                None => 0..1,
            };
            let of = |case: usize| several.then(|| names[case].to_owned());
            found.extend(cases.map(|case| (Self { case: of(case), ..limit.clone() }, case)));
        }
        let is_peak = |limit: &Self| limit.quantity == LimitedQuantity::PeakPressure;
        found.sort_by_key(|(limit, case)| if is_peak(limit) { (0, *case) } else { (1, 0) });
        Ok(found)
    }

    /// By how much a value is beyond the bound, in the unit of the quantity; 0 up to 1e-6 of the scale.
    pub fn excess(&self, value: f64) -> f64 {
        let beyond = self.constraint(value);
        if self.side == LimitSide::Equal { beyond.abs() } else { beyond.max(0.0) }
    }

    /// The constraint c = ±(value − bound) of the optimizer; 0 within 1e-6 of the scale: such a value counts as at the
    /// bound.
    pub(crate) fn constraint(&self, value: f64) -> f64 {
        let beyond = sign(self.side) * (value - self.bound);
        if beyond.abs() <= ALLOWANCE * self.scale() { 0.0 } else { beyond }
    }

    /// What it asks of the optimizer. Smooth functions of the contact state have kinks where the state has them, which
    /// points on the way rarely meet: their curvature between kinks is worth more.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a quantity with kinks that must be at its bound, and for bounds that are not
    /// finite; those of volumes and peak pressures must be > 0.
    pub(crate) fn kind(&self) -> Result<ConstraintKind, SceneError> {
        let field = || format!("limit of {}", self.quantity.name());
        let positive = self.quantity.is_of_shape() || self.quantity == LimitedQuantity::PeakPressure;
        let allowed = if positive { "a finite number > 0" } else { "a finite number" };
        SceneError::require(self.bound.is_finite() && (self.bound > 0.0 || !positive), field(), self.bound, allowed)?;
        match (self.quantity.is_of_shape(), self.side) {
            (true, LimitSide::Equal) => Ok(ConstraintKind::SmoothEquality),
            (true, _) => Ok(ConstraintKind::Smooth),
            (false, LimitSide::Equal) => {
                let allowed = "at_most or at_least alone: a function of the contact state has kinks";
                Err(SceneError::out_of_range(field(), self.bound, allowed))
            }
            (false, _) if self.quantity.is_smooth() => Ok(ConstraintKind::Smooth),
            (false, _) => Ok(ConstraintKind::Nonsmooth),
        }
    }

    /// The factor of the value in the constraint c = ±(value − bound).
    pub(crate) fn sign(&self) -> f64 {
        sign(self.side)
    }
}

fn sign(side: LimitSide) -> f64 {
    if side == LimitSide::AtLeast { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scale of 0 would leave no allowance for rounding, and 0/0 as the relative excess of a limit that is kept.
    #[test]
    fn a_bound_of_zero_has_a_scale() {
        for side in [LimitSide::AtMost, LimitSide::AtLeast] {
            let limit = Limit::new(LimitedQuantity::LoadedArea { pressure: 1.0 }, side, 0.0);
            let beyond = |value: f64| limit.excess(limit.sign() * value) / limit.scale();
            assert_eq!([beyond(-1.0), beyond(0.0), beyond(0.5 * ALLOWANCE), beyond(0.25)], [0.0, 0.0, 0.0, 0.25]);
            let typical = Limit { typical: 1e-3, ..limit };
            assert!(typical.scale() == 1e-3 && typical.excess(typical.sign() * 0.5 * ALLOWANCE) > 0.0);
        }
    }
}
