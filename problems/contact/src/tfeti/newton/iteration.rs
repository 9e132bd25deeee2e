//! Semismooth Newton for Coulomb friction on top of TFETI.
//!
//! ```text
//! residual:  (c (B_E u − c_E),  λ − Π(λ + c (B u − g))),     B u − g = d − Fλ + Gᵀa,     G λ = e in every iterate
//! ```
//! Every step solves the system of [`ReducedRows`] by projected GMRES, as accurately as the outer residual deserves
//! (Eisenstat–Walker). One product with F gives the particular part, one each Krylov vector; F is linear, so that step
//! lengths and the new residual are free.

use crate::equilibrium::certificate::projection_residual;
use crate::equilibrium::law::Linearization;
use crate::equilibrium::{ContactBoundary, Stage};
use crate::error::ContactError;
use crate::linear::vector::norm;
use crate::tfeti::dual::coarse_space::{CoarseProblem, CoarseSpace};
use crate::tfeti::newton::linear_solve::LinearAccuracy;
use crate::tfeti::newton::recycling::Recycled;
use crate::tfeti::{DualOperator, Precision, Preconditioner, ReducedRows};

/// Everything the iteration works with, for one shape.
#[derive(Debug)]
pub struct TornContact<'a> {
    /// F.
    pub operator: &'a DualOperator<'a>,
    /// G and e.
    pub space: &'a CoarseSpace,
    /// Preconditioner of F.
    pub preconditioner: &'a Preconditioner<'a>,
    /// Contact nodes.
    pub boundary: &'a ContactBoundary,
    /// d = B K⁺ f − g over all rows.
    pub constant: Vec<f64>,
    /// Initial gaps of the contact nodes, mm.
    pub gaps: &'a [f64],
    /// c, N/mm.
    pub stiffness: f64,
    /// Force that residuals are relative to, N.
    pub load: f64,
    /// Precision of products with search directions.
    pub precision: Precision,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonSettings {
    /// Relative residual aimed at.
    pub tolerance: f64,
    /// Relative residual that is accepted when rounding stops all progress.
    pub acceptable: f64,
    /// Newton steps allowed.
    pub max_steps: usize,
    /// Krylov iterations allowed per Newton step.
    pub max_krylov: usize,
    /// Whether dual directions are kept over a whole solve.
    pub recycling: Recycling,
}

impl NewtonSettings {
    /// Settings for a relative residual; 0 asks for all that rounding allows.
    pub fn to(tolerance: f64) -> Self {
        Self {
            tolerance: tolerance.max(TIGHTEST),
            acceptable: tolerance.max(1e-9),
            max_steps: 60,
            max_krylov: 400,
            recycling: Recycling::default(),
        }
    }
}

/// Use of the dual directions that a solve has already multiplied with F.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Recycling {
    /// On unless the coarse problem is so large that its repeated factorisation outweighs the products saved.
    #[default]
    Auto,
    /// Every product serves all later iterates: fewest products with F, more dense algebra.
    On,
    /// Newton steps with a GMRES of their own.
    Off,
}

/// Coarse unknowns up to which recycling is used: up to 7³ subdomains its coarse factorisations were seen to be affordable;
/// beyond, their cubic cost is expected to outweigh the products saved (not measured).
const RECYCLING_PAYS: usize = 2100;

impl Recycling {
    fn pays(self, space: &CoarseSpace) -> bool {
        match self {
            Self::Auto => space.resultants.len() <= RECYCLING_PAYS,
            Self::On => true,
            Self::Off => false,
        }
    }
}

/// Multipliers with their image under F, and what follows from them.
#[derive(Debug, Clone)]
pub struct Iterate {
    /// λ over all rows (scaled rows).
    pub multipliers: Vec<f64>,
    /// F λ.
    pub image: Vec<f64>,
    /// Rigid amplitudes a.
    pub amplitudes: Vec<f64>,
    /// w = B u − g over all rows.
    pub jumps: Vec<f64>,
}

/// The result of a Newton run.
#[derive(Debug, Clone)]
pub struct TornSolution {
    /// The last iterate.
    pub iterate: Iterate,
    /// Derivative selected at the solution.
    pub linearizations: Vec<Linearization>,
    /// Relative residual.
    pub residual: f64,
    /// Newton steps.
    pub steps: usize,
}

impl TornContact<'_> {
    /// Solves from given multipliers of a similar problem, or from the bonded problem. Where inexact steps do not converge, a
    /// second run solves every linear system as accurately as rounding allows. The residual that decides, and that certifies
    /// the state, comes from a fresh product with F.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] with the residual history, [`ContactError::BeyondPrecision`],
    /// [`ContactError::NotFinite`], [`ContactError::Unheld`] when an active set leaves a motion free.
    pub fn solve(&self, start: Option<&[f64]>, settings: &NewtonSettings) -> Result<TornSolution, ContactError> {
        let mut pairs = settings.recycling.pays(self.space).then(Recycled::default);
        let mut iterate = match start {
            Some(multipliers) => match self.restart(multipliers) {
                // Forces that hold the old shape but not the new one are no start.
                Err(ContactError::Unheld { .. }) => self.bonded(LinearAccuracy::START, pairs.as_mut())?,
                other => other?,
            },
            None => self.bonded(LinearAccuracy::START, pairs.as_mut())?,
        };
        let mut residual = self.residual(&iterate);
        let mut history = vec![residual];
        if let Some(mut pairs) = pairs {
            residual = self.descend(&mut iterate, &mut pairs, residual, settings, &mut history)?;
        }
        if residual > settings.tolerance || self.precision == Precision::Double {
            iterate = self.newton_steps(iterate, residual, false, settings, &mut history)?;
            residual = self.replace_image(&mut iterate);
        }
        if residual.is_nan() || residual > settings.acceptable {
            let exact = self.bonded(LinearAccuracy::EXACT, None)?;
            let start = self.residual(&exact);
            history.push(start);
            iterate = self.newton_steps(exact, start, true, settings, &mut history)?;
            residual = self.replace_image(&mut iterate);
        }
        if residual.is_nan() || residual > settings.acceptable {
            return Err(self.not_converged(residual, settings, history));
        }
        let linearizations = self.linearize(&iterate);
        Ok(TornSolution { iterate, linearizations, residual, steps: history.len() - 1 })
    }

    /// Newton steps until the residual is small, rounding stops them, or they lead nowhere.
    fn newton_steps(
        &self,
        mut iterate: Iterate,
        mut residual: f64,
        exact: bool,
        settings: &NewtonSettings,
        history: &mut Vec<f64>,
    ) -> Result<Iterate, ContactError> {
        let first = history.len() - 1;
        let budget = self.operator.applications() + MAX_PRODUCTS;
        let mut forcing = FIRST_FORCING;
        while residual > settings.tolerance && history.len() - first <= settings.max_steps {
            if (residual <= settings.acceptable && stagnates(history, 1))
                || circles(&history[first..])
                || self.operator.applications() > budget
            {
                break;
            }
            let target = forcing.max(0.3 * settings.tolerance / residual) * residual * self.load / self.stiffness;
            let accuracy = if exact { LinearAccuracy::EXACT } else { LinearAccuracy::to(target, settings.max_krylov) };
            let (rows, coarse) = self.held_at(&iterate)?;
            let candidate = self.linear_solve(&rows, &coarse, &iterate.multipliers, accuracy, None)?;
            let (next, length) = self.search(iterate, candidate, residual);
            iterate = next;
            let previous = residual;
            residual = self.residual(&iterate);
            if !residual.is_finite() {
                return Err(ContactError::NotFinite { what: "contact residual" });
            }
            history.push(residual);
            Stage::Contact.reached(history.len() - 1, residual);
            forcing = eisenstat_walker(residual, previous, length);
        }
        Ok(iterate)
    }

    /// |(c w_E, λ − Π(λ + c w))|₂ over the load.
    pub fn residual(&self, iterate: &Iterate) -> f64 {
        let equality = self.operator.model.constraints.equality_count;
        let glued = self.stiffness * norm(&iterate.jumps[..equality]);
        glued.hypot(norm(&self.law_residual(iterate))) / self.load
    }

    /// λ − Π(λ + c w) over the packed contact rows.
    pub fn law_residual(&self, iterate: &Iterate) -> Vec<f64> {
        let equality = self.operator.model.constraints.equality_count;
        let (forces, jumps) = (&iterate.multipliers[equality..], &iterate.jumps[equality..]);
        projection_residual(self.boundary, forces, jumps, self.stiffness)
    }

    /// The projection arguments x = λ + c w of all contact rows.
    pub fn arguments(&self, iterate: &Iterate) -> Vec<f64> {
        let equality = self.operator.model.constraints.equality_count;
        let pairs = iterate.multipliers[equality..].iter().zip(&iterate.jumps[equality..]);
        pairs.map(|(force, jump)| force + self.stiffness * jump).collect()
    }

    /// The derivative selected at every contact node.
    pub fn linearize(&self, iterate: &Iterate) -> Vec<Linearization> {
        let arguments = self.arguments(iterate);
        let points = self.boundary.points.iter();
        points
            .map(|point| {
                Linearization::at(&arguments[point.start..point.start + point.row_count()], self.boundary.friction)
            })
            .collect()
    }

    /// Row structure for given derivatives.
    pub fn reduced(&self, linearizations: Vec<Linearization>) -> ReducedRows<'_> {
        let equality = self.operator.model.constraints.equality_count;
        ReducedRows::new(self.boundary, equality, linearizations, self.stiffness)
    }

    /// Multipliers of a similar problem, corrected to the new resultants; amplitudes by least squares on the held rows.
    pub(crate) fn restart(&self, multipliers: &[f64]) -> Result<Iterate, ContactError> {
        let equality = self.operator.model.constraints.equality_count;
        let guess = |held_slip: bool| -> Vec<Linearization> {
            let points = self.boundary.points.iter();
            points
                .map(|point| {
                    let rows = equality + point.start..equality + point.start + point.row_count();
                    held_by_forces(&multipliers[rows], self.boundary.friction, held_slip)
                })
                .collect()
        };
        let held = self.reduced(guess(true));
        let coarse = self.coarse(&held, false)?;
        let mut unknowns = held.initial(multipliers);
        coarse.enforce(&mut unknowns, &self.space.resultants);
        let multipliers = held.expand(&unknowns, false);
        let image = self.operator.apply(&multipliers);
        let rows = self.reduced(guess(false));
        let coarse = self.coarse(&rows, false)?;
        let rest: Vec<f64> = self.constant.iter().zip(&image).map(|(d, image)| d - image).collect();
        let amplitudes = coarse.amplitudes(&rows.restrict(&rest, false));
        Ok(self.iterate(multipliers, image, amplitudes))
    }

    /// The iterate of given multipliers, their image and amplitudes.
    pub fn iterate(&self, multipliers: Vec<f64>, image: Vec<f64>, amplitudes: Vec<f64>) -> Iterate {
        let mut jumps = self.space.jumps(&amplitudes);
        for ((jump, d), image) in jumps.iter_mut().zip(&self.constant).zip(&image) {
            *jump += d - image;
        }
        Iterate { multipliers, image, amplitudes, jumps }
    }

    /// The coarse problem of an active set; refused if a rigid motion is left free.
    pub fn coarse(&self, rows: &ReducedRows<'_>, coulomb: bool) -> Result<CoarseProblem<'_>, ContactError> {
        let rows = self.reduced(rows.linearizations.clone());
        let coarse = CoarseProblem::new(self.space, rows, coulomb && self.boundary.has_friction());
        if coarse.pivot_ratio() < SINGULAR {
            return Err(ContactError::Unheld {
                pivot_ratio: coarse.pivot_ratio(),
                resultant: norm(&self.space.resultants),
            });
        }
        Ok(coarse)
    }

    /// Projected preconditioner: P (Qᵀ M Q + Z) v.
    pub fn precondition(&self, rows: &ReducedRows<'_>, v: &[f64], project: impl Fn(&mut [f64])) -> Vec<f64> {
        let mut z = rows.restrict(&self.preconditioner.apply(&rows.expand(v, false)), false);
        rows.add_spring(v, &mut z);
        project(&mut z);
        z
    }

    /// Halves the step until the residual falls; takes the full step when no length helps (a change of many statuses).
    fn search(&self, from: Iterate, to: Iterate, residual: f64) -> (Iterate, f64) {
        let mut length = 1.0;
        for _halving in 0..MAX_HALVINGS {
            let trial = if length == 1.0 { to.clone() } else { between(&from, &to, length) };
            if self.residual(&trial) <= (1.0 - SUFFICIENT_DECREASE * length) * residual {
                return (trial, length);
            }
            length *= 0.5;
        }
        (to, 1.0)
    }
}

/// Tightest relative residual aimed at: below it rounding decides.
const TIGHTEST: f64 = 2e-13;
/// First forcing term.
const FIRST_FORCING: f64 = 0.3;
/// Forcing after a shortened step.
const SHORTENED_FORCING: f64 = 0.01;
/// Pivot ratio of a coarse matrix that counts as singular.
const SINGULAR: f64 = 1e-13;
/// Products with F that one run of Newton steps may take.
const MAX_PRODUCTS: usize = 20_000;
/// Newton steps in which the best residual must at least halve.
const CIRCLING: usize = 16;
/// Step halvings.
const MAX_HALVINGS: usize = 6;
/// Decrease asked of a step.
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Whether the residual has not halved in the last `window` steps.
pub fn stagnates(history: &[f64], window: usize) -> bool {
    history.len() > window && history[history.len() - 1] > 0.5 * history[history.len() - 1 - window]
}

/// Whether the best residual of the last steps is no better than half of the best before.
fn circles(history: &[f64]) -> bool {
    let best = |part: &[f64]| part.iter().copied().fold(f64::INFINITY, f64::min);
    history.len() > 2 * CIRCLING && {
        let (before, last) = history.split_at(history.len() - CIRCLING);
        best(last) > 0.5 * best(before)
    }
}

/// Forcing term of the next step.
fn eisenstat_walker(residual: f64, previous: f64, length: f64) -> f64 {
    let forcing = FIRST_FORCING.min((0.5 * (residual / previous).powf(1.5)).max(1e-4));
    if length < 1.0 { forcing.min(SHORTENED_FORCING) } else { forcing }
}

/// The derivative that given forces suggest: open without force, slip on the cone, else stick.
fn held_by_forces(forces: &[f64], friction: f64, held_slip: bool) -> Linearization {
    if forces[0] <= 0.0 {
        return Linearization::Open;
    }
    let traction = crate::equilibrium::law::tangential_norm(forces);
    if held_slip || forces.len() == 1 || traction < (1.0 - 1e-9) * friction * forces[0] {
        return Linearization::Stick;
    }
    let second = if forces.len() > 2 { forces[2] / traction } else { 0.0 };
    Linearization::Slip { direction: [forces[1] / traction, second], ratio: 0.0 }
}

/// (1 − t)·from + t·to in every part.
fn between(from: &Iterate, to: &Iterate, t: f64) -> Iterate {
    let mix = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + t * (b - a)).collect();
    Iterate {
        multipliers: mix(&from.multipliers, &to.multipliers),
        image: mix(&from.image, &to.image),
        amplitudes: mix(&from.amplitudes, &to.amplitudes),
        jumps: mix(&from.jumps, &to.jumps),
    }
}
