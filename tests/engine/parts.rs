//! Maxima of smooth functions of outputs: Newton's method on all parts against cuts of the maximum.

use nonsmooth::composite::{FnOuter, OuterFunction, OuterPart, SumOfPowers};
use nonsmooth::verify::seeded_direction;
use nonsmooth::{BundleTrust, BundleTrustConfig, CompositeFunction, Matrix, Report, Vector};

/// max_k Σ c_i⁴ over consecutive groups of four outputs, with or without its parts.
struct WorstGroup;

const GROUP: usize = 4;
const POWERS: SumOfPowers = SumOfPowers { exponent: 4.0 };

impl WorstGroup {
    fn group(outputs: &Vector, k: usize) -> Vector {
        outputs.rows(GROUP * k, GROUP).into_owned()
    }

    fn part(outputs: &Vector, k: usize) -> OuterPart {
        let own = Self::group(outputs, k);
        let mut gradient = Vector::zeros(outputs.len());
        gradient.rows_mut(GROUP * k, GROUP).copy_from(&POWERS.subgradient(&own));
        OuterPart { value: POWERS.value(&own), gradient }
    }

    fn worst(outputs: &Vector) -> OuterPart {
        let parts = (0..outputs.len() / GROUP).map(|k| Self::part(outputs, k));
        parts.reduce(|most, next| if next.value > most.value { next } else { most }).expect("some groups")
    }
}

impl OuterFunction for WorstGroup {
    fn value(&self, outputs: &Vector) -> f64 {
        Self::worst(outputs).value
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        Self::worst(outputs).gradient
    }

    fn parts(&self, outputs: &Vector) -> Vec<OuterPart> {
        (0..outputs.len() / GROUP).map(|k| Self::part(outputs, k)).collect()
    }

    fn parts_curvature(&self, outputs: &Vector, jacobian: &Matrix, weights: &[f64]) -> Option<Matrix> {
        let curvature = |(k, weight): (usize, &f64)| {
            let rows = jacobian.rows(GROUP * k, GROUP).into_owned();
            POWERS.curvature(&Self::group(outputs, k), &rows).map(|own| own * *weight)
        };
        weights.iter().enumerate().map(curvature).collect::<Option<Vec<_>>>()?.into_iter().reduce(|a, b| a + b)
    }
}

/// Outputs b + A x + ½ sin(x) of three groups.
fn outputs(seed: u64) -> impl Fn(&Vector) -> (Vector, Matrix) {
    let (m, n) = (3 * GROUP, 5);
    let entries = seeded_direction(m * n, seed);
    let matrix = Matrix::from_fn(m, n, |i, j| 3.0 * entries[i * n + j]);
    let offset = seeded_direction(m, seed + 100) * 2.0;
    move |x: &Vector| {
        let bent = Vector::from_fn(m, |i, _| 0.5 * x[i % n].sin());
        let slope = Matrix::from_fn(m, n, |i, j| if i % n == j { 0.5 * x[j].cos() } else { 0.0 });
        (&offset + &matrix * x + bent, &matrix + slope)
    }
}

fn minimized(outer: impl OuterFunction, seed: u64) -> Report {
    let theta = CompositeFunction::new(5, outer, outputs(seed));
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap();
    method.minimize(&theta, Vector::from_element(5, 0.3)).unwrap()
}

#[test]
fn both_ways_lead_to_one_optimum_and_its_proof_holds() {
    let mut active = 0;
    for seed in 1..=8 {
        let parts = minimized(WorstGroup, seed);
        let cuts = minimized(FnOuter::new(|c: &Vector| (WorstGroup.value(c), WorstGroup.subgradient(c))), seed);
        for report in [&parts, &cuts] {
            assert!(report.termination.is_confirmed(), "{seed}: {report}");
        }
        assert!((parts.value - cuts.value).abs() < 1e-6 * cuts.value, "{seed}: {parts} {cuts}");
        let certificate = parts.certificate.as_ref().unwrap();
        let Some(proof) = &certificate.composite else { continue };
        let check = proof.recheck(certificate, &WorstGroup).unwrap();
        assert!(check.largest() < 1e-9, "{seed}: {check:?}");
        active += usize::from(proof.cuts.len() > 1);
    }
    // Several groups are active at most optima.
    assert!(active >= 4, "{active}");
}
