//! Obstacles of a scene file, and the heights that shapes start from.

use crate::ObstacleSection;
use crate::lookup::required;
use crate::{grid_file, obstacle_mesh};
use contact::error::SceneError;
use contact::scene::{CounterSurface, Meridian, Revolution};
use std::path::Path;

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
        &ObstacleSection::Cylinder { point, axis, radius, side } => CounterSurface::cylinder(point, axis, radius, side),
        &ObstacleSection::Cone { point, axis, radius, half_angle, side } => {
            let meridian = Meridian::Line { radius, slope: half_angle.to_radians().tan() };
            Revolution { point, axis, side, meridian }.into()
        }
        &ObstacleSection::Torus { centre, axis, major_radius, minor_radius, side } => {
            let meridian = Meridian::Circle { major_radius, minor_radius };
            Revolution { point: centre, axis, side, meridian }.into()
        }
        ObstacleSection::Revolution { file, point, axis, side } => {
            let meridian = Meridian::Profile(grid_file::profile(&folder.join(file))?);
            Revolution { point: *point, axis: *axis, side: *side, meridian }.into()
        }
        ObstacleSection::Mesh { file, face, unit, side } => {
            CounterSurface::Mesh(obstacle_mesh::read(field, &folder.join(file), face.as_deref(), *unit, *side)?)
        }
    })
}

/// Start height of the scene, and the controls where they differ from it.
pub(crate) fn start(
    section: &ObstacleSection,
    size: [f64; 2],
    counts: [usize; 2],
    folder: &Path,
) -> Result<(f64, Option<Vec<f64>>), SceneError> {
    if let ObstacleSection::Plane { height } = *section {
        return Ok((height, None));
    }
    let surface = obstacle("lattice.start", section, Some(([0.0; 2], size)), folder)?;
    if !surface.has_heights() {
        return Err(SceneError::out_of_range("lattice.start", "a surface in space", "a height over x1 and x2"));
    }
    let along = |axis: usize, index: usize| size[axis] * index as f64 / (counts[axis].max(2) - 1) as f64;
    let places = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
    mean_height(places.map(|(i, j)| surface.height(along(0, i), along(1, j))).collect(), counts)
}

/// The mean of control heights, and these.
pub(crate) fn mean_height(controls: Vec<f64>, counts: [usize; 2]) -> Result<(f64, Option<Vec<f64>>), SceneError> {
    let expected = counts[0] * counts[1];
    if controls.len() != expected {
        return Err(SceneError::WrongCount { what: "lattice.controls".into(), expected, found: controls.len() });
    }
    let mean = controls.iter().sum::<f64>() / expected as f64;
    Ok((mean, Some(controls)))
}
