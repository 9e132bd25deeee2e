//! SMALSE-M: semimonotonic augmented Lagrangians for separable and equality constraints.
//!
//! ```text
//! L(x, μ) = ½ xᵀHx − xᵀb + μᵀ(C x − e) + ρ/2 |C x − e|²
//! 1. find x ∈ Ω with |g̃(x, μ)| ≤ min(M |C x − e|, |b|)                    (MPGP, warm)
//! 2. stop when |g̃| and |C x − e| are small enough
//! 3. μ ← μ + ρ (C x − e);   if L grew by less than ρ/2 |C x − e|²: M ← β M
//! ```
//! ρ stays at |H| (for orthonormal rows C the spectrum of H + ρCᵀC is then that of H on the kernel of C, and ρ), unless
//! ten updates do not halve C x − e; then it grows by a factor of four.

use crate::linear::vector::{add_scaled, dot, norm};
use crate::qp::mpgp::Ending;
use crate::qp::{
    FacePreconditioner, Mpgp, Point, QpError, QpLimits, QuadraticProgram, SmalseSolution, StepCounts, WarmStart,
    largest_eigenvalue,
};

/// The solver.
///
/// ```
/// use contact::qp::*;
/// // The point of the half-plane x₀ ≥ 1/2 on the line x₀ + x₁ = 0 that is nearest to the origin.
/// let hessian = nonsmooth::Matrix::identity(2, 2);
/// let set = SeparableSet::new(2, vec![Block::HalfLine { index: 0, bound: 0.5 }])?;
/// let line = DenseEqualities { transposed: nonsmooth::Matrix::from_element(2, 1, 1.0), right_side: vec![0.0] };
/// let program = QuadraticProgram { hessian: &hessian, linear: &[0.0; 2], set: &set, equalities: &line };
/// let solver = Smalse { program, preconditioner: None, limits: QpLimits::default() };
/// let start = WarmStart { x: vec![0.0; 2], ..WarmStart::default() };
/// let x = solver.solve(&start, 1e-10)?.warm.x;
/// assert!((x[0] - 0.5).abs() < 1e-9 && (x[1] + 0.5).abs() < 1e-9);
/// # Ok::<(), QpError>(())
/// ```
#[derive(Clone, Copy)]
pub struct Smalse<'a> {
    /// The program to solve.
    pub program: QuadraticProgram<'a>,
    /// Preconditioner of H + ρCᵀC inside faces.
    pub preconditioner: Option<FacePreconditioner<'a>>,
    /// Limits on the work.
    pub limits: QpLimits,
}

impl Smalse<'_> {
    /// Solves to |g̃| ≤ tolerance·|H|·s and |C x − e| ≤ tolerance·s, where s = max(|b|/|H|, |e|, |P_Ω(0)|) is the size
    /// of the solution that the data suggest.
    ///
    /// # Errors
    /// [`QpError`]; [`QpError::NotConverged`] also when rounding stops the iteration above a thousand times the
    /// tolerance.
    pub fn solve(&self, start: &WarmStart, tolerance: f64) -> Result<SmalseSolution, QpError> {
        self.check(start)?;
        let norm_h = self.norm(start)?;
        let start = WarmStart { norm: Some(norm_h), ..start.clone() };
        let mut nearest = vec![0.0; self.program.hessian.dimension()];
        self.program.set.project(&mut nearest);
        let right = norm(self.program.equalities.right_side());
        let feasible = (norm(self.program.linear) / norm_h).max(right).max(norm(&nearest));
        let scale = norm_h * feasible;
        let inner = tolerance * scale;
        let solution = self.run(&start, inner, &mut |progress| {
            progress.reduced_gradient <= inner && progress.infeasibility <= tolerance * feasible
        })?;
        let residual = (solution.reduced_gradient / scale).max(solution.infeasibility / feasible);
        if solution.converged || scale == 0.0 || residual <= ACCEPTED * tolerance {
            return Ok(solution);
        }
        let steps = solution.counts.products();
        Err(QpError::NotConverged { solver: "SMALSE-M", residual, steps, history: vec![residual] })
    }

    /// Runs until `enough` is satisfied after an inner solve or rounding stops all progress; `floor` is the
    /// smallest |g̃| that is ever asked of the inner solver.
    ///
    /// # Errors
    /// [`QpError::NotConverged`] with the history of |g̃| + ρ|C x − e| over |b| at the limit of outer steps, and what
    /// the inner solver returns.
    pub fn run(
        &self,
        start: &WarmStart,
        floor: f64,
        enough: &mut dyn FnMut(&SmalseSolution) -> bool,
    ) -> Result<SmalseSolution, QpError> {
        self.check(start)?;
        let mut state = State::new(self, start)?;
        let mut history = Vec::new();
        let (mut infeasibility, mut stalled) = (f64::INFINITY, 0);
        let scale = norm(self.program.linear).max(f64::MIN_POSITIVE);
        loop {
            let (QuadraticProgram { hessian, equalities, .. }, rho) = (self.program, state.rho);
            let augmented = (hessian.dimension(), |x: &[f64], result: &mut [f64]| {
                hessian.apply(x, result);
                add_scaled(result, rho, &equalities.apply_transposed(&equalities.apply(x)));
            });
            let mut inner = Mpgp {
                hessian: &augmented,
                set: self.program.set,
                preconditioner: self.preconditioner,
                norm: state.norm + state.rho * state.row_norm * state.row_norm,
                max_products: self.limits.products,
                counts: state.counts,
            };
            if history.is_empty() {
                state.begin(&mut inner, start)?;
            }
            let stagnated = state.inner_solve(&mut inner, scale, floor)?;
            state.counts = inner.counts;
            let solution = state.update(inner.norm, history.len());
            history.push((solution.reduced_gradient + state.rho * solution.infeasibility) / scale);
            if !history[history.len() - 1].is_finite() {
                return Err(QpError::NotFinite { what: "residual of the equalities" });
            }
            state.strengthen(solution.infeasibility);
            let converged = enough(&solution);
            let progressed = solution.infeasibility < 0.9 * infeasibility;
            stalled = if stagnated && !progressed { stalled + 1 } else { 0 };
            infeasibility = solution.infeasibility;
            let bounds_alone = self.program.equalities.right_side().is_empty();
            if converged || stalled > STALLED || (bounds_alone && solution.reduced_gradient <= floor) {
                return Ok(SmalseSolution { converged, ..solution });
            }
            if history.len() >= self.limits.outer {
                let residual = history[history.len() - 1];
                let steps = state.counts.products();
                return Err(QpError::NotConverged { solver: "SMALSE-M", residual, steps, history });
            }
        }
    }

    fn check(&self, start: &WarmStart) -> Result<(), QpError> {
        let expected = self.program.hessian.dimension();
        let sizes = [
            ("linear term", self.program.linear.len()),
            ("set", self.program.set.dimension()),
            ("start", start.x.len()),
        ];
        if let Some(&(what, found)) = sizes.iter().find(|(_, found)| *found != expected) {
            return Err(QpError::Dimension { what, expected, found });
        }
        let equalities = self.program.equalities;
        let count = equalities.right_side().len();
        let found = equalities.apply_transposed(&vec![0.0; count]).len();
        if found != expected {
            return Err(QpError::Dimension { what: "row of the equalities", expected, found });
        }
        let found = equalities.apply(&start.x).len();
        if found != count {
            return Err(QpError::Dimension { what: "equalities", expected: count, found });
        }
        Ok(())
    }

    /// |H| as given, or a safe estimate.
    ///
    /// # Errors
    /// [`QpError::NotFinite`] from the estimate.
    pub fn norm(&self, start: &WarmStart) -> Result<f64, QpError> {
        if let Some(norm) = start.norm {
            return Ok(norm);
        }
        let estimate = NORM_SAFETY * largest_eigenvalue(self.program.hessian, NORM_STEPS)?;
        Ok(if estimate > 0.0 { estimate } else { 1.0 })
    }
}

/// β, the factor of M.
const BETA: f64 = 0.8;
/// Lanczos steps for |H| where it is not known; a low estimate costs steps, not correctness.
const NORM_STEPS: usize = 5;
/// Factor on the Lanczos estimate of |H|.
const NORM_SAFETY: f64 = 1.05;
/// Multiple of the tolerance accepted when rounding stops all progress.
const ACCEPTED: f64 = 1e3;
/// Updates of μ after which C x − e should have been halved.
const SLOW: usize = 10;
/// Updates of μ without progress, with an inner solver stopped by rounding, that end a run.
const STALLED: usize = 3;
/// Multiple of the rounding of C x below which C x − e means nothing.
const BLURRED: f64 = 1e3;
/// Factor of ρ when the updates of μ have not halved C x − e.
const RAISE: f64 = 4.0;
/// Lanczos steps for |C|.
const ROW_NORM_STEPS: usize = 10;

/// What changes during a run.
struct State<'a> {
    program: QuadraticProgram<'a>,
    norm: f64,
    row_norm: f64,
    rho: f64,
    m: f64,
    multipliers: Vec<f64>,
    linear: Vec<f64>,
    point: Point,
    lagrangian: f64,
    counts: StepCounts,
    /// |C x − e| when ρ was last looked at, and updates of μ since then.
    checkpoint: (f64, usize),
}

impl<'a> State<'a> {
    fn new(solver: &Smalse<'a>, start: &WarmStart) -> Result<Self, QpError> {
        let program = solver.program;
        let norm = solver.norm(start)?;
        let (equalities, right) = (program.equalities, program.equalities.right_side());
        let gram = (program.hessian.dimension(), |x: &[f64], result: &mut [f64]| {
            result.copy_from_slice(&equalities.apply_transposed(&equalities.apply(x)));
        });
        let row_norm = largest_eigenvalue(&gram, ROW_NORM_STEPS)?.max(0.0).sqrt();
        let known = start.multipliers.len() == right.len();
        let multipliers = if known { start.multipliers.clone() } else { vec![0.0; right.len()] };
        let rho = if row_norm > 0.0 { norm / (row_norm * row_norm) } else { 0.0 };
        let m = start.m.unwrap_or(rho * row_norm);
        let mut linear = program.linear.to_vec();
        let shift: Vec<f64> = right.iter().zip(&multipliers).map(|(e, mu)| rho * e - mu).collect();
        add_scaled(&mut linear, 1.0, &equalities.apply_transposed(&shift));
        Ok(Self {
            program,
            norm,
            row_norm,
            rho,
            m,
            multipliers,
            linear,
            point: Point::default(),
            lagrangian: f64::NEG_INFINITY,
            counts: StepCounts::default(),
            checkpoint: (f64::INFINITY, 0),
        })
    }

    /// The first point, with a known product or a new one.
    fn begin(&mut self, inner: &mut Mpgp<'_>, start: &WarmStart) -> Result<(), QpError> {
        let mut x = start.x.clone();
        if let Some(image) = &start.image
            && image.len() == x.len()
            && !self.program.set.project(&mut x)
        {
            let mut gradient: Vec<f64> = image.iter().zip(&self.linear).map(|(image, b)| image - b).collect();
            let equalities = self.program.equalities;
            add_scaled(&mut gradient, self.rho, &equalities.apply_transposed(&equalities.apply(&x)));
            self.point = Point { x, gradient };
        } else {
            self.point = inner.start(start.x.clone(), &self.linear)?;
        }
        Ok(())
    }

    /// Minimises the augmented Lagrangian; true when rounding stopped it.
    fn inner_solve(&mut self, inner: &mut Mpgp<'_>, largest: f64, floor: f64) -> Result<bool, QpError> {
        let tolerance = |x: &[f64]| (self.m * norm(&self.program.defect(x))).min(largest).max(floor);
        let ending = inner.minimise(&mut self.point, &self.linear, &tolerance);
        Ok(ending? == Ending::Stagnated)
    }

    /// Raises ρ when C x − e has not been halved in ten updates: rows that hardly touch the face.
    fn strengthen(&mut self, infeasibility: f64) {
        self.checkpoint.1 += 1;
        if self.checkpoint.1 < SLOW {
            return;
        }
        let rounding = f64::EPSILON * self.row_norm * norm(&self.point.x);
        if infeasibility > (0.5 * self.checkpoint.0).max(BLURRED * rounding) {
            let (added, equalities) = ((RAISE - 1.0) * self.rho, self.program.equalities);
            let defect = self.program.defect(&self.point.x);
            add_scaled(&mut self.linear, added, &equalities.apply_transposed(equalities.right_side()));
            add_scaled(&mut self.point.gradient, added, &equalities.apply_transposed(&defect));
            self.rho *= RAISE;
            self.m *= RAISE;
            self.lagrangian = f64::NEG_INFINITY;
        }
        self.checkpoint = (infeasibility, 0);
    }

    /// Step 3, the update of μ and M; returns the solution so far.
    fn update(&mut self, norm_rho: f64, outer: usize) -> SmalseSolution {
        let reduced = self.program.set.reduced_gradient(&self.point.x, &self.point.gradient, 1.0 / norm_rho);
        let equalities = self.program.equalities;
        let defect = self.program.defect(&self.point.x);
        let infeasibility = norm(&defect);
        let terms = self.point.x.iter().zip(&self.point.gradient).zip(&self.linear);
        let energy = 0.5 * terms.map(|((x, g), b)| x * (g - b)).sum::<f64>();
        let right = equalities.right_side();
        let lagrangian = energy - dot(&self.multipliers, right) + 0.5 * self.rho * dot(right, right);
        if lagrangian < self.lagrangian + 0.5 * self.rho * infeasibility * infeasibility {
            self.m *= BETA;
        }
        self.lagrangian = lagrangian;
        add_scaled(&mut self.multipliers, self.rho, &defect);
        let shift = equalities.apply_transposed(&defect);
        add_scaled(&mut self.linear, -self.rho, &shift);
        add_scaled(&mut self.point.gradient, self.rho, &shift);
        // H x − b + Cᵀμ⁺ = g⁺ − ρCᵀ(C x − e) = the gradient before the update.
        let mut gradient = self.point.gradient.clone();
        let mut image: Vec<f64> = gradient.iter().zip(&self.linear).map(|(g, b)| g + b).collect();
        add_scaled(&mut gradient, -self.rho, &shift);
        add_scaled(&mut image, -self.rho, &equalities.apply_transposed(&equalities.apply(&self.point.x)));
        let warm = WarmStart {
            x: self.point.x.clone(),
            image: Some(image),
            multipliers: self.multipliers.clone(),
            m: Some(self.m),
            norm: Some(self.norm),
        };
        let reduced_gradient = norm(&reduced);
        SmalseSolution {
            warm,
            gradient,
            reduced_gradient,
            infeasibility,
            outer: outer + 1,
            counts: self.counts,
            converged: false,
        }
    }
}
