//! Free-form deformation by a lattice of control points: x = x₀ + Σ B_i(ξ₁) B_j(ξ₂) B_l(ξ₃) d α_ijl.
//!
//! ```text
//! Cartesian:    ξ along three axes of a box, d the axes of the box, or the normal of a face
//! cylindrical:  ξ along radius, angle and axis, d the unit vectors there: one control along the angle makes a revolved profile,
//!               one control along an axis of a box an extruded one
//! ```
//! A B-spline of degree count − 1 is the Bernstein basis. Nodes outside the box do not move. Where supports hold nodes,
//! these do not move in the held directions.

use crate::body::mesh::{Mesh, bounding_box};
use crate::error::SceneError;
use crate::names::{find_face, nodes_of};
use crate::patches::MiddlePoint;
use crate::shape::BodyMap;
use crate::shape::bspline::Basis;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};

/// Which coordinates a lattice has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Coordinates {
    /// Along the three axes of a box with a corner and edges that are perpendicular to each other.
    Cartesian {
        /// Corner of the box, mm.
        corner: [f64; 3],
        /// Its edges, mm.
        edges: [[f64; 3]; 3],
    },
    /// Radius, angle and height about an axis.
    Cylindrical {
        /// A point of the axis, from which heights are measured, mm.
        point: [f64; 3],
        /// Direction of the axis.
        axis: [f64; 3],
        /// Direction of angle 0, across the axis.
        zero: [f64; 3],
        /// Least and largest radius, mm; angle, radians; height, mm.
        ranges: [[f64; 2]; 3],
    },
}

/// Which ways the control points move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Directions {
    /// Along some axes of the coordinates.
    Axes([bool; 3]),
    /// Along the outward normal of a face at the reference shape; only nodes of the face move.
    Normal(String),
}

/// A lattice with its bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LatticeShape {
    /// Its coordinates and extent.
    pub coordinates: Coordinates,
    /// Control points along the coordinates.
    pub control_points: [usize; 3],
    /// Degrees along the coordinates; less than the control points.
    pub degrees: [usize; 3],
    /// Which ways the control points move.
    pub directions: Directions,
    /// Faces, node sets or volumes whose nodes move; all nodes in the box if there is none.
    pub region: Vec<String>,
    /// Faces or node sets whose nodes do not move.
    pub fixed: Vec<String>,
    /// Whether nodes do not move in directions in which supports hold them.
    pub hold_supports: bool,
    /// Coordinates across whose middle the shape is symmetric.
    pub symmetric: [bool; 3],
    /// Layers of control points that do not move at both ends of every coordinate.
    pub frozen: [[usize; 2]; 3],
    /// Least and largest displacement of a control point, mm.
    pub displacement: [f64; 2],
    /// Bounds of the displacement of nodes.
    pub node_bounds: Vec<NodeBound>,
}

/// A bound of a component of the displacement of nodes by the shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeBound {
    /// Face or node set.
    pub place: String,
    /// The component: 0 for x₁, 1 for x₂, 2 for x₃.
    pub component: usize,
    /// Least and largest value, mm.
    pub range: [f64; 2],
}

/// Distance over the extent of a lattice at which a point still counts as inside: rounding of mesh files.
const INSIDE: f64 = 1e-9;

/// A control: what it adds to which control points, as (control point, direction, factor).
type Control = Vec<(usize, usize, f64)>;

impl LatticeShape {
    /// The axes along which control points move: 0 to 2, or 0 alone for the normal of a face.
    fn ways(&self) -> Vec<usize> {
        match &self.directions {
            Directions::Axes(axes) => (0..3).filter(|&axis| axes[axis]).collect(),
            Directions::Normal(_) => vec![0],
        }
    }

    /// The controls: by control point, then by direction; mirrored ones are one, those that symmetry holds none.
    fn controls(&self) -> Vec<Control> {
        let (counts, ways) = (self.control_points, self.ways());
        let index = |[i, j, l]: [usize; 3]| (i * counts[1] + j) * counts[2] + l;
        let mut controls = Vec::new();
        let mut done = BTreeSet::new();
        for point in 0..counts.iter().product() {
            let place = [point / (counts[1] * counts[2]), point / counts[2] % counts[1], point % counts[2]];
            let is_frozen = |axis: usize| {
                let [first, last] = self.frozen[axis];
                place[axis] < first || place[axis] + last >= counts[axis]
            };
            for &way in &ways {
                if done.contains(&(point, way)) || (0..3).any(is_frozen) {
                    continue;
                }
                let mut images: HashMap<usize, f64> = HashMap::from([(point, 1.0)]);
                let mut places = vec![(place, 1.0)];
                for axis in (0..3).filter(|&axis| self.symmetric[axis]) {
                    let along = matches!(self.directions, Directions::Axes(_)) && way == axis;
                    let mirrored: Vec<_> = places
                        .iter()
                        .map(|&(mut place, sign)| {
                            place[axis] = counts[axis] - 1 - place[axis];
                            (place, if along { -sign } else { sign })
                        })
                        .collect();
                    places.extend(mirrored);
                }
                for &(place, sign) in &places[1..] {
                    *images.entry(index(place)).or_insert(0.0) += sign;
                }
                let count = places.len() as f64 / images.len() as f64;
                done.extend(images.keys().map(|point| (*point, way)));
                let mut control: Control = images.into_iter().map(|(point, sum)| (point, way, sum / count)).collect();
                control.retain(|(.., factor)| *factor != 0.0);
                control.sort_unstable_by_key(|(point, ..)| *point);
                controls.extend((!control.is_empty()).then_some(control));
            }
        }
        controls
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.controls().len()
    }

    /// Checks what needs no mesh.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] naming the field.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.bases()?;
        match &self.coordinates {
            Coordinates::Cartesian { edges, .. } => {
                for (axis, edge) in edges.iter().enumerate() {
                    let valid = length(*edge) > 0.0 && length(*edge).is_finite();
                    let field = format!("lattice.edges[{axis}]");
                    SceneError::require(valid, field, format!("{edge:?}"), "an edge of some length (mm)")?;
                    for other in &edges[..axis] {
                        let cosine = dot(*edge, *other) / (length(*edge) * length(*other));
                        let allowed = "edges perpendicular to each other";
                        SceneError::require(cosine.abs() < 1e-6, "lattice.edges", format!("{edges:?}"), allowed)?;
                    }
                }
            }
            Coordinates::Cylindrical { axis, zero, ranges, .. } => {
                let valid = length(*axis) > 0.0 && length(cross(*axis, *zero)) > 1e-9 * length(*axis) * length(*zero);
                let value = format!("axis {axis:?}, zero {zero:?}");
                SceneError::require(valid, "lattice.axis", value, "two directions that are not parallel")?;
                for [least, largest] in ranges {
                    let value = format!("[{least}, {largest}]");
                    SceneError::require(least < largest, "lattice.ranges", value, "the smaller number first")?;
                }
            }
        }
        let [least, largest] = self.displacement;
        let value = format!("[{least}, {largest}]");
        let valid = least <= 0.0 && 0.0 <= largest && least < largest && least.is_finite() && largest.is_finite();
        SceneError::require(valid, "lattice.displacement", value, "finite numbers around 0, the smaller first (mm)")?;
        SceneError::require(self.control_count() > 0, "lattice.directions", "none", "at least one control that moves")
    }

    fn bases(&self) -> Result<[Basis; 3], SceneError> {
        let basis = |axis: usize| Basis::clamped(self.degrees[axis], self.control_points[axis], "lattice.degrees");
        Ok([basis(0)?, basis(1)?, basis(2)?])
    }

    /// The map of a body with this mesh; `held`: orthonormal directions in which supports hold a node.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names that the mesh does not have, and for a lattice that holds no node that may
    /// move.
    pub(crate) fn map<'b>(
        &self,
        mesh: &Mesh,
        points: &[MiddlePoint],
        held: impl Fn(u32) -> &'b [[f64; 3]],
    ) -> Result<BodyMap, SceneError> {
        let (bases, controls) = (self.bases()?, self.controls());
        let mut by_point: HashMap<(usize, usize), Vec<(usize, f64)>> = HashMap::new();
        for (number, control) in controls.iter().enumerate() {
            for &(point, way, factor) in control {
                by_point.entry((point, way)).or_default().push((number, factor));
            }
        }
        let region = self.region_nodes(mesh)?;
        let mut fixed = BTreeSet::new();
        for name in &self.fixed {
            fixed.extend(nodes_of("lattice.fixed", name, mesh)?);
        }
        let normals = match &self.directions {
            Directions::Axes(_) => None,
            Directions::Normal(face) => {
                let faces = find_face("lattice.normal", face, mesh)?;
                Some(crate::body::nodal_normals(mesh, faces))
            }
        };
        let (mut rows, mut moved) = (Vec::with_capacity(3 * mesh.node_count()), 0);
        // A middle is fixed, or in the region, where both ends of its edge are.
        let row = |x: [f64; 3], ends: &[u32], held: &[[f64; 3]]| {
            let is_in = |set: &BTreeSet<u32>| ends.iter().all(|end| set.contains(end));
            let free = !is_in(&fixed) && region.as_ref().is_none_or(is_in);
            let place = self.place(x).filter(|_| free);
            let directions = match (&normals, place) {
                (_, None) => None,
                (None, Some((_, frame))) => Some(frame.to_vec()),
                (Some(normals), Some(_)) => mean_normal(ends.iter().map(|end| normals.get(end))).map(|n| vec![n]),
            };
            match (place, directions) {
                (Some((xi, _)), Some(directions)) => self.rows(xi, &directions, &bases, &by_point, held),
                _ => [vec![], vec![], vec![]],
            }
        };
        for node in 0..mesh.node_count() as u32 {
            let row = row(mesh.nodes()[node as usize], &[node], held(node));
            moved += usize::from(row.iter().any(|row| !row.is_empty()));
            rows.extend(row);
        }
        for MiddlePoint { ends, place } in points {
            rows.extend(row(*place, ends, &common(ends.map(&held))));
        }
        if moved == 0 {
            let [least, most] = bounding_box(mesh.nodes());
            let allowed = format!("a box around nodes that may move; the body lies between {least:?} and {most:?} mm");
            return Err(SceneError::out_of_range("lattice", "a box without such nodes", allowed));
        }
        let base = mesh.nodes().iter().copied().chain(points.iter().map(|point| point.place)).collect();
        Ok(BodyMap { base, middles: points.len(), controls: controls.len(), rows })
    }

    /// The nodes of the region; none where all nodes in the box move.
    fn region_nodes(&self, mesh: &Mesh) -> Result<Option<BTreeSet<u32>>, SceneError> {
        if self.region.is_empty() {
            return Ok(None);
        }
        let mut region = BTreeSet::new();
        for name in &self.region {
            region.extend(nodes_of("lattice.region", name, mesh)?);
        }
        Ok(Some(region))
    }

    /// The rows of N of a node at lattice coordinates ξ, whose control points move along `directions`.
    fn rows(
        &self,
        xi: [f64; 3],
        directions: &[[f64; 3]],
        bases: &[Basis; 3],
        by_point: &HashMap<(usize, usize), Vec<(usize, f64)>>,
        held: &[[f64; 3]],
    ) -> [Vec<(usize, f64)>; 3] {
        let values: [Vec<f64>; 3] = std::array::from_fn(|axis| bases[axis].values(xi[axis]));
        let counts = self.control_points;
        let mut sums: HashMap<usize, [f64; 3]> = HashMap::new();
        for (i, a) in values[0].iter().enumerate().filter(|(_, a)| **a != 0.0) {
            for (j, b) in values[1].iter().enumerate().filter(|(_, b)| **b != 0.0) {
                for (l, c) in values[2].iter().enumerate().filter(|(_, c)| **c != 0.0) {
                    let point = (i * counts[1] + j) * counts[2] + l;
                    for (&way, &direction) in self.ways().iter().zip(&self.along(directions)) {
                        for &(control, factor) in by_point.get(&(point, way)).into_iter().flatten() {
                            let sum = sums.entry(control).or_default();
                            (0..3).for_each(|axis| sum[axis] += a * b * c * factor * direction[axis]);
                        }
                    }
                }
            }
        }
        let mut rows = [vec![], vec![], vec![]];
        let mut sums: Vec<(usize, [f64; 3])> = sums.into_iter().collect();
        sums.sort_unstable_by_key(|(control, _)| *control);
        for (control, mut sum) in sums {
            for direction in held.iter().filter(|_| self.hold_supports) {
                let share = dot(*direction, sum);
                (0..3).for_each(|axis| sum[axis] -= share * direction[axis]);
            }
            let size = length(sum);
            for axis in (0..3).filter(|&axis| sum[axis].abs() > 1e-14 * size) {
                rows[axis].push((control, sum[axis]));
            }
        }
        rows
    }

    /// Of the directions at a node, those along which control points move.
    fn along(&self, directions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self.directions {
            Directions::Normal(_) => directions.to_vec(),
            Directions::Axes(_) => self.ways().into_iter().map(|way| directions[way]).collect(),
        }
    }

    /// Lattice coordinates of a point on [0, 1], and the unit vectors of the coordinates there; none outside the box.
    fn place(&self, x: [f64; 3]) -> Option<([f64; 3], [[f64; 3]; 3])> {
        let (xi, frame): ([f64; 3], [[f64; 3]; 3]) = match self.coordinates {
            Coordinates::Cartesian { corner, edges } => {
                let from = subtract(x, corner);
                (edges.map(|edge| dot(from, edge) / dot(edge, edge)), edges.map(unit))
            }
            Coordinates::Cylindrical { point, axis, zero, ranges } => {
                let axis = unit(axis);
                let second = unit(cross(axis, zero));
                let first = cross(second, axis);
                let from = subtract(x, point);
                let (height, a, b) = (dot(from, axis), dot(from, first), dot(from, second));
                let radius = a.hypot(b);
                // The angle counts from the least one of the range.
                let [least, largest] = ranges[1];
                let turn = 2.0 * std::f64::consts::PI;
                let slack = INSIDE * (largest - least);
                let angle = least - slack + (b.atan2(a) - least + slack).rem_euclid(turn);
                let outward = combine(first, a / radius, second, b / radius);
                let around = combine(first, -b / radius, second, a / radius);
                let place = [radius, angle, height];
                let xi = |k: usize| (place[k] - ranges[k][0]) / (ranges[k][1] - ranges[k][0]);
                (std::array::from_fn(xi), [outward, around, axis])
            }
        };
        let inside = xi.iter().all(|xi| (-INSIDE..=1.0 + INSIDE).contains(xi));
        inside.then(|| (xi.map(|xi| xi.clamp(0.0, 1.0)), frame))
    }

    /// Where a control point lies at the reference shape, mm.
    fn point_place(&self, point: usize) -> [f64; 3] {
        let counts = self.control_points;
        let index = [point / (counts[1] * counts[2]), point / counts[2] % counts[1], point % counts[2]];
        let xi = |axis: usize| match counts[axis] {
            1 => 0.5,
            count => index[axis] as f64 / (count - 1) as f64,
        };
        match self.coordinates {
            Coordinates::Cartesian { corner, edges } => {
                std::array::from_fn(|k| corner[k] + (0..3).map(|axis| xi(axis) * edges[axis][k]).sum::<f64>())
            }
            Coordinates::Cylindrical { point, axis, zero, ranges } => {
                let axis = unit(axis);
                let second = unit(cross(axis, zero));
                let first = cross(second, axis);
                let [radius, angle, height] =
                    std::array::from_fn(|k| ranges[k][0] + xi(k) * (ranges[k][1] - ranges[k][0]));
                let across = combine(first, radius * angle.cos(), second, radius * angle.sin());
                std::array::from_fn(|k| point[k] + across[k] + height * axis[k])
            }
        }
    }

    /// Names of the controls: place of the control point and direction.
    pub fn control_names(&self) -> Vec<String> {
        let way = |way: usize| match (&self.directions, self.coordinates) {
            (Directions::Normal(face), _) => format!("along the normal of {face}"),
            (_, Coordinates::Cartesian { edges, .. }) => {
                let edge = unit(edges[way]);
                match (0..3).find(|&axis| edge[axis].abs() > 1.0 - 1e-12) {
                    Some(axis) => format!("along x{}", axis + 1),
                    None => format!("along edge {}", way + 1),
                }
            }
            (_, Coordinates::Cylindrical { .. }) => ["outwards", "around", "along the axis"][way].to_owned(),
        };
        let name = |control: &Control| {
            let (point, direction, _) = control[0];
            let [x1, x2, x3] = self.point_place(point);
            format!("control point at ({x1:.4}, {x2:.4}, {x3:.4}) mm {}", way(direction))
        };
        self.controls().iter().map(name).collect()
    }
}

/// The held directions of the first that the second has too.
fn common([first, second]: [&[[f64; 3]]; 2]) -> Vec<[f64; 3]> {
    let is_held = |direction: &&[f64; 3]| {
        let square: f64 = second.iter().map(|other| dot(**direction, *other).powi(2)).sum();
        (square - 1.0).abs() < 1e-8
    };
    first.iter().filter(is_held).copied().collect()
}

/// The mean of unit normals at length one; none where one is missing.
fn mean_normal<'n>(normals: impl Iterator<Item = Option<&'n [f64; 3]>>) -> Option<[f64; 3]> {
    let all: Vec<[f64; 3]> = normals.map(Option::<&[f64; 3]>::copied).collect::<Option<_>>()?;
    if let [only] = all[..] {
        return Some(only);
    }
    let sum = all.iter().fold([0.0; 3], |sum, normal| combine(sum, 1.0, *normal, 1.0));
    Some(unit(sum))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = length(a);
    a.map(|x| x / length)
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn combine(a: [f64; 3], s: f64, b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|axis| s * a[axis] + t * b[axis])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
