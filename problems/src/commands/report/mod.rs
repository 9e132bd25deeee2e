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
mod skin;
mod solved_page;
mod space;
mod stamp;
pub mod study;
mod summary;
mod tables;

pub use bodies::{MAX_LIFT as LIFT, Relief, apart};
pub use contact_surface::ContactSurface;
pub use folder::VTK;
pub use sections::{export_command, found_label, origin};
pub use skin::{Skin, extent, faces_by_names};
pub use solved_page::solved_page;
pub use stamp::stamp;
