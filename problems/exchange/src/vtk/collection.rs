//! A series of grids: the PVD file that lists times, parts and files.

use crate::vtk::VtkError;
use crate::vtk::xml::escaped;
use std::fmt::Write;

/// One line of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Time, or whatever orders the series.
    pub time: f64,
    /// Number of the part; the same for the same object at all times.
    pub part: usize,
    /// Name of the part.
    pub name: String,
    /// The file, relative to the list.
    pub file: String,
}

/// The text of a PVD file.
///
/// # Errors
/// [`VtkError::NotFinite`] for a time, [`VtkError::Text`] for a name or a file.
pub fn collection(entries: &[Entry]) -> Result<String, VtkError> {
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    text += "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for (index, Entry { time, part, name, file }) in entries.iter().enumerate() {
        if !time.is_finite() {
            return Err(VtkError::NotFinite { array: "times of the collection".to_owned(), index, value: *time });
        }
        let (name, file) = (escaped("name of a part", name)?, escaped("file of a part", file)?);
        // Writing to a string does not fail.
        let _ =
            writeln!(text, "<DataSet timestep=\"{time}\" group=\"\" part=\"{part}\" name=\"{name}\" file=\"{file}\"/>");
    }
    text += "</Collection>\n</VTKFile>\n";
    Ok(text)
}
