//! The admissible shapes U.
//!
//! ```text
//! a ≤ α ≤ b of every control,   |α_{i+1,j,l} − α_ijl| ≤ C₁L₁/d₁ along every coordinate,   C₂₁ ≤ meas Ω(α) ≤ C₂₂
//! heights of a face:  C₀ ≤ α_ij ≤ F²(x₁ⁱ, x₂ʲ)
//! ```
//! method.md section 2. d₁, d₂ are numbers of intervals between controls. Of heights, both the measure of the domain
//! under the spline and the volume of its cells are kept within the bounds: they differ by the discretisation error.

use crate::body::mesh::Mesh;
use crate::error::SceneError;
use crate::names::nodes_of;
use crate::scene::{Block, CounterSurface, Opposite, Scene};
use crate::shape::control_rows::{NamedRow, slope_rows, volume_rows};
use crate::shape::{BodyMap, LatticeShape, ShapedFace};
use nonsmooth::{Matrix, Polyhedron, Vector};

/// Relative violation that still counts as admissible: rounding in user files and in the optimizer's steps.
const ADMISSIBLE: f64 = 1e-9;

/// Most rows that bound displacements of nodes.
const MOST_ROWS: usize = 2000;

/// U as a polyhedron, with words for its rows.
#[derive(Debug, Clone)]
pub struct AdmissibleSet {
    polyhedron: Polyhedron,
    control_names: Vec<String>,
    row_names: Vec<String>,
    /// Number of rows that depend on the mesh, at the end.
    volume_rows: usize,
}

/// Bounds and rows of the controls of one body.
#[derive(Debug, Default)]
struct Part {
    /// Least and largest value of every control.
    bounds: [Vec<f64>; 2],
    control_names: Vec<String>,
    rows: Vec<NamedRow>,
    volume_rows: Vec<NamedRow>,
}

impl AdmissibleSet {
    /// U of a scene, for the maps and meshes of its bodies.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names that a mesh does not have and for too many bounded nodes;
    /// [`SceneError::Set`] when bounds contradict each other.
    pub(crate) fn new(scene: &Scene, meshes: &[&Mesh], maps: &[BodyMap]) -> Result<Self, SceneError> {
        let shaped = scene.bodies.iter().filter(|body| body.shape.is_some()).count();
        let mut whole = Part::default();
        let starts: Vec<usize> =
            maps.iter().scan(0, |next, map| Some(std::mem::replace(next, *next + map.controls))).collect();
        for (number, body) in scene.bodies.iter().enumerate() {
            let Some(shape) = &body.shape else { continue };
            let block = body.start_block();
            let mut part = Part::new((shape, starts[number]), (&maps[number], meshes[number]), block.as_ref())?;
            if let Some(block) = &block {
                part.keep_apart(scene, (number, block, shape));
            }
            let name = |name: String| if shaped > 1 { format!("{}: {name}", body.name) } else { name };
            let moved = |(words, row, sides): NamedRow| {
                let row = row.into_iter().map(|(control, value)| (starts[number] + control, value)).collect();
                (name(words), row, sides)
            };
            (0..2).for_each(|side| whole.bounds[side].extend(&part.bounds[side]));
            whole.control_names.extend(part.control_names.into_iter().map(name));
            whole.rows.extend(part.rows.into_iter().map(moved));
            whole.volume_rows.extend(part.volume_rows.into_iter().map(moved));
        }
        whole.rows.extend(below(scene, &starts)?);
        whole.set()
    }

    /// The set for the optimizer.
    pub fn polyhedron(&self) -> &Polyhedron {
        &self.polyhedron
    }

    /// Name, value, lower and upper bound of every control and every row.
    fn expressions(&self, controls: &Vector) -> Vec<(String, f64, f64, f64)> {
        let set = &self.polyhedron;
        let products = set.rows() * controls;
        let bounds =
            (0..controls.len()).map(|i| (self.control_names[i].clone(), controls[i], set.lower()[i], set.upper()[i]));
        let rows = (0..products.len())
            .map(|i| (self.row_names[i].clone(), products[i], set.row_lower()[i], set.row_upper()[i]));
        bounds.chain(rows).collect()
    }

    /// Bounds and rows that controls attain (up to the tolerance of [`AdmissibleSet::check`]), in words.
    pub fn active(&self, controls: &Vector) -> Vec<String> {
        let attained = |value: f64, side: f64| {
            side.is_finite() && (value - side).abs() <= ADMISSIBLE * side.abs().max(f64::MIN_POSITIVE)
        };
        let words = |(name, value, lower, upper): (String, f64, f64, f64)| match () {
            () if attained(value, lower) => Some(format!("{name} = {}, its least value", rounded(lower))),
            () if attained(value, upper) => Some(format!("{name} = {}, its largest value", rounded(upper))),
            () => None,
        };
        self.expressions(controls).into_iter().filter_map(words).collect()
    }

    /// Refuses controls outside U.
    ///
    /// # Errors
    /// [`SceneError::NotAdmissible`] naming the most violated bound or row, its value and what is allowed.
    pub fn check(&self, controls: &Vector) -> Result<(), SceneError> {
        self.check_some(controls, self.row_names.len())
    }

    /// Refuses controls whose heights or slopes are outside U. The volume of the bricks is another one on every mesh: a
    /// shape that attains its bound on one of them may be shown on all.
    ///
    /// # Errors
    /// As [`AdmissibleSet::check`].
    pub fn check_shape(&self, controls: &Vector) -> Result<(), SceneError> {
        self.check_some(controls, self.row_names.len() - self.volume_rows)
    }

    /// Refuses controls outside the bounds and the first rows of U.
    fn check_some(&self, controls: &Vector, rows: usize) -> Result<(), SceneError> {
        // What rows are made of may be large where their sides are small: a volume that is to stay.
        let terms = self.polyhedron.rows().abs() * controls.abs();
        let terms = std::iter::repeat_n(0.0, controls.len()).chain(terms.iter().copied());
        let excess = |&((_, value, lower, upper), terms): &((String, f64, f64, f64), f64)| {
            // A side that is open is no scale.
            let sides = [lower, upper].into_iter().filter(|side| side.is_finite());
            let scale = sides.fold(terms.max(f64::MIN_POSITIVE), |scale, side| scale.max(side.abs()));
            (lower - value).max(value - upper) / scale
        };
        let expressions = self.expressions(controls).into_iter().zip(terms).take(controls.len() + rows);
        let worst = expressions.max_by(|a, b| excess(a).total_cmp(&excess(b)));
        match worst.filter(|worst| excess(worst) > ADMISSIBLE) {
            Some(((constraint, value, lower, upper), _)) => {
                Err(SceneError::NotAdmissible { constraint, value, allowed: format!("[{lower}, {upper}]") })
            }
            None => Ok(()),
        }
    }
}

impl Part {
    /// The range of the controls of a lattice, whose first one has a number among all, with the bounds of nodes, slopes
    /// and volume.
    fn new(
        (shape, first): (&LatticeShape, usize),
        (map, mesh): (&BodyMap, &Mesh),
        block: Option<&Block>,
    ) -> Result<Self, SceneError> {
        let mut rows: Vec<NamedRow> = Vec::new();
        for (index, bound) in shape.node_bounds.iter().enumerate() {
            let field = format!("lattice.bounds[{index}]");
            let axis = bound.component;
            let mut nodes = nodes_of(&format!("{field}.place"), &bound.place, mesh)?;
            nodes.sort_unstable();
            nodes.dedup();
            for node in nodes {
                let row = map.row(node, axis);
                if !row.is_empty() {
                    let name = format!("displacement of node {node} along x{} ({field})", axis + 1);
                    let start = shape.start * row.iter().map(|(_, value)| value).sum::<f64>();
                    rows.push((name, row.to_vec(), bound.range.map(|side| side + start)));
                }
            }
        }
        let allowed = format!("at most {MOST_ROWS} nodes");
        SceneError::require(rows.len() <= MOST_ROWS, "lattice.bounds", format!("{} nodes", rows.len()), allowed)?;
        rows.extend(shape.slope.map_or_else(Vec::new, |slope| slope_rows(shape, slope, first, block)));
        let volume_rows = shape.volume.map(|range| volume_rows(shape, range, (map, mesh), block)).transpose()?;
        let bounds = shape.range.map(|value| vec![value; map.controls]);
        let names = shape.control_names(block).into_iter().enumerate();
        let control_names = names.map(|(control, name)| format!("{name}, α[{}]", first + control)).collect();
        Ok(Self { bounds, control_names, rows, volume_rows: volume_rows.unwrap_or_default() })
    }

    /// Keeps heights away from the other face of their block, and on their side of what lies opposite to them.
    fn keep_apart(&mut self, scene: &Scene, (number, block, shape): (usize, &Block, &LatticeShape)) {
        let (Some(face), Some(thickness)) = (shape.face(), shape.thickness) else { return };
        let opposite = match scene.opposite(number, face) {
            Some(Opposite::Heights(surface)) => Some(surface),
            Some(Opposite::Shaped(_)) | None => None,
        };
        let [lower, upper] = &mut self.bounds;
        for (control, [x1, x2]) in shape.height_places(block).enumerate() {
            let over = |surface: &CounterSurface| surface.height(x1, x2);
            let (least, largest) = match face {
                ShapedFace::Top => (over(&block.bottom) + thickness, opposite.map_or(f64::INFINITY, over)),
                ShapedFace::Bottom => (opposite.map_or(f64::NEG_INFINITY, over), over(&block.top) - thickness),
            };
            lower[control] = lower[control].max(least);
            upper[control] = upper[control].min(largest);
        }
    }

    fn set(self) -> Result<AdmissibleSet, SceneError> {
        let Self { bounds: [lower, upper], control_names, mut rows, volume_rows: volumes } = self;
        let volume_rows = volumes.len();
        rows.extend(volumes);
        let dimension = lower.len();
        let polyhedron = Polyhedron::boxed(Vector::from_vec(lower), Vector::from_vec(upper))?;
        let row_names = rows.iter().map(|(name, ..)| name.clone()).collect();
        if rows.is_empty() {
            return Ok(AdmissibleSet { polyhedron, control_names, row_names, volume_rows });
        }
        let mut matrix = Matrix::zeros(rows.len(), dimension);
        for (row, (_, entries, _)) in rows.iter().enumerate() {
            for &(column, value) in entries {
                matrix[(row, column)] += value;
            }
        }
        let side = |which: usize| Vector::from_iterator(rows.len(), rows.iter().map(|(_, _, sides)| sides[which]));
        let polyhedron = polyhedron.with_rows(&matrix, &side(0), &side(1))?;
        Ok(AdmissibleSet { polyhedron, control_names, row_names, volume_rows })
    }
}

/// Where the surfaces of two blocks lie opposite to each other and controls shape both: the controls of the lower one
/// stay below the upper surface.
fn below(scene: &Scene, starts: &[usize]) -> Result<Vec<NamedRow>, SceneError> {
    let mut rows = Vec::new();
    for (lower, body) in scene.bodies.iter().enumerate() {
        let (Some(own), Some(block)) = (body.heights(), body.block()) else { continue };
        let Some(Opposite::Shaped(upper)) = scene.opposite(lower, ShapedFace::Top) else { continue };
        let other = &scene.bodies[upper];
        let (Some(theirs), Some(above)) = (other.heights(), other.block()) else { continue };
        if own.face() != Some(ShapedFace::Top) {
            continue;
        }
        let surface = theirs.surface()?;
        for (control, at) in own.height_places(block).enumerate() {
            let place: [f64; 2] = std::array::from_fn(|axis| (at[axis] - above.corner[axis]) / above.size[axis]);
            if place.iter().any(|place| !(0.0..=1.0).contains(place)) {
                continue;
            }
            let mut row = vec![(starts[lower] + control, 1.0)];
            row.extend(surface.weights(place).into_iter().map(|(other, weight)| (starts[upper] + other, -weight)));
            let name = format!("α[{}] less the surface of {} above it", starts[lower] + control, other.name);
            // No shape is farther apart than the faces that keep their shape.
            let apart = above.top.height(at[0], at[1]) - block.bottom.height(at[0], at[1]);
            rows.push((name, row, [-apart, 0.0]));
        }
    }
    Ok(rows)
}

/// A number with seven digits, as people read them.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}
