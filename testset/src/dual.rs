//! Forward-mode differentiation with one branch per kink.
//!
//! A [`Dual`] carries a value, one Clarke subgradient and the distance to the nearest kink, to first order:
//!
//! ```text
//! max(u₁, …, u_m)      value u_k, gradient ∇u_k of the first active k,   kink at min_{j≠k} (u_k − u_j) / |∇u_k − ∇u_j|
//! |u|                  value |u|, gradient ±∇u,                          kink at |u| / |∇u|
//! |(u, v)|             value √(u² + v²),                                 kink at |(u, v)| / |(∇u, ∇v)|
//! ```
//!
//! The gradient is a Clarke subgradient wherever every kinked term enters increasingly (regular functions, calculus
//! with equality), which holds for every problem of the collection but one: negative distances, where two points
//! coincide, have the subgradient zero that is chosen here.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A function of the variables that is differentiated as it is evaluated.
pub type Function = std::sync::Arc<dyn Fn(&[Dual]) -> Dual + Send + Sync>;

/// A value with its gradient and the first-order distance to the nearest kink passed on the way.
#[derive(Clone, Debug)]
pub struct Dual {
    value: f64,
    gradient: Vec<f64>,
    kink: f64,
}

impl Dual {
    /// The independent variables at the point `x`.
    pub fn variables(x: &[f64]) -> Vec<Self> {
        let unit = |i: usize| (0..x.len()).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
        x.iter().enumerate().map(|(i, &value)| Self { value, gradient: unit(i), kink: f64::INFINITY }).collect()
    }

    /// The value.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Value, gradient and distance to the nearest kink.
    pub fn into_parts(self) -> (f64, Vec<f64>, f64) {
        (self.value, self.gradient, self.kink)
    }

    /// Σ cᵢ uᵢ in one pass.
    ///
    /// # Panics
    /// When no term is given.
    pub fn combination<'a>(terms: impl IntoIterator<Item = (f64, &'a Self)>) -> Self {
        let mut terms = terms.into_iter();
        let (c, first) = terms.next().expect("a combination has at least one term");
        let mut sum = first.chain(c * first.value, c);
        for (c, term) in terms {
            sum.value += c * term.value;
            sum.kink = sum.kink.min(term.kink);
            for (s, t) in sum.gradient.iter_mut().zip(&term.gradient) {
                *s += c * t;
            }
        }
        sum
    }

    /// Σ uᵢ.
    ///
    /// # Panics
    /// When no term is given.
    pub fn sum(terms: impl IntoIterator<Item = Self>) -> Self {
        terms.into_iter().reduce(|a, b| a + b).expect("a sum has at least one term")
    }

    /// max uᵢ with the gradient of the first active piece.
    ///
    /// # Panics
    /// When no piece is given.
    pub fn max(pieces: impl IntoIterator<Item = Self>) -> Self {
        let pieces: Vec<Self> = pieces.into_iter().collect();
        let active = (1..pieces.len()).fold(0, |best, i| if pieces[i].value > pieces[best].value { i } else { best });
        let mut result = pieces[active].clone();
        for (_, other) in pieces.iter().enumerate().filter(|&(i, _)| i != active) {
            let slope = distance(&pieces[active].gradient, &other.gradient);
            result.kink = result.kink.min(kink_distance(pieces[active].value - other.value, slope));
        }
        result
    }

    /// max(0, u).
    pub fn positive_part(&self) -> Self {
        Self::max([self * 0.0, self.clone()])
    }

    /// |u|, with slope 1 at zero.
    pub fn abs(&self) -> Self {
        let mut result = self.chain(self.value.abs(), if self.value < 0.0 { -1.0 } else { 1.0 });
        result.kink = result.kink.min(kink_distance(self.value.abs(), norm(&self.gradient)));
        result
    }

    /// √(u² + v²), with gradient zero at the origin.
    pub fn hypot(&self, other: &Self) -> Self {
        let value = self.value.hypot(other.value);
        let (a, b) = if value > 0.0 { (self.value / value, other.value / value) } else { (0.0, 0.0) };
        let mut result = Self::combination([(a, self), (b, other)]);
        result.value = value;
        result.kink = result.kink.min(kink_distance(value, norm(&self.gradient).hypot(norm(&other.gradient))));
        result
    }

    /// u².
    pub fn square(&self) -> Self {
        self.chain(self.value * self.value, 2.0 * self.value)
    }

    /// uᵖ for an integer p ≥ 1.
    pub fn powi(&self, power: i32) -> Self {
        self.chain(self.value.powi(power), f64::from(power) * self.value.powi(power - 1))
    }

    /// uᵖ for u > 0.
    pub fn powf(&self, power: f64) -> Self {
        self.chain(self.value.powf(power), power * self.value.powf(power - 1.0))
    }

    /// exp u.
    pub fn exp(&self) -> Self {
        self.chain(self.value.exp(), self.value.exp())
    }

    /// ln u.
    pub fn ln(&self) -> Self {
        self.chain(self.value.ln(), self.value.recip())
    }

    /// ln(1 + |u|) with the sign of u, which is smooth.
    pub fn signed_ln_1p(&self) -> Self {
        let size = self.value.abs();
        self.chain(size.ln_1p().copysign(self.value), (1.0 + size).recip())
    }

    /// sin u.
    pub fn sin(&self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }

    /// cos u.
    pub fn cos(&self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }

    /// sinh u.
    pub fn sinh(&self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }

    /// A smooth function of one variable: its value and slope here.
    fn chain(&self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.iter().map(|g| slope * g).collect(), kink: self.kink }
    }

    /// A smooth function of two variables: its value and both slopes here.
    fn chain2(&self, other: &Self, value: f64, slope: f64, other_slope: f64) -> Self {
        let pairs = self.gradient.iter().zip(&other.gradient);
        let gradient = pairs.map(|(a, b)| slope * a + other_slope * b).collect();
        Self { value, gradient, kink: self.kink.min(other.kink) }
    }
}

/// First-order distance to the zero of a quantity: gap / slope; a zero gap between identical slopes is no kink.
fn kink_distance(gap: f64, slope: f64) -> f64 {
    if slope > 0.0 { gap / slope } else { f64::INFINITY }
}

fn norm(g: &[f64]) -> f64 {
    g.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

macro_rules! binary {
    ($trait:ident, $method:ident, |$a:ident, $b:ident| $dual:expr, |$u:ident, $c:ident| $right:expr, $left:expr) => {
        impl $trait<&Dual> for &Dual {
            type Output = Dual;
            fn $method(self, $b: &Dual) -> Dual {
                let $a = self;
                $dual
            }
        }
        impl $trait<Dual> for &Dual {
            type Output = Dual;
            fn $method(self, other: Dual) -> Dual {
                $trait::$method(self, &other)
            }
        }
        impl $trait<&Dual> for Dual {
            type Output = Dual;
            fn $method(self, other: &Dual) -> Dual {
                $trait::$method(&self, other)
            }
        }
        impl $trait<Dual> for Dual {
            type Output = Dual;
            fn $method(self, other: Dual) -> Dual {
                $trait::$method(&self, &other)
            }
        }
        impl $trait<f64> for &Dual {
            type Output = Dual;
            fn $method(self, $c: f64) -> Dual {
                let $u = self;
                $right
            }
        }
        impl $trait<f64> for Dual {
            type Output = Dual;
            fn $method(self, other: f64) -> Dual {
                $trait::$method(&self, other)
            }
        }
        impl $trait<&Dual> for f64 {
            type Output = Dual;
            fn $method(self, $u: &Dual) -> Dual {
                let $c = self;
                $left
            }
        }
        impl $trait<Dual> for f64 {
            type Output = Dual;
            fn $method(self, other: Dual) -> Dual {
                $trait::$method(self, &other)
            }
        }
    };
}

binary!(
    Add,
    add,
    |a, b| a.chain2(b, a.value + b.value, 1.0, 1.0),
    |u, c| u.chain(u.value + c, 1.0),
    u.chain(c + u.value, 1.0)
);
binary!(
    Sub,
    sub,
    |a, b| a.chain2(b, a.value - b.value, 1.0, -1.0),
    |u, c| u.chain(u.value - c, 1.0),
    u.chain(c - u.value, -1.0)
);
binary!(
    Mul,
    mul,
    |a, b| a.chain2(b, a.value * b.value, b.value, a.value),
    |u, c| u.chain(u.value * c, c),
    u.chain(c * u.value, c)
);
binary!(
    Div,
    div,
    |a, b| a.chain2(b, a.value / b.value, b.value.recip(), -a.value / (b.value * b.value)),
    |u, c| u.chain(u.value / c, c.recip()),
    u.chain(c / u.value, -c / (u.value * u.value))
);

impl Neg for &Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        self.chain(-self.value, -1.0)
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        -&self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(dual: Dual) -> (f64, Vec<f64>, f64) {
        dual.into_parts()
    }

    #[test]
    fn smooth_rules_follow_the_calculus() {
        let x = Dual::variables(&[0.3, 1.7]);
        let (value, gradient, kink) = parts((&x[0] * &x[1]).sin() / x[1].powf(0.5) - 2.0 * (1.0 - &x[0]).exp());
        let (a, b): (f64, f64) = (0.3, 1.7);
        assert!((value - ((a * b).sin() / b.sqrt() - 2.0 * (1.0 - a).exp())).abs() < 1e-15);
        assert!((gradient[0] - (b.sqrt() * (a * b).cos() + 2.0 * (1.0 - a).exp())).abs() < 1e-14);
        let slope = a * (a * b).cos() / b.sqrt() - 0.5 * (a * b).sin() / b.powf(1.5);
        assert!((gradient[1] - slope).abs() < 1e-14);
        assert_eq!(kink, f64::INFINITY);
    }

    #[test]
    fn kinks_know_their_distance() {
        let x = Dual::variables(&[0.3, -0.4]);
        assert_eq!(parts(x[1].abs()), (0.4, vec![-0.0, -1.0], 0.4));
        // max(x, 2y): the pieces meet on the line x = 2y, at distance |0.3 + 0.8| / √5.
        let (value, gradient, kink) = parts(Dual::max([x[0].clone(), 2.0 * &x[1]]));
        assert_eq!((value, gradient), (0.3, vec![1.0, 0.0]));
        assert!((kink - 1.1 / 5f64.sqrt()).abs() < 1e-15);
        let (value, _, kink) = parts(x[0].hypot(&x[1]));
        assert_eq!(value, 0.5);
        assert!((kink - 0.5 / 2f64.sqrt()).abs() < 1e-15);
        assert_eq!(parts(x[0].positive_part()), (0.3, vec![1.0, 0.0], 0.3));
    }

    #[test]
    fn at_a_tie_one_piece_answers() {
        let x = Dual::variables(&[0.0]);
        assert_eq!(parts(x[0].abs()), (0.0, vec![1.0], 0.0));
        assert_eq!(parts(Dual::max([-&x[0], x[0].clone()])), (-0.0, vec![-1.0], 0.0));
        let (value, gradient, kink) = parts(x[0].hypot(&x[0]));
        assert_eq!((value, gradient[0], kink), (0.0, 0.0, 0.0));
    }
}
