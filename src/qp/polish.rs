//! The accurate optimum of a sum of absolute values once it is known which of them vanish and which sides are met.
//!
//! ```text
//! H x + p + Gᵀw + Eᵀμ = 0,   c_i + ⟨g_i, x⟩ = 0 where |·| vanishes, w_i its sign elsewhere,   E_k x = e_k where met, μ_k = 0 elsewhere
//! ```
//! The products of large ratios z/s that Newton steps of the interior-point method contain cost digits; these equations
//! contain none. They are solved for corrections, so that what rounding leaves is small beside these.

use super::dense::Cholesky;
use super::program::{PrimalDual, Program};
use crate::{Matrix, Vector};

/// Corrections: a second one removes what rounding left in the first.
const CORRECTIONS: usize = 2;

/// The absolute values and the sides that are taken to vanish at the optimum.
pub(super) struct Guess {
    /// Which of the absolute values vanish.
    pub(super) vanishing: Vec<bool>,
    /// Which of the sides are met, equalities included.
    pub(super) met: Vec<bool>,
}

/// The equations of a guess.
struct Equations<'a> {
    program: &'a Program<'a>,
    /// The absolute values that vanish.
    values: Vec<usize>,
    /// The sides that are met.
    sides: Vec<usize>,
    /// The rows of both, as columns.
    columns: Matrix,
    /// The right-hand side of the rows.
    targets: Vector,
}

/// The better one of an answer and of what the equations of a guess make of it; none where nobody waits any more.
pub(super) fn polish(program: &Program<'_>, answer: PrimalDual, guess: &Guess) -> Option<PrimalDual> {
    let polished = Equations::new(program, guess).solve(&answer)?;
    Some(if error(program, &polished) < error(program, &answer) { polished } else { answer })
}

impl<'a> Equations<'a> {
    fn new(program: &'a Program<'a>, guess: &Guess) -> Self {
        let places = |of: &[bool]| -> Vec<usize> { (0..of.len()).filter(|&i| of[i]).collect() };
        let (values, sides) = (places(&guess.vanishing), places(&guess.met));
        let mut columns = Matrix::zeros(program.jacobian.ncols(), values.len() + sides.len());
        for (k, &i) in values.iter().enumerate() {
            columns.set_column(k, &program.jacobian.row(i).transpose());
        }
        for (k, &i) in sides.iter().enumerate() {
            let normal = program.sides[i].normal.iter();
            normal.for_each(|&(row, entry)| columns[(row, values.len() + k)] = entry);
        }
        let of_values = values.iter().map(|&i| -program.outputs[i]);
        let targets: Vec<f64> = of_values.chain(sides.iter().map(|&i| program.sides[i].bound)).collect();
        Self { program, values, sides, columns, targets: Vector::from_vec(targets) }
    }

    fn solve(&self, start: &PrimalDual) -> Option<PrimalDual> {
        let mut found = self.fitting(start);
        let factor = Cholesky::new(self.program.quadratic.clone());
        let schur = factor.schur(self.columns.clone())?;
        for _ in 0..CORRECTIONS {
            let dual = -slopes(self.program, &found);
            let primal = &self.targets - self.columns.tr_mul(&found.x);
            let multipliers = schur.solve(self.columns.tr_mul(&factor.solve(dual.clone())) - primal);
            found.x += factor.solve(dual - &self.columns * &multipliers);
            let (of_values, of_sides) = multipliers.as_slice().split_at(self.values.len());
            self.values.iter().zip(of_values).for_each(|(&i, change)| found.weights[i] += change);
            self.sides.iter().zip(of_sides).for_each(|(&i, change)| found.multipliers[i] += change);
        }
        Some(found)
    }

    /// The start, with the weights and multipliers that the guess knows.
    fn fitting(&self, start: &PrimalDual) -> PrimalDual {
        let mut weights = start.weights.map(f64::signum);
        self.values.iter().for_each(|&i| weights[i] = start.weights[i]);
        let mut multipliers = vec![0.0; start.multipliers.len()];
        self.sides.iter().for_each(|&i| multipliers[i] = start.multipliers[i]);
        PrimalDual { x: start.x.clone(), weights, multipliers }
    }
}

/// H x + p + Gᵀw + Eᵀμ.
fn slopes(program: &Program<'_>, at: &PrimalDual) -> Vector {
    let mut slopes = program.quadratic * &at.x + program.linear + program.jacobian.tr_mul(&at.weights);
    for (side, multiplier) in program.sides.iter().zip(&at.multipliers) {
        side.normal.iter().for_each(|&(k, entry)| slopes[k] += entry * multiplier);
    }
    slopes
}

/// The largest residual of the conditions of an optimum.
fn error(program: &Program<'_>, at: &PrimalDual) -> f64 {
    let values = program.outputs + program.jacobian * &at.x;
    let missed: f64 = values.iter().zip(at.weights.iter()).map(|(value, w)| value.abs() - w * value).sum();
    let gap = missed / (1.0 + values.iter().map(|value| value.abs()).sum::<f64>());
    let beyond = at.weights.amax() - 1.0;
    let mut largest = gap.max(beyond).max(slopes(program, at).amax());
    for (k, (side, multiplier)) in program.sides.iter().zip(&at.multipliers).enumerate() {
        let slack = side.bound - side.normal.iter().map(|&(k, entry)| entry * at.x[k]).sum::<f64>();
        let of_side =
            if k < program.equalities { slack.abs() } else { (-slack).max(-multiplier).max(multiplier * slack) };
        largest = largest.max(of_side);
    }
    if largest.is_nan() { f64::INFINITY } else { largest }
}
