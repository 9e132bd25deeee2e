//! Form errors of the shaped faces around one shape: isotropic waves along their outward normals.
//!
//! ```text
//! x(a) = x(α) + Σ_j [a_{2j} cos(k_j·r) + a_{2j+1} sin(k_j·r)] n(x),     |k_j| = 2π/λ,  r = x(α) − x₀
//! ```
//! x₀ is the first node of the mesh, so that a body that is moved in a load case has the same errors there.
//! A face is shaped where controls move it along its normal. Its nodes have normals n, less the directions in which
//! supports hold them. Bodies are made independently of each other: each has waves of its own.

use crate::body::mesh::CellFace;
use crate::body::{Body, nodal_normals};
use crate::error::SceneError;
use crate::mortar::vector::{dot, length, plus};
use crate::patches::MiddlePoint;
use crate::shape::{BodyMap, Positions, ShapeMap, mean_rows};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::{PI, TAU};

/// Directions of the waves: with 32 on a half sphere, neighbouring ones are 25 degrees apart, and waves of random
/// amplitudes are isotropic over two wavelengths.
const DIRECTIONS: usize = 32;
/// Facets per wavelength: with fewer, a mesh does not show a wave.
const FACETS_PER_WAVE: f64 = 4.0;
/// Part of a movement that lies along a normal and is no rounding.
const ALONG: f64 = 1e-6;

/// Form errors of a wavelength around a shape. The controls of their problem are the amplitudes of the waves, mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FormErrors {
    /// Controls of the shape, mm.
    pub controls: Vec<f64>,
    /// λ, mm.
    pub wavelength: f64,
}

/// The shaped faces of a body: their nodes with unit normals, and the lengths of the edges between neighbouring nodes.
struct ShapedFaces {
    normals: HashMap<u32, [f64; 3]>,
    edges: Vec<f64>,
}

impl FormErrors {
    /// Number of waves of a body: cosines and sines.
    pub const WAVES: usize = 2 * DIRECTIONS;

    /// From the amplitudes of the waves to the positions of all points, around a shape of `lattice`. `points`: middles
    /// of edges by body; `flat`: whether facets of a body stay flat.
    ///
    /// # Errors
    /// [`SceneError`] for another number of controls, for a wavelength that the mesh does not show, and where controls
    /// move no face along its normal.
    pub(crate) fn map(
        &self,
        lattice: &ShapeMap,
        bodies: &[Body],
        (points, flat): (&[Vec<MiddlePoint>], &[bool]),
    ) -> Result<ShapeMap, SceneError> {
        let (expected, found) = (lattice.control_count(), self.controls.len());
        if expected != found {
            return Err(SceneError::WrongCount { what: "controls of the form error's shape".into(), expected, found });
        }
        let positions = lattice.points(&self.controls);
        let faces: Vec<ShapedFaces> =
            bodies.iter().enumerate().map(|(body, own)| ShapedFaces::of(own, body, lattice, &positions)).collect();
        self.check(&faces)?;
        let maps = faces.iter().enumerate().map(|(body, faces)| {
            let base = positions[body].to_vec();
            let (middles, controls) = (points[body].len(), if faces.normals.is_empty() { 0 } else { Self::WAVES });
            let nodes = base.len() - middles;
            let normal = |node: u32| faces.normals.get(&node).copied();
            let from = bodies[body].mesh.nodes()[0];
            let row = |x: [f64; 3], normal: Option<[f64; 3]>| {
                normal.map_or_else(Default::default, |n| self.rows(plus(x, -1.0, from), n))
            };
            let mut rows: Vec<Vec<(usize, f64)>> =
                (0..nodes).flat_map(|node| row(base[node], normal(node as u32))).collect();
            for (index, MiddlePoint { ends, .. }) in points[body].iter().enumerate() {
                let own = match (flat[body], ends.map(normal)) {
                    (true, _) => mean_rows(&rows, *ends),
                    (false, [Some(a), Some(b)]) => row(base[nodes + index], unit(plus(a, 1.0, b))),
                    (false, _) => Default::default(),
                };
                rows.extend(own);
            }
            BodyMap { base, middles, controls, rows }
        });
        Ok(ShapeMap::new(maps.collect()))
    }

    /// Refuses a wavelength that the facets of shaped faces do not show.
    fn check(&self, faces: &[ShapedFaces]) -> Result<(), SceneError> {
        let edges = || faces.iter().flat_map(|faces| &faces.edges);
        let allowed = "controls that move a face of a body along its normal";
        SceneError::require(edges().next().is_some(), "form error", "no shaped face", allowed)?;
        // The mean over all places on edges, so that a few long edges count as much as many short ones.
        let facet = edges().map(|edge| edge * edge).sum::<f64>() / edges().sum::<f64>();
        let least = FACETS_PER_WAVE * facet;
        let allowed =
            format!("at least {least:.4} mm: {FACETS_PER_WAVE} facets of the shaped faces, {facet:.4} mm each");
        let valid = self.wavelength >= least && self.wavelength.is_finite();
        SceneError::require(valid, "wavelength of the form error", self.wavelength, allowed)
    }

    /// The rows of N at a place from the first node on, with this normal.
    fn rows(&self, place: [f64; 3], normal: [f64; 3]) -> [Vec<(usize, f64)>; 3] {
        let values: Vec<f64> = (0..DIRECTIONS)
            .flat_map(|index| {
                let phase = TAU / self.wavelength * dot(direction(index), place);
                [phase.cos(), phase.sin()]
            })
            .collect();
        normal.map(|component| {
            let own = values.iter().enumerate().filter(|_| component != 0.0);
            own.map(|(wave, value)| (wave, value * component)).collect()
        })
    }
}

impl ShapedFaces {
    fn of(body: &Body, number: usize, lattice: &ShapeMap, positions: &Positions) -> Self {
        let (mesh, positions) = (&body.mesh, &positions[number]);
        let is_shaped = |face: &CellFace| {
            let area = mesh.face_vector(*face, positions);
            unit(area).is_some_and(|n| mesh.face_nodes(*face).any(|node| moves_along(lattice, (number, node), n)))
        };
        let faces: Vec<CellFace> = match lattice.shapes(number) {
            true => mesh.skin().into_iter().filter(is_shaped).collect(),
            false => Vec::new(),
        };
        let free = |(node, normal): (u32, [f64; 3])| {
            let held = body.held(node).iter();
            (node, held.fold(normal, |rest, held| plus(rest, -dot(*held, normal), *held)))
        };
        let normals = nodal_normals(mesh, positions, &faces).into_iter().map(free).collect();
        let edges = faces.iter().flat_map(|face| {
            let (nodes, corners) = mesh.face_with_corners(*face);
            let parts = if nodes.len() > corners { 2.0 } else { 1.0 };
            let place = move |corner: usize| positions[nodes[corner % corners] as usize];
            (0..corners).map(move |corner| length(plus(place(corner + 1), -1.0, place(corner))) / parts)
        });
        Self { normals, edges: edges.collect() }
    }
}

/// Whether a control moves a node of a body along a normal.
fn moves_along(lattice: &ShapeMap, (body, node): (usize, u32), normal: [f64; 3]) -> bool {
    let mut moved: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
    for axis in 0..3 {
        lattice.row(body, node, axis).for_each(|(control, value)| moved.entry(control).or_default()[axis] = value);
    }
    moved.values().any(|way| dot(*way, normal).abs() > ALONG * length(*way))
}

/// The direction of a wave: points of a golden spiral share the half sphere evenly.
fn direction(index: usize) -> [f64; 3] {
    let up = (index as f64 + 0.5) / DIRECTIONS as f64;
    let (across, angle) = ((1.0 - up * up).sqrt(), index as f64 * PI * (3.0 - 5.0_f64.sqrt()));
    [across * angle.cos(), across * angle.sin(), up]
}

/// A vector at length one; none without length.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let size = length(vector);
    (size > 0.0).then(|| vector.map(|component| component / size))
}
