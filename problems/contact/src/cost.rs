//! Costs of the contact pressure σ_i = λ_N,i / A_i; method.md (3.4).

use crate::equilibrium::{ContactBoundary, ContactState};
use crate::error::SceneError;
use crate::scene::Scene;
use nonsmooth::composite::{OuterFunction, weighted_gram};
use nonsmooth::{Cost, CostGradient, Matrix, Vector};

/// A function of the contact pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// Whether the value is the p-th root of Σσ^p.
    is_root: bool,
    areas: Vec<f64>,
    dual_dimension: usize,
}

/// Decades of Σσ^p at the typical pressure of a scene beyond which its root is taken. Squares of subgradients at pressures far
/// above that must still be doubles, which end at 308 decades.
const MAX_DECADES: f64 = 100.0;
/// Largest pressure over the mean pressure, roughly: those of the paper's scenes are at 4 to 10.
const TYPICAL_PEAK: f64 = 10.0;

impl PressureCost {
    /// The cost on a contact boundary.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless the exponent is finite and > 1.
    pub fn new(measure: PressureMeasure, boundary: &ContactBoundary) -> Result<Self, SceneError> {
        if let PressureMeasure::Norm { exponent } = measure {
            let valid = exponent > 1.0 && exponent.is_finite();
            SceneError::require(valid, "objective.exponent", exponent, "a finite number > 1")?;
        }
        let areas = boundary.points.iter().map(|point| point.area).collect();
        Ok(Self { measure, is_root: false, areas, dual_dimension: boundary.dual_dimension() })
    }

    /// The same cost in a form that can be computed for the pressures of a scene: where Σσ^p may leave the range of doubles, its
    /// root (Σσ^p)^{1/p}, which has the same minimisers. The choice depends neither on the mesh nor on the shape.
    #[must_use]
    pub fn normalised_for(self, scene: &Scene) -> Self {
        let PressureMeasure::Norm { exponent } = self.measure else { return self };
        let typical = TYPICAL_PEAK * scene.load() / (scene.size[0] * scene.size[1]);
        Self { is_root: typical > 0.0 && exponent * typical.log10().abs() > MAX_DECADES, ..self }
    }

    /// p where the value is (Σσ^p)^{1/p}, else 1.
    pub fn root(&self) -> f64 {
        match self.measure {
            PressureMeasure::Norm { exponent } if self.is_root => exponent,
            _ => 1.0,
        }
    }

    /// The unit of the value, such as `MPa^{4}`.
    pub fn unit(&self) -> String {
        match self.measure {
            PressureMeasure::Norm { exponent } if !self.is_root => format!("MPa^{{{exponent}}}"),
            _ => "MPa".into(),
        }
    }

    /// The least value that any distribution of a total normal force over the contact nodes can have: no shape that carries
    /// this force is below it.
    ///
    /// Σσ^p ≥ Λ^p / (ΣA^{p/(p−1)})^{p−1}, max σ ≥ Λ/ΣA, with Λ = Σλ_N ≥ 0 in N; method.md (9.1), (9.2).
    pub fn lower_bound(&self, total_force: f64) -> f64 {
        match self.measure {
            PressureMeasure::Norm { exponent: p } => {
                // Relative to the largest area, so that the sum is at least 1 for every p.
                let largest = self.areas.iter().copied().fold(0.0, f64::max);
                let weights: f64 = self.areas.iter().map(|area| (area / largest).powf(p / (p - 1.0))).sum();
                match self.is_root {
                    false => (total_force / largest).powf(p) / weights.powf(p - 1.0),
                    true => total_force / largest / weights.powf((p - 1.0) / p),
                }
            }
            PressureMeasure::Peak => total_force / self.areas.iter().sum::<f64>(),
        }
    }

    /// σ per contact node, MPa.
    pub fn pressures<S>(&self, state: &ContactState<S>) -> Vec<f64> {
        state.forces.normal.iter().zip(&self.areas).map(|(force, area)| force / area).collect()
    }
}

/// As a function of the pressures.
impl OuterFunction for PressureCost {
    fn value(&self, pressures: &Vector) -> f64 {
        match self.measure {
            PressureMeasure::Norm { exponent } if self.is_root => {
                let (largest, sum) = relative_sum(pressures, exponent);
                largest * sum.powf(1.0 / exponent)
            }
            PressureMeasure::Norm { exponent } => pressures.iter().map(|p| p.max(0.0).powf(exponent)).sum(),
            PressureMeasure::Peak => pressures.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    fn subgradient(&self, pressures: &Vector) -> Vector {
        match self.measure {
            PressureMeasure::Norm { exponent } => {
                let (largest, factor) = match self.is_root {
                    false => (1.0, exponent),
                    true => {
                        let (largest, sum) = relative_sum(pressures, exponent);
                        (largest, sum.powf(1.0 / exponent - 1.0))
                    }
                };
                pressures.map(|pressure| factor * (pressure.max(0.0) / largest).powf(exponent - 1.0))
            }
            PressureMeasure::Peak => {
                let larger = |peak: usize, index: usize| if pressures[index] > pressures[peak] { index } else { peak };
                let peak = (0..pressures.len()).fold(0, larger);
                Vector::from_fn(pressures.len(), |index, _| f64::from(u8::from(index == peak)))
            }
        }
    }

    /// Σσ^p has the curvature p(p−1)σ^{p−2} per node; its root N has (p−1)/N ((σ/N)^{p−2} − g gᵀ) with g = (σ/N)^{p−1}. None for
    /// the peak, and for p < 2, where the curvature grows without bound as a node opens.
    fn curvature(&self, pressures: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        let PressureMeasure::Norm { exponent } = self.measure else { return None };
        if exponent < 2.0 {
            return None;
        }
        let size = if self.is_root { OuterFunction::value(self, pressures) } else { 1.0 };
        let relative = pressures.map(|pressure| pressure.max(0.0) / size);
        let factor = if self.is_root { (exponent - 1.0) / size } else { exponent * (exponent - 1.0) };
        let weights = relative.map(|p| factor * p.powf(exponent - 2.0));
        let mut curvature = weighted_gram(jacobian, &weights);
        if self.is_root {
            let gradient = jacobian.tr_mul(&relative.map(|p| p.powf(exponent - 1.0)));
            curvature.ger(-factor, &gradient, &gradient, 1.0);
        }
        Some(curvature)
    }
}

impl<S> Cost<ContactState<S>> for PressureCost {
    fn value(&self, _control: &Vector, state: &ContactState<S>) -> f64 {
        OuterFunction::value(self, &Vector::from_vec(self.pressures(state)))
    }

    fn gradient(&self, control: &Vector, state: &ContactState<S>) -> CostGradient {
        let weights = self.subgradient(&Vector::from_vec(self.pressures(state)));
        let mut dual = Vector::zeros(self.dual_dimension);
        for (index, (weight, area)) in weights.iter().zip(&self.areas).enumerate() {
            dual[index] = weight / area;
        }
        CostGradient { control: Vector::zeros(control.len()), state: dual }
    }
}

/// The largest pressure m, and Σ(σ/m)^p; m is positive, also where no pressure is.
fn relative_sum(pressures: &Vector, exponent: f64) -> (f64, f64) {
    let largest = pressures.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    // At least 1, which it is unless there is no pressure at all.
    (largest, pressures.iter().map(|p| (p.max(0.0) / largest).powf(exponent)).sum::<f64>().max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Σσ^p of forces over areas.
    fn norm(forces: &[f64], areas: &[f64], p: f64) -> f64 {
        forces.iter().zip(areas).map(|(force, area)| (force / area).powf(p)).sum()
    }

    #[test]
    fn the_lower_bound_is_attained_and_never_undercut() {
        let areas = vec![1.0, 2.0, 4.0, 0.5];
        for p in [1.02, 1.5, 4.0, 12.0] {
            let measure = PressureMeasure::Norm { exponent: p };
            let cost = PressureCost { is_root: false, measure, areas: areas.clone(), dual_dimension: 4 };
            let weights: Vec<f64> = areas.iter().map(|area: &f64| area.powf(p / (p - 1.0))).collect();
            let forces: Vec<f64> = weights.iter().map(|w| 30.0 * w / weights.iter().sum::<f64>()).collect();
            let bound = cost.lower_bound(30.0);
            assert!((norm(&forces, &areas, p) / bound - 1.0).abs() < 1e-12);
            for other in [[30.0, 0.0, 0.0, 0.0], [7.5; 4], [4.0, 8.0, 16.0, 2.0]] {
                assert!(norm(&other, &areas, p) >= bound * (1.0 - 1e-12));
            }
        }
        // Near p = 1 everything goes to the largest area: (30/4)^p.
        let nearly = PressureMeasure::Norm { exponent: 1.001 };
        let cost = PressureCost { is_root: false, measure: nearly, areas: areas.clone(), dual_dimension: 4 };
        assert!((cost.lower_bound(30.0) / 7.5_f64.powf(1.001) - 1.0).abs() < 1e-12);
        let cost = PressureCost { is_root: false, measure: PressureMeasure::Peak, areas, dual_dimension: 4 };
        assert!((cost.lower_bound(30.0) - 4.0).abs() < 1e-14);
    }

    #[test]
    fn the_lower_bound_of_the_paper_s_example() {
        // method.md (9.1): (3e7)⁴/(Σ A^{4/3})³ = 1.294e16 on 12 × 12 bricks of a 100 mm square.
        let grid = crate::body::mesh::Grid { cells: [12, 12, 12], size: [100.0, 100.0] };
        let areas = grid.columns().map(|(i, j)| grid.tributary_area(i, j)).collect();
        let cost = PressureCost {
            is_root: false,
            measure: PressureMeasure::Norm { exponent: 4.0 },
            areas,
            dual_dimension: 169,
        };
        assert!((cost.lower_bound(3e7) / 1.294e16 - 1.0).abs() < 5e-4);
    }
}
