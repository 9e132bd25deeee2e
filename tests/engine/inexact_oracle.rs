//! Oracles with noise, accuracy on demand, and certified no-descent answers.
use crate::common::{cb3, v};
use nonsmooth::{
    AccuracyPolicy, Answer, BundleTrust, BundleTrustConfig, Convexity, Evaluation, FnObjective, NonsmoothObjective,
    OracleError, Request, StepKind, Termination, Vector,
};
use std::cell::Cell;
use testset::kit::jitter;

fn exact(x: &Vector) -> (f64, Vector) {
    let evaluation = cb3().evaluate(&Request::tight(x)).unwrap().into_evaluation();
    (evaluation.value, evaluation.subgradient)
}

fn noisy(level: f64) -> FnObjective<impl Fn(&Vector) -> (f64, Vector)> {
    FnObjective::new(2, move |x: &Vector| {
        let (value, subgradient) = exact(x);
        (value + level * jitter(x.as_slice(), 0), subgradient)
    })
}

#[test]
fn unannounced_noise_ends_in_a_noise_limit() {
    for convexity in [Convexity::Convex, Convexity::Unknown] {
        for level in [1e-3, 1e-4, 1e-5] {
            let config = BundleTrustConfig { convexity, max_evaluations: 500, ..Default::default() };
            let report = BundleTrust::new(config).unwrap().minimize(&noisy(level), v(&[2.0, 2.0])).unwrap();
            let Termination::NoiseLimit { estimate } = report.termination else {
                panic!("{convexity:?} level {level}: {report}")
            };
            assert!(estimate > 0.05 * level && estimate < 20.0 * level, "level {level}: {report}");
            assert!(report.value - 2.0 < 30.0 * level, "level {level}: {report}");
        }
    }
}

/// Noise of the level asked for, promised in the answer; never below `floor`.
struct OnDemand {
    floor: f64,
    cost: Cell<f64>,
}

impl NonsmoothObjective for OnDemand {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        2
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (value, subgradient) = exact(request.point);
        let accuracy = request.accuracy.tolerance().max(self.floor);
        self.cost.set(self.cost.get() - accuracy.log10());
        let error_bound = accuracy * value;
        let value = value + error_bound * jitter(request.point.as_slice(), 0);
        Ok(Answer::Accurate(Evaluation { error_bound, ..Evaluation::exact(value, subgradient, ()) }))
    }
}

#[test]
fn promised_noise_ends_in_a_noise_limit_of_that_level() {
    let theta = OnDemand { floor: 1e-5, cost: Cell::new(0.0) };
    let report = BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&theta, v(&[2.0, 2.0])).unwrap();
    let Termination::NoiseLimit { estimate } = report.termination else { panic!("{report}") };
    assert!((1e-5..1e-4).contains(&estimate), "{report}");
    assert!(report.value - 2.0 < 1e-3);
}

#[test]
fn accuracy_on_demand_costs_less_and_ends_as_well() {
    let run = |accuracy| {
        let theta = OnDemand { floor: 1e-12, cost: Cell::new(0.0) };
        let config = BundleTrustConfig { accuracy, ..Default::default() };
        let report = BundleTrust::new(config).unwrap().minimize(&theta, v(&[2.0, 2.0])).unwrap();
        assert!(report.value - 2.0 < 1e-6, "{report}");
        assert!(report.termination.is_stationary(), "{report}");
        theta.cost.get()
    };
    let (tight, demand) = (run(AccuracyPolicy::Tightest), run(AccuracyPolicy::ON_DEMAND));
    // The cost is the number of digits: the last digits are bought in both runs, the first ones in one only. One of the
    // two ends takes a second look (second_look.rs): 0.803.
    assert!(demand < 0.85 * tight, "{demand} against {tight}");
}

/// Answers with half the excess over the target wherever the point is no descent.
struct Lazy;

impl NonsmoothObjective for Lazy {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        2
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (value, subgradient) = exact(request.point);
        let evaluation = |value| Evaluation::exact(value, subgradient.clone(), ());
        Ok(match request.descent_target {
            Some(target) if value > target => Answer::NoDescent(evaluation(target + 0.5 * (value - target))),
            _ => Answer::Accurate(evaluation(value)),
        })
    }
}

#[test]
fn no_descent_answers_are_null_steps_only() {
    let report = BundleTrust::new(BundleTrustConfig::default()).unwrap().minimize(&Lazy, v(&[2.0, 2.0])).unwrap();
    assert!(report.value - 2.0 < 1e-5, "{report}");
    assert!(report.history.iter().any(|record| record.kind == StepKind::NoDescent));
    for pair in report.history.windows(2) {
        assert!(pair[1].kind != StepKind::NoDescent || pair[1].center_value == pair[0].center_value);
    }
}
