//! A wanted contact pressure, as a formula or as a grid.

use contact::error::SceneError;
use contact::formula::Formula;
use contact::scene::HeightGrid;

/// The field of a formula.
const FIELD: &str = "objective.wanted.pressure";

/// A wanted contact pressure.
#[derive(Debug, Clone, PartialEq)]
pub enum WantedPressure {
    /// A formula in x1, x2, x3 (mm) that was parsed once, MPa.
    Formula(String),
    /// Values on a uniform grid, bilinear in between as heights are, MPa.
    Grid(HeightGrid),
}

impl WantedPressure {
    /// A formula.
    pub(crate) fn formula(text: &str) -> Result<Self, SceneError> {
        Formula::parse(FIELD, text)?;
        Ok(Self::Formula(text.to_owned()))
    }

    /// The pressures at some places, MPa.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a formula that is not finite at a place, with the place.
    pub fn at(&self, places: &[[f64; 3]]) -> Result<Vec<f64>, SceneError> {
        match self {
            Self::Grid(values) => Ok(places.iter().map(|[x1, x2, _]| values.height(*x1, *x2)).collect()),
            Self::Formula(text) => {
                let formula = Formula::parse(FIELD, text)?;
                places.iter().map(|place| pressure(&formula, *place)).collect()
            }
        }
    }
}

fn pressure(formula: &Formula, place @ [x1, x2, x3]: [f64; 3]) -> Result<f64, SceneError> {
    let pressure: f64 = formula.value(place);
    match pressure.is_finite() {
        true => Ok(pressure),
        false => {
            let value = format!("{pressure} at x1 = {x1}, x2 = {x2}, x3 = {x3} mm");
            Err(SceneError::out_of_range(FIELD, value, "finite at every contact node"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Result<Vec<f64>, String> {
        let places = [[0.0, 0.0, 5.0], [0.0, 3.0, 5.0], [4.0, 6.0, 5.0]];
        WantedPressure::formula(text).and_then(|wanted| wanted.at(&places)).map_err(|error| error.to_string())
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
