//! Properties of the QP solver on random problems; see `tests/common/qps.rs` for their kinds.

#[path = "common/qps.rs"]
mod qps;

use nonsmooth::qp::EpigraphQpSolver;
use qps::{Shape, random_qp};

#[test]
#[ignore = "survey for the log, not a proof"]
fn survey() {
    let mut histogram = [0usize; 20];
    let (mut fallbacks, mut errors) = (0, 0);
    for seed in 0..3000u64 {
        let shape =
            Shape { dimension: 1 + (seed % 37) as usize, cuts: 1 + (seed % 61) as usize, rows: (seed % 53) as usize };
        let qp = random_qp(seed, shape);
        let mut solver = EpigraphQpSolver::new();
        match solver.solve(&qp.view()) {
            Ok(solution) => {
                let digits = -solution.kkt_residual.max(1e-19).log10();
                histogram[digits as usize] += 1;
                if digits < 12.0 {
                    println!("seed {seed} {shape:?} {:?} {:e}", solution.method, solution.kkt_residual);
                }
            }
            Err(error) => {
                errors += 1;
                println!("seed {seed} {shape:?}: {error}");
            }
        }
        if solver.counts().fallbacks > 0 {
            println!("fallback seed {seed} {shape:?}");
        }
        fallbacks += solver.counts().fallbacks;
    }
    println!("fallbacks {fallbacks}, errors {errors}, digits {histogram:?}");
}

#[test]
#[ignore = "debug"]
fn extremes() {
    use qps::{Numbers, OwnedMetric, OwnedQp};
    use nonsmooth::Vector;
    let mut table: std::collections::BTreeMap<String, (usize, usize, usize, f64, usize)> = Default::default();
    let mut note = |label: String, qp: &OwnedQp, seed: u64| {
        let mut solver = EpigraphQpSolver::new();
        let result = solver.solve(&qp.view());
        let entry = table.entry(label.clone()).or_insert((0, 0, 0, 0.0, 0));
        entry.0 += 1;
        entry.1 += solver.counts().fallbacks;
        entry.4 += solver.counts().pivots;
        match result {
            Ok(s) => { if s.kkt_residual > 1e-12 { println!("{label} seed {seed} kkt {:e} {:?}", s.kkt_residual, s.method); } entry.3 = entry.3.max(s.kkt_residual) }
            Err(e) => { entry.2 += 1; if entry.2 < 4 { println!("{label} seed {seed}: {e}"); } }
        }
    };
    for seed in 0..400u64 {
        for power in [-12, -9, -6, 6, 9, 12] {
            let shape = Shape { dimension: 1 + (seed % 37) as usize, cuts: 1 + (seed % 61) as usize, rows: (seed % 53) as usize };
            let mut qp = random_qp(seed, shape);
            let f = 10f64.powi(power);
            match &mut qp.metric { OwnedMetric::ScaledIdentity(w) => *w *= f, OwnedMetric::Diagonal(d) => *d *= f, OwnedMetric::Dense(m) => *m *= f }
            note(format!("weight {power:+}"), &qp, seed);
            // no box, no rows
            let n = shape.dimension;
            let mut free = OwnedQp::free(1.0, qp.slopes.clone(), qp.offsets.clone());
            free.metric = qp.metric.clone();
            note(format!("free weight {power:+}"), &free, seed);
            let mut lp = qp.clone();
            lp.lower = Vector::from_element(n, -1.0); lp.upper = Vector::from_element(n, 1.0);
            lp.rows = lp.rows * 0.0;
            lp.row_lower.fill(-1.0); lp.row_upper.fill(1.0);
            note(format!("box weight {power:+}"), &lp, seed);
        }
        // clusters 1e-8 in three dimensions
        for spread in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14] {
            let mut r = Numbers(seed);
            let centres: Vec<Vector> = (0..5).map(|_| r.vector(3)).collect();
            let slopes: Vec<Vector> = (0..80).map(|j| &centres[j % 5] + r.vector(3) * spread).collect();
            let offsets: Vec<f64> = (0..80).map(|_| 0.1 + spread * r.signed()).collect();
            note(format!("cluster {spread:e}"), &OwnedQp::free(1.0, slopes, offsets), seed);
            // smooth point: slopes g + H (y-x), errors quadratic
            let g = r.vector(10);
            let ys: Vec<Vector> = (0..40).map(|_| r.vector(10) * spread).collect();
            let slopes: Vec<Vector> = ys.iter().map(|y| &g * 1e-3 + y).collect();
            let offsets: Vec<f64> = ys.iter().map(|y| 0.5 * y.norm_squared()).collect();
            note(format!("smooth {spread:e}"), &OwnedQp::free(1.0, slopes.clone(), offsets.clone()), seed);
            note(format!("smooth small weight {spread:e}"), &OwnedQp::free(1e-8, slopes, offsets), seed);
            let slopes: Vec<Vector> = ys.iter().enumerate().map(|(j, y)| y / spread * if j % 3 == 0 { 1.0 / spread.sqrt() } else { 1.0 }).collect();
            let offsets: Vec<f64> = ys.iter().map(|y| 0.5 * y.norm_squared()).collect();
            note(format!("steep {spread:e}"), &OwnedQp::free(1.0, slopes, offsets), seed);
        }
    }
    for (k, v) in table { println!("{k:28} runs {} fallbacks {} errors {} worst kkt {:.1e} pivots/run {}", v.0, v.1, v.2, v.3, v.4 / v.0); }
}
