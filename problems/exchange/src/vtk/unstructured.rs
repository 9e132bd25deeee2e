//! One grid as the text of a VTU file.

use crate::vtk::xml::{comment, escaped};
use crate::vtk::{Array, Note, NoteValue, UnstructuredGrid, Values, VtkError};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// Names of the components of a symmetric tensor in VTK's order.
const TENSOR_COMPONENTS: [&str; 6] = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"];

/// The text of a VTU file.
///
/// # Errors
/// [`VtkError`] for data that do not fit the grid, numbers that are not finite, and names that XML cannot hold.
pub fn unstructured(grid: &UnstructuredGrid) -> Result<String, VtkError> {
    grid.check()?;
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    text += &comment(&grid.description)?;
    text += "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
    text += "<UnstructuredGrid>\n";
    if !grid.notes.is_empty() {
        text += "<FieldData>\n";
        grid.notes.iter().try_for_each(|note| write_note(&mut text, note))?;
        text += "</FieldData>\n";
    }
    let (points, cells) = (grid.points.len(), grid.cells.len());
    // Writing to a string does not fail.
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
    for (section, arrays) in [("PointData", &grid.point_data), ("CellData", &grid.cell_data)] {
        let _ = writeln!(text, "<{section}{}>", active(arrays)?);
        for array in arrays {
            write_array(&mut text, array)?;
        }
        let _ = writeln!(text, "</{section}>");
    }
    text += "<Points>\n";
    write_bytes(&mut text, "Float64", "Points", 3, [""; 2], &float_bytes(grid.points.as_flattened()));
    text += "</Points>\n<Cells>\n";
    // An index beyond 64 bits cannot occur: usize has at most as many.
    let connectivity = grid.cells.iter().flat_map(|cell| cell.points()).flat_map(|&point| (point as i64).to_le_bytes());
    write_bytes(&mut text, "Int64", "connectivity", 1, [""; 2], &connectivity.collect::<Vec<u8>>());
    let mut end = 0;
    let offsets = grid.cells.iter().flat_map(|cell| {
        end += cell.points().len() as i64;
        end.to_le_bytes()
    });
    write_bytes(&mut text, "Int64", "offsets", 1, [""; 2], &offsets.collect::<Vec<u8>>());
    write_bytes(
        &mut text,
        "UInt8",
        "types",
        1,
        [""; 2],
        &grid.cells.iter().map(|cell| cell.kind()).collect::<Vec<u8>>(),
    );
    text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    Ok(text)
}

/// The attributes of a section that name its active arrays, each with a blank before it.
fn active(arrays: &[Array]) -> Result<String, VtkError> {
    let mut attributes = String::new();
    for (kind, components) in [("Scalars", 1), ("Vectors", 3)] {
        let fits =
            |array: &&Array| !matches!(array.values, Values::Integers(_)) && array.values.numbers().0 == components;
        if let Some(Array { name, .. }) = arrays.iter().find(fits) {
            attributes += &format!(" {kind}=\"{}\"", escaped("name of an array", name)?);
        }
    }
    Ok(attributes)
}

/// A field of one entry.
fn write_note(text: &mut String, Note { name, unit, value }: &Note) -> Result<(), VtkError> {
    let (name, unit) = (escaped("name of a note", name)?, units_label(unit)?);
    let (kind, value) = match value {
        NoteValue::Integer(value) => ("Int32", value.to_string()),
        NoteValue::Number(value) => ("Float64", format!("{value:e}")),
    };
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">{value}{unit}</DataArray>"
    );
    Ok(())
}

/// VTK's key for the unit of an array. It stands after the numbers: meshio takes the text before the first key for the
/// numbers.
fn units_label(unit: &str) -> Result<String, VtkError> {
    if unit.is_empty() {
        return Ok(String::new());
    }
    let unit = escaped("unit", unit)?;
    Ok(format!("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{unit}</InformationKey>"))
}

fn write_array(text: &mut String, Array { name, unit, values }: &Array) -> Result<(), VtkError> {
    let (name, unit) = (escaped("name of an array", name)?, units_label(unit)?);
    if let Values::Integers(values) = values {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        write_bytes(text, "Int32", &name, 1, ["", &unit], &bytes);
        return Ok(());
    }
    let (components, numbers) = values.numbers();
    let named = if components == 6 { &TENSOR_COMPONENTS[..] } else { &[] };
    let names: String =
        named.iter().enumerate().map(|(index, name)| format!(" ComponentName{index}=\"{name}\"")).collect();
    write_bytes(text, "Float64", &name, components, [&names, &unit], &float_bytes(numbers));
    Ok(())
}

fn float_bytes(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// One DataArray element; `more`: further attributes, each with a blank before it, and what stands after the numbers.
fn write_bytes(text: &mut String, kind: &str, name: &str, components: usize, more: [&str; 2], bytes: &[u8]) {
    let mut block = Vec::with_capacity(8 + bytes.len());
    block.extend((bytes.len() as u64).to_le_bytes());
    block.extend_from_slice(bytes);
    // VTK leaves the number out where it is one; some readers make columns of what has it.
    let components = if components == 1 { String::new() } else { format!(" NumberOfComponents=\"{components}\"") };
    let [attributes, keys] = more;
    // Writing to a string does not fail.
    let _ = write!(text, "<DataArray type=\"{kind}\" Name=\"{name}\"{components}{attributes} format=\"binary\">");
    STANDARD.encode_string(&block, text);
    *text += keys;
    *text += "</DataArray>\n";
}
