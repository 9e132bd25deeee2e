//! Dimensionless results of a scene in N–mm and in N–m are equal: no tolerance depends on a unit.
//!
//! ```text
//! lengths × s, moduli and tractions / s²:   forces stay, displacements × s, pressures / s²
//! ```

use crate::stability::case::Case;
use crate::stability::checked_run::{difference_over, force_difference};
use crate::stability::contact::{Attempt, by_condensation, by_tfeti, wavy_controls};
use crate::stability::record::{CaseOutcome, Record};
use crate::stability::scenes::{block, footed, pair, stacked, with_loads};
use contact::body::elasticity::Material;
use contact::equilibrium::{ContactForces, ContactProblem};
use contact::error::SceneError;
use contact::scene::{CounterSurface, Master, Scene};
use std::sync::Arc;

const GROUP: &str = "units";
/// Largest difference of dimensionless results.
const EQUAL: f64 = 1e-10;

/// A scene with its unit of length changed: lengths × s at equal forces.
fn rescaled(scene: &Scene, s: f64) -> Result<Scene, SceneError> {
    let scene = scene.clone().with_blocks(|block| {
        block.size = block.size.map(|length| s * length);
        (block.bottom, block.top) = (surface(&block.bottom, s), surface(&block.top, s));
    });
    let mut scene = scene.with_shapes(|heights| {
        heights.start *= s;
        heights.thickness = heights.thickness.map(|thickness| s * thickness);
        heights.volume = heights.volume.map(|range| range.map(|volume| s.powi(3) * volume));
    });
    for contact in &mut scene.contacts {
        if let Master::Obstacle(obstacle) = &mut contact.master {
            *obstacle = surface(obstacle, s);
        }
    }
    for body in &mut scene.bodies {
        let material = body.material;
        body.material = Material::new(material.young_modulus() / (s * s), material.poisson_ratio())?
            .with_formulation(material.formulation());
        for load in &mut body.loads {
            *load = load.scaled(1.0 / (s * s));
        }
    }
    Ok(scene)
}

/// A surface with lengths × s.
fn surface(surface: &CounterSurface, s: f64) -> CounterSurface {
    match surface.clone() {
        CounterSurface::Waves { base, first, second, period, origin } => {
            let origin = origin.map(|x| s * x);
            CounterSurface::Waves { base: s * base, first: s * first, second: s * second, period: s * period, origin }
        }
        CounterSurface::Sphere { apex, radius, centre } => {
            CounterSurface::Sphere { apex: s * apex, radius: s * radius, centre: centre.map(|x| s * x) }
        }
        CounterSurface::Punch { height, half_width, relief, centre } => {
            let [height, half_width, relief, centre] = [height, half_width, relief, centre].map(|x| s * x);
            CounterSurface::Punch { height, half_width, relief, centre }
        }
        CounterSurface::Plane { height } => CounterSurface::Plane { height: s * height },
        CounterSurface::Grid(grid) => CounterSurface::Grid(grid.scaled(s)),
        other => other,
    }
}

/// Control heights of a scene.
type Heights = fn(&Scene) -> Vec<f64>;

fn flat_controls(scene: &Scene) -> Vec<f64> {
    scene.start()
}

fn solve(scene: Scene, heights: Heights, direct: bool) -> Result<(Attempt, f64), SceneError> {
    let (controls, length) = (heights(&scene), scene.start()[0]);
    let problem = Arc::new(ContactProblem::new(scene)?);
    let attempt = if direct { by_condensation(&problem, &controls) } else { by_tfeti(&problem, &controls) };
    Ok((attempt, length))
}

/// Openings over a length.
fn openings(forces: &ContactForces, length: f64) -> Vec<f64> {
    forces.opening.iter().map(|opening| opening / length).collect()
}

/// Strain that the normal forces stand for: openings of closed nodes are zero compared with it.
fn strain(scene: &Scene, forces: &ContactForces) -> f64 {
    let body = &scene.bodies[0];
    let area = body.block().map_or(1.0, |block| block.size[0] * block.size[1]);
    forces.total_normal_force() / (body.material.young_modulus() * area)
}

fn compare(record: &mut Record, scene: &Scene, s: f64, heights: Heights) -> Result<(CaseOutcome, String), SceneError> {
    let mut worst = 0.0_f64;
    for direct in [false, true] {
        let ((path, first), length) = solve(scene.clone(), heights, direct)?;
        let ((other_path, second), other_length) = solve(rescaled(scene, s)?, heights, direct)?;
        let (Some(first), Some(second)) = (first, second) else {
            let alike = path.refusal == other_path.refusal;
            let text = format!("refused in both units: {}", path.reason.unwrap_or_default());
            return Ok((if alike { CaseOutcome::Refused } else { CaseOutcome::Broken }, text));
        };
        let forces = force_difference(&first.forces, &second.forces);
        let (openings, floor) =
            ([openings(&first.forces, length), openings(&second.forces, other_length)], strain(scene, &first.forces));
        let gaps = difference_over(&openings[0], &openings[1], floor);
        // Sensitivities are forces per length.
        let times = |heights: &Result<Vec<f64>, String>, length: f64| -> Vec<f64> {
            heights.as_ref().map(|heights| heights.iter().map(|value| value * length).collect()).unwrap_or_default()
        };
        let slopes = difference_over(&times(&first.heights, length), &times(&second.heights, other_length), 0.0);
        if first.forces.status != second.forces.status {
            return Ok((CaseOutcome::Broken, "statuses differ".into()));
        }
        record.paths.push(path);
        record.force_difference = Some(record.force_difference.unwrap_or(0.0).max(forces));
        record.subgradient_difference = Some(record.subgradient_difference.unwrap_or(0.0).max(slopes));
        worst = worst.max(forces).max(gaps);
        if forces.is_nan() || gaps.is_nan() || slopes.is_nan() || slopes > 1e3 * EQUAL {
            worst = f64::NAN;
        }
    }
    let outcome = if worst <= EQUAL { CaseOutcome::Solved } else { CaseOutcome::Broken };
    Ok((outcome, format!("largest difference of dimensionless results {worst:.1e}")))
}

fn case(name: &'static str, scene: Result<Scene, SceneError>, s: f64, heights: Heights) -> Case {
    Case::new(GROUP, name, move || {
        let mut record = Record::default();
        let result = match &scene {
            Ok(scene) => compare(&mut record, scene, s, heights).map_err(|error| error.to_string()),
            Err(error) => Err(error.to_string()),
        };
        (record.outcome, record.remark) = result.unwrap_or_else(|reason| (CaseOutcome::Broken, reason));
        record
    })
}

pub fn cases() -> Vec<Case> {
    vec![
        case("block, N–mm against N–m", block(), 1e-3, wavy_controls),
        case("two bodies, N–mm against N–m", pair(), 1e-3, wavy_controls),
        case("stacked blocks, N–mm against N–µm", stacked(0.3, 1.0, 0.1), 1e3, flat_controls),
        case("held base, N–mm against N–km", footed(1e-4), 1e-6, flat_controls),
        case("load reversed, N–mm against N–m", with_loads(block(), -1.0), 1e-3, wavy_controls),
    ]
}
