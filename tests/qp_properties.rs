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
