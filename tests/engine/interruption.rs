//! Subproblems hear that nobody waits for them any more: no other evaluation begins, and the best point is kept.

use crate::common::v;
use nonsmooth::composite::{EuclideanNorm, FnOuter, Maximum, OuterFunction, SumOfPowers};
use nonsmooth::interruption::watched;
use nonsmooth::{
    BundleTrust, BundleTrustConfig, CompositeFunction, FnObjective, Matrix, NonsmoothObjective, Polyhedron, Report,
    Termination, Vector,
};
use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;

/// The run whose end is wanted as soon as its first evaluation is done.
fn interrupted(objective: impl FnOnce(Rc<Cell<bool>>) -> Box<dyn Fn(&Polyhedron) -> Report>) -> Report {
    let done = Rc::new(Cell::new(false));
    let set = Polyhedron::boxed(v(&[-5.0, -5.0]), v(&[5.0, 5.0])).unwrap();
    let run = objective(Rc::clone(&done));
    watched(move || done.get(), || run(&set))
}

/// Wants the end from now on, and lets the time pass in which nobody asks again.
fn end(done: &Cell<bool>) {
    done.set(true);
    std::thread::sleep(Duration::from_millis(60));
}

fn minimised(theta: &impl NonsmoothObjective, set: &Polyhedron) -> Report {
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap().constraints(set.clone());
    method.minimize(theta, v(&[-1.2, 1.0])).unwrap()
}

#[test]
fn subproblems_of_every_kind_are_interrupted() {
    let penalty = FnOuter::new(|c: &Vector| {
        let slopes = Vector::from_fn(c.len(), |i, _| f64::from(u8::from(c[i] > 0.0)));
        (slopes.dot(c), slopes)
    });
    let outers: [(&str, Box<dyn OuterFunction>); 6] = [
        ("powers", Box::new(SumOfPowers { exponent: 4.0 })),
        ("squares", Box::new(SumOfPowers { exponent: 2.0 })),
        ("l1", Box::new(SumOfPowers { exponent: 1.0 })),
        ("norm", Box::new(EuclideanNorm)),
        ("maximum", Box::new(Maximum)),
        ("cuts", Box::new(penalty)),
    ];
    for (name, outer) in outers {
        let report = interrupted(|done| {
            Box::new(move |set| {
                let theta = CompositeFunction::new(2, &*outer, |p: &Vector| {
                    end(&done);
                    let outputs = v(&[10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0], p[0] + p[1]]);
                    (outputs, Matrix::from_row_slice(3, 2, &[-20.0 * p[0], 10.0, -1.0, 0.0, 1.0, 1.0]))
                });
                minimised(&theta, set)
            })
        });
        assert_eq!(report.termination, Termination::StoppedByObserver, "{name}");
        assert_eq!((report.counts.evaluations, report.solution), (1, v(&[-1.2, 1.0])), "{name}");
    }
    let report = interrupted(|done| {
        Box::new(move |set| {
            let theta = FnObjective::new(2, |p: &Vector| {
                end(&done);
                (p.abs().sum(), p.map(f64::signum))
            });
            minimised(&theta, set)
        })
    });
    assert_eq!((report.termination, report.counts.evaluations), (Termination::StoppedByObserver, 1));
}

/// The closure takes its time, so that the number of its calls tells when the run has ended.
#[test]
fn a_limit_of_time_holds_inside_a_subproblem() {
    let (n, pause) = (30, Duration::from_millis(20));
    let calls = Cell::new(0);
    let norms = FnOuter::new(|c: &Vector| {
        calls.set(calls.get() + 1);
        std::thread::sleep(pause);
        let lengths = Vector::from_fn(n, |i, _| c.rows(3 * i, 3).norm());
        (lengths.sum(), Vector::from_fn(3 * n, |i, _| c[i] / lengths[i / 3].max(f64::MIN_POSITIVE)))
    });
    let rows = Matrix::from_fn(3 * n, n, |i, k| ((3 * i + 1) as f64 * (0.7 * k as f64 + 0.3)).sin());
    let wanted = Vector::from_fn(3 * n, |i, _| (i as f64).cos());
    let theta = CompositeFunction::new(n, &norms, |x: &Vector| (&rows * x - &wanted, rows.clone()));
    let config = BundleTrustConfig { max_seconds: Some(0.4), ..BundleTrustConfig::default() };
    let report = BundleTrust::new(config).unwrap().minimize(&theta, Vector::zeros(n)).unwrap();
    assert_eq!((report.termination, report.counts.evaluations), (Termination::TimeLimit, 1));
    assert_eq!(report.history.len(), 1);
    // 20 pauses fill the time; some more come from an end in the middle and from the report.
    assert!(calls.get() <= 30, "{}", calls.get());
}
