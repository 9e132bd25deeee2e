//! Residuals of a claimed solution, recomputed from x and μ alone.

use crate::linear::vector::{add_scaled, norm};
use crate::qp::QuadraticProgram;

/// How far (x, μ) is from satisfying the optimality conditions; dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KktResidual {
    /// |x − P_Ω(x)|∞ over |x|∞.
    pub set: f64,
    /// |C x − e| over |e| + |x|: meant for rows C of unit length.
    pub equality: f64,
    /// |x − P_Ω(x − α(H x − b + Cᵀμ))|/α over |b| + norm·|x|, with α = 1/norm.
    pub stationarity: f64,
}

impl KktResidual {
    /// The residual of a point; `norm_h` is a norm of H, which sets the length of the trial step.
    pub fn of(program: &QuadraticProgram<'_>, x: &[f64], multipliers: &[f64], norm_h: f64) -> Self {
        let mut image = vec![0.0; x.len()];
        program.hessian.apply(x, &mut image);
        let scale = (norm(program.linear) + norm_h * norm(x)).max(f64::MIN_POSITIVE);
        let mut gradient: Vec<f64> = image.iter().zip(program.linear).map(|(image, b)| image - b).collect();
        add_scaled(&mut gradient, 1.0, &program.equalities.apply_transposed(multipliers));
        let size = (norm(x) + norm(program.equalities.right_side())).max(f64::MIN_POSITIVE);
        let equality = norm(&program.defect(x)) / size;
        let reduced = program.set.reduced_gradient(x, &gradient, 1.0 / norm_h);
        let mut projected = x.to_vec();
        program.set.project(&mut projected);
        let largest = x.iter().fold(f64::MIN_POSITIVE, |largest, entry| largest.max(entry.abs()));
        let moved = x.iter().zip(&projected).fold(0.0_f64, |largest, (x, p)| largest.max((x - p).abs()));
        Self { set: moved / largest, equality, stationarity: norm(&reduced) / scale }
    }

    /// The largest of the three.
    pub fn largest(&self) -> f64 {
        self.set.max(self.equality).max(self.stationarity)
    }
}
