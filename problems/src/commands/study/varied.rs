//! What a study varies: options and their values.

use serde::{Deserialize, Serialize};

/// The options that a study may vary: those of the scene, of its objective, of the contact solver, and of the error of a workshop.
const ALLOWED: [&str; 15] = [
    "mesh",
    "subdomains",
    "friction",
    "surface",
    "control-points",
    "poisson-ratio",
    "young-modulus",
    "formulation",
    "load-factor",
    "solver",
    "preconditioner",
    "objective",
    "exponent",
    HEIGHT_ERROR,
    SEED,
];
/// The option that says how far heights are off.
pub const HEIGHT_ERROR: &str = "height-error";
/// The option that says in which directions.
pub const SEED: &str = "seed";
/// Most values of an option.
const MAX_VALUES: usize = 1000;
/// Digits of the values between both ends of a range: 0.6 instead of 0.6000000000000001.
const DIGITS: usize = 12;

/// An option with its values, as they are typed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Varied {
    name: String,
    values: Vec<String>,
}

impl Varied {
    /// From `OPTION=a,b,c` or `OPTION=FIRST:LAST:COUNT`.
    ///
    /// # Errors
    /// In words, for an option that cannot be varied.
    pub fn parse(text: &str) -> Result<Self, String> {
        let shape = "allowed: OPTION=a,b,c or OPTION=FIRST:LAST:COUNT, such as friction=0:0.8:5";
        let (name, values) = text.split_once('=').ok_or(shape)?;
        let name = name.trim_start_matches("--");
        if !ALLOWED.contains(&name) {
            return Err(format!("option {name:?} cannot be varied; allowed: {}", ALLOWED.join(", ")));
        }
        let values = match range(values) {
            Some(values) => values?,
            None => values.split(',').map(str::to_owned).collect(),
        };
        Ok(Self { name: name.to_owned(), values })
    }

    /// The option.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether rows that differ in it have different shapes, though they are not optimized.
    pub fn changes_shapes(&self) -> bool {
        ["surface", "control-points", HEIGHT_ERROR].contains(&self.name.as_str())
    }

    /// Its values, as they are typed.
    pub fn values(&self) -> &[String] {
        &self.values
    }
}

/// Numbers from first to last in equal steps; none for a text that is no range.
fn range(text: &str) -> Option<Result<Vec<String>, String>> {
    let parts: Vec<&str> = text.split(':').collect();
    let [first, last, count] = parts[..] else { return None };
    let (first, last, count) = (first.parse::<f64>().ok()?, last.parse::<f64>().ok()?, count.parse::<usize>());
    let Ok(count @ 2..=MAX_VALUES) = count else {
        return Some(Err(format!("COUNT of a range is a number from 2 to {MAX_VALUES}")));
    };
    if !(first.is_finite() && last.is_finite()) {
        return Some(Err("a range has finite ends".into()));
    }
    let rounded = |value: f64| format!("{value:.DIGITS$e}").parse().unwrap_or(value);
    let value = |step: usize| match step {
        0 => first,
        step if step == count - 1 => last,
        step => rounded(first + (last - first) * (step as f64 / (count - 1) as f64)),
    };
    Some(Ok((0..count).map(|step| value(step).to_string()).collect()))
}

/// An option with its value, as an argument.
pub fn assignment(name: &str, value: &str) -> String {
    format!("--{name}={value}")
}

/// The options of all rows; the last option changes fastest.
pub fn combinations(varied: &[Varied]) -> Vec<Vec<String>> {
    varied.iter().fold(vec![vec![]], |rows, varied| {
        let longer = |row: &Vec<String>, value: &String| {
            let mut row = row.clone();
            row.push(assignment(&varied.name, value));
            row
        };
        rows.iter().flat_map(|row| varied.values.iter().map(move |value| longer(row, value))).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_lists_become_all_combinations() {
        let friction = Varied::parse("friction=0:0.8:5").expect("a range");
        assert_eq!(friction.values(), ["0", "0.2", "0.4", "0.6", "0.8"]);
        let mesh = Varied::parse("--mesh=4:12:3").expect("numbers of bricks");
        assert_eq!(mesh.values(), ["4", "8", "12"]);
        let surface = Varied::parse("surface=bspline:2,bezier").expect("splines");
        let rows = combinations(&[surface, Varied::parse("friction=0,0.3").expect("numbers")]);
        let expected = [
            ["--surface=bspline:2", "--friction=0"],
            ["--surface=bspline:2", "--friction=0.3"],
            ["--surface=bezier", "--friction=0"],
            ["--surface=bezier", "--friction=0.3"],
        ];
        assert_eq!(rows, expected);
    }

    #[test]
    fn what_cannot_be_varied_is_refused_in_words() {
        for (text, words) in
            [("friction", "OPTION=a,b,c"), ("threads=1,2", "cannot be varied"), ("friction=0:1:1", "COUNT")]
        {
            let refusal = Varied::parse(text).expect_err(text);
            assert!(refusal.contains(words), "{text}: {refusal}");
        }
    }
}
