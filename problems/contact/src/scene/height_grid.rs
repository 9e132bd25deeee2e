//! A surface given by heights on a uniform grid, bilinear in between.

use crate::error::SceneError;
use crate::scene::jet::Jet;
use serde::{Deserialize, Serialize};

/// Heights on a uniform grid over a base, its edges included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeightGrid {
    /// (x₁, x₂) of the first place, mm.
    origin: [f64; 2],
    size: [f64; 2],
    counts: [usize; 2],
    heights: Vec<f64>,
}

impl HeightGrid {
    /// The surface in another unit of length: all lengths are multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            origin: self.origin.map(|length| factor * length),
            size: self.size.map(|length| factor * length),
            counts: self.counts,
            heights: self.heights.iter().map(|height| factor * height).collect(),
        }
    }

    /// Heights (mm) at `counts` places along x₁, x₂ of a base of `size` mm; row major, index i·n₂ + j with i along x₁.
    ///
    /// # Errors
    /// [`SceneError`] unless there are at least two places per axis, a height for each, and all heights are finite.
    pub fn new(size: [f64; 2], counts: [usize; 2], heights: Vec<f64>) -> Result<Self, SceneError> {
        for count in counts {
            SceneError::require(count >= 2, "heights per axis of a grid", count, "at least 2")?;
        }
        let expected = counts[0].saturating_mul(counts[1]);
        if heights.len() != expected {
            return Err(SceneError::WrongCount { what: "heights of a grid".into(), expected, found: heights.len() });
        }
        match heights.iter().position(|height| !height.is_finite()) {
            Some(index) => {
                let field = format!("height ({}, {}) of a grid", index / counts[1], index % counts[1]);
                Err(SceneError::out_of_range(field, heights[index], "finite numbers (mm)"))
            }
            None => Ok(Self { origin: [0.0; 2], size, counts, heights }),
        }
    }

    /// The grid with its first place at (x₁, x₂).
    #[must_use]
    pub fn at(self, origin: [f64; 2]) -> Self {
        Self { origin, ..self }
    }

    /// The surface translated by a vector, mm.
    #[must_use]
    pub fn moved(&self, by: [f64; 3]) -> Self {
        let origin = [self.origin[0] + by[0], self.origin[1] + by[1]];
        Self { origin, heights: self.heights.iter().map(|height| height + by[2]).collect(), ..self.clone() }
    }

    /// Height at (x₁, x₂), mm; beyond the base that of its edge.
    pub fn height(&self, x1: f64, x2: f64) -> f64 {
        let [(i, s), (j, t)] = [self.place(0, x1), self.place(1, x2)];
        let at = |i: usize, j: usize| self.heights[i * self.counts[1] + j];
        (1.0 - s) * ((1.0 - t) * at(i, j) + t * at(i, j + 1)) + s * ((1.0 - t) * at(i + 1, j) + t * at(i + 1, j + 1))
    }

    /// Height with its slopes and second derivatives at (x₁, x₂), of the cell that the place lies in; flat across an
    /// edge of the base beyond it.
    pub(crate) fn jet(&self, x1: f64, x2: f64) -> Jet {
        let [(i, s), (j, t)] = [self.place(0, x1), self.place(1, x2)];
        let at = |i: usize, j: usize| self.heights[i * self.counts[1] + j];
        let [h1, h2] = [0, 1].map(|axis: usize| self.size[axis] / (self.counts[axis] - 1) as f64);
        let [in1, in2] = [(0, x1), (1, x2)].map(|(axis, x): (usize, f64)| {
            let inside = (self.origin[axis]..=self.origin[axis] + self.size[axis]).contains(&x);
            f64::from(u8::from(inside))
        });
        let along1 = (1.0 - t) * (at(i + 1, j) - at(i, j)) + t * (at(i + 1, j + 1) - at(i, j + 1));
        let along2 = (1.0 - s) * (at(i, j + 1) - at(i, j)) + s * (at(i + 1, j + 1) - at(i + 1, j));
        let twist = in1 * in2 * (at(i + 1, j + 1) - at(i + 1, j) - at(i, j + 1) + at(i, j)) / (h1 * h2);
        Jet {
            height: self.height(x1, x2),
            slopes: [in1 * along1 / h1, in2 * along2 / h2],
            second: [[0.0, twist], [twist, 0.0]],
        }
    }

    /// Cell along an axis and the position in it.
    fn place(&self, axis: usize, x: f64) -> (usize, f64) {
        let last = self.counts[axis] - 1;
        let position = ((x - self.origin[axis]) / self.size[axis]).clamp(0.0, 1.0) * last as f64;
        let cell = (position as usize).min(last - 1);
        (cell, position - cell as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bilinear_surface_is_reproduced() {
        let surface = |x: f64, y: f64| 3.0 + 0.5 * x - 0.25 * y + 0.125 * x * y;
        let heights =
            (0..3).flat_map(|i| (0..5).map(move |j| surface(2.0 * f64::from(i), 0.5 * f64::from(j)))).collect();
        let grid = HeightGrid::new([4.0, 2.0], [3, 5], heights).expect("valid");
        for (x, y) in [(0.0, 0.0), (4.0, 2.0), (1.3, 0.7), (3.9, 1.99)] {
            assert!((grid.height(x, y) - surface(x, y)).abs() < 1e-13);
        }
        assert!(HeightGrid::new([1.0, 1.0], [2, 2], vec![0.0; 3]).is_err());
        let refusal = HeightGrid::new([1.0, 1.0], [2, 2], vec![0.0, 0.0, f64::NAN, 0.0]).expect_err("no number");
        assert!(refusal.to_string().starts_with("height (1, 0) of a grid = NaN is not allowed"), "{refusal}");
    }
}
