//! Triangles as STL files: binary ones are written, binary and text ones read.

use crate::error::ExchangeError;
use stl_io::{Normal, Vertex, write_stl};

/// Three corners, counterclockwise as seen from outside, mm.
pub type Triangle = [[f32; 3]; 3];

/// What the header says, which has 80 bytes. It must not begin with `solid`, as text files do.
const HEADER: &[u8] = b"lengths in mm; written by nonsmooth";

/// The bytes of a binary STL file; normals follow from the order of the corners.
///
/// # Errors
/// [`ExchangeError::Stl`] for more triangles than such a file can count.
pub fn stl(triangles: &[Triangle]) -> Result<Vec<u8>, ExchangeError> {
    let mut bytes = Vec::new();
    let triangles = triangles
        .iter()
        .map(|corners| stl_io::Triangle { normal: Normal::new(normal(corners)), vertices: corners.map(Vertex::new) });
    write_stl(&mut bytes, triangles).map_err(|error| ExchangeError::Stl(error.to_string()))?;
    bytes[..HEADER.len()].copy_from_slice(HEADER);
    Ok(bytes)
}

/// Places, and the triangles between them by their numbers.
pub type Triangulation = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Places and triangles of an STL file, binary or text: corners that agree in all bits are one place. Triangles are
/// counterclockwise as seen from outside; the normals of the file are not used.
///
/// # Errors
/// [`ExchangeError::Stl`] for bytes that are no such file.
pub fn read_stl(bytes: &[u8]) -> Result<Triangulation, ExchangeError> {
    let refused = |reason: String| ExchangeError::Stl(reason);
    let mesh = stl_io::read_stl(&mut std::io::Cursor::new(bytes)).map_err(|error| refused(error.to_string()))?;
    let count = mesh.vertices.len();
    if u32::try_from(count).is_err() {
        return Err(refused(format!("{count} places are too many")));
    }
    let places = mesh.vertices.iter().map(|vertex| vertex.0.map(f64::from)).collect();
    Ok((places, mesh.faces.iter().map(|face| face.vertices.map(|place| place as u32)).collect()))
}

/// The outward unit normal; zero for a triangle without area.
fn normal(corners: &Triangle) -> [f32; 3] {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| to[axis] - a[axis]) };
    let (u, v) = (edge(b), edge(c));
    let cross = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
    let normal = [cross(1, 2), cross(2, 0), cross(0, 1)];
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    normal.map(|x| if length > 0.0 { (x / length) as f32 } else { 0.0 })
}
