//! How counts and times grow with the number of subdomains at fixed H/h.

use crate::rates::exponent;
use crate::scaling::cases::{RATIO, SceneName, Variant};
use crate::scaling::rows::{ScalingRow, Start};
use clap::ValueEnum;
use serde::Serialize;

/// Growth of one solver at H/h = 7, without clusters.
#[derive(Debug, Clone, Serialize)]
pub struct Growth {
    /// Scene whose rows are compared.
    pub scene: SceneName,
    /// Contact solver whose rows are compared.
    pub variant: Variant,
    /// Least-squares slope of log(seconds of cold state and subgradient) over log(dofs).
    pub cold_exponent: Option<f64>,
    /// `cold_exponent` over the cases from s = 3 on, where fixed costs are a smaller share.
    pub cold_exponent_large: Option<f64>,
    /// Least-squares slope of log(seconds of warm state and subgradient) over log(dofs), all s.
    pub warm_exponent: Option<f64>,
    /// Cold counts per tolerance and their growth.
    pub counts: Vec<CountGrowth>,
}

/// Products with F of a cold state, relative to s = 3.
#[derive(Debug, Clone, Serialize)]
pub struct CountGrowth {
    /// Relative residual of the states.
    pub tolerance: f64,
    /// s and count(s) / count(3) − 1, per s > 3.
    pub growth: Vec<(usize, f64)>,
}

/// Tolerances whose counts are compared.
const TOLERANCES: [f64; 3] = [1e-6, 1e-8, 1e-10];
/// s that the others are compared with.
const REFERENCE: usize = 3;

impl Growth {
    /// Growth per variant, where at least two rows have H/h = 7.
    pub fn of(rows: &[ScalingRow]) -> Vec<Self> {
        let series = |variant: &Variant| -> Vec<&ScalingRow> {
            let alike = |row: &&ScalingRow| row.variant == *variant && row.case.ratio() == RATIO && row.clusters == 1;
            rows.iter().filter(alike).collect()
        };
        let all = Variant::value_variants().iter().map(series);
        all.filter(|series| series.len() > 1).map(|series| Self::of_series(&series)).collect()
    }

    fn of_series(series: &[&ScalingRow]) -> Self {
        let cold = |row: &&ScalingRow| Some([row.dofs as f64, row.cold.seconds()]);
        let warm = |row: &&ScalingRow| row.warm.as_ref().map(|warm| [row.dofs as f64, warm.seconds()]);
        let large = |row: &&&ScalingRow| row.case.subdomains >= REFERENCE;
        Self {
            scene: series[0].scene,
            variant: series[0].variant,
            cold_exponent: exponent(series.iter().filter_map(cold)),
            cold_exponent_large: exponent(series.iter().filter(large).filter_map(cold)),
            warm_exponent: exponent(series.iter().filter_map(warm)),
            counts: TOLERANCES.iter().map(|&tolerance| count_growth(series, tolerance)).collect(),
        }
    }
}

fn count_growth(series: &[&ScalingRow], tolerance: f64) -> CountGrowth {
    let counts: Vec<(usize, f64)> = series
        .iter()
        .filter_map(|row| Some((row.case.subdomains, row.solve(Start::Cold, tolerance)?.applications() as f64)))
        .collect();
    let reference = counts.iter().find(|(s, count)| *s == REFERENCE && *count > 0.0);
    let growth = reference.map_or_else(Vec::new, |(_, reference)| {
        counts.iter().filter(|(s, _)| *s > REFERENCE).map(|(s, count)| (*s, count / reference - 1.0)).collect()
    });
    CountGrowth { tolerance, growth }
}
