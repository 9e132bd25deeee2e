//! A wanted contact pressure, as a formula or as a grid.

use contact::body::mesh::Grid;
use contact::error::SceneError;
use contact::scene::HeightGrid;
use exmex::prelude::*;
use exmex::{FloatOpsFactory, MatchLiteral, literal_matcher_from_pattern};

literal_matcher_from_pattern!(DecimalNumber, r"^(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?");

/// A parsed formula, with numbers such as 2.5e-3.
type Expression = FlatEx<f64, FloatOpsFactory<f64>, DecimalNumber>;

/// The names that a formula may use, in the order in which exmex lists them.
const NAMES: [&str; 2] = ["x1", "x2"];
/// Longest formula.
const LONGEST: usize = 1000;
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
        parse(text)?;
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
                let expression = parse(text)?;
                places.map(|place| evaluate(&expression, place)).collect()
            }
        }
    }
}

/// Refuses everything that is no formula in x1 and x2.
fn parse(text: &str) -> Result<Expression, SceneError> {
    let refused = |value: &str, allowed: String| Err(SceneError::out_of_range(FIELD, value, allowed));
    if text.chars().count() > LONGEST {
        return refused("a long text", format!("at most {LONGEST} characters"));
    }
    let Some(explicit) = explicit_signs(text) else {
        return refused(
            &format!("{text:?}"),
            "parentheses around a sign that follows an operator, as in 2*(-x1)".into(),
        );
    };
    let expression = match Expression::parse(&explicit) {
        Ok(expression) => expression,
        Err(error) => return refused(&format!("{text:?}"), format!("a formula in x1, x2; here: {error}")),
    };
    match expression.var_names().iter().find(|name| !NAMES.contains(&name.as_str())) {
        Some(name) => refused(name, format!("the names x1, x2 and those of functions, in {text:?}")),
        None => Ok(expression),
    }
}

/// The formula with 0 before every sign that no term precedes: -x1^2 is −(x1²), where exmex takes a sign before the power. None if a sign
/// follows an operator.
fn explicit_signs(text: &str) -> Option<String> {
    let (mut explicit, mut last) = (String::with_capacity(text.len()), None);
    for character in text.chars() {
        if matches!(character, '-' | '+') {
            match last {
                None | Some('(' | ',') => explicit.push('0'),
                Some('+' | '-' | '*' | '/' | '^' | '%') => return None,
                _ => {}
            }
        }
        explicit.push(character);
        last = if character.is_whitespace() { last } else { Some(character) };
    }
    Some(explicit)
}

fn evaluate(expression: &Expression, [x1, x2]: [f64; 2]) -> Result<f64, SceneError> {
    let values: Vec<f64> = expression.var_names().iter().map(|name| if name == NAMES[0] { x1 } else { x2 }).collect();
    let refused = |value: String| {
        SceneError::out_of_range(FIELD, format!("{value} at x1 = {x1}, x2 = {x2} mm"), "finite at every contact node")
    };
    match expression.eval(&values) {
        Ok(pressure) if pressure.is_finite() => Ok(pressure),
        Ok(pressure) => Err(refused(pressure.to_string())),
        Err(error) => Err(refused(error.to_string())),
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
    fn formulas_are_those_of_arithmetic() {
        // Nodes (0, 0), (0, 3), (0, 6), (4, 0), (4, 3), (4, 6).
        for (text, expected) in [
            ("7", [7.0; 6]),
            ("x2 + 10*x1", [0.0, 3.0, 6.0, 40.0, 43.0, 46.0]),
            ("-x1^2/2 + 2^3", [8.0, 8.0, 8.0, 0.0, 0.0, 0.0]),
            ("2 + ( - x1^2) + max(-x1^2, -8) + 2*(-x1)^2 - 1e-3", [1.999, 1.999, 1.999, 9.999, 9.999, 9.999]),
            ("(x2 - 3)*(x2 - 3) - x1*(1 + 1)", [9.0, 0.0, 9.0, 1.0, -8.0, 1.0]),
            ("sqrt(abs(x2 - 3)*3)", [3.0, 0.0, 3.0, 3.0, 0.0, 3.0]),
            ("max(x1, x2)", [0.0, 3.0, 6.0, 4.0, 4.0, 6.0]),
            ("2*cos(PI*x1/4)", [2.0, 2.0, 2.0, -2.0, -2.0, -2.0]),
        ] {
            let found = at(text).expect(text);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-13), "{text}: {found:?}");
        }
    }

    #[test]
    fn everything_else_is_refused_with_the_place() {
        for (text, words) in [
            ("", "formula in x1, x2"),
            ("x1 +", "formula in x1, x2"),
            ("2 x1 3", "formula in x1, x2"),
            ("(x1", "formula in x1, x2"),
            ("2*-x1", "parentheses around a sign"),
            ("x1 - -x2^2", "parentheses around a sign"),
            ("x3", "pressure = x3 is not allowed"),
            ("x1 + height", "height is not allowed"),
            ("1/x1", "inf at x1 = 0, x2 = 0 mm"),
            ("ln(x2 - 4)", "NaN at x1 = 0, x2 = 0 mm"),
            ("1e400", "inf at x1 = 0"),
        ] {
            let refusal = at(text).expect_err(text);
            assert!(refusal.contains(words) && refusal.contains(FIELD), "{text}: {refusal}");
        }
        assert!(at(&"x1+".repeat(400)).expect_err("too long").contains("at most 1000"));
    }

    #[test]
    fn deep_nesting_and_odd_texts_do_not_end_the_program() {
        for text in [
            "(".repeat(500) + "x1" + &")".repeat(499),
            "-".repeat(999) + "1",
            "{x1}".into(),
            "x1 π τ".into(),
            "é".repeat(30),
            "sin".repeat(300),
            "1..2".into(),
            "max(1)".into(),
            ",".into(),
            "\u{0}".into(),
        ] {
            let _ = at(&text);
        }
    }
}
