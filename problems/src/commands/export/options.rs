//! The options of `export`.

use crate::commands::failure::{Failure, refused};
use clap::Args;
use std::path::PathBuf;

/// What `export` writes, and of which shape.
#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Export")]
pub struct ExportOptions {
    /// The shape is that of the optimization in the folder DIR: its optimum or, while it has not ended, the best one
    /// so far.
    #[arg(long, value_name = "DIR")]
    pub run: Option<PathBuf>,
    /// With --run: the shape of evaluation K instead.
    #[arg(long, value_name = "K", requires = "run")]
    pub evaluation: Option<usize>,
    /// Bodies and contact faces as triangles between the nodes of their meshes. Without one of --stl, --step, --csv,
    /// --msh, --vtu, --inp, --friction-problem, triangles, STEP and tables are written, for a mesh --msh and --vtu
    /// besides.
    #[arg(long)]
    pub stl: bool,
    /// For CAD systems: the B-spline surface of a block and its body as a solid; of a mesh, each face that moves with
    /// the controls as a B-spline surface fitted to its nodes.
    #[arg(long)]
    pub step: bool,
    /// Tables: the change of shape (points, normals, amounts to remove), and the heights of the surface of a block.
    #[arg(long)]
    pub csv: bool,
    /// The mesh of every optimized body in this shape as a Gmsh file, with its names.
    #[arg(long)]
    pub msh: bool,
    /// The mesh of every optimized body in this shape as a VTU file, with its change from the start.
    #[arg(long)]
    pub vtu: bool,
    /// The mesh of every optimized body in this shape with its supports and loads as input of CalculiX, without
    /// contact.
    #[arg(long)]
    pub inp: bool,
    /// Stiffness, loads, contact matrix, gaps and friction coefficients for other solvers.
    #[arg(long)]
    pub friction_problem: bool,
    /// With --friction-problem or --inp: the load case of a scene that has several.
    #[arg(long, value_name = "NAME")]
    pub case: Option<String>,
}

impl ExportOptions {
    /// Whether no format is named.
    pub fn is_free(&self) -> bool {
        !(self.stl || self.step || self.csv || self.msh || self.vtu || self.inp || self.friction_problem)
    }

    /// Refuses options that do not go together; `has_folder`, `has_controls`: `--out` and `--controls` are given.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the option.
    pub fn check(&self, has_folder: bool, has_controls: bool) -> Result<(), Failure> {
        if !has_folder {
            return Err(Failure::Input("export needs --out DIR, the folder for its files".into()));
        }
        if has_controls && self.run.is_some() {
            return refused("--controls", "without --run, which names the shape");
        }
        if self.case.is_some() && !(self.friction_problem || self.inp) {
            return refused("--case", "with --friction-problem or --inp only: the shape is the same in all cases");
        }
        Ok(())
    }
}
