//! Reports: the files that `--out` asks for. Figures and pages are drawn by the package `figures`, from numbers.

mod bodies;
mod captions;
mod contact_surface;
pub mod files;
mod folder;
mod gallery;
mod key_numbers;
mod pages;
mod sections;
mod setup;
mod skin;
mod space;
mod stamp;
pub mod study;
mod tables;

pub use bodies::Relief;
pub use contact_surface::ContactSurface;
pub use folder::VTK;
pub use sections::{export_command, found_label};
