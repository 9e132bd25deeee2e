//! Ends that rest on cuts not quite near are confirmed only after a second look.
use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Report, StopRule, Termination, Vector};

/// Numbers in [0, 1) by xorshift, and sums of twelve of them that stand for normal ones.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Σ w_i |x_{i+1} − a_i x_i² − b_i sin 2x_i − c_i| + |x_1 − 1| or (x_1 − 1)²/4: curved valleys with flanks of many
/// slopes.
struct Valley {
    weights: Vec<f64>,
    harmonics: Vec<[f64; 3]>,
    smooth: bool,
}

impl Valley {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (2 << 32) | 1);
        (0..10).for_each(|_| _ = random.uniform());
        let n = 2 + (random.uniform() * 9.0) as usize;
        let weights = (0..n).map(|_| 10_f64.powf(3.0 * random.uniform() - 0.5)).collect();
        let harmonics = (0..n).map(|_| [random.normal(), random.normal(), random.normal()]).collect();
        Self { weights, harmonics, smooth: random.uniform() < 0.5 }
    }

    fn at(&self, x: &Vector) -> (f64, Vector) {
        let off = x[0] - 1.0;
        let (mut value, mut slope) = (if self.smooth { 0.25 * off * off } else { off.abs() }, Vector::zeros(x.len()));
        slope[0] = if self.smooth { 0.5 * off } else { off.signum() };
        for i in 0..x.len() - 1 {
            let [a, b, c] = self.harmonics[i];
            let across = x[i + 1] - (a * x[i] * x[i] + b * (2.0 * x[i]).sin() + c);
            let flank = self.weights[i] * across.signum();
            value += self.weights[i] * across.abs();
            slope[i + 1] += flank;
            slope[i] -= flank * (2.0 * a * x[i] + 2.0 * b * (2.0 * x[i]).cos());
        }
        (value, slope)
    }

    fn run(&self, start: Vector, first_step: Option<f64>) -> Report {
        let config = BundleTrustConfig { first_step, ..Default::default() };
        let mut method = BundleTrust::new(config).unwrap().stop_when(StopRule::Evaluations(1500));
        method.minimize(&FnObjective::new(self.weights.len(), |x: &Vector| self.at(x)), start).unwrap()
    }
}

#[test]
fn a_second_look_finds_what_falls_along_a_curved_kink() {
    // Without the second look these runs end confirmed, 6.9e-4, 6.1e-5 and 2.2e-5 (relative) above what can be attained
    // next to them. With it they come to their limit of evaluations.
    for (seed, scale) in [(20894, 10.0), (21368, 0.1), (31081, 0.1)] {
        let valley = Valley::new(seed);
        let mut random = Random(seed * 7919 + 13);
        let mut start = Vector::zeros(0);
        for size in [0.1, 1.0, 10.0] {
            start = Vector::from_fn(valley.weights.len(), |_, _| size * random.normal());
            if size == scale {
                break;
            }
        }
        let report = valley.run(start, None);
        if !report.termination.is_confirmed() {
            continue;
        }
        for _ in 0..4 {
            let distance = 1e-7 * (1.0 + report.solution.amax());
            let near = report.solution.map(|x| x + distance * random.normal());
            let lower = valley.run(near, Some(distance)).value;
            assert!(report.value - lower <= 1e-5 * (1.0 + report.value.abs()), "{seed}: {lower} {report}");
        }
    }
}

#[test]
fn the_first_proof_comes_back_where_nothing_lower_is_found() {
    let mut kept = 0;
    for problem in testset::all() {
        if problem.family != testset::Family::Unconstrained {
            continue;
        }
        let theta = FnObjective::new(problem.dimension, |x: &Vector| {
            let (value, slope) = problem.evaluate(x.as_slice());
            (value, Vector::from_vec(slope))
        });
        let config = BundleTrustConfig { max_evaluations: 600, ..Default::default() };
        let start = Vector::from_column_slice(&problem.start);
        let report = BundleTrust::new(config).unwrap().minimize(&theta, start).unwrap();
        let Termination::Stationary { radius, .. } = report.termination else { continue };
        // Beyond 1e-6, the end has been checked twice; its certificate holds the cuts on which the termination rests.
        assert!(radius <= 1e-6 || report.counts.restarts > 0, "{}: {report}", problem.name);
        let certificate = report.certificate.as_ref().unwrap();
        let largest = certificate.active_radius / report.solution.norm().max(f64::MIN_POSITIVE);
        assert!(radius <= largest * (1.0 + 1e-9) || certificate.active_radius == 0.0, "{}: {report}", problem.name);
        assert!(certificate.cuts.iter().any(|cut| cut.point == report.solution), "{}: {report}", problem.name);
        if radius > 1e-6 {
            kept += 1;
            // A limit that ends the second check remains the termination.
            let max_evaluations = report.counts.evaluations - 1;
            let config = BundleTrustConfig { max_evaluations, ..Default::default() };
            let start = Vector::from_column_slice(&problem.start);
            let cut = BundleTrust::new(config).unwrap().minimize(&theta, start).unwrap();
            assert!(matches!(cut.termination, Termination::EvaluationLimit), "{}: {cut}", problem.name);
        }
    }
    assert!(kept >= 2, "{kept}");
}
