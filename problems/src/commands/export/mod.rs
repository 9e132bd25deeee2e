//! `export`: a shape as files for other programs. Nothing is solved for it.

pub mod change;
mod deck;
mod files;
mod friction;
mod mesh;
pub mod options;
pub mod run;
mod shape;
mod surfaces;

use crate::commands::controls::{self, Layout};
use crate::commands::export::files::{FaceRecord, Origin, OutputFile};
use crate::commands::export::options::ExportOptions;
use crate::commands::export::run::KeptRun;
use crate::commands::export::shape::Block;
use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, json, printed_with_files};
use crate::commands::loaded_scene::{LoadedScene, Session};
use crate::commands::numbers::{number, rounded};
use crate::commands::scene_difference::Difference;
use contact::equilibrium::ContactProblem;
use nonsmooth::Vector;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// The keys of the JSON of `export`.
#[derive(Debug, Serialize)]
struct ExportJson {
    folder: String,
    shape: Origin,
    /// How the friction problem differs from that of the run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    differences: Vec<String>,
    files: Vec<FileJson>,
    /// Faces that no STEP file holds, each with the reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<String>,
}

#[derive(Debug, Serialize)]
struct FileJson {
    file: String,
    holds: String,
    bytes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    triangles: Option<usize>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    faces: Vec<FaceRecord>,
}

pub fn run(loaded: &LoadedScene, session: &Session<'_>) -> Result<String, Failure> {
    let arguments = session.arguments;
    let options = &arguments.export;
    let run = options.run.as_ref().map(|folder| KeptRun::open(folder, loaded)).transpose()?;
    let case = run.as_ref().and_then(|run| run.on_last_mesh.as_ref()).unwrap_or(&loaded.case);
    let scene = match options.friction_problem || options.inp {
        true => &case.named(options.case.as_deref()).map_err(|error| arguments.changes().blame(error))?.scene,
        false => &case.scene,
    };
    let problem = ContactProblem::new(scene.clone())?;
    if options.friction_problem {
        friction::check(&problem).map_err(|error| arguments.changes().blame(error))?;
    }
    let (controls, origin) = match &run {
        Some(run) => run.shape(options.evaluation)?,
        None => start(&problem, loaded, arguments.shape.controls.as_deref())?,
    };
    let differences = run.filter(|_| options.friction_problem).map_or_else(Vec::new, |run| run.differences);
    problem.admissible.check_shape(&controls)?;
    // What no state is computed for is no part either.
    problem.rows(&problem.positions(controls.as_slice())?)?;
    let block = Block::of(&problem.scene);
    let (files, left_out) = files(&problem, block, controls.as_slice(), options)?;
    // The folder is touched when all that it will hold is there.
    let path = arguments.files.out.as_deref().unwrap_or(Path::new(""));
    let bytes = files.iter().map(|file| file.content.len() as u64).sum();
    let folder = Folder::create(path, bytes, arguments.files.overwrite)?;
    let describe = |file: &OutputFile| FileJson {
        file: file.name.clone(),
        holds: file.what.clone(),
        bytes: file.content.len(),
        triangles: file.triangles,
        faces: file.faces.clone(),
    };
    let result = ExportJson {
        folder: path.display().to_string(),
        shape: origin,
        differences: differences.iter().map(Difference::to_string).collect(),
        files: files.iter().map(describe).collect(),
        left_out,
    };
    let text = arguments.printed(result.to_string(), json(&result)?);
    printed_with_files(text, arguments.json, Some(&folder), |folder| {
        files.iter().try_for_each(|file| match file.name.split_once('/') {
            Some((below, name)) => folder.within(below)?.write(name, &file.content),
            None => folder.write(&file.name, &file.content),
        })
    })
}

/// All files that the options ask for, and the faces that no STEP file holds, each with the reason.
fn files(
    problem: &ContactProblem,
    block: Option<Block<'_>>,
    controls: &[f64],
    options: &ExportOptions,
) -> Result<(Vec<OutputFile>, Vec<String>), Failure> {
    let written = controls::written(controls, Layout::of(&problem.scene))?;
    let what = "the controls; --controls and --start-controls take the file";
    let mut files = vec![OutputFile::text("controls.json", written, what)];
    if options.stl || options.is_free() {
        files.extend(mesh::triangles(problem, controls)?);
    }
    let mut left_out = Vec::new();
    match block {
        Some(block) => files.extend(of_block(block, controls, options)?),
        None if options.step || options.is_free() => {
            let surfaces;
            (surfaces, left_out) = surfaces::files(problem, controls)?;
            if options.step && surfaces.is_empty() {
                let why =
                    if left_out.is_empty() { "no face moves with the controls".into() } else { left_out.join("; ") };
                return Err(Failure::Input(format!("--step: no face has a B-spline surface: {why}")));
            }
            files.extend(surfaces);
        }
        None => {}
    }
    if options.csv || options.is_free() {
        files.push(change::table(problem, controls));
    }
    let is_mesh = options.is_free() && block.is_none();
    if options.msh || is_mesh {
        files.extend(mesh::gmsh_files(problem, controls)?);
    }
    if options.vtu || is_mesh {
        files.extend(mesh::vtk_files(problem, controls)?);
    }
    if options.inp {
        files.extend(deck::files(problem, controls)?);
    }
    if options.friction_problem {
        files.extend(friction::matrices(problem, controls)?);
    }
    Ok((files, left_out))
}

/// The files that only heights of a face of a block have.
fn of_block(block: Block<'_>, controls: &[f64], options: &ExportOptions) -> Result<Vec<OutputFile>, Failure> {
    let mut files = Vec::new();
    if options.step || options.is_free() {
        files.extend(shape::splines(block, controls)?);
    }
    if options.csv || options.is_free() {
        files.push(shape::table(block, controls)?);
    }
    Ok(files)
}

/// The shape that the command line or the scene names.
fn start(problem: &ContactProblem, loaded: &LoadedScene, file: Option<&Path>) -> Result<(Vector, Origin), Failure> {
    let controls = controls::load(problem, &loaded.case, ("--controls", file))?;
    let source =
        file.map_or_else(|| "the start of the scene".to_owned(), |file| format!("the controls in {}", file.display()));
    Ok((controls, Origin { source, evaluation: None, objective: None }))
}

impl fmt::Display for ExportJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let objective = self.shape.objective.map_or_else(String::new, |value| format!(", Θ = {}", number(value)));
        writeln!(f, "shape:       {}{objective}", self.shape.source)?;
        for difference in &self.differences {
            writeln!(f, "note:        another friction problem than in the run: {difference}")?;
        }
        for file in &self.files {
            writeln!(f, "{:<24} {}", file.file, file.holds)?;
            for FaceRecord { face, nodes, control_points: [n1, n2], distance, angle, .. } in &file.faces {
                let [distance, angle] = [distance, angle].map(|value| rounded(*value, 2));
                writeln!(
                    f,
                    "  {face:<22} {n1} x {n2} control points, {nodes} nodes within {distance} mm, normals of facets within {angle}°"
                )?;
            }
        }
        self.left_out.iter().try_for_each(|reason| writeln!(f, "note:        not in a STEP file: {reason}"))
    }
}
