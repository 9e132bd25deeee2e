//! Problems with nonlinear constraints: minimise f(x) over lower ≤ x ≤ upper with cⱼ(x) ≤ 0 or cⱼ(x) = 0.
//!
//! `testset/reference` states every problem a second time and solves it: by IPOPT, confirmed by SLSQP of SciPy; with
//! limits on eigenvalues, by Clarabel as a semidefinite program, confirmed by IPOPT. The file `constrained.json` there
//! has optimal values, minimisers and sums of multipliers; tests compare it with the problems here. Where a source says
//! that limits or data were added here, the objective or the kind of problem is published, and the optimal value is
//! not.

mod eigenvalue;
mod equations;
mod fitting;
mod inequalities;
mod minimax;
mod problem;
mod scalable;

pub use problem::{ConstrainedProblem, ConstrainedValue, Kind};

/// All problems; the names are unique.
pub fn all() -> Vec<ConstrainedProblem> {
    [
        inequalities::problems(),
        equations::problems(),
        minimax::problems(),
        fitting::problems(),
        scalable::problems(),
        eigenvalue::problems(),
    ]
    .concat()
}

/// The problem of this name.
pub fn find(name: &str) -> Option<ConstrainedProblem> {
    all().into_iter().find(|problem| problem.name == name)
}
