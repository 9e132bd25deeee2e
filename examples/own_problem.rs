//! A problem of one's own in three traits: a string above a table.
//!
//! A string of tension T is pulled down by a unit weight at its middle, a table of height a ≤ 0 may catch it there: 4T
//! u = −1 + λ, u ≥ a, λ ≥ 0, λ (u − a) = 0, so λ = max(0, 1 + 4T a). Wanted: little tension, a high table, little load
//! on it: J = T²/2 + 2a² + λ. As λ ≥ (1 + 4T a)/2, Θ ≥ 1/2 + (T + 2a)²/2, with equality only where the string just
//! touches the table: a = −√2/4, T = √2/2, Θ = 1/2.

use nonsmooth::{
    Accuracy, BundleTrust, BundleTrustConfig, Coderivative, Cost, CostGradient, OracleError, Polyhedron,
    ReducedObjective, Report, Sensitivity, StateSolver, Vector,
};

struct StringOverTable;

/// Load λ on the table.
struct Load(f64);

impl StateSolver for StringOverTable {
    type State = Load;
    type WarmStart = ();

    fn control_dimension(&self) -> usize {
        2 // height a, tension T
    }

    fn solve(&self, control: &Vector, _start: Option<&()>, _accuracy: Accuracy) -> Result<Load, OracleError> {
        if control[1] <= 0.0 {
            return Err(OracleError::OutsideDomain { reason: format!("tension {} is not positive", control[1]) });
        }
        Ok(Load((1.0 + 4.0 * control[1] * control[0]).max(0.0)))
    }

    fn warm_start(&self, _state: &Load) {}
}

impl Coderivative for StringOverTable {
    /// One element of D*S(a, T)(λ*): 0 where the string hangs free or just touches, otherwise λ* (4T, 4a).
    fn coderivative(&self, control: &Vector, state: &Load, direction: &Vector) -> Result<Sensitivity, OracleError> {
        let touching = if state.0 > 0.0 { direction[0] } else { 0.0 };
        Ok(Sensitivity::exact(Vector::from_vec(vec![4.0 * control[1] * touching, 4.0 * control[0] * touching])))
    }
}

struct Wishes;

impl Cost<Load> for Wishes {
    fn value(&self, control: &Vector, state: &Load) -> f64 {
        0.5 * control[1].powi(2) + 2.0 * control[0].powi(2) + state.0
    }

    fn gradient(&self, control: &Vector, _state: &Load) -> CostGradient {
        let control = Vector::from_vec(vec![4.0 * control[0], control[1]]);
        CostGradient { control, state: Vector::from_element(1, 1.0) }
    }
}

/// Minimises over −1 ≤ a ≤ 0, 0.1 ≤ T ≤ 3.
pub fn minimize() -> Result<Report, Box<dyn std::error::Error>> {
    let objective = ReducedObjective::new(StringOverTable, Wishes);
    let set = Polyhedron::boxed(Vector::from_vec(vec![-1.0, 0.1]), Vector::from_vec(vec![0.0, 3.0]))?;
    let mut method = BundleTrust::new(BundleTrustConfig::default())?.constraints(set);
    Ok(method.minimize(&objective, Vector::from_vec(vec![-0.1, 2.0]))?)
}

#[allow(dead_code, reason = "a test includes this file and calls `minimize`")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let report = minimize()?;
    println!("height {:.6}, tension {:.6}\n{report}", report.solution[0], report.solution[1]);
    Ok(())
}
