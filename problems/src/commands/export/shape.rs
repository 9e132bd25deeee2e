//! The shape of a block as triangles, as B-splines, and as a table.

use crate::commands::export::files::{OutputFile, body_file};
use crate::commands::failure::Failure;
use crate::commands::numbers::number;
use crate::commands::scene_words;
use contact::error::SceneError;
use contact::scene::{self, CounterSurface, Scene};
use contact::shape::{HeightShape, Pieces, ShapedFace};
use exchange::step::{self, SplineHeights};
use exchange::{ExchangeError, Heights, Triangle, lines, sheet, solid, stl};

/// Points of the table along each axis.
const TABLE_POINTS: usize = 101;

/// The only optimized body of a scene, where it is a block that a height surface shapes.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    scene: &'a Scene,
    /// Its place among the bodies.
    pub body: usize,
    block: &'a scene::Block,
    shape: &'a HeightShape,
}

impl<'a> Block<'a> {
    /// The block of a scene; none for a mesh, a lattice, and several optimized bodies.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        let (block, shape) = scene.shaped_block()?;
        let body = scene.bodies.iter().position(|body| body.shape.is_some())?;
        Some(Self { scene, body, block, shape })
    }

    /// The height of the plane opposite to the optimized face, mm; none where it is no plane.
    pub fn plane(&self) -> Option<f64> {
        plane(match self.shape.face {
            ShapedFace::Top => &self.block.bottom,
            ShapedFace::Bottom => &self.block.top,
        })
    }

    /// Refuses a block that a STEP file does not hold as a solid.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] naming the option.
    pub fn check_solid(&self) -> Result<(), SceneError> {
        let allowed = "for an optimized top over a plane bottom; --stl and --msh write every body";
        if self.shape.face == ShapedFace::Top && self.plane().is_some() {
            return Ok(());
        }
        let value = format!("given for {}", scene_words::body(&self.scene.bodies[self.body].name));
        Err(SceneError::out_of_range("--step", value, allowed))
    }

    /// Largest coordinate of the blocks, mm, as far as controls and planes tell it.
    fn reach(&self, controls: &[f64]) -> f64 {
        let of_block = |body: &scene::BodyScene| {
            let block = body.block()?;
            let ends = [0, 1].map(|axis| block.corner[axis] + block.size[axis]);
            let shaped = body.heights().map(|heights| heights.face);
            let faces = [(ShapedFace::Bottom, &block.bottom), (ShapedFace::Top, &block.top)];
            let planes = faces.into_iter().filter(|(face, _)| shaped != Some(*face)).filter_map(|(_, own)| plane(own));
            Some(block.corner.into_iter().chain(ends).chain(planes).fold(0.0, |reach: f64, x| reach.max(x.abs())))
        };
        let blocks = self.scene.bodies.iter().filter_map(of_block).fold(0.0, f64::max);
        controls.iter().fold(blocks, |reach: f64, height| reach.max(height.abs()))
    }
}

/// The height of a plane, mm; none of other surfaces.
fn plane(surface: &CounterSurface) -> Option<f64> {
    if let CounterSurface::Plane { height } = surface { Some(*height) } else { None }
}

fn written(name: String, what: &str, tolerance: f64, triangles: &[Triangle]) -> Result<OutputFile, Failure> {
    let (count, content) = (triangles.len(), stl(triangles).map_err(failure)?);
    let what = format!("{what}: {count} triangles within {tolerance} mm of it");
    Ok(OutputFile { name, content, what, triangles: Some(count) })
}

/// What a file of a closed body holds.
fn closed(scene: &Scene, body: usize) -> String {
    format!("the {}, closed", scene_words::body(&scene.bodies[body].name))
}

/// The surface as triangles within a distance of it, mm, and the block below or above it where its other face is a
/// plane.
///
/// # Errors
/// [`Failure::Input`] for a tolerance that is too small.
pub fn triangles(block: Block<'_>, controls: &[f64], tolerance: f64) -> Result<Vec<OutputFile>, Failure> {
    let surface = block.shape.surface()?;
    let pieces = surface.pieces(controls, block.block.size);
    let lines = divided(&pieces, block.reach(controls), tolerance)?;
    let heights = heights(block, controls, lines)?;
    let what = format!("the optimized surface alone, {}", relief(&heights));
    let mut files = vec![written("surface.stl".into(), &what, tolerance, &sheet(&heights))?];
    if let Some(plane) = block.plane() {
        let (name, body) = (body_file(block.scene, block.body, "stl"), solid(&heights, plane).map_err(failure)?);
        files.push(written(name, &closed(block.scene, block.body), tolerance, &body)?);
    }
    Ok(files)
}

/// Another block as triangles within a distance of it, mm: a plane and any other face. None for a block of another
/// kind, and for a body that is no block.
///
/// # Errors
/// As [`triangles`], and for a surface with a step.
pub fn other_block(
    block: Block<'_>,
    body: usize,
    (controls, tolerance): (&[f64], f64),
) -> Result<Option<OutputFile>, Failure> {
    let Some(own) = block.scene.bodies[body].block() else { return Ok(None) };
    let (surface, plane, face) = match (plane(&own.bottom), plane(&own.top)) {
        (_, Some(top)) => (&own.bottom, top, "lower"),
        (Some(bottom), None) => (&own.top, bottom, "upper"),
        (None, None) => return Ok(None),
    };
    let words = scene_words::body(&block.scene.bodies[body].name);
    let step = || Failure::Input(format!("the {face} surface of the {words} has a step: it has no triangles"));
    let corner = own.corner;
    let pieces = surface.moved([-corner[0], -corner[1], 0.0]).pieces(own.size).ok_or_else(step)?;
    let lines = divided(&within(pieces, own.size), block.reach(controls), tolerance)?;
    let lines = shifted(lines, corner);
    let places = lines[0].iter().flat_map(|&x1| lines[1].iter().map(move |&x2| [x1, x2]));
    let values = places.map(|[x1, x2]| surface.height(x1, x2)).collect();
    let heights = Heights::new(lines, values).map_err(failure)?;
    let triangles = solid(&heights, plane).map_err(failure)?;
    let name = body_file(block.scene, body, "stl");
    written(name, &closed(block.scene, body), tolerance, &triangles).map(Some)
}

/// The pieces of a surface over a base, where it reaches beyond it.
fn within(mut pieces: Pieces, size: [f64; 2]) -> Pieces {
    for (lines, length) in pieces.lines.iter_mut().zip(size) {
        lines.retain(|line| 0.0 < *line && *line < length);
        lines.insert(0, 0.0);
        lines.push(length);
    }
    pieces
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
fn divided(pieces: &Pieces, reach: f64, tolerance: f64) -> Result<[Vec<f64>; 2], Failure> {
    lines([&pieces.lines[0], &pieces.lines[1]], pieces.curvature, reach, tolerance).map_err(failure)
}

fn shifted(mut lines: [Vec<f64>; 2], corner: [f64; 2]) -> [Vec<f64>; 2] {
    for (lines, corner) in lines.iter_mut().zip(corner) {
        lines.iter_mut().for_each(|line| *line += corner);
    }
    lines
}

/// Heights of the surface where lines cross, which count from the corner of the block.
fn heights(block: Block<'_>, controls: &[f64], lines: [Vec<f64>; 2]) -> Result<Heights, Failure> {
    let size = block.block.size;
    let places = std::array::from_fn(|axis: usize| lines[axis].iter().map(|x| x / size[axis]).collect());
    let values = block.shape.surface()?.height_map_at(places).heights(controls);
    Heights::new(shifted(lines, block.block.corner), values).map_err(failure)
}

/// The surface, and the solid below it where it has one, as STEP files.
///
/// # Errors
/// [`Failure`] for control heights that leave no solid.
pub fn splines(block: Block<'_>, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let (scene, surface) = (block.scene, block.shape.surface()?);
    let knots = surface.knots().map(<[f64]>::to_vec);
    let spline = SplineHeights::new(surface.degrees(), knots, block.block.size, controls.to_vec()).map_err(failure)?;
    let spline = spline.at(block.block.corner);
    let face = step::surface(&scene.name, &spline);
    let what = "the optimized surface as an exact B-spline face";
    let mut files = vec![OutputFile::text("surface.step", face, what)];
    if let (Ok(()), Some(plane)) = (block.check_solid(), block.plane()) {
        let words = scene_words::body(&scene.bodies[block.body].name);
        let body = step::solid(&format!("{}: {words}", scene.name), &spline, plane).map_err(failure)?;
        let what = format!("the {words} as a solid with that face");
        files.push(OutputFile::text(body_file(scene, block.body, "step"), body, what));
    }
    Ok(files)
}

/// Heights of the surface on a uniform grid.
///
/// # Errors
/// [`Failure`] for heights that are no numbers.
pub fn table(block: Block<'_>, controls: &[f64]) -> Result<OutputFile, Failure> {
    let size = block.block.size;
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
