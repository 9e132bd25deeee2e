//! Taylor tables of the subgradient, and points where Θ is not differentiable, with the element returned there.
//!
//! ```text
//! t* : the contact status changes along a line,   Θ′(t*−) and Θ′(t*+) by one-sided differences of second order
//! min(Θ′−, Θ′+) ≤ ⟨ξ, d⟩ ≤ max(Θ′−, Θ′+)     for any element ξ of the subdifferential of the two pieces that meet
//! ```

use crate::accuracy::objective::{objective_of, perturbed};
use crate::markdown::{or_dash, section};
use crate::scaling::{SceneName, option_name};
use contact::equilibrium::ContactStatus;
use contact::load_cases::CaseStates;
use nonsmooth::verify::{TaylorTest, seeded_direction};
use nonsmooth::{Accuracy, StateSolver, Vector};
use problems::commands::{ContactObjective, Failure, smooth_taylor_test};
use serde::Serialize;

/// Relative error of the one-sided differences.
const SLACK: f64 = 1e-5;
/// Mesh of the constructed kinks.
const MESH: usize = 4;
/// Length of the line searched, relative to the height of the body, and the steps on it.
const REACH: (f64, usize) = (0.02, 40);
/// Most bisections; rounding ends them earlier.
const BISECTIONS: usize = 60;
/// First step of the one-sided differences, relative to the height of the body, and how often it is divided by four.
const DIFFERENCE: (f64, usize) = (2e-5, 4);

/// A Taylor test of a scene's objective.
#[derive(Debug, Serialize)]
struct TaylorStudy {
    scene: String,
    /// Remainders of the test per step.
    test: TaylorTest,
}

/// One kink on a line α + t d.
#[derive(Debug, Serialize)]
struct KinkRow {
    scene: String,
    /// Statuses that change at the kink, and how.
    change: String,
    /// The derivatives Θ′(t*−) and Θ′(t*+).
    before: f64,
    after: f64,
    /// ⟨ξ, d⟩ with the element returned at t*.
    product: f64,
    /// Nodes that the state at t* reports as weakly active.
    weakly_active: usize,
    /// Whether the one-sided slopes bracket the product, up to 1e-5 of the larger.
    bracketed: bool,
}

/// Taylor tables and kinks of the scenes.
#[derive(Debug, Serialize)]
pub struct SubgradientStudy {
    taylor: Vec<TaylorStudy>,
    kinks: Vec<KinkRow>,
}

impl SubgradientStudy {
    /// Makes a table per scene on a mesh, and constructs so many kinks of each.
    pub fn new(scenes: &[SceneName], taylor_mesh: usize, count: usize) -> Result<Self, Failure> {
        let (mut taylor, mut kinks) = (Vec::new(), Vec::new());
        for &scene in scenes {
            let objective = objective_of(scene, taylor_mesh)?;
            let (_, _, test) = smooth_taylor_test(&objective, &perturbed(&objective))?;
            taylor.push(TaylorStudy { scene: option_name(&scene), test });
            kinks.extend(kinks_of(scene, count)?);
        }
        Ok(Self { taylor, kinks })
    }

    /// The tables.
    pub fn markdown(&self) -> String {
        let tests = self.taylor.iter().map(|TaylorStudy { scene, test }| {
            vec![
                scene.clone(),
                format!("{:.6e}", test.directional_derivative),
                or_dash(test.fitted_slope, |slope| format!("{slope:.2}")),
                format!("{:.1e}", test.best_derivative_error),
            ]
        });
        let kinks = self.kinks.iter().map(|kink| {
            let mut cells = vec![kink.scene.clone(), kink.change.clone()];
            cells.extend([kink.before, kink.after, kink.product].map(|slope| format!("{slope:.6e}")));
            cells.push(if kink.bracketed { "yes" } else { "no" }.into());
            cells
        });
        let head = "where | change of status | slope before | slope after | ⟨ξ, d⟩ at the kink | bracketed";
        section("Taylor tables", "where | ⟨ξ, d⟩ | fitted slope | best relative error of the derivative", tests)
            + &section("Kinks", head, kinks)
    }
}

/// Θ along a line.
struct Line<'a> {
    objective: &'a ContactObjective,
    start: &'a Vector,
    direction: Vector,
}

/// A change of status between two places that rounding cannot separate, and the statuses there.
struct Change {
    places: [f64; 2],
    statuses: [Vec<ContactStatus>; 2],
}

impl Line<'_> {
    fn at(&self, t: f64) -> Vector {
        self.start + &self.direction * t
    }

    fn state(&self, t: f64) -> Result<CaseStates, Failure> {
        Ok(self.objective.cases().solve(&self.at(t), None, Accuracy::TIGHTEST)?)
    }

    fn status(&self, t: f64) -> Result<Vec<ContactStatus>, Failure> {
        Ok(self.state(t)?[0].forces.status.clone())
    }

    /// The first change of status on the line.
    fn change(&self, reach: f64) -> Result<Option<Change>, Failure> {
        let mut low = 0.0;
        let below = self.status(low)?;
        for step in 1..=REACH.1 {
            let mut high = reach * step as f64 / REACH.1 as f64;
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
            return Ok(Some(Change { places: [low, high], statuses: [below, above] }));
        }
        Ok(None)
    }

    /// One-sided slope at `t` towards `sign`, on the piece with the given status; none if no step stays on it.
    fn slope(&self, t: f64, sign: f64, status: &[ContactStatus], mut step: f64) -> Result<Option<f64>, Failure> {
        let value = |t: f64| -> Result<(f64, bool), Failure> {
            let state = self.state(t)?;
            Ok((self.objective.value(&state), state[0].forces.status == status))
        };
        let here = value(t)?.0;
        for _shortening in 0..=DIFFERENCE.1 {
            let ((near, on), (far, still)) = (value(t + sign * step)?, value(t + 2.0 * sign * step)?);
            if on && still {
                return Ok(Some(sign * (4.0 * near - far - 3.0 * here) / (2.0 * step)));
            }
            step /= 4.0;
        }
        Ok(None)
    }

    /// The first kink on the line; none where there is none, or another one next to it.
    fn kink(&self, scene: String) -> Result<Option<KinkRow>, Failure> {
        let height = self.start.mean();
        let Some(Change { places: [low, high], statuses: [below, above] }) = self.change(REACH.0 * height)? else {
            return Ok(None);
        };
        let before = self.slope(low, -1.0, &below, DIFFERENCE.0 * height)?;
        let after = self.slope(high, 1.0, &above, DIFFERENCE.0 * height)?;
        let (Some(before), Some(after)) = (before, after) else { return Ok(None) };
        let t = 0.5 * (low + high);
        let state = self.state(t)?;
        let product = self.objective.differentiate(&self.at(t), &state)?.subgradient.dot(&self.direction);
        let changed = below.iter().zip(&above).enumerate().filter(|(_, (below, above))| below != above);
        let changes: Vec<String> = changed
            .map(|(node, (below, above))| format!("node {node}: {below:?} to {above:?}").to_lowercase())
            .collect();
        let slack = SLACK * before.abs().max(after.abs());
        Ok(Some(KinkRow {
            scene,
            change: changes.join(", "),
            before,
            after,
            product,
            weakly_active: state[0].forces.kink.weakly_active,
            bracketed: before.min(after) - slack <= product && product <= before.max(after) + slack,
        }))
    }
}

/// `count` kinks of a scene, on lines from a perturbed shape in random directions.
fn kinks_of(scene: SceneName, count: usize) -> Result<Vec<KinkRow>, Failure> {
    let objective = objective_of(scene, MESH)?;
    let start = &perturbed(&objective);
    let line = |seed| Line { objective: &objective, start, direction: seeded_direction(start.len(), seed) };
    let kinks = (100..100 + 4 * count as u64).map(|seed| line(seed).kink(option_name(&scene)));
    kinks.filter_map(Result::transpose).take(count).collect()
}
