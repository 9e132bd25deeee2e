//! Objective, cases and limits over random shapes: values by first derivatives, order by how bad they are, amplitudes
//! that are allowed.

use crate::commands::limited_value::LimitedValue;
use crate::commands::numbers::raised;
use crate::commands::solved_shape::ContactObjective;
use crate::commands::tolerance::form_error::{Allowed, LARGEST_TIMES, LOSS, MEANINGLESS_MODEL_ERROR, Row, SHARE};
use contact::cost::{Limit, LimitSide};
use contact::load_cases::CaseStates;
use contact::{FirstOrderModel, Predicted};
use nonsmooth::Vector;
use rayon::prelude::*;

/// Halvings in the search for an allowed amplitude: a millionth of the largest.
const HALVINGS: usize = 20;

/// A quantity that a row tells of.
enum Measured<'o> {
    Objective,
    /// The root of Θ that is a pressure.
    Root,
    Case(usize),
    Limit(usize, &'o Limit),
}

/// The rows of a table.
pub struct Measures<'o> {
    objective: &'o ContactObjective,
    all: Vec<Measured<'o>>,
    nominal: Vec<f64>,
}

/// The shapes that the model rates.
pub struct Rated {
    /// Values by shape and row.
    values: Vec<Vec<f64>>,
    /// Multiples of the amplitude that shapes allow, by shape and row; infinite for what is only told.
    times: Vec<Vec<f64>>,
}

impl<'o> Measures<'o> {
    /// The rows of an objective at a shape.
    pub fn new(objective: &'o ContactObjective, control: &Vector, states: &CaseStates) -> Self {
        let cases = objective.cases().count();
        let mut all = vec![Measured::Objective];
        all.extend(objective.pressure_root(0.0).map(|_| Measured::Root));
        all.extend((0..cases).filter(|_| cases > 1).map(Measured::Case));
        all.extend(objective.limits().enumerate().map(|(index, limit)| Measured::Limit(index, limit)));
        let mut measures = Self { objective, all, nominal: Vec::new() };
        measures.nominal = measures.of_states(control, states);
        measures
    }

    /// The values of a shape that was solved.
    pub fn of_states(&self, control: &Vector, states: &CaseStates) -> Vec<f64> {
        self.values(&Predicted {
            value: self.objective.value(states),
            weighted: self.objective.weighted_values(states),
            limits: self.objective.limited_values(control, states),
        })
    }

    fn values(&self, of: &Predicted) -> Vec<f64> {
        let value = |measured: &Measured<'_>| match measured {
            Measured::Objective => of.value,
            Measured::Root => self.objective.pressure_root(of.value).map_or(f64::NAN, |root| root.value),
            Measured::Case(case) => of.weighted[*case],
            Measured::Limit(index, _) => of.limits[*index],
        };
        self.all.iter().map(value).collect()
    }

    /// How bad a value of a row is.
    fn badness(&self, row: usize, value: f64) -> f64 {
        match &self.all[row] {
            Measured::Limit(_, Limit { side: LimitSide::AtLeast, .. }) => -value,
            Measured::Limit(_, Limit { side: LimitSide::Equal, bound, .. }) => (value - bound).abs(),
            _ => value,
        }
    }

    /// Whether a row decides what is allowed: limits of states, and the objective or its root.
    fn decides(&self, row: usize) -> bool {
        match &self.all[row] {
            Measured::Objective => !self.all.iter().any(|other| matches!(other, Measured::Root)),
            // Volume, mass and equations are conditions of the optimization: no shape that is made keeps them exactly.
            Measured::Limit(_, limit) => limit.side != LimitSide::Equal && !limit.quantity.is_of_shape(),
            Measured::Root => true,
            Measured::Case(_) => false,
        }
    }

    fn is_allowed(&self, row: usize, value: f64) -> bool {
        match &self.all[row] {
            Measured::Limit(_, limit) => limit.excess(value) == 0.0,
            _ => value <= self.nominal[row] + LOSS * self.nominal[row].abs(),
        }
    }

    /// Rates random shapes.
    pub fn rate(&self, model: &FirstOrderModel<'_>, shapes: &[Vector]) -> Rated {
        let rated = |change: &Vector| {
            let slope = model.slope(change);
            let at = |times: f64| self.values(&model.at(&slope, times));
            let largest = at(LARGEST_TIMES);
            let times = |row: usize| match (self.decides(row), self.is_allowed(row, self.nominal[row])) {
                (false, _) => f64::INFINITY,
                (true, false) => 0.0,
                (true, true) if self.is_allowed(row, largest[row]) => LARGEST_TIMES,
                (true, true) => {
                    let (mut within, mut beyond) = (0.0, LARGEST_TIMES);
                    for _halving in 0..HALVINGS {
                        let middle = 0.5 * (within + beyond);
                        let side = if self.is_allowed(row, at(middle)[row]) { &mut within } else { &mut beyond };
                        *side = middle;
                    }
                    within
                }
            };
            (at(1.0), (0..self.all.len()).map(times).collect())
        };
        let (values, times) = shapes.par_iter().map(rated).unzip();
        Rated { values, times }
    }

    /// The shapes that are solved: those that are worst by one of the rows that decide, row by row in turn, up to half
    /// of them; then the first of the others.
    pub fn chosen(&self, rated: &Rated, count: usize) -> Vec<usize> {
        let orders: Vec<Vec<usize>> =
            (0..self.all.len()).filter(|&row| self.decides(row)).map(|row| self.order(rated, row)).collect();
        let shapes = rated.values.len();
        let worst = (0..shapes).flat_map(|rank| orders.iter().map(move |order| order[shapes - 1 - rank]));
        let mut chosen = Vec::new();
        for (shape, most) in worst.map(|shape| (shape, count / 2)).chain((0..shapes).map(|shape| (shape, count))) {
            if chosen.len() < most && !chosen.contains(&shape) {
                chosen.push(shape);
            }
        }
        chosen
    }

    /// The shapes by a row, the best first.
    fn order(&self, rated: &Rated, row: usize) -> Vec<usize> {
        let badness = |shape: &usize| self.badness(row, rated.values[*shape][row]);
        let mut order: Vec<usize> = (0..rated.values.len()).collect();
        order.sort_by(|a, b| badness(a).total_cmp(&badness(b)));
        order
    }

    /// The rows; `states`: values of shapes that were solved, by their numbers.
    pub fn rows(&self, rated: &Rated, amplitude: f64, states: &[(usize, Vec<f64>)]) -> Vec<Row> {
        let count = rated.values.len();
        let rank = |share: f64| ((share * count as f64).ceil() as usize).clamp(1, count) - 1;
        let row = |(row, measured): (usize, &Measured<'_>)| {
            let order = self.order(rated, row);
            let at = |rank: usize| rated.values[order[rank]][row];
            let (quantity, unit, limit) = self.names(measured);
            let kept = |limit: &Limit| {
                let kept = rated.values.iter().filter(|values| limit.excess(values[row]) == 0.0);
                kept.count() as f64 / count as f64
            };
            let solved = states.iter().map(|(_, values)| values[row]);
            let change = solved.clone().map(|value| (value - self.nominal[row]).abs()).fold(0.0, f64::max);
            let differences = states.iter().map(|(shape, values)| (rated.values[*shape][row] - values[row]).abs());
            let difference = differences.fold(0.0, f64::max);
            let worst_state = solved.reduce(|a, b| if self.badness(row, b) > self.badness(row, a) { b } else { a });
            let model_error = (change > 0.0).then_some(difference / change);
            let is_known = model_error.is_none_or(|error| error <= MEANINGLESS_MODEL_ERROR);
            Row {
                quantity,
                unit,
                nominal: self.nominal[row],
                median: at(rank(0.5)),
                percentile_95: at(rank(SHARE)),
                worst: at(count - 1),
                kept: limit.filter(|limit| limit.side != LimitSide::Equal).map(kept),
                decides: self.decides(row),
                allowed: (self.decides(row) && is_known)
                    .then(|| allowed(rated.times.iter().map(|times| times[row]), amplitude)),
                worst_state: worst_state.unwrap_or(self.nominal[row]),
                model_error,
            }
        };
        self.all.iter().enumerate().map(row).collect()
    }

    /// Name, unit and limit of a row.
    fn names<'m>(&self, measured: &Measured<'m>) -> (String, String, Option<&'m Limit>) {
        let unit = raised(&self.objective.unit());
        match measured {
            Measured::Objective => ("objective Θ".into(), unit, None),
            Measured::Root => {
                let name = self.objective.pressure_root(0.0).map_or_else(String::new, |root| raised(&root.name));
                (name, "MPa".into(), None)
            }
            Measured::Case(case) => (format!("{}: measure", self.objective.cases().name(*case)), unit, None),
            Measured::Limit(_, limit) => {
                let words = LimitedValue { limit: Limit::clone(limit), value: limit.bound }.words();
                (format!("limit: {words}"), String::new(), Some(limit))
            }
        }
    }
}

impl Rated {
    /// What 95 % of the shapes allow in all rows.
    pub fn allowed(&self, amplitude: f64) -> Allowed {
        allowed(self.times.iter().map(|times| times.iter().copied().fold(f64::INFINITY, f64::min)), amplitude)
    }
}

/// The amplitude that 95 % of some shapes allow, from the multiples that each allows.
fn allowed(times: impl Iterator<Item = f64>, amplitude: f64) -> Allowed {
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    // So many may allow less.
    let less = ((1.0 - SHARE) * times.len() as f64 + 1e-9).floor() as usize;
    let found = times.get(less).copied().unwrap_or(0.0);
    Allowed { amplitude: found * amplitude, or_more: found >= LARGEST_TIMES }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_of_a_hundred_shapes_may_allow_less() {
        let times = |zeros: usize| (0..100).map(move |shape| if shape < zeros { 0.0 } else { 2.0 });
        let found = [0, 5, 6].map(|zeros| allowed(times(zeros), 0.5).amplitude);
        assert_eq!(found, [1.0, 1.0, 0.0]);
        assert!(allowed([LARGEST_TIMES; 20].into_iter(), 1.0).or_more && !allowed(times(0), 1.0).or_more);
    }
}
