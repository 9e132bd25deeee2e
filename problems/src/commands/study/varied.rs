//! What a study varies: options of the scene or its fields, and their values.

use crate::commands::scene_options::{find, options};
use scene_file::check_path;
use serde::{Deserialize, Serialize};

/// The option that says how far heights are off.
pub const HEIGHT_ERROR: &str = "height-error";
/// The option that says in which directions.
pub const SEED: &str = "seed";
/// Most values of an option.
const MAX_VALUES: usize = 1000;
/// Digits of the values between both ends of a range: 0.6 instead of 0.6000000000000001.
const DIGITS: usize = 12;

/// An option or a field with its values, as they are typed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Varied {
    name: String,
    values: Vec<String>,
}

impl Varied {
    /// From `OPTION=a,b,c` or `OPTION=FIRST:LAST:COUNT`.
    ///
    /// # Errors
    /// In words, for what cannot be varied.
    pub fn parse(text: &str) -> Result<Self, String> {
        let shape = "allowed: OPTION=a,b,c or OPTION=FIRST:LAST:COUNT, such as friction=0:0.8:5";
        let (name, values) = text.split_once('=').ok_or(shape)?;
        let name = name.trim_start_matches("--");
        if !is_option(name) {
            let known = options(false).iter().map(|option| option.name).chain([HEIGHT_ERROR, SEED]);
            let allowed = || known.clone().collect::<Vec<_>>().join(", ");
            let no_field = check_path(name).err().map(|error| error.to_string());
            if let Some(reason) = no_field.or(name.starts_with("output").then(|| "it is where results go".to_owned())) {
                return Err(format!(
                    "{name:?} cannot be varied; allowed: {}, and fields of the scene: {reason}",
                    allowed()
                ));
            }
        }
        let values = match range(values) {
            Some(values) => values?,
            None => listed(values),
        };
        Ok(Self { name: name.to_owned(), values })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// The field that it changes, or the option that changes none.
    pub fn field(&self) -> &str {
        let fields = find(&self.name).filter(|_| is_option(&self.name)).map_or(&[][..], |option| option.fields);
        fields.first().unwrap_or(&&*self.name)
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

/// Values between commas that stand in no bracket.
fn listed(text: &str) -> Vec<String> {
    let mut depth = 0_i32;
    let outside = |character: char| {
        depth += i32::from("[{".contains(character)) - i32::from("]}".contains(character));
        character == ',' && depth == 0
    };
    text.split(outside).map(str::to_owned).collect()
}

/// Whether an option of this name can be varied; other names are those of fields.
fn is_option(name: &str) -> bool {
    [HEIGHT_ERROR, SEED].contains(&name) || options(false).iter().any(|option| option.name == name)
}

/// What comes before a field and its value in an argument.
const FIELD: &str = "--set=";

/// An option or a field with its value, as an argument.
pub fn assignment(name: &str, value: &str) -> String {
    format!("{}{name}={value}", if is_option(name) { "--" } else { FIELD })
}

/// Name and value in such an argument.
pub fn parts(argument: &str) -> (&str, &str) {
    let inner = argument.strip_prefix(FIELD).unwrap_or(argument.trim_start_matches("--"));
    inner.split_once('=').unwrap_or((inner, ""))
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
        let degrees = Varied::parse("degrees=2,3").expect("degrees");
        let rows = combinations(&[degrees, Varied::parse("friction=0,0.3").expect("numbers")]);
        let expected = [
            ["--degrees=2", "--friction=0"],
            ["--degrees=2", "--friction=0.3"],
            ["--degrees=3", "--friction=0"],
            ["--degrees=3", "--friction=0.3"],
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
