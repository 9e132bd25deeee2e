#![allow(missing_docs, clippy::unwrap_used)]
use ConstraintKind::*;
use nonsmooth::composite::*;
use nonsmooth::*;
type F = Box<dyn Fn(&Vector) -> (f64, Vector, Vec<(f64, Vec<f64>)>)>;
struct P {
    name: &'static str,
    x0: Vec<f64>,
    fstar: f64,
    rho: f64,
    kinds: Vec<ConstraintKind>,
    f: F,
}
fn v(x: &[f64]) -> Vector {
    Vector::from_column_slice(x)
}
fn problems() -> Vec<P> {
    let mut ps: Vec<P> = vec![];
    ps.push(P {
        name: "RosenSuzuki",
        x0: vec![0.0; 4],
        fstar: -44.0,
        rho: 10.0,
        kinds: vec![Smooth; 3],
        f: Box::new(|x| {
            let (a, b, c, d) = (x[0], x[1], x[2], x[3]);
            (
                a * a + b * b + 2.0 * c * c + d * d - 5.0 * a - 5.0 * b - 21.0 * c + 7.0 * d,
                v(&[2.0 * a - 5.0, 2.0 * b - 5.0, 4.0 * c - 21.0, 2.0 * d + 7.0]),
                vec![
                    (
                        a * a + b * b + c * c + d * d + a - b + c - d - 8.0,
                        vec![2.0 * a + 1.0, 2.0 * b - 1.0, 2.0 * c + 1.0, 2.0 * d - 1.0],
                    ),
                    (
                        a * a + 2.0 * b * b + c * c + 2.0 * d * d - a - d - 10.0,
                        vec![2.0 * a - 1.0, 4.0 * b, 2.0 * c, 4.0 * d - 1.0],
                    ),
                    (
                        2.0 * a * a + b * b + c * c + 2.0 * a - b - d - 5.0,
                        vec![4.0 * a + 2.0, 2.0 * b - 1.0, 2.0 * c, -1.0],
                    ),
                ],
            )
        }),
    });
    ps.push(P {
        name: "NSRosen",
        x0: vec![-1.2, 1.0],
        fstar: (1.0f64 - 0.5f64.sqrt()).powi(2),
        rho: 10.0,
        kinds: vec![Nonsmooth],
        f: Box::new(|x| {
            let (a, b) = (x[0], x[1]);
            let k = a * a - b;
            let s = if k >= 0.0 { 1.0 } else { -1.0 };
            let (p, q) = (2f64.sqrt() * a - 1.0, 2.0 * b - 1.0);
            (
                8.0 * k.abs() + (1.0 - a).powi(2),
                v(&[8.0 * s * 2.0 * a - 2.0 * (1.0 - a), -8.0 * s]),
                vec![if p >= q { (p, vec![2f64.sqrt(), 0.0]) } else { (q, vec![0.0, 2.0]) }],
            )
        }),
    });
    ps.push(P {
        name: "HS66",
        x0: vec![0.0, 1.05, 2.9],
        fstar: 0.5181632741,
        rho: 10.0,
        kinds: vec![Smooth; 2],
        f: Box::new(|x| {
            (
                0.2 * x[2] - 0.8 * x[0],
                v(&[-0.8, 0.0, 0.2]),
                vec![
                    (x[0].exp() - x[1], vec![x[0].exp(), -1.0, 0.0]),
                    (x[1].exp() - x[2], vec![0.0, x[1].exp(), -1.0]),
                ],
            )
        }),
    });
    ps.push(P {
        name: "HS100",
        x0: vec![1., 2., 0., 4., 0., 1., 1.],
        fstar: 680.6300573,
        rho: 10.0,
        kinds: vec![Smooth; 4],
        f: Box::new(|x| {
            let f = (x[0] - 10.).powi(2)
                + 5. * (x[1] - 12.).powi(2)
                + x[2].powi(4)
                + 3. * (x[3] - 11.).powi(2)
                + 10. * x[4].powi(6)
                + 7. * x[5] * x[5]
                + x[6].powi(4)
                - 4. * x[5] * x[6]
                - 10. * x[5]
                - 8. * x[6];
            let g = v(&[
                2. * (x[0] - 10.),
                10. * (x[1] - 12.),
                4. * x[2].powi(3),
                6. * (x[3] - 11.),
                60. * x[4].powi(5),
                14. * x[5] - 4. * x[6] - 10.,
                4. * x[6].powi(3) - 4. * x[5] - 8.,
            ]);
            (
                f,
                g,
                vec![
                    (
                        2. * x[0] * x[0] + 3. * x[1].powi(4) + x[2] + 4. * x[3] * x[3] + 5. * x[4] - 127.,
                        vec![4. * x[0], 12. * x[1].powi(3), 1., 8. * x[3], 5., 0., 0.],
                    ),
                    (
                        7. * x[0] + 3. * x[1] + 10. * x[2] * x[2] + x[3] - x[4] - 282.,
                        vec![7., 3., 20. * x[2], 1., -1., 0., 0.],
                    ),
                    (
                        23. * x[0] + x[1] * x[1] + 6. * x[5] * x[5] - 8. * x[6] - 196.,
                        vec![23., 2. * x[1], 0., 0., 0., 12. * x[5], -8.],
                    ),
                    (
                        4. * x[0] * x[0] + x[1] * x[1] - 3. * x[0] * x[1] + 2. * x[2] * x[2] + 5. * x[5] - 11. * x[6],
                        vec![8. * x[0] - 3. * x[1], 2. * x[1] - 3. * x[0], 4. * x[2], 0., 0., 5., -11.],
                    ),
                ],
            )
        }),
    });
    ps.push(P {
        name: "HS113",
        x0: vec![2., 3., 5., 5., 1., 2., 7., 3., 6., 10.],
        fstar: 24.3062091,
        rho: 10.0,
        kinds: vec![Smooth; 8],
        f: Box::new(|x| {
            let f = x[0] * x[0] + x[1] * x[1] + x[0] * x[1] - 14. * x[0] - 16. * x[1]
                + (x[2] - 10.).powi(2)
                + 4. * (x[3] - 5.).powi(2)
                + (x[4] - 3.).powi(2)
                + 2. * (x[5] - 1.).powi(2)
                + 5. * x[6] * x[6]
                + 7. * (x[7] - 11.).powi(2)
                + 2. * (x[8] - 10.).powi(2)
                + (x[9] - 7.).powi(2)
                + 45.;
            let g = v(&[
                2. * x[0] + x[1] - 14.,
                2. * x[1] + x[0] - 16.,
                2. * (x[2] - 10.),
                8. * (x[3] - 5.),
                2. * (x[4] - 3.),
                4. * (x[5] - 1.),
                10. * x[6],
                14. * (x[7] - 11.),
                4. * (x[8] - 10.),
                2. * (x[9] - 7.),
            ]);
            (
                f,
                g,
                vec![
                    (
                        -105. + 4. * x[0] + 5. * x[1] - 3. * x[6] + 9. * x[7],
                        vec![4., 5., 0., 0., 0., 0., -3., 9., 0., 0.],
                    ),
                    (10. * x[0] - 8. * x[1] - 17. * x[6] + 2. * x[7], vec![10., -8., 0., 0., 0., 0., -17., 2., 0., 0.]),
                    (
                        -8. * x[0] + 2. * x[1] + 5. * x[8] - 2. * x[9] - 12.,
                        vec![-8., 2., 0., 0., 0., 0., 0., 0., 5., -2.],
                    ),
                    (
                        3. * (x[0] - 2.).powi(2) + 4. * (x[1] - 3.).powi(2) + 2. * x[2] * x[2] - 7. * x[3] - 120.,
                        vec![6. * (x[0] - 2.), 8. * (x[1] - 3.), 4. * x[2], -7., 0., 0., 0., 0., 0., 0.],
                    ),
                    (
                        5. * x[0] * x[0] + 8. * x[1] + (x[2] - 6.).powi(2) - 2. * x[3] - 40.,
                        vec![10. * x[0], 8., 2. * (x[2] - 6.), -2., 0., 0., 0., 0., 0., 0.],
                    ),
                    (
                        0.5 * (x[0] - 8.).powi(2) + 2. * (x[1] - 4.).powi(2) + 3. * x[4] * x[4] - x[5] - 30.,
                        vec![x[0] - 8., 4. * (x[1] - 4.), 0., 0., 6. * x[4], -1., 0., 0., 0., 0.],
                    ),
                    (
                        x[0] * x[0] + 2. * (x[1] - 2.).powi(2) - 2. * x[0] * x[1] + 14. * x[4] - 6. * x[5],
                        vec![2. * x[0] - 2. * x[1], 4. * (x[1] - 2.) - 2. * x[0], 0., 0., 14., -6., 0., 0., 0., 0.],
                    ),
                    (
                        -3. * x[0] + 6. * x[1] + 12. * (x[8] - 8.).powi(2) - 7. * x[9],
                        vec![-3., 6., 0., 0., 0., 0., 0., 0., 24. * (x[8] - 8.), -7.],
                    ),
                ],
            )
        }),
    });
    ps
}
/// The exact penalty as a composite objective: f + rho max(0, c).
struct Pen(f64);
impl OuterFunction for Pen {
    fn value(&self, z: &Vector) -> f64 {
        z[0] + self.0 * z.iter().skip(1).fold(0.0f64, |a, b| a.max(*b))
    }
    fn subgradient(&self, z: &Vector) -> Vector {
        let mut w = Vector::zeros(z.len());
        w[0] = 1.0;
        let m = z.iter().skip(1).fold(0.0f64, |a, b| a.max(*b));
        if m > 0.0 {
            let i = (1..z.len()).find(|&i| z[i] == m).unwrap();
            w[i] = self.0;
        }
        w
    }
}
fn run(p: &P, x0: &[f64], joined: bool, verbose: bool, seps: bool) {
    let n = x0.len();
    let all = |x: &Vector| {
        let (f, g, cs) = (p.f)(x);
        let cs: Vec<_> = if joined { vec![cs.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()] } else { cs };
        (f, g, cs)
    };
    let kinds = if joined { vec![Nonsmooth] } else { p.kinds.clone() };
    let report = if seps {
        let theta = ConstrainedFunction::new(n, kinds, |x: &Vector| {
            let (f, g, cs) = all(x);
            let values = Vector::from_iterator(cs.len(), cs.iter().map(|c| c.0));
            let jacobian = Matrix::from_fn(cs.len(), n, |i, k| cs[i].1[k]);
            (f, g, ConstraintEvaluation::new(values, jacobian))
        });
        BundleTrust::new(BundleTrustConfig { max_evaluations: 500, ..Default::default() })
            .unwrap()
            .minimize(&theta, v(x0))
            .unwrap()
    } else {
        let theta = CompositeFunction::new(n, Pen(p.rho), |x: &Vector| {
            let (f, g, cs) = all(x);
            let outputs = Vector::from_iterator(cs.len() + 1, std::iter::once(f).chain(cs.iter().map(|c| c.0)));
            let jacobian = Matrix::from_fn(cs.len() + 1, n, |i, k| if i == 0 { g[k] } else { cs[i - 1].1[k] });
            (outputs, jacobian)
        });
        BundleTrust::new(BundleTrustConfig { max_evaluations: 500, ..Default::default() })
            .unwrap()
            .minimize(&theta, v(x0))
            .unwrap()
    };
    let (f, _, cs) = all(&report.solution);
    let viol = cs.iter().fold(0.0f64, |a, c| a.max(c.0));
    let t = report.termination.to_string();
    if verbose {
        for r in &report.history {
            let (_, _, _) = ((), (), ());
            println!(
                "  {:3} {:8} {:12} {:?} c {:.9e} pred {:.2e} agg {:.1e} err {:.1e} u {:.1e} len {:.1e}",
                r.evaluation,
                r.kind,
                r.origin,
                r.value,
                r.center_value,
                r.predicted_decrease,
                r.aggregate_norm,
                r.aggregate_error,
                r.weight,
                r.step_length
            );
        }
    }
    println!(
        "{:12} {:6} {:7} ev {:4} f-f* {:+.2e} viol {:+.1e}  {}",
        p.name,
        if joined { "joined" } else { "" },
        if seps { "cuts" } else { "penalty" },
        report.counts.evaluations,
        (f - p.fstar) / p.fstar.abs().max(1.0),
        viol,
        &t[..t.len().min(60)]
    );
}
fn rnd(s: &mut u64) -> f64 {
    *s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    ((*s >> 33) as f64) / (1u64 << 31) as f64 * 2.0 - 1.0
}
fn trust() {
    let mut bad = 0;
    let mut counts = std::collections::BTreeMap::new();
    let mut solved = 0;
    let mut total = 0;
    let mut evs = 0.0;
    for p in problems() {
        for joined in [false, true] {
            for k in 0..20 {
                let mut s = 777 + 31 * k as u64;
                for _ in 0..5 {
                    rnd(&mut s);
                }
                let n = p.x0.len();
                let fs = 10f64.powf((6.0 * rnd(&mut s)).round());
                let cs: Vec<f64> = p.kinds.iter().map(|_| 10f64.powf((6.0 * rnd(&mut s)).round())).collect();
                let big = if k % 3 == 0 {
                    0.0
                } else if k % 3 == 1 {
                    0.1
                } else {
                    1.0
                };
                let x0: Vec<f64> = p.x0.iter().map(|x| x + big * (x.abs() + 1.0) * rnd(&mut s)).collect();
                let kinds = if joined { vec![Nonsmooth] } else { p.kinds.clone() };
                let theta = ConstrainedFunction::new(n, kinds, |x: &Vector| {
                    let (f, g, c) = (p.f)(x);
                    let mut c: Vec<(f64, Vec<f64>)> = c;
                    if joined {
                        c = vec![c.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()];
                    }
                    let values = Vector::from_iterator(c.len(), c.iter().enumerate().map(|(j, c)| cs[j] * c.0));
                    let jacobian = Matrix::from_fn(c.len(), n, |i, k| cs[i] * c[i].1[k]);
                    (fs * f, g * fs, ConstraintEvaluation::new(values, jacobian))
                });
                let report = BundleTrust::new(BundleTrustConfig { max_evaluations: 500, ..Default::default() })
                    .unwrap()
                    .minimize(&theta, v(&x0))
                    .unwrap();
                let (f, _, c) = (p.f)(&report.solution);
                let viol = c.iter().fold(0.0f64, |a, c| a.max(c.0));
                let err = (f - p.fstar) / p.fstar.abs().max(1.0);
                let conf = report.termination.is_confirmed();
                let ok = err.abs() < 1e-6 && viol < 1e-7;
                total += 1;
                if ok {
                    solved += 1;
                    evs += (report.counts.evaluations as f64).ln();
                }
                let t = report.termination.to_string();
                *counts.entry((ok, t.split(':').next().unwrap().chars().take(40).collect::<String>())).or_insert(0) +=
                    1;
                if conf && !ok {
                    bad += 1;
                    println!(
                        "FALSE {} joined {joined} k {k} fs {fs:e} cs {cs:?} err {err:e} viol {viol:e} ev {}",
                        p.name, report.counts.evaluations
                    );
                } else if !ok {
                    println!(
                        "miss {} joined {joined} k {k} fs {fs:e} cs {cs:?} err {err:e} viol {viol:e} ev {} {}",
                        p.name,
                        report.counts.evaluations,
                        &t[..t.len().min(50)]
                    );
                }
            }
        }
    }
    println!("{solved} of {total}, false {bad}, geo {:.1}", (evs / solved as f64).exp());
    for (k, v) in counts {
        println!("{k:?} {v}");
    }
}
fn odd() {
    // Infeasible: x^2 + 1 <= 0 style, two discs apart, |x| + 1 <= 0; degenerate: x^2 <= 0, (x^3 - y <= 0, y <= 0).
    let cfg = || BundleTrustConfig { max_evaluations: 300, ..Default::default() };
    let mut go = |name: &str,
                  n: usize,
                  kinds: Vec<ConstraintKind>,
                  f: &dyn Fn(&Vector) -> (f64, Vector, ConstraintEvaluation)| {
        for k in 0..4 {
            let mut s = 5 + k as u64;
            for _ in 0..5 {
                rnd(&mut s);
            }
            let x0 = Vector::from_fn(n, |_, _| 3.0 * rnd(&mut s));
            let theta = ConstrainedFunction::new(n, kinds.clone(), |x: &Vector| f(x));
            let r = BundleTrust::new(cfg()).unwrap().minimize(&theta, x0).unwrap();
            let c = f(&r.solution).2.values;
            println!(
                "{name:14} ev {:4} f {:+.4e} c {:?} {}",
                r.counts.evaluations,
                r.value,
                c.as_slice().iter().map(|c| (c * 1e9).round() / 1e9).collect::<Vec<_>>(),
                r.termination
            );
        }
    };
    let ce = |vals: &[f64], rows: &[f64], n: usize| {
        ConstraintEvaluation::new(v(vals), Matrix::from_row_slice(vals.len(), n, rows))
    };
    go("parabola", 1, vec![Smooth], &|x| (x[0], v(&[1.0]), ce(&[x[0] * x[0] + 1.0], &[2.0 * x[0]], 1)));
    go("discs", 2, vec![Smooth; 2], &|x| {
        (
            x[0] + x[1],
            v(&[1.0, 1.0]),
            ce(
                &[x[0] * x[0] + x[1] * x[1] - 1.0, (x[0] - 3.0).powi(2) + x[1] * x[1] - 1.0],
                &[2.0 * x[0], 2.0 * x[1], 2.0 * (x[0] - 3.0), 2.0 * x[1]],
                2,
            ),
        )
    });
    go("l1", 2, vec![Nonsmooth], &|x| {
        (x[0] * x[0], v(&[2.0 * x[0], 0.0]), ce(&[x[0].abs() + x[1].abs() + 1.0], &[x[0].signum(), x[1].signum()], 2))
    });
    go("eq infeasible", 2, vec![SmoothEquality], &|x| {
        (x[0], v(&[1.0, 0.0]), ce(&[x[0] * x[0] + x[1] * x[1] + 2.0], &[2.0 * x[0], 2.0 * x[1]], 2))
    });
    go("x^2<=0", 1, vec![Smooth], &|x| (x[0], v(&[1.0]), ce(&[x[0] * x[0]], &[2.0 * x[0]], 1)));
    go("cusp", 2, vec![Smooth; 2], &|x| {
        (
            -x[0],
            v(&[-1.0, 0.0]),
            ce(&[x[1] - (1.0 - x[0]).powi(3), -x[1]], &[3.0 * (1.0 - x[0]).powi(2), 1.0, 0.0, -1.0], 2),
        )
    });
    go("tangent discs", 2, vec![Smooth; 2], &|x| {
        (
            x[1],
            v(&[0.0, 1.0]),
            ce(
                &[x[0] * x[0] + x[1] * x[1] - 1.0, (x[0] - 2.0).powi(2) + x[1] * x[1] - 1.0],
                &[2.0 * x[0], 2.0 * x[1], 2.0 * (x[0] - 2.0), 2.0 * x[1]],
                2,
            ),
        )
    });
    go("circle eq", 2, vec![SmoothEquality], &|x| {
        (x[0] + 2.0 * x[1], v(&[1.0, 2.0]), ce(&[x[0] * x[0] + x[1] * x[1] - 5.0], &[2.0 * x[0], 2.0 * x[1]], 2))
    });
    go("circle 2eq", 3, vec![SmoothEquality; 2], &|x| {
        (
            x[0].abs() + x[2],
            v(&[x[0].signum(), 0.0, 1.0]),
            ce(
                &[x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - 5.0, x[0] - x[1]],
                &[2.0 * x[0], 2.0 * x[1], 2.0 * x[2], 1.0, -1.0, 0.0],
                3,
            ),
        )
    });
    go("outside disc", 2, vec![Smooth], &|x| {
        (
            x[0] * x[0] + 2.0 * x[1] * x[1],
            v(&[2.0 * x[0], 4.0 * x[1]]),
            ce(&[1.0 - x[0] * x[0] - x[1] * x[1]], &[-2.0 * x[0], -2.0 * x[1]], 2),
        )
    });
    go("redundant", 2, vec![Smooth; 3], &|x| {
        (
            x[0] + x[1],
            v(&[1.0, 1.0]),
            ce(
                &[
                    x[0] * x[0] + x[1] * x[1] - 2.0,
                    2.0 * (x[0] * x[0] + x[1] * x[1]) - 4.0,
                    x[0].exp() * (x[0] * x[0] + x[1] * x[1] - 2.0),
                ],
                &{
                    let e = x[0].exp();
                    let q = x[0] * x[0] + x[1] * x[1] - 2.0;
                    [2.0 * x[0], 2.0 * x[1], 4.0 * x[0], 4.0 * x[1], e * (q + 2.0 * x[0]), e * 2.0 * x[1]]
                },
                2,
            ),
        )
    });
}
/// h composed of the objective's own outer function and the exact penalty.
struct PenOuter(testset::Outer, usize, f64, Vec<ConstraintKind>);
impl OuterFunction for PenOuter {
    fn value(&self, z: &Vector) -> f64 {
        self.0.evaluate(&z.as_slice()[..self.1]).0
            + self.2 * z.iter().skip(self.1).zip(&self.3).fold(0.0f64, |a, (b, k)| a.max(k.violation(*b)))
    }
    fn subgradient(&self, z: &Vector) -> Vector {
        let mut w = self.0.evaluate(&z.as_slice()[..self.1]).1;
        w.resize(z.len(), 0.0);
        let (mut m, mut at) = (0.0, None);
        for (j, k) in self.3.iter().enumerate() {
            let v = k.violation(z[self.1 + j]);
            if v > m {
                m = v;
                at = Some(j);
            }
        }
        if let Some(j) = at {
            w[self.1 + j] = self.2 * if z[self.1 + j] > 0.0 { 1.0 } else { -1.0 };
        }
        Vector::from_vec(w)
    }
}
struct Wrapped<'a>(&'a testset::constrained::ConstrainedProblem, Option<OwnOuter>, Vec<ConstraintKind>);
struct OwnOuter(testset::Outer);
impl OuterFunction for OwnOuter {
    fn value(&self, z: &Vector) -> f64 {
        self.0.evaluate(z.as_slice()).0
    }
    fn subgradient(&self, z: &Vector) -> Vector {
        Vector::from_vec(self.0.evaluate(z.as_slice()).1)
    }
}
impl NonsmoothObjective for Wrapped<'_> {
    type WarmStart = ();
    fn dimension(&self) -> usize {
        self.0.dimension
    }
    fn outer(&self) -> Option<&dyn OuterFunction> {
        self.1.as_ref().map(|o| o as &dyn OuterFunction)
    }
    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.2
    }
    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let x = request.point.as_slice();
        let found = self.0.evaluate(x);
        let n = x.len();
        let c = &found.constraints;
        let constraints = ConstraintEvaluation::new(
            Vector::from_iterator(c.len(), c.iter().map(|c| c.0)),
            Matrix::from_fn(c.len(), n, |i, k| c[i].1[k]),
        );
        let (outputs, rows) = self.0.composition().linearize(x);
        let linearization = if self.1.is_some() {
            Linearized::if_asked(
                request.linearization,
                Linearization {
                    jacobian: Matrix::from_fn(outputs.len(), n, |i, k| rows[i][k]),
                    outputs: Vector::from_vec(outputs),
                    accuracy: 0.0,
                    inactive: None,
                },
            )
        } else {
            Linearized::NotAsked
        };
        Ok(Answer::Accurate(Evaluation {
            linearization,
            constraints: Some(constraints),
            ..Evaluation::exact(found.value, Vector::from_vec(found.subgradient), ())
        }))
    }
}
fn kinds_of(p: &testset::constrained::ConstrainedProblem) -> Vec<ConstraintKind> {
    p.kinds
        .iter()
        .map(|k| match k {
            testset::constrained::Kind::Nonsmooth => Nonsmooth,
            testset::constrained::Kind::Smooth => Smooth,
            testset::constrained::Kind::SmoothEquality => SmoothEquality,
        })
        .collect()
}
fn coll() {
    let only = std::env::args().nth(2).unwrap_or_default();
    let verbose = std::env::args().nth(3).is_some();
    let (mut logs, mut solved, mut total, mut false_, mut ratio, mut both) = (0.0, 0, 0, 0, 0.0, 0);
    for p in testset::constrained::all()
        .into_iter()
        .flat_map(|p| [p.joined(), p])
        .filter(|p| only.is_empty() || p.name == only || (only == "single" && !p.name.ends_with("Joined")))
    {
        let set = Polyhedron::boxed(v(&p.lower), v(&p.upper)).unwrap();
        let limit = 1000;
        let judge = |x: &Vector| {
            let f = p.evaluate(x.as_slice()).value;
            let best = std::iter::once(p.optimum)
                .chain(p.other_optima.iter().copied())
                .map(|o| (f - o) / o.abs().max(1.0))
                .min_by(|a, b| a.abs().total_cmp(&b.abs()))
                .unwrap();
            (best, p.violation(x.as_slice()))
        };
        let mut line = format!("{:26} n {:3} m {:2}", p.name, p.dimension, p.kinds.len());
        let mut counts = [0usize; 3];
        for mode in 0..3 {
            let config = BundleTrustConfig { max_evaluations: limit, ..Default::default() };
            let report = if mode < 2 {
                let plain = p.composition().outer().clone();
                let theta = Wrapped(&p, (mode == 0).then(|| OwnOuter(plain)), kinds_of(&p));
                BundleTrust::new(config).unwrap().constraints(set.clone()).minimize(&theta, v(&p.start))
            } else {
                let m0 = p.composition().linearize(&p.start).0.len();
                let theta = CompositeFunction::new(
                    p.dimension,
                    PenOuter(p.composition().outer().clone(), m0, p.penalty, kinds_of(&p)),
                    |x: &Vector| {
                        let found = p.evaluate(x.as_slice());
                        let (outputs, rows) = p.composition().linearize(x.as_slice());
                        let n = x.len();
                        let z: Vec<f64> =
                            outputs.iter().copied().chain(found.constraints.iter().map(|c| c.0)).collect();
                        let all: Vec<Vec<f64>> =
                            rows.into_iter().chain(found.constraints.into_iter().map(|c| c.1)).collect();
                        (Vector::from_vec(z), Matrix::from_fn(all.len(), n, |i, k| all[i][k]))
                    },
                );
                BundleTrust::new(config).unwrap().constraints(set.clone()).minimize(&theta, v(&p.start))
            };
            match report {
                Ok(r) => {
                    if verbose && mode == 0 {
                        for r in &r.history {
                            println!(
                                "  {:3} {:8} {:12} {:?} c {:.9e} pred {:.2e} agg {:.1e} err {:.1e} u {:.1e} len {:.1e}",
                                r.evaluation,
                                r.kind,
                                r.origin,
                                r.value,
                                r.center_value,
                                r.predicted_decrease,
                                r.aggregate_norm,
                                r.aggregate_error,
                                r.weight,
                                r.step_length
                            );
                        }
                        println!("{r}");
                    }
                    let (e, viol) = judge(&r.solution);
                    let ok = e.abs() <= 1e-6 && (viol <= 1e-7 || mode == 2 && viol < 1e-5);
                    let conf = r.termination.is_confirmed();
                    if mode == 0 {
                        total += 1;
                        solved += usize::from(ok);
                        false_ += usize::from(conf && !ok);
                        if ok {
                            logs += (r.counts.evaluations as f64).ln();
                        }
                    }
                    if ok {
                        counts[mode] = r.counts.evaluations;
                    }
                    let t = r.termination.to_string();
                    line += &format!(
                        " | {} {:4} {:+.0e} {:.0e}{}{}",
                        if ok { "ok  " } else { "MISS" },
                        r.counts.evaluations,
                        e,
                        viol,
                        if conf { " conf" } else { "" },
                        if ok { String::new() } else { format!(" {}", &t[..t.len().min(38)]) }
                    );
                }
                Err(e) => {
                    line += &format!(" | ERROR {e}");
                    if mode == 0 {
                        total += 1;
                    }
                }
            }
        }
        if counts[0] > 0 && counts[2] > 0 {
            ratio += (counts[0] as f64 / counts[2] as f64).ln();
            both += 1;
        }
        println!("{line}");
    }
    println!(
        "{solved} of {total}, false {false_}, geo {:.1}, ratio to the penalty {:.2} over {both}",
        (logs / solved as f64).exp(),
        (ratio / both as f64).exp()
    );
}
fn main() {
    if std::env::args().nth(1).as_deref() == Some("coll") {
        return coll();
    }
    if std::env::args().nth(1).as_deref() == Some("trust") {
        return trust();
    }
    if std::env::args().nth(1).as_deref() == Some("odd") {
        return odd();
    }
    let args: Vec<String> = std::env::args().collect();
    for p in problems() {
        if args.len() > 1 && !p.name.starts_with(&args[1]) {
            continue;
        }
        for joined in [false, true] {
            for seps in [false, true] {
                run(&p, &p.x0, joined, args.len() > 2, seps);
                for k in 0..10usize {
                    if args.len() > 2 && args[2] != k.to_string() {
                        continue;
                    }
                    let mut s = 12345u64 + 977 * k as u64;
                    let mut rnd = || {
                        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                        ((s >> 33) as f64) / (1u64 << 31) as f64 * 2.0 - 1.0
                    };
                    let big = if k < 5 { 0.1 } else { 1.0 };
                    let x0: Vec<f64> = p.x0.iter().map(|x| x + big * (x.abs() + 1.0) * rnd()).collect();
                    run(&p, &x0, joined, args.len() > 2, seps);
                }
            }
        }
    }
}
