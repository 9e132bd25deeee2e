//! Smooth programs with their nonlinear constraints as exact penalties ρ max(0, c₁, c₂, …).

use crate::composition::{Outer, Term};
use crate::dual::Dual;
use crate::table::{Record, records};

/// f + ρ max(0, c₁, c₂, …) as the maximum of f and all f + ρ cᵢ.
fn penalized(objective: Dual, weight: f64, constraints: impl IntoIterator<Item = Dual>) -> Vec<Dual> {
    let pieces: Vec<Dual> = constraints.into_iter().map(|c| &objective + weight * c).collect();
    [objective].into_iter().chain(pieces).collect()
}

/// Rosen and Suzuki.
pub fn rosen_suzuki(x: &[Dual]) -> Vec<Dual> {
    penalized(rosen_suzuki_objective(x), 10.0, rosen_suzuki_constraints(x, 1.0))
}

/// Rosen's and Suzuki's objective.
pub fn rosen_suzuki_objective(x: &[Dual]) -> Dual {
    form(x, [1.0, 1.0, 2.0, 1.0], [-5.0, -5.0, -21.0, 7.0])
}

/// Rosen's and Suzuki's constraints; the weight of x₁² in the third is 2 in Hock and Schittkowski 43, and 1 in the
/// collection of Lukšan and Vlček.
pub fn rosen_suzuki_constraints(x: &[Dual], weight: f64) -> [Dual; 3] {
    [
        form(x, [1.0, 1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0]) - 8.0,
        form(x, [1.0, 2.0, 1.0, 2.0], [-1.0, 0.0, 0.0, -1.0]) - 10.0,
        form(x, [weight, 1.0, 1.0, 0.0], [2.0, -1.0, 0.0, -1.0]) - 5.0,
    ]
}

/// Σ wᵢ xᵢ² + Σ cᵢ xᵢ.
fn form(x: &[Dual], weights: [f64; 4], linear: [f64; 4]) -> Dual {
    let squares: Vec<Dual> = x.iter().map(Dual::square).collect();
    Dual::combination(weights.into_iter().zip(&squares)) + Dual::combination(linear.into_iter().zip(x))
}

/// Data of Colville's first problem: Σ dⱼ xⱼ³ + xᵀ C x + eᵀ x subject to A x ≥ b.
pub struct Colville {
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
    c: Vec<Vec<f64>>,
    d: Vec<f64>,
    e: Vec<f64>,
}

impl Colville {
    /// The data of the record.
    pub fn new(record: &Record) -> Self {
        let (a, c) = (record.matrix("a"), record.matrix("c"));
        Self { a, b: record.vector("b"), c, d: record.vector("d"), e: record.vector("e") }
    }

    /// The data of the published table.
    ///
    /// # Panics
    /// When the table lacks the problem, which the tests rule out.
    pub fn published() -> Self {
        let record = records().into_iter().find(|record| record.name == "Colville1");
        Self::new(&record.expect("Colville's first problem is in the table"))
    }

    /// The number of variables of the first problem.
    pub fn dimension(&self) -> usize {
        self.d.len()
    }

    /// The negative objective of the dual, 2 Σ dⱼ yⱼ³ + yᵀ C y − bᵀ w, at points that satisfy its constraints.
    pub fn dual_value(&self, y: &[Dual], w: &[Dual]) -> Dual {
        2.0 * self.cubic(y) + self.quadratic(y) - dot(&self.b, w)
    }

    /// The constraints of the dual, Aᵀ w − 2 C y − 3 d y² − e ≤ 0.
    pub fn stationarity(&self, y: &[Dual], w: &[Dual]) -> Vec<Dual> {
        let row = |j: usize| {
            let multipliers = Dual::combination(self.a.iter().zip(w).map(|(row, w)| (row[j], w)));
            let quadratic = 2.0 * Dual::combination(self.c.iter().zip(y).map(|(row, y)| (row[j], y)));
            multipliers - quadratic - 3.0 * self.d[j] * y[j].square() - self.e[j]
        };
        (0..y.len()).map(row).collect()
    }

    fn cubic(&self, x: &[Dual]) -> Dual {
        let cubes: Vec<Dual> = x.iter().map(|x| x.powi(3)).collect();
        dot(&self.d, &cubes)
    }

    fn quadratic(&self, x: &[Dual]) -> Dual {
        Dual::sum(self.c.iter().zip(x).map(|(row, x_i)| x_i * dot(row, x)))
    }
}

/// Colville's first problem with weight 50 on the largest violation.
pub fn colville(data: Colville) -> impl Fn(&[Dual]) -> Vec<Dual> {
    move |x| {
        let objective = data.cubic(x) + data.quadratic(x) + dot(&data.e, x);
        penalized(objective, 50.0, data.a.iter().zip(&data.b).map(|(row, &b)| b - dot(row, x)))
    }
}

/// The dual of Colville's first problem with weight 100 on the sum of the violations; x = (y, w).
///
/// ```text
/// 2 |c₁| + c₂ + 100 Σ max(cᵢ, 0)
/// ```
pub fn shell_dual(data: Colville) -> impl Fn(&[Dual]) -> Vec<Dual> {
    move |x| {
        let (y, w) = x.split_at(data.d.len());
        let objective = [data.cubic(y), data.quadratic(y) - dot(&data.b, w)];
        objective.into_iter().chain(data.stationarity(y, w)).chain(x.iter().map(|x| -x)).collect()
    }
}

/// The weights of [`shell_dual`] for a number of violations.
pub fn shell_dual_outer(violations: usize) -> Outer {
    let penalties = vec![(100.0, Term::PositivePart); violations];
    Outer::Sum([vec![(2.0, Term::Magnitude), (1.0, Term::Itself)], penalties].concat())
}

/// Wong's first problem (Hock and Schittkowski 100), weight 10.
pub fn wong1(x: &[Dual]) -> Vec<Dual> {
    penalized(wong1_objective(x), 10.0, wong1_constraints(x))
}

/// The objective of Wong's first problem.
pub fn wong1_objective(x: &[Dual]) -> Dual {
    (&x[0] - 10.0).square()
        + 5.0 * (&x[1] - 12.0).square()
        + x[2].powi(4)
        + 3.0 * (&x[3] - 11.0).square()
        + 10.0 * x[4].powi(6)
        + 7.0 * x[5].square()
        + x[6].powi(4)
        - 4.0 * &x[5] * &x[6]
        - 10.0 * &x[5]
        - 8.0 * &x[6]
}

/// The constraints of Wong's first problem.
pub fn wong1_constraints(x: &[Dual]) -> [Dual; 4] {
    [
        2.0 * x[0].square() + 3.0 * x[1].powi(4) + &x[2] + 4.0 * x[3].square() + 5.0 * &x[4] - 127.0,
        7.0 * &x[0] + 3.0 * &x[1] + 10.0 * x[2].square() + &x[3] - &x[4] - 282.0,
        23.0 * &x[0] + x[1].square() + 6.0 * x[5].square() - 8.0 * &x[6] - 196.0,
        4.0 * x[0].square() + x[1].square() - 3.0 * &x[0] * &x[1] + 2.0 * x[2].square() + 5.0 * &x[5] - 11.0 * &x[6],
    ]
}

/// Wong's third problem with all seventeen constraints, weight 10.
pub fn wong3(x: &[Dual]) -> Vec<Dual> {
    penalized(wong_objective(x), 10.0, wong3_constraints(x).into_iter().chain(wong3_rows(x)))
}

/// Wong's third problem with its thirteen nonlinear constraints penalized.
pub fn wong3_linear(x: &[Dual]) -> Vec<Dual> {
    penalized(wong_objective(x), 10.0, wong3_constraints(x))
}

/// The linear constraints of Wong's second problem.
pub fn wong2_rows(x: &[Dual]) -> [Dual; 3] {
    [
        4.0 * &x[0] + 5.0 * &x[1] - 3.0 * &x[6] + 9.0 * &x[7] - 105.0,
        10.0 * &x[0] - 8.0 * &x[1] - 17.0 * &x[6] + 2.0 * &x[7],
        -8.0 * &x[0] + 2.0 * &x[1] + 5.0 * &x[8] - 2.0 * &x[9] - 12.0,
    ]
}

/// The linear constraints of Wong's third problem.
pub fn wong3_rows(x: &[Dual]) -> Vec<Dual> {
    wong2_rows(x).into_iter().chain([&x[0] + &x[1] + 4.0 * &x[10] - 21.0 * &x[11]]).collect()
}

/// The objective of Wong's second problem in ten variables, or of his third in twenty.
pub fn wong_objective(x: &[Dual]) -> Dual {
    let centred = [
        (2, 1.0, 10.0),
        (3, 4.0, 5.0),
        (4, 1.0, 3.0),
        (5, 2.0, 1.0),
        (6, 5.0, 0.0),
        (7, 7.0, 11.0),
        (8, 2.0, 10.0),
        (9, 1.0, 7.0),
        (10, 1.0, 9.0),
        (11, 10.0, 1.0),
        (12, 5.0, 7.0),
        (13, 4.0, 14.0),
        (14, 27.0, 1.0),
        (16, 1.0, 2.0),
        (17, 13.0, 2.0),
        (18, 1.0, 3.0),
        (19, 1.0, 0.0),
    ];
    let coupled = x[0].square() + x[1].square() + &x[0] * &x[1] - 14.0 * &x[0] - 16.0 * &x[1];
    let own = centred.into_iter().filter(|(i, ..)| *i < x.len());
    let squares = own.map(|(i, weight, centre)| weight * (&x[i] - centre).square());
    let common = Dual::sum(squares) + coupled;
    if x.len() > 15 { common + x[15].powi(4) + 95.0 } else { common + 45.0 }
}

/// The nonlinear constraints of Wong's second problem.
pub fn wong2_constraints(x: &[Dual]) -> [Dual; 5] {
    let [a, b] = [&x[0], &x[1]];
    [
        3.0 * (a - 2.0).square() + 4.0 * (b - 3.0).square() + 2.0 * x[2].square() - 7.0 * &x[3] - 120.0,
        5.0 * a.square() + 8.0 * b + (&x[2] - 6.0).square() - 2.0 * &x[3] - 40.0,
        0.5 * (a - 8.0).square() + 2.0 * (b - 4.0).square() + 3.0 * x[4].square() - &x[5] - 30.0,
        a.square() + 2.0 * (b - 2.0).square() - 2.0 * a * b + 14.0 * &x[4] - 6.0 * &x[5],
        -3.0 * a + 6.0 * b + 12.0 * (&x[8] - 8.0).square() - 7.0 * &x[9],
    ]
}

/// The nonlinear constraints of Wong's third problem.
pub fn wong3_constraints(x: &[Dual]) -> Vec<Dual> {
    let [a, b] = [&x[0], &x[1]];
    let further = [
        a.square() + 15.0 * &x[10] - 8.0 * &x[11] - 28.0,
        4.0 * a + 9.0 * b + 5.0 * x[12].square() - 9.0 * &x[13] - 87.0,
        3.0 * a + 4.0 * b + 3.0 * (&x[12] - 6.0).square() - 14.0 * &x[13] - 10.0,
        14.0 * a.square() + 35.0 * &x[14] - 79.0 * &x[15] - 92.0,
        15.0 * b.square() + 11.0 * &x[14] - 61.0 * &x[15] - 54.0,
        5.0 * a.square() + 2.0 * b + 9.0 * x[16].powi(4) - &x[17] - 68.0,
        a.square() - b + 19.0 * &x[18] - 20.0 * &x[19] + 19.0,
        7.0 * a.square() + 5.0 * b.square() + x[18].square() - 30.0 * &x[19],
    ];
    wong2_constraints(x).into_iter().chain(further).collect()
}

/// Alkylation process (Hock and Schittkowski 114), weight 500; an equation is a pair of inequalities.
pub fn hs114(x: &[Dual]) -> Vec<Dual> {
    let tolerance = 0.99;
    let objective = 5.04 * &x[0] + 0.035 * &x[1] + 10.0 * &x[2] + 3.36 * &x[4] - 0.063 * &x[3] * &x[6];
    let yield_ = 1.12 * &x[0] + &x[0] * &x[7] * (0.13167 - 0.00667 * &x[7]);
    let octane = 57.425 + &x[7] * (1.098 - 0.038 * &x[7]) + 0.325 * &x[5];
    let strength = 98_000.0 * &x[2] / (&x[3] * &x[8] + 1000.0 * &x[2]) - &x[5];
    let ratio = (&x[1] + &x[4]) / &x[0] - &x[7];
    let constraints = [
        &yield_ - &x[3] / tolerance,
        tolerance * &x[3] - &yield_,
        &octane - &x[6] / tolerance,
        tolerance * &x[6] - &octane,
        strength.clone(),
        -strength,
        ratio.clone(),
        -ratio,
    ];
    penalized(objective, 500.0, constraints)
}

/// Dembo's fifth problem, heat exchangers in geometric form (Hock and Schittkowski 106), weight 10⁵.
pub fn dembo5(x: &[Dual]) -> Vec<Dual> {
    penalized(&x[0] + &x[1] + &x[2], 1e5, dembo5_constraints(x))
}

/// The nonlinear constraints of Dembo's fifth problem.
pub fn dembo5_constraints(x: &[Dual]) -> [Dual; 3] {
    [
        (100.0 + (833.332_52 * &x[3] - 83_333.333) / &x[0]) / &x[5] - 1.0,
        (&x[3] + 1250.0 * (&x[4] - &x[3]) / &x[1]) / &x[6] - 1.0,
        (&x[4] + (1.25e6 - 2500.0 * &x[4]) / &x[2]) / &x[7] - 1.0,
    ]
}

fn dot(weights: &[f64], x: &[Dual]) -> Dual {
    Dual::combination(weights.iter().copied().zip(x))
}
