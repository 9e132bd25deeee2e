//! Least weight of trusses under a limit on the largest stress: one nonsmooth, nonconvex constraint, against the same
//! problem with an exact penalty.

use nonsmooth::{
    BundleTrust, BundleTrustConfig, ConstrainedFunction, ConstraintEvaluation, ConstraintKind, FnObjective, Matrix,
    Polyhedron, Vector,
};

const PENALTY: f64 = 100.0;

/// Directions of the bars and the load, without pattern.
struct Truss {
    bars: Matrix,
    load: Vector,
}

impl Truss {
    fn new(bars: usize, dimensions: usize, seed: u64) -> Self {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let mut normal = || (-2.0 * next().ln()).sqrt() * (std::f64::consts::TAU * next()).cos();
        let (bars, load) =
            (Matrix::from_fn(dimensions, bars, |_, _| normal()), Vector::from_fn(dimensions, |_, _| normal()));
        Self { bars, load }
    }

    /// max |stress| − 1 with one subgradient, for areas x: s = Bᵀ (B diag(x) Bᵀ)⁻¹ F.
    fn excess(&self, x: &Vector) -> (f64, Vector) {
        let scaled =
            |factors: &Vector| Matrix::from_fn(self.bars.nrows(), x.len(), |i, j| self.bars[(i, j)] * factors[j]);
        let stiffness = (scaled(x) * self.bars.transpose()).lu();
        let stresses = self.bars.tr_mul(&stiffness.solve(&self.load).unwrap());
        let worst = stresses.iamax();
        let change = stiffness.solve(&scaled(&stresses)).unwrap();
        let slope = (self.bars.column(worst).transpose() * change).transpose() * -stresses[worst].signum();
        (stresses[worst].abs() - 1.0, slope)
    }
}

#[test]
fn limits_of_stresses_do_as_well_as_their_penalty() {
    let (mut share, mut confirmed, mut as_low, mut count) = (0.0, 0, 0, 0);
    for (bars, dimensions) in [(3, 2), (5, 3), (10, 4)] {
        for (seed, start) in (1..7).flat_map(|seed| [0.3, 1.0, 3.0].map(|start| (seed, start))) {
            let truss = Truss::new(bars, dimensions, seed * 7919 + bars as u64 * 104_729);
            let one = Vector::from_element(bars, 1.0);
            let limited = ConstrainedFunction::new(bars, vec![ConstraintKind::Nonsmooth], |x: &Vector| {
                let (excess, slope) = truss.excess(x);
                let row = Matrix::from_row_slice(1, bars, slope.as_slice());
                (x.sum(), one.clone(), ConstraintEvaluation::new(Vector::from_element(1, excess), row))
            });
            let penalized = FnObjective::new(bars, |x: &Vector| {
                let (excess, slope) = truss.excess(x);
                let active = if excess > 0.0 { PENALTY } else { 0.0 };
                (x.sum() + active * excess, &one + slope * active)
            });
            let method = || {
                let config = BundleTrustConfig { max_evaluations: 500, ..BundleTrustConfig::default() };
                let set =
                    Polyhedron::boxed(Vector::from_element(bars, 0.02), Vector::from_element(bars, 50.0)).unwrap();
                BundleTrust::new(config).unwrap().constraints(set)
            };
            let start = Vector::from_element(bars, start);
            let report = method().minimize(&limited, start.clone()).unwrap();
            let other = method().minimize(&penalized, start).unwrap();
            assert!(report.is_feasible(), "{bars} {seed}: {report}");
            as_low += usize::from(report.value <= other.value * (1.0 + 1e-6));
            share += (report.counts.evaluations as f64 / other.counts.evaluations as f64).ln();
            confirmed += usize::from(report.termination.is_confirmed());
            count += 1;
        }
    }
    let share = (share / f64::from(count)).exp();
    let found = format!("{as_low} as low, {confirmed} confirmed of {count}, evaluations {share:.2}");
    println!("{found} of those with the penalty");
    assert!(as_low >= 50 && confirmed >= 46 && share < 0.95, "{found}");
}
