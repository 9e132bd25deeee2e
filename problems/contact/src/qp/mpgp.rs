//! Modified proportioning with gradient projections (MPGP), with conjugate gradients on curved faces.
//!
//! ```text
//! min q(x) = ½ xᵀHx − xᵀb,  x ∈ Ω            g = H x − b,   g̃ = (x − P_Ω(x − αg))/α,   α = 1/|H|
//!
//! proportioning step  when the chopped part of g̃ outweighs the free part: first step of a sweep that lets go
//!                     every active constraint whose negative gradient points inwards
//! cg step             conjugate gradients in the face, preconditioned there
//! expansion step      the end of a sweep that left Ω or slid along a circle: projection, gradient from x
//! ```
//! Two things differ from the textbook. Sliding along an active circle belongs to the face and takes its curvature into
//! account (the textbook leaves it to proportioning, which then costs most of the products). And the sweep is accepted
//! only if it lowers q by a fixed share of what the projected step x − αg̃ is certain to gain; otherwise that projected
//! step is made. So every sweep gains at least a multiple of α|g̃|², which gives the R-linear rate of gradient
//! projection whatever the face does.

use crate::linear::vector::{add_scaled, dot, norm};
use crate::qp::{Face, QpError, SeparableSet, SymmetricOperator};

/// An approximate inverse of H, used inside faces.
#[derive(Clone, Copy)]
pub struct FacePreconditioner<'a> {
    /// M ≈ H⁻¹, positive definite.
    pub operator: &'a dyn SymmetricOperator,
    /// Typical diagonal entry of M on entries that belong to discs.
    pub diagonal: f64,
}

/// Products with H by the kind of step that needed them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StepCounts {
    /// Number of conjugate gradient steps.
    pub cg_steps: usize,
    /// Projected ends of sweeps, and projected gradient steps.
    pub expansion_steps: usize,
    /// Steps that let constraints go.
    pub proportioning_steps: usize,
    /// Gradients computed afresh: at the start and against drift.
    pub refreshed_gradients: usize,
}

impl StepCounts {
    /// All products with H.
    pub fn products(&self) -> usize {
        self.cg_steps + self.expansion_steps + self.proportioning_steps + self.refreshed_gradients
    }
}

impl std::ops::AddAssign for StepCounts {
    fn add_assign(&mut self, other: Self) {
        self.cg_steps += other.cg_steps;
        self.expansion_steps += other.expansion_steps;
        self.proportioning_steps += other.proportioning_steps;
        self.refreshed_gradients += other.refreshed_gradients;
    }
}

/// A feasible point with its gradient.
#[derive(Debug, Clone, Default)]
pub struct Point {
    /// The iterate x ∈ Ω.
    pub x: Vec<f64>,
    /// g = H x − b.
    pub gradient: Vec<f64>,
}

/// The solver: operator, set, preconditioner and work so far.
pub struct Mpgp<'a> {
    /// The matrix H.
    pub hessian: &'a dyn SymmetricOperator,
    /// The feasible set Ω.
    pub set: &'a SeparableSet,
    /// The preconditioner inside faces of Ω.
    pub preconditioner: Option<FacePreconditioner<'a>>,
    /// Upper estimate of |H|; raised when a step shows that it is too small.
    pub norm: f64,
    /// Products with H allowed.
    pub max_products: usize,
    /// The steps done so far.
    pub counts: StepCounts,
}

/// How a run of [`Mpgp::minimise`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The reduced gradient is as small as asked for.
    Converged,
    /// Rounding stops all progress.
    Stagnated,
}

/// What a sweep proposes.
struct Sweep {
    step: Vec<f64>,
    image: Vec<f64>,
}

impl Mpgp<'_> {
    /// The point P_Ω(x) with its gradient (one product).
    ///
    /// # Errors
    /// [`QpError::Dimension`], [`QpError::Setting`], [`QpError::NotFinite`].
    pub fn start(&mut self, mut x: Vec<f64>, linear: &[f64]) -> Result<Point, QpError> {
        if !(self.norm > 0.0 && self.norm.is_finite()) {
            return Err(QpError::Setting { name: "norm", value: self.norm, allowed: "finite and > 0" });
        }
        let expected = self.hessian.dimension();
        for (what, found) in [("start", x.len()), ("linear term", linear.len()), ("set", self.set.dimension())] {
            if found != expected {
                return Err(QpError::Dimension { what, expected, found });
            }
        }
        self.set.project(&mut x);
        self.counts.refreshed_gradients += 1;
        let gradient = self.gradient(&x, linear)?;
        Ok(Point { x, gradient })
    }

    /// Moves the point until |g̃| ≤ `tolerance`(x), for q with linear term `linear`.
    ///
    /// # Errors
    /// [`QpError::NotConverged`] at the step limit, [`QpError::NotFinite`], [`QpError::Curvature`].
    pub fn minimise(
        &mut self,
        point: &mut Point,
        linear: &[f64],
        tolerance: &dyn Fn(&[f64]) -> f64,
    ) -> Result<Ending, QpError> {
        let mut history = Vec::new();
        // The gradient of the point may come from a recursion.
        let mut since_refresh = 1;
        let (mut best, mut since_best) = (f64::INFINITY, 0);
        loop {
            let reduced = self.set.reduced_gradient(&point.x, &point.gradient, 1.0 / self.norm);
            let length = norm(&reduced);
            if !length.is_finite() {
                return Err(QpError::NotFinite { what: "reduced gradient" });
            }
            if length <= tolerance(&point.x) {
                return Ok(Ending::Converged);
            }
            let rounding = f64::EPSILON * (norm(linear) + self.norm * norm(&point.x));
            since_best = if length < best { 0 } else { since_best + 1 };
            best = best.min(length);
            if length <= ROUNDED * rounding || (since_best > MAX_STALLED_ITERATIONS && best <= STALLED * rounding) {
                return Ok(Ending::Stagnated);
            }
            history.push(length);
            if self.counts.products() >= self.max_products {
                let (residual, steps) = (length / norm(linear).max(f64::MIN_POSITIVE), self.counts.products());
                return Err(QpError::NotConverged { solver: "MPGP", residual, steps, history });
            }
            let before = self.counts.cg_steps;
            if self.advance(point, linear, &reduced, tolerance)? {
                since_refresh += 1 + self.counts.cg_steps - before;
                if since_refresh <= REFRESH {
                    continue;
                }
            } else if since_refresh == 0 {
                return Ok(Ending::Stagnated);
            }
            self.counts.refreshed_gradients += 1;
            point.gradient = self.gradient(&point.x, linear)?;
            since_refresh = 0;
        }
    }

    /// One sweep and its end; false when nothing lowers q.
    fn advance(
        &mut self,
        point: &mut Point,
        linear: &[f64],
        reduced: &[f64],
        tolerance: &dyn Fn(&[f64]) -> f64,
    ) -> Result<bool, QpError> {
        let (free, chopped) = self.set.split(&point.x, &point.gradient, reduced);
        let release = chopped > PROPORTION * PROPORTION * free;
        let face = Face::new(self.set, &point.x, &point.gradient, release);
        let sweep = self.sweep(point, &face, release, tolerance)?;
        let certain = 0.5 * SUFFICIENT * (free + chopped) / self.norm;
        let mut x = point.x.clone();
        add_scaled(&mut x, 1.0, &sweep.step);
        let gradient = if self.set.project(&mut x) {
            self.counts.expansion_steps += 1;
            self.gradient(&x, linear)?
        } else {
            point.gradient.iter().zip(&sweep.image).map(|(g, image)| g + image).collect()
        };
        let candidate = Point { x, gradient };
        match compare_values(point, &candidate, certain) {
            Comparison::Lower => *point = candidate,
            Comparison::Rounded if self.reduces_gradient(&candidate, reduced, 0.9) => *point = candidate,
            _ => return self.projected_step(point, linear, reduced),
        }
        Ok(true)
    }

    /// Conjugate gradients in the face, from the point.
    fn sweep(
        &mut self,
        point: &Point,
        face: &Face,
        release: bool,
        tolerance: &dyn Fn(&[f64]) -> f64,
    ) -> Result<Sweep, QpError> {
        let mut residual: Vec<f64> = point.gradient.iter().map(|g| -g).collect();
        face.restrict(&mut residual);
        let start = norm(&residual);
        let size = residual.len();
        let mut sweep = Sweep { step: vec![0.0; size], image: vec![0.0; size] };
        let mut direction = vec![0.0; size];
        let mut previous = 0.0;
        let mut position = point.x.clone();
        for index in 0..REFRESH {
            if norm(&residual) <= (FORCING * start).max(0.5 * tolerance(&position)) {
                break;
            }
            let z = self.precondition(face, &residual);
            let product = dot(&residual, &z);
            let beta = if previous > 0.0 { product / previous } else { 0.0 };
            direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + beta * *d);
            previous = product;
            match (release, index) {
                (true, 0) => self.counts.proportioning_steps += 1,
                _ => self.counts.cg_steps += 1,
            }
            let image = self.product(&direction);
            let mut applied = image.clone();
            face.restrict(&mut applied);
            face.add_on_circles(&direction, &mut applied, |curvature| curvature);
            let curvature = dot(&direction, &applied);
            let Some(length) = self.step_length(point, &direction, product, curvature, index)? else { break };
            add_scaled(&mut sweep.step, length, &direction);
            add_scaled(&mut sweep.image, length, &image);
            add_scaled(&mut position, length, &direction);
            add_scaled(&mut residual, -length, &applied);
        }
        Ok(sweep)
    }

    /// The minimising length along a direction of a sweep; where q is flat, the way to the boundary of Ω if the sweep
    /// begins there, otherwise none.
    fn step_length(
        &self,
        point: &Point,
        direction: &[f64],
        product: f64,
        curvature: f64,
        index: usize,
    ) -> Result<Option<f64>, QpError> {
        let square = dot(direction, direction);
        if !(curvature.is_finite() && square.is_finite()) {
            return Err(QpError::NotFinite { what: "product with the quadratic form" });
        }
        if curvature > FLAT * self.norm * square {
            return Ok(Some(product / curvature));
        }
        if curvature < -FLAT * self.norm * square {
            return Err(QpError::Curvature { curvature: curvature / square });
        }
        if index > 0 {
            return Ok(None);
        }
        match self.set.feasible_step(&point.x, direction, f64::INFINITY) {
            length if length.is_finite() => Ok(Some(length)),
            _ => Err(QpError::Curvature { curvature: curvature / square }),
        }
    }

    /// Whether |g̃| at the candidate is below `factor` times what it was.
    fn reduces_gradient(&self, candidate: &Point, reduced: &[f64], factor: f64) -> bool {
        norm(&self.set.reduced_gradient(&candidate.x, &candidate.gradient, 1.0 / self.norm)) < factor * norm(reduced)
    }

    /// x ← P_Ω(x − αg); raises the norm estimate until q falls. False when neither q nor |g̃| falls any more.
    fn projected_step(&mut self, point: &mut Point, linear: &[f64], reduced: &[f64]) -> Result<bool, QpError> {
        let estimate = self.norm;
        let scale = norm(&point.x).max(norm(linear) / self.norm) * f64::EPSILON;
        for _raise in 0..MAX_RAISES {
            let mut x: Vec<f64> = point.x.iter().zip(&point.gradient).map(|(x, g)| x - g / self.norm).collect();
            self.set.project(&mut x);
            self.counts.expansion_steps += 1;
            let gradient = self.gradient(&x, linear)?;
            let candidate = Point { x, gradient };
            let moved: f64 = candidate.x.iter().zip(&point.x).map(|(new, old)| (new - old) * (new - old)).sum();
            let accepted = match compare_values(point, &candidate, 0.49 * self.norm * moved) {
                Comparison::Lower => moved > 0.0,
                Comparison::Rounded => self.reduces_gradient(&candidate, reduced, 1.0),
                Comparison::Higher if moved.sqrt() > STAGNATION * scale => {
                    self.norm *= 2.0;
                    continue;
                }
                Comparison::Higher => false,
            };
            if accepted {
                *point = candidate;
                return Ok(true);
            }
            break;
        }
        self.norm = estimate;
        Ok(false)
    }

    /// M restricted to the face, with the curvature of circles as a spring in series.
    fn precondition(&self, face: &Face, residual: &[f64]) -> Vec<f64> {
        let c = self.preconditioner.map_or(1.0 / self.norm, |preconditioner| preconditioner.diagonal);
        let weight = |curvature: f64| 1.0 / (1.0 + curvature * c);
        let mut weighted = residual.to_vec();
        face.scale_circles(&mut weighted, weight);
        let mut z = vec![0.0; residual.len()];
        match self.preconditioner {
            Some(preconditioner) => preconditioner.operator.apply(&weighted, &mut z),
            None => z.iter_mut().zip(&weighted).for_each(|(z, entry)| *z = c * entry),
        }
        face.restrict(&mut z);
        face.scale_circles(&mut z, weight);
        face.add_on_circles(residual, &mut z, |curvature| curvature * c * c * weight(curvature) * weight(curvature));
        z
    }

    fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; x.len()];
        self.hessian.apply(x, &mut image);
        image
    }

    fn gradient(&self, x: &[f64], linear: &[f64]) -> Result<Vec<f64>, QpError> {
        let mut gradient = self.product(x);
        gradient.iter_mut().zip(linear).for_each(|(g, b)| *g -= b);
        if gradient.iter().all(|g| g.is_finite()) { Ok(gradient) } else { Err(QpError::NotFinite { what: "gradient" }) }
    }
}

/// Γ: constraints are let go when |chopped| > Γ·|free|; a larger one holds them longer.
const PROPORTION: f64 = 0.5;
/// Relative residual at which conjugate gradients leave a face.
const FORCING: f64 = 0.1;
/// Share of the certain gain of a projected step that a sweep must reach.
const SUFFICIENT: f64 = 0.1;
/// Conjugate gradient steps allowed without a gradient computed from x.
const REFRESH: usize = 100;
/// Multiple of the rounding of the gradient below which |g̃| means nothing.
const ROUNDED: f64 = 2.0;
/// Multiple of the rounding below which |g̃| means nothing once [`MAX_STALLED_ITERATIONS`] sweeps made no progress.
const STALLED: f64 = 1e7;
/// Sweeps without a smaller |g̃| near the level of rounding.
const MAX_STALLED_ITERATIONS: usize = 20;
/// Doublings of the norm estimate in one projected step.
const MAX_RAISES: usize = 60;
/// Curvature relative to |H| that counts as zero.
const FLAT: f64 = 1e-14;
/// Multiple of the rounding unit of x below which a step is no progress.
const STAGNATION: f64 = 100.0;

/// What the values of q say about a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Comparison {
    /// The gain asked for was made.
    Lower,
    /// Gain and the gain asked for are below rounding: q says nothing.
    Rounded,
    /// Too little gain, or none.
    Higher,
}

/// Compares q(from) − q(to), computed without the cancellation of two large values, with what is asked for.
fn compare_values(from: &Point, to: &Point, asked: f64) -> Comparison {
    let (mut gain, mut size) = (0.0, 0.0);
    for index in 0..from.x.len() {
        let slope = 0.5 * (from.gradient[index] + to.gradient[index]);
        gain += slope * (from.x[index] - to.x[index]);
        size += (slope * from.x[index]).abs() + (slope * to.x[index]).abs();
    }
    let noise = 16.0 * f64::EPSILON * size;
    if gain >= asked {
        Comparison::Lower
    } else if asked <= noise && gain >= -noise {
        Comparison::Rounded
    } else {
        Comparison::Higher
    }
}
