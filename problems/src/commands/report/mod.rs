//! The files of a command with `--out`: tables, figures, meshes for ParaView and a report page.

mod contact_table;
pub mod files;
mod gallery;
mod pages;
mod sections;
