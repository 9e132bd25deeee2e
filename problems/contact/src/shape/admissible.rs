//! The admissible shapes U.
//!
//! ```text
//! C₀ ≤ α_ij ≤ F²(x₁ⁱ, x₂ʲ),   |α_{i+1,j} − α_ij| ≤ C₁a/d₁,   |α_{i,j+1} − α_ij| ≤ C₁b/d₂,   C₂₁ ≤ meas Ω¹(α) ≤ C₂₂
//! ```
//! method.md section 2. d₁, d₂ are numbers of intervals between controls. Both the measure of the domain under the
//! spline and the volume of its bricks are kept within the bounds: they differ by the discretisation error.

use crate::body::mesh::{Grid, Mesh};
use crate::error::SceneError;
use crate::names::nodes_of;
use crate::scene::{Block, CounterSurface, Geometry, Opposite, Scene};
use crate::shape::{BodyMap, HeightShape, LatticeShape, ShapeScene, ShapedFace, SplineSurface};
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

/// A row with its name, entries and sides.
type NamedRow = (String, Vec<(usize, f64)>, [f64; 2]);

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
            let part = match (&body.shape, &body.geometry) {
                (Some(ShapeScene::Heights(heights)), Geometry::Block(block)) => {
                    Part::of_heights(scene, (number, block, heights), &starts)?
                }
                (Some(ShapeScene::Lattice(lattice)), _) => Part::of_lattice(lattice, &maps[number], meshes[number])?,
                _ => continue,
            };
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
        let excess = |value: f64, lower: f64, upper: f64| {
            // A side that is open is no scale.
            let sides = [lower, upper].into_iter().filter(|side| side.is_finite());
            (lower - value).max(value - upper) / sides.fold(f64::MIN_POSITIVE, |scale, side| scale.max(side.abs()))
        };
        let expressions = self.expressions(controls).into_iter().take(controls.len() + rows);
        let worst = expressions.max_by(|a, b| excess(a.1, a.2, a.3).total_cmp(&excess(b.1, b.2, b.3)));
        match worst.filter(|worst| excess(worst.1, worst.2, worst.3) > ADMISSIBLE) {
            Some((constraint, value, lower, upper)) => {
                Err(SceneError::NotAdmissible { constraint, value, allowed: format!("[{lower}, {upper}]") })
            }
            None => Ok(()),
        }
    }
}

impl Part {
    /// The heights of a face of a block: between its other face and what lies opposite to it.
    fn of_heights(
        scene: &Scene,
        (number, block, heights): (usize, &Block, &HeightShape),
        starts: &[usize],
    ) -> Result<Self, SceneError> {
        let (surface, grid, bounds) = (heights.surface()?, block.grid(), &heights.bounds);
        let places: Vec<[f64; 2]> = surface.places(block.size).map(|at| grid.moved(at)).collect();
        let over =
            |surface: &CounterSurface| -> Vec<f64> { places.iter().map(|at| surface.height(at[0], at[1])).collect() };
        let opposite = match scene.opposite(number, heights.face) {
            Some(Opposite::Heights(surface)) => Some(over(surface)),
            Some(Opposite::Shaped(_)) | None => None,
        };
        let unbounded = |value: f64| vec![value; places.len()];
        let away = |heights: Vec<f64>, by: f64| heights.into_iter().map(|height| height + by).collect();
        let bounds_of_heights = match heights.face {
            ShapedFace::Top => {
                [away(over(&block.bottom), bounds.minimum_height), opposite.unwrap_or_else(|| unbounded(f64::INFINITY))]
            }
            ShapedFace::Bottom => [
                opposite.unwrap_or_else(|| unbounded(f64::NEG_INFINITY)),
                away(over(&block.top), -bounds.minimum_height),
            ],
        };
        let control_names =
            (0..places.len()).map(|i| format!("height of control {i}, α[{}]", starts[number] + i)).collect();
        Ok(Self {
            bounds: bounds_of_heights,
            control_names,
            rows: slopes(&surface, &grid, bounds.slope, starts[number]),
            volume_rows: volumes(&surface, block, heights).into(),
        })
    }

    /// The box of a lattice with bounds of node displacements.
    fn of_lattice(lattice: &LatticeShape, map: &BodyMap, mesh: &Mesh) -> Result<Self, SceneError> {
        let mut rows: Vec<NamedRow> = Vec::new();
        for (index, bound) in lattice.node_bounds.iter().enumerate() {
            let field = format!("lattice.bounds[{index}]");
            let axis = bound.component;
            let mut nodes = nodes_of(&format!("{field}.place"), &bound.place, mesh)?;
            nodes.sort_unstable();
            nodes.dedup();
            for node in nodes {
                let row = map.row(node, axis);
                if !row.is_empty() {
                    let name = format!("displacement of node {node} along x{} ({field})", axis + 1);
                    rows.push((name, row.to_vec(), bound.range));
                }
            }
        }
        let allowed = format!("at most {MOST_ROWS} nodes");
        SceneError::require(rows.len() <= MOST_ROWS, "lattice.bounds", format!("{} nodes", rows.len()), allowed)?;
        let bounds = lattice.displacement.map(|value| vec![value; map.controls]);
        Ok(Self { bounds, control_names: lattice.control_names(), rows, volume_rows: Vec::new() })
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

/// Slopes between neighbouring controls; `first`: of the controls among all.
fn slopes(surface: &SplineSurface, grid: &Grid, slope: f64, first: usize) -> Vec<NamedRow> {
    let counts = surface.counts();
    let intervals = counts.map(|count| (count - 1) as f64);
    let mut rows = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let here = i * counts[1] + j;
            for (axis, exists, next) in [(0, i + 1 < counts[0], here + counts[1]), (1, j + 1 < counts[1], here + 1)] {
                if exists {
                    let bound = slope * grid.size[axis] / intervals[axis];
                    let [next_name, here_name] = [first + next, first + here];
                    let name = format!("α[{next_name}] − α[{here_name}] (admissible.slope along x{})", axis + 1);
                    rows.push((name, vec![(next, 1.0), (here, -1.0)], [-bound, bound]));
                }
            }
        }
    }
    rows
}

/// The volumes between a surface and the other face of its block: under the spline, and of the bricks.
fn volumes(surface: &SplineSurface, block: &Block, heights: &HeightShape) -> [NamedRow; 2] {
    let (grid, [least, largest]) = (block.grid(), heights.bounds.volume);
    let [bottom, top] = block.heights();
    let columns = column_areas(&grid);
    let under = |heights: &[f64]| heights.iter().zip(&columns).map(|(height, area)| height * area).sum::<f64>();
    // What the volume and the integral of the surface make up for.
    let (words, sides) = match heights.face {
        ShapedFace::Top => ("under", [under(&bottom) + least, under(&bottom) + largest]),
        ShapedFace::Bottom => ("above", [under(&top) - largest, under(&top) - least]),
    };
    let area = grid.size[0] * grid.size[1];
    let measure = surface.integrals().into_iter().map(|value| value * area).enumerate().collect();
    let bricks = surface.height_map(&grid).pull_back(&columns).into_iter().enumerate().collect();
    [
        (format!("volume {words} the surface (admissible.volume)"), measure, sides),
        ("volume of the bricks (admissible.volume)".into(), bricks, sides),
    ]
}

/// Where the surfaces of two blocks lie opposite to each other and controls shape both: the controls of the lower one
/// stay below the upper surface.
fn below(scene: &Scene, starts: &[usize]) -> Result<Vec<NamedRow>, SceneError> {
    let mut rows = Vec::new();
    for (lower, body) in scene.bodies.iter().enumerate() {
        let (Some(own), Some(block)) = (body.heights(), body.block()) else { continue };
        let Some(Opposite::Shaped(upper)) = scene.opposite(lower, own.face).filter(|_| own.face == ShapedFace::Top)
        else {
            continue;
        };
        let other = &scene.bodies[upper];
        let (Some(theirs), Some(above)) = (other.heights(), other.block()) else { continue };
        let surface = theirs.surface()?;
        for (control, at) in own.surface()?.places(block.size).enumerate() {
            let at = block.grid().moved(at);
            let place: [f64; 2] = std::array::from_fn(|axis| (at[axis] - above.corner[axis]) / above.size[axis]);
            if place.iter().any(|place| !(0.0..=1.0).contains(place)) {
                continue;
            }
            let weights = surface.height_map_at(place.map(|place| vec![place])).weights(0, 0);
            let mut row = vec![(starts[lower] + control, 1.0)];
            row.extend(weights.into_iter().map(|(other, weight)| (starts[upper] + other, -weight)));
            let name = format!("α[{}] less the surface of {} above it", starts[lower] + control, other.name);
            // No shape is farther apart than the faces that keep their shape.
            let apart = above.top.height(at[0], at[1]) - block.bottom.height(at[0], at[1]);
            rows.push((name, row, [-apart, 0.0]));
        }
    }
    Ok(rows)
}

/// Areas of the columns of a grid: h₁h₂ inside, half on edges, quarter in corners; mm².
fn column_areas(grid: &Grid) -> Vec<f64> {
    let [n1, n2, _] = grid.cells;
    let share = |index: usize, cells: usize| if index == 0 || index == cells { 0.5 } else { 1.0 };
    let cell = grid.size[0] / n1 as f64 * grid.size[1] / n2 as f64;
    grid.columns().map(|(i, j)| cell * share(i, n1) * share(j, n2)).collect()
}

/// A number with seven digits, as people read them.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}
