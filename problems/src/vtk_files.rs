//! Fields of solved shapes as VTK files: per state a grid of the bodies and one of the contact boundary; a list of all.
//!
//! | array | where | unit | meaning |
//! |---|---|---|---|
//! | `displacement` | points of bodies and contact | mm | displacement u; "warp by vector" shows the deformed shape |
//! | `von_mises_nodal` | points of bodies | MPa | mean of `von_mises` over the adjoining cells, weighted by volume |
//! | `body` | cells of bodies | – | number of the body in the scene: 1 lower, 2 upper |
//! | `subdomain` | cells of bodies | – | subdomain of the total FETI tearing, through all bodies; one per body if not torn |
//! | `stress` | cells of bodies | MPa | σ at the centre of the cell, components XX, YY, ZZ, XY, YZ, XZ |
//! | `von_mises` | cells of bodies | MPa | von Mises stress at the centre of the cell |
//! | `pressure` | points of contact | MPa | λ_N/A, compression positive |
//! | `normal` | points of contact | – | unit normal from the slave (lower) body outwards |
//! | `traction` | points of contact | MPa | λ_T/A, what the slave (lower) body exerts on the other side; only with friction |
//! | `slip` | points of contact | mm | tangential jump, slave (lower) less master (upper) body; only with friction |
//! | `status` | points of contact | – | 0 open, 1 stick, 2 slip (closed and free to slide, if there is no friction) |
//! | `area` | points of contact | mm² | tributary area A; Σ pressure·A is the normal force |
//! | `gap` | points of contact | mm | gap before loading |
//! | `remaining_gap` | points of contact | mm | gap under load |
//! | `sensitivity` | points of contact | unit of J per mm | n·∂J/∂x of the node; only if asked for |
//! | `contact` | cells of contact | – | number of the contact in the scene; only where there are several |

use contact::body::mesh::{CellKind, Mesh};
use contact::equilibrium::ContactStatus;
use contact::fields::{BodyFields, ContactFields, Fields};
use exchange::vtk::{Array, Cell, Entry, Note, UnstructuredGrid, Values, VtkError, collection, unstructured};
use thiserror::Error;

/// A solved shape in a series.
#[derive(Debug, Clone, Copy)]
pub struct FieldState<'a> {
    /// Place in the series, for example 0 for the start and 1 for the optimum.
    pub time: f64,
    /// Name, the beginning of its files' names: letters, digits, `-` and `_`.
    pub name: &'a str,
    /// The fields of the solved shape.
    pub fields: &'a Fields,
    /// What its files say of it as a whole.
    pub notes: &'a [Note],
}

/// The files of one state, and their lines in the list of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct StateFiles {
    /// Names of the files with their texts.
    pub files: Vec<(String, String)>,
    /// The lines of the list.
    pub entries: Vec<Entry>,
}

/// Why fields were not written.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FieldsError {
    /// The name of a state cannot be the beginning of a file name.
    #[error("name of state {index} = {name:?} is not allowed; allowed: {allowed}")]
    Name {
        /// Its place in the list.
        index: usize,
        /// The name that was given.
        name: String,
        /// The names that are allowed.
        allowed: &'static str,
    },
    /// The data do not make a file.
    #[error("fields of state `{state}`: {source}")]
    File {
        /// Name of the state.
        state: String,
        /// The error of the file format.
        source: VtkError,
    },
}

/// The list of all files of a series.
const LIST: &str = "fields.pvd";

/// Names and texts of the files of a series: for each state `NAME_bodies.vtu` and `NAME_contact.vtu`, then
/// `fields.pvd`, the file to open.
///
/// # Errors
/// [`FieldsError::Name`] for a name that is empty, has other characters or stands twice, [`FieldsError::File`] for
/// fields that are not finite.
pub fn vtk_files(states: &[FieldState<'_>]) -> Result<Vec<(String, String)>, FieldsError> {
    let mut files = Vec::with_capacity(2 * states.len() + 1);
    let mut entries = Vec::with_capacity(2 * states.len());
    for (index, state) in states.iter().enumerate() {
        if states[..index].iter().any(|other| other.name == state.name) {
            return Err(unusable(index, state.name));
        }
        let of_state = state_files(index, state)?;
        files.extend(of_state.files);
        entries.extend(of_state.entries);
    }
    files.push((LIST.to_owned(), list(&entries)?));
    Ok(files)
}

/// The text of a list of files.
///
/// # Errors
/// [`FieldsError::File`] for a time that is not finite.
pub fn list(entries: &[Entry]) -> Result<String, FieldsError> {
    collection(entries).map_err(|source| FieldsError::File { state: "all".to_owned(), source })
}

/// The files of the state with this place in its series, for series that are not held in memory as a whole.
///
/// # Errors
/// As [`vtk_files`].
pub fn state_files(index: usize, state: &FieldState<'_>) -> Result<StateFiles, FieldsError> {
    let FieldState { time, name, fields, notes } = *state;
    let usable = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.is_empty() || !name.chars().all(usable) {
        return Err(unusable(index, name));
    }
    let (mut files, mut entries) = (Vec::new(), Vec::new());
    let parts = [("bodies", bodies(&fields.bodies)), ("contact", contact(&fields.contact, &fields.bodies))];
    for (part, (kind, grid)) in parts.into_iter().enumerate() {
        let (grid, file) = (UnstructuredGrid { notes: notes.to_vec(), ..grid }, format!("{name}_{kind}.vtu"));
        let text = unstructured(&grid).map_err(|source| FieldsError::File { state: name.to_owned(), source })?;
        files.push((file.clone(), text));
        entries.push(Entry { time, part, name: kind.to_owned(), file });
    }
    Ok(StateFiles { files, entries })
}

fn unusable(index: usize, name: &str) -> FieldsError {
    let allowed = "letters, digits, - and _, another name for every state";
    FieldsError::Name { index, name: name.to_owned(), allowed }
}

/// Nodes of a tetrahedron of second order that VTK takes one after the other: Gmsh has its last two edges the other
/// way.
const TETRAHEDRON: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

/// The cells of a mesh whose first node has this place among the points.
pub(crate) fn vtk_cells(mesh: &Mesh, first: usize) -> impl Iterator<Item = Cell> {
    mesh.cells().map(move |cell| {
        let node = |local: usize| first + cell.nodes[local] as usize;
        match cell.kind {
            CellKind::Hex8 => Cell::Hexahedron(std::array::from_fn(node)),
            CellKind::Tet10 => Cell::QuadraticTetrahedron(TETRAHEDRON.map(node)),
        }
    })
}

/// All bodies as one grid; bodies share no points.
fn bodies(bodies: &[BodyFields]) -> UnstructuredGrid {
    let (mut points, mut cells, mut body_numbers) = (Vec::new(), Vec::new(), Vec::new());
    for (number, body) in (1..).zip(bodies) {
        let first = points.len();
        points.extend(body.positions.iter().copied());
        cells.extend(vtk_cells(&body.mesh, first));
        body_numbers.extend(std::iter::repeat_n(number, body.mesh.cell_count()));
    }
    let subdomains = bodies.iter().flat_map(|body| &body.subdomain).map(|&subdomain| subdomain as i32).collect();
    UnstructuredGrid {
        description: "Bodies, undeformed. Lengths in mm, stresses in MPa.\n\
            body: 1 lower, 2 upper. stress: at the centre of the cell, order XX YY ZZ XY YZ XZ."
            .to_owned(),
        notes: Vec::new(),
        points,
        cells,
        point_data: vec![
            Array::new("displacement", "mm", Values::Vectors(joined(bodies, |body| &body.displacement))),
            Array::new("von_mises_nodal", "MPa", Values::Scalars(joined(bodies, |body| &body.nodal_von_mises))),
        ],
        cell_data: vec![
            Array::new("body", "", Values::Integers(body_numbers)),
            Array::new("subdomain", "", Values::Integers(subdomains)),
            Array::new("stress", "MPa", Values::Tensors(joined(bodies, |body| &body.stress))),
            Array::new("von_mises", "MPa", Values::Scalars(joined(bodies, |body| &body.von_mises))),
        ],
    }
}

/// One field of all bodies, one after the other.
fn joined<T: Copy>(bodies: &[BodyFields], field: impl Fn(&BodyFields) -> &Vec<T>) -> Vec<T> {
    bodies.iter().flat_map(|body| field(body).iter().copied()).collect()
}

/// The contact boundary as triangles and quadrilaterals whose normals point outwards. Where supports hold a node along
/// its normal, there is no contact node: it is open, without force, and has no gap.
fn contact(contact: &ContactFields, bodies: &[BodyFields]) -> UnstructuredGrid {
    let facets = &contact.facets;
    let numbers = |values: &[f64]| Values::Scalars(spread(contact, values, 0.0));
    let vectors = |values: &[[f64; 3]]| Values::Vectors(spread(contact, values, [0.0; 3]));
    let at_nodes = |values: fn(&BodyFields) -> &[[f64; 3]]| -> Vec<[f64; 3]> {
        facets.bodies.iter().zip(&facets.nodes).map(|(&body, &node)| values(&bodies[body])[node as usize]).collect()
    };
    let status: Vec<i32> = contact.status.iter().map(|&status| status_code(status)).collect();
    let mut point_data = vec![
        Array::new("displacement", "mm", Values::Vectors(at_nodes(|body| &body.displacement))),
        Array::new("normal", "", vectors(&contact.normal)),
        Array::new("pressure", "MPa", numbers(&contact.pressure)),
        Array::new("status", "", Values::Integers(spread(contact, &status, 0))),
        Array::new("area", "mm^2", numbers(&contact.area)),
        Array::new("gap", "mm", numbers(&contact.gap)),
        Array::new("remaining_gap", "mm", numbers(&contact.remaining_gap)),
    ];
    for (name, unit, values) in [("traction", "MPa", &contact.traction), ("slip", "mm", &contact.slip)] {
        point_data.extend(values.as_deref().map(|values| Array::new(name, unit, vectors(values))));
    }
    // Its unit is that of the objective per mm, which the fields do not know.
    let sensitivity = contact.sensitivity.as_deref();
    point_data.extend(sensitivity.map(|values| Array::new("sensitivity", "", numbers(values))));
    let facet = |nodes: &Vec<usize>| match nodes[..] {
        [a, b, c] => Some(Cell::Triangle([a, b, c])),
        [a, b, c, d] => Some(Cell::Quad([a, b, c, d])),
        _ => None,
    };
    UnstructuredGrid {
        description: "Contact faces, undeformed. Lengths in mm, areas in mm^2, stresses in MPa.\n\
            status: 0 open, 1 stick, 2 slip. pressure times area: normal force of the node, N.\n\
            sensitivity: derivative of the objective by the position of the node along its normal."
            .to_owned(),
        notes: Vec::new(),
        points: at_nodes(|body| &body.positions),
        cells: facets.facets.iter().filter_map(facet).collect(),
        point_data,
        cell_data: contact_numbers(contact),
    }
}

/// The number of the contact of every facet, from 1 on in the order of the scene, where there are several; 0 where none
/// of its corners is a contact node.
fn contact_numbers(contact: &ContactFields) -> Vec<Array> {
    if contact.contacts.windows(2).all(|pair| pair[0] == pair[1]) {
        return Vec::new();
    }
    let of_facet = |corners: &Vec<usize>| {
        let point = corners.iter().find_map(|&corner| contact.facets.points[corner]);
        point.map_or(0, |point| contact.contacts[point] as i32 + 1)
    };
    vec![Array::new("contact", "", Values::Integers(contact.facets.facets.iter().map(of_facet).collect()))]
}

/// Values at the corners of the facets from those at the contact nodes, `rest` at the others.
fn spread<T: Copy>(contact: &ContactFields, values: &[T], rest: T) -> Vec<T> {
    contact.facets.points.iter().map(|point| point.map_or(rest, |point| values[point])).collect()
}

/// 0 open, 1 stick, 2 slip.
fn status_code(status: ContactStatus) -> i32 {
    match status {
        ContactStatus::Open => 0,
        ContactStatus::Stick => 1,
        ContactStatus::Slip => 2,
    }
}
