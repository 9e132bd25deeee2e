//! Quantities of contact states on the mesh of a problem, with their derivatives; method.md (3.7), (3.8), (5.5) to
//! (5.7).
//!
//! ```text
//! J(x, λ, u):     ∂J/∂λ and ∂J/∂u are the dual of the adjoint problem,     ∂J/∂x at fixed λ and u is explicit
//! ```

use crate::body::Body;
use crate::body::elasticity::facet::{integrate, length};
use crate::body::loads::{load_sensitivities, nodal_forces};
use crate::cost::contact_work::{ContactNodes, Resultant};
use crate::cost::extreme::{Extreme, MeanNodes, Points};
use crate::cost::piece::{StateGradient, StatePiece};
use crate::cost::reaction::Reaction;
use crate::cost::region::{Region, RegionCells};
use crate::cost::row_terms::RowTerms;
use crate::cost::state_view::StateView;
use crate::cost::stress_norm::StressNorm;
use crate::cost::{PressureCost, PressureMeasure, Quantity};
use crate::equilibrium::ContactProblem;
use crate::error::SceneError;
use crate::mortar::vector::dot;
use crate::names::find;
use nonsmooth::Vector;
use nonsmooth::composite::OuterFunction;

/// J as a function of contact states on one mesh.
#[derive(Debug, Clone)]
pub struct StateCost {
    quantity: Quantity,
    function: Function,
}

/// A quantity on the mesh of a problem.
#[derive(Debug, Clone)]
enum Function {
    Pressures(PressureCost),
    LoadedArea(PressureCost),
    MeanPressure(ContactNodes),
    ClosedArea(ContactNodes),
    Resultant(Resultant),
    FrictionWork(ContactNodes),
    Reaction(Reaction),
    StressNorm(StressNorm),
    Compliance,
    Extreme(Extreme),
}

impl StateCost {
    /// A quantity on the bodies of a problem; none for one [of the shape](Quantity::is_of_shape). `place`: what
    /// messages call the table that has the quantity.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] as [`PressureCost::new`]; unless the exponent of a stress norm is finite and > 1; for
    /// an axis beyond 2, for the smallest length of displacements, for a region of held cells alone that leaves them
    /// out, for a contact that the scene does not have, for one of several contacts that is not named, for a face
    /// without supports; and as [`Region::cells`] and [`Region::nodes`].
    pub fn new(place: &str, quantity: &Quantity, problem: &ContactProblem) -> Result<Option<Self>, SceneError> {
        if quantity.is_of_shape() {
            return Ok(None);
        }
        check_numbers(place, quantity)?;
        let nodes = |contact: Option<usize>| opening_nodes(place, contact, problem);
        let function = match quantity {
            Quantity::Pressure(measure) => Function::Pressures(PressureCost::named(place, measure.clone(), problem)?),
            &Quantity::LoadedArea { pressure } => {
                let open = PressureMeasure::OpenArea { pressure };
                Function::LoadedArea(PressureCost::named(place, open, problem)?)
            }
            Quantity::MeanPressure { contact } => Function::MeanPressure(nodes(*contact)?),
            Quantity::ClosedArea { contact } => Function::ClosedArea(nodes(*contact)?),
            Quantity::ContactForce { contact, axis } => {
                let nodes = nodes_of_one(place, *contact, problem)?;
                Function::Resultant(Resultant { nodes, axis: *axis, about: None })
            }
            Quantity::ContactMoment { contact, axis, about } => {
                let nodes = nodes_of_one(place, *contact, problem)?;
                Function::Resultant(Resultant { nodes, axis: *axis, about: Some(*about) })
            }
            Quantity::FrictionWork { contact } => Function::FrictionWork(nodes(*contact)?),
            Quantity::Slip { contact } => {
                Function::Extreme(Extreme { points: Points::Slips(nodes(*contact)?), least: false })
            }
            Quantity::Reaction { region, axis } => Function::Reaction(reaction(place, region, *axis, problem)?),
            Quantity::StressNorm { region, exponent } => {
                Function::StressNorm(StressNorm { cells: region.cells(place, problem)?, exponent: *exponent })
            }
            Quantity::Stress { region, without_held } => {
                let mut cells = region.cells(place, problem)?;
                if *without_held {
                    leave_out_held(place, &problem.bodies, &mut cells)?;
                }
                Function::Extreme(Extreme { points: Points::Stresses(cells), least: false })
            }
            Quantity::Displacement { region, relative_to, axis, least } => {
                let nodes = region.nodes(place, problem)?;
                let base = relative_to.as_ref().map(|base| mean_over(place, base, problem)).transpose()?;
                let points = Points::Displacements { nodes, base: base.unwrap_or_default(), axis: *axis };
                Function::Extreme(Extreme { points, least: *least })
            }
            Quantity::Compliance => Function::Compliance,
            Quantity::Volume | Quantity::RelativeVolume | Quantity::Mass => return Ok(None),
        };
        Ok(Some(Self { quantity: quantity.clone(), function }))
    }

    /// Whether states need the displacements of the bodies.
    pub fn needs_displacements(&self) -> bool {
        let of_forces = |function: &Function| {
            matches!(
                function,
                Function::Pressures(_) | Function::LoadedArea(_) | Function::MeanPressure(_) | Function::ClosedArea(_)
            )
        };
        !of_forces(&self.function)
    }

    /// Whether J is a maximum or a minimum of [pieces](Self::pieces).
    pub fn has_pieces(&self) -> bool {
        matches!(self.function, Function::Extreme(_))
    }

    /// J at a state of the problem; no number where displacements are needed and not known.
    pub fn value(&self, problem: &ContactProblem, at: StateView<'_>) -> f64 {
        if self.needs_displacements() && at.bodies.is_empty() {
            return f64::NAN;
        }
        let terms = RowTerms { problem, at };
        match &self.function {
            Function::Pressures(cost) => cost.value_at(at),
            Function::LoadedArea(open) => at.rows.area() - open.value_at(at),
            Function::MeanPressure(nodes) => nodes.mean_pressure(&at),
            Function::ClosedArea(nodes) => nodes.closed_area(&at),
            Function::Resultant(resultant) => resultant.value(terms),
            Function::FrictionWork(nodes) => nodes.friction_work(&at),
            Function::Reaction(reaction) => reaction.value(terms),
            Function::StressNorm(norm) => norm.value(terms),
            Function::Compliance => compliance(terms),
            Function::Extreme(extreme) => extreme.value(terms),
        }
    }

    /// The derivatives of J at a state: of a maximum or minimum over points those of the first extreme one, which is
    /// one subgradient of a maximum of such functions. Without the displacements that it needs, and for a closed
    /// area, which jumps, 0.
    pub fn gradient(&self, problem: &ContactProblem, at: StateView<'_>) -> StateGradient {
        if self.needs_displacements() && at.bodies.is_empty() {
            return StateGradient::default();
        }
        let terms = RowTerms { problem, at };
        match &self.function {
            Function::Pressures(cost) => pressure_gradient(cost, terms),
            Function::LoadedArea(open) => loaded_area_gradient(open, terms),
            Function::MeanPressure(nodes) => nodes.mean_pressure_gradient(problem, &at),
            Function::ClosedArea(_) => StateGradient::default(),
            Function::Resultant(resultant) => resultant.gradient(terms),
            Function::FrictionWork(nodes) => nodes.friction_work_gradient(terms),
            Function::Reaction(reaction) => reaction.gradient(terms),
            Function::StressNorm(norm) => norm.gradient(terms),
            Function::Compliance => compliance_gradient(terms),
            Function::Extreme(extreme) => {
                extreme.first(terms).map_or_else(StateGradient::default, |piece| piece.gradient(problem))
            }
        }
    }

    /// The smooth functions of which a maximum or minimum over points is made near a state; empty for smooth
    /// quantities. For a maximum the points whose values are within a tenth of it, at most 200, the largest first; for
    /// a minimum those within a tenth of the largest absolute value above it, the smallest first. Values and
    /// derivatives have the sign of the displacements, for a minimum too: J is the smallest of its pieces then.
    pub fn pieces(&self, problem: &ContactProblem, at: StateView<'_>) -> Vec<StatePiece> {
        match &self.function {
            Function::Extreme(extreme) if !at.bodies.is_empty() => extreme.pieces(RowTerms { problem, at }),
            _ => Vec::new(),
        }
    }

    /// A typical size of its values where these may be 0, in their unit; 0 where their bounds say it.
    pub(crate) fn typical(&self, problem: &ContactProblem) -> f64 {
        let (load, moved) = (problem.load(), problem.typical_displacement());
        match &self.quantity {
            Quantity::ContactForce { .. } | Quantity::Reaction { .. } => load,
            Quantity::ContactMoment { .. } => load * problem.contact_area().sqrt(),
            Quantity::Compliance | Quantity::FrictionWork { .. } => load * moved,
            Quantity::Displacement { .. } | Quantity::Slip { .. } => moved,
            _ => 0.0,
        }
    }
}

/// Checks the numbers of a quantity that no mesh is needed for.
fn check_numbers(place: &str, quantity: &Quantity) -> Result<(), SceneError> {
    let axis = match quantity {
        Quantity::StressNorm { exponent, .. } => {
            let valid = *exponent > 1.0 && exponent.is_finite();
            return SceneError::require(valid, format!("{place}.exponent"), exponent, "a finite number > 1");
        }
        Quantity::Displacement { axis: None, least: true, .. } => {
            let allowed = "the largest length |u|; the smallest displacement is that along an axis";
            return Err(SceneError::out_of_range(format!("{place}.least"), "true", allowed));
        }
        Quantity::ContactMoment { about, .. } if about.iter().any(|x| !x.is_finite()) => {
            return Err(SceneError::out_of_range(
                format!("{place}.about"),
                format!("{about:?}"),
                "finite numbers (mm)",
            ));
        }
        Quantity::Displacement { axis, .. }
        | Quantity::ContactForce { axis, .. }
        | Quantity::ContactMoment { axis, .. }
        | Quantity::Reaction { axis, .. } => *axis,
        _ => None,
    };
    match axis {
        Some(axis) => SceneError::require(axis < 3, format!("{place}.axis"), axis, "an axis: 0, 1 or 2"),
        None => Ok(()),
    }
}

/// The nodes of a contact whose sides may part, or of all such contacts.
fn opening_nodes(place: &str, contact: Option<usize>, problem: &ContactProblem) -> Result<ContactNodes, SceneError> {
    let (field, allowed) =
        (format!("{place}.contact"), "a contact whose sides may part: glued faces neither slide nor open");
    let opening = problem.boundary.contact_points().len();
    let Some(contact) = contact else {
        SceneError::require(opening > 0, field, "none that may part", allowed)?;
        return Ok(ContactNodes(0..opening));
    };
    let nodes = nodes_of(place, contact, problem)?;
    SceneError::require(!problem.scene.contacts[contact].is_tied(), field, contact, allowed)?;
    Ok(nodes)
}

/// The nodes of the contact of a resultant: the one that is named, or the only one.
fn nodes_of_one(place: &str, contact: Option<usize>, problem: &ContactProblem) -> Result<ContactNodes, SceneError> {
    match (contact, problem.scene.contacts.len()) {
        (Some(contact), _) => nodes_of(place, contact, problem),
        (None, 1) => nodes_of(place, 0, problem),
        (None, count) => {
            let allowed = format!("the place of one of the {count} contacts, from 0: each has a resultant of its own");
            Err(SceneError::out_of_range(format!("{place}.contact"), "missing", allowed))
        }
    }
}

/// The nodes of a contact.
fn nodes_of(place: &str, contact: usize, problem: &ContactProblem) -> Result<ContactNodes, SceneError> {
    let count = problem.scene.contacts.len();
    let allowed = format!("the place of a contact of the scene, from 0 to {}", count.saturating_sub(1));
    SceneError::require(contact < count, format!("{place}.contact"), contact, &allowed)?;
    Ok(ContactNodes(problem.boundary.of_contact(contact)))
}

/// The supports of a face.
fn reaction(
    place: &str,
    region: &Region,
    axis: Option<usize>,
    problem: &ContactProblem,
) -> Result<Reaction, SceneError> {
    let field = format!("{place}.region.face");
    let Some(face) = &region.face else {
        return Err(SceneError::out_of_range(field, "missing", "the face of a support"));
    };
    let whole = Region { body: region.body.clone(), face: region.face.clone(), ..Region::WHOLE };
    let allowed = "a face, and its body: a reaction is that of whole supports";
    SceneError::require(*region == whole, format!("{place}.region"), "bounds or a volume", allowed)?;
    if let Some(body) = &region.body {
        find(&format!("{place}.region.body"), body, problem.bodies.iter().map(|body| body.name.as_str()))?;
    }
    let bodies = problem.scene.bodies.iter().enumerate();
    let bodies = bodies.filter(|(_, body)| region.body.as_ref().is_none_or(|name| *name == body.name));
    let own = |supports: &[crate::scene::Support]| -> Vec<usize> {
        supports.iter().enumerate().filter(|(_, support)| support.face == *face).map(|(number, _)| number).collect()
    };
    let found: Vec<(usize, Vec<usize>)> = bodies
        .clone()
        .map(|(number, body)| (number, own(&body.supports)))
        .filter(|(_, supports)| !supports.is_empty())
        .collect();
    match &found[..] {
        [(body, supports)] => Ok(Reaction { body: *body, supports: supports.clone(), axis }),
        [] => {
            let faces = bodies.flat_map(|(_, body)| &body.supports).map(|support| support.face.as_str());
            find(&field, face, faces)?;
            Err(SceneError::out_of_range(field, format!("\"{face}\""), "a face with a support"))
        }
        _ => {
            let allowed = "the name of one body: several have a support of this face";
            Err(SceneError::out_of_range(format!("{place}.region.body"), "missing", allowed))
        }
    }
}

/// Takes cells off that have a node held by a support of their body.
fn leave_out_held(place: &str, bodies: &[Body], cells: &mut RegionCells) -> Result<(), SceneError> {
    for (cells, body) in cells.cells.iter_mut().zip(bodies) {
        let held = body.held_nodes();
        cells.retain(|&cell| body.mesh.cell(cell).nodes.iter().all(|node| held.binary_search(node).is_err()));
    }
    let any = cells.cells.iter().any(|cells| !cells.is_empty());
    let allowed = "false: supports hold a node of every cell of the region";
    SceneError::require(any, format!("{place}.without_held"), true, allowed)
}

/// The weights of the mean over a face at the start, ∫N_v dA/∫dA of its nodes.
fn mean_over(place: &str, region: &Region, problem: &ContactProblem) -> Result<MeanNodes, SceneError> {
    let within = format!("{place}.relative_to");
    let Some(face) = &region.face else {
        let allowed = "the face whose mean displacement is subtracted";
        return Err(SceneError::out_of_range(format!("{within}.face"), "missing", allowed));
    };
    let nodes = region.face_of(&within, face, problem)?;
    let positions = problem.start_positions();
    let (mut weights, mut whole) = (std::collections::BTreeMap::new(), 0.0);
    for (number, facets) in nodes.iter().enumerate() {
        for facet in facets {
            let places: Vec<[f64; 3]> = facet.iter().map(|&node| positions[number][node as usize]).collect();
            integrate(&places, |point| {
                let area: f64 = length(point.area);
                whole += area;
                for (&node, value) in facet.iter().zip(point.values) {
                    *weights.entry((number, node)).or_insert(0.0) += value * area;
                }
            });
        }
    }
    Ok(weights.into_iter().map(|((body, node), weight)| (body, node, weight / whole)).collect())
}

/// The derivatives of a function of the pressures.
fn pressure_gradient(cost: &PressureCost, terms: RowTerms<'_>) -> StateGradient {
    let [by_force, by_area] = pressure_slopes(cost, terms);
    by_forces_and_areas(terms, |index| by_force[index], &by_area)
}

/// ΣA less the open area.
fn loaded_area_gradient(open: &PressureCost, terms: RowTerms<'_>) -> StateGradient {
    let [by_force, by_area] = pressure_slopes(open, terms);
    let by_area: Vec<f64> = by_area.into_iter().map(|slope| 1.0 - slope).collect();
    by_forces_and_areas(terms, |index| -by_force[index], &by_area)
}

fn pressure_slopes(cost: &PressureCost, terms: RowTerms<'_>) -> [Vec<f64>; 2] {
    let (outputs, forces, areas) = (cost.outputs(false), &terms.at.forces.normal, terms.at.rows.areas());
    let weights = OuterFunction::subgradient(cost, &Vector::from_vec(outputs.values(forces, &areas)));
    outputs.pull_back(forces, &areas, weights.as_slice())
}

fn by_forces_and_areas(terms: RowTerms<'_>, by_force: impl Fn(usize) -> f64, by_area: &[f64]) -> StateGradient {
    let problem = terms.problem;
    let mut forces = vec![0.0; problem.boundary.row_count];
    let points = problem.boundary.contact_points().iter().enumerate();
    points.for_each(|(index, point)| forces[point.start] = by_force(index));
    let positions = problem.pull_back_areas(terms.at.rows, by_area);
    StateGradient { forces, displacements: Vec::new(), positions }
}

/// f·u.
fn compliance(terms: RowTerms<'_>) -> f64 {
    let works = terms.at.bodies.iter().zip(&*terms.problem.bodies).map(|(solved, body)| {
        let forces = nodal_forces(body, &solved.positions).into_iter();
        forces.map(|(node, force)| dot(force, solved.displacement[node as usize])).sum::<f64>()
    });
    works.sum()
}

/// l = f, and uᵀ∂f.
fn compliance_gradient(terms: RowTerms<'_>) -> StateGradient {
    let problem = terms.problem;
    let (mut displacements, mut positions) = (vec![0.0; problem.displacement_count()], problem.no_sensitivities());
    for (number, (solved, body)) in terms.at.bodies.iter().zip(&*problem.bodies).enumerate() {
        for (node, force) in nodal_forces(body, &solved.positions) {
            let first = 3 * problem.map.number(number, node);
            (0..3).for_each(|axis| displacements[first + axis] += force[axis]);
        }
        let u = |node: u32| solved.displacement[node as usize];
        let moves = |node: u32| problem.map.moves(number, node);
        for (node, value) in load_sensitivities(body, &|_| true, &solved.positions, &u, &moves) {
            if moves(node) {
                positions[problem.node_number(number, node)] = value;
            }
        }
    }
    StateGradient { forces: Vec::new(), displacements, positions }
}
