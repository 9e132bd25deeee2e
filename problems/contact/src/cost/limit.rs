//! Limits: quantities that a shape must keep on one side of a bound, or at it, beside the objective. Reports:
//! quantities that are told.

use crate::cost::Quantity;
use crate::error::SceneError;
use crate::names::find;
use nonsmooth::ConstraintKind;

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
    pub quantity: Quantity,
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

/// A quantity that is told beside objective and limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Reported {
    /// The quantity.
    pub quantity: Quantity,
    /// What it is called; none for the name of the quantity.
    pub label: Option<String>,
    /// The load case in which it is told; none: in all.
    pub case: Option<String>,
}

impl Reported {
    /// What it is called, with its case.
    pub fn title(&self) -> String {
        let case = self.case.as_ref().map_or_else(String::new, |case| format!(" in case \"{case}\""));
        format!("{}{case}", self.label.as_deref().unwrap_or(self.quantity.name()))
    }

    /// The report in all its cases, with their numbers: one per case without a case of its own, but one of the shape
    /// stays one. `place`: what messages call it.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for an unknown case.
    pub(crate) fn in_cases(&self, place: &str, names: &[&str]) -> Result<Vec<(Self, usize)>, SceneError> {
        let find = |case| find(&format!("{place}.case"), case, names.iter().copied());
        let case = self.case.as_deref().map(find).transpose()?;
        let own = cases_of(&self.quantity, case, names).into_iter();
        Ok(own.map(|(case, name)| (Self { case: name, ..self.clone() }, case)).collect())
    }
}

/// The cases in which a quantity is measured, with their names where there are several.
fn cases_of(quantity: &Quantity, case: Option<usize>, names: &[&str]) -> Vec<(usize, Option<String>)> {
    let several = names.len() > 1 && !quantity.is_of_shape();
    let cases = match case {
        Some(case) => case..case + 1,
        None if several => 0..names.len(),
        None => 0..1,
    };
    cases.map(|case| (case, several.then(|| names[case].to_owned()))).collect()
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

impl Limit {
    /// A limit in all load cases.
    pub fn new(quantity: Quantity, side: LimitSide, bound: f64) -> Self {
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
            let own = cases_of(&limit.quantity, case, names).into_iter();
            found.extend(own.map(|(case, name)| (Self { case: name, ..limit.clone() }, case)));
        }
        let is_peak = |limit: &Self| limit.quantity.is_peak();
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
    /// finite; those of volumes, masses and peak pressures must be > 0.
    pub(crate) fn kind(&self) -> Result<ConstraintKind, SceneError> {
        let field = || format!("limit of {}", self.quantity.name());
        self.quantity.check_differentiable("limit.quantity")?;
        let positive = self.quantity.is_of_shape() || self.quantity.is_peak();
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
            let limit = Limit::new(Quantity::LoadedArea { pressure: 1.0 }, side, 0.0);
            let beyond = |value: f64| limit.excess(limit.sign() * value) / limit.scale();
            assert_eq!([beyond(-1.0), beyond(0.0), beyond(0.5 * ALLOWANCE), beyond(0.25)], [0.0, 0.0, 0.0, 0.25]);
            let typical = Limit { typical: 1e-3, ..limit };
            assert!(typical.scale() == 1e-3 && typical.excess(typical.sign() * 0.5 * ALLOWANCE) > 0.0);
        }
    }
}
