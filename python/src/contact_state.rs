//! The state of a contact scene as numpy arrays.

use crate::convert::shaped;
use contact::equilibrium::{ContactForces, ContactProblem, ContactStatus};
use contact::fields::{BodyFields, Fields};
use contact::plausibility::Warning;
use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The contact nodes of a block: columns of nodes along x₁ and x₂, and the layers of nodes.
#[derive(Debug, Clone, Copy)]
struct NodeGrid {
    columns: [usize; 2],
    layers: usize,
}

/// The grid of the contact nodes where the only contact is that of a face of a block whose heights are controls; none
/// for other scenes.
fn grid_of(problem: &ContactProblem) -> Option<NodeGrid> {
    let [contact] = &problem.scene.contacts[..] else { return None };
    let body = &problem.scene.bodies[contact.slave.body];
    let is_shaped = body.heights()?.face()?.block_face().name() == contact.slave.face;
    let [first, second, layers] = body.block().filter(|_| is_shaped)?.grid().nodes();
    Some(NodeGrid { columns: [first, second], layers })
}

/// The fields of a state and how arrays over the contact nodes are laid out.
pub struct StateArrays<'a> {
    /// The problem whose state it is.
    pub problem: &'a ContactProblem,
    /// Displacements, stresses, contact fields.
    pub fields: &'a Fields,
    /// The contact forces.
    pub forces: &'a ContactForces,
}

impl StateArrays<'_> {
    /// Adds all arrays to a dictionary.
    ///
    /// # Errors
    /// Those of numpy.
    pub fn set(&self, result: &Bound<'_, PyDict>) -> PyResult<()> {
        let contact = &self.fields.contact;
        let status = |index: usize| match contact.status[index] {
            ContactStatus::Open => 0_i8,
            ContactStatus::Stick => 1,
            ContactStatus::Slip => 2,
        };
        let traction = |index: usize| -> [f64; 3] {
            let tangential = contact.traction.as_ref().map_or([0.0; 3], |traction| traction[index]);
            std::array::from_fn(|axis| contact.pressure[index] * contact.normal[index][axis] + tangential[axis])
        };
        self.set_contact(result, "contact_nodes", -1, |index| [i64::from(contact.nodes[index])])?;
        self.set_contact(result, "contact_bodies", -1, |index| [contact.bodies[index] as i64])?;
        self.set_contact(result, "contacts", -1, |index| [contact.contacts[index] as i64])?;
        self.set_contact(result, "pressures", f64::NAN, |index| [contact.pressure[index]])?;
        self.set_contact(result, "gaps", f64::NAN, |index| [-self.forces.opening[index]])?;
        self.set_contact(result, "status", -1, |index| [status(index)])?;
        self.set_contact(result, "areas", f64::NAN, |index| [contact.area[index]])?;
        self.set_contact(result, "normals", f64::NAN, |index| contact.normal[index])?;
        self.set_contact(result, "tractions", f64::NAN, traction)?;
        let bodies = PyDict::new(result.py());
        for (body, fields) in self.problem.bodies.iter().zip(&self.fields.bodies) {
            let own = PyDict::new(result.py());
            set_body(&own, fields)?;
            bodies.set_item(&body.name, own)?;
        }
        result.set_item("bodies", bodies)?;
        let optimized = self.problem.map.shaped_bodies().next().unwrap_or(0);
        set_body(result, &self.fields.bodies[optimized])
    }

    /// Adds an array over the contact nodes with `C` components; `missing` stands where a block has no contact node.
    fn set_contact<T: Element + Copy, const C: usize>(
        &self,
        result: &Bound<'_, PyDict>,
        name: &str,
        missing: T,
        entry: impl Fn(usize) -> [T; C],
    ) -> PyResult<()> {
        let nodes = &self.fields.contact.nodes;
        let grid = grid_of(self.problem);
        let mut shape = grid.map_or_else(|| vec![nodes.len()], |grid| grid.columns.to_vec());
        let mut entries = vec![missing; C * shape.iter().product::<usize>()];
        for (index, &node) in nodes.iter().enumerate() {
            let place = grid.map_or(index, |grid| node as usize / grid.layers);
            entries[C * place..C * (place + 1)].copy_from_slice(&entry(index));
        }
        if C > 1 {
            shape.push(C);
        }
        result.set_item(name, shaped(result.py(), entries, &shape)?)
    }
}

/// Adds the arrays of a body.
fn set_body(result: &Bound<'_, PyDict>, body: &BodyFields) -> PyResult<()> {
    set_rows(result, "positions", &body.positions)?;
    set_rows(result, "displacements", &body.displacement)?;
    set_rows(result, "stresses", &body.stress)?;
    result.set_item("von_mises", shaped(result.py(), body.von_mises.clone(), &[body.von_mises.len()])?)
}

/// Adds an array with a row per node or cell.
fn set_rows<const C: usize>(result: &Bound<'_, PyDict>, name: &str, rows: &[[f64; C]]) -> PyResult<()> {
    result.set_item(name, shaped(result.py(), rows.as_flattened().to_vec(), &[rows.len(), C])?)
}

/// Every warning as its code and its sentence.
pub fn in_words(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(ToString::to_string).collect()
}
