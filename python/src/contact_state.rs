//! The state of a contact scene as numpy arrays.

use crate::convert::shaped;
use contact::equilibrium::{ContactForces, ContactProblem, ContactStatus};
use contact::fields::Fields;
use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The contact nodes of a block: columns of nodes along x₁ and x₂, and the layers of nodes.
#[derive(Debug, Clone, Copy)]
pub struct NodeGrid {
    columns: [usize; 2],
    layers: usize,
}

/// The grid of the contact nodes where a height surface shapes a block; none for other bodies.
pub fn grid_of(problem: &ContactProblem) -> Option<NodeGrid> {
    problem.scene.heights()?;
    let [first, second, layers] = problem.scene.blocks()?.grid().nodes();
    Some(NodeGrid { columns: [first, second], layers })
}

/// The fields of a state and how arrays over the contact nodes are laid out.
pub struct StateArrays<'a> {
    /// Displacements, stresses, contact fields.
    pub fields: &'a Fields,
    /// The contact forces.
    pub forces: &'a ContactForces,
    /// The grid of the contact nodes of a block.
    pub grid: Option<NodeGrid>,
}

impl StateArrays<'_> {
    /// Adds all arrays to a dictionary.
    ///
    /// # Errors
    /// Those of numpy.
    pub fn set(&self, result: &Bound<'_, PyDict>) -> PyResult<()> {
        let (contact, body) = (&self.fields.contact, &self.fields.bodies[0]);
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
        self.set_contact(result, "pressures", f64::NAN, |index| [contact.pressure[index]])?;
        self.set_contact(result, "gaps", f64::NAN, |index| [-self.forces.opening[index]])?;
        self.set_contact(result, "status", -1, |index| [status(index)])?;
        self.set_contact(result, "areas", f64::NAN, |index| [contact.area[index]])?;
        self.set_contact(result, "normals", f64::NAN, |index| contact.normal[index])?;
        self.set_contact(result, "tractions", f64::NAN, traction)?;
        set_rows(result, "positions", &body.positions)?;
        set_rows(result, "displacements", &body.displacement)?;
        set_rows(result, "stresses", &body.stress)?;
        result.set_item("von_mises", shaped(result.py(), body.von_mises.clone(), &[body.von_mises.len()])?)
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
        let mut shape = self.grid.map_or_else(|| vec![nodes.len()], |grid| grid.columns.to_vec());
        let mut entries = vec![missing; C * shape.iter().product::<usize>()];
        for (index, &node) in nodes.iter().enumerate() {
            let place = self.grid.map_or(index, |grid| node as usize / grid.layers);
            entries[C * place..C * (place + 1)].copy_from_slice(&entry(index));
        }
        if C > 1 {
            shape.push(C);
        }
        result.set_item(name, shaped(result.py(), entries, &shape)?)
    }
}

/// Adds an array with a row per node or cell.
fn set_rows<const C: usize>(result: &Bound<'_, PyDict>, name: &str, rows: &[[f64; C]]) -> PyResult<()> {
    result.set_item(name, shaped(result.py(), rows.as_flattened().to_vec(), &[rows.len(), C])?)
}
