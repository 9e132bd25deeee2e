//! Convex problems whose minimiser is chosen first.
//!
//! ```text
//! min h(A (y − c) − b) + ½|L (y − c)|²   over   lower ≤ y ≤ upper,  R y ≤ s
//! Aᵀp + ν = 0,   p ∈ ∂h(−b),   ν a normal of the set at c:   c is a minimiser, h(−b) the minimum
//! ```
//! A, b, p and ν are random; A − p (Aᵀp + ν)ᵀ/|p|² in place of A makes the equation hold.

use nonsmooth::composite::{GroupNorms, Maximum, OuterFunction, SumOfPowers};
use nonsmooth::{Matrix, Polyhedron, Vector};
use testset::kit::Random;

/// The function h of the residuals.
#[derive(Debug, Clone)]
pub enum Outer {
    /// The sum of absolute values.
    Absolute,
    /// The largest residual.
    Largest,
    /// The sum of norms of groups of residuals, of these sizes.
    Norms(Vec<usize>),
}

impl Outer {
    /// h as the engine takes it.
    pub fn function(&self) -> Box<dyn OuterFunction> {
        match self {
            Self::Absolute => Box::new(SumOfPowers { exponent: 1.0 }),
            Self::Largest => Box::new(Maximum),
            Self::Norms(sizes) => Box::new(GroupNorms { sizes: sizes.clone() }),
        }
    }
}

/// A problem with its minimiser.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Its name in tables.
    pub family: &'static str,
    pub outer: Outer,
    /// A.
    pub slopes: Matrix,
    /// −b, the residuals at c.
    pub residuals: Vector,
    /// L, without rows where there is no square; only where h is the largest residual.
    pub root: Matrix,
    /// c.
    pub minimiser: Vector,
    pub lower: Vector,
    pub upper: Vector,
    /// R and s.
    pub rows: (Matrix, Vector),
    /// ν: c + ν lies beyond the constraints that are active at c.
    pub normal: Vector,
}

fn entries(random: &mut Random, count: usize, size: f64) -> Vector {
    Vector::from_fn(count, |_, _| size * random.signed())
}

fn matrix(random: &mut Random, rows: usize, columns: usize) -> Matrix {
    Matrix::from_fn(rows, columns, |_, _| random.signed())
}

/// M D⁻¹ for a diagonal D.
fn columns_over(matrix: &Matrix, units: &Vector) -> Matrix {
    Matrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / units[j])
}

impl Problem {
    /// Names of the families.
    pub const FAMILIES: [&str; 5] = ["L1 fit", "maximum", "maximum plus square", "sum of norms", "linear function"];
    /// Kinds of sets; a linear function has no minimum without constraints.
    pub const SETS: [&str; 3] = ["box", "rows", "free"];

    /// h over all points, without A, residuals and L.
    fn of(family: &'static str, outer: Outer, minimiser: Vector) -> Self {
        let n = minimiser.len();
        Self {
            family,
            outer,
            slopes: Matrix::zeros(0, n),
            residuals: Vector::zeros(0),
            root: Matrix::zeros(0, n),
            minimiser,
            lower: Vector::from_element(n, f64::NEG_INFINITY),
            upper: Vector::from_element(n, f64::INFINITY),
            rows: (Matrix::zeros(0, n), Vector::zeros(0)),
            normal: Vector::zeros(n),
        }
    }

    /// A random problem of a family over a set of some kind; every eighth has ten variables, the others two to six.
    pub fn random(family: &'static str, set: &str, number: usize, random: &mut Random) -> Self {
        let n = if number % 8 == 7 { 10 } else { 2 + random.below(5) };
        let m = if family == "linear function" { 1 } else { (8 + random.below(12)).max(n + 3) };
        let mut problem = Self::of(family, Outer::Largest, entries(random, n, 3.0));
        match set {
            "box" => problem.add_box(m == 1, random),
            "rows" => problem.add_rows(if m == 1 { n } else { random.below(n) }, random),
            _ => {}
        }
        let dual = problem.add_residuals(m, random);
        let slopes = matrix(random, m, n);
        let rest = slopes.tr_mul(&dual) + &problem.normal;
        problem.slopes = slopes - &dual * rest.transpose() / dual.norm_squared();
        problem
    }

    /// Bounds of which some, or all where one is `needed` per variable, are active at c.
    fn add_box(&mut self, needed: bool, random: &mut Random) {
        for i in 0..self.minimiser.len() {
            let widths = [(); 2].map(|()| 10_f64.powf(1.3 * random.unit()));
            (self.lower[i], self.upper[i]) = (self.minimiser[i] - widths[0], self.minimiser[i] + widths[1]);
            let slope = 0.1 + random.unit();
            match random.below(if needed { 2 } else { 3 }) {
                0 => (self.lower[i], self.normal[i]) = (self.minimiser[i], -slope),
                1 => (self.upper[i], self.normal[i]) = (self.minimiser[i], slope),
                _ => {}
            }
        }
    }

    /// Half-spaces of which so many are active at c.
    fn add_rows(&mut self, active: usize, random: &mut Random) {
        let n = self.minimiser.len();
        let rows = matrix(random, n + 2, n);
        let mut sides = &rows * &self.minimiser;
        for i in 0..n + 2 {
            let size = 0.2 + random.unit();
            if i < active {
                self.normal += rows.row(i).transpose() * size;
            } else {
                sides[i] += size;
            }
        }
        self.rows = (rows, sides);
    }

    /// h, m residuals at c, and a subgradient of h there.
    fn add_residuals(&mut self, m: usize, random: &mut Random) -> Vector {
        let n = self.minimiser.len();
        let (mut residuals, mut dual) = (entries(random, m, 2.0), Vector::zeros(m));
        match self.family {
            "L1 fit" => {
                self.outer = Outer::Absolute;
                residuals.rows_mut(0, n).fill(0.0);
                dual = residuals.map(|r| if r == 0.0 { 0.8 * random.signed() } else { r.signum() });
            }
            "sum of norms" => {
                let size = 2 + random.below(2);
                let sizes: Vec<usize> = (0..m).step_by(size).map(|first| size.min(m - first)).collect();
                for (group, &count) in sizes.iter().enumerate() {
                    let mut part = residuals.rows_mut(group * size, count);
                    let length = part.norm();
                    dual.rows_mut(group * size, count).copy_from(&(&part / length));
                    if random.below(2) == 0 {
                        part.fill(0.0);
                        dual.rows_mut(group * size, count).scale_mut(random.unit());
                    }
                }
                self.outer = Outer::Norms(sizes);
            }
            family => {
                let curved = family == "maximum plus square";
                let active = if curved { 1 + random.below(n) } else { m.min(n + 1) };
                for i in 0..m {
                    (residuals[i], dual[i]) =
                        if i < active { (0.0, 0.1 + random.unit()) } else { (-0.1 - residuals[i].abs(), 0.0) };
                }
                dual /= dual.sum();
                self.root = matrix(random, if curved { n } else { 0 }, n);
            }
        }
        self.residuals = residuals;
        dual
    }

    /// Problems of users in which the engine went wrong, with the units of their variables.
    pub fn of_users() -> Vec<(Self, Vector)> {
        const FAMILY: &str = "problems of users";
        let vector = Vector::from_column_slice;
        let of = |outer, minimiser: &[f64], slopes: Matrix, residuals: Vector| Self {
            slopes,
            residuals,
            ..Self::of(FAMILY, outer, vector(minimiser))
        };
        let boxed = |problem: Self, lower: &[f64], upper: &[f64]| Self {
            lower: vector(lower),
            upper: vector(upper),
            ..problem
        };
        // A modulus of 1e8 and a length of 1 in the largest of four affine functions.
        let rows = Matrix::from_row_slice(4, 2, &[1.0, 0.0, -1.0, 0.0, -0.1, -1.0, 0.0, 1.0]);
        let modulus = of(Outer::Largest, &[0.0, 1.0], rows, vector(&[0.0, 0.0, 0.0, -0.2]));
        let modulus = boxed(modulus, &[-1.0, 0.0], &[1.0, 2.0]);
        // Parabolas through nine points, the slope in a unit of 1e-4: by absolute deviations, by the largest one.
        let at = vector(&[0.05, 0.15, 0.3, 0.35, 0.5, 0.6, 0.75, 0.9, 1.0]);
        let data = vector(&[2.1, 3.4, 2.9, 4.2, 4.0, 5.6, 5.2, 7.3, 6.4]);
        let powers = Matrix::from_fn(9, 3, |i, j| at[i].powi(j as i32));
        let deviations = |c: &[f64]| &powers * vector(c) - &data;
        let both = Matrix::from_fn(18, 3, |i, j| if i < 9 { powers[(i, j)] } else { -powers[(i - 9, j)] });
        let absolute = [2079.0 / 1235.0, 2105.0 / 247.0, -940.0 / 247.0];
        let largest = [13.0 / 7.0, 5.8, -4.0 / 7.0];
        let largest_deviations = deviations(&largest);
        let signed = Vector::from_fn(18, |i, _| if i < 9 { largest_deviations[i] } else { -largest_deviations[i - 9] });
        // (y − 2)² over [0, 1], and y over [0, 5].
        let line = |slope, value| (Matrix::from_element(1, 1, slope), vector(&[value]));
        let ((down, one), (up, zero)) = (line(-2.0, 1.0), line(1.0, 0.0));
        let square = Self { root: Matrix::from_element(1, 1, 2_f64.sqrt()), ..of(Outer::Largest, &[1.0], down, one) };
        vec![
            (modulus, vector(&[1.0, 1e8])),
            (of(Outer::Absolute, &absolute, powers.clone(), deviations(&absolute)), vector(&[1.0, 1e4, 0.1])),
            (of(Outer::Largest, &largest, both, signed), vector(&[1.0, 1e4, 0.1])),
            (boxed(square, &[0.0], &[1.0]), vector(&[1.0])),
            (boxed(of(Outer::Largest, &[0.0], up, zero), &[0.0], &[5.0]), vector(&[1.0])),
        ]
    }

    /// Whether every variable has two finite bounds.
    pub fn is_boxed(&self) -> bool {
        self.lower.iter().chain(&self.upper).all(|side| side.is_finite())
    }

    /// The problem in variables x = D y, where D holds the units.
    pub fn in_units(&self, units: &Vector) -> Self {
        Self {
            slopes: columns_over(&self.slopes, units),
            root: columns_over(&self.root, units),
            minimiser: self.minimiser.component_mul(units),
            lower: self.lower.component_mul(units),
            upper: self.upper.component_mul(units),
            rows: (columns_over(&self.rows.0, units), self.rows.1.clone()),
            ..self.clone()
        }
    }

    /// The admissible set.
    pub fn set(&self) -> Polyhedron {
        let (rows, sides) = &self.rows;
        let open = Vector::from_element(sides.len(), f64::NEG_INFINITY);
        let set = Polyhedron::boxed(self.lower.clone(), self.upper.clone()).unwrap();
        set.with_rows(rows, &open, sides).unwrap()
    }

    /// The arguments of h and their Jacobian; the square is added to all of them, as h(r + t) = h(r) + t.
    pub fn outputs(&self, x: &Vector) -> (Vector, Matrix) {
        let way = x - &self.minimiser;
        let stretched = &self.root * &way;
        let outputs = (&self.slopes * &way + &self.residuals).add_scalar(0.5 * stretched.norm_squared());
        let gradient = self.root.tr_mul(&stretched).transpose();
        let mut jacobian = self.slopes.clone();
        jacobian.row_iter_mut().for_each(|mut row| row += &gradient);
        (outputs, jacobian)
    }

    pub fn value(&self, x: &Vector) -> f64 {
        self.outer.function().value(&self.outputs(x).0)
    }

    /// The mean rise one unit of every variable away from c.
    pub fn rise(&self) -> f64 {
        let (n, minimum) = (self.minimiser.len(), self.value(&self.minimiser));
        let moved = |i: usize, by: f64| {
            let mut point = self.minimiser.clone();
            point[i] += by;
            (self.value(&point) - minimum).abs()
        };
        (0..n).map(|i| moved(i, 1.0).max(moved(i, -1.0))).sum::<f64>() / n as f64
    }

    /// The size of the terms that the function is computed from: its rounding errors are some ε times as large.
    pub fn size_of_terms(&self, x: &Vector) -> f64 {
        let size = x.abs() + self.minimiser.abs();
        let square = (self.root.abs() * &size).norm_squared();
        (self.slopes.abs() * size + self.residuals.abs()).sum() + square
    }
}
