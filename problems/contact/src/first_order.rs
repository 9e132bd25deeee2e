//! What first derivatives say of shapes near one: h(c + C a) for Θ, the largest linearization for every limit.

use crate::contact_objective::ContactObjective;
use crate::load_cases::{Bound, CaseStates};
use nonsmooth::composite::{Linearization, OuterFunction};
use nonsmooth::{Accuracy, Matrix, OracleError, OutputJacobian, Vector};
use std::ops::Range;

/// Θ, its cases and the limited quantities of a shape, as functions of a change a of the controls. Θ is the cost of
/// linear outputs: of linear pressures where it is a function of pressures. A limited extreme value is that of linear
/// pressures, or of linear values at the points near the extreme one.
#[derive(Debug)]
pub struct FirstOrderModel<'o> {
    objective: &'o ContactObjective,
    outputs: Vector,
    jacobian: Matrix,
    limits: Vec<LimitModel>,
}

/// A limited quantity.
#[derive(Debug)]
enum LimitModel {
    /// The largest of the outputs that are the pressures of a case.
    Peak(Range<usize>),
    /// Values with gradients; `least`: the least of them counts, else the largest.
    Pieces { pieces: Vec<(f64, Vector)>, least: bool },
}

/// First derivatives along a change of the controls.
#[derive(Debug, Clone)]
pub struct Slope {
    outputs: Vector,
    limits: Vec<Vec<f64>>,
}

/// What the model says of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// Θ.
    pub value: f64,
    /// w_k J_k of every case.
    pub weighted: Vec<f64>,
    /// The limited quantities, in the order of [`ContactObjective::limits`].
    pub limits: Vec<f64>,
}

impl ContactObjective {
    /// The first-order model at states already found.
    ///
    /// # Errors
    /// [`OracleError`] of the linearized problems.
    pub fn first_order(&self, control: &Vector, states: &CaseStates) -> Result<FirstOrderModel<'_>, OracleError> {
        // The linearization first: it keeps the forward derivatives that limits take.
        let Linearization { outputs, jacobian, .. } = self.cases().linearize(control, states, Accuracy::TIGHTEST)?;
        let limit = |bound: &Bound| {
            if bound.limit.quantity.is_peak() {
                return Ok(LimitModel::Peak(self.cost().pressure_range(bound.case)));
            }
            let pieces = bound.quantity_pieces(self.cases(), control, states)?;
            let least = bound.limit.sign() < 0.0;
            Ok(LimitModel::Pieces { pieces, least })
        };
        let limits = self.bounds().iter().map(limit).collect::<Result<_, OracleError>>()?;
        Ok(FirstOrderModel { objective: self, outputs, jacobian, limits })
    }
}

impl FirstOrderModel<'_> {
    /// The derivatives along a change of the controls.
    pub fn slope(&self, change: &Vector) -> Slope {
        let limit = |limit: &LimitModel| match limit {
            LimitModel::Peak(_) => Vec::new(),
            LimitModel::Pieces { pieces, .. } => pieces.iter().map(|(_, gradient)| gradient.dot(change)).collect(),
        };
        Slope { outputs: &self.jacobian * change, limits: self.limits.iter().map(limit).collect() }
    }

    /// The shape changed by so many times the change of a slope.
    pub fn at(&self, slope: &Slope, times: f64) -> Predicted {
        let outputs = &self.outputs + &slope.outputs * times;
        let limit = |(limit, slopes): (&LimitModel, &Vec<f64>)| match limit {
            LimitModel::Peak(range) => outputs.rows(range.start, range.len()).max(),
            LimitModel::Pieces { pieces, least } => {
                let values = pieces.iter().zip(slopes).map(|((value, _), slope)| value + times * slope);
                values.reduce(if *least { f64::min } else { f64::max }).unwrap_or(f64::NAN)
            }
        };
        Predicted {
            value: self.objective.cost().value(&outputs),
            weighted: self.objective.cost().weighted(&outputs),
            limits: self.limits.iter().zip(&slope.limits).map(limit).collect(),
        }
    }
}
