//! What people run on the [`nonsmooth`] framework: the commands that optimize contact shapes, and two small state
//! problems, a membrane over an obstacle and a 2D toy with closed forms.
//!
//! The front page of the package [`contact`] shows how to evaluate Θ of a scene from Rust; the package [`scene_file`]
//! reads scenes from TOML files.
//!
//! # The contact binaries
//!
//! ```text
//! hertz3d [optimize|compare|study|look|evaluate|verify|recheck DIR|export] [options]
//! signorini3d [optimize|compare|study|look|evaluate|verify|recheck DIR|export] [options]
//! contact3d SCENE.toml [optimize|compare|study|look|evaluate|verify|recheck DIR|export] [options]
//! contact3d new MESH.msh
//! ```
//!
//! * `optimize` minimises Θ over the admissible shapes;
//! * `compare` optimizes with and without friction, and solves both shapes found with and without friction;
//! * `study` makes a table over values of parameters;
//! * `look` shows a scene before any solve, and `new` writes a first scene for a mesh;
//! * `evaluate` computes Θ, one subgradient and the residuals of the contact state at one shape;
//! * `verify` makes a Taylor test of the subgradient at one shape;
//! * `recheck` computes norm and error of an optimization's certificate again, from the files in its folder;
//! * `export` writes a shape for other programs.
//!
//! `--help` lists the options. Exit status: 0 success, 1 the computation failed or a certificate does not agree, 2 bad
//! input, 130 interrupted. `toy2d` runs the toy.
//!
//! # Modules
//!
//! | module | what it holds |
//! |---|---|
//! | [`commands`] | the commands of the contact binaries, their reports and long runs |
//! | [`vtk_files`] | displacements, stresses and contact fields of solved shapes as VTK files |
//! | [`membrane`], [`toy`] | the two small state problems |

pub mod commands;
pub mod membrane;
pub mod toy;
pub mod vtk_files;
