//! The outputs of a contact state that a cost of the pressures is a convex function of.
//!
//! ```text
//! h has fixed weights; where areas A change with the shape, outputs c carry the change:            A⁰, S⁰ = ΣA⁰: at the start
//! pressures  c = λ/A                                                        h = max c,  Σc^p
//! power      c = λ/A (A/A⁰)^{1/p}, times (S⁰/S)^{1/p} for a mean            h = Σ A⁰ c^p = ∫σ^p dA
//! deviation  c = w + (λ/A − w) (A S⁰/(A⁰ S))^{1/2}                          h = Σ A⁰ (c − w)²/S⁰
//! open area  c = σ₀ (1 − A/A⁰) + λ/A⁰                                       h = Σ A⁰ max(1 − c/σ₀, 0)
//! ```

/// What the outputs are.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) enum Scaling {
    /// The pressures.
    #[default]
    Pressure,
    /// Those of an integral of powers, or of its mean.
    Power { exponent: f64, is_mean: bool },
    /// Those of a deviation from wanted pressures.
    Deviation { wanted: Vec<f64> },
    /// Those of an open area.
    OpenArea { pressure: f64 },
}

/// The outputs of a contact state.
#[derive(Debug, Clone, Default)]
pub struct PressureOutputs {
    pub(crate) scaling: Scaling,
    /// Areas at the start, mm²; none for pressures.
    pub(crate) areas: Vec<f64>,
    /// Whether the pressures follow as outputs of their own: their largest one is limited.
    pub(crate) with_pressures: bool,
}

/// An output and its derivatives by the normal force of its node, its area, and the sum of all areas.
struct Output {
    value: f64,
    by_force: f64,
    by_area: f64,
    by_sum: f64,
}

impl PressureOutputs {
    fn pressure(force: f64, area: f64) -> Output {
        let value = force / area;
        Output { value, by_force: 1.0 / area, by_area: -value / area, by_sum: 0.0 }
    }

    fn output(&self, node: usize, [force, area]: [f64; 2], [start, sum]: [f64; 2]) -> Output {
        let pressure = force / area;
        match &self.scaling {
            Scaling::Pressure => Self::pressure(force, area),
            &Scaling::Power { exponent: p, is_mean } => {
                let ratio = area / self.areas[node] * if is_mean { start / sum } else { 1.0 };
                let factor = ratio.powf(1.0 / p);
                let value = pressure * factor;
                let by_sum = if is_mean { -value / (p * sum) } else { 0.0 };
                Output { value, by_force: factor / area, by_area: (1.0 / p - 1.0) * value / area, by_sum }
            }
            Scaling::Deviation { wanted } => {
                let factor = (area * start / (self.areas[node] * sum)).sqrt();
                let part = (pressure - wanted[node]) * factor;
                Output {
                    value: wanted[node] + part,
                    by_force: factor / area,
                    by_area: (0.5 * part - pressure * factor) / area,
                    by_sum: -0.5 * part / sum,
                }
            }
            &Scaling::OpenArea { pressure: bound } => {
                let own = self.areas[node];
                let value = bound * (1.0 - area / own) + force / own;
                Output { value, by_force: 1.0 / own, by_area: -bound / own, by_sum: 0.0 }
            }
        }
    }

    /// All outputs in order.
    fn all<'a>(&'a self, forces: &'a [f64], areas: &'a [f64]) -> impl Iterator<Item = (usize, Output)> + 'a {
        let sums = [self.areas.iter().sum::<f64>(), areas.iter().sum::<f64>()];
        let nodes = || forces.iter().zip(areas).enumerate();
        let outputs = nodes().map(move |(node, (&force, &area))| (node, self.output(node, [force, area], sums)));
        let pressures = nodes().map(|(node, (&force, &area))| (node, Self::pressure(force, area)));
        outputs.chain(pressures.take(if self.with_pressures { forces.len() } else { 0 }))
    }

    /// Their number for so many contact nodes.
    pub fn count(&self, nodes: usize) -> usize {
        if self.with_pressures { 2 * nodes } else { nodes }
    }

    /// The outputs for normal forces (N) and areas (mm²) per contact node.
    pub fn values(&self, forces: &[f64], areas: &[f64]) -> Vec<f64> {
        self.all(forces, areas).map(|(_, output)| output.value).collect()
    }

    /// The derivatives of Σ weights·outputs by the normal forces and by the areas.
    pub fn pull_back(&self, forces: &[f64], areas: &[f64], weights: &[f64]) -> [Vec<f64>; 2] {
        let (mut by_force, mut by_area, mut by_sum) = (vec![0.0; forces.len()], vec![0.0; forces.len()], 0.0);
        for ((node, output), weight) in self.all(forces, areas).zip(weights) {
            by_force[node] += weight * output.by_force;
            by_area[node] += weight * output.by_area;
            by_sum += weight * output.by_sum;
        }
        by_area.iter_mut().for_each(|value| *value += by_sum);
        [by_force, by_area]
    }

    /// The changes of the outputs for changes of the normal forces and of the areas.
    pub fn push_forward(
        &self,
        [forces, areas]: [&[f64]; 2],
        force_changes: impl Fn(usize) -> f64,
        area_changes: &[f64],
    ) -> Vec<f64> {
        let sum = area_changes.iter().sum::<f64>();
        let change = |(node, output): (usize, Output)| {
            output.by_force * force_changes(node) + output.by_area * area_changes[node] + output.by_sum * sum
        };
        self.all(forces, areas).map(change).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Both derivatives are those of central differences, whatever the outputs are.
        #[test]
        fn derivatives_are_those_of_differences(
            forces in prop::collection::vec(0.5_f64..2.0, 4), areas in prop::collection::vec(0.5_f64..2.0, 4),
            moved in prop::collection::vec(-1.0_f64..1.0, 8), weights in prop::collection::vec(-1.0_f64..1.0, 8),
        ) {
            let scalings = [
                Scaling::Pressure,
                Scaling::Power { exponent: 3.0, is_mean: false },
                Scaling::Power { exponent: 3.0, is_mean: true },
                Scaling::Deviation { wanted: vec![0.3, 1.2, 0.7, 0.0] },
                Scaling::OpenArea { pressure: 1.3 },
            ];
            let (by_force, by_area) = moved.split_at(4);
            for scaling in scalings {
                let outputs = PressureOutputs { scaling, areas: vec![1.0, 1.5, 0.8, 1.1], with_pressures: true };
                let step = 1e-5;
                let at = |way: f64| {
                    let moved = |values: &[f64], changes: &[f64]| -> Vec<f64> {
                        values.iter().zip(changes).map(|(value, change)| value + way * step * change).collect()
                    };
                    outputs.values(&moved(&forces, by_force), &moved(&areas, by_area))
                };
                let (before, after) = (at(-1.0), at(1.0));
                let changes = outputs.push_forward([&forces, &areas], |node| by_force[node], by_area);
                let mut sum = 0.0;
                for index in 0..8 {
                    let difference = (after[index] - before[index]) / (2.0 * step);
                    prop_assert!((changes[index] - difference).abs() < 1e-8, "{outputs:?} {index}");
                    sum += weights[index] * changes[index];
                }
                let [by_forces, by_areas] = outputs.pull_back(&forces, &areas, &weights);
                let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let pulled = product(&by_forces, by_force) + product(&by_areas, by_area);
                prop_assert!((pulled - sum).abs() < 1e-12);
            }
        }

        /// At the areas of the start, all outputs but the open area's are the pressures.
        #[test]
        fn outputs_at_the_start_are_pressures(forces in prop::collection::vec(0.0_f64..2.0, 3)) {
            let areas = vec![0.3, 0.7, 1.9];
            for scaling in [Scaling::Power { exponent: 4.0, is_mean: true }, Scaling::OpenArea { pressure: 0.4 }] {
                let outputs = PressureOutputs { scaling, areas: areas.clone(), with_pressures: false };
                for (output, (force, area)) in outputs.values(&forces, &areas).iter().zip(forces.iter().zip(&areas)) {
                    prop_assert_eq!(*output, force / area);
                }
            }
        }
    }
}
