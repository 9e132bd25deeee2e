//! Limits: quantities that a shape must keep on one side of a bound, or at it, beside the objective.

use crate::equilibrium::ContactProblem;
use crate::error::SceneError;
use nonsmooth::{ConstraintKind, Vector};

/// What a limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LimitedQuantity {
    /// The largest contact pressure, MPa.
    PeakPressure,
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// What it bounds.
    pub quantity: LimitedQuantity,
    /// The side.
    pub side: LimitSide,
    /// The bound, in the unit of the quantity.
    pub bound: f64,
}

/// Share of a bound by which a quantity that keeps it may be off. Steps along a curved constraint miss it by a little;
/// steps that do nothing but remove the rest would cost a state each.
const ALLOWANCE: f64 = 1e-8;

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
    pub fn name(self) -> &'static str {
        match self {
            Self::PeakPressure => "peak-pressure",
            Self::RelativeVolume => "relative-volume",
            Self::Volume => "volume",
        }
    }

    /// Its unit; empty for ratios.
    pub fn unit(self) -> &'static str {
        match self {
            Self::PeakPressure => "MPa",
            Self::RelativeVolume => "",
            Self::Volume => "mm^{3}",
        }
    }

    /// Whether the shape alone decides it, without the contact state.
    pub fn is_of_shape(self) -> bool {
        matches!(self, Self::RelativeVolume | Self::Volume)
    }
}

impl Limit {
    /// Limits in the order of the constraints of the optimizer: those of the contact state, then those of the shape.
    pub fn in_order(limits: &[Self]) -> Vec<Self> {
        let mut limits = limits.to_vec();
        limits.sort_by_key(|limit| limit.quantity.is_of_shape());
        limits
    }

    /// By how much a value is beyond the bound, in the unit of the quantity; 0 up to 1e-8 of the bound.
    pub fn excess(&self, value: f64) -> f64 {
        let excess = match self.side {
            LimitSide::AtMost => value - self.bound,
            LimitSide::AtLeast => self.bound - value,
            LimitSide::Equal => (value - self.bound).abs(),
        };
        if excess > ALLOWANCE * self.bound.abs() { excess } else { 0.0 }
    }

    /// What it asks of the optimizer.
    pub fn kind(&self) -> ConstraintKind {
        match (self.quantity, self.side) {
            (LimitedQuantity::PeakPressure, _) => ConstraintKind::Nonsmooth,
            (_, LimitSide::Equal) => ConstraintKind::SmoothEquality,
            (_, LimitSide::AtMost | LimitSide::AtLeast) => ConstraintKind::Smooth,
        }
    }

    /// The factor of the value in the constraint c = ±(value − bound).
    fn sign(&self) -> f64 {
        if self.side == LimitSide::AtLeast { -1.0 } else { 1.0 }
    }
}

/// The volume of the lower body as constraints of the optimizer.
#[derive(Debug, Clone)]
pub struct VolumeLimits {
    limits: Vec<Limit>,
    /// That of the scene at the start, mm³.
    start: f64,
}

impl VolumeLimits {
    /// Those among some limits that bound the volume.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless bounds are finite and > 0.
    pub fn new(limits: &[Limit], problem: &ContactProblem) -> Result<Self, SceneError> {
        let limits: Vec<Limit> = limits.iter().filter(|limit| limit.quantity.is_of_shape()).copied().collect();
        for limit in &limits {
            let valid = limit.bound > 0.0 && limit.bound.is_finite();
            SceneError::require(valid, "limit of the volume", limit.bound, "a finite number > 0")?;
        }
        Ok(Self { start: volume(problem, &problem.scene.shape.start()), limits })
    }

    /// The values of the limited quantities at some controls.
    pub fn values(&self, problem: &ContactProblem, controls: &Vector) -> Vec<f64> {
        let volume = if self.limits.is_empty() { 0.0 } else { volume(problem, controls.as_slice()) };
        self.limits.iter().map(|limit| volume / self.unit(limit)).collect()
    }

    /// Values and gradients of the constraints, one per limit; a value within 1e-8 of the bound counts as at it.
    pub fn constraints(&self, problem: &ContactProblem, controls: &Vector) -> Vec<(f64, Vector)> {
        if self.limits.is_empty() {
            return vec![];
        }
        let positions = problem.map.positions(controls.as_slice());
        let slope = problem.bodies[0].mesh.volume_derivative(&positions);
        let slope = Vector::from_vec(problem.map.pull_back(&slope));
        let pairs = self.limits.iter().zip(self.values(problem, controls));
        let constraint = |(limit, value): (&Limit, f64)| {
            let beyond = limit.sign() * (value - limit.bound);
            let kept = beyond.abs() <= ALLOWANCE * limit.bound;
            (if kept { 0.0 } else { beyond }, &slope * (limit.sign() / self.unit(limit)))
        };
        pairs.map(constraint).collect()
    }

    fn unit(&self, limit: &Limit) -> f64 {
        if limit.quantity == LimitedQuantity::RelativeVolume { self.start } else { 1.0 }
    }
}

fn volume(problem: &ContactProblem, controls: &[f64]) -> f64 {
    problem.bodies[0].mesh.volume(&problem.map.positions(controls))
}
