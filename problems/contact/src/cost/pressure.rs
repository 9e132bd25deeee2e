//! Costs of the contact pressure σ_i = λ_N,i / A_i; method.md (3.4) to (3.6).
//!
//! ```text
//! ∫σ^p dA = Σ A_i σ_i^p  or  Σσ^p,    max σ,    Σ A_i (σ_i − w_i)² / Σ A_i,    Σ A_i max(1 − σ_i/σ₀, 0)
//! ```

use crate::cost::outputs::{PressureOutputs, Scaling};
use crate::cost::pressure_measure::{NodeWeight, PressureMeasure, PressureRoot};
use crate::cost::state_view::StateView;
use crate::equilibrium::{ContactProblem, ContactState};
use crate::error::SceneError;
use nonsmooth::composite::{Maximum, OuterFunction, weighted_gram};
use nonsmooth::{Matrix, Vector};

/// A measure of the contact pressures σ, a function of these outputs of
/// [`ContactShape`](crate::contact_shape::ContactShape).
#[derive(Debug, Clone)]
pub struct PressureCost {
    measure: PressureMeasure,
    /// The wanted pressure per contact node, MPa, of a deviation.
    wanted: Vec<f64>,
    /// Whether the value of a norm is its root in MPa.
    is_root: bool,
    /// What the nodes count in a norm; empty for the other measures.
    weights: Vec<f64>,
    /// Areas of the contact nodes at the start, mm².
    areas: Vec<f64>,
    /// Whether areas change with the shape.
    areas_change: bool,
}

/// Decades of a pressure norm at the typical pressure of a scene beyond which its root is taken. Squares of
/// subgradients at pressures far above that must still be doubles, which end at 308 decades.
const MAX_DECADES: f64 = 100.0;
/// Largest pressure over the mean pressure, roughly: those of the paper's scenes are at 4 to 10.
const TYPICAL_PEAK: f64 = 10.0;

impl PressureCost {
    /// The cost on the contact boundary of a problem.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless the exponent is finite and > 1 and σ₀ is finite and > 0; as
    /// [`WantedPressure::at`](crate::cost::WantedPressure::at).
    pub fn new(measure: PressureMeasure, problem: &ContactProblem) -> Result<Self, SceneError> {
        Self::named("objective", measure, problem)
    }

    /// The cost on the contact boundary of a problem; `place`: what messages call the table that has the measure.
    ///
    /// # Errors
    /// As [`PressureCost::new`].
    pub(crate) fn named(place: &str, measure: PressureMeasure, problem: &ContactProblem) -> Result<Self, SceneError> {
        let wanted = match &measure {
            PressureMeasure::Deviation { wanted } => wanted.at_nodes(place, problem)?,
            _ => Vec::new(),
        };
        Self::over(place, measure, wanted, (problem.start_rows().areas(), problem.areas_change()))
    }

    /// The cost over contact nodes with these areas at the start, which may change with the shape.
    fn over(
        place: &str,
        measure: PressureMeasure,
        wanted: Vec<f64>,
        (areas, areas_change): (Vec<f64>, bool),
    ) -> Result<Self, SceneError> {
        match &measure {
            PressureMeasure::Peak => {}
            PressureMeasure::Norm { exponent, .. } => {
                let valid = *exponent > 1.0 && exponent.is_finite();
                SceneError::require(valid, format!("{place}.exponent"), exponent, "a finite number > 1")?;
            }
            PressureMeasure::Deviation { .. } => {}
            PressureMeasure::OpenArea { pressure } => {
                let valid = *pressure > 0.0 && pressure.is_finite();
                SceneError::require(valid, format!("{place}.pressure"), pressure, "a finite number > 0 (MPa)")?;
            }
        }
        let weights = match &measure {
            PressureMeasure::Norm { weight: NodeWeight::Area, .. } => areas.clone(),
            PressureMeasure::Norm { weight: NodeWeight::Nodes, .. } => vec![1.0; areas.len()],
            _ => vec![],
        };
        Ok(Self { measure, wanted, is_root: false, weights, areas, areas_change })
    }

    /// Whether a norm may leave the range of doubles for the pressures of a problem. Its [root](Self::rooted) in MPa
    /// has the same minimisers. The answer depends on neither mesh nor shape.
    pub(crate) fn may_leave_doubles(&self, problem: &ContactProblem) -> bool {
        let PressureMeasure::Norm { exponent, .. } = self.measure else { return false };
        let typical = TYPICAL_PEAK * problem.load() / problem.contact_area();
        typical > 0.0 && exponent * typical.log10().abs() > MAX_DECADES
    }

    /// A norm as its root: (Σσ^p)^{1/p}, or (∫σ^p dA / ΣA)^{1/p}; other measures as they are.
    #[must_use]
    pub(crate) fn rooted(self) -> Self {
        let PressureMeasure::Norm { .. } = self.measure else { return self };
        let size = self.root_size();
        Self { is_root: true, weights: self.weights.iter().map(|weight| weight / size).collect(), ..self }
    }

    /// What a norm is divided by before its root is taken: ΣA, so that the root is a mean, or 1 for a sum over nodes.
    fn root_size(&self) -> f64 {
        match self.measure {
            PressureMeasure::Norm { weight: NodeWeight::Area, .. } => self.areas.iter().sum(),
            _ => 1.0,
        }
    }

    /// The root of a norm in MPa from a value of this cost: (Σσ^p)^{1/p}, or (∫σ^p dA / ΣA)^{1/p}, the power mean of
    /// the pressures. None for the other measures.
    pub fn norm_in_mpa(&self, value: f64) -> Option<f64> {
        let PressureMeasure::Norm { exponent, .. } = self.measure else { return None };
        Some(if self.is_root { value } else { (value / self.root_size()).powf(1.0 / exponent) })
    }

    /// The wanted pressure per contact node, MPa, of a deviation; none for the other measures.
    pub fn wanted(&self) -> Option<&[f64]> {
        matches!(self.measure, PressureMeasure::Deviation { .. }).then_some(self.wanted.as_slice())
    }

    /// p where the value is the root of a norm, (Σσ^p)^{1/p} or (∫σ^p dA / ΣA)^{1/p}, else 1.
    pub fn root(&self) -> f64 {
        match self.measure {
            PressureMeasure::Norm { exponent, .. } if self.is_root => exponent,
            _ => 1.0,
        }
    }

    /// A value as a pressure with its name, where it is a norm; see [`norm_in_mpa`](Self::norm_in_mpa).
    pub fn pressure_root(&self, value: f64) -> Option<PressureRoot> {
        let PressureMeasure::Norm { exponent, weight } = self.measure else { return None };
        let name = match weight {
            NodeWeight::Nodes => format!("(Σσ^{exponent})^(1/{exponent})"),
            NodeWeight::Area => format!("(∫σ^{exponent} dA / ∫dA)^(1/{exponent})"),
        };
        Some(PressureRoot { name, value: self.norm_in_mpa(value)? })
    }

    /// Where the value is the root of a norm, the factor and the unit of the norm: factor times value to the power p.
    pub fn norm_of_root(&self) -> Option<(f64, String)> {
        match self.measure {
            PressureMeasure::Norm { .. } if self.is_root => Some((self.root_size(), self.measure.unit())),
            _ => None,
        }
    }

    /// The unit of the value, such as `MPa^{4}·mm^{2}`.
    pub fn unit(&self) -> String {
        match &self.measure {
            PressureMeasure::Norm { .. } if self.is_root => "MPa".into(),
            measure => measure.unit(),
        }
    }

    /// Why the value does not change with the pressures near those of a state, in words with a remedy: where σ₀ of the
    /// open area lies above all pressures, or below those of all closed nodes. None otherwise.
    pub fn why_flat<S>(&self, state: &ContactState<S>) -> Option<String> {
        let PressureMeasure::OpenArea { pressure: bound } = self.measure else { return None };
        let pressures = state.rows.pressures(&state.forces.normal);
        let largest = pressures.iter().copied().fold(0.0, f64::max);
        let least = pressures.iter().copied().filter(|pressure| *pressure > 0.0).fold(f64::INFINITY, f64::min);
        if largest < bound {
            let reason = "every contact pressure is below objective.pressure, so that the value depends on the total force alone";
            return Some(format!("{reason}: choose less than the largest pressure, {largest:.4e} MPa"));
        }
        let reason = "every closed contact node is above objective.pressure and gains nothing";
        (least >= bound)
            .then(|| format!("{reason}: choose more than the least pressure of a closed node, {least:.4e} MPa"))
    }

    /// The least value that any distribution of a total normal force over the contact nodes can have: no shape that
    /// carries this force is below it. None where areas change with the shape.
    ///
    /// Σσ^p ≥ Λ^p / (ΣA^{p/(p−1)})^{p−1}, ΣAσ^p ≥ Λ^p / (ΣA)^{p−1}, max σ ≥ Λ/ΣA, Σ A max(1 − σ/σ₀, 0) ≥ max(ΣA − Λ/σ₀,
    /// 0), with Λ = Σλ_N ≥ 0 in N; method.md (9.1) to (9.5).
    pub fn lower_bound(&self, total_force: f64) -> Option<f64> {
        (!self.areas_change).then(|| self.least_value(total_force))
    }

    fn least_value(&self, total_force: f64) -> f64 {
        let whole = || self.areas.iter().sum::<f64>();
        match &self.measure {
            PressureMeasure::Norm { weight: NodeWeight::Area, .. } if self.is_root => total_force / whole(),
            &PressureMeasure::Norm { exponent, weight: NodeWeight::Area } => {
                whole() * (total_force / whole()).powf(exponent)
            }
            &PressureMeasure::Norm { exponent: p, weight: NodeWeight::Nodes } => {
                // Relative to the largest area, so that the sum is at least 1 for every p.
                let largest = self.areas.iter().copied().fold(0.0, f64::max);
                let weights: f64 = self.areas.iter().map(|area| (area / largest).powf(p / (p - 1.0))).sum();
                match self.is_root {
                    false => (total_force / largest).powf(p) / weights.powf(p - 1.0),
                    true => total_force / largest / weights.powf((p - 1.0) / p),
                }
            }
            PressureMeasure::Peak => total_force / whole(),
            PressureMeasure::Deviation { .. } => least_deviation(&self.areas, &self.wanted, total_force),
            PressureMeasure::OpenArea { pressure } => (whole() - total_force / pressure).max(0.0),
        }
    }
}

impl PressureCost {
    /// The value at a state.
    pub fn value_at(&self, at: StateView<'_>) -> f64 {
        self.value(&Vector::from_vec(self.outputs(false).values(&at.forces.normal, &at.rows.areas())))
    }

    /// The outputs of a state that this cost is a function of: the pressures where areas do not change. With
    /// `with_pressures`, the pressures follow where the outputs are others.
    pub fn outputs(&self, with_pressures: bool) -> PressureOutputs {
        if !self.areas_change {
            return PressureOutputs::default();
        }
        let scaling = match &self.measure {
            &PressureMeasure::Norm { exponent, weight: NodeWeight::Area } => {
                Scaling::Power { exponent, is_mean: self.is_root }
            }
            PressureMeasure::Norm { .. } | PressureMeasure::Peak => Scaling::Pressure,
            PressureMeasure::Deviation { .. } => Scaling::Deviation { wanted: self.wanted.clone() },
            PressureMeasure::OpenArea { pressure } => Scaling::OpenArea { pressure: *pressure },
        };
        let with_pressures = with_pressures && scaling != Scaling::Pressure;
        PressureOutputs { scaling, areas: self.areas.clone(), with_pressures }
    }

    /// A subgradient of the measure by its outputs.
    fn measure_subgradient(&self, pressures: &Vector) -> Vector {
        match &self.measure {
            &PressureMeasure::Norm { exponent, .. } => {
                let (largest, factor) = match self.is_root {
                    false => (1.0, exponent),
                    true => {
                        let (largest, sum) = self.relative_sum(pressures, exponent);
                        (largest, sum.powf(1.0 / exponent - 1.0))
                    }
                };
                let slope = |(pressure, weight): (&f64, &f64)| {
                    weight * (factor * (pressure.max(0.0) / largest).powf(exponent - 1.0))
                };
                Vector::from_iterator(pressures.len(), pressures.iter().zip(&self.weights).map(slope))
            }
            PressureMeasure::Peak => Maximum.subgradient(pressures),
            PressureMeasure::Deviation { .. } => {
                let whole = self.areas.iter().sum::<f64>();
                let slope = |index: usize| 2.0 * self.areas[index] / whole * (pressures[index] - self.wanted[index]);
                Vector::from_fn(pressures.len(), |index, _| slope(index))
            }
            PressureMeasure::OpenArea { pressure } => {
                let slope =
                    |index: usize| if pressures[index] < *pressure { -self.areas[index] / pressure } else { 0.0 };
                Vector::from_fn(pressures.len(), |index, _| slope(index))
            }
        }
    }

    /// The largest pressure s, and Σ m(σ/s)^p; s is positive, also where no pressure is.
    fn relative_sum(&self, pressures: &Vector, exponent: f64) -> (f64, f64) {
        let largest = pressures.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let terms =
            pressures.iter().zip(&self.weights).map(|(p, weight)| weight * (p.max(0.0) / largest).powf(exponent));
        // The node of the largest pressure alone gives this much, unless there is no pressure at all.
        let least = self.weights.iter().copied().fold(f64::INFINITY, f64::min);
        (largest, terms.sum::<f64>().max(least))
    }
}

impl OuterFunction for PressureCost {
    fn value(&self, outputs: &Vector) -> f64 {
        let pressures = outputs;
        let nodes = || pressures.iter().zip(&self.areas);
        match &self.measure {
            &PressureMeasure::Norm { exponent, .. } if self.is_root => {
                let (largest, sum) = self.relative_sum(pressures, exponent);
                largest * sum.powf(1.0 / exponent)
            }
            &PressureMeasure::Norm { exponent, .. } => {
                pressures.iter().zip(&self.weights).map(|(p, weight)| weight * p.max(0.0).powf(exponent)).sum()
            }
            PressureMeasure::Deviation { .. } => {
                let terms =
                    nodes().zip(&self.wanted).map(|((pressure, area), wanted)| area * (pressure - wanted).powi(2));
                terms.sum::<f64>() / self.areas.iter().sum::<f64>()
            }
            PressureMeasure::OpenArea { pressure } => {
                nodes().map(|(found, area)| area * (1.0 - found / pressure).max(0.0)).sum()
            }
            PressureMeasure::Peak => Maximum.value(pressures),
        }
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        self.measure_subgradient(outputs)
    }

    /// Σmσ^p has the curvature p(p−1)mσ^{p−2} per node; its root N has (p−1)/N (m(σ/N)^{p−2} − g gᵀ) with g =
    /// m(σ/N)^{p−1}, which is formed from the rows of G − (σ/N) gᵀG. The deviation has 2A/ΣA. None for the peak and the
    /// open area, which have kinks, and for p < 2, where the curvature grows without bound as a node opens.
    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        let pressures = outputs;
        let exponent = match self.measure {
            PressureMeasure::Norm { exponent, .. } if exponent >= 2.0 => exponent,
            PressureMeasure::Deviation { .. } => {
                let whole = self.areas.iter().sum::<f64>();
                let weights = Vector::from_fn(self.areas.len(), |index, _| 2.0 * self.areas[index] / whole);
                return Some(weighted_gram(jacobian, &weights));
            }
            _ => return None,
        };
        let size = if self.is_root { self.value(outputs) } else { 1.0 };
        let relative = pressures.map(|pressure| pressure.max(0.0) / size);
        let factor = if self.is_root { (exponent - 1.0) / size } else { exponent * (exponent - 1.0) };
        let nodes = Vector::from_column_slice(&self.weights);
        let weights = relative.map(|p| factor * p.powf(exponent - 2.0)).component_mul(&nodes);
        if !self.is_root {
            return Some(weighted_gram(jacobian, &weights));
        }
        // As a difference, rounding would make it indefinite where few nodes carry the norm: Σ m(σ/N)^p = 1.
        let mut centred = jacobian.clone();
        let gradient = jacobian.tr_mul(&relative.map(|p| p.powf(exponent - 1.0)).component_mul(&nodes));
        centred.ger(-1.0, &relative, &gradient, 1.0);
        Some(weighted_gram(&centred, &weights))
    }
}

/// The least Σ A (σ − w)² / Σ A of pressures σ ≥ 0 with Σ A σ = Λ: σ = max(w + t, 0) with the t that gives this force;
/// method.md (9.3).
fn least_deviation(areas: &[f64], wanted: &[f64], total_force: f64) -> f64 {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|a, b| wanted[*b].total_cmp(&wanted[*a]));
    // With the first nodes of this order under pressure, t follows from the force; nodes are added while w + t > 0.
    let (mut area, mut force, mut shift) = (0.0, 0.0, f64::INFINITY);
    for index in order {
        if area > 0.0 && wanted[index] + shift <= 0.0 {
            break;
        }
        area += areas[index];
        force += areas[index] * wanted[index];
        shift = (total_force - force) / area;
    }
    let deviation = |wanted: f64| (wanted + shift).max(0.0) - wanted;
    let sum = areas.iter().zip(wanted).map(|(area, wanted)| area * deviation(*wanted).powi(2)).sum::<f64>();
    sum / areas.iter().sum::<f64>()
}

#[cfg(test)]
mod tests;
