//! A part of the bodies: the cells whose centres lie in a box, those of a named volume, or the nodes of a named face.

use crate::body::Body;
use crate::body::elasticity::CellNodes;
use crate::body::mesh::{Mesh, bounding_box};
use crate::equilibrium::{ContactProblem, SolvedBody};
use crate::error::SceneError;
use crate::linear::parallel;
use crate::names::{Kind, check_among, find};

/// A part of one body or of all.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Smallest x₁, x₂, x₃, mm.
    pub lower: [f64; 3],
    /// Largest x₁, x₂, x₃, mm; the faces of the box belong to it.
    pub upper: [f64; 3],
    /// Name of the only body; none for all bodies.
    pub body: Option<String>,
    /// The name of a volume of the mesh; none for all volumes.
    pub volume: Option<String>,
    /// The name of a face of the mesh, whose nodes alone belong to the region; none for whole cells. Stresses belong to
    /// cells: their regions have no face.
    pub face: Option<String>,
}

/// The cells of a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionCells {
    /// Cells of every body.
    pub cells: Vec<Vec<usize>>,
    /// Volume of these cells at the start, mm³.
    pub volume: f64,
}

/// Distance over the size of the bodies at which a centre still counts as inside a box: rounding of its coordinates.
const ROUNDING: f64 = 1e-12;

impl RegionCells {
    /// What `compute` makes of every cell, per body, for solved bodies with what does not depend on the shape: given
    /// its nodes, shear modulus and displacements.
    pub(super) fn map<T: Send>(
        &self,
        bodies: &[Body],
        solved: &[SolvedBody],
        compute: impl Fn(&CellNodes<f64>, f64, &[f64]) -> T + Sync,
    ) -> Vec<Vec<T>> {
        let parts = self.cells.iter().zip(solved).zip(bodies);
        let of_body = |((cells, solved), body): ((&Vec<usize>, &SolvedBody), &Body)| {
            let of_cell = |place: usize| {
                let cell = cells[place];
                let u = body.mesh.cell_values(cell, &solved.displacement);
                compute(&body.mesh.cell_nodes(cell, &solved.positions), body.solid.material(cell).shear_modulus(), &u)
            };
            parallel::map(cells.len(), &of_cell)
        };
        parts.map(of_body).collect()
    }
}

impl Region {
    /// All of all bodies.
    pub const WHOLE: Self =
        Self { lower: [f64::NEG_INFINITY; 3], upper: [f64::INFINITY; 3], body: None, volume: None, face: None };

    /// The cells of the named volume whose centres lie in the box at the start of the scene: no cell enters or leaves
    /// the region as the shape changes. `place`: what messages call the table that has the region.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] if there is none, for a region with a face, for a body that the scene does not have,
    /// and for a volume that no mesh has.
    pub fn cells(&self, place: &str, problem: &ContactProblem) -> Result<RegionCells, SceneError> {
        if let Some(face) = &self.face {
            let allowed = "no face where stresses are measured, which belong to whole cells";
            return Err(SceneError::out_of_range(format!("{place}.region.face"), format!("\"{face}\""), allowed));
        }
        self.check(&format!("{place}.region"), problem)?;
        let positions = problem.start_positions();
        let slack = slack(&positions);
        let mut found = RegionCells { cells: vec![Vec::new(); positions.len()], volume: 0.0 };
        let mut centres = Vec::new();
        for (number, (body, positions)) in problem.bodies.iter().zip(&positions).enumerate() {
            for cell in (0..body.mesh.cell_count()).filter(|&cell| self.may_hold(body, cell)) {
                let centre = body.mesh.centre(cell, positions);
                centres.push(centre);
                if self.surrounds(centre, slack) {
                    found.cells[number].push(cell);
                    found.volume += body.mesh.cell_nodes(cell, positions).volume();
                }
            }
        }
        match found.cells.iter().all(Vec::is_empty) {
            true => Err(self.without(place, "centre of a cell", &centres)),
            false => Ok(found),
        }
    }

    /// The nodes of every body, each ascending: those of the [cells](Self::cells), or with a face those of
    /// its nodes that lie in the box at the start and belong to a cell of the volume.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] if there is none, for a body that the scene does not have, and for a volume or a face
    /// that no mesh has.
    pub fn nodes(&self, place: &str, problem: &ContactProblem) -> Result<Vec<Vec<u32>>, SceneError> {
        let mut nodes: Vec<Vec<u32>> = match &self.face {
            Some(face) => self.face_nodes(place, face, problem)?,
            None => {
                let cells = self.cells(place, problem)?.cells;
                let nodes_of = |(cells, body): (&Vec<usize>, &Body)| {
                    cells.iter().flat_map(|&cell| body.mesh.cell(cell).nodes).copied().collect()
                };
                cells.iter().zip(&*problem.bodies).map(nodes_of).collect()
            }
        };
        for nodes in &mut nodes {
            nodes.sort_unstable();
            nodes.dedup();
        }
        Ok(nodes)
    }

    /// The nodes of every facet of a face, by body; `place`: what messages call the region.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a body that the scene does not have, and for a volume or a face that no mesh has.
    pub(super) fn face_of(
        &self,
        place: &str,
        face: &str,
        problem: &ContactProblem,
    ) -> Result<Vec<Vec<Vec<u32>>>, SceneError> {
        self.check(place, problem)?;
        let meshes = problem.bodies.iter().filter(|body| self.is_of(body)).map(|body| &*body.mesh);
        check_among(&format!("{place}.face"), face, &meshes.collect::<Vec<_>>(), &[Kind::Faces])?;
        let of_body = |body: &Body| {
            let faces = body.mesh.faces().get(face).into_iter().flatten().filter(|_| self.is_of(body));
            let own = faces.filter(|face| self.may_hold(body, face.cell as usize));
            own.map(|face| body.mesh.face_nodes(*face).collect()).collect()
        };
        Ok(problem.bodies.iter().map(of_body).collect())
    }

    fn face_nodes(&self, place: &str, face: &str, problem: &ContactProblem) -> Result<Vec<Vec<u32>>, SceneError> {
        let facets = self.face_of(&format!("{place}.region"), face, problem)?;
        let positions = problem.start_positions();
        let slack = slack(&positions);
        let mut found = vec![Vec::new(); positions.len()];
        let mut places = Vec::new();
        for (number, node) in facets
            .iter()
            .enumerate()
            .flat_map(|(number, facets)| facets.iter().flatten().map(move |&node| (number, node)))
        {
            let x = positions[number][node as usize];
            places.push(x);
            if self.surrounds(x, slack) {
                found[number].push(node);
            }
        }
        match found.iter().all(Vec::is_empty) {
            true => Err(self.without(place, "node of the face", &places)),
            false => Ok(found),
        }
    }

    /// Checks body and volume; `place`: what messages call the region.
    fn check(&self, place: &str, problem: &ContactProblem) -> Result<(), SceneError> {
        if let Some(body) = &self.body {
            find(&format!("{place}.body"), body, problem.bodies.iter().map(|body| body.name.as_str()))?;
        }
        if let Some(volume) = &self.volume {
            let bodies = problem.bodies.iter().filter(|body| self.is_of(body));
            let meshes: Vec<&Mesh> = bodies.map(|body| &*body.mesh).collect();
            check_among(&format!("{place}.volume"), volume, &meshes, &[Kind::Volumes])?;
        }
        Ok(())
    }

    /// Whether a body belongs to the region.
    fn is_of(&self, body: &Body) -> bool {
        self.body.as_ref().is_none_or(|own| *own == body.name)
    }

    /// Whether a cell belongs to the body and the volume of the region.
    fn may_hold(&self, body: &Body, cell: usize) -> bool {
        let name = &body.mesh.volumes()[body.mesh.volume_of(cell)];
        self.is_of(body) && self.volume.as_ref().is_none_or(|volume| volume == name)
    }

    /// Whether a point lies in the box.
    fn surrounds(&self, x: [f64; 3], slack: f64) -> bool {
        (0..3).all(|axis| x[axis] >= self.lower[axis] - slack && x[axis] <= self.upper[axis] + slack)
    }

    /// The refusal of a box without any of some places.
    fn without(&self, place: &str, what: &str, places: &[[f64; 3]]) -> SceneError {
        let bounded = (0..3).filter(|&axis| self.lower[axis] > f64::NEG_INFINITY || self.upper[axis] < f64::INFINITY);
        let bounds = bounded.map(|axis| format!("x{} = {:?} … {:?}", axis + 1, self.lower[axis], self.upper[axis]));
        let bounds: Vec<String> = bounds.collect();
        let value = if bounds.is_empty() { "no bounds".to_owned() } else { bounds.join(", ") };
        let [least, most] = bounding_box(places);
        let allowed = format!("a box that holds the {what}; they lie between {least:?} and {most:?} mm");
        SceneError::out_of_range(format!("{place}.region"), value, allowed)
    }
}

/// By how much a point may lie outside of a box that still holds it, mm.
fn slack(positions: &[impl AsRef<Vec<[f64; 3]>>]) -> f64 {
    let coordinates = positions.iter().flat_map(|nodes| nodes.as_ref().as_flattened());
    ROUNDING * coordinates.fold(0.0, |largest: f64, x| largest.max(x.abs()))
}
