//! The section on form errors: of a page of its own, and of the pages of an optimization.

use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, SUMMARY};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::output::notice;
use crate::commands::report::{origin, stamp};
use crate::commands::tolerance::form_error::{FORM_ERROR, FormError, TITLE, of_text};
use figures::page::{Page, with_section};
use scene_file::read_text;

/// Largest page that is read, bytes.
const LARGEST_PAGE: u64 = 1 << 30;

/// A page of its own.
///
/// # Errors
/// [`Failure`] of a scene that cannot be printed.
pub fn page(found: &FormError, loaded: &LoadedScene) -> Result<String, Failure> {
    let page = Page {
        title: format!("{}: form errors", found.scene),
        lead: format!("{}: {}.", found.shape, found.verdict()),
        origin: stamp(),
        warnings: vec![],
        sections: vec![found.group().section(), origin(&loaded.file.print()?, &[])],
    };
    Ok(page.html())
}

/// Puts the section into the pages of an optimization that has ended.
///
/// # Errors
/// [`Failure`] of the files.
pub fn renew(folder: &Folder, found: &FormError) -> Result<(), Failure> {
    for (name, section) in [("report.html", found.group().section()), (SUMMARY, of_text(found.short()))] {
        let path = folder.path().join(name);
        if !path.exists() {
            continue;
        }
        match with_section(&read_text(&path, LARGEST_PAGE)?, &section) {
            Some(page) => folder.write(name, page)?,
            None => notice(&format!("{}: has no section {TITLE}; {FORM_ERROR} holds the result", path.display())),
        }
    }
    Ok(())
}
