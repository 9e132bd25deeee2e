//! VTU and PVD files: what the writer keeps of names, units and numbers, and what it refuses.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use exchange::vtk::{
    Array, Cell, Entry, Note, NoteValue, UnstructuredGrid, Values, VtkError, collection, unstructured,
};
use testset::kit::vtu_file::read;

/// One quadrilateral with one array of data on its points.
fn small(name: &str, values: Values) -> UnstructuredGrid {
    UnstructuredGrid {
        description: "a < b & c".to_owned(),
        notes: vec![],
        points: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        cells: vec![Cell::Quad([0, 1, 2, 3])],
        point_data: vec![Array::new(name, "", values)],
        cell_data: vec![],
    }
}

#[test]
fn names_are_escaped_and_extreme_numbers_survive() {
    let name = "σ < \"µ\" & 'λ' > 0";
    let values = vec![f64::MAX, -f64::MIN_POSITIVE, 5e-324, -0.0];
    let text = unstructured(&small(name, Values::Scalars(values.clone()))).unwrap();
    let found = read(&text);
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&found.point_data[name].1), bits(&values));
    let document = roxmltree::Document::parse(&text).unwrap();
    assert!(document.descendants().any(|node| node.attribute("Name") == Some(name)));
    let entry = Entry { time: 0.1, part: 3, name: "a&b".to_owned(), file: "<'\">.vtu".to_owned() };
    let text = collection(&[entry]).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let set = document.descendants().find(|node| node.has_tag_name("DataSet")).unwrap();
    assert_eq!(["name", "file", "timestep"].map(|name| set.attribute(name).unwrap()), ["a&b", "<'\">.vtu", "0.1"]);
}

#[test]
fn data_that_readers_would_misread_are_refused() {
    let scalars = |count| Values::Scalars(vec![1.0; count]);
    let error = |grid: &UnstructuredGrid| unstructured(grid).unwrap_err();
    assert_eq!(
        error(&small("p", scalars(3))),
        VtkError::WrongLength { array: "p".to_owned(), place: "points", expected: 4, found: 3 }
    );
    let mut grid = small("p", scalars(4));
    grid.cell_data.push(Array::new("q", "", Values::Integers(vec![1, 2])));
    assert_eq!(error(&grid), VtkError::WrongLength { array: "q".to_owned(), place: "cells", expected: 1, found: 2 });
    let mut vectors = vec![[0.0; 3]; 4];
    vectors[2][1] = f64::INFINITY;
    assert_eq!(
        error(&small("u", Values::Vectors(vectors))),
        VtkError::NotFinite { array: "u".to_owned(), index: 7, value: f64::INFINITY }
    );
    let mut grid = small("p", scalars(4));
    grid.points[3][0] = f64::NAN;
    assert!(matches!(error(&grid), VtkError::NotFinite { array, index: 9, .. } if array == "Points"));
    let mut grid = small("p", scalars(4));
    grid.cells.push(Cell::Quad([0, 1, 2, 4]));
    assert_eq!(error(&grid), VtkError::NoSuchPoint { cell: 1, point: 4, points: 4 });
    let mut grid = small("p", scalars(4));
    grid.point_data.push(Array::new("p", "", scalars(4)));
    assert_eq!(error(&grid), VtkError::Twice { array: "p".to_owned(), place: "points" });
    for name in ["", "a\nb", "\u{0}"] {
        assert!(matches!(error(&small(name, scalars(4))), VtkError::Text { .. }), "{name:?}");
    }
    let grid =
        UnstructuredGrid { notes: vec![Note::new("a", "", NoteValue::Number(f64::NAN))], ..small("p", scalars(4)) };
    assert!(matches!(error(&grid), VtkError::NotFinite { index: 0, .. }));
    let mut grid = small("p", scalars(4));
    grid.point_data[0].unit = "\u{0}".to_owned();
    assert!(matches!(error(&grid), VtkError::Text { .. }));
    for description in ["a -- b", "ends with -", "bell \u{7}"] {
        let grid = UnstructuredGrid { description: description.to_owned(), ..small("p", scalars(4)) };
        assert!(matches!(error(&grid), VtkError::Text { .. }), "{description:?}");
    }
    let entry = Entry { time: f64::NAN, part: 0, name: "a".to_owned(), file: "b".to_owned() };
    assert!(matches!(collection(&[entry]), Err(VtkError::NotFinite { index: 0, .. })));
}

#[test]
fn units_and_notes_stand_in_the_file_without_arrays_of_text() {
    let mut grid = small("pressure", Values::Scalars(vec![0.5, 1.0, 2.0, 4.0]));
    grid.point_data[0].unit = "MPa".to_owned();
    grid.cell_data = vec![
        Array::new("area", "mm<2>", Values::Scalars(vec![1.0])),
        Array::new("body", "", Values::Integers(vec![1])),
    ];
    grid.notes = vec![
        Note::new("objective", "MPa^4", NoteValue::Number(4.5e17)),
        Note::new("evaluation", "", NoteValue::Integer(7)),
    ];
    let text = unstructured(&grid).unwrap();
    // python/tests/test_vtu.py reads this file with meshio.
    assert_eq!(text, include_str!("small.vtu"));
    let document = roxmltree::Document::parse(&text).unwrap();
    let arrays: Vec<_> = document.descendants().filter(|node| node.has_tag_name("DataArray")).collect();
    // meshio 5.3.5 knows the types of numbers alone.
    assert!(
        arrays.iter().all(|array| ["Float64", "Int32", "Int64", "UInt8"].contains(&array.attribute("type").unwrap()))
    );
    let unit = |name: &str| {
        let array = arrays.iter().find(|array| array.attribute("Name") == Some(name)).unwrap();
        let key = array.children().find(|node| node.has_tag_name("InformationKey"))?;
        assert_eq!((key.attribute("name"), key.attribute("location")), (Some("UNITS_LABEL"), Some("vtkDataArray")));
        // Readers take the text before the key for the numbers.
        assert!(array.first_child().unwrap().is_text());
        key.text()
    };
    let units = ["pressure", "area", "body", "objective", "evaluation"].map(unit);
    assert_eq!(units, [Some("MPa"), Some("mm<2>"), None, Some("MPa^4"), None]);
    let notes = arrays.iter().filter(|array| array.parent().unwrap().has_tag_name("FieldData"));
    let notes: Vec<[&str; 3]> =
        notes.map(|array| ["type", "Name", "NumberOfTuples"].map(|name| array.attribute(name).unwrap())).collect();
    assert_eq!(notes, [["Float64", "objective", "1"], ["Int32", "evaluation", "1"]]);
    let found = read(&text);
    assert_eq!(found.point_data["pressure"], (1, vec![0.5, 1.0, 2.0, 4.0]));
    assert_eq!(found.cell_data["area"], (1, vec![1.0]));
}
