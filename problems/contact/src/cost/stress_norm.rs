//! The p-norm of the von Mises stress over a region; method.md (3.7), (5.5) to (5.7).
//!
//! ```text
//! J = ((1/V₀) Σ_e V_e σ_vM,e^p)^{1/p}
//! with r = σ/σ_max, s = Σ V r^p/V₀:     dJ = s^{1/p−1}/V₀ Σ (V r^{p−1} dσ + σ_max/p r^p dV)
//! ```

use crate::body::elasticity::CellNodes;
use crate::cost::piece::StateGradient;
use crate::cost::region::RegionCells;
use crate::cost::row_terms::RowTerms;

/// The norm over some cells.
#[derive(Debug, Clone)]
pub(super) struct StressNorm {
    pub cells: RegionCells,
    pub exponent: f64,
}

impl StressNorm {
    /// Its value at a state, MPa.
    pub fn value(&self, terms: RowTerms<'_>) -> f64 {
        let Self { cells, exponent } = self;
        let stresses = cells.map(&terms.problem.bodies, terms.at.bodies, |cell, shear_modulus, u| {
            (cell.von_mises(shear_modulus, u), cell.volume())
        });
        let largest = stresses.iter().flatten().map(|(stress, _)| *stress).fold(0.0, f64::max);
        if largest == 0.0 {
            return 0.0;
        }
        // Relative to the largest stress, so that no power leaves the range of doubles.
        let terms = stresses.iter().flatten().map(|(stress, volume)| volume * (stress / largest).powf(*exponent));
        largest * (terms.sum::<f64>() / cells.volume).powf(1.0 / exponent)
    }

    /// Its derivatives.
    pub fn gradient(&self, terms: RowTerms<'_>) -> StateGradient {
        let (problem, bodies, exponent) = (terms.problem, terms.at.bodies, self.exponent);
        let (mut displacements, mut positions) = (vec![0.0; problem.displacement_count()], problem.no_sensitivities());
        let cells = self.cells.map(&problem.bodies, bodies, CellNodes::stressed);
        let largest = cells.iter().flatten().map(|cell| cell.stress).fold(0.0, f64::max);
        if largest == 0.0 {
            return StateGradient { forces: Vec::new(), displacements, positions };
        }
        let terms = cells.iter().flatten().map(|cell| cell.volume * (cell.stress / largest).powf(exponent));
        let sum = terms.sum::<f64>() / self.cells.volume;
        let factor = sum.powf(1.0 / exponent - 1.0) / self.cells.volume;
        for (number, (places, cells)) in self.cells.cells.iter().zip(&cells).enumerate() {
            let mesh = &problem.bodies[number].mesh;
            for (place, cell) in places.iter().zip(cells) {
                let relative = (cell.stress / largest).powf(exponent - 1.0);
                let by_stress = factor * cell.volume * relative;
                let by_volume = factor * relative * cell.stress / exponent;
                for (local, &node) in mesh.cell(*place).nodes.iter().enumerate() {
                    let (own, moves) = (problem.map.number(number, node), problem.map.moves(number, node));
                    for axis in 0..3 {
                        displacements[3 * own + axis] += by_stress * cell.by_displacement[local][axis];
                        if moves {
                            positions[own][axis] += by_stress * cell.by_position[local][axis]
                                + by_volume * cell.volume_by_position[local][axis];
                        }
                    }
                }
            }
        }
        StateGradient { forces: Vec::new(), displacements, positions }
    }
}
