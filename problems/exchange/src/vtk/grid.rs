//! What a VTU file holds, and what it may not hold.

use std::collections::HashSet;
use thiserror::Error;

/// One cell, by the indices of its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// VTK type 12: the four points of the lower face counterclockwise as seen from above, then those above them.
    Hexahedron([usize; 8]),
    /// VTK type 24: corners, then the middles of the edges 01, 12, 02, 03, 13, 23.
    QuadraticTetrahedron([usize; 10]),
    /// VTK type 9: four points in order around the face.
    Quad([usize; 4]),
    /// VTK type 5: three points in order around the face.
    Triangle([usize; 3]),
}

impl Cell {
    /// Number of the type in VTK.
    pub fn kind(&self) -> u8 {
        match self {
            Self::Hexahedron(_) => 12,
            Self::QuadraticTetrahedron(_) => 24,
            Self::Quad(_) => 9,
            Self::Triangle(_) => 5,
        }
    }

    /// Indices of the points.
    pub fn points(&self) -> &[usize] {
        match self {
            Self::Hexahedron(points) => points,
            Self::QuadraticTetrahedron(points) => points,
            Self::Quad(points) => points,
            Self::Triangle(points) => points,
        }
    }
}

/// The values of an array: one entry per point or per cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Integers.
    Integers(Vec<i32>),
    /// Numbers.
    Scalars(Vec<f64>),
    /// Vectors (x, y, z).
    Vectors(Vec<[f64; 3]>),
    /// Symmetric tensors (XX, YY, ZZ, XY, YZ, XZ).
    Tensors(Vec<[f64; 6]>),
}

impl Values {
    /// Number of entries.
    pub fn count(&self) -> usize {
        match (self, self.numbers()) {
            (Self::Integers(values), _) => values.len(),
            (_, (components, numbers)) => numbers.len() / components,
        }
    }

    /// Components of an entry, and all floating-point numbers in order.
    pub(crate) fn numbers(&self) -> (usize, &[f64]) {
        match self {
            Self::Integers(_) => (1, &[]),
            Self::Scalars(values) => (1, values),
            Self::Vectors(values) => (3, values.as_flattened()),
            Self::Tensors(values) => (6, values.as_flattened()),
        }
    }
}

/// A named array.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Name shown by readers; any text without control characters.
    pub name: String,
    /// Unit of the values, such as `mm`; empty for numbers without unit.
    pub unit: String,
    /// One entry per point or cell.
    pub values: Values,
}

impl Array {
    /// A named array.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, values: Values) -> Self {
        Self { name: name.into(), unit: unit.into(), values }
    }
}

/// A number about a grid as a whole.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    /// Name shown by readers; any text without control characters.
    pub name: String,
    /// Unit of the number; empty for a number without unit.
    pub unit: String,
    /// What it says.
    pub value: NoteValue,
}

/// What a [`Note`] says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoteValue {
    /// An integer.
    Integer(i32),
    /// A number.
    Number(f64),
}

impl Note {
    /// A note of this name.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, value: NoteValue) -> Self {
        Self { name: name.into(), unit: unit.into(), value }
    }
}

/// Points, cells, and data on both and on the whole.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UnstructuredGrid {
    /// What the file shows, with units and codes; written as a comment at its head.
    pub description: String,
    /// What is said of the grid as a whole.
    pub notes: Vec<Note>,
    /// Coordinates.
    pub points: Vec<[f64; 3]>,
    /// Cells.
    pub cells: Vec<Cell>,
    /// Arrays with one entry per point.
    pub point_data: Vec<Array>,
    /// Arrays with one entry per cell.
    pub cell_data: Vec<Array>,
}

/// Why a grid or a list cannot be written.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum VtkError {
    /// An array has not one entry per point or cell.
    #[error("array `{array}` has {found} entries, allowed: {expected}, one for each of the {place}")]
    WrongLength {
        /// Name of the array.
        array: String,
        /// `points` or `cells`.
        place: &'static str,
        /// Entries it must have.
        expected: usize,
        /// Entries it has.
        found: usize,
    },
    /// A number is infinite or not a number.
    #[error("array `{array}`: value {index} is {value}, allowed: finite numbers")]
    NotFinite {
        /// Name of the array; `Points` for the coordinates.
        array: String,
        /// Position among all numbers of the array.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A cell names a point that does not exist.
    #[error("cell {cell} has the point {point}, allowed: less than {points}, the number of points")]
    NoSuchPoint {
        /// The cell.
        cell: usize,
        /// The point.
        point: usize,
        /// Number of points.
        points: usize,
    },
    /// A text cannot stand in XML.
    #[error("{what} {text:?} is not allowed; allowed: {allowed}")]
    Text {
        /// What the text is.
        what: &'static str,
        /// The text.
        text: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Two arrays of the same place have one name.
    #[error("array `{array}` stands twice among the data of the {place}, allowed: once")]
    Twice {
        /// Name of the arrays.
        array: String,
        /// `points` or `cells`.
        place: &'static str,
    },
}

impl UnstructuredGrid {
    /// Refuses what readers would misread.
    ///
    /// # Errors
    /// [`VtkError`] naming the array, the place and the value.
    pub fn check(&self) -> Result<(), VtkError> {
        check_finite("Points", self.points.as_flattened())?;
        for note in &self.notes {
            if let NoteValue::Number(value) = note.value {
                check_finite(&note.name, &[value])?;
            }
        }
        for (cell, points) in self.cells.iter().enumerate() {
            if let Some(&point) = points.points().iter().find(|&&point| point >= self.points.len()) {
                return Err(VtkError::NoSuchPoint { cell, point, points: self.points.len() });
            }
        }
        check_arrays(&self.point_data, "points", self.points.len())?;
        check_arrays(&self.cell_data, "cells", self.cells.len())
    }
}

fn check_arrays(arrays: &[Array], place: &'static str, expected: usize) -> Result<(), VtkError> {
    let mut names = HashSet::new();
    for Array { name, values, .. } in arrays {
        if !names.insert(name) {
            return Err(VtkError::Twice { array: name.clone(), place });
        }
        if values.count() != expected {
            return Err(VtkError::WrongLength { array: name.clone(), place, expected, found: values.count() });
        }
        check_finite(name, values.numbers().1)?;
    }
    Ok(())
}

fn check_finite(array: &str, numbers: &[f64]) -> Result<(), VtkError> {
    match numbers.iter().position(|number| !number.is_finite()) {
        Some(index) => Err(VtkError::NotFinite { array: array.to_owned(), index, value: numbers[index] }),
        None => Ok(()),
    }
}
