//! Plates and rods on total FETI: the state is that of direct condensation.

use crate::common::change_counter_surface;
use contact::body::mesh::BlockFace;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::linear::vector::{add_scaled, norm};
use contact::scene::{CounterSurface, Load, signorini};
use nonsmooth::{Accuracy, StateSolver};

/// Rounding of the factors decides how often directions are found anew: 1400 to 1750 products with several elimination
/// orders.
const FLAT: usize = 2000;
const TALL: usize = 520;

#[test]
fn plates_one_to_a_hundred_and_rods_are_solved() {
    // The plate was refused before K⁺ was balanced.
    for (height, pressure, allowed) in [(1.0, 30.0, FLAT), (1e4, 30.0, TALL)] {
        let mut scene = signorini().unwrap().with_bricks([4; 3], [2; 3]).with_shapes(|heights| {
            (heights.start, heights.thickness) = (height, Some(0.5 * height));
            heights.volume = Some([0.8e4 * height, 1.2e4 * height]);
        });
        change_counter_surface(&mut scene, |_| CounterSurface::Plane { height: 1.00001 * height });
        scene.bodies[0].loads = vec![Load::traction(BlockFace::Bottom, [0.0, 0.0, pressure])];
        let solve = |kind| {
            let shape = ContactShape::new(scene.clone(), kind).unwrap();
            let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
            let products = state.work().dual_operator_applications;
            (state.forces.normal, products)
        };
        let ((mut difference, products), (direct, _)) = (solve(SolverKind::Newton), solve(SolverKind::Direct));
        add_scaled(&mut difference, -1.0, &direct);
        let relative = norm(&difference) / norm(&direct);
        assert!(relative < 1e-6, "height {height}: {relative:e}");
        assert!(products <= allowed, "height {height}: {products}, allowed: {allowed}");
    }
}
