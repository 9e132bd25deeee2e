//! Limits with the values of their quantities at a shape.

use crate::commands::facts::Value;
use crate::commands::numbers::{number, raised};
use contact::cost::Limit;
use serde_json::{Map, json};

/// A limit with its quantity at a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitedValue {
    /// The limit.
    pub limit: Limit,
    /// The quantity, in its unit.
    pub value: f64,
}

impl LimitedValue {
    /// By how much the value is beyond the bound; 0 up to rounding.
    pub fn excess(&self) -> f64 {
        self.limit.excess(self.value)
    }

    /// The quantity with its case.
    pub fn title(&self) -> String {
        let case = self.limit.case.as_ref().map_or_else(String::new, |case| format!(" in case \"{case}\""));
        format!("{}{case}", self.limit.quantity.name())
    }

    /// The limit in words: `peak-pressure at most 3400 MPa`.
    pub fn words(&self) -> String {
        let Limit { quantity, side, bound, case, .. } = &self.limit;
        let side = side.name().replace('_', " ");
        let words = format!("{} {side} {} {}", quantity.name(), number(*bound), raised(&quantity.unit()));
        let case = case.as_ref().map_or_else(String::new, |case| format!(" in case \"{case}\""));
        words.trim_end().to_owned() + &case
    }

    /// The value, and whether the limit is kept.
    pub fn verdict(&self) -> Value {
        let value = number(self.value);
        match self.excess() {
            0.0 => format!("{value}, kept").into(),
            excess => format!("{value}, VIOLATED by {}", number(excess)).into(),
        }
    }

    /// The keys of the limit in JSON.
    pub fn keys(&self) -> Map<String, serde_json::Value> {
        let Limit { quantity, side, bound, case, .. } = &self.limit;
        let mut keys =
            Map::from_iter([("quantity".to_owned(), json!(quantity.name())), (side.name().to_owned(), json!(bound))]);
        keys.extend(case.iter().map(|case| ("case".to_owned(), json!(case))));
        keys
    }
}
