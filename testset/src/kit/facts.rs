//! Measured numbers that several pages state: `docs/facts.toml`.

use serde::Deserialize;
use std::path::Path;

/// A measured number.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fact {
    /// What it is, for people and tests.
    pub name: String,
    /// The number as pages state it.
    pub value: String,
    /// How it is measured: a command, or the test that measures it.
    pub measured: String,
    /// `PAGE: text`, with `{}` in place of the number.
    pub stated: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Facts {
    fact: Vec<Fact>,
}

/// All facts of the repository.
///
/// # Panics
/// When the file cannot be read.
pub fn facts() -> Vec<Fact> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/facts.toml");
    let text = std::fs::read_to_string(path).expect("docs/facts.toml");
    toml::from_str::<Facts>(&text).expect("a list of facts").fact
}

/// The number of a fact.
///
/// # Panics
/// When there is no such fact, or it is no number.
pub fn fact(name: &str) -> f64 {
    let facts = facts();
    let fact = facts.iter().find(|fact| fact.name == name).unwrap_or_else(|| panic!("no fact {name}"));
    fact.value.replace(' ', "").parse().unwrap_or_else(|_| panic!("{name}: {} is no number", fact.value))
}
