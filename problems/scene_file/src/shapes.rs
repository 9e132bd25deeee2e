//! Height surfaces of a scene file: what they are, where they start, what lies opposite to them.

use crate::conversion::required;
use crate::grid_file;
use crate::{AdmissibleSection, ObstacleSection, SplineName, StartSection, SurfaceSection};
use contact::error::SceneError;
use contact::scene::CounterSurface;
use contact::shape::LatticeShape;
use std::path::Path;

/// Degree of the paper's B-splines.
const DEFAULT_DEGREE: usize = 3;

/// A height surface over a base of this size, and its controls at the start where they are not all alike.
pub(crate) fn heights(
    (surface, admissible): (&SurfaceSection, &AdmissibleSection),
    size: [f64; 2],
    folder: &Path,
) -> Result<(LatticeShape, Option<Vec<f64>>), SceneError> {
    let (start_height, start) = start(&surface.start, size, surface.control_points, folder)?;
    let points = surface.control_points;
    let shape = LatticeShape {
        thickness: Some(admissible.minimum_height),
        slope: Some(admissible.slope),
        volume: Some(admissible.volume),
        fairness: surface.fairness.as_ref().map_or(0.0, |fairness| fairness.weight),
        ..LatticeShape::heights(surface.face, points, degrees(surface)?, start_height)
    };
    match shape.face() {
        Some(_) => Ok((shape, start)),
        None => Err(SceneError::out_of_range("surface.start", start_height, "a finite mean height > 0 mm")),
    }
}

/// Degrees along both axes.
fn degrees(section: &SurfaceSection) -> Result<[usize; 2], SceneError> {
    let degrees = match (section.spline, section.degree) {
        (SplineName::Bspline, degree) => [degree.unwrap_or(DEFAULT_DEGREE); 2],
        (SplineName::Bezier, None) => section.control_points.map(|count| count.saturating_sub(1)),
        (SplineName::Bezier, Some(degree)) => {
            let allowed = "no degree with surface.spline = \"bezier\"";
            return Err(SceneError::out_of_range("surface.degree", degree, allowed));
        }
    };
    let mut both = degrees.into_iter().zip(section.control_points);
    match both.find(|(degree, count)| !(1..*count).contains(degree)) {
        None => Ok(degrees),
        Some((degree, count)) => {
            let allowed = format!("1 ≤ degree ≤ {} for {count} control points along an axis", count.saturating_sub(1));
            Err(SceneError::out_of_range("surface.degree", degree, allowed))
        }
    }
}

/// A surface of heights, or in space; `field` stands in messages, `base` is the least corner and the lengths of the
/// rectangle that a grid covers where its section does not say.
pub(crate) fn obstacle(
    field: &str,
    section: &ObstacleSection,
    base: Option<([f64; 2], [f64; 2])>,
    folder: &Path,
) -> Result<CounterSurface, SceneError> {
    Ok(match section {
        &ObstacleSection::Plane { height } => CounterSurface::Plane { height },
        &ObstacleSection::Waves { base, first, second, period } => {
            CounterSurface::Waves { base, first, second, period, origin: [0.0; 2] }
        }
        &ObstacleSection::Sphere { apex, radius, centre } => {
            CounterSurface::Sphere { apex, radius, centre: centre.unwrap_or_default() }
        }
        ObstacleSection::Grid { file, origin, size } => {
            let size = size.or(base.map(|(_, size)| size));
            let size = *required(&format!("{field}.size"), size.as_ref(), "the lengths of the grid along x1, x2 (mm)")?;
            let grid = grid_file::read(&folder.join(file), size, "mm")?;
            CounterSurface::Grid(grid.at(origin.or(base.map(|(corner, _)| corner)).unwrap_or_default()))
        }
        &ObstacleSection::TiltedPlane { point, normal } => CounterSurface::TiltedPlane { point, normal },
        &ObstacleSection::Ball { centre, radius, side } => CounterSurface::Ball { centre, radius, side },
        &ObstacleSection::Cylinder { point, axis, radius, side } => {
            CounterSurface::Cylinder { point, axis, radius, side }
        }
    })
}

/// Start height of the scene, and the controls where they differ from it.
fn start(
    section: &StartSection,
    size: [f64; 2],
    counts: [usize; 2],
    folder: &Path,
) -> Result<(f64, Option<Vec<f64>>), SceneError> {
    let sampled = |surface: CounterSurface| {
        let along = |axis: usize, index: usize| size[axis] * index as f64 / (counts[axis].max(2) - 1) as f64;
        let places = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
        places.map(|(i, j)| surface.height(along(0, i), along(1, j))).collect::<Vec<f64>>()
    };
    let controls = match section {
        &StartSection::Plane { height } => return Ok((height, None)),
        &StartSection::Waves { base, first, second, period } => {
            sampled(CounterSurface::Waves { base, first, second, period, origin: [0.0; 2] })
        }
        StartSection::Grid { file } => sampled(CounterSurface::Grid(grid_file::read(&folder.join(file), size, "mm")?)),
        StartSection::Controls { heights } => heights.clone(),
    };
    let expected = counts[0] * counts[1];
    if controls.len() != expected {
        return Err(SceneError::WrongCount { what: "surface.start.heights".into(), expected, found: controls.len() });
    }
    let mean = controls.iter().sum::<f64>() / expected as f64;
    Ok((mean, Some(controls)))
}
