//! Interior-point method for sums of the absolute values of many dense affine functions, with a quadratic term.
//!
//! ```text
//! min over (x, t)   Σ t_i + ½xᵀHx + ⟨p, x⟩,     |c_i + ⟨g_i, x⟩| ≤ t_i,     B x = b,     E x ≤ e
//! Newton step:      (H + Σ D_i g_i g_iᵀ + Σ θ_k E_k E_kᵀ) Δx + BᵀΔy = …,     θ = z/s of slacks s and multipliers z
//!                   D_i = 4 θ⁺θ⁻/(θ⁺ + θ⁻) of the two sides of |c_i + ⟨g_i, x⟩| ≤ t_i
//! ```
//! The epigraph variables t leave the system in closed form, so that a step costs one product of dense matrices and one
//! Cholesky factor of the size of x. Reference: \[Mehrotra1992\] (predictor and corrector).

use super::dense::Cholesky;
use super::outer_products::OuterProducts;
use super::polish::{Guess, polish};
use super::program::{PrimalDual, Program};
use crate::interruption::interrupted;
use crate::{Matrix, Vector};

/// Largest number of steps.
const MAX_STEPS: usize = 100;
/// Steps in a row that may fail to halve the error, before the best iterate counts as the most that double precision
/// gives.
const MAX_STALLED: usize = 8;
/// Relative error that ends the method.
const ACCURATE: f64 = 1e-13;
/// Relative error below which steps that do not halve it do not come back to progress: rounding holds it.
const ROUNDED: f64 = 1e-11;
/// So many such steps in a row end the method there.
const MAX_STALLED_BY_ROUNDING: usize = 2;
/// Share of the way to the boundary that a step goes.
const SHARE: f64 = 0.995;

/// The constraints as the method sees them. Slacks and multipliers are in the order: upper sides of
/// the absolute values, lower ones, inequalities.
struct Constraints<'a> {
    program: &'a Program<'a>,
    /// G, and below it the inequalities of more than one entry.
    rows: Matrix,
    /// Transpose of `rows`.
    columns: Matrix,
    products: OuterProducts,
    /// Inequalities, those of more than one entry first, as positions in the list of sides.
    order: Vec<usize>,
    /// How many of them have more than one entry.
    dense: usize,
    /// B.
    equalities: Matrix,
    /// The size of Gᵀw for the weights that occur.
    slopes: f64,
}

/// Variables, or their step, or the residuals of what belongs to them.
#[derive(Clone)]
struct Point {
    x: Vector,
    t: Vector,
    /// Multipliers of the equalities.
    y: Vector,
    s: Vector,
    z: Vector,
}

/// The factors of the equations of a Newton step.
struct Newton {
    /// θ.
    ratios: Vector,
    /// θ⁺ + θ⁻.
    sums: Vector,
    factor: Cholesky,
    /// The factor of B (L Lᵀ)⁻¹ Bᵀ, where there are equalities.
    equalities: Option<Cholesky>,
}

/// Solves the program; none where its numbers are not finite or nobody waits for the answer any more.
pub(crate) fn solve(program: &Program<'_>) -> Option<PrimalDual> {
    solve_counted(program).map(|(answer, _)| answer)
}

/// The answer, and the number of steps.
fn solve_counted(program: &Program<'_>) -> Option<(PrimalDual, usize)> {
    let constraints = Constraints::new(program);
    let mut point = constraints.start();
    // E x, kept from step to step.
    let mut images = constraints.images(&point.x);
    let mut best: Option<(f64, Point)> = None;
    let (mut stalled, mut steps) = (0, 0);
    while steps < MAX_STEPS && stalled < MAX_STALLED {
        if interrupted() {
            return None;
        }
        let residuals = constraints.residuals(&point, &images);
        let error = constraints.error(&point, &residuals);
        if !error.is_finite() {
            break;
        }
        let least = best.as_ref().map_or(f64::INFINITY, |(error, _)| *error);
        stalled = if error < 0.5 * least { 0 } else { stalled + 1 };
        if error < least {
            best = Some((error, point.clone()));
        }
        if error <= ACCURATE || stalled >= MAX_STALLED_BY_ROUNDING && least <= ROUNDED {
            break;
        }
        let newton = constraints.newton(&point)?;
        let (step, change) = constraints.step(&newton, &point, &residuals);
        let length = point.length(&step, SHARE);
        point.advance(&step, length);
        images.axpy(length, &change, 1.0);
        steps += 1;
    }
    let (error, point) = best?;
    let guess = constraints.guess(&point);
    let answer = constraints.answer(point);
    Some((if error > ACCURATE { polish(program, answer, &guess)? } else { answer }, steps))
}

impl<'a> Constraints<'a> {
    fn new(program: &'a Program<'a>) -> Self {
        let (m, n) = program.jacobian.shape();
        let normal = |k: usize| &program.sides[k].normal;
        let (mut order, single): (Vec<usize>, Vec<usize>) =
            (program.equalities..program.sides.len()).partition(|&k| normal(k).len() != 1);
        let dense = order.len();
        let mut rows = program.jacobian.clone().resize_vertically(m + dense, 0.0);
        for (i, &k) in order.iter().enumerate() {
            normal(k).iter().for_each(|&(column, entry)| rows[(m + i, column)] = entry);
        }
        let mut equalities = Matrix::zeros(program.equalities, n);
        for i in 0..program.equalities {
            normal(i).iter().for_each(|&(column, entry)| equalities[(i, column)] = entry);
        }
        order.extend(single);
        let slopes = program.jacobian.column_iter().map(|column| column.iter().map(|entry| entry.abs()).sum());
        let slopes = slopes.fold(0.0, f64::max);
        let columns = rows.transpose();
        let products = OuterProducts::of(&columns);
        Self { program, columns, rows, products, order, dense, equalities, slopes }
    }

    /// m, the number of absolute values.
    fn count(&self) -> usize {
        self.program.outputs.len()
    }

    /// The inequalities of one entry: position among all, column, entry.
    fn single(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let first = 2 * self.count() + self.dense;
        let sides = self.order[self.dense..].iter().map(|&k| self.program.sides[k].normal[0]);
        sides.enumerate().map(move |(i, (column, entry))| (first + i, column, entry))
    }

    /// G x and E x.
    fn images(&self, x: &Vector) -> Vector {
        let m = self.count();
        let mut images = (&self.rows * x).resize_vertically(m + self.order.len(), 0.0);
        self.single().for_each(|(place, column, entry)| images[place - m] = entry * x[column]);
        images
    }

    /// G x − t, −G x − t and E x, for images G x and E x.
    fn sides(&self, images: &Vector, t: &Vector) -> Vector {
        let m = self.count();
        Vector::from_fn(m + images.len(), |k, _| match k {
            k if k < m => images[k] - t[k],
            k if k < 2 * m => -images[k - m] - t[k - m],
            k => images[k - m],
        })
    }

    /// Gᵀw + Eᵀz for weights of the outputs and multipliers of all sides, of which the first 2 m do not count.
    fn pull(&self, weights: &Vector, multipliers: &Vector) -> Vector {
        let m = self.count();
        let mut all = Vector::zeros(m + self.dense);
        all.rows_mut(0, m).copy_from(weights);
        all.rows_mut(m, self.dense).copy_from(&multipliers.rows(2 * m, self.dense));
        let mut pull = &self.columns * all;
        self.single().for_each(|(place, column, entry)| pull[column] += entry * multipliers[place]);
        pull
    }

    /// z⁺ − z⁻.
    fn weights(&self, z: &Vector) -> Vector {
        let m = self.count();
        z.rows(0, m) - z.rows(m, m)
    }

    /// z⁺ + z⁻.
    fn sums(&self, z: &Vector) -> Vector {
        let m = self.count();
        z.rows(0, m) + z.rows(m, m)
    }

    /// The right sides of the inequalities.
    fn bounds(&self) -> Vector {
        let (c, m, sides) = (self.program.outputs, self.count(), self.program.sides);
        Vector::from_fn(2 * m + self.order.len(), |k, _| match k {
            k if k < m => -c[k],
            k if k < 2 * m => c[k - m],
            k => sides[self.order[k - 2 * m]].bound,
        })
    }

    fn start(&self) -> Point {
        let (c, m, n) = (self.program.outputs, self.count(), self.program.jacobian.ncols());
        let t = c.abs().add_scalar(1.0);
        let sides = self.sides(&Vector::zeros(m + self.order.len()), &t);
        let s = (self.bounds() - sides).map(|slack| slack.max(1.0));
        let z = Vector::from_fn(s.len(), |k, _| 0.5 / if k < 2 * m { 1.0 } else { s[k] });
        Point { x: Vector::zeros(n), t, y: Vector::zeros(self.equalities.nrows()), s, z }
    }

    /// What the equations of an optimum leave: those of x, of t, the equalities, the inequalities, and z s.
    fn residuals(&self, point: &Point, images: &Vector) -> Point {
        let Program { quadratic, linear, sides, .. } = self.program;
        let pull = self.pull(&self.weights(&point.z), &point.z) + self.equalities.tr_mul(&point.y);
        let values = Vector::from_fn(self.equalities.nrows(), |i, _| sides[i].bound);
        Point {
            x: *quadratic * &point.x + *linear + pull,
            t: self.sums(&point.z).map(|sum| 1.0 - sum),
            y: &self.equalities * &point.x - values,
            s: self.sides(images, &point.t) + &point.s - self.bounds(),
            z: point.s.component_mul(&point.z),
        }
    }

    /// The largest residual, each beside the size of its terms.
    fn error(&self, point: &Point, residuals: &Point) -> f64 {
        let sizes = 1.0 + self.program.linear.amax() + self.slopes;
        let gap = residuals.z.sum() / (1.0 + point.t.abs().sum());
        let rest = [residuals.x.amax() / sizes, residuals.t.amax(), residuals.y.amax(), residuals.s.amax()];
        rest.into_iter().fold(gap, |largest, rest| if rest > largest || rest.is_nan() { rest } else { largest })
    }

    /// The equations of a Newton step; none where nobody waits for the answer any more.
    fn newton(&self, point: &Point) -> Option<Newton> {
        let m = self.count();
        let ratios = point.z.component_div(&point.s);
        let sums = self.sums(&ratios);
        let mut densities = Vector::zeros(m + self.dense);
        (0..m).for_each(|i| densities[i] = 4.0 * ratios[i] * (ratios[m + i] / sums[i]));
        densities.rows_mut(m, self.dense).copy_from(&ratios.rows(2 * m, self.dense));
        let mut lower = self.program.quadratic.clone();
        self.products.add_to(&mut lower, &densities)?;
        self.single().for_each(|(place, k, entry)| lower[(k, k)] += entry * entry * ratios[place]);
        let factor = Cholesky::new(lower);
        let equalities = match self.equalities.nrows() {
            0 => None,
            _ => Some(factor.schur(self.equalities.transpose())?),
        };
        Some(Newton { ratios, sums, factor, equalities })
    }

    /// The step that removes the residuals, with the images of its x.
    fn direction(&self, newton: &Newton, point: &Point, residuals: &Point) -> (Point, Vector) {
        let (Newton { ratios, sums, factor, .. }, m) = (newton, self.count());
        let open = ratios.component_mul(&residuals.s) - residuals.z.component_div(&point.s);
        let of_sums = self.sums(&open) - &residuals.t;
        // In this form, nothing cancels where one of the two ratios is far larger than the other.
        let weights = Vector::from_fn(m, |i, _| {
            let (upper, lower) = (ratios[i] / sums[i], ratios[m + i] / sums[i]);
            2.0 * (lower * open[i] - upper * open[m + i]) + (upper - lower) * residuals.t[i]
        });
        let mut rhs = -self.pull(&weights, &open) - &residuals.x;
        let mut y = Vector::zeros(residuals.y.len());
        if let Some(schur) = &newton.equalities {
            y = schur.solve(&self.equalities * factor.solve(rhs.clone()) + &residuals.y);
            rhs -= self.equalities.tr_mul(&y);
        }
        let x = factor.solve(rhs);
        let images = self.images(&x);
        let lengths = self.sides(&images, &Vector::zeros(m));
        let t = (of_sums + self.sums(&ratios.component_mul(&lengths))).component_div(sums);
        let change = self.sides(&images, &t);
        let z = open + ratios.component_mul(&change);
        (Point { x, t, y, s: -change - &residuals.s, z }, images)
    }

    /// The step of predictor and corrector, with the images of its x.
    fn step(&self, newton: &Newton, point: &Point, residuals: &Point) -> (Point, Vector) {
        let (predictor, _) = self.direction(newton, point, residuals);
        let length = point.length(&predictor, 1.0);
        let count = point.s.len() as f64;
        let mean = residuals.z.sum() / count;
        let reached = (&point.s + &predictor.s * length).dot(&(&point.z + &predictor.z * length)) / count;
        let center = mean * (reached / mean).powi(3);
        let z = (&residuals.z + predictor.s.component_mul(&predictor.z)).add_scalar(-center);
        self.direction(newton, point, &Point { z, ..residuals.clone() })
    }

    /// Absolute values whose both sides, and inequalities whose side has a multiplier above its slack.
    fn guess(&self, point: &Point) -> Guess {
        let (m, equalities) = (self.count(), self.program.equalities);
        let is_met = |k: usize| point.z[k] > point.s[k];
        let mut met = vec![true; self.program.sides.len()];
        self.order.iter().enumerate().for_each(|(i, &k)| met[k] = k < equalities || is_met(2 * m + i));
        Guess { vanishing: (0..m).map(|i| is_met(i) && is_met(m + i)).collect(), met }
    }

    fn answer(&self, point: Point) -> PrimalDual {
        let inequalities = 2 * self.count();
        let mut multipliers = vec![0.0; self.program.sides.len()];
        multipliers[..point.y.len()].copy_from_slice(point.y.as_slice());
        self.order.iter().enumerate().for_each(|(i, &k)| multipliers[k] = point.z[inequalities + i]);
        PrimalDual { weights: self.weights(&point.z), x: point.x, multipliers }
    }
}

impl Point {
    /// The length of a step, at most 1, that goes a share of the way to where a slack or a multiplier vanishes.
    fn length(&self, step: &Point, share: f64) -> f64 {
        let pairs = self.s.iter().zip(step.s.iter()).chain(self.z.iter().zip(step.z.iter()));
        let falling = pairs.filter(|(_, change)| **change < 0.0).map(|(value, change)| -share * value / change);
        falling.fold(1.0, f64::min)
    }

    fn advance(&mut self, step: &Point, length: f64) {
        let Self { x, t, y, s, z } = self;
        for (value, change) in [(x, &step.x), (t, &step.t), (y, &step.y), (s, &step.s), (z, &step.z)] {
            value.axpy(length, change, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::interior_point::{ScaledSide, compressed, equalities_first, push_set, settings};
    use super::*;
    use crate::Polyhedron;
    use crate::verify::seeded_direction;
    use clarabel::solver::{DefaultSolver, IPSolver, NonnegativeConeT, ZeroConeT};

    fn sides_of(set: &Polyhedron) -> (Vec<ScaledSide>, usize) {
        let mut sides = vec![];
        let rows = (set.row_lower(), set.row_upper());
        push_set(&mut sides, set.rows(), rows, (set.lower(), set.upper()), |entry, _| entry);
        let equalities = equalities_first(&mut sides);
        (sides, equalities)
    }

    #[test]
    fn one_variable_has_a_closed_form() {
        let (one, zero) = (Vector::from_element(1, 1.0), Vector::zeros(1));
        let point = |curvature: f64, highest: f64| {
            let set = Polyhedron::boxed(&one * -9.0, &one * highest).expect("not empty");
            let (sides, equalities) = sides_of(&set);
            let (outputs, jacobian) = (-&one, Matrix::identity(1, 1));
            let (quadratic, linear) = (&Matrix::from_element(1, 1, curvature), &zero);
            let answer = solve(&Program {
                outputs: &outputs,
                jacobian: &jacobian,
                quadratic,
                linear,
                sides: &sides,
                equalities,
            });
            answer.map_or(f64::NAN, |answer| answer.x[0])
        };
        // min |x − 1| + ½ u x²  at min(1, 1/u), or at the bound.
        for (curvature, highest, wanted) in [(2.0, 9.0, 0.5), (0.5, 9.0, 1.0), (2.0, 0.3, 0.3), (0.5, 0.3, 0.3)] {
            assert!((point(curvature, highest) - wanted).abs() <= 1e-11, "{curvature} {highest}");
        }
    }

    #[test]
    fn a_large_program_takes_few_steps_to_the_answer_of_clarabel() {
        let (n, m) = (30, 80);
        let rows: Vec<_> = (0..m).map(|i| (seeded_direction(n, i as u64) * 2.0).transpose()).collect();
        let (jacobian, outputs) = (Matrix::from_rows(&rows), seeded_direction(m, 1000) * 9.0);
        let (quadratic, linear) = (Matrix::identity(n, n) * 1e-3, seeded_direction(n, 1001) * 0.1);
        // An equality that is given twice, a two-sided row, a box, and a fixed variable.
        let normal = seeded_direction(n, 1002).transpose();
        let of_set = Matrix::from_rows(&[normal.clone(), normal, seeded_direction(n, 1003).transpose()]);
        let (lower, upper) = (Vector::from_vec(vec![0.2, 0.2, -0.1]), Vector::from_vec(vec![0.2, 0.2, 0.1]));
        let fixed = |side: f64| Vector::from_fn(n, |k, _| if k == 3 { 0.1 } else { side });
        let set = Polyhedron::boxed(fixed(-0.5), fixed(0.5)).and_then(|set| set.with_rows(&of_set, &lower, &upper));
        let (sides, equalities) = sides_of(&set.expect("not empty"));
        let program = Program {
            outputs: &outputs,
            jacobian: &jacobian,
            quadratic: &quadratic,
            linear: &linear,
            sides: &sides,
            equalities,
        };
        let (own, steps) = solve_counted(&program).expect("nobody interrupts");
        assert!(steps <= 20, "{steps}");
        let (x, weights) = by_clarabel(&program);
        assert!((own.x - x).amax() <= 1e-9);
        assert!((own.weights - weights).amax() <= 1e-9);
    }

    /// The minimizer and the weights of the outputs.
    fn by_clarabel(program: &Program<'_>) -> (Vector, Vector) {
        let Program { outputs, jacobian, quadratic, linear, sides, equalities } = program;
        let (m, n) = jacobian.shape();
        let mut columns = vec![vec![]; n + m];
        for (i, side) in sides.iter().enumerate() {
            side.normal.iter().for_each(|&(k, entry)| columns[k].push((i, entry)));
        }
        let mut bounds: Vec<f64> = sides.iter().map(|side| side.bound).collect();
        for (i, sign) in (0..m).flat_map(|i| [(i, 1.0), (i, -1.0)]) {
            (0..n).for_each(|k| columns[k].push((bounds.len(), sign * jacobian[(i, k)])));
            columns[n + i].push((bounds.len(), -1.0));
            bounds.push(-sign * outputs[i]);
        }
        let mut upper: Vec<_> = (0..n).map(|k| vec![(k, quadratic[(k, k)])]).collect();
        upper.extend(vec![vec![]; m]);
        let slopes: Vec<f64> = linear.iter().copied().chain(vec![1.0; m]).collect();
        let cones = [ZeroConeT(*equalities), NonnegativeConeT(bounds.len() - equalities)];
        let (quadratic, matrix) = (compressed(n + m, &upper), compressed(bounds.len(), &columns));
        let solver = DefaultSolver::new(&quadratic, &slopes, &matrix, &bounds, &cones, settings());
        let mut solver = solver.expect("the program is valid");
        solver.solve();
        let of_outputs = |i: usize| solver.solution.z[sides.len() + i];
        let weights = Vector::from_fn(m, |i, _| of_outputs(2 * i) - of_outputs(2 * i + 1));
        (Vector::from_column_slice(&solver.solution.x[..n]), weights)
    }
}
