//! A wanted contact pressure: a formula, a grid, or numbers.

use crate::equilibrium::ContactProblem;
use crate::error::SceneError;
use crate::formula::Formula;
use crate::scene::HeightGrid;

/// A wanted contact pressure.
#[derive(Debug, Clone, PartialEq)]
pub enum WantedPressure {
    /// A formula in x1, x2, x3 (mm) that was parsed once, MPa.
    Formula(String),
    /// Values on a uniform grid, bilinear in between as heights are, MPa.
    Grid(HeightGrid),
    /// One pressure per contact node, MPa, in the order of
    /// [`ContactBoundary::points`](crate::equilibrium::ContactBoundary::points).
    AtNodes(Vec<f64>),
}

impl WantedPressure {
    /// A formula; `field`: what messages call it.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] with the character that is not understood.
    pub fn formula(field: &str, text: &str) -> Result<Self, SceneError> {
        Formula::parse(field, text)?;
        Ok(Self::Formula(text.to_owned()))
    }

    /// The pressures at the contact nodes of a problem at the start, MPa.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub(super) fn at_nodes(&self, place: &str, problem: &ContactProblem) -> Result<Vec<f64>, SceneError> {
        let positions = problem.start_positions();
        let points = problem.boundary.contact_points().iter();
        self.at(
            &format!("{place}.wanted.pressure"),
            &points.map(|point| positions[point.body][point.node as usize]).collect::<Vec<_>>(),
        )
    }

    /// The pressures at some places, MPa; `field`: what messages call a formula.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a formula that is not finite at a place, with the place; for pressures that are
    /// not finite; [`SceneError::WrongCount`] unless there is one pressure per place.
    pub fn at(&self, field: &str, places: &[[f64; 3]]) -> Result<Vec<f64>, SceneError> {
        match self {
            Self::AtNodes(values) => {
                let (expected, found) = (places.len(), values.len());
                if expected != found {
                    return Err(SceneError::WrongCount { what: "wanted pressures".into(), expected, found });
                }
                match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                    Some((index, value)) => {
                        let allowed = "finite numbers (MPa)";
                        Err(SceneError::out_of_range(format!("wanted pressure {index}"), value, allowed))
                    }
                    None => Ok(values.clone()),
                }
            }
            Self::Grid(values) => Ok(places.iter().map(|[x1, x2, _]| values.height(*x1, *x2)).collect()),
            Self::Formula(text) => {
                let formula = Formula::parse(field, text)?;
                places.iter().map(|place| pressure(field, &formula, *place)).collect()
            }
        }
    }
}

fn pressure(field: &str, formula: &Formula, place @ [x1, x2, x3]: [f64; 3]) -> Result<f64, SceneError> {
    let pressure: f64 = formula.value(place);
    match pressure.is_finite() {
        true => Ok(pressure),
        false => {
            let value = format!("{pressure} at x1 = {x1}, x2 = {x2}, x3 = {x3} mm");
            Err(SceneError::out_of_range(field, value, "finite at every contact node"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: &str = "objective.wanted.pressure";

    fn at(text: &str) -> Result<Vec<f64>, String> {
        let places = [[0.0, 0.0, 5.0], [0.0, 3.0, 5.0], [4.0, 6.0, 5.0]];
        WantedPressure::formula(FIELD, text)
            .and_then(|wanted| wanted.at(FIELD, &places))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn a_formula_is_sampled_at_the_contact_nodes() {
        assert_eq!(at("x2 + 10*x1 + 100*x3"), Ok(vec![500.0, 503.0, 546.0]));
    }

    #[test]
    fn everything_else_is_refused_with_field_and_place() {
        for (text, words) in [
            ("sin x1", "\"x1\" at character 5"),
            ("x4", "\"x4\" at character 1"),
            ("1/x1", "inf at x1 = 0, x2 = 0, x3 = 5 mm"),
            ("ln(x2 - 4)", "NaN at x1 = 0, x2 = 0, x3 = 5 mm"),
            ("1e400", "inf at x1 = 0"),
        ] {
            let refusal = at(text).expect_err(text);
            assert!(refusal.contains(words) && refusal.contains(FIELD), "{text}: {refusal}");
        }
    }
}
