//! The contact law of one node as a projection, and its Newton derivative.
//!
//! ```text
//! λ = Π(x),  x = λ + c (B u − g),     Π(x) = ( max(0, x_N), projection of x_T onto the disc of radius 𝓕 max(0, x_N) )
//! open (x_N ≤ 0): λ = 0;   stick (|x_T| ≤ 𝓕x_N): B u = g;
//! slip: (B u)_N = g,  e·λ_T = 𝓕 λ_N,  (1 − β)/(cβ) p·λ_T = p·(B u)_T,   e = x_T/|x_T|, p ⟂ e, β = 𝓕 x_N/|x_T|
//! ```
//! method.md section 4. On a kink (x_N = 0, |x_T| = 𝓕x_N) the open and the stick derivative are selected.

use crate::equilibrium::{ContactPoint, ContactStatus};
use crate::scalar::Scalar;

/// One element of the generalised derivative of Π at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Linearization {
    /// The node carries no force.
    Open,
    /// All rows of the node held.
    Stick,
    /// The node slides along `direction`.
    Slip {
        /// e, the unit vector along x_T over the node's tangential rows (the second entry is 0 if there is one row).
        direction: [f64; 2],
        /// β = 𝓕x_N/|x_T| ∈ (0, 1).
        ratio: f64,
    },
}

/// What bounds the traction of a slip node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friction {
    /// The normal force of the node times 𝓕.
    Coulomb,
    /// A given bound, which does not follow the normal force.
    Tresca,
}

impl Friction {
    /// By how much the bound of a node grows with its normal force.
    pub(crate) fn of(self, point: &ContactPoint) -> f64 {
        match self {
            Self::Coulomb => point.friction,
            Self::Tresca => 0.0,
        }
    }
}

impl Linearization {
    /// The derivative selected at `x`, the packed rows of one node.
    pub fn at(x: &[f64], friction: f64) -> Self {
        let normal = x[0];
        if normal <= 0.0 {
            return Self::Open;
        }
        let length = tangential_norm(x);
        let radius = friction * normal;
        if x.len() == 1 || length <= radius {
            return Self::Stick;
        }
        let second = if x.len() > 2 { x[2] / length } else { 0.0 };
        Self::Slip { direction: [x[1] / length, second], ratio: radius / length }
    }

    /// D = ∂Π/∂x over the `count` rows of a node (1, 2 or 3), zero elsewhere.
    pub fn derivative(&self, count: usize, friction: f64) -> [[f64; 3]; 3] {
        let mut block = [[0.0; 3]; 3];
        match *self {
            Self::Open => {}
            Self::Stick => (0..count).for_each(|i| block[i][i] = 1.0),
            Self::Slip { direction, ratio } => {
                block[0][0] = 1.0;
                for i in 1..count {
                    block[i][0] = friction * direction[i - 1];
                    for j in 1..count {
                        let identity = f64::from(u8::from(i == j));
                        block[i][j] = ratio * (identity - direction[i - 1] * direction[j - 1]);
                    }
                }
            }
        }
        block
    }

    /// The status this derivative stands for. Without tangential rows a closed node that can slide slips.
    pub fn status(&self, point: &ContactPoint) -> ContactStatus {
        match self {
            Self::Open => ContactStatus::Open,
            Self::Slip { .. } => ContactStatus::Slip,
            Self::Stick if point.tangents == 0 && point.can_slide => ContactStatus::Slip,
            Self::Stick => ContactStatus::Stick,
        }
    }
}

impl ContactPoint {
    /// The derivative of Π selected at the packed rows x of the node; all rows of a glued node are held.
    pub(crate) fn linearization(&self, x: &[f64]) -> Linearization {
        if self.is_tied { Linearization::Stick } else { Linearization::at(x, self.friction) }
    }

    /// Π(x) for the packed rows of the node, written to `result`; x itself where it is glued.
    pub(crate) fn project<T: Scalar>(&self, x: &[T], result: &mut [T]) {
        if self.is_tied { result.copy_from_slice(x) } else { project(x, self.friction, result) }
    }
}

/// |x_T| of the packed rows of one node.
pub fn tangential_norm(x: &[f64]) -> f64 {
    match x.len() {
        1 => 0.0,
        2 => x[1].abs(),
        _ => x[1].hypot(x[2]),
    }
}

/// Π(x) for the packed rows of one node (1, 2 or 3 entries), written to `result`.
pub fn project<T: Scalar>(x: &[T], friction: f64, result: &mut [T]) {
    if x[0].value() <= 0.0 {
        result.fill(T::constant(0.0));
        return;
    }
    project_onto_disc(&x[1..], T::constant(friction) * x[0], &mut result[1..]);
    result[0] = x[0];
}

/// Projection of a tangential vector onto the disc of a given radius.
fn project_onto_disc<T: Scalar>(x: &[T], radius: T, result: &mut [T]) {
    let mut square = T::constant(0.0);
    for &entry in x {
        square += entry * entry;
    }
    let inside = square.value() <= radius.value() * radius.value();
    let factor = if inside { T::constant(1.0) } else { radius / square.sqrt() };
    for (result, &entry) in result.iter_mut().zip(x) {
        *result = entry * factor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;
    use proptest::prelude::*;

    /// DΠ(x)·dx from the linearisation.
    fn derivative(x: &[f64], dx: &[f64], friction: f64) -> Vec<f64> {
        let block = Linearization::at(x, friction).derivative(x.len(), friction);
        block[..x.len()].iter().map(|row| row.iter().zip(dx).map(|(d, dx)| d * dx).sum()).collect()
    }

    proptest! {
        #[test]
        fn projection_is_idempotent(x in prop::array::uniform3(-10.0_f64..10.0), friction in 0.0_f64..2.0) {
            let (mut once, mut twice) = ([0.0; 3], [0.0; 3]);
            project(&x, friction, &mut once);
            project(&once, friction, &mut twice);
            for (a, b) in once.iter().zip(&twice) {
                prop_assert!((a - b).abs() <= 1e-14 * (1.0 + a.abs()));
            }
            prop_assert!(once[0] >= 0.0 && tangential_norm(&once) <= friction * once[0] * (1.0 + 1e-15) + 1e-300);
        }

        #[test]
        fn disc_projection_is_nonexpansive(
            x in prop::array::uniform2(-10.0_f64..10.0), y in prop::array::uniform2(-10.0_f64..10.0),
            radius in 0.0_f64..5.0,
        ) {
            let (mut px, mut py) = ([0.0; 2], [0.0; 2]);
            project_onto_disc(&x, radius, &mut px);
            project_onto_disc(&y, radius, &mut py);
            let distance = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
            prop_assert!(distance(&px, &py) <= distance(&x, &y) * (1.0 + 1e-14) + 1e-300);
        }

        #[test]
        fn linearization_equals_dual_numbers(
            x in prop::array::uniform3(-10.0_f64..10.0), dx in prop::array::uniform3(-1.0_f64..1.0),
            friction in 0.01_f64..2.0,
        ) {
            let dual: [Dual; 3] = std::array::from_fn(|i| Dual::new(x[i], dx[i]));
            let mut exact = [Dual::constant(0.0); 3];
            project(&dual, friction, &mut exact);
            for (closed, exact) in derivative(&x, &dx, friction).iter().zip(&exact) {
                prop_assert!((closed - exact.derivative).abs() < 1e-12);
            }
        }
    }
}
