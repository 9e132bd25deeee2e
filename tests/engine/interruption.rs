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
