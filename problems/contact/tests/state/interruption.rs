//! A state that nobody waits for any more is given up by every solver, and leaves no trace.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::hertz;
use nonsmooth::interruption::watched;
use nonsmooth::{Accuracy, Coderivative, OracleError, OutputJacobian, StateSolver, Vector};

#[test]
fn states_and_their_derivatives_are_interrupted() {
    let scene = hertz().unwrap().with_bricks([4; 3], [2; 3]);
    for kind in [SolverKind::Newton, SolverKind::Direct, SolverKind::Auto, SolverKind::AugmentedLagrangian] {
        let shape = ContactShape::new(scene.clone(), kind).unwrap();
        let start = shape.start();
        let solve = || shape.solve(&start, None, Accuracy::TIGHTEST);
        let refused = watched(|| true, solve);
        assert!(matches!(refused, Err(OracleError::Interrupted)), "{kind:?}: {refused:?}");
        let state = solve().unwrap();
        let again = watched(|| false, solve).unwrap();
        assert_eq!(state.forces.normal, again.forces.normal, "{kind:?}");
        let dual = Vector::from_element(shape.problem().boundary.row_count, 1.0);
        let adjoint = watched(|| true, || shape.coderivative(&start, &state, &dual));
        assert!(matches!(adjoint, Err(OracleError::Interrupted)), "{kind:?}");
        let tangents = watched(|| true, || shape.linearize(&start, &state, Accuracy::TIGHTEST));
        assert!(matches!(tangents, Err(OracleError::Interrupted)), "{kind:?}");
    }
}
