//! The bundle method on hostile oracles and awkward admissible sets.

use crate::stability::case::Case;
use crate::stability::oracle::{Exact, Hostile, centre, crescent, largest_square, nearly_parallel, polyhedral};
use crate::stability::record::{CaseOutcome, Record};
use nonsmooth::{BundleTrust, BundleTrustConfig, InputError, Matrix, Polyhedron, VariableScaling, Vector};

const GROUP: &str = "optimizer";
/// Evaluations allowed: no case may hang.
const MAX_EVALUATIONS: usize = 2000;
/// Largest value above the minimum 1 without noise.
const GAP: f64 = 1e-5;
/// Times the noise that the value may be above the minimum.
const NOISE_GAP: f64 = 50.0;

/// A run with a known minimum.
struct OptimizerRun {
    objective: Hostile,
    scaling: VariableScaling,
    set: Option<Polyhedron>,
    start: Vector,
    minimum: f64,
    gap: f64,
}

impl OptimizerRun {
    fn new(exact: Exact, start: Vector) -> Self {
        let objective = Hostile::new(exact, start.len());
        Self { objective, scaling: VariableScaling::FromBox, set: None, start, minimum: 1.0, gap: GAP }
    }

    fn run(&self) -> Record {
        let mut record = Record::default();
        let config =
            BundleTrustConfig { max_evaluations: MAX_EVALUATIONS, scaling: self.scaling.clone(), ..Default::default() };
        let result = BundleTrust::new(config).map_err(Into::into).and_then(|mut method| {
            if let Some(set) = &self.set {
                method = method.constraints(set.clone());
            }
            method.minimize(&self.objective, self.start.clone())
        });
        let report = match result {
            Ok(report) => report,
            Err(error) => {
                record.remark = error.to_string();
                return record;
            }
        };
        let x = report.solution.component_mul(&self.objective.scales);
        let excess = (self.objective.exact)(&x).0 - self.minimum;
        let feasible = self.set.as_ref().is_none_or(|set| set.violation(&report.solution) <= 1e-9);
        record.evaluations = Some(report.counts.evaluations);
        record.remark = format!("{excess:.1e} above the minimum; {}", report.termination);
        if excess.abs() <= self.gap && feasible && report.largest_violation <= 1e-9 {
            record.outcome = CaseOutcome::Solved;
        }
        record
    }
}

fn case(name: impl Into<String>, run: OptimizerRun) -> Case {
    Case::new(GROUP, name, move || run.run())
}

fn refused(name: &'static str, error: impl Fn() -> Result<String, String> + Send + Sync + 'static) -> Case {
    Case::new(GROUP, name, move || match error() {
        Ok(reason) => Record::plain(CaseOutcome::Refused, reason),
        Err(finding) => Record::plain(CaseOutcome::Broken, finding),
    })
}

fn ones(dimension: usize, value: f64) -> Vector {
    Vector::from_element(dimension, value)
}

/// A box around the polyhedral objective's minimiser that cuts half of its entries off, and the minimum over it.
fn cut_box(dimension: usize) -> Result<(Polyhedron, f64), InputError> {
    let lower = Vector::from_fn(dimension, |i, _| if i % 2 == 0 { centre(i) + 0.1 } else { centre(i) - 1.0 });
    let set = Polyhedron::boxed(lower.clone(), Vector::from_fn(dimension, |i, _| centre(i) + 2.0))?;
    let best = Vector::from_fn(dimension, |i, _| centre(i).max(lower[i]));
    Ok((set, polyhedral(&best).0))
}

fn constrained() -> Result<Vec<Case>, InputError> {
    let (set, minimum) = cut_box(10)?;
    let corner = set.lower().clone();
    let edge = Vector::from_fn(10, |i, _| if i < 5 { set.lower()[i] } else { centre(i) + 1.0 });
    let mut cases = Vec::new();
    for (name, start) in
        [("start in a corner of U", corner), ("start on the boundary of U", edge), ("start outside U", ones(10, 100.0))]
    {
        cases
            .push(case(name, OptimizerRun { set: Some(set.clone()), minimum, ..OptimizerRun::new(polyhedral, start) }));
    }
    let point = Vector::from_fn(10, |i, _| centre(i) + 0.5);
    let fixed = Polyhedron::boxed(point.clone(), point.clone())?;
    let minimum = polyhedral(&point).0;
    cases.push(case(
        "U is one point",
        OptimizerRun { set: Some(fixed), minimum, ..OptimizerRun::new(polyhedral, ones(10, 0.0)) },
    ));
    Ok(cases)
}

fn empty_rows() -> Result<Polyhedron, InputError> {
    let rows = Matrix::from_element(1, 3, 1.0);
    Polyhedron::boxed(ones(3, 0.0), ones(3, 1.0))?.with_rows(&rows, &ones(1, -2.0), &ones(1, -1.0))
}

pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        case("nearly parallel cuts", OptimizerRun::new(nearly_parallel, ones(5, 2.0))),
        case("nonconvex crescent", OptimizerRun::new(crescent, Vector::from_vec(vec![-1.0, 2.0]))),
    ];
    for (label, exact) in [("polyhedral", polyhedral as Exact), ("largest square", largest_square)] {
        for (size, scale) in [("1e6", 1e6), ("1e-6", 1e-6)] {
            let mut run = OptimizerRun::new(exact, ones(10, 2.0 / scale));
            run.objective.scales = ones(10, scale);
            cases.push(case(format!("variables × {size}, {label}"), run));
        }
        let scales = Vector::from_fn(10, |i, _| if i % 2 == 0 { 1e6 } else { 1e-6 });
        let mut run = OptimizerRun::new(exact, scales.map(|scale| 2.0 / scale));
        run.scaling = VariableScaling::Typical(scales.map(|scale| 1.0 / scale));
        run.objective.scales = scales;
        cases.push(case(format!("variables scaled 1e6 and 1e-6 in turn, typical sizes given, {label}"), run));
        for exponent in [3, 4, 6, 8, 10] {
            let noise = 10.0_f64.powi(-exponent);
            let mut run = OptimizerRun::new(exact, ones(10, 2.0));
            run.objective.noise = noise;
            run.gap = (NOISE_GAP * noise).max(GAP);
            cases.push(case(format!("noise 1e-{exponent} in value and subgradient, {label}"), run));
        }
        let mut run = OptimizerRun::new(exact, ones(10, 2.0));
        run.objective.failing = Some(10);
        cases.push(case(format!("oracle fails on a tenth of the calls, {label}"), run));
    }
    match constrained() {
        Ok(more) => cases.extend(more),
        Err(error) => cases.push(refused("constrained cases", move || Err(error.to_string()))),
    }
    cases.push(refused("U empty by a row against the box", || {
        let set = empty_rows().map_err(|error| error.to_string())?;
        let mut method = BundleTrust::new(BundleTrustConfig::default()).map_err(|error| error.to_string())?;
        method = method.constraints(set);
        match method.minimize(&Hostile::new(polyhedral, 3), ones(3, 0.5)) {
            Err(error @ nonsmooth::OptimizeError::Infeasible { .. }) => Ok(error.to_string()),
            other => Err(format!("{other:?}")),
        }
    }));
    cases.push(refused("U empty by crossed bounds", || match Polyhedron::boxed(ones(2, 1.0), ones(2, 0.0)) {
        Err(error @ InputError::EmptyInterval { .. }) => Ok(error.to_string()),
        other => Err(format!("{other:?}")),
    }));
    cases
}
