//! Free-form deformation by a lattice of control points: x = x₀ + Σ B_i(ξ₁) B_j(ξ₂) B_l(ξ₃) d (α_ijl − α⁰).
//!
//! ```text
//! Cartesian:    ξ along three axes of a box, d the axes of the box, or the normal of a face
//! cylindrical:  ξ along radius, angle and axis, d the unit vectors there: one control along the angle makes a revolved profile,
//!               one control along an axis of a box an extruded one
//! block:        ξ along the bricks; two control points across the thickness, of which one layer does not move: heights of a face
//! ```
//! A B-spline of degree count − 1 is the Bernstein basis. Nodes outside the box do not move. Where supports hold nodes,
//! these do not move in the held directions, unless the lattice says otherwise.

use crate::body::mesh::BlockFace;
use crate::error::SceneError;
use crate::scene::Block;
use crate::shape::bspline::Basis;
use crate::shape::coordinates::Coordinates;
use crate::shape::surface::SplineSurface;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap};

/// The face of a block whose heights controls are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "ShapedFaceName", transform = crate::schema::names_only))]
pub enum ShapedFace {
    /// The upper surface.
    #[default]
    Top,
    /// The lower surface.
    Bottom,
}

impl ShapedFace {
    /// The face of the block.
    pub fn block_face(self) -> BlockFace {
        match self {
            Self::Top => BlockFace::Top,
            Self::Bottom => BlockFace::Bottom,
        }
    }
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
    /// α⁰, the value of every control at the start, mm: 0 where controls are displacements, the height of a plane where
    /// they are heights of a face ([`LatticeShape::face`]).
    pub start: f64,
    /// Least and largest value of a control, mm.
    pub range: [f64; 2],
    /// Bounds of the displacement of nodes.
    pub node_bounds: Vec<NodeBound>,
    /// Least distance of a height from the other face of its block, mm. Heights with this bound also stay on their side
    /// of what lies opposite to their face in a contact.
    pub thickness: Option<f64>,
    /// Largest slope of the net of controls: the difference of neighbours along a coordinate over the distance of their
    /// places.
    pub slope: Option<f64>,
    /// Least and largest volume of the body, mm³, for controls that move nodes along one axis of space. Of heights, the
    /// measure below or above the spline keeps these bounds besides.
    pub volume: Option<[f64; 2]>,
    /// The factor of the bending in the objective, unit of Θ; the bending has no unit. 0: none.
    pub fairness: f64,
    /// Whether an optimization begins with several short attempts, one of them on a coarse net of controls.
    pub attempts: bool,
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

/// Highest degree that is chosen without being asked for.
const USUAL_DEGREE: usize = 3;

/// A control: what it adds to which control points, as (control point, direction, factor).
pub(crate) type Control = Vec<(usize, usize, f64)>;

/// The controls that move a control point in a direction, as (control, factor).
pub(crate) type Movers = HashMap<(usize, usize), Vec<(usize, f64)>>;

impl LatticeShape {
    /// A lattice of displacements along all its axes, of degree 3 or as high as the control points allow, whose
    /// controls lie in a range (mm). Supports hold their nodes.
    pub fn new(coordinates: Coordinates, control_points: [usize; 3], range: [f64; 2]) -> Self {
        Self {
            coordinates,
            control_points,
            degrees: control_points.map(|count| USUAL_DEGREE.min(count.saturating_sub(1))),
            directions: Directions::Axes([true; 3]),
            region: Vec::new(),
            fixed: Vec::new(),
            hold_supports: true,
            symmetric: [false; 3],
            frozen: [[0; 2]; 3],
            start: 0.0,
            range,
            node_bounds: Vec::new(),
            thickness: None,
            slope: None,
            volume: None,
            fairness: 0.0,
            attempts: false,
        }
    }

    /// Heights of a face of a block, all at `start` (mm) at first: a lattice of degree 1 across the thickness, of which
    /// the layer of the other face does not move. Supports do not hold heights.
    pub fn heights(face: ShapedFace, control_points: [usize; 2], degrees: [usize; 2], start: f64) -> Self {
        let ([n1, n2], [first, second]) = (control_points, degrees);
        let still = if face == ShapedFace::Top { [1, 0] } else { [0, 1] };
        Self {
            degrees: [first, second, 1],
            directions: Directions::Axes([false, false, true]),
            hold_supports: false,
            frozen: [[0; 2], [0; 2], still],
            start,
            attempts: true,
            ..Self::new(Coordinates::Block, [n1, n2, 2], [f64::NEG_INFINITY, f64::INFINITY])
        }
    }

    /// The face whose heights the controls are, index i·n₂ + j; none where they are displacements.
    pub fn face(&self) -> Option<ShapedFace> {
        let along_x3 = self.directions == Directions::Axes([false, false, true]) && !self.hold_supports;
        let is_layer = (self.control_points[2], self.degrees[2]) == (2, 1) && self.frozen[..2] == [[0; 2]; 2];
        let is_whole = self.region.is_empty() && self.fixed.is_empty() && self.symmetric == [false; 3];
        let is_heights = self.coordinates == Coordinates::Block && along_x3 && is_layer && is_whole;
        match self.frozen[2] {
            [1, 0] if is_heights && self.start != 0.0 => Some(ShapedFace::Top),
            [0, 1] if is_heights && self.start != 0.0 => Some(ShapedFace::Bottom),
            _ => None,
        }
    }

    /// The spline surface over the first two coordinates, of which heights are control values.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] when there are too few control points for the degree.
    pub fn surface(&self) -> Result<SplineSurface, SceneError> {
        let [first, second, _] = self.bases()?;
        Ok(SplineSurface::new([first, second]))
    }

    /// Whether a coordinate goes across a body of which one face moves and the other does not.
    pub(crate) fn is_across(&self, axis: usize) -> bool {
        self.control_points[axis] == 2 && self.frozen[axis].iter().sum::<usize>() == 1
    }

    /// The axes along which control points move: 0 to 2, or 0 alone for the normal of a face.
    pub(crate) fn ways(&self) -> Vec<usize> {
        match &self.directions {
            Directions::Axes(axes) => (0..3).filter(|&axis| axes[axis]).collect(),
            Directions::Normal(_) => vec![0],
        }
    }

    /// The controls: by control point, then by direction; mirrored ones are one, those that symmetry holds none.
    pub(crate) fn controls(&self) -> Vec<Control> {
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

    /// What every control point takes from the controls.
    pub(crate) fn movers(&self) -> Movers {
        let mut movers = Movers::new();
        for (number, control) in self.controls().iter().enumerate() {
            for &(point, way, factor) in control {
                movers.entry((point, way)).or_default().push((number, factor));
            }
        }
        movers
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        if self.symmetric != [false; 3] {
            return self.controls().len();
        }
        let free = |axis: usize| self.control_points[axis].saturating_sub(self.frozen[axis].iter().sum());
        (0..3).map(free).product::<usize>() * self.ways().len()
    }

    /// The controls at the start, mm.
    pub fn start_controls(&self) -> Vec<f64> {
        vec![self.start; self.control_count()]
    }

    /// Checks what needs no mesh.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] naming the field.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.bases()?;
        self.coordinates.validate()?;
        let [least, largest] = self.range;
        let value = format!("[{least}, {largest}]");
        match self.face() {
            Some(_) => {
                let valid = self.start > 0.0 && self.start.is_finite();
                SceneError::require(valid, "lattice.start", self.start, "a finite mean height > 0 mm")?;
                SceneError::require(least < largest, "lattice.range", value, "the smaller number first (mm)")?;
                let (points, allowed) = (&self.control_points[..2], "at least 2 along x1 and x2");
                let valid = points.iter().all(|count| *count > 1);
                SceneError::require(valid, "lattice.control_points", format!("{points:?}"), allowed)?;
            }
            None => {
                let valid =
                    least <= 0.0 && 0.0 <= largest && least < largest && least.is_finite() && largest.is_finite();
                let allowed = "finite numbers around 0, the smaller first (mm)";
                SceneError::require(valid, "lattice.displacement", value, allowed)?;
                let allowed = "0 where controls are displacements (mm)";
                SceneError::require(self.start == 0.0, "lattice.start", self.start, allowed)?;
                let allowed = "none where controls are displacements";
                SceneError::require(self.thickness.is_none(), "lattice.thickness", "a thickness", allowed)?;
            }
        }
        if let Some([least, largest]) = self.volume {
            let value = format!("[{least}, {largest}]");
            let allowed = "the smallest volume, then the largest (mm³)";
            SceneError::require(least <= largest, "lattice.volume", value, allowed)?;
        }
        SceneError::require(self.control_count() > 0, "lattice.directions", "none", "at least one control that moves")
    }

    /// The bases along the coordinates.
    pub(crate) fn bases(&self) -> Result<[Basis; 3], SceneError> {
        let basis = |axis: usize| Basis::clamped(self.degrees[axis], self.control_points[axis], "lattice.degrees");
        Ok([basis(0)?, basis(1)?, basis(2)?])
    }

    /// Where a control point lies at the start, mm.
    pub(crate) fn point_place(&self, point: usize, block: Option<&Block>) -> [f64; 3] {
        let counts = self.control_points;
        let index = [point / (counts[1] * counts[2]), point / counts[2] % counts[1], point % counts[2]];
        let xi = |axis: usize| match counts[axis] {
            1 => 0.5,
            count => index[axis] as f64 / (count - 1) as f64,
        };
        self.coordinates.point(std::array::from_fn(xi), block)
    }

    /// Places (x₁, x₂) of heights of a face, spread evenly over the base of their block, mm.
    pub(crate) fn height_places(&self, block: &Block) -> impl Iterator<Item = [f64; 2]> + use<> {
        let ([n1, n2, _], size, grid) = (self.control_points, block.size, block.grid());
        let along = move |axis: usize, index: usize, count: usize| size[axis] * index as f64 / (count - 1) as f64;
        (0..n1).flat_map(move |i| (0..n2).map(move |j| grid.moved([along(0, i, n1), along(1, j, n2)])))
    }

    /// Names of the controls: place of the control point and direction; `block`: the block at the start, for lattices
    /// in its coordinates.
    pub fn control_names(&self, block: Option<&Block>) -> Vec<String> {
        let name = |control: &Control| {
            let (point, direction, _) = control[0];
            let [x1, x2, x3] = self.point_place(point, block);
            match (self.face(), &self.directions) {
                (Some(_), _) => format!("height of control point at ({x1:.4}, {x2:.4}) mm"),
                (None, Directions::Normal(face)) => {
                    format!("control point at ({x1:.4}, {x2:.4}, {x3:.4}) mm along the normal of {face}")
                }
                (None, Directions::Axes(_)) => {
                    let way = self.coordinates.way(direction);
                    format!("control point at ({x1:.4}, {x2:.4}, {x3:.4}) mm {way}")
                }
            }
        };
        self.controls().iter().map(name).collect()
    }
}
