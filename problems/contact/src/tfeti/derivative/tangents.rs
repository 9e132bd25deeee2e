//! Forward derivatives of a TFETI state: all columns in lockstep; method.md (5.4).
//!
//! ```text
//! r = −∂(K u + Bᵀλ − f),   δe = Rᵀ r,   δd = B K⁺ r + ∂B u − ∂g
//! Qᵀ F T y + Δ y − QᵀGᵀ δa = Qᵀ δd,   G T y = δe,      δλ = T y,   δw = δd − F δλ + Gᵀ δa
//! ```
//! The system of a Newton step with another right side; the adjoint solves with its transpose. With G T y = δe the
//! forces r − Bᵀ T y are in equilibrium on every subdomain, so δd − F T y = B K⁺(r − Bᵀ T y) + ∂B u − ∂g is one
//! product, free of rigid parts that would cancel. Directions are in single precision, and so is all else where the
//! tolerance allows it; otherwise the residual is computed afresh in double precision after every cycle. Displacements
//! are u′ = K⁺(r − Bᵀ T y) + R δa, from one more product.

use crate::body::MOTIONS;
use crate::equilibrium::law::{Friction, Linearization};
use crate::equilibrium::row_work::{NodeValues, row_approaches};
use crate::equilibrium::trace_work::{TraceChanges, TraceWork};
use crate::equilibrium::{Positions, RowChange, Tangents};
use crate::error::ContactError;
use crate::linear::columns::{add_combination, norms};
use crate::linear::entry::{Entry, LANES, Row};
use crate::linear::gcr::gcr;
use crate::linear::real::Real;
use crate::linear::vector::add_scaled;
use crate::tfeti::derivative::cycles::{
    CYCLE_REDUCTION, MAX_CYCLES, NextCycle, SMALLEST_PROJECTED_SHARE, TIGHTEST_ACCEPTABLE, next_cycle,
};
use crate::tfeti::derivative::shape_derivative::SolvedShape;
use crate::tfeti::derivative::shape_loads::ShapeLoads;
use crate::tfeti::dual::{ActiveSet, Precision, TornContact};
use crate::tfeti::torn::{RowVector, TornModel, TornVector, parts_mut, whole_bodies};
use std::cell::RefCell;

/// Columns that advance in lockstep: the sums of a tile of the subdomain solves then fill the registers.
pub(crate) const MAX_COLUMNS: usize = 5 * LANES;
/// Relative residual below which rounding of the subdomain solves in double precision decides.
const TIGHTEST_GOAL: f64 = 1e-11;
/// Smallest relative residual for which single precision needs no check by a product in double precision.
const TIGHTEST_SINGLE: f64 = 1e-4;
/// Unit roundoff of single precision over that of double precision.
const SINGLE_ROUNDING: f64 = (1_u64 << 29) as f64;
/// Share of the tolerance that rounding of the subdomain solves in single precision may take.
const MAX_ROUNDING_SHARE: f64 = 0.1;
/// Krylov iterations allowed per cycle.
const MAX_KRYLOV: usize = 400;

/// What is asked of a solved shape.
#[derive(Debug, Clone, Copy)]
pub struct TangentRequest<'a> {
    /// The shape.
    pub shape: SolvedShape<'a>,
    /// Positions of the nodes of all bodies, where the displacements of the bodies are differentiated as well.
    pub whole: Option<&'a Positions>,
    /// Relative residual.
    pub tolerance: f64,
}

/// The system of at most 8N changes of the shape, with residuals in precision D.
struct TangentSystem<'a, D, const N: usize> {
    contact: &'a TornContact<'a>,
    active: &'a ActiveSet<'a>,
    loads: ShapeLoads<D, N>,
    /// ∂B u − ∂g over the packed contact rows, mm.
    approaches: Vec<Row<D, N>>,
    /// Changes of the areas of the contact nodes, mm².
    areas: Vec<Vec<f64>>,
    count: usize,
}

/// Unknowns y with their residual.
struct TangentIterate<D, const N: usize> {
    unknowns: Vec<Row<D, N>>,
    /// The residual without its rigid part, mm.
    projected: Vec<Row<D, N>>,
    /// Normal rows of δw.
    openings: Vec<Row<D, N>>,
    /// Norms of the projected residual.
    residuals: Row<f64, N>,
    /// Norms of the whole residual.
    natural: Row<f64, N>,
}

/// What unknowns do to the torn bodies.
struct TangentResponse<D, const N: usize> {
    /// K⁺(r − Bᵀ T y) over the torn dofs of this process, then its ghosts, mm.
    torn: Vec<Row<D, N>>,
    /// Its jumps, in contact rows with ∂B u − ∂g.
    jumps: RowVector<Row<D, N>>,
    /// The reduced residual with its rigid part.
    reduced: Vec<Row<D, N>>,
}

/// Tangents for changes of the controls. Where there are several processes, all of them call it, and the first one
/// alone gets displacements.
///
/// # Errors
/// [`ContactError::NotConverged`] when a column does not reach the tolerance, [`ContactError::Unheld`].
pub fn tangents(
    contact: &TornContact<'_>,
    request: TangentRequest<'_>,
    linearizations: &[Linearization],
    changes: &[Vec<f64>],
) -> Result<Tangents, ContactError> {
    let active = contact.active_set(linearizations.to_vec(), Friction::Coulomb)?;
    let (forces, openings, areas) = (Vec::new(), Vec::new(), Vec::new());
    let displacements = request.whole.map(|_| Vec::new());
    let mut tangents = Tangents { forces, openings, areas, displacements, residual: 0.0, applications: 0 };
    let batches = changes.len().div_ceil(MAX_COLUMNS).max(1);
    for batch in changes.chunks(changes.len().div_ceil(batches).max(1)) {
        match batch.len().div_ceil(LANES) {
            0 | 1 => tangent_batch::<1>(contact, &active, request, batch, &mut tangents)?,
            2 | 3 => tangent_batch::<3>(contact, &active, request, batch, &mut tangents)?,
            _ => tangent_batch::<5>(contact, &active, request, batch, &mut tangents)?,
        }
    }
    tangents.applications = contact.operator.applications();
    Ok(tangents)
}

/// Appends the tangents of at most 8N changes.
fn tangent_batch<const N: usize>(
    contact: &TornContact<'_>,
    active: &ActiveSet<'_>,
    request: TangentRequest<'_>,
    changes: &[Vec<f64>],
    tangents: &mut Tangents,
) -> Result<(), ContactError> {
    let TangentRequest { shape, whole, tolerance } = request;
    if single_is_enough(contact, tolerance) {
        let system = TangentSystem::<f32, N>::new(contact, active, shape, changes);
        if let Some(iterate) = system.solve_once(tolerance) {
            system.append(&iterate, whole, tangents);
            return Ok(());
        }
    }
    let system = TangentSystem::<f64, N>::new(contact, active, shape, changes);
    let iterate = system.solve_in_cycles(tolerance)?;
    system.append(&iterate, whole, tangents);
    Ok(())
}

/// Whether single precision alone reaches a tolerance, estimated from the condition of the subdomains.
fn single_is_enough(contact: &TornContact<'_>, tolerance: f64) -> bool {
    contact.precision == Precision::Mixed
        && tolerance >= TIGHTEST_SINGLE
        && SINGLE_ROUNDING * contact.operator.system.forward_error <= MAX_ROUNDING_SHARE * tolerance
}

impl<'a, D: Real, const N: usize> TangentSystem<'a, D, N> {
    fn new(
        contact: &'a TornContact<'a>,
        active: &'a ActiveSet<'a>,
        shape: SolvedShape<'_>,
        changes: &[Vec<f64>],
    ) -> Self {
        let operator = &contact.operator;
        let velocities = operator.model.problem.map.velocities(changes);
        let of_column = |column| shape.rows.changes(contact.boundary, &velocities, column);
        let rows: Vec<Vec<RowChange>> = (0..changes.len()).map(of_column).collect();
        let traces = TraceWork::new(&operator.model.problem, shape.rows, shape.positions);
        let traces = traces.map(|work| work.along(&velocities));
        let loads = ShapeLoads::new(operator.model, operator.system, shape, (&velocities, traces.as_ref()), &rows);
        let approaches = approaches(operator.model, shape, traces.as_ref(), &rows);
        let areas = rows.iter().map(|changes| shape.rows.area_changes(changes)).collect();
        Self { contact, active, loads, approaches, areas, count: changes.len() }
    }

    /// Brings unknowns into equilibrium and computes their residual.
    fn evaluate(&self, mut unknowns: Vec<Row<D, N>>) -> TangentIterate<D, N> {
        self.active.enforce(&mut unknowns, &self.loads.resultants);
        let TangentResponse { jumps, reduced: mut projected, .. } = self.respond(&unknowns);
        let sums = self.contact.operator.model.sums();
        let natural = norms(&sums, &projected);
        let openings = self.release(&mut projected, &jumps);
        TangentIterate { unknowns, residuals: norms(&sums, &projected), projected, openings, natural }
    }

    /// What unknowns do to the torn bodies.
    fn respond(&self, unknowns: &[Row<D, N>]) -> TangentResponse<D, N> {
        let (rows, operator) = (&self.active.rows, &self.contact.operator);
        let mut torn = vec![Row::ZERO; operator.model.interface.torn_count()];
        let mut jumps = operator.free_jumps(&self.loads.forces, &rows.trial(unknowns), &mut torn, self.count);
        for (jump, approach) in jumps.contact_mut().iter_mut().zip(&self.approaches) {
            jump.add_scaled(1.0, approach);
        }
        let mut reduced = rows.test_transposed(&jumps);
        rows.add_compliance(unknowns, &mut reduced, -1.0);
        TangentResponse { torn, jumps, reduced }
    }

    /// u′ = K⁺(r − Bᵀ T y) + R δa of whole bodies, per column: three entries per node of every body, lower first, mm;
    /// the copies of a node are averaged. None but process 0 gets entries.
    fn displacements(&self, unknowns: &[Row<D, N>], positions: &Positions) -> Vec<Vec<f64>> {
        let (model, system) = (self.contact.operator.model, self.contact.operator.system);
        let TangentResponse { torn, reduced, .. } = self.respond(unknowns);
        let amplitudes = self.active.amplitudes(&reduced);
        let own = &amplitudes[MOTIONS * model.clusters.owned().start..];
        let of_column = |column: usize| {
            let mut values: Vec<f64> = torn.iter().map(|row| row.get(column)).collect();
            let own: Vec<f64> = own.iter().map(|row| row.get(column)).collect();
            for (index, (values, part)) in
                parts_mut(&mut values, &system.starts).into_iter().zip(&system.parts).enumerate()
            {
                for (mode, amplitude) in part.modes.iter().zip(system.amplitudes_of(index, &own)) {
                    add_scaled(values, amplitude, mode);
                }
            }
            let bodies = whole_bodies(model, positions, &TornVector(values)).into_iter();
            bodies.flat_map(|body| body.displacement.into_flattened()).collect()
        };
        (0..self.count).map(of_column).collect()
    }

    /// y = 0, brought into equilibrium.
    fn at_zero(&self) -> TangentIterate<D, N> {
        self.evaluate(vec![Row::ZERO; self.active.rows.dimension()])
    }

    /// Takes the rigid part off a reduced residual or product; returns the normal rows of `jumps` without it.
    fn release<E: Real>(&self, reduced: &mut [Row<E, N>], jumps: &RowVector<Row<E, N>>) -> Vec<Row<E, N>> {
        let rigid = self.contact.space.jumps(&self.active.amplitudes(reduced));
        for (entry, rigid) in reduced.iter_mut().zip(self.active.rows.test_transposed(&rigid)) {
            entry.add_scaled(1.0, &rigid);
        }
        let points = self.contact.boundary.points.iter();
        let sum = |start: usize| jumps.contact()[start].zip(&rigid.contact()[start], |jump, rigid| jump + rigid);
        points.map(|point| sum(point.start)).collect()
    }

    /// One run of the Krylov method in precision E, towards residuals of `goals`, or by `reduction` if that is more.
    fn cycle<E: Real>(&self, iterate: &mut TangentIterate<D, N>, goals: &Row<f64, N>, reduction: f64) {
        let (rows, contact) = (&self.active.rows, self.contact);
        // Every column is brought to size one, so that no unit system leaves the range of single precision.
        let sizes = iterate.residuals.map(|size| if size > 0.0 { size } else { 1.0 });
        let targets = goals.zip(&sizes, |goal, size| (goal / size).max(reduction));
        let scaled = |row: &Row<D, N>| row.zip(&sizes, |row, size| E::of(row.double() / size));
        let residual = iterate.projected.iter().map(scaled).collect();
        let torn = RefCell::new(vec![Row::<E, N>::ZERO; contact.operator.model.interface.torn_count()]);
        let precondition = |v: &[Row<E, N>]| {
            let image = contact.preconditioner.apply_columns(&rows.test(v), &mut torn.borrow_mut());
            let mut z = rows.test_transposed(&image);
            rows.add_spring(v, &mut z);
            self.active.project(&mut z);
            z
        };
        let apply = |z: &[Row<E, N>]| {
            let image = contact.operator.apply_columns(&rows.trial(z), &mut torn.borrow_mut(), self.count);
            let mut reduced = rows.test_transposed(&image);
            rows.add_compliance(z, &mut reduced, 1.0);
            let openings = self.release(&mut reduced, &image);
            (reduced, openings)
        };
        let krylov = gcr(&contact.operator.model.sums(), residual, &targets, MAX_KRYLOV, &precondition, &apply);
        let factors = krylov.coefficients.iter().map(|factor| factor.zip(&sizes, |factor, size| factor * size));
        let factors: Vec<Row<f64, N>> = factors.collect();
        let terms: Vec<_> = factors.iter().copied().zip(krylov.directions.iter().map(Vec::as_slice)).collect();
        add_combination(&mut iterate.unknowns, &terms);
        let changes = factors.iter().map(|factor| factor.map(|factor| -factor));
        let terms: Vec<_> = changes.zip(krylov.payloads.iter().map(Vec::as_slice)).collect();
        add_combination(&mut iterate.openings, &terms);
        iterate.residuals = krylov.residuals.zip(&sizes, |residual, size| residual * size);
    }

    /// Appends the tangents of an iterate.
    fn append(
        &self,
        (iterate, residual): &(TangentIterate<D, N>, f64),
        whole: Option<&Positions>,
        tangents: &mut Tangents,
    ) {
        tangents.residual = tangents.residual.max(*residual);
        let multipliers = self.active.rows.trial(&iterate.unknowns);
        let constraints = &self.contact.operator.model.constraints;
        let scales: Vec<f64> = constraints.contact_scales(self.contact.boundary).collect();
        for column in 0..self.count {
            let rows = multipliers.contact().iter().zip(&scales);
            tangents.forces.push(rows.map(|(row, nu)| row.get(column) / nu).collect());
            let nodes = iterate.openings.iter().zip(&constraints.normalisation);
            tangents.openings.push(nodes.map(|(opening, nu)| opening.get(column) * nu).collect());
        }
        tangents.areas.extend_from_slice(&self.areas);
        if let (Some(positions), Some(displacements)) = (whole, &mut tangents.displacements) {
            displacements.extend(self.displacements(&iterate.unknowns, positions));
        }
    }
}

impl<const N: usize> TangentSystem<'_, f32, N> {
    /// One cycle in single precision, with its largest relative residual by the recurrence; none if it misses the
    /// tolerance.
    fn solve_once(&self, tolerance: f64) -> Option<(TangentIterate<f32, N>, f64)> {
        let mut iterate = self.at_zero();
        let sizes = iterate.sizes();
        self.cycle::<f32>(&mut iterate, &sizes.map(|size| tolerance * size), 0.0);
        let residual = largest_share(&iterate.residuals, &sizes);
        (residual <= tolerance).then_some((iterate, residual))
    }
}

impl<const N: usize> TangentSystem<'_, f64, N> {
    /// Cycles to a relative residual, each followed by products in double precision; also the largest residual.
    fn solve_in_cycles(&self, tolerance: f64) -> Result<(TangentIterate<f64, N>, f64), ContactError> {
        let mut precision = self.contact.precision;
        let mut iterate = self.at_zero();
        let sizes = iterate.sizes();
        let goal = tolerance.max(TIGHTEST_GOAL);
        let goals = sizes.map(|size| goal * size);
        let mut residual = largest_share(&iterate.residuals, &sizes);
        for _cycle in 0..MAX_CYCLES {
            if residual <= goal {
                break;
            }
            match precision {
                Precision::Mixed => self.cycle::<f32>(&mut iterate, &goals, CYCLE_REDUCTION),
                Precision::Double => self.cycle::<f64>(&mut iterate, &goals, 0.0),
            }
            iterate = self.evaluate(iterate.unknowns);
            let previous = std::mem::replace(&mut residual, largest_share(&iterate.residuals, &sizes));
            match next_cycle(precision, previous, residual, goal) {
                NextCycle::Continue => {}
                NextCycle::Double => precision = Precision::Double,
                NextCycle::DoubleFromZero => {
                    precision = Precision::Double;
                    iterate = self.at_zero();
                    residual = largest_share(&iterate.residuals, &sizes);
                }
                NextCycle::Stop => break,
            }
        }
        if residual.is_nan() || residual > TIGHTEST_ACCEPTABLE.max(tolerance) {
            return Err(ContactError::NotConverged {
                solver: "tangents by GCR on TFETI",
                residual,
                tolerance,
                iterations: MAX_KRYLOV,
                history: vec![residual],
            });
        }
        Ok((iterate, residual))
    }
}

impl<D, const N: usize> TangentIterate<D, N> {
    /// What relative residuals refer to: where equilibrium alone determines the forces, all of the right side is rigid
    /// and only rounding is left of it.
    fn sizes(&self) -> Row<f64, N> {
        self.residuals.zip(&self.natural, |size, all| size.max(SMALLEST_PROJECTED_SHARE * all))
    }
}

/// ∂B u − ∂g over the packed contact rows.
fn approaches<E: Real, const N: usize>(
    model: &TornModel,
    shape: SolvedShape<'_>,
    traces: Option<&TraceChanges<'_>>,
    changes: &[Vec<RowChange>],
) -> Vec<Row<E, N>> {
    let boundary = &model.problem.boundary;
    let mut approaches = vec![Row::ZERO; boundary.row_count];
    let turned = !model.problem.geometry.is_fixed();
    let nodal = turned.then(|| model.contact_displacements(shape.displacement));
    let u = nodal.as_ref().map(|nodal| model.weighted(shape.rows, nodal));
    let traces = traces.zip(nodal.as_ref());
    let moved = |column: usize| traces.map(|(traces, nodal)| traces.moved(column, nodal));
    let moved: Vec<Option<NodeValues>> = (0..changes.len()).map(moved).collect();
    let nodes = boundary.points.iter().zip(&shape.rows.nodes).zip(&model.constraints.normalisation);
    for (index, ((point, rows), nu)) in nodes.enumerate() {
        for (column, change) in changes.iter().map(|nodes| &nodes[index]).enumerate() {
            let values = (u.as_ref(), moved[column].as_ref());
            for (row, approach) in point.rows().zip(row_approaches((point, rows), change, values)) {
                approaches[row].set(column, approach / nu);
            }
        }
    }
    approaches
}

/// The largest residual over its size; NaN if a residual is.
fn largest_share<const N: usize>(residuals: &Row<f64, N>, sizes: &Row<f64, N>) -> f64 {
    residuals.iter().zip(sizes.iter()).fold(0.0, |largest: f64, (residual, size)| {
        let share = if residual == 0.0 { 0.0 } else { residual / size };
        if share.is_nan() || share > largest { share } else { largest }
    })
}
