//! Taylor tables of the subgradient, and its behaviour at kinks.

use crate::accuracy::algebra::perturbed;
use crate::accuracy::extent::{Extent, SCENES};
use crate::accuracy::kink::{self, KinkRow};
use crate::accuracy::objective::{norm, objective_of};
use nonsmooth::Vector;
use nonsmooth::verify::{Direction, TaylorTest, taylor_test};
use problems::commands::{DIRECTION_SEED, Failure, smooth_taylor_test, taylor_steps};
use problems::toy;
use serde::Serialize;

/// A Taylor test of a scene's objective.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TaylorStudy {
    /// Where: a scene or the toy.
    pub scene: String,
    /// Remainders of the test per step.
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

/// Makes the tables and constructs the kinks.
pub fn study(extent: Extent) -> Result<SubgradientStudy, Failure> {
    let (mut taylor, mut kinks) = (Vec::new(), kink::of_toy()?);
    for scene in SCENES {
        let objective = objective_of(scene, extent.taylor_mesh, norm())?;
        let control = perturbed(&objective);
        let (_, _, test) = smooth_taylor_test(&objective, &control)?;
        taylor.push(TaylorStudy { scene: crate::scaling::option_name(&scene), test });
        kinks.extend(kink::of_scene(scene, extent.kinks)?);
    }
    let smooth = Vector::from_row_slice(&[1.0, -0.5]);
    let test = taylor_test(&toy::toy_objective(), &smooth, &Direction::Seeded(DIRECTION_SEED), &taylor_steps(0.1))?;
    taylor.push(TaylorStudy { scene: "toy".into(), test });
    Ok(SubgradientStudy { taylor, kinks })
}
