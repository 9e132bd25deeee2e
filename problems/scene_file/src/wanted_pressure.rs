//! A wanted contact pressure, as a formula or as a grid.

use crate::formula::Formula;
use contact::body::mesh::Grid;
use contact::error::SceneError;
use contact::scene::HeightGrid;

/// The field of a formula.
const FIELD: &str = "objective.wanted.pressure";

/// A wanted contact pressure over the base.
#[derive(Debug, Clone, PartialEq)]
pub enum WantedPressure {
    /// A formula in x1, x2 (mm) that was parsed once, MPa.
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

    /// The pressures at the contact nodes of a grid, in the order of its columns, MPa.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for a formula that is not finite at a node, with the place.
    pub fn at(&self, grid: &Grid) -> Result<Vec<f64>, SceneError> {
        let places = grid.columns().map(|(i, j)| grid.position(i, j));
        match self {
            Self::Grid(values) => Ok(places.map(|[x1, x2]| values.height(x1, x2)).collect()),
            Self::Formula(text) => {
                let formula = Formula::parse(FIELD, text)?;
                places.map(|place| pressure(&formula, place)).collect()
            }
        }
    }
}

fn pressure(formula: &Formula, place @ [x1, x2]: [f64; 2]) -> Result<f64, SceneError> {
    let pressure = formula.value(place);
    match pressure.is_finite() {
        true => Ok(pressure),
        false => {
            let value = format!("{pressure} at x1 = {x1}, x2 = {x2} mm");
            Err(SceneError::out_of_range(FIELD, value, "finite at every contact node"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Result<Vec<f64>, String> {
        let grid = Grid { cells: [1, 2, 1], size: [4.0, 6.0] };
        WantedPressure::formula(text).and_then(|wanted| wanted.at(&grid)).map_err(|error| error.to_string())
    }

    #[test]
    fn a_formula_is_sampled_at_the_contact_nodes() {
        // Nodes (0, 0), (0, 3), (0, 6), (4, 0), (4, 3), (4, 6).
        assert_eq!(at("x2 + 10*x1"), Ok(vec![0.0, 3.0, 6.0, 40.0, 43.0, 46.0]));
    }

    #[test]
    fn everything_else_is_refused_with_field_and_place() {
        for (text, words) in [
            ("sin x1", "\"x1\" at character 5"),
            ("x3", "\"x3\" at character 1"),
            ("1/x1", "inf at x1 = 0, x2 = 0 mm"),
            ("ln(x2 - 4)", "NaN at x1 = 0, x2 = 0 mm"),
            ("1e400", "inf at x1 = 0"),
        ] {
            let refusal = at(text).expect_err(text);
            assert!(refusal.contains(words) && refusal.contains(FIELD), "{text}: {refusal}");
        }
    }
}
