//! The shape of a block as triangles, as B-splines, and as a table.

use crate::commands::export::files::OutputFile;
use crate::commands::failure::Failure;
use crate::commands::numbers::number;
use contact::scene::Scene;
use contact::shape::{HeightShape, Pieces};
use exchange::step::{self, SplineHeights};
use exchange::{ExchangeError, Heights, Triangle, lines, sheet, solid, stl};

/// Points of the table along each axis.
const TABLE_POINTS: usize = 101;

/// Height of the plane below the lower body, mm.
const BASE: f64 = 0.0;

/// A scene of blocks whose lower one a height surface shapes.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    scene: &'a Scene,
    shape: &'a HeightShape,
    size: [f64; 2],
}

impl<'a> Block<'a> {
    /// The block of a scene; none for a mesh.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        Some(Self { scene, shape: scene.heights()?, size: scene.blocks()?.size })
    }
}

/// Bodies and surface as triangles within a distance of the exact surfaces, mm.
///
/// # Errors
/// [`Failure::Input`] for a tolerance that is too small, and for a surface with a step.
pub fn triangles(block: Block<'_>, controls: &[f64], tolerance: f64) -> Result<Vec<OutputFile>, Failure> {
    let (scene, surface) = (block.scene, block.shape.surface()?);
    let pieces = surface.pieces(controls, block.size);
    let lines = divided(&pieces, block, controls, tolerance)?;
    let heights = heights(block, controls, lines)?;
    let written = |name, what: &str, triangles: Vec<Triangle>| {
        let (count, content) = (triangles.len(), stl(&triangles).map_err(failure)?);
        let what = format!("{what}: {count} triangles within {tolerance} mm of it");
        Ok::<_, Failure>(OutputFile { name, content, what, triangles: Some(count) })
    };
    let mut files = vec![
        written("surface.stl", &format!("the optimized surface alone, {}", relief(&heights)), sheet(&heights))?,
        written("lower_body.stl", "the lower body, closed", solid(&heights, BASE).map_err(failure)?)?,
    ];
    if let Some(upper) = &scene.upper {
        let counter = &scene.counter_surface;
        let step = || Failure::Input("the lower surface of the upper body has a step: it has no triangles".into());
        let pieces = counter.pieces(block.size).ok_or_else(step)?;
        let lines = divided(&pieces, block, controls, tolerance)?;
        let places = lines[0].iter().flat_map(|&x1| lines[1].iter().map(move |&x2| [x1, x2]));
        let values = places.map(|[x1, x2]| counter.height(x1, x2)).collect();
        let heights = Heights::new(lines, values).map_err(failure)?;
        let body = solid(&heights, upper.top).map_err(failure)?;
        files.push(written("upper_body.stl", "the upper body, closed", body)?);
    }
    Ok(files)
}

/// How much the surface rises in all: a tolerance that is not far below hides it.
fn relief(heights: &Heights) -> String {
    let (low, high) = heights
        .points()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [.., height]| (height.min(low), height.max(high)));
    let rounding = 16.0 * f64::EPSILON * high.abs();
    let relief = if high - low > rounding { high - low } else { 0.0 };
    format!("whose heights differ by {} mm", number(relief))
}

/// Lines on which triangles keep their distance.
fn divided(pieces: &Pieces, block: Block<'_>, controls: &[f64], tolerance: f64) -> Result<[Vec<f64>; 2], Failure> {
    let top = block.scene.upper.as_ref().map(|upper| upper.top);
    let heights = controls.iter().copied().chain(block.size).chain(top);
    let reach = heights.fold(0.0, |reach: f64, length| reach.max(length.abs()));
    lines([&pieces.lines[0], &pieces.lines[1]], pieces.curvature, reach, tolerance).map_err(failure)
}

/// Heights of the surface where lines cross.
fn heights(block: Block<'_>, controls: &[f64], lines: [Vec<f64>; 2]) -> Result<Heights, Failure> {
    let places = std::array::from_fn(|axis: usize| lines[axis].iter().map(|x| x / block.size[axis]).collect());
    let values = block.shape.surface()?.height_map_at(places).heights(controls);
    Heights::new(lines, values).map_err(failure)
}

/// The surface, and the solid below it, as STEP files.
///
/// # Errors
/// [`Failure`] for control heights that leave no solid.
pub fn splines(block: Block<'_>, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let (scene, surface) = (block.scene, block.shape.surface()?);
    let knots = surface.knots().map(<[f64]>::to_vec);
    let spline = SplineHeights::new(surface.degrees(), knots, block.size, controls.to_vec()).map_err(failure)?;
    let face = step::surface(&scene.name, &spline);
    let body = step::solid(&format!("{}: lower body", scene.name), &spline, BASE).map_err(failure)?;
    Ok(vec![
        OutputFile::text("surface.step", face, "the optimized surface as an exact B-spline face"),
        OutputFile::text("lower_body.step", body, "the lower body as a solid with that face"),
    ])
}

/// Heights of the surface on a uniform grid.
///
/// # Errors
/// [`Failure`] for heights that are no numbers.
pub fn table(block: Block<'_>, controls: &[f64]) -> Result<OutputFile, Failure> {
    let size = block.size;
    let last = (TABLE_POINTS - 1) as f64;
    let line = |axis: usize| (0..TABLE_POINTS).map(|index| size[axis] * index as f64 / last).collect();
    let heights = heights(block, controls, [line(0), line(1)])?;
    let [h1, h2] = size.map(|length| length / last);
    let spacing = format!("spacing {h1} mm along x1, {h2} mm along x2");
    let table = heights.csv(&format!("{}: heights of the optimized surface\n{spacing}", block.scene.name));
    let what = format!("heights of the surface at {TABLE_POINTS} x {TABLE_POINTS} points, {spacing}");
    Ok(OutputFile::text("surface.csv", table, what))
}

/// What the option says is bad input; so is a shape that makes no file.
pub fn failure(error: ExchangeError) -> Failure {
    match error {
        ExchangeError::Tolerance { .. } | ExchangeError::TooManyTriangles { .. } => {
            Failure::Input(format!("--{error}"))
        }
        ExchangeError::Stl(_) => Failure::computation(error),
        _ => Failure::Input(error.to_string()),
    }
}
