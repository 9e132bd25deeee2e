//! Formulas in x1, x2 and x3 with the precedence of mathematics, for numbers with or without derivatives. Available
//! crates count powers from the left, bind signs more than powers, or report errors without a place.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = factor { ("*" | "/") factor }
//! factor  = ("+" | "-") factor | power
//! power   = operand [ "^" factor ]            2^3^2 = 2^(3^2),  -x1^2 = -(x1^2),  2^-1 = 0.5
//! operand = number | "x1" | "x2" | "x3" | "PI" | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use crate::error::SceneError;
use crate::scalar::Scalar;
use std::f64::consts::PI;

/// Longest formula, characters.
const LONGEST: usize = 1000;
/// Most parentheses, signs and powers inside each other.
const DEEPEST: usize = 100;

/// A function by its number of arguments, with its slope.
#[derive(Debug, Clone, Copy)]
enum Function {
    One(fn(f64) -> f64, fn(f64) -> f64),
    /// Of two numbers one, by a comparison that chooses the first.
    Chosen(fn(f64, f64) -> bool),
}
use Function::{Chosen, One};

/// The functions by their names.
const FUNCTIONS: [(&str, Function); 19] = [
    ("abs", One(f64::abs, f64::signum)),
    ("sqrt", One(f64::sqrt, |x| 0.5 / x.sqrt())),
    ("exp", One(f64::exp, f64::exp)),
    ("ln", One(f64::ln, f64::recip)),
    ("log10", One(f64::log10, |x| 1.0 / (x * std::f64::consts::LN_10))),
    ("sin", One(f64::sin, f64::cos)),
    ("cos", One(f64::cos, |x| -x.sin())),
    ("tan", One(f64::tan, |x| 1.0 + x.tan().powi(2))),
    ("asin", One(f64::asin, |x| 1.0 / (1.0 - x * x).sqrt())),
    ("acos", One(f64::acos, |x| -1.0 / (1.0 - x * x).sqrt())),
    ("atan", One(f64::atan, |x| 1.0 / (1.0 + x * x))),
    ("sinh", One(f64::sinh, f64::cosh)),
    ("cosh", One(f64::cosh, f64::sinh)),
    ("tanh", One(f64::tanh, |x| 1.0 - x.tanh().powi(2))),
    ("floor", One(f64::floor, |_| 0.0)),
    ("ceil", One(f64::ceil, |_| 0.0)),
    ("round", One(f64::round, |_| 0.0)),
    ("max", Chosen(|a, b| a >= b)),
    ("min", Chosen(|a, b| a <= b)),
];

/// A formula in x1, x2 and x3.
#[derive(Debug, Clone)]
pub struct Formula {
    /// What is done to a stack of numbers, in order.
    steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy)]
enum Step {
    Number(f64),
    /// The coordinate of this index.
    Coordinate(usize),
    One(fn(f64) -> f64, fn(f64) -> f64),
    Chosen(fn(f64, f64) -> bool),
    Negative,
    Sum,
    Difference,
    Product,
    Quotient,
    Power,
}

impl Formula {
    /// Reads the formula of a field.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] with the first place that cannot be understood.
    pub fn parse(field: &str, text: &str) -> Result<Self, SceneError> {
        let characters: Vec<char> = text.chars().collect();
        if characters.len() > LONGEST {
            let found = format!("a formula of {} characters", characters.len());
            return Err(SceneError::out_of_range(field, found, format!("at most {LONGEST} characters")));
        }
        let field = field.to_owned();
        let mut parser = Parser { field, characters, at: 0, steps: Vec::new(), depth: 0 };
        parser.sum()?;
        if parser.peek().is_some() {
            return Err(parser.error("an operator (+ - * / ^) or the end"));
        }
        Ok(Self { steps: parser.steps })
    }

    /// Its value at a place; not a number where it has none.
    pub fn value<T: Scalar>(&self, place: [T; 3]) -> T {
        let mut stack = Vec::new();
        for step in &self.steps {
            let mut pop = || stack.pop().unwrap_or(T::constant(f64::NAN));
            let value = match *step {
                Step::Number(number) => T::constant(number),
                Step::Coordinate(axis) => place[axis],
                Step::One(function, slope) => pop().map(function, slope),
                Step::Negative => T::constant(0.0) - pop(),
                two => {
                    let (second, first) = (pop(), pop());
                    two.of(first, second)
                }
            };
            stack.push(value);
        }
        stack.pop().unwrap_or(T::constant(f64::NAN))
    }
}

impl Step {
    /// An operation on two numbers.
    fn of<T: Scalar>(self, a: T, b: T) -> T {
        match self {
            Self::Sum => a + b,
            Self::Difference => a - b,
            Self::Product => a * b,
            Self::Quotient => a / b,
            Self::Power => a.power(b),
            // Neither of them where one is not a number.
            Self::Chosen(first) if a.value().is_nan() || first(a.value(), b.value()) => a,
            _ => b,
        }
    }
}

/// A text that is being read.
struct Parser {
    field: String,
    characters: Vec<char>,
    at: usize,
    steps: Vec<Step>,
    depth: usize,
}

impl Parser {
    fn sum(&mut self) -> Result<(), SceneError> {
        self.product()?;
        while let Some(sign @ ('+' | '-')) = self.peek() {
            self.at += 1;
            self.product()?;
            self.steps.push(if sign == '+' { Step::Sum } else { Step::Difference });
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), SceneError> {
        self.factor()?;
        while let Some(sign @ ('*' | '/')) = self.peek() {
            self.at += 1;
            self.factor()?;
            self.steps.push(if sign == '*' { Step::Product } else { Step::Quotient });
        }
        Ok(())
    }

    fn factor(&mut self) -> Result<(), SceneError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(&format!("at most {DEEPEST} parentheses, signs and powers inside each other")));
        }
        if let Some(sign @ ('+' | '-')) = self.peek() {
            self.at += 1;
            self.factor()?;
            self.steps.extend((sign == '-').then_some(Step::Negative));
        } else {
            self.operand()?;
            if self.peek() == Some('^') {
                self.at += 1;
                self.factor()?;
                self.steps.push(Step::Power);
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), SceneError> {
        let expected = "a number, x1, x2, x3, PI, a function or a parenthesis";
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.sum()?;
                self.expect(')', "an operator (+ - * / ^) or )")
            }
            Some(first) if first.is_ascii_digit() || first == '.' => self.number(),
            Some(first) if first.is_alphabetic() => self.name(),
            _ => Err(self.error(expected)),
        }
    }

    /// Digits with a point, with an exponent such as e-3.
    fn number(&mut self) -> Result<(), SceneError> {
        let start = self.at;
        self.digits();
        if self.characters.get(self.at) == Some(&'.') {
            self.at += 1;
            self.digits();
        }
        if let Some('e' | 'E') = self.characters.get(self.at) {
            let before = self.at;
            self.at += 1;
            if let Some('+' | '-') = self.characters.get(self.at) {
                self.at += 1;
            }
            if self.digits() == 0 {
                self.at = before;
            }
        }
        let text: String = self.characters[start..self.at].iter().collect();
        let number = text.parse().map_err(|_| {
            self.at = start;
            self.error("a number such as 2.5e-3")
        })?;
        self.steps.push(Step::Number(number));
        Ok(())
    }

    fn digits(&mut self) -> usize {
        let rest = &self.characters[self.at..];
        let count = rest.iter().take_while(|character| character.is_ascii_digit()).count();
        self.at += count;
        count
    }

    /// A coordinate, π, or a function with its arguments.
    fn name(&mut self) -> Result<(), SceneError> {
        let name = self.word();
        match name.as_str() {
            "x1" => self.steps.push(Step::Coordinate(0)),
            "x2" => self.steps.push(Step::Coordinate(1)),
            "x3" => self.steps.push(Step::Coordinate(2)),
            "PI" => self.steps.push(Step::Number(PI)),
            _ => {
                let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
                    let names: Vec<&str> = FUNCTIONS.iter().map(|(name, _)| *name).collect();
                    return Err(self.error(&format!("the names x1, x2, x3, PI and the functions {}", names.join(", "))));
                };
                self.at += name.chars().count();
                return self.call(&name, *function);
            }
        }
        self.at += name.chars().count();
        Ok(())
    }

    fn call(&mut self, name: &str, function: Function) -> Result<(), SceneError> {
        self.expect('(', &format!("a parenthesis after {name}, as in {name}(…)"))?;
        self.sum()?;
        let step = match function {
            One(function, slope) => Step::One(function, slope),
            Chosen(first) => {
                self.expect(',', &format!("a comma and a second argument of {name}"))?;
                self.sum()?;
                Step::Chosen(first)
            }
        };
        self.steps.push(step);
        self.expect(')', &format!("an operator (+ - * / ^) or the ) of {name}"))
    }

    /// The next character that is no blank; the place moves there.
    fn peek(&mut self) -> Option<char> {
        let blanks = self.characters[self.at..].iter().take_while(|character| character.is_whitespace()).count();
        self.at += blanks;
        self.characters.get(self.at).copied()
    }

    fn expect(&mut self, character: char, allowed: &str) -> Result<(), SceneError> {
        if self.peek() != Some(character) {
            return Err(self.error(allowed));
        }
        self.at += 1;
        Ok(())
    }

    /// Letters, digits and underscores from here on.
    fn word(&self) -> String {
        let is_part = |character: &char| character.is_alphanumeric() || *character == '_';
        self.characters[self.at..].iter().copied().take_while(is_part).collect()
    }

    /// What stands here, and what may.
    fn error(&mut self, allowed: &str) -> SceneError {
        let found = match self.peek() {
            None => "the end".to_owned(),
            Some(character) => {
                let word = self.word();
                let text = if word.is_empty() { character.to_string() } else { word };
                format!("{text:?} at character {}", self.at + 1)
            }
        };
        SceneError::out_of_range(self.field.as_str(), found, allowed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    #[test]
    fn every_function_has_its_value_and_its_derivative() {
        let at = |x1: f64, text: &str| Formula::parse("f", text).expect(text).value([x1, 0.3, 0.0]);
        for (name, function) in FUNCTIONS {
            let text = if matches!(function, One(..)) { format!("{name}(x1)") } else { format!("{name}(x1, x2)") };
            let difference = (at(0.4 + 1e-6, &text) - at(0.4 - 1e-6, &text)) / 2e-6;
            let place = [Dual::new(0.4, 1.0), Dual::new(0.3, 0.0), Dual::new(0.0, 0.0)];
            let slope = Formula::parse("f", &text).expect(&text).value(place).derivative;
            assert!((slope - difference).abs() < 1e-8, "{text}: {slope}, by differences {difference}");
        }
        let values = [("sinh(1)", 1.1752011936438014), ("atan(1)", std::f64::consts::FRAC_PI_4), ("min(2, 1)", 1.0)];
        for (text, expected) in values {
            assert!((at(0.4, text) - expected).abs() < 1e-15, "{text}");
        }
    }
}
