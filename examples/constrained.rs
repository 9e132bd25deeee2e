//! Runs the collection of problems with nonlinear constraints, each beside an exact penalty with a weight that is known
//! to suffice.
//!
//! `cargo run --release --example constrained -- [--joined] [--only NAME] [--trust RUNS]`
//!
//! `--joined` joins the inequalities of every problem into their maximum, which returns one subgradient. `--trust`
//! makes so many runs from moved starts with objective and constraints multiplied by powers of ten up to 1e±6, and
//! counts what is confirmed although it is not optimal, or called feasible although it is not.

use nonsmooth::composite::{Linearization, Linearized, OuterFunction};
use nonsmooth::{
    Answer, BundleTrust, BundleTrustConfig, CompositeFunction, ConstraintEvaluation, ConstraintKind, Evaluation,
    Matrix, NonsmoothObjective, OracleError, Polyhedron, Report, Request, Vector,
};
use testset::constrained::{ConstrainedProblem, Kind};

/// Evaluations after which a run ends.
const BUDGET: usize = 1000;
/// An objective this close to the optimal value, relatively, is optimal.
const OPTIMAL: f64 = 1e-6;
/// A violation up to this is none, relative to the largest value of the constraint at the start and at 1.
const FEASIBLE: f64 = 1e-8;

fn vector(values: &[f64]) -> Vector {
    Vector::from_column_slice(values)
}

fn kinds(problem: &ConstrainedProblem) -> Vec<ConstraintKind> {
    let kind = |kind: &Kind| match kind {
        Kind::Nonsmooth => ConstraintKind::Nonsmooth,
        Kind::Smooth => ConstraintKind::Smooth,
        Kind::SmoothEquality => ConstraintKind::SmoothEquality,
    };
    problem.kinds.iter().map(kind).collect()
}

/// The outer function of a problem's objective.
struct Own(testset::Outer);

impl OuterFunction for Own {
    fn value(&self, outputs: &Vector) -> f64 {
        self.0.evaluate(outputs.as_slice()).0
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        Vector::from_vec(self.0.evaluate(outputs.as_slice()).1)
    }
}

/// A problem whose functions are multiplied by factors.
struct Scaled<'a> {
    problem: &'a ConstrainedProblem,
    outer: Own,
    kinds: Vec<ConstraintKind>,
    objective: f64,
    constraints: Vec<f64>,
}

impl<'a> Scaled<'a> {
    fn new(problem: &'a ConstrainedProblem, objective: f64, constraints: Vec<f64>) -> Self {
        let outer = Own(problem.composition().outer().clone());
        Self { problem, outer, kinds: kinds(problem), objective, constraints }
    }
}

impl NonsmoothObjective for Scaled<'_> {
    type WarmStart = ();

    fn dimension(&self) -> usize {
        self.problem.dimension
    }

    fn outer(&self) -> Option<&dyn OuterFunction> {
        // The outer functions of the collection are positively homogeneous: a factor may stand inside.
        Some(&self.outer)
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    fn evaluate(&self, request: &Request<'_, ()>) -> Result<Answer<()>, OracleError> {
        let (x, n) = (request.point.as_slice(), request.point.len());
        let found = self.problem.evaluate(x);
        let (factors, c) = (&self.constraints, &found.constraints);
        let values = Vector::from_fn(c.len(), |j, _| factors[j] * c[j].0);
        let constraints = ConstraintEvaluation::new(values, Matrix::from_fn(c.len(), n, |j, k| factors[j] * c[j].1[k]));
        let (outputs, rows) = self.problem.composition().linearize(x);
        let jacobian = Matrix::from_fn(outputs.len(), n, |i, k| self.objective * rows[i][k]);
        let outputs = Vector::from_vec(outputs) * self.objective;
        let linearization = Linearization { outputs, jacobian, accuracy: 0.0, inactive: None };
        let linearization = Linearized::if_asked(request.linearization, linearization);
        let (value, subgradient) = (self.objective * found.value, vector(&found.subgradient) * self.objective);
        let exact = Evaluation::exact(value, subgradient, ());
        Ok(Answer::Accurate(Evaluation { linearization, constraints: Some(constraints), ..exact }))
    }
}

/// f + ρ max(0, cⱼ, |c_eq|) of outputs and constraints.
struct Penalty {
    own: Own,
    outputs: usize,
    kinds: Vec<ConstraintKind>,
    weight: f64,
}

impl OuterFunction for Penalty {
    fn value(&self, z: &Vector) -> f64 {
        let violations = self.kinds.iter().zip(z.iter().skip(self.outputs)).map(|(kind, c)| kind.violation(*c));
        self.own.value(&z.rows(0, self.outputs).into_owned()) + self.weight * violations.fold(0.0, f64::max)
    }

    fn subgradient(&self, z: &Vector) -> Vector {
        let own = self.own.subgradient(&z.rows(0, self.outputs).into_owned());
        let mut weights = own.resize_vertically(z.len(), 0.0);
        let violation = |j: usize| self.kinds[j].violation(z[self.outputs + j]);
        let worst = (0..self.kinds.len()).max_by(|a, b| violation(*a).total_cmp(&violation(*b)));
        if let Some(j) = worst.filter(|j| violation(*j) > 0.0) {
            weights[self.outputs + j] = self.weight.copysign(z[self.outputs + j]);
        }
        weights
    }
}

/// The problem as an exact penalty.
fn penalised(problem: &ConstrainedProblem) -> impl NonsmoothObjective<WarmStart = ()> + '_ {
    let outputs = problem.composition().linearize(&problem.start).0.len();
    let own = Own(problem.composition().outer().clone());
    let outer = Penalty { own, outputs, kinds: kinds(problem), weight: problem.penalty };
    CompositeFunction::new(problem.dimension, outer, move |x: &Vector| {
        let (outputs, rows) = problem.composition().linearize(x.as_slice());
        let constraints = problem.evaluate(x.as_slice()).constraints;
        let values = outputs.iter().copied().chain(constraints.iter().map(|c| c.0));
        let rows: Vec<&Vec<f64>> = rows.iter().chain(constraints.iter().map(|c| &c.1)).collect();
        (Vector::from_iterator(rows.len(), values), Matrix::from_fn(rows.len(), x.len(), |i, k| rows[i][k]))
    })
}

fn minimize<O: NonsmoothObjective>(problem: &ConstrainedProblem, objective: &O, start: &[f64]) -> Option<Report> {
    let set = Polyhedron::boxed(vector(&problem.lower), vector(&problem.upper)).ok()?;
    let config = BundleTrustConfig { max_evaluations: BUDGET, ..Default::default() };
    BundleTrust::new(config).ok()?.constraints(set).minimize(objective, vector(start)).ok()
}

/// Relative distance of the objective from the nearest optimal value, and relative violation.
fn errors(problem: &ConstrainedProblem, x: &Vector) -> [f64; 2] {
    let found = problem.evaluate(x.as_slice());
    let optima = problem.other_optima.iter().chain([&problem.optimum]);
    let gaps = optima.map(|optimum| (found.value - optimum).abs() / optimum.abs().max(1.0));
    let start = problem.evaluate(&problem.start).constraints;
    let relative = |j: usize| {
        let violation = kinds(problem)[j].violation(found.constraints[j].0);
        violation / start[j].0.abs().max(1.0)
    };
    [gaps.fold(f64::INFINITY, f64::min), (0..start.len()).map(relative).fold(0.0, f64::max)]
}

fn is_solved([gap, violation]: [f64; 2]) -> bool {
    gap <= OPTIMAL && violation <= FEASIBLE
}

/// One line per problem, and how many are solved with which ratio to the penalty.
fn table(problems: &[ConstrainedProblem]) {
    let (mut solved, mut logarithms, mut compared) = (0, 0.0, 0);
    for problem in problems {
        let Some(report) =
            minimize(problem, &Scaled::new(problem, 1.0, vec![1.0; problem.kinds.len()]), &problem.start)
        else {
            println!("{:28} refused", problem.name);
            continue;
        };
        let found = errors(problem, &report.solution);
        let penalty = minimize(problem, &penalised(problem), &problem.start);
        let penalty = penalty.map(|report| (report.counts.evaluations, errors(problem, &report.solution)));
        let other = penalty.filter(|(_, found)| found[0] <= OPTIMAL).map(|(count, _)| count);
        let count = report.counts.evaluations;
        solved += usize::from(is_solved(found));
        if let Some(other) = other.filter(|_| is_solved(found)) {
            (logarithms, compared) = (logarithms + (count as f64 / other as f64).ln(), compared + 1);
        }
        println!(
            "{:28} {:4} {:4} active  {:5} evaluations, penalty {:>5}  gap {:.0e}  violation {:.0e}  {}{}",
            problem.name,
            problem.kinds.len(),
            problem.active,
            count,
            other.map_or_else(|| "–".to_owned(), |count| count.to_string()),
            found[0],
            found[1],
            if is_solved(found) { "" } else { "NOT SOLVED: " },
            report.termination
        );
    }
    let ratio = (logarithms / compared as f64).exp();
    println!("{solved} of {} solved; evaluations {ratio:.2} of the penalty's over {compared}", problems.len());
}

/// Whether the multipliers of the certificate prove another stationary point: what they sum to is small beside its
/// terms.
fn is_stationary(problem: &ConstrainedProblem, report: &Report) -> bool {
    let Some(certificate) = &report.certificate else { return false };
    let Ok(set) = Polyhedron::boxed(vector(&problem.lower), vector(&problem.upper)) else { return false };
    let terms = certificate.cuts.iter().map(|cut| cut.multiplier * cut.subgradient.norm()).sum::<f64>()
        + certificate
            .constraints
            .iter()
            .flat_map(|c| &c.cuts)
            .map(|c| c.multiplier.abs() * c.subgradient.norm())
            .sum::<f64>();
    certificate.recheck(&set).is_ok_and(|check| {
        check.aggregate_norm <= 1e-4 * terms
            && check.multiplier_defect <= 1e-9 * terms.max(1.0)
            && check.violation <= 1e-8
    }) && errors(problem, &report.solution)[1] <= FEASIBLE
}

/// Uniform numbers in [−1, 1].
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    fn power_of_ten(&mut self) -> f64 {
        10_f64.powf((6.0 * self.next()).round())
    }
}

/// Runs from moved starts with scaled functions.
fn trust(problems: &[ConstrainedProblem], runs: usize) {
    let small: Vec<&ConstrainedProblem> = problems.iter().filter(|problem| problem.dimension <= 20).collect();
    let (mut solved, mut confirmed, mut wrong) = (0, 0, 0);
    for run in 0..runs {
        let problem = small[run % small.len()];
        let mut random = Random(run as u64 + 1);
        random.next();
        let size = [0.0, 0.1, 1.0][run / small.len() % 3];
        let start: Vec<f64> = problem.start.iter().map(|x| x + size * (x.abs() + 1.0) * random.next()).collect();
        let objective = random.power_of_ten();
        let constraints = problem.kinds.iter().map(|_| random.power_of_ten()).collect();
        let Some(report) = minimize(problem, &Scaled::new(problem, objective, constraints), &start) else { continue };
        let found = errors(problem, &report.solution);
        solved += usize::from(is_solved(found));
        confirmed += usize::from(report.termination.is_confirmed());
        let claims_too_much =
            report.termination.is_confirmed() && !is_solved(found) && !is_stationary(problem, &report);
        if claims_too_much || report.is_feasible() && found[1] > FEASIBLE {
            wrong += 1;
            println!(
                "{} run {run}: gap {:.1e} violation {:.1e} {}",
                problem.name, found[0], found[1], report.termination
            );
        }
    }
    println!("{runs} runs: {solved} solved, {confirmed} confirmed, {wrong} confirmed or called feasible elsewhere");
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let value = |flag: &str| arguments.iter().position(|a| a == flag).and_then(|i| arguments.get(i + 1));
    let joined = arguments.iter().any(|argument| argument == "--joined");
    let problems = testset::constrained::all().into_iter();
    let problems = problems.filter(|problem| value("--only").is_none_or(|name| *name == problem.name));
    let problems: Vec<ConstrainedProblem> =
        problems.map(|problem| if joined { problem.joined() } else { problem }).collect();
    match value("--trust").and_then(|runs| runs.parse().ok()) {
        Some(runs) => trust(&problems, runs),
        None => table(&problems),
    }
}
