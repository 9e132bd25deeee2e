//! The friction problem of a shape as matrices, for other solvers.
//!
//! ```text
//! K u = f + Hᵀ r,   w = H u + (g, s₁, s₂) per contact node,
//! 0 ≤ r_N ⊥ w_N ≥ 0,   |r_T| ≤ 𝓕 r_N,   w_T = −κ r_T with κ ≥ 0, and κ = 0 where |r_T| < 𝓕 r_N
//! ```
//! Node by node, r = (λ_N, λ_T) are the contact forces of method.md section 3, and H u is minus the jump, lower body
//! less upper: w_N is the gap under load, w_T minus the slip. The bodies are not torn; directions that supports hold
//! are eliminated: what supports prescribe there is part of f, g and s.

use crate::body::loads::piece_loads;
use crate::body::{Body, NodalAxes, Piece, Trace, TraceWeights};
use crate::equilibrium::{ContactPoint, ContactProblem, NodeRows};
use crate::error::ContactError;
use crate::linear::vector::add_scaled;
use std::collections::BTreeMap;

/// Rows of H per contact node: the normal, then two tangential directions.
pub const ROWS: usize = 3;

/// The matrices of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionProblem {
    /// The unknown displacements: body (0 lower, 1 upper), node of its mesh, component along the axes; along the
    /// directions across the supports, in their order, where these hold the node along other directions than axes.
    pub unknowns: Vec<[usize; 3]>,
    /// K by its lower triangle: (row, column, value in N/mm).
    pub stiffness: Vec<(usize, usize, f64)>,
    /// The loads f less the forces of prescribed displacements, N.
    pub load: Vec<f64>,
    /// H: (row, column, value). A row is empty where supports hold its direction on all bodies.
    pub contact: Vec<(usize, usize, f64)>,
    /// g per contact node: the gap where only held nodes have moved, mm.
    pub gaps: Vec<f64>,
    /// s per contact node: minus the slip where only held nodes have moved, mm.
    pub slips: Vec<[f64; 2]>,
    /// 𝓕 per contact node.
    pub friction: Vec<f64>,
    /// Places of the contact nodes on the lower body, mm.
    pub places: Vec<[f64; 3]>,
    /// Tributary areas of the contact nodes, mm²; a pressure is λ_N over the area.
    pub areas: Vec<f64>,
    /// Unit normals of the contact nodes.
    pub normals: Vec<[f64; 3]>,
    /// The directions of the two tangential rows of the contact nodes; 0 for rows that are empty.
    pub tangents: Vec<[[f64; 3]; 2]>,
}

impl FrictionProblem {
    /// Number of displacements of all bodies, those that supports hold included.
    pub fn most_unknowns(problem: &ContactProblem) -> usize {
        problem.displacement_count()
    }

    /// The matrices of the shape with these controls.
    ///
    /// # Errors
    /// [`ContactError::InvertedElement`], [`ContactError::NoFoot`].
    pub fn new(problem: &ContactProblem, controls: &[f64]) -> Result<Self, ContactError> {
        let positions = problem.positions(controls)?;
        let rows = problem.rows(&positions)?;
        let points = &problem.boundary.points;
        let nodes = || points.iter().zip(&rows.nodes);
        let along = |(point, node): (&ContactPoint, &NodeRows), direction: &[f64; 3]| -> f64 {
            let own = point.prescribed_jump(&node.weights);
            let by_trace = rows.prescribed_by_trace((point, node), &problem.bodies);
            let jump = own.into_iter().zip(by_trace).map(|(own, by_trace)| own + by_trace);
            jump.zip(direction).map(|(jump, d)| jump * d).sum()
        };
        let slip = |(point, node): (&ContactPoint, &NodeRows)| {
            tangents(node.all_directions(&point.free)).map(|tangent| -along((point, node), &tangent))
        };
        let mut this = Self {
            unknowns: Vec::new(),
            stiffness: Vec::new(),
            load: Vec::new(),
            contact: Vec::new(),
            gaps: nodes().map(|(point, node)| node.gap - along((point, node), &node.directions[0])).collect(),
            slips: nodes().map(slip).collect(),
            friction: points.iter().map(|point| point.friction).collect(),
            places: points.iter().map(|point| positions[point.body][point.node as usize]).collect(),
            areas: rows.areas(),
            normals: rows.nodes.iter().map(|node| node.normal).collect(),
            tangents: nodes().map(|(point, node)| tangents(node.all_directions(&point.free))).collect(),
        };
        for (number, (body, positions)) in problem.bodies.iter().zip(&positions).enumerate() {
            let piece = body.whole();
            let axes = NodalAxes::new(body, &piece);
            let numbers = this.add_body(number, body, (&piece, &axes), positions);
            let contact = (number, &piece, &axes, numbers.as_slice());
            let trace = (&body.trace, &rows.traces[number]);
            points.iter().zip(&rows.nodes).enumerate().for_each(|node| this.add_contact(node, contact, trace));
        }
        Ok(this)
    }

    /// Adds stiffness and loads of a body; returns the numbers of its free dofs among all unknowns.
    fn add_body(
        &mut self,
        number: usize,
        body: &Body,
        (piece, axes): (&Piece, &NodalAxes),
        positions: &[[f64; 3]],
    ) -> Vec<Option<usize>> {
        let mut number_of = |(dof, held): (usize, &bool)| {
            (!held).then(|| {
                self.unknowns.push([number, piece.nodes[dof / 3] as usize, dof % 3]);
                self.unknowns.len() - 1
            })
        };
        let numbers: Vec<Option<usize>> = axes.held.iter().enumerate().map(&mut number_of).collect();
        let mut values = piece.assemble(&body.solid, positions, |material| *material);
        let lower = &piece.pattern.lower;
        axes.turn_matrix(lower, &mut values);
        for column in 0..lower.dimension() {
            let Some(second) = numbers[column] else { continue };
            for position in lower.starts()[column]..lower.starts()[column + 1] {
                let first = numbers[lower.rows()[position]];
                self.stiffness.extend(first.map(|first| (first, second, values[position])));
            }
        }
        let mut loads = piece_loads(body, piece, positions);
        axes.turn(&mut loads);
        let mut carried = vec![0.0; loads.len()];
        lower.multiply(&values, &axes.lift(piece, |node| body.prescribed(node)), &mut carried);
        add_scaled(&mut loads, -1.0, &carried);
        let loads = loads.into_iter().zip(&numbers).filter(|(_, number)| number.is_some());
        self.load.extend(loads.map(|(force, _)| force));
        numbers
    }

    /// Adds the rows of H of a contact node on one body, given its number, its piece, and the numbers of its unknowns.
    fn add_contact(
        &mut self,
        (index, (point, row)): (usize, (&ContactPoint, &NodeRows)),
        (body, piece, axes, numbers): (usize, &Piece, &NodalAxes, &[Option<usize>]),
        (trace, weights): (&Trace, &TraceWeights),
    ) {
        let sides = point.sides.iter().zip(&row.weights);
        let mut entries: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for (side, weight) in sides.filter(|(side, weight)| side.body == body && **weight != 0.0) {
            for (offset, direction) in row.all_directions(&point.free).into_iter().enumerate() {
                let force = direction.map(|d| -weight * d);
                trace.spread(weights, side.node, force, &mut |node, share| {
                    let Some(place) = piece.local(node) else { return };
                    let turned = axes.turn_at(place, share);
                    for axis in (0..3).filter(|axis| turned[*axis] != 0.0) {
                        if let Some(number) = numbers[3 * place + axis] {
                            *entries.entry((ROWS * index + offset, number)).or_insert(0.0) += turned[axis];
                        }
                    }
                });
            }
        }
        self.contact.extend(entries.into_iter().map(|((row, column), value)| (row, column, value)));
    }
}

/// The directions of two tangential rows among those of all rows.
fn tangents(directions: Vec<[f64; 3]>) -> [[f64; 3]; 2] {
    [1, 2].map(|row| directions.get(row).copied().unwrap_or_default())
}
