//! Linear rows as linear programs have them: redundant, dependent, of signs, of networks, of dynamics, twice; with
//! bounds, from inside and outside. What the sets hold is known from the point that they are built around.

use crate::common::is_study;
use nonsmooth::qp::project;
use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, Matrix, OptimizeError, Polyhedron, Termination, Vector};

/// Numbers without pattern in [0, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize % count
    }

    fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Redundant,
    Signs,
    Network,
    Dynamics,
    Twice,
}

const KINDS: [Kind; 5] = [Kind::Redundant, Kind::Signs, Kind::Network, Kind::Dynamics, Kind::Twice];

fn rows(kind: Kind, numbers: &mut Numbers, n: usize) -> Matrix {
    let count = 1 + numbers.below(n.div_ceil(2));
    match kind {
        Kind::Redundant => {
            let own = Matrix::from_fn(count, n, |_, _| numbers.signed());
            let more = 1 + numbers.below(count);
            let mixed = Matrix::from_fn(more, count, |_, _| (3.0 * numbers.signed()).round()) * &own;
            Matrix::from_fn(count + more, n, |i, j| if i < count { own[(i, j)] } else { mixed[(i - count, j)] })
        }
        Kind::Signs => Matrix::from_fn(1 + numbers.below(n - 1), n, |_, _| numbers.below(3) as f64 - 1.0),
        Kind::Network => {
            let nodes = 2 + numbers.below(n.div_ceil(2)).min(n - 1);
            let mut rows = Matrix::zeros(nodes, n);
            for arc in 0..n {
                let (from, by) = (numbers.below(nodes), 1 + numbers.below(nodes - 1));
                rows[(from, arc)] = 1.0;
                rows[((from + by) % nodes, arc)] = -1.0;
            }
            rows
        }
        // Place and speed of a body under forces: x' = x + h s + h² f/2, s' = s + h f; both ends are given.
        Kind::Dynamics => {
            let (steps, h) = ((n - 2) / 3, 0.1 + numbers.next());
            let mut rows = Matrix::zeros(2 * steps + 4, n);
            for t in 0..steps {
                for (column, entry) in [(0, 1.0), (1, h), (2, 0.5 * h * h), (3, -1.0)] {
                    rows[(2 * t, 3 * t + column)] = entry;
                }
                for (column, entry) in [(1, 1.0), (2, h), (4, -1.0)] {
                    rows[(2 * t + 1, 3 * t + column)] = entry;
                }
            }
            for (k, column) in [0, 1, 3 * steps, 3 * steps + 1].into_iter().enumerate() {
                rows[(2 * steps + k, column)] = 1.0;
            }
            rows
        }
        Kind::Twice => {
            let own = Matrix::from_fn(count, n, |_, _| if numbers.next() < 0.4 { numbers.signed() } else { 0.0 });
            let copies: Vec<(usize, f64)> =
                (0..count).map(|_| (numbers.below(count), if numbers.next() < 0.5 { 1.0 } else { -2.3 })).collect();
            Matrix::from_fn(2 * count, n, |i, j| match i.checked_sub(count) {
                None => own[(i, j)],
                Some(copy) => copies[copy].1 * own[(copies[copy].0, j)],
            })
        }
    }
}

/// A set around a point; many entries of the point lie at bounds.
fn set(kind: Kind, numbers: &mut Numbers, n: usize) -> (Polyhedron, Vector) {
    let rows = rows(kind, numbers, n);
    let (whole, bounds) = (numbers.next() < 0.5, numbers.below(3));
    let point = Vector::from_fn(n, |_, _| {
        let value = 3.0 * numbers.signed();
        let value = if whole { value.round() } else { value };
        match bounds {
            0 => value,
            _ if numbers.next() < 0.4 => 0.0,
            _ => value.abs(),
        }
    });
    let lower = Vector::from_element(n, if bounds > 0 { 0.0 } else { f64::NEG_INFINITY });
    let upper = Vector::from_fn(n, |i, _| match bounds {
        2 if numbers.next() < 0.3 => point[i],
        2 => point[i] + 5.0 * numbers.next(),
        _ => f64::INFINITY,
    });
    let sides = &rows * &point;
    let set = Polyhedron::boxed(lower, upper).unwrap().with_rows(&rows, &sides, &sides).unwrap();
    (set, point)
}

/// Largest violation of rows and bounds relative to 1 and the sizes of point and side.
fn violation(set: &Polyhedron, x: &Vector) -> f64 {
    let values = set.rows() * x;
    let rows = values.iter().zip(set.row_lower().iter().zip(set.row_upper().iter()));
    let bounds = x.iter().zip(set.lower().iter().zip(set.upper().iter()));
    let excess = |(value, (lower, upper)): (&f64, (&f64, &f64))| (lower - value).max(value - upper).max(0.0);
    rows.chain(bounds).map(excess).fold(0.0, f64::max) / (1.0 + x.amax())
}

#[test]
fn no_set_around_a_point_is_called_empty() {
    let (count, least, most) = if is_study() { (2000_u64, 5.0, 200.0) } else { (500, 5.0, 30.0) };
    for seed in 0..count {
        let mut numbers = Numbers(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 77);
        let kind = KINDS[seed as usize % KINDS.len()];
        let n = (least * f64::powf(most / least, numbers.next())) as usize;
        let (set, point) = set(kind, &mut numbers, n);
        let start = match numbers.below(3) {
            0 => Vector::zeros(n),
            1 => point,
            _ => Vector::from_fn(n, |_, _| 4.0 * numbers.signed()),
        };
        let nearest = project(&set, &start).unwrap_or_else(|error| panic!("{seed} {kind:?}: {error}"));
        assert!(violation(&set, &nearest) < 1e-9, "{seed} {kind:?}");
        let goal = Vector::from_fn(n, |_, _| 2.0 * numbers.signed());
        let theta = FnObjective::new(n, |x: &Vector| {
            let away = x - &goal;
            (away.lp_norm(1), away.map(|d| if d == 0.0 { 0.0 } else { d.signum() }))
        });
        let config = BundleTrustConfig { max_evaluations: 40, ..BundleTrustConfig::default() };
        let report = BundleTrust::new(config).unwrap().constraints(set.clone()).minimize(&theta, start);
        let report = report.unwrap_or_else(|error| panic!("{seed} {kind:?}: {error}"));
        let failed = matches!(report.termination, Termination::SubproblemFailed { .. });
        assert!(!failed, "{seed} {kind:?}: {report}");
        assert!(violation(&set, &report.solution) < 1e-9, "{seed} {kind:?}: {report}");
        if let Some(certificate) = &report.certificate {
            // One multiplier per row, dependent ones included.
            assert_eq!(certificate.row_multipliers.len(), set.rows().nrows());
        }
    }
    println!("{count} sets of up to {most} variables: none called empty, no subproblem failed");
}

#[test]
fn dependent_rows_with_other_sides_are_refused() {
    for seed in 0..200_u64 {
        let mut numbers = Numbers(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 99);
        let n = (5.0 * 6.0_f64.powf(numbers.next())) as usize;
        let (whole, _) = set(Kind::Redundant, &mut numbers, n);
        let mut sides = whole.row_upper().clone();
        let last = sides.len() - 1;
        sides[last] += 10.0_f64.powf(-6.0 * numbers.next()) * (1.0 + sides[last].abs());
        let empty = Polyhedron::unbounded(n).with_rows(whole.rows(), &sides, &sides).unwrap();
        let theta = FnObjective::new(n, |x: &Vector| (x.norm_squared(), x * 2.0));
        let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap().constraints(empty);
        let error = method.minimize(&theta, Vector::zeros(n)).unwrap_err();
        assert!(matches!(error, OptimizeError::Infeasible { violation } if violation > 0.0), "{seed}: {error}");
    }
}

/// Rows that contradict each other by rounding are stated, and the run goes on.
#[test]
fn contradictions_by_rounding_are_stated() {
    let rows = Matrix::from_row_slice(2, 2, &[1.0, 1.0, 3.0, 3.0]);
    let sides = Vector::from_vec(vec![1.0, 3.0 + 3e-11]);
    let set = Polyhedron::unbounded(2).with_rows(&rows, &sides, &sides).unwrap();
    let theta = FnObjective::new(2, |x: &Vector| (x.norm_squared(), x * 2.0));
    let mut method = BundleTrust::new(BundleTrustConfig::default()).unwrap().constraints(set);
    let report = method.minimize(&theta, Vector::zeros(2)).unwrap();
    assert!((report.value - 0.5).abs() < 1e-9 && report.termination.is_confirmed(), "{report}");
    assert!(report.warnings.iter().any(|words| words.contains("row 0") || words.contains("row 1")), "{report}");
}
