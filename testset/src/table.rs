//! The table of the collection: names, start points, optimal values, linear constraints, evaluation counts.

use std::collections::BTreeMap;

use serde::Deserialize;

/// The file as it is published with this crate.
const REFERENCE: &str = include_str!("../data/reference.json");

/// A line of the table: the published data of a problem.
#[derive(Debug, Deserialize)]
pub struct Record {
    /// Name by which the collection finds the problem.
    pub name: String,
    /// Part of the collection: unconstrained, minimax, linear, scalable, overton, nesterov.
    #[serde(rename = "family")]
    pub group: String,
    /// Number of variables.
    #[serde(rename = "n")]
    pub dimension: usize,
    /// Convex where it matters, see [`crate::Problem::convex_lower`].
    pub convex: bool,
    /// Description of the function.
    pub formula: String,
    /// Start point.
    pub x0: Vec<f64>,
    /// Optimal value.
    pub fstar: f64,
    /// Publication that states the problem.
    pub source: String,
    /// Remark on the problem.
    pub note: Option<String>,
    /// Lower bounds, null for none.
    pub lower: Option<Vec<Option<f64>>>,
    /// Upper bounds, null for none.
    pub upper: Option<Vec<Option<f64>>>,
    /// Rows of the linear constraints.
    #[serde(rename = "A", default)]
    pub rows: Vec<Vec<f64>>,
    /// Lower bounds of the rows.
    #[serde(default)]
    pub cl: Vec<Option<f64>>,
    /// Upper bounds of the rows.
    #[serde(default)]
    pub cu: Vec<Option<f64>>,
    /// Numeric data of the formula.
    #[serde(default)]
    pub data: BTreeMap<String, Numbers>,
    /// Oracle calls to f − f* ≤ 1e-6 (1 + |f*|) of each solver.
    #[serde(rename = "evaluations_to_1e-6")]
    pub evaluations: BTreeMap<String, Option<usize>>,
}

/// A vector or a matrix by rows.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum Numbers {
    Vector(Vec<f64>),
    /// A matrix by rows.
    Matrix(Vec<Vec<f64>>),
}

impl Record {
    /// The vector of this name in the data of the formula.
    ///
    /// # Panics
    /// When the table holds none.
    pub fn vector(&self, name: &str) -> Vec<f64> {
        match self.data.get(name) {
            Some(Numbers::Vector(vector)) => vector.clone(),
            _ => panic!("{}: no vector {name} in the table", self.name),
        }
    }

    /// The matrix of this name in the data of the formula.
    ///
    /// # Panics
    /// When the table holds none.
    pub fn matrix(&self, name: &str) -> Vec<Vec<f64>> {
        match self.data.get(name) {
            Some(Numbers::Matrix(matrix)) => matrix.clone(),
            _ => panic!("{}: no matrix {name} in the table", self.name),
        }
    }
}

#[derive(Deserialize)]
struct Table {
    problems: Vec<Record>,
}

/// All records in the order of the file.
pub fn records() -> Vec<Record> {
    serde_json::from_str::<Table>(REFERENCE).expect("the table compiled into the crate is well formed").problems
}

/// Bounds with ±∞ where the table has null or nothing.
pub fn bounds(given: Option<&[Option<f64>]>, dimension: usize, none: f64) -> Vec<f64> {
    given.map_or_else(|| vec![none; dimension], |values| values.iter().map(|v| v.unwrap_or(none)).collect())
}
