//! VTU files read back by `vtkio`.

use std::collections::HashMap;
use vtkio::model::{Attribute, DataSet, Piece, VertexNumbers};

/// One array as read: components per entry, all numbers.
pub type Read = (u32, Vec<f64>);

/// A grid as read.
pub struct ReadGrid {
    /// Coordinates.
    pub points: Vec<[f64; 3]>,
    /// Types of the cells as VTK numbers them: 9 for a quadrilateral, 12 for a hexahedron.
    pub kinds: Vec<u8>,
    /// Points of every cell.
    pub cells: Vec<Vec<usize>>,
    /// Arrays with one entry per point.
    pub point_data: HashMap<String, Read>,
    /// Arrays with one entry per cell.
    pub cell_data: HashMap<String, Read>,
}

/// The grid of a VTU file of one piece.
///
/// # Panics
/// When the text is no such file.
pub fn read(text: &str) -> ReadGrid {
    let file = vtkio::Vtk::parse_xml(text.as_bytes()).expect("a VTU file");
    let DataSet::UnstructuredGrid { mut pieces, .. } = file.data else { panic!("not an unstructured grid") };
    assert_eq!(pieces.len(), 1);
    let Some(Piece::Inline(piece)) = pieces.pop() else { panic!("no inline piece") };
    let VertexNumbers::XML { connectivity, offsets } = piece.cells.cell_verts else { panic!("legacy cells") };
    let starts = std::iter::once(&0).chain(&offsets);
    let cell =
        |(&start, &end): (&u64, &u64)| connectivity[start as usize..end as usize].iter().map(|&p| p as usize).collect();
    let arrays = |attributes: Vec<Attribute>| {
        let array = |attribute| {
            let Attribute::DataArray(array) = attribute else { panic!("a field") };
            (array.name.clone(), (array.elem.num_comp(), array.data.cast_into().expect("a VTU file")))
        };
        attributes.into_iter().map(array).collect()
    };
    ReadGrid {
        points: piece.points.into_vec().expect("a VTU file").as_chunks::<3>().0.to_vec(),
        cells: starts.zip(&offsets).map(cell).collect(),
        kinds: piece.cells.types.iter().map(|&kind| kind as u8).collect(),
        point_data: arrays(piece.data.point),
        cell_data: arrays(piece.data.cell),
    }
}
