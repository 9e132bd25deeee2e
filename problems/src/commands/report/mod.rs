//! The files of a command with `--out`: tables, figures, meshes for ParaView and a report page.

pub mod files;
mod gallery;
mod pages;
mod sections;
mod tables;
