//! Dimensionless results of a scene in N–mm and in N–m are equal: no tolerance depends on a unit.
//!
//! ```text
//! lengths × s, moduli and tractions / s²:   forces stay, displacements × s, sensitivities / s
//! ```

use crate::stability::case::{Case, CaseOutcome, Record};
use crate::stability::contact::{Attempt, difference_over, force_difference, wavy_controls};
use crate::stability::scenes::{block, footed, pair, stacked, with_loads};
use contact::body::elasticity::Material;
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::scene::{CounterSurface, Master, Scene};
use std::sync::Arc;

/// Largest difference of dimensionless forces and openings; of sensitivities, a thousand times as much.
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
        let (young, poisson) = (body.material.young_modulus(), body.material.poisson_ratio());
        body.material = Material::new(young / (s * s), poisson)?;
        body.loads = body.loads.iter().map(|load| load.scaled(1.0 / (s * s))).collect();
    }
    Ok(scene)
}

/// A surface of these cases with lengths × s.
fn surface(surface: &CounterSurface, s: f64) -> CounterSurface {
    match surface.clone() {
        CounterSurface::Waves { base, first, second, period, origin } => {
            let [base, first, second, period] = [base, first, second, period].map(|x| s * x);
            CounterSurface::Waves { base, first, second, period, origin: origin.map(|x| s * x) }
        }
        CounterSurface::Sphere { apex, radius, centre } => {
            CounterSurface::Sphere { apex: s * apex, radius: s * radius, centre: centre.map(|x| s * x) }
        }
        CounterSurface::Plane { height } => CounterSurface::Plane { height: s * height },
        other => other,
    }
}

/// Control heights of a scene.
type Heights = fn(&Scene) -> Vec<f64>;

/// Compares the results in both units, by both solvers.
fn compare(scene: &Scene, s: f64, heights: Heights) -> Result<Record, SceneError> {
    let mut record = Record::default();
    let mut worst = 0.0_f64;
    let body = &scene.bodies[0];
    let stiffness = body.material.young_modulus() * body.block().map_or(1.0, |block| block.size[0] * block.size[1]);
    for by in [Attempt::by_tfeti, Attempt::by_condensation] {
        let solve = |scene: Scene| -> Result<Attempt, SceneError> {
            let controls = heights(&scene);
            Ok(by(&Arc::new(ContactProblem::new(scene)?), &controls))
        };
        let (one, other) = (solve(scene.clone())?, solve(rescaled(scene, s)?)?);
        record.work.push(one.work);
        let (first, second) = match (one.found, other.found) {
            (Ok(first), Ok(second)) => (first, second),
            (Err((kind, reason)), Err((other_kind, _))) if kind == other_kind => {
                return Ok(Record::plain(CaseOutcome::Refused, format!("refused in both units: {reason}")));
            }
            _ => return Ok(Record::plain(CaseOutcome::Broken, "refused in one unit, or for other reasons".into())),
        };
        let over = |values: &[f64], factor: f64| values.iter().map(|value| value * factor).collect::<Vec<f64>>();
        let forces = force_difference(&first.forces, &second.forces);
        // Openings of closed nodes are zero compared with the strain that the normal forces stand for.
        let floor = first.forces.total_normal_force() / stiffness * scene.start()[0];
        let openings = difference_over(&first.forces.opening, &over(&second.forces.opening, 1.0 / s), floor);
        let slopes = match (&first.heights, &second.heights) {
            (Ok(first), Ok(second)) => difference_over(first, &over(second, s), 0.0),
            _ => f64::NAN,
        };
        let equal = first.forces.status == second.forces.status && slopes <= 1e3 * EQUAL && !openings.is_nan();
        worst = worst.max(if equal { forces.max(openings) } else { f64::INFINITY });
        record.residual = Some(record.residual.unwrap_or(0.0).max(first.residual));
        record.force_difference = Some(record.force_difference.unwrap_or(0.0).max(forces));
        record.subgradient_difference = Some(record.subgradient_difference.unwrap_or(0.0).max(slopes));
    }
    record.outcome = if worst <= EQUAL { CaseOutcome::Solved } else { CaseOutcome::Broken };
    record.remark = format!("largest difference of dimensionless results {worst:.1e}");
    Ok(record)
}

pub fn cases() -> Vec<Case> {
    let case = |name: &'static str, scene: Result<Scene, SceneError>, s: f64, heights: Heights| {
        Case::new("units", name, move || {
            let result = scene.as_ref().map_err(ToString::to_string);
            let result = result.and_then(|scene| compare(scene, s, heights).map_err(|error| error.to_string()));
            result.unwrap_or_else(|reason| Record::plain(CaseOutcome::Broken, reason))
        })
    };
    let flat: Heights = |scene| scene.start();
    vec![
        case("block, N–mm against N–m", block(), 1e-3, wavy_controls),
        case("two bodies, N–mm against N–m", pair(), 1e-3, wavy_controls),
        case("stacked blocks, N–mm against N–µm", stacked(0.3, 1.0, 0.1), 1e3, flat),
        case("held base, N–mm against N–km", footed(1e-4), 1e-6, flat),
        case("load reversed, N–mm against N–m", with_loads(block(), -1.0), 1e-3, wavy_controls),
    ]
}
