//! A part of the bodies: the cells whose centres lie in a box, or those of a named volume.

use crate::body::Body;
use crate::equilibrium::ContactProblem;
use crate::error::SceneError;
use crate::names::find;

/// A part of one body or of all.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Smallest x₁, x₂, x₃, mm.
    pub lower: [f64; 3],
    /// Largest x₁, x₂, x₃, mm; the faces of the box belong to it.
    pub upper: [f64; 3],
    /// 0 for the lower body alone, 1 for the upper one alone, none for all bodies.
    pub body: Option<usize>,
    /// The name of a volume of the mesh; none for all volumes.
    pub volume: Option<String>,
}

/// The cells of a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionCells {
    /// Cells of every body, lower first.
    pub cells: Vec<Vec<usize>>,
    /// Volume of these cells at the start, mm³.
    pub volume: f64,
}

/// Distance over the size of the bodies at which a centre still counts as inside a box: rounding of its coordinates.
const ROUNDING: f64 = 1e-12;

impl Region {
    /// All of all bodies.
    pub const WHOLE: Self = Self { lower: [f64::NEG_INFINITY; 3], upper: [f64::INFINITY; 3], body: None, volume: None };

    /// The cells of the named volume whose centres lie in the box at the start of the scene: no cell enters or leaves
    /// the region as the shape changes.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] if there is none, for a body that the scene does not have, and for a volume that no
    /// mesh has.
    pub fn cells(&self, problem: &ContactProblem) -> Result<RegionCells, SceneError> {
        let positions = problem.start_positions();
        if let Some(body) = self.body.filter(|body| *body >= problem.bodies.len()) {
            let value = if body == 1 { "upper" } else { "unknown" };
            let allowed = "a body of the scene, which has no upper one";
            return Err(SceneError::out_of_range("objective.body", value, allowed));
        }
        if let Some(volume) = &self.volume {
            let names = problem.bodies.iter().flat_map(|body| body.mesh.volumes());
            find("objective.volume", volume, names.map(String::as_str))?;
        }
        let coordinates = || positions.iter().flat_map(|nodes| nodes.as_flattened());
        let slack = ROUNDING * coordinates().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut found = RegionCells { cells: vec![Vec::new(); positions.len()], volume: 0.0 };
        for (number, (body, positions)) in problem.bodies.iter().zip(&positions).enumerate() {
            for cell in (0..body.mesh.cell_count()).filter(|&cell| self.may_hold(number, body, cell)) {
                let centre = body.mesh.centre(cell, positions);
                let inside =
                    |axis: usize| centre[axis] >= self.lower[axis] - slack && centre[axis] <= self.upper[axis] + slack;
                if (0..3).all(inside) {
                    found.cells[number].push(cell);
                    found.volume += body.mesh.cell_nodes(cell, positions).volume();
                }
                for axis in 0..3 {
                    least[axis] = least[axis].min(centre[axis]);
                    most[axis] = most[axis].max(centre[axis]);
                }
            }
        }
        if found.cells.iter().all(Vec::is_empty) {
            let value = format!("{:?} to {:?}", self.lower, self.upper);
            let allowed = format!("a box that holds the centre of a cell; they lie between {least:?} and {most:?} mm");
            return Err(SceneError::out_of_range("objective.region", value, allowed));
        }
        Ok(found)
    }

    /// Whether a cell belongs to the body and the volume of the region.
    fn may_hold(&self, number: usize, body: &Body, cell: usize) -> bool {
        let name = &body.mesh.volumes()[body.mesh.volume_of(cell)];
        self.body.is_none_or(|own| own == number) && self.volume.as_ref().is_none_or(|volume| volume == name)
    }
}
