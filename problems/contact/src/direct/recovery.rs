//! Displacements inside the condensed bodies.

use crate::direct::solver::DirectState;
use crate::linear::vector::add_scaled;

impl DirectState {
    /// Displacements over the dofs of a whole body of the state, along the axes. They are solved for when they are
    /// first asked for, and kept: fields, adjoint and tangents need the same ones.
    pub(super) fn displacement(&self, number: usize) -> &[f64] {
        self.displacements[number].get_or_init(|| {
            let sizes = self.contact.bodies.iter().map(|body| body.load.free.len());
            let first: usize = sizes.take(number).sum();
            let body = &self.contact.bodies[number];
            let contact = &self.solution.displacement[first..first + body.load.free.len()];
            let mut u = body.extend_under(contact, &self.solution.forces, &body.load.full);
            let mut lift = body.load.lift.clone();
            body.stiff().condensed.pattern.axes.turn_back(&mut lift);
            add_scaled(&mut u, 1.0, &lift);
            u
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::direct::DirectSolver;
    use crate::equilibrium::ContactProblem;
    use crate::scene::hertz;
    use std::sync::Arc;

    #[test]
    fn a_factor_that_was_given_back_is_computed_again_to_the_bit() {
        let scene = hertz().expect("the example").with_bricks([3; 3], [1; 3]);
        let controls = scene.start();
        let solver = DirectSolver::new(Arc::new(ContactProblem::new(scene).expect("a scene"))).expect("a pattern");
        let found = [false, true].map(|gives_back| {
            let state = solver.solve(&controls, None, 1e-10).expect("a state").solution;
            if gives_back {
                solver.patterns.iter().for_each(|pattern| pattern.give_latest_back(0));
            }
            solver.bodies(&state).expect("bodies")
        });
        assert_eq!(found[0], found[1]);
    }

    /// A function of the displacements needs them for its value, its adjoint and the estimate of its error.
    #[test]
    fn a_state_solves_for_its_displacements_once() {
        let scene = hertz().expect("the example").with_bricks([3; 3], [1; 3]);
        let controls = scene.start();
        let problem = Arc::new(ContactProblem::new(scene).expect("a scene"));
        let solver = DirectSolver::new(Arc::clone(&problem)).expect("a pattern");
        let state = solver.solve(&controls, None, 1e-10).expect("a state").solution;
        assert!(state.displacements.iter().all(|found| found.get().is_none()));
        let bodies = solver.bodies(&state).expect("bodies");
        let places: Vec<*const f64> = (0..2).map(|body| state.displacement(body).as_ptr()).collect();
        let mut dual = vec![0.0; problem.boundary.row_count];
        dual.extend(bodies.iter().flat_map(|body| body.displacement.as_flattened()));
        solver.sensitivities(&state, &dual).expect("an adjoint");
        assert_eq!((0..2).map(|body| state.displacement(body).as_ptr()).collect::<Vec<_>>(), places);
        assert_eq!(solver.bodies(&state).expect("bodies"), bodies);
    }
}
