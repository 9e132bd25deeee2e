//! What grids that do not match cost total FETI: products with the dual operator, against grids that match.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::{Geometry, Scene, hertz};
use nonsmooth::{Accuracy, StateSolver};

/// The Hertz scene with so many bricks and subdomains per edge of the lower and of the upper body.
fn scene(bodies: [[usize; 2]; 2]) -> Scene {
    let mut scene = hertz().unwrap();
    for (body, [bricks, subdomains]) in scene.bodies.iter_mut().zip(bodies) {
        if let Geometry::Block(block) = &mut body.geometry {
            (block.bricks, block.subdomains) = ([bricks; 3], [subdomains; 3]);
        }
    }
    scene
}

fn products(bodies: [[usize; 2]; 2], friction: f64) -> usize {
    let shape = ContactShape::new(scene(bodies).with_friction(friction), SolverKind::Newton).unwrap();
    let state = shape.solve(&shape.start(), None, Accuracy::TIGHTEST).unwrap();
    state.work().dual_operator_applications
}

#[test]
fn grids_that_do_not_match_take_a_few_more_products() {
    for friction in [0.3, 0.0] {
        let matching = products([[25, 5], [25, 5]], friction);
        for other in [[[25, 5], [20, 5]], [[20, 5], [25, 5]], [[25, 5], [15, 5]]] {
            let found = products(other, friction);
            println!(
                "{other:?} friction {friction}: {found} products, {matching} of matching grids: {:.2}",
                found as f64 / matching as f64
            );
        }
    }
}
