//! The objective of all cases as a function of their outputs, with the limits that are functions of the pressures.

use crate::cost::{Limit, LimitSide, PressureCost, PressureOutputs, Quantity, ShapeFunction, StateCost};
use crate::equilibrium::ContactProblem;
use crate::error::SceneError;
use crate::load_cases::{Over, WeightedCase};
use crate::shape::lattice_bending_rows;
use nonsmooth::composite::{OuterFunction, OuterPart, OutputPiece};
use nonsmooth::{ConstraintKind, Matrix, Vector};
use std::ops::Range;

/// Pressures over the bound, or over the largest pressure where that is less, from which nodes are pieces of the
/// limited peak: a step of the optimizer may make any of them the largest, and takes load from all that are beyond the
/// bound.
const NEAR_PEAK: f64 = 0.5;

/// What is minimised of one case.
#[derive(Debug, Clone)]
pub enum CaseCost {
    /// Of the contact pressures, normalised where it may lie outside the range of doubles.
    Pressure(PressureCost),
    /// Another function of the state, an output of its own.
    State(Box<StateCost>),
    /// A function of the shape, the same in all cases.
    Shape(ShapeFunction),
}

impl CaseCost {
    /// A quantity as an objective on the mesh of a problem.
    fn new(quantity: &Quantity, problem: &ContactProblem) -> Result<Self, SceneError> {
        const PLACE: &str = "objective";
        quantity.check_differentiable("objective.quantity")?;
        if let Quantity::Pressure(measure) = quantity {
            return Ok(Self::Pressure(PressureCost::new(measure.clone(), problem)?));
        }
        if let Some(shape) = ShapeFunction::new(PLACE, quantity, problem)? {
            return Ok(Self::Shape(shape));
        }
        match StateCost::new(PLACE, quantity, problem)? {
            Some(state) => Ok(Self::State(Box::new(state))),
            None => {
                Err(SceneError::out_of_range("objective.quantity", quantity.name(), "a quantity of states or shapes"))
            }
        }
    }
}

/// A case among the outputs.
#[derive(Debug, Clone)]
struct Part {
    weight: f64,
    cost: CaseCost,
    /// The outputs of the measure, and the pressures.
    own: Range<usize>,
    pressures: Range<usize>,
    outputs: Option<PressureOutputs>,
}

/// A limit of the largest pressure of one case.
#[derive(Debug, Clone)]
struct PeakLimit {
    part: usize,
    limit: Limit,
}

/// h of the outputs of all cases: max w_k J_k or Σ w_k J_k, or a function of the shape; with the peak pressures that
/// are limited as its nonlinear constraints.
#[derive(Debug, Clone)]
pub struct CasesCost {
    over: Over,
    parts: Vec<Part>,
    /// What is minimised.
    quantity: Quantity,
    /// The output that is a function of the shape, where that is the objective.
    of_shape: Option<usize>,
    limits: Vec<PeakLimit>,
    kinds: Vec<ConstraintKind>,
    /// The first of the outputs r = √w R α whose squares add the bending of the surface, and √w R.
    fairness: Option<(usize, Matrix)>,
}

impl CasesCost {
    /// The cost of some cases; of the limits, it takes those of the peak pressure. A limit of no case holds for all.
    ///
    /// # Errors
    /// [`SceneError`] as [`PressureCost::new`] and [`StateCost::new`]; [`SceneError::OutOfRange`] for weights and
    /// bounds that are not finite and > 0, for a quantity that jumps, and without a case.
    pub fn new(cases: &[WeightedCase<'_>], over: Over, limits: &[Limit]) -> Result<Self, SceneError> {
        let costs = normalised(cases)?;
        let names: Vec<&str> = cases.iter().map(|case| case.name).collect();
        let limits = Limit::of_cases(limits, &names)?.into_iter();
        let peaks = limits.filter(|(limit, _)| limit.quantity.is_peak());
        let peak = |(limit, part): (Limit, usize)| {
            limit.kind()?;
            Ok(PeakLimit { part, limit })
        };
        let peaks = peaks.map(peak).collect::<Result<Vec<_>, SceneError>>()?;
        let (mut parts, mut next) = (Vec::new(), 0);
        for (index, (case, cost)) in cases.iter().zip(costs).enumerate() {
            let valid = case.weight > 0.0 && case.weight.is_finite();
            SceneError::require(valid, "case.weight", case.weight, "a finite number > 0")?;
            let is_limited = peaks.iter().any(|limit: &PeakLimit| limit.part == index);
            let part = Part::new((case.weight, cost), next, case.problem.boundary.contact_points().len(), is_limited);
            next = part.own.end.max(part.pressures.end);
            parts.push(part);
        }
        let fairness = fairness(cases)?;
        let of_shape = parts.iter().any(|part| matches!(part.cost, CaseCost::Shape(_)));
        let kinds = vec![ConstraintKind::Nonsmooth; peaks.len()];
        let fairness = fairness.map(|rows| (next + usize::from(of_shape), rows));
        let Some(first) = cases.first() else {
            return Err(SceneError::out_of_range("case", "none", "at least one load case"));
        };
        let (quantity, of_shape) = (first.quantity.clone(), of_shape.then_some(next));
        Ok(Self { over, parts, quantity, of_shape, limits: peaks, kinds, fairness })
    }

    /// The outputs of the pressures of a case; none where neither objective nor limits depend on them.
    pub(super) fn pressures(&self, case: usize) -> Option<PressureOutputs> {
        self.parts[case].outputs.clone()
    }

    /// What is minimised of a case.
    pub fn case(&self, case: usize) -> &CaseCost {
        &self.parts[case].cost
    }

    /// What is minimised.
    pub fn quantity(&self) -> &Quantity {
        &self.quantity
    }

    /// The function of the shape that is minimised, if one is.
    pub(super) fn of_shape(&self) -> Option<&ShapeFunction> {
        match &self.parts.first()?.cost {
            CaseCost::Shape(shape) => Some(shape),
            CaseCost::Pressure(_) | CaseCost::State(_) => None,
        }
    }

    /// √w R of the bending w|Rα|² that is added to Θ, if it is.
    pub(crate) fn fairness(&self) -> Option<&Matrix> {
        self.fairness.as_ref().map(|(_, rows)| rows)
    }

    /// What the bending adds to Θ, with its gradient.
    fn bending(&self, outputs: &Vector) -> (f64, Vector) {
        let mut gradient = Vector::zeros(outputs.len());
        let Some((first, rows)) = &self.fairness else { return (0.0, gradient) };
        let own = outputs.rows(*first, rows.nrows());
        gradient.rows_mut(*first, rows.nrows()).copy_from(&(own * 2.0));
        (own.norm_squared(), gradient)
    }

    /// The curvature of a function without the bending, with it.
    fn bent(&self, curvature: Matrix, jacobian: &Matrix) -> Matrix {
        let Some((first, rows)) = &self.fairness else { return curvature };
        let own = jacobian.rows(*first, rows.nrows());
        curvature + own.tr_mul(&own) * 2.0
    }

    /// How the cases are rated together.
    pub fn over(&self) -> Over {
        self.over
    }

    /// w_k J_k of every case at some outputs.
    pub fn weighted(&self, outputs: &Vector) -> Vec<f64> {
        self.parts.iter().map(|part| part.weight * self.value_of(part, outputs)).collect()
    }

    /// The weight w_k of a case.
    pub fn weight(&self, case: usize) -> f64 {
        self.parts[case].weight
    }

    /// What a change of every output is compared with: the largest pressure of its case, or its own size; none for the
    /// bending, which is no state.
    pub fn sizes(&self, outputs: &Vector) -> Vec<Option<f64>> {
        let mut sizes: Vec<Option<f64>> = outputs.iter().map(|output| Some(output.abs())).collect();
        for part in self.parts.iter().filter(|part| part.outputs.is_some()) {
            let ranges = if part.own.len() > 1 { [&part.own, &part.pressures] } else { [&part.pressures; 2] };
            for range in ranges {
                sizes[range.clone()].fill(Some(outputs.rows(range.start, range.len()).amax()));
            }
        }
        if let Some((first, _)) = self.fairness {
            sizes[first..].fill(None);
        }
        sizes
    }

    /// Numbers of the outputs that are the pressures of a case; none where they are no outputs.
    pub fn pressure_range(&self, case: usize) -> Range<usize> {
        self.parts[case].pressures.clone()
    }

    fn value_of(&self, part: &Part, outputs: &Vector) -> f64 {
        match (&part.cost, self.of_shape) {
            (CaseCost::Pressure(cost), _) => cost.value(&slice(outputs, &part.own)),
            (CaseCost::State(_), _) => outputs[part.own.start],
            (CaseCost::Shape(_), place) => place.map_or(f64::NAN, |place| outputs[place]),
        }
    }

    /// A subgradient of the sum of the weighted measures of some cases.
    fn gradient_of(&self, outputs: &Vector, counts: impl Fn(usize) -> bool) -> Vector {
        let mut gradient = Vector::zeros(outputs.len());
        for (_, part) in self.parts.iter().enumerate().filter(|(index, _)| counts(*index)) {
            let own = match &part.cost {
                CaseCost::Pressure(cost) => cost.subgradient(&slice(outputs, &part.own)) * part.weight,
                CaseCost::State(_) | CaseCost::Shape(_) => Vector::from_element(part.own.len(), part.weight),
            };
            gradient.rows_mut(part.own.start, part.own.len()).copy_from(&own);
        }
        gradient
    }

    /// The curvature of the measure of a case, if it has one.
    fn curvature_of(&self, part: &Part, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        let CaseCost::Pressure(cost) = &part.cost else { return None };
        let rows = jacobian.rows(part.own.start, part.own.len()).into_owned();
        cost.curvature(&slice(outputs, &part.own), &rows)
    }

    /// The case that a subgradient of one part belongs to; none for one that is zero in all cases.
    pub fn case_of(&self, subgradient: &Vector) -> Option<usize> {
        let moves = |part: &Part| slice(subgradient, &part.own).iter().any(|entry| *entry != 0.0);
        self.parts.iter().position(moves)
    }

    /// The first of the worst cases.
    pub fn worst(&self, outputs: &Vector) -> usize {
        let values = self.weighted(outputs);
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        values.iter().position(|value| *value == largest).unwrap_or(0)
    }
}

impl Part {
    /// A case whose outputs begin at `first`.
    fn new((weight, cost): (f64, CaseCost), first: usize, nodes: usize, is_limited: bool) -> Self {
        let at = |count: usize| first..first + count;
        let (own, pressures, outputs) = match &cost {
            CaseCost::Pressure(pressure) => {
                let outputs = pressure.outputs(is_limited);
                let end = first + outputs.count(nodes);
                (at(nodes), end - nodes..end, Some(outputs))
            }
            CaseCost::State(_) if is_limited => {
                (first + nodes..first + nodes + 1, at(nodes), Some(PressureOutputs::default()))
            }
            CaseCost::State(_) => (at(1), at(0), None),
            CaseCost::Shape(_) if is_limited => (at(0), at(nodes), Some(PressureOutputs::default())),
            CaseCost::Shape(_) => (at(0), at(0), None),
        };
        Self { weight, cost, own, pressures, outputs }
    }
}

/// √w R of the shapes that the cases share, where their bending counts.
fn fairness(cases: &[WeightedCase<'_>]) -> Result<Option<Matrix>, SceneError> {
    let Some(scene) = cases.first().map(|case| &case.problem.scene) else { return Ok(None) };
    let (mut parts, mut first) = (Vec::new(), 0);
    for body in &scene.bodies {
        if let Some(shape) = body.shape.as_ref().filter(|own| own.fairness != 0.0) {
            let (weight, allowed) = (shape.fairness, "a finite number ≥ 0 (unit of the objective)");
            SceneError::require(weight > 0.0 && weight.is_finite(), "lattice.fairness", weight, allowed)?;
            parts.push((first, lattice_bending_rows(shape, body.start_block().as_ref())? * weight.sqrt()));
        }
        first += body.control_count();
    }
    if parts.is_empty() {
        return Ok(None);
    }
    let mut all = Matrix::zeros(parts.iter().map(|(_, rows)| rows.nrows()).sum(), first);
    let mut row = 0;
    for (column, rows) in &parts {
        all.view_mut((row, *column), rows.shape()).copy_from(rows);
        row += rows.nrows();
    }
    Ok(Some(all))
}

/// The costs of all cases; norms are roots in all cases if they have to be in one.
fn normalised(cases: &[WeightedCase<'_>]) -> Result<Vec<CaseCost>, SceneError> {
    let cost = |case: &WeightedCase<'_>| CaseCost::new(&case.quantity, case.problem);
    let costs = cases.iter().map(cost).collect::<Result<Vec<_>, SceneError>>()?;
    let leaves = |(cost, case): (&CaseCost, &WeightedCase<'_>)| match cost {
        CaseCost::Pressure(cost) => cost.may_leave_doubles(case.problem),
        CaseCost::State(_) | CaseCost::Shape(_) => false,
    };
    if !costs.iter().zip(cases).any(leaves) {
        return Ok(costs);
    }
    let rooted = |cost| match cost {
        CaseCost::Pressure(cost) => CaseCost::Pressure(cost.rooted()),
        other => other,
    };
    Ok(costs.into_iter().map(rooted).collect())
}

fn slice(outputs: &Vector, range: &Range<usize>) -> Vector {
    outputs.rows(range.start, range.len()).into_owned()
}

impl OuterFunction for CasesCost {
    fn value(&self, outputs: &Vector) -> f64 {
        let bending = self.bending(outputs).0;
        if let Some(place) = self.of_shape {
            return outputs[place] + bending;
        }
        let values = self.weighted(outputs);
        bending
            + match self.over {
                Over::Sum => values.iter().sum(),
                // What is no number stays, to be refused.
                Over::Worst => values
                    .into_iter()
                    .fold(f64::NEG_INFINITY, |most, next| if most.is_nan() || most > next { most } else { next }),
            }
    }

    fn subgradient(&self, outputs: &Vector) -> Vector {
        let mut bending = self.bending(outputs).1;
        if let Some(place) = self.of_shape {
            bending[place] = 1.0;
            return bending;
        }
        let only = (self.over == Over::Worst).then(|| self.worst(outputs));
        self.gradient_of(outputs, |case| only.is_none_or(|only| only == case)) + bending
    }

    /// Σ w_k times the curvature of the measures; none for the worst of several cases, which has kinks, and where a
    /// measure has none.
    fn curvature(&self, outputs: &Vector, jacobian: &Matrix) -> Option<Matrix> {
        if self.over == Over::Worst && self.parts.len() > 1 {
            return None;
        }
        let mut sum = Matrix::zeros(jacobian.ncols(), jacobian.ncols());
        for part in &self.parts {
            let own = self.curvature_of(part, outputs, jacobian)?;
            if self.parts.len() == 1 && part.weight == 1.0 {
                return Some(self.bent(own, jacobian));
            }
            sum += own * part.weight;
        }
        Some(self.bent(sum, jacobian))
    }

    /// The weighted measures of the cases, where the worst of several counts and all are smooth.
    fn parts(&self, outputs: &Vector) -> Vec<OuterPart> {
        if self.over == Over::Sum || self.parts.len() == 1 || self.of_shape.is_some() {
            return vec![];
        }
        let (bending, slope) = self.bending(outputs);
        let part = |(index, part): (usize, &Part)| OuterPart {
            value: part.weight * self.value_of(part, outputs) + bending,
            gradient: self.gradient_of(outputs, |case| case == index) + &slope,
        };
        self.parts.iter().enumerate().map(part).collect()
    }

    fn parts_curvature(&self, outputs: &Vector, jacobian: &Matrix, weights: &[f64]) -> Option<Matrix> {
        let mut sum = Matrix::zeros(jacobian.ncols(), jacobian.ncols());
        for (part, weight) in self.parts.iter().zip(weights) {
            sum += self.curvature_of(part, outputs, jacobian)? * (part.weight * weight);
        }
        Some(self.bent(sum, jacobian))
    }

    fn constraint_kinds(&self) -> &[ConstraintKind] {
        &self.kinds
    }

    /// ±(σ_i − bound) for the nodes near the peak, or at the peak alone where it must be at least the bound, MPa.
    fn constraint_pieces(&self, outputs: &Vector) -> Vec<OutputPiece> {
        let unit = |index: usize, sign: f64| {
            let mut weights = Vector::zeros(outputs.len());
            weights[index] = sign;
            weights
        };
        let mut pieces = Vec::new();
        for (constraint, PeakLimit { part, limit }) in self.limits.iter().enumerate() {
            let range = self.parts[*part].pressures.clone();
            let pressures = outputs.rows(range.start, range.len());
            let peak = pressures.max();
            if limit.side == LimitSide::AtLeast {
                let index = range.start + pressures.imax();
                pieces.push(OutputPiece { constraint, value: limit.constraint(peak), weights: unit(index, -1.0) });
                continue;
            }
            let nodes = pressures.iter().enumerate();
            let least = NEAR_PEAK * peak.min(limit.bound);
            let near = nodes.filter(|(_, pressure)| **pressure == peak || **pressure >= least);
            pieces.extend(near.map(|(index, pressure)| OutputPiece {
                constraint,
                value: limit.constraint(*pressure),
                weights: unit(range.start + index, 1.0),
            }));
        }
        pieces
    }
}
