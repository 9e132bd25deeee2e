//! Taylor tables of the subgradient, and its behaviour at kinks.

use crate::accuracy::algebra::bent;
use crate::accuracy::extent::{Extent, SCENES};
use crate::accuracy::kink::{self, KinkRow};
use crate::accuracy::objective::{norm, objective_of};
use nonsmooth::verify::{Direction, TaylorTest, seeded_direction, taylor_test};
use nonsmooth::{Accuracy, StateSolver, Vector};
use problems::commands::{Failure, smooth_step};
use problems::toy;
use serde::Serialize;

/// A Taylor table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TaylorStudy {
    /// Where: a scene or the toy.
    pub scene: String,
    /// The table.
    pub test: TaylorTest,
}

/// Taylor tables and kinks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SubgradientStudy {
    /// One table per scene, then the toy's.
    pub taylor: Vec<TaylorStudy>,
    /// The toy's kinks, then those of the scenes.
    pub kinks: Vec<KinkRow>,
}

/// Steps of a table and their ratio.
const STEPS: i32 = 9;
const RATIO: f64 = 0.316_227_766_016_837_94;
/// Seed of the directions.
const SEED: u64 = 20_231;

/// Makes the tables and constructs the kinks.
///
/// # Errors
/// [`Failure`] from a scene or a solver.
pub fn study(extent: Extent) -> Result<SubgradientStudy, Failure> {
    let (mut taylor, mut kinks) = (Vec::new(), kink::of_toy()?);
    for scene in SCENES {
        let objective = objective_of(scene, extent.taylor_mesh(), norm())?;
        let control = bent(&objective);
        let direction = seeded_direction(control.len(), SEED);
        let here = objective.solver().solve(&control, None, Accuracy::TIGHTEST)?;
        let step = smooth_step(&objective, &control, &direction, &here.forces.status)?;
        let test = taylor_test(&objective, &control, &Direction::Given(direction), &steps(step))?;
        taylor.push(TaylorStudy { scene: crate::scaling::word(&scene), test });
        kinks.extend(kink::of_scene(scene, extent.kinks())?);
    }
    let smooth = Vector::from_row_slice(&[1.0, -0.5]);
    let test = taylor_test(&toy::toy_objective(), &smooth, &Direction::Seeded(SEED), &steps(0.1))?;
    taylor.push(TaylorStudy { scene: "toy".into(), test });
    Ok(SubgradientStudy { taylor, kinks })
}

fn steps(largest: f64) -> Vec<f64> {
    (0..STEPS).map(|index| largest * RATIO.powi(index)).collect()
}
