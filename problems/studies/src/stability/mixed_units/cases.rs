//! All problems of the study, each with units, an offset and the ways in which the engine gets it.

use crate::stability::mixed_units::fits::{FITS, entries, fit};
use crate::stability::mixed_units::problem::{Problem, Start};
use crate::stability::mixed_units::reported::reported;
use crate::stability::mixed_units::vertices::{VERTICES, vertex};
use nonsmooth::Vector;
use serde::Serialize;
use testset::kit::Random;

/// Largest decimal exponent of the units.
pub const LARGEST_SPREAD: usize = 8;
/// Offsets of Θ, in turn.
const OFFSETS: [f64; 3] = [0.0, 100.0, -1e4];
/// Fits of a family and a spread, in a box and without one.
const FIT_COUNTS: [usize; 2] = [8, 16];
/// Problems with a chosen minimiser, of a family and a spread.
const VERTEX_COUNT: usize = 6;
/// Further problems of either kind whose starts are at the minimiser.
const MINIMISER_COUNT: usize = 2;
/// Entries of random starts in variables of unit 1.
const AFAR: f64 = 8.0;

/// What the engine is told besides values and subgradients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Given {
    /// Neither convexity nor outputs are declared.
    Nothing,
    /// Convexity of Θ is declared.
    Convexity,
    /// The outputs, their Jacobian and the outer function are given.
    Outputs,
}

impl Given {
    /// Everything that may be declared.
    pub const ALL: [Self; 3] = [Self::Nothing, Self::Convexity, Self::Outputs];

    /// The declaration in names of cases.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "plain",
            Self::Convexity => "convex",
            Self::Outputs => "outputs",
        }
    }
}

/// A problem in units.
#[derive(Debug, Clone)]
pub struct UnitCase {
    /// The problem in variables of unit 1, with its starts.
    pub problem: Problem,
    /// Units D of the variables.
    pub units: Vector,
    /// Largest decimal exponent of the units.
    pub spread: usize,
    /// The constant added to Θ.
    pub offset: f64,
    /// Number among the problems of the same family, set, spread and kind of start.
    pub number: usize,
}

impl UnitCase {
    /// The name of a run: family, what is given, set, spread, start, offset, and the numbers of problem and start.
    pub fn name(&self, given: Given, index: usize) -> String {
        let set = match (self.problem.is_boxed(), self.problem.sides.len()) {
            (true, _) => "box",
            (false, 0) => "free",
            (false, _) => "rows",
        };
        let start = self.problem.starts[index].name();
        let Self { problem, spread, offset, number, .. } = self;
        format!("{}, {}, {set}, 1e{spread}, {start}, {offset:+}, #{number}.{index}", problem.family, given.name())
    }
}

/// Units 10^u with u uniform in [−spread, spread]; in every second problem, all but one are 1.
fn units(random: &mut Random, n: usize, spread: usize, number: usize) -> Vector {
    let largest = spread as f64;
    if number.is_multiple_of(2) {
        return Vector::from_fn(n, |_, _| 10_f64.powf(largest * random.signed()));
    }
    // A large unit hides a variable more often than a small one: its derivatives are small beside the others.
    let (one, sign) = (random.below(n), if random.below(4) == 0 { -1.0 } else { 1.0 });
    Vector::from_fn(n, |i, _| if i == one { 10_f64.powf(sign * largest) } else { 1.0 })
}

/// The generator of the problems of one kind and spread; another one for every number.
fn generator(kind: usize, spread: usize, number: usize) -> Random {
    Random((kind * 1_000_000 + spread * 10_000 + number) as u64)
}

fn in_units(problem: Problem, spread: usize, number: usize, random: &mut Random) -> UnitCase {
    let units = units(random, problem.lower.len(), spread, number);
    UnitCase { problem, units, spread, offset: OFFSETS[number % OFFSETS.len()], number }
}

/// From zero with all offsets, twice, then from afar with all of them.
fn usual_start(number: usize, n: usize, random: &mut Random) -> Vec<Start> {
    let afar = Start::Random(entries(random, n, AFAR));
    vec![if (number / OFFSETS.len()) % 3 < 2 { Start::Zero } else { afar }]
}

/// Starts at the minimiser; beyond it where there are bounds.
fn minimiser_starts(boxed: bool) -> Vec<Start> {
    if boxed { vec![Start::Minimiser, Start::Beyond] } else { vec![Start::Minimiser] }
}

/// The random problems of a spread.
fn of_spread(spread: usize) -> Vec<UnitCase> {
    let mut all = vec![];
    for (kind, (family, boxed)) in FITS.into_iter().flat_map(|family| [(family, true), (family, false)]).enumerate() {
        let usual = if boxed { FIT_COUNTS[0] } else { FIT_COUNTS[1] };
        for number in 0..usual + MINIMISER_COUNT {
            let mut random = generator(kind, spread, number);
            let problem = fit(family, number, boxed, &mut random);
            let n = problem.lower.len();
            // Only the minimisers of linear programs, which the first two families are, are known to the last digits.
            let starts = match (number < usual, kind < 4) {
                (true, _) => usual_start(number, n, &mut random),
                (false, true) => minimiser_starts(boxed),
                (false, false) => continue,
            };
            all.push(in_units(problem.with_starts(starts), spread, number, &mut random));
        }
    }
    for (kind, family) in VERTICES.into_iter().enumerate() {
        for number in 0..VERTEX_COUNT + MINIMISER_COUNT {
            let mut random = generator(2 * FITS.len() + kind, spread, number);
            let problem = vertex(family, number, &mut random);
            let (n, boxed) = (problem.lower.len(), problem.is_boxed());
            let usual = number < VERTEX_COUNT;
            let starts = if usual { usual_start(number, n, &mut random) } else { minimiser_starts(boxed) };
            all.push(in_units(problem.with_starts(starts), spread, number, &mut random));
        }
    }
    all
}

/// The problems of users, with every offset.
fn of_users() -> Vec<UnitCase> {
    let of = |(number, (problem, units)): (usize, (Problem, Vector))| {
        let spread = units.iter().map(|unit| unit.log10().abs().round() as usize).max().unwrap_or(0);
        OFFSETS.map(|offset| UnitCase { problem: problem.clone(), units: units.clone(), spread, offset, number })
    };
    reported().into_iter().enumerate().flat_map(of).collect()
}

/// All problems: the random ones by spread, from equal units on, then those of users.
pub fn cases() -> Vec<UnitCase> {
    (0..=LARGEST_SPREAD).flat_map(of_spread).chain(of_users()).collect()
}
