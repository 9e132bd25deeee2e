//! The faces of a body that move with the controls as B-spline surfaces.

use super::fit::{Fit, Samples};
use super::net::SplineNet;
use super::part::{Part, Source, rectangle};
use crate::body::mesh::{CellFace, bounding_box};
use crate::equilibrium::ContactProblem;
use crate::linear::FactorizationError;
use crate::mortar::vector::{cross, dot, length};
use crate::mortar::{Facet, doubled_area};
use thiserror::Error;

/// Largest distance of a node from its surface that is always allowed, mm: what machining cannot make.
const FINE: f64 = 1e-3;
/// Largest distance of a node from its surface, as a part of the largest extent of the body.
const SHARE: f64 = 1e-4;
/// Nets are refined until the distance is this part of the allowed one, as far as the nodes determine them.
const GOAL: f64 = 0.01;
/// Largest angle between the normals of a facet and of the surface at its centre, degrees. More are waves.
const ANGLE: f64 = 15.0;
/// How far a surface reaches beyond its face on every side, as a part of the length of the face along that side.
const OVERLAP: f64 = 0.05;

/// A smooth part of a face as a B-spline surface that overlaps it on every side.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineFace {
    /// The face, with the number of the part where it has several.
    pub name: String,
    /// The surface; its normal points outwards.
    pub net: SplineNet,
    /// How many nodes of the mesh lie on it.
    pub nodes: usize,
    /// Their largest distance from it, mm.
    pub distance: f64,
    /// The distance that is allowed, mm.
    pub allowed: f64,
    /// The largest angle between the normals of a facet of the mesh and of the surface at its centre, degrees.
    pub angle: f64,
}

/// Why a face has no surface.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// No parameters.
    #[error(
        "face {face}: its facets fold over on every plane, cylinder and sphere along it; allowed: faces of which every \
         smooth part has facets fine enough for one"
    )]
    Folds {
        /// The face.
        face: String,
    },
    /// The nodes do not lie near enough to the surface.
    #[error("face {face}: a node lies {distance:.1e} mm from the B-spline surface; allowed: {allowed:.1e} mm")]
    Distance {
        /// The face.
        face: String,
        /// Largest distance of a node, mm.
        distance: f64,
        /// Largest one that is allowed, mm.
        allowed: f64,
    },
    /// The surface has waves between the nodes.
    #[error(
        "face {face}: between nodes, the normal of the B-spline surface is {angle:.1} degrees off that of a facet; \
         allowed: {allowed} degrees"
    )]
    Waves {
        /// The face.
        face: String,
        /// Largest angle, degrees.
        angle: f64,
        /// Largest one that is allowed, degrees.
        allowed: f64,
    },
    /// The normal equations were not solved.
    #[error("face {face}: {source}")]
    Equations {
        /// The face.
        face: String,
        /// What failed.
        source: FactorizationError,
    },
}

/// The surfaces of the smooth parts of some faces of a body, each with its name, of which nodes move with the controls.
pub fn spline_faces(
    problem: &ContactProblem,
    body: usize,
    faces: &[(String, Vec<CellFace>)],
    controls: &[f64],
) -> Vec<Result<SplineFace, SurfaceError>> {
    let (start, end) = (&problem.start_positions()[body], &problem.map.positions(controls)[body]);
    let mesh = &problem.bodies[body].mesh;
    let source = Source { mesh, start };
    let [least, most] = bounding_box(&start[..mesh.node_count()]);
    let extent = (0..3).map(|axis| most[axis] - least[axis]).fold(0.0, f64::max);
    let allowed = FINE.max(SHARE * extent);
    let mut found = Vec::new();
    for (name, faces) in faces {
        let mut parts = source.parts(faces);
        parts.retain(|part| part.points.iter().any(|&point| problem.map.moves(body, point)));
        let count = parts.len();
        for (number, part) in (1..).zip(parts) {
            let name = if count > 1 { format!("{name}, part {number}") } else { name.clone() };
            found.push(spline_face(name, &part, [start, end], allowed));
        }
    }
    found
}

/// The angle between two directions of any length, degrees.
fn between(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(cross(a, b)).atan2(dot(a, b)).to_degrees()
}

/// The surface of a part with points at the start and at the end.
pub(super) fn spline_face(
    name: String,
    part: &Part,
    [start, end]: [&[[f64; 3]]; 2],
    allowed: f64,
) -> Result<SplineFace, SurfaceError> {
    let Some(chart) = &part.chart else { return Err(SurfaceError::Folds { face: name }) };
    let places: Vec<[f64; 2]> = part.points.iter().map(|&point| chart.place(start[point as usize])).collect();
    let [corner, sides] = rectangle(&places, OVERLAP);
    let inside = |place: &[f64; 2]| [0, 1].map(|axis| ((place[axis] - corner[axis]) / sides[axis]).clamp(0.0, 1.0));
    let places: Vec<[f64; 2]> = places.iter().map(inside).collect();
    let points: Vec<[f64; 3]> = part.points.iter().map(|&point| end[point as usize]).collect();
    let place = |node: &u32| inside(&chart.place(start[*node as usize]));
    let flat_normal =
        |corners: &[u32]| doubled_area(&corners.iter().map(|&node| end[node as usize]).collect::<Vec<_>>());
    let centre = |corners: &[u32]| {
        let sum = corners.iter().map(place).fold([0.0; 2], |[a, b], [s, t]| [a + s, b + t]);
        sum.map(|sum| sum / corners.len() as f64)
    };
    // The largest angle between the normals of a facet and of a surface at its centre.
    let angle = |net: &SplineNet| {
        let angles = part.facets.iter().map(|facet| {
            let corners = facet.corners();
            between(net.normal(centre(corners)), flat_normal(corners))
        });
        angles.fold(0.0, f64::max)
    };
    let failed = |source| SurfaceError::Equations { face: name.clone(), source };
    let base = chart.surface(corner, sides).map_err(failed)?;
    // At a corner, the surface may be inclined to the base more than the facet is by the allowed angle.
    let turns = |net: &SplineNet, facet: &Facet| {
        let corners = facet.corners();
        let flat = between(base.normal(centre(corners)), flat_normal(corners));
        corners
            .iter()
            .map(|node| between(net.normal(place(node)), base.normal(place(node))))
            .any(|own| own > flat + ANGLE)
    };
    let has_waves = |net: &SplineNet| angle(net) > ANGLE || part.facets.iter().any(|facet| turns(net, facet));
    let samples = Samples { places: &places, points: &points, sides, has_waves: &has_waves };
    let Fit { net, distances, .. } = samples.fit(base.clone(), GOAL * allowed).map_err(failed)?;
    let distance = distances.into_iter().fold(0.0, f64::max);
    if distance > allowed {
        return Err(SurfaceError::Distance { face: name, distance, allowed });
    }
    let angle = angle(&net);
    if angle > ANGLE {
        return Err(SurfaceError::Waves { face: name, angle, allowed: ANGLE });
    }
    Ok(SplineFace { name, net, nodes: part.points.len(), distance, allowed, angle })
}
