//! The facts of a result in one table, and its printers: text for the terminal, JSON, sections of a page.

use crate::commands::failure::Failure;
use crate::commands::numbers::{number, percent, rounded};
use figures::page::{Block, Section};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::borrow::Cow;

/// Digits of a residual for people.
const RESIDUAL_DIGITS: usize = 2;
/// Width of the names before the values in a text.
const NAME_WIDTH: usize = 30;

/// A value for people and for JSON.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    /// An error, a residual or a time, of which few digits matter.
    Rough(f64),
    /// A number of things.
    Count(usize),
    Text(String),
    /// The value does not exist.
    Missing,
}

impl Value {
    /// The value as people read it.
    pub fn shown(&self) -> String {
        match self {
            Self::Number(value) => number(*value),
            Self::Rough(value) => rounded(*value, RESIDUAL_DIGITS),
            Self::Count(count) => count.to_string(),
            Self::Text(text) => text.clone(),
            Self::Missing => "–".into(),
        }
    }

    fn json(&self) -> serde_json::Value {
        match self {
            Self::Number(value) | Self::Rough(value) => (*value).into(),
            Self::Count(count) => (*count).into(),
            Self::Text(text) => text.as_str().into(),
            Self::Missing => serde_json::Value::Null,
        }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<Option<f64>> for Value {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Missing, Self::Number)
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

/// One fact of a result: a value, or one per shape.
#[derive(Debug, Clone)]
pub struct Fact {
    /// Its name in JSON, which does not change; `a.b` is the key `b` of the object `a`. Empty: not in JSON.
    key: Cow<'static, str>,
    /// Its name for people. Empty: in JSON only.
    name: String,
    values: Vec<Value>,
    /// Unit of the values; empty where there is none.
    unit: String,
    /// Empty: the name says it.
    meaning: &'static str,
    /// Whether a text has it with `--verbose` only.
    detail: bool,
    /// What JSON has in place of the values.
    object: Option<serde_json::Value>,
}

impl Fact {
    pub fn new(key: impl Into<Cow<'static, str>>, name: &str, value: impl Into<Value>, unit: &str) -> Self {
        Self::row(key, name, vec![value.into()], unit)
    }

    /// A fact with a value per shape.
    pub fn row(key: impl Into<Cow<'static, str>>, name: &str, values: Vec<Value>, unit: &str) -> Self {
        Self { key: key.into(), name: name.into(), values, unit: unit.into(), meaning: "", detail: false, object: None }
    }

    /// Words for people, and an object for JSON.
    ///
    /// # Errors
    /// [`Failure::Computation`] for a value that has no JSON.
    pub fn object(key: &'static str, name: &str, value: &impl Serialize, words: String) -> Result<Self, Failure> {
        let object = Some(serde_json::to_value(value).map_err(Failure::computation)?);
        Ok(Self { object, ..Self::new(key, name, words, "") })
    }

    /// A fact for JSON only.
    ///
    /// # Errors
    /// [`Failure::Computation`] for a value that has no JSON.
    pub fn json(key: &'static str, value: &impl Serialize) -> Result<Self, Failure> {
        Self::object(key, "", value, String::new())
    }

    pub fn meaning(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// The fact where a text has it with `--verbose` only.
    pub fn detail(self) -> Self {
        Self { detail: true, ..self }
    }

    /// The name with the unit, as it stands before the values of a table.
    fn titled(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{}, {}", self.name, self.unit) }
    }

    /// The fact for people only.
    pub fn without_key(self) -> Self {
        Self { key: Cow::Borrowed(""), ..self }
    }

    /// The values as people read them, without the unit.
    fn shown(&self) -> impl Iterator<Item = String> {
        self.values.iter().map(Value::shown)
    }

    /// From the first value to the second, in per cent of the first; none for other numbers of values and after zero.
    fn change_percent(&self) -> Option<f64> {
        match self.values[..] {
            [Value::Number(first), Value::Number(second)] if first != 0.0 => {
                Some(100.0 * (second - first) / first.abs())
            }
            _ => None,
        }
    }

    fn value_json(&self, shape: Option<usize>) -> serde_json::Value {
        match (&self.object, shape, &self.values[..]) {
            (Some(object), ..) => object.clone(),
            (None, Some(shape), values) => values.get(shape).map_or(serde_json::Value::Null, Value::json),
            (None, None, [value]) => value.json(),
            (None, None, values) => values.iter().map(Value::json).collect(),
        }
    }
}

/// Facts that belong together; a section of a page.
#[derive(Debug, Clone, Default)]
pub struct Group {
    pub title: &'static str,
    /// What the values of a fact belong to, where there are several.
    pub columns: Vec<String>,
    pub facts: Vec<Fact>,
    /// What is to be said about them.
    pub words: String,
}

impl Group {
    /// Facts with one value each.
    pub fn new(title: &'static str, facts: Vec<Fact>) -> Self {
        Self { title, facts, ..Self::default() }
    }

    /// The group with words about it.
    pub fn with_words(self, words: impl Into<String>) -> Self {
        Self { words: words.into(), ..self }
    }

    /// A line per fact, or a table where facts have more values than a start and an end.
    fn text(&self, verbose: bool) -> String {
        let shown = self.facts.iter().filter(|fact| !fact.name.is_empty() && (verbose || !fact.detail));
        if self.columns.len() > 2 {
            let head: Vec<String> = std::iter::once(String::new()).chain(self.columns.iter().cloned()).collect();
            let rows: Vec<Vec<String>> =
                shown.map(|fact| std::iter::once(fact.titled()).chain(fact.shown()).collect()).collect();
            return if rows.is_empty() { String::new() } else { aligned(&head, &rows) };
        }
        let lines = shown.map(|fact| {
            let values = fact.shown().collect::<Vec<_>>().join(" -> ");
            line(&fact.name, &format!("{values} {}", fact.unit))
        });
        lines.collect()
    }

    /// A section of a page with the facts that people read; empty without any.
    pub fn section(&self) -> Section {
        let named = || self.facts.iter().filter(|fact| !fact.name.is_empty());
        if named().next().is_none() {
            return Section::default();
        }
        let changes = self.columns.len() == 2 && named().any(|fact| fact.change_percent().is_some());
        let columns = if self.columns.is_empty() { vec!["value".to_owned()] } else { self.columns.clone() };
        let head = std::iter::once(String::new()).chain(columns).chain(changes.then(|| "change".to_owned()));
        let rows = named().map(|fact| {
            let change = || fact.change_percent().map_or_else(|| "–".to_owned(), percent);
            std::iter::once(fact.titled()).chain(fact.shown()).chain(changes.then(change)).collect::<Vec<String>>()
        });
        let mut blocks = vec![Block::table(head, rows.collect::<Vec<_>>())];
        blocks.extend((!self.words.is_empty()).then(|| Block::Text(self.words.clone())));
        let meanings: Vec<String> = named()
            .filter(|fact| !fact.meaning.is_empty())
            .map(|fact| format!("{}: {}", fact.name, fact.meaning))
            .collect();
        blocks.extend((!meanings.is_empty()).then_some(Block::List(meanings)));
        Section::new(self.title, blocks)
    }

    /// The group as a table in JSON: columns, and rows with key, quantity, unit, values and change.
    pub fn table(&self) -> impl Serialize + use<> {
        #[derive(Serialize)]
        struct Row {
            key: String,
            quantity: String,
            unit: String,
            values: Vec<serde_json::Value>,
            change_percent: Option<f64>,
        }
        #[derive(Serialize)]
        struct Table {
            columns: Vec<String>,
            rows: Vec<Row>,
        }
        let row = |fact: &Fact| Row {
            key: fact.key.to_string(),
            quantity: fact.name.clone(),
            unit: fact.unit.clone(),
            values: fact.values.iter().map(Value::json).collect(),
            change_percent: fact.change_percent(),
        };
        let rows = self.facts.iter().filter(|fact| !fact.key.is_empty()).map(row).collect();
        Table { columns: self.columns.clone(), rows }
    }
}

/// The facts of a result.
#[derive(Debug, Default)]
pub struct Facts {
    /// The first lines of a text: what was found, and whether it is confirmed.
    pub lead: Vec<String>,
    pub groups: Vec<Group>,
}

impl Facts {
    fn all(&self) -> impl Iterator<Item = &Fact> {
        self.groups.iter().flat_map(|group| &group.facts)
    }

    /// The text for people; with all facts if `verbose`.
    pub fn text(&self, verbose: bool) -> String {
        let lead = self.lead.iter().map(|words| format!("{words}\n"));
        lead.chain(self.groups.iter().map(|group| group.text(verbose))).collect()
    }
}

/// A text table: a line per row, columns side by side; the last cell of a shorter row runs over the columns behind it.
pub fn aligned(head: &[String], rows: &[Vec<String>]) -> String {
    let count = |cell: &String| cell.chars().count();
    let mut widths: Vec<usize> = head.iter().map(count).collect();
    for cells in rows.iter().filter(|cells| cells.len() == head.len()) {
        widths.iter_mut().zip(cells).for_each(|(width, cell)| *width = (*width).max(count(cell)));
    }
    let row = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).enumerate().map(|(index, (cell, &width))| match index {
            index if index + 1 == cells.len() && cells.len() != head.len() => cell.clone(),
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    std::iter::once(head).chain(rows.iter().map(Vec::as_slice)).map(row).collect()
}

/// A line of a text: a name and what is said of it.
pub fn line(name: &str, words: &str) -> String {
    format!("{name:<NAME_WIDTH$}{}{}\n", if name.chars().count() < NAME_WIDTH { "" } else { "  " }, words.trim_end())
}

/// One JSON object. Facts with several values have arrays; objects of such facts become an array, one per shape.
impl Serialize for Facts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        fn parent(fact: &Fact) -> Option<&str> {
            fact.key.split_once('.').map(|(parent, _)| parent)
        }
        let keyed: Vec<&Fact> = self.all().filter(|fact| !fact.key.is_empty()).collect();
        let mut map = serializer.serialize_map(None)?;
        for facts in keyed.chunk_by(|a, b| parent(a).is_some() && parent(a) == parent(b)) {
            let Some(name) = parent(facts[0]) else {
                map.serialize_entry(&facts[0].key, &facts[0].value_json(None))?;
                continue;
            };
            let object = |shape: Option<usize>| -> serde_json::Value {
                let own = |fact: &&Fact| (fact.key[name.len() + 1..].to_owned(), fact.value_json(shape));
                serde_json::Value::Object(facts.iter().map(own).collect())
            };
            match facts[0].values.len() {
                1 => map.serialize_entry(name, &object(None))?,
                shapes => {
                    map.serialize_entry(name, &(0..shapes).map(|shape| object(Some(shape))).collect::<Vec<_>>())?
                }
            }
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts() -> Facts {
        let pair = |key, name, a: f64, b: f64| Fact::row(key, name, vec![a.into(), b.into()], "MPa");
        let columns = vec!["start".to_owned(), "optimum".to_owned()];
        let shapes = vec![
            pair("peak_pressure", "peak pressure", 2.0, 1.0).meaning("the largest pressure of a node"),
            pair("residuals.newton", "Newton", 1e-12, 2e-12).detail(),
            pair("residuals.cone", "cone", 0.0, -0.0).detail(),
        ];
        let run = vec![
            Fact::new("evaluations", "evaluations", 7, ""),
            Fact::new("seconds.state", "time of the state", 0.25, "s").detail(),
            Fact::json("controls", &[1.0, 2.0]).expect("numbers"),
        ];
        let shapes = Group { title: "Result", columns, facts: shapes, words: "w".into() };
        Facts { lead: vec!["found".into()], groups: vec![shapes, Group::new("Run", run)] }
    }

    #[test]
    fn the_text_has_details_with_verbose_only() {
        let short = "found\npeak pressure                 2.00000 -> 1.00000 MPa\nevaluations                   7\n";
        assert_eq!(facts().text(false), short);
        let long = facts().text(true);
        assert!(
            long.contains("time of the state             0.250000 s")
                && long.contains("cone                          0 -> 0 MPa"),
            "{long}"
        );
        assert!(!long.contains("controls"));
    }

    #[test]
    fn json_has_objects_per_shape() {
        let expected = serde_json::json!({
            "peak_pressure": [2.0, 1.0],
            "residuals": [{"newton": 1e-12, "cone": 0.0}, {"newton": 2e-12, "cone": -0.0}],
            "evaluations": 7,
            "seconds": {"state": 0.25},
            "controls": [1.0, 2.0],
        });
        assert_eq!(serde_json::to_value(facts()).expect("numbers"), expected);
    }

    #[test]
    fn a_section_has_the_change_and_the_meanings() {
        let section = facts().groups[0].section();
        let Block::Table { head, rows } = &section.blocks[0] else { panic!("a table") };
        assert_eq!(head.last().map(String::as_str), Some("change"));
        assert_eq!(rows[0], ["peak pressure, MPa", "2.00000", "1.00000", "−50.0 %"]);
        assert_eq!(rows[2][3], "–");
        assert_eq!(section.blocks[2], Block::List(vec!["peak pressure: the largest pressure of a node".into()]));
        let Block::Table { head, rows } = facts().groups[1].section().blocks[0].clone() else { panic!("a table") };
        assert_eq!((head.len(), rows.len(), rows[0].len()), (2, 2, 2));
    }
}
