//! The lattice of a scene file: heights of a face of a block, and free-form shapes of any region.

use crate::lookup::required;
use crate::{ObstacleSection, shapes};
use contact::body::mesh::Mesh;
use contact::error::SceneError;
use contact::names::nodes_of;
use contact::shape::{Coordinates, Directions, LatticeShape, NodeBound, ShapedFace};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Control points along x1, x2 of heights where the scene does not say, and highest degree without being asked for.
const HEIGHTS: [usize; 2] = [6, 6];
const USUAL_DEGREE: usize = 3;
/// Part of its extent by which the box around a region exceeds it, so that rounding leaves no node outside.
const MARGIN: f64 = 1e-6;

/// The shape of a body that is optimized: the heights of a face of a block (`heights`), or displacements of control
/// points in a lattice around a region. Nodes outside the lattice stay where they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LatticeSection {
    /// The face of a block whose heights are the controls, in place of displacements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heights: Option<ShapedFace>,
    /// Control points along the three coordinates of the box; along x1, x2 for heights. Default [6, 6] for heights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1, max = 40)), extend("x-unit" = "1"))]
    pub control_points: Option<Vec<usize>>,
    /// Degrees of the B-splines along the same coordinates, or one for all, less than the control points. Default 3, or
    /// as many as the control points allow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 0, max = 39)), extend("x-unit" = "1"))]
    pub degrees: Option<Vec<usize>>,
    /// Heights at the start, taken at the places of the control points. Required for heights, unless controls are
    /// given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<ObstacleSection>,
    /// Control heights at the start one by one, row major with x1 first, in place of start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(max = 1e9)), extend("x-unit" = "mm"))]
    pub controls: Option<Vec<f64>>,
    /// Least distance of a control point from the other face of the block; required for heights, and for heights alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e9), extend("x-unit" = "mm", "exclusiveMinimum" = 0.0))]
    pub thickness: Option<f64>,
    /// Two opposite corners of a box along the axes. Default the box around the region.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "mm"))]
    pub bounds_of_box: Option<[[f64; 3]; 2]>,
    /// Corner of an oriented box, with edges.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub corner: Option<[f64; 3]>,
    /// The three edges of an oriented box from its corner, perpendicular to each other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit" = "mm"))]
    pub edges: Option<[[f64; 3]; 3]>,
    /// A sector of a tube in place of a box: radius, angle and height are its coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<CylinderSection>,
    /// Coordinates along which the control points move: 1, 2, 3 are those of the box, or radius, angle and height.
    /// Default [1, 2, 3]; not with normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1, max = 3)), extend("x-unit" = "1"))]
    pub directions: Option<Vec<usize>>,
    /// A face whose nodes move along its outward normal at the start, for small changes; no other node moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<String>,
    /// Faces, sets of nodes and volumes whose nodes move. Default all nodes in the box.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub region: Vec<String>,
    /// Faces and sets of nodes whose nodes do not move.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixed: Vec<String>,
    /// Whether supports hold nodes in the shape as they do under load.
    #[serde(default = "yes")]
    pub hold_supports: bool,
    /// Coordinates across whose middle the shape is symmetric.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(inner(range(min = 1, max = 3)), extend("x-unit" = "1"))]
    pub symmetric: Vec<usize>,
    /// Layers of control points that do not move at both ends of every coordinate.
    #[serde(default)]
    #[schemars(extend("x-unit" = "1"))]
    pub frozen: [[usize; 2]; 3],
    /// Least and largest displacement of a control point; required without heights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub displacement: Option<[f64; 2]>,
    /// Largest slope of the net: the difference of neighbours over the distance of their places.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e9), extend("x-unit" = "1", "exclusiveMinimum" = 0.0))]
    pub slope: Option<f64>,
    /// Least and largest volume of the body, where nodes move along one axis alone; else use a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 0.0, max = 1e27)), extend("x-unit" = "mm³"))]
    pub volume: Option<[f64; 2]>,
    /// The factor with which the bending of the net of control points, ∫(∂₁₁F)² + 2(∂₁₂F)² + (∂₂₂F)² for heights F, is
    /// added to the objective. Default 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e60), extend("x-unit" = "unit of the objective"))]
    pub fairness: Option<f64>,
    /// Whether an optimization begins with short attempts, also on coarse nets. Default true for heights, else false.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attempts: Option<bool>,
    /// Bounds of the displacements of nodes by the shape, a row each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bounds: Vec<NodeBoundSection>,
}

/// A sector of a tube.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderSection {
    /// A point of the axis, from which heights are measured.
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub point: [f64; 3],
    /// Direction of the axis.
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
    pub axis: [f64; 3],
    /// Direction of the angle 0, across the axis.
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "1"))]
    pub zero: [f64; 3],
    /// Least and largest radius.
    #[schemars(inner(range(min = 0.0, max = 1e9)), extend("x-unit" = "mm"))]
    pub radius: [f64; 2],
    /// Least and largest angle.
    #[schemars(inner(range(min = -360.0, max = 360.0)), extend("x-unit" = "degree"))]
    pub angle: [f64; 2],
    /// Least and largest height.
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub height: [f64; 2],
}

/// A bound of a component of the displacement of nodes by the shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeBoundSection {
    /// Face, set of nodes or volume.
    pub place: String,
    /// Component along x1, x2 or x3.
    #[schemars(range(min = 1, max = 3), extend("x-unit" = "1"))]
    pub component: usize,
    /// Least and largest displacement.
    #[schemars(inner(range(min = -1e9, max = 1e9)), extend("x-unit" = "mm"))]
    pub range: [f64; 2],
}

fn yes() -> bool {
    true
}

impl LatticeSection {
    /// Heights of a face of a block over a base of this size, and the controls at the start where they are not all
    /// alike.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for fields of displacements, for a start that is missing, and for too few control
    /// points.
    pub(crate) fn height_shape(
        &self,
        face: ShapedFace,
        size: [f64; 2],
        folder: &Path,
    ) -> Result<(LatticeShape, Option<Vec<f64>>), SceneError> {
        for (field, given) in [
            ("box", self.bounds_of_box.is_some()),
            ("corner", self.corner.is_some()),
            ("edges", self.edges.is_some()),
            ("cylinder", self.cylinder.is_some()),
            ("directions", self.directions.is_some()),
            ("normal", self.normal.is_some()),
            ("region", !self.region.is_empty()),
            ("fixed", !self.fixed.is_empty()),
            ("symmetric", !self.symmetric.is_empty()),
            ("frozen", self.frozen != [[0; 2]; 3]),
            ("displacement", self.displacement.is_some()),
            ("bounds", !self.bounds.is_empty()),
        ] {
            if given {
                let allowed = "none beside lattice.heights, whose controls move one face along x3";
                return Err(SceneError::out_of_range(format!("lattice.{field}"), "a value", allowed));
            }
        }
        let points =
            self.control_points.as_deref().map_or(Ok(HEIGHTS), |points| counts("lattice.control_points", points))?;
        let degrees = self.degrees(points)?;
        if let Some((degree, count)) =
            degrees.into_iter().zip(points).find(|(degree, count)| !(1..*count).contains(degree))
        {
            let allowed = format!("1 ≤ degree ≤ {} for {count} control points along an axis", count.saturating_sub(1));
            return Err(SceneError::out_of_range("lattice.degrees", degree, allowed));
        }
        let thickness =
            *required("lattice.thickness", self.thickness.as_ref(), "the least height of a control point (mm)")?;
        let (height, start) = match (&self.controls, &self.start) {
            (Some(controls), None) => shapes::mean_height(controls.clone(), points)?,
            (None, Some(section)) => shapes::start(section, size, points, folder)?,
            (given, _) => {
                let found = if given.is_some() { "beside controls" } else { "missing" };
                let allowed = "a table such as { form = \"plane\", height = 10.0 }, or controls";
                return Err(SceneError::out_of_range("lattice.start", found, allowed));
            }
        };
        let heights = LatticeShape::heights(face, points, degrees, height);
        let shape = LatticeShape {
            thickness: Some(thickness),
            slope: self.slope,
            volume: self.volume,
            fairness: self.fairness.unwrap_or_default(),
            attempts: self.attempts.unwrap_or(heights.attempts),
            ..heights
        };
        match shape.face() {
            Some(_) => Ok((shape, start)),
            None => Err(SceneError::out_of_range("lattice.start", height, "a finite mean height > 0 mm")),
        }
    }

    /// The degrees along so many control points.
    fn degrees<const N: usize>(&self, points: [usize; N]) -> Result<[usize; N], SceneError> {
        match self.degrees.as_deref() {
            None => Ok(points.map(|count| USUAL_DEGREE.min(count.saturating_sub(1)))),
            Some(&[degree]) => Ok([degree; N]),
            Some(degrees) => counts("lattice.degrees", degrees),
        }
    }

    /// Displacements of a lattice in space, on a mesh.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for fields that exclude each other and for names that the mesh does not have.
    pub(crate) fn shape(&self, mesh: &Mesh) -> Result<LatticeShape, SceneError> {
        let (start, controls, thickness) = (self.start.is_some(), self.controls.is_some(), self.thickness.is_some());
        for (field, given) in [("start", start), ("controls", controls), ("thickness", thickness)] {
            if given {
                let allowed = "none without lattice.heights, since displacements start at 0";
                return Err(SceneError::out_of_range(format!("lattice.{field}"), "a value", allowed));
            }
        }
        let allowed = "three numbers of control points";
        let points = counts(
            "lattice.control_points",
            required("lattice.control_points", self.control_points.as_ref(), allowed)?,
        )?;
        let allowed = "the least and the largest displacement (mm)";
        let displacement = *required("lattice.displacement", self.displacement.as_ref(), allowed)?;
        let directions = match (&self.normal, &self.directions) {
            (Some(_), Some(directions)) => {
                let value = format!("{directions:?}");
                return Err(SceneError::out_of_range("lattice.directions", value, "none with lattice.normal"));
            }
            (Some(face), None) => Directions::Normal(face.clone()),
            (None, directions) => Directions::Axes(among(directions.as_deref().unwrap_or(&[1, 2, 3]))),
        };
        let bound = |bound: &NodeBoundSection| NodeBound {
            place: bound.place.clone(),
            component: bound.component - 1,
            range: bound.range,
        };
        let lattice = LatticeShape::new(self.coordinates(mesh)?, points, displacement);
        Ok(LatticeShape {
            degrees: self.degrees(points)?,
            directions,
            region: self.region.clone(),
            fixed: self.fixed.clone(),
            hold_supports: self.hold_supports,
            symmetric: among(&self.symmetric),
            frozen: self.frozen,
            node_bounds: self.bounds.iter().map(bound).collect(),
            slope: self.slope,
            volume: self.volume,
            fairness: self.fairness.unwrap_or_default(),
            attempts: self.attempts.unwrap_or_default(),
            ..lattice
        })
    }

    fn coordinates(&self, mesh: &Mesh) -> Result<Coordinates, SceneError> {
        let given = [self.bounds_of_box.is_some(), self.corner.is_some(), self.cylinder.is_some()];
        if given.iter().filter(|given| **given).count() > 1 || self.corner.is_some() != self.edges.is_some() {
            let allowed = "one of box, corner with edges, and cylinder";
            return Err(SceneError::out_of_range("lattice.box", "two extents of the lattice, or half of one", allowed));
        }
        if let (Some(corner), Some(edges)) = (self.corner, self.edges) {
            return Ok(Coordinates::Cartesian { corner, edges });
        }
        if let Some(CylinderSection { point, axis, zero, radius, angle, height }) = self.cylinder {
            let ranges = [radius, angle.map(f64::to_radians), height];
            return Ok(Coordinates::Cylindrical { point, axis, zero, ranges });
        }
        let [least, most] = self.bounds_of_box.map_or_else(|| self.box_around(mesh), Ok)?;
        if (0..3).any(|axis| least[axis] >= most[axis]) {
            let value = format!("[{least:?}, {most:?}]");
            return Err(SceneError::out_of_range("lattice.box", value, "the corner of least coordinates first (mm)"));
        }
        let edge = |axis: usize| std::array::from_fn(|k| if k == axis { most[axis] - least[axis] } else { 0.0 });
        Ok(Coordinates::Cartesian { corner: least, edges: [edge(0), edge(1), edge(2)] })
    }

    /// The box around the region, or around the face that moves along its normal, or around the body.
    fn box_around(&self, mesh: &Mesh) -> Result<[[f64; 3]; 2], SceneError> {
        let mut nodes = Vec::new();
        for name in self.region.iter().chain(&self.normal) {
            nodes.extend(nodes_of("lattice.region", name, mesh)?);
        }
        if nodes.is_empty() {
            nodes = (0..mesh.node_count() as u32).collect();
        }
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for node in nodes {
            for (axis, x) in mesh.nodes()[node as usize].into_iter().enumerate() {
                (least[axis], most[axis]) = (least[axis].min(x), most[axis].max(x));
            }
        }
        let size = (0..3).map(|axis| most[axis] - least[axis]).fold(0.0, f64::max);
        Ok([least.map(|x| x - MARGIN * size), most.map(|x| x + MARGIN * size)])
    }
}

/// A number per coordinate.
fn counts<const N: usize>(field: &str, list: &[usize]) -> Result<[usize; N], SceneError> {
    list.try_into().map_err(|_| SceneError::out_of_range(field, format!("{list:?}"), format!("{N} entries here")))
}

/// Which of three coordinates a list counted from 1 names.
fn among(list: &[usize]) -> [bool; 3] {
    [1, 2, 3].map(|axis| list.contains(&axis))
}
