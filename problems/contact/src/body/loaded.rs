//! Loads with the faces and cells of a mesh that they act on.

use crate::body::mesh::{CellFace, Mesh};
use crate::error::SceneError;
use crate::formula::Formula;
use crate::names::{find_face, find_volume};
use crate::scene::{Load, LoadKind};

/// A load with the faces or cells that it acts on.
#[derive(Debug)]
pub enum Loaded {
    /// A traction on faces.
    Faces(Vec<CellFace>, Traction),
    /// A force per volume in cells.
    Cells(Vec<u32>, [f64; 3]),
}

/// A traction over a face.
#[derive(Debug)]
pub enum Traction {
    /// Along the axes, MPa.
    Constant([f64; 3]),
    /// Against the outward normal, MPa.
    Pressure(f64),
    /// Along the axes over the position, MPa.
    Formula(Box<[Formula; 3]>),
    /// With a force, and a moment about a point.
    Resultant { force: [f64; 3], moment: [f64; 3], point: Option<[f64; 3]> },
}

impl Loaded {
    /// A load on a mesh; `field` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for an unknown face or volume, for numbers that are not finite and for formulas that
    /// cannot be understood.
    pub fn new(field: &str, load: &Load, mesh: &Mesh) -> Result<Self, SceneError> {
        let finite = |what: &str, values: &[f64]| {
            let bad = values.iter().find(|value| !value.is_finite()).copied();
            SceneError::require(bad.is_none(), format!("{field}: {what}"), bad.unwrap_or(0.0), "finite numbers")
        };
        let traction = match &load.kind {
            LoadKind::BodyForce(force) => {
                finite("body_force", force)?;
                let volume = load.place.as_ref().map(|name| find_volume(&format!("{field}.volume"), name, mesh));
                let volume = volume.transpose()?;
                let inside = |cell: &usize| volume.is_none_or(|volume| volume == mesh.volume_of(*cell));
                let cells = (0..mesh.cell_count()).filter(inside).map(|cell| cell as u32);
                return Ok(Self::Cells(cells.collect(), *force));
            }
            LoadKind::Traction(traction) => {
                finite("traction", traction)?;
                Traction::Constant(*traction)
            }
            LoadKind::Pressure(pressure) => {
                finite("pressure", &[*pressure])?;
                Traction::Pressure(*pressure)
            }
            LoadKind::Resultant { force, moment, point } => {
                finite("force", force)?;
                finite("moment", moment)?;
                finite("point", &point.unwrap_or_default())?;
                Traction::Resultant { force: *force, moment: *moment, point: *point }
            }
            LoadKind::Formula(texts) => {
                let parse = |axis: usize| Formula::parse(&format!("{field}.formula[{axis}]"), &texts[axis]);
                Traction::Formula(Box::new([parse(0)?, parse(1)?, parse(2)?]))
            }
        };
        let name = load.place.as_deref().unwrap_or("");
        let faces = find_face(&format!("{field}.face"), name, mesh)?.to_vec();
        let loaded = Self::Faces(faces, traction);
        loaded.check(field, mesh)?;
        Ok(loaded)
    }

    /// Refuses formulas without value on the face at the reference shape.
    fn check(&self, field: &str, mesh: &Mesh) -> Result<(), SceneError> {
        let Self::Faces(faces, Traction::Formula(formulas)) = self else { return Ok(()) };
        for &face in faces {
            for node in mesh.face_nodes(face) {
                let place @ [x1, x2, x3] = mesh.nodes()[node as usize];
                let values = formulas.each_ref().map(|formula| formula.value(place));
                if values.iter().any(|value: &f64| !value.is_finite()) {
                    let value = format!("{values:?} at x1 = {x1}, x2 = {x2}, x3 = {x3} mm");
                    return Err(SceneError::out_of_range(format!("{field}.formula"), value, "finite over the face"));
                }
            }
        }
        Ok(())
    }
}
