//! The faces of meshes that move with the controls as B-spline surfaces in a STEP file.

use crate::commands::export::files::{FaceRecord, OutputFile, named_file};
use crate::commands::export::shape::failure;
use crate::commands::failure::Failure;
use crate::commands::numbers::rounded;
use crate::commands::report::faces_by_names;
use crate::commands::scene_words;
use contact::body::mesh::CellFace;
use contact::equilibrium::ContactProblem;
use contact::surfaces::{SplineFace, spline_faces};
use exchange::step::{self, SplinePatch};

/// Digits of a distance.
const DIGITS: usize = 2;

/// A file per optimized body of which a face moves with the controls, and why faces are not in them.
///
/// # Errors
/// [`Failure`] for control points that a file cannot hold.
pub fn files(problem: &ContactProblem, controls: &[f64]) -> Result<(Vec<OutputFile>, Vec<String>), Failure> {
    let (mut files, mut left_out) = (Vec::new(), Vec::new());
    for body in problem.map.shaped_bodies() {
        let named = |(names, faces): (Vec<String>, Vec<CellFace>)| {
            (if names.is_empty() { "without a name".to_owned() } else { names.join("; ") }, faces)
        };
        let faces: Vec<_> = faces_by_names(&problem.bodies[body].mesh).into_iter().map(named).collect();
        let (mut fitted, words) = (Vec::new(), scene_words::body(&problem.scene.bodies[body].name));
        for face in spline_faces(problem, body, &faces, controls) {
            match face {
                Ok(face) => fitted.push(face),
                Err(error) => left_out.push(format!("{words}, {error}")),
            }
        }
        if !fitted.is_empty() {
            files.push(file(problem, body, &fitted)?);
        }
    }
    Ok((files, left_out))
}

fn file(problem: &ContactProblem, body: usize, faces: &[SplineFace]) -> Result<OutputFile, Failure> {
    let patch = |face: &SplineFace| {
        let net = &face.net;
        SplinePatch::new(net.surface().degrees(), net.surface().knots().map(<[f64]>::to_vec), net.points().to_vec())
            .map_err(failure)
    };
    let patches = faces.iter().map(patch).collect::<Result<Vec<_>, Failure>>()?;
    let words = scene_words::body(&problem.scene.bodies[body].name);
    let name = format!("{}: {words}", problem.scene.name);
    let text = step::surfaces(&name, faces.iter().map(|face| face.name.as_str()).zip(&patches));
    let largest = faces.iter().map(|face| face.distance).fold(0.0, f64::max);
    let allowed = faces.iter().map(|face| face.allowed).fold(0.0, f64::max);
    let what = format!(
        "{} B-spline surfaces over faces of the {words}, nodes within {} mm (allowed: {} mm)",
        faces.len(),
        rounded(largest, DIGITS),
        rounded(allowed, DIGITS)
    );
    let record = |face: &SplineFace| FaceRecord {
        face: face.name.clone(),
        nodes: face.nodes,
        control_points: face.net.surface().counts(),
        distance: face.distance,
        allowed: face.allowed,
        angle: face.angle,
    };
    let faces = faces.iter().map(record).collect();
    Ok(OutputFile { faces, ..OutputFile::text(named_file(&problem.scene, body, "faces", "step"), text, what) })
}
