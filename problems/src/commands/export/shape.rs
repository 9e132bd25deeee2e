//! Heights of a face of a block as B-splines and as a table.

use crate::commands::export::files::{OutputFile, body_file};
use crate::commands::failure::Failure;
use crate::commands::scene_words;
use contact::scene::{self, CounterSurface, Scene};
use contact::shape::{LatticeShape, ShapedFace};
use exchange::ExchangeError;
use exchange::step::{self, SplineHeights};
use std::fmt::Write;

/// Points of the table along each axis.
const TABLE_POINTS: usize = 101;

/// The only optimized body of a scene, where it is a block and heights of a face are its controls.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    scene: &'a Scene,
    /// Its place among the bodies.
    body: usize,
    block: &'a scene::Block,
    shape: &'a LatticeShape,
}

impl<'a> Block<'a> {
    /// The block of a scene; none where controls are displacements, and for several optimized bodies.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        let (block, shape) = scene.shaped_block()?;
        let body = scene.bodies.iter().position(|body| body.shape.is_some())?;
        Some(Self { scene, body, block, shape })
    }

    /// The height of the plane below an optimized top, mm; none of other blocks, of which there is no solid.
    fn base(&self) -> Option<f64> {
        match (self.shape.face(), &self.block.bottom) {
            (Some(ShapedFace::Top), CounterSurface::Plane { height }) => Some(*height),
            _ => None,
        }
    }
}

/// The surface, and the solid below it where it has one, as STEP files.
///
/// # Errors
/// [`Failure`] for control heights that leave no solid.
pub fn splines(block: Block<'_>, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let (scene, surface) = (block.scene, block.shape.surface()?);
    let knots = surface.knots().map(<[f64]>::to_vec);
    let rectangle = (block.block.corner, block.block.size);
    let spline = SplineHeights::new(surface.degrees(), knots, rectangle, controls).map_err(failure)?;
    let face = step::surfaces(&scene.name, [("", spline.patch())]);
    let what = "the optimized surface as an exact B-spline face";
    let mut files = vec![OutputFile::text("surface.step", face, what)];
    if let Some(plane) = block.base() {
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
/// [`Failure`] for a surface that is none.
pub fn table(block: Block<'_>, controls: &[f64]) -> Result<OutputFile, Failure> {
    let (surface, size, last) = (block.shape.surface()?, block.block.size, (TABLE_POINTS - 1) as f64);
    let [h1, h2] = size.map(|length| length / last);
    let spacing = format!("spacing {h1} mm along x1, {h2} mm along x2");
    let mut text = format!(
        "# {}: heights of the optimized surface\n# {spacing}\n# {TABLE_POINTS} x {TABLE_POINTS} points in rows along x2; \
         lengths in mm\nx1,x2,height\n",
        block.scene.name
    );
    for index in 0..TABLE_POINTS * TABLE_POINTS {
        let place = [index / TABLE_POINTS, index % TABLE_POINTS].map(|index| index as f64 / last);
        let [x1, x2] = block.block.grid().moved([size[0] * place[0], size[1] * place[1]]);
        // Writing to a string does not fail.
        let _ = writeln!(text, "{x1},{x2},{}", surface.height(controls, place));
    }
    let what = format!("heights of the surface at {TABLE_POINTS} x {TABLE_POINTS} points, {spacing}");
    Ok(OutputFile::text("surface.csv", text, what))
}

/// A shape that makes no file is bad input.
pub fn failure(error: ExchangeError) -> Failure {
    match error {
        ExchangeError::Stl(_) => Failure::computation(error),
        _ => Failure::Input(error.to_string()),
    }
}
