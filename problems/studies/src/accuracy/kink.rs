//! Points where Θ is not differentiable, constructed by bisection along a line, and the element returned there.
//!
//! ```text
//! t* : the contact status changes,   Θ′(t*−) and Θ′(t*+) by one-sided differences of second order
//! min(Θ′−, Θ′+) ≤ ⟨ξ, d⟩ ≤ max(Θ′−, Θ′+)     for any element ξ of the subdifferential of the two pieces that meet
//! ```

use crate::accuracy::objective::{norm, objective_of};
use crate::scaling::SceneName;
use contact::equilibrium::ContactStatus;
use contact::load_cases::CaseStates;
use nonsmooth::verify::seeded_direction;
use nonsmooth::{Accuracy, NonsmoothObjective, Request, StateSolver, Vector};
use problems::commands::{ContactObjective, Failure};
use problems::toy::{self, ToyObjective};
use serde::Serialize;

/// One kink on a line α + t d.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KinkRow {
    /// Where: a scene or the toy.
    pub scene: String,
    /// Statuses that change at the kink, and how.
    pub change: String,
    /// The position t* of the kink, mm.
    pub position: f64,
    /// The derivative Θ′(t*−).
    pub before: f64,
    /// The derivative Θ′(t*+).
    pub after: f64,
    /// ⟨ξ, d⟩ with the element returned at t*.
    pub product: f64,
    /// Nodes that the state at t* reports as weakly active.
    pub weakly_active: usize,
    /// Whether the one-sided slopes bracket the product, up to 1e-5 of the larger.
    pub bracketed: bool,
}

/// Relative error of the one-sided differences.
pub const SLACK: f64 = 1e-5;
/// Mesh of the constructed kinks.
pub const MESH: usize = 4;
/// Length of the line searched, relative to the height of the body.
const REACH: f64 = 0.02;
/// Number of steps on that line.
const STEPS: usize = 40;
/// Most bisections; rounding ends them earlier.
const BISECTIONS: usize = 60;
/// First step of the one-sided differences, relative to the height of the body, and how often it is divided by four.
const DIFFERENCE: f64 = 2e-5;
const SHORTENINGS: usize = 4;

/// Θ along a line.
struct Line<'a> {
    objective: &'a ContactObjective,
    start: Vector,
    direction: Vector,
}

impl Line<'_> {
    fn at(&self, t: f64) -> Vector {
        &self.start + &self.direction * t
    }

    fn state(&self, t: f64) -> Result<CaseStates, Failure> {
        Ok(self.objective.cases().solve(&self.at(t), None, Accuracy::TIGHTEST)?)
    }

    fn status(&self, t: f64) -> Result<Vec<ContactStatus>, Failure> {
        Ok(self.state(t)?[0].forces.status.clone())
    }

    /// The first change of status on the line: t below and above it, and the statuses there.
    fn change(&self, reach: f64) -> Result<Option<Change>, Failure> {
        let mut low = 0.0;
        let below = self.status(low)?;
        for step in 1..=STEPS {
            let mut high = reach * step as f64 / STEPS as f64;
            let mut above = self.status(high)?;
            if above == below {
                low = high;
                continue;
            }
            for _bisection in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                let status = self.status(middle)?;
                if status == below { low = middle } else { (high, above) = (middle, status) }
            }
            return Ok(Some(Change { low, high, below, above }));
        }
        Ok(None)
    }

    /// One-sided slope at `t` towards `sign`, on the piece with the given status; none if no step stays on it.
    fn slope(&self, t: f64, sign: f64, status: &[ContactStatus], step: f64) -> Result<Option<f64>, Failure> {
        let value = |t: f64| -> Result<(f64, bool), Failure> {
            let state = self.state(t)?;
            Ok((self.objective.value(&state), state[0].forces.status == status))
        };
        let here = value(t)?.0;
        let mut step = step;
        for _shortening in 0..=SHORTENINGS {
            let ((near, on), (far, still)) = (value(t + sign * step)?, value(t + 2.0 * sign * step)?);
            if on && still {
                return Ok(Some(sign * (4.0 * near - far - 3.0 * here) / (2.0 * step)));
            }
            step /= 4.0;
        }
        Ok(None)
    }
}

struct Change {
    low: f64,
    high: f64,
    below: Vec<ContactStatus>,
    above: Vec<ContactStatus>,
}

/// `count` kinks of a scene, on lines from a perturbed shape in random directions.
pub fn of_scene(scene: SceneName, count: usize) -> Result<Vec<KinkRow>, Failure> {
    let objective = objective_of(scene, MESH, norm())?;
    let start = crate::accuracy::algebra::perturbed(&objective);
    let height = start.mean();
    let mut rows = Vec::new();
    for seed in 0..4 * count as u64 {
        if rows.len() == count {
            break;
        }
        let line =
            Line { objective: &objective, start: start.clone(), direction: seeded_direction(start.len(), seed + 100) };
        let Some(change) = line.change(REACH * height)? else { continue };
        let t = 0.5 * (change.low + change.high);
        let before = line.slope(change.low, -1.0, &change.below, DIFFERENCE * height)?;
        let after = line.slope(change.high, 1.0, &change.above, DIFFERENCE * height)?;
        let (Some(before), Some(after)) = (before, after) else { continue };
        let state = line.state(t)?;
        let product = objective.differentiate(&line.at(t), &state)?.subgradient.dot(&line.direction);
        rows.push(KinkRow {
            scene: crate::scaling::option_name(&scene),
            change: change_text(&change),
            position: t,
            before,
            after,
            product,
            weakly_active: state[0].forces.kink.weakly_active,
            bracketed: bracketed(product, before, after),
        });
    }
    Ok(rows)
}

fn change_text(change: &Change) -> String {
    let changed = change.below.iter().zip(&change.above).enumerate().filter(|(_, (below, above))| below != above);
    let changes: Vec<String> =
        changed.map(|(node, (below, above))| format!("node {node}: {below:?} to {above:?}").to_lowercase()).collect();
    changes.join(", ")
}

fn bracketed(product: f64, before: f64, after: f64) -> bool {
    let slack = SLACK * before.abs().max(after.abs());
    before.min(after) - slack <= product && product <= before.max(after) + slack
}

/// All kinks of the toy's first node, with the one-sided slopes in closed form.
///
/// # Errors
/// [`Failure`] never: the toy is defined everywhere.
pub fn of_toy() -> Result<Vec<KinkRow>, Failure> {
    let objective = toy::toy_objective();
    let [first, second] = toy::SURFACE;
    let determinant = first[0] * second[1] - first[1] * second[0];
    let mut rows = Vec::new();
    for kink in objective.solver().nodes()[0].kinks() {
        let heights = [kink.height, 0.3];
        let point = Vector::from_row_slice(&[
            (second[1] * heights[0] - first[1] * heights[1]) / determinant,
            (first[0] * heights[1] - second[0] * heights[0]) / determinant,
        ]);
        // The support of the first node rises, that of the second stays.
        let direction = Vector::from_row_slice(&[second[1] / determinant, -second[0] / determinant]);
        let slopes: Vec<f64> =
            toy::clarke_vertices(&objective, &point)?.iter().map(|vertex| vertex.dot(&direction)).collect();
        let evaluation = objective.evaluate(&Request::tight(&point))?.into_evaluation();
        let product = evaluation.subgradient.dot(&direction);
        let side = |sign: f64| one_sided(&objective, &point, &direction, sign);
        let (before, after) = (side(-1.0)?, side(1.0)?);
        let known = |slope: f64| slopes.iter().any(|other| (other - slope).abs() <= SLACK * slope.abs().max(1.0));
        rows.push(KinkRow {
            scene: "toy".into(),
            change: format!("node 0: {} to {}", kink.below, kink.above),
            position: 0.0,
            before,
            after,
            product,
            weakly_active: 1,
            bracketed: bracketed(product, before, after) && known(before) && known(after),
        });
    }
    Ok(rows)
}

fn one_sided(objective: &ToyObjective, point: &Vector, direction: &Vector, sign: f64) -> Result<f64, Failure> {
    const STEP: f64 = 1e-4;
    let value = |t: f64| -> Result<f64, Failure> {
        Ok(objective.evaluate(&Request::tight(&(point + direction * t)))?.into_evaluation().value)
    };
    Ok(sign * (4.0 * value(sign * STEP)? - value(2.0 * sign * STEP)? - 3.0 * value(0.0)?) / (2.0 * STEP))
}
