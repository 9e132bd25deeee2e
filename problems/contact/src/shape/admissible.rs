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
use crate::shape::{LatticeShape, ShapeMap, SplineSurface};
use nonsmooth::{Matrix, Polyhedron, Vector};

/// Relative violation that still counts as admissible: rounding in user files and in the optimizer's steps.
const ADMISSIBLE: f64 = 1e-9;

/// The last rows of a height surface are the volumes under the surface and of the bricks.
const VOLUME_ROWS: usize = 2;
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

/// The constants of U.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ShapeBounds {
    /// C₀, smallest control height, mm.
    pub minimum_height: f64,
    /// C₁, bound of the slope between neighbouring controls.
    pub slope: f64,
    /// Least and largest volume [C₂₁, C₂₂], mm³.
    pub volume: [f64; 2],
}

impl AdmissibleSet {
    /// U for a surface over `grid`, below the obstacle, which has the heights `ceiling` over the controls.
    ///
    /// # Errors
    /// [`SceneError::Set`] when bounds contradict each other.
    pub fn new(
        surface: &SplineSurface,
        grid: &Grid,
        bounds: &ShapeBounds,
        ceiling: Vec<f64>,
    ) -> Result<Self, SceneError> {
        let counts = surface.counts();
        let dimension = surface.control_count();
        let intervals = counts.map(|count| (count - 1) as f64);
        let upper = Vector::from_vec(ceiling);
        let mut rows = Vec::new();
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                let here = i * counts[1] + j;
                for (axis, exists, next) in [(0, i + 1 < counts[0], here + counts[1]), (1, j + 1 < counts[1], here + 1)]
                {
                    if exists {
                        let bound = bounds.slope * grid.size[axis] / intervals[axis];
                        let name = format!("α[{next}] − α[{here}] (admissible.slope along x{})", axis + 1);
                        rows.push((name, vec![(next, 1.0), (here, -1.0)], [-bound, bound]));
                    }
                }
            }
        }
        let area = grid.size[0] * grid.size[1];
        let measure = surface.integrals().iter().map(|value| value * area).collect::<Vec<_>>();
        rows.push((
            "volume under the surface (admissible.volume)".into(),
            measure.into_iter().enumerate().collect(),
            bounds.volume,
        ));
        let bricks = surface.height_map(grid).pull_back(&column_areas(grid));
        rows.push((
            "volume of the bricks (admissible.volume)".into(),
            bricks.into_iter().enumerate().collect(),
            bounds.volume,
        ));
        let control_names = (0..dimension).map(|i| format!("height of control {i}, α[{i}]")).collect();
        let lower = Vector::from_element(dimension, bounds.minimum_height);
        Self::of_rows([lower, upper], control_names, rows, VOLUME_ROWS)
    }

    /// The box of a lattice with bounds of node displacements.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names that the mesh does not have and for too many nodes; [`SceneError::Set`]
    /// when bounds contradict each other.
    pub(crate) fn of_lattice(lattice: &LatticeShape, map: &ShapeMap, mesh: &Mesh) -> Result<Self, SceneError> {
        let mut rows: Vec<NamedRow> = Vec::new();
        for (index, bound) in lattice.node_bounds.iter().enumerate() {
            let field = format!("lattice.bounds[{index}]");
            let axis = bound.component;
            let mut nodes = nodes_of(&format!("{field}.place"), &bound.place, mesh)?;
            nodes.sort_unstable();
            nodes.dedup();
            for node in nodes {
                let row: Vec<(usize, f64)> = map.row(node, axis).collect();
                if !row.is_empty() {
                    let name = format!("displacement of node {node} along x{} ({field})", axis + 1);
                    rows.push((name, row, bound.range));
                }
            }
        }
        let allowed = format!("at most {MOST_ROWS} nodes");
        SceneError::require(rows.len() <= MOST_ROWS, "lattice.bounds", format!("{} nodes", rows.len()), allowed)?;
        let [least, largest] = lattice.displacement.map(|value| Vector::from_element(map.control_count(), value));
        Self::of_rows([least, largest], lattice.control_names(), rows, 0)
    }

    fn of_rows(
        [lower, upper]: [Vector; 2],
        control_names: Vec<String>,
        rows: Vec<NamedRow>,
        volume_rows: usize,
    ) -> Result<Self, SceneError> {
        let dimension = lower.len();
        let polyhedron = Polyhedron::boxed(lower, upper)?;
        let row_names = rows.iter().map(|(name, ..)| name.clone()).collect();
        if rows.is_empty() {
            return Ok(Self { polyhedron, control_names, row_names, volume_rows });
        }
        let mut matrix = Matrix::zeros(rows.len(), dimension);
        for (row, (_, entries, _)) in rows.iter().enumerate() {
            for &(column, value) in entries {
                matrix[(row, column)] += value;
            }
        }
        let side = |which: usize| Vector::from_iterator(rows.len(), rows.iter().map(|(_, _, sides)| sides[which]));
        let polyhedron = polyhedron.with_rows(&matrix, &side(0), &side(1))?;
        Ok(Self { polyhedron, control_names, row_names, volume_rows })
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
        let attained = |value: f64, side: f64| (value - side).abs() <= ADMISSIBLE * side.abs().max(f64::MIN_POSITIVE);
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
            (lower - value).max(value - upper) / lower.abs().max(upper.abs()).max(f64::MIN_POSITIVE)
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
