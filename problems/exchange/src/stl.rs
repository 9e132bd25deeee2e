//! Triangles as a binary STL file.

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
