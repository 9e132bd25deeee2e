//! Resultants of the forces on the bodies of a solved shape, reactions of their supports, and the largest stress.
//!
//! ```text
//! r = K u − f − c per node, half of a tied node's r on each of its ends;     c: contact forces λ_N n + λ_T, by sides
//! reaction of a support = Σ (d·r) d over the held directions d of its nodes;     Σ f + Σ c + Σ reactions = 0
//! ```
//! Of several supports that hold a direction of a node, the first one takes its reaction. All follows from the
//! displacements of whole bodies and from the contact forces, whatever solver found them.

use crate::body::Body;
use crate::body::loads::nodal_forces;
use crate::equilibrium::{ContactForces, ContactPoint, ContactProblem, ContactRows, NodeRows, SolvedBody};
use crate::linear::parallel;
use serde::Serialize;

/// Forces on all bodies, and the largest stress in them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resultants {
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodyResultants>,
    /// The largest stress; none where no body is known to this process.
    pub largest_stress: Option<LargestStress>,
}

/// Resultants of the forces on one body, along x₁, x₂, x₃.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BodyResultants {
    /// The body.
    pub body: String,
    /// Of all loads, N.
    pub loads: [f64; 3],
    /// Of the contact forces on the body, N.
    pub contact: [f64; 3],
    /// Σ 𝓕 λ_N over its contact nodes that supports hold in a tangential direction, N: at most so much friction along
    /// these directions is in neither the contact forces nor the reactions, because such nodes have no row for it.
    pub friction_of_held: f64,
    /// Reactions of its supports, in the order of the scene.
    pub supports: Vec<SupportReaction>,
}

/// What a support exerts on its body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportReaction {
    /// The face that the support holds.
    pub face: String,
    /// Force on the body along x₁, x₂, x₃, N.
    pub force: [f64; 3],
}

/// The largest von Mises stress over the integration points of all cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LargestStress {
    /// Number of the body.
    pub body: usize,
    /// Number of the cell in its mesh.
    pub cell: usize,
    /// The integration point at the undeformed shape, mm.
    pub place: [f64; 3],
    /// The stress, MPa.
    pub value: f64,
}

impl BodyResultants {
    /// Loads, contact forces and reactions together, N: zero up to the accuracy of the state.
    pub fn imbalance(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let forces = [self.loads, self.contact].into_iter().chain(self.supports.iter().map(|support| support.force));
        forces.for_each(|force| add(&mut sum, 1.0, force));
        sum
    }
}

impl Resultants {
    /// The forces on solved bodies with their contact rows and contact forces.
    pub fn new(problem: &ContactProblem, bodies: &[SolvedBody], contact: (&ContactRows, &ContactForces)) -> Self {
        let of_body = |(number, solved): (usize, &SolvedBody)| of_body(problem, number, solved, contact);
        let largest_stress = LargestStress::of(problem, bodies);
        Self { bodies: bodies.iter().enumerate().map(of_body).collect(), largest_stress }
    }
}

impl LargestStress {
    /// The largest stress in solved bodies; none without bodies.
    pub fn of(problem: &ContactProblem, bodies: &[SolvedBody]) -> Option<Self> {
        let of_body = |(number, (solved, body)): (usize, (&SolvedBody, &Body))| {
            let of_cell = |cell: usize| {
                let nodes = solved.mesh.cell_nodes(cell, &solved.positions);
                let u = solved.mesh.cell_values(cell, &solved.displacement);
                let (value, place) = nodes.largest_von_mises(body.solid.material(cell).shear_modulus(), &u);
                Self { body: number, cell, place, value }
            };
            parallel::map(solved.mesh.cell_count(), &of_cell)
        };
        let cells = bodies.iter().zip(&*problem.bodies).enumerate().flat_map(of_body);
        // The first one of equal stresses.
        cells.reduce(|largest, other| if other.value > largest.value { other } else { largest })
    }
}

/// The forces on one body.
fn of_body(
    problem: &ContactProblem,
    number: usize,
    solved: &SolvedBody,
    contact: (&ContactRows, &ContactForces),
) -> BodyResultants {
    let body = &problem.bodies[number];
    let mut rest = body.solid.internal_forces(&solved.positions, &solved.displacement);
    let (mut loads, mut contacts) = ([0.0; 3], [0.0; 3]);
    for (node, force) in nodal_forces(body, &solved.positions) {
        add(&mut loads, 1.0, force);
        add(&mut rest[node as usize], -1.0, force);
    }
    for (node, force) in contact_forces(problem, number, contact) {
        add(&mut contacts, 1.0, force);
        let (trace, weights) = (&body.trace, &contact.0.traces[number]);
        trace.spread(weights, node, force, &mut |node, share| add(&mut rest[node as usize], -1.0, share));
    }
    let friction_of_held = friction_of_held(problem, number, contact);
    let supports = &problem.scene.bodies[number].supports;
    let reaction = |face: &String| SupportReaction { face: face.clone(), force: [0.0; 3] };
    let mut supports: Vec<SupportReaction> = supports.iter().map(|support| reaction(&support.face)).collect();
    for node in body.held_nodes() {
        for (direction, support) in body.held_by(node) {
            let share = (0..3).map(|axis| direction[axis] * rest[node as usize][axis]).sum();
            add(&mut supports[support].force, share, direction);
        }
    }
    BodyResultants { body: body.name.clone(), loads, contact: contacts, friction_of_held, supports }
}

/// Contact forces on the weighted displacements of the nodes of a body, N.
fn contact_forces<'a>(
    problem: &'a ContactProblem,
    number: usize,
    (rows, forces): (&'a ContactRows, &'a ContactForces),
) -> impl Iterator<Item = (u32, [f64; 3])> + 'a {
    let points = problem.boundary.points.iter().zip(&rows.nodes).enumerate();
    points.flat_map(move |(index, (point, node))| {
        let tangential = forces.tangential.get(index).copied().unwrap_or_default();
        let force: [f64; 3] = match forces.normal.get(index) {
            // Between bodies, what supports hold of a normal acts on neither side.
            Some(normal) => {
                let along = if point.sides.len() > 1 { node.directions[0] } else { node.normal };
                std::array::from_fn(|axis| normal * along[axis] + tangential[axis])
            }
            None => forces.ties[index - forces.normal.len()],
        };
        let sides = point.sides.iter().zip(&node.weights);
        let own = sides.filter(move |(side, weight)| side.body == number && **weight != 0.0);
        own.map(move |(side, weight)| (side.node, force.map(|force| -weight * force)))
    })
}

/// The slip bounds of the contact nodes of a body that supports hold in a tangential direction, N.
fn friction_of_held(problem: &ContactProblem, number: usize, (rows, forces): (&ContactRows, &ContactForces)) -> f64 {
    let nodes = problem.boundary.contact_points().iter().zip(&rows.nodes).zip(&forces.normal);
    let is_held = |((point, node), _): &((&ContactPoint, &NodeRows), &f64)| {
        let takes_part = point.body == number || point.sides.iter().any(|side| side.body == number);
        takes_part && point.free.len() < 3 && node.is_covered
    };
    nodes.filter(is_held).map(|((point, _), force)| point.friction * force.max(0.0)).fold(0.0, |sum, own| sum + own)
}

fn add(sum: &mut [f64; 3], factor: f64, vector: [f64; 3]) {
    (0..3).for_each(|axis| sum[axis] += factor * vector[axis]);
}
