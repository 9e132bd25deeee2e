//! A coarse net of controls within those of the bodies.

use contact::error::SceneError;
use contact::scene::Scene;
use contact::shape::{self, CoarseNet};

/// Control points along every coordinate of a coarse net: a bowl or a saddle, with every slope. Nets of 4 were measured
/// to end higher on the seat of the tutorial, and nets of 3 and then 4 to take more evaluations for the same ends.
const COARSE: usize = 3;

/// Whether an optimization of a scene begins with attempts: a shape asks for them, and has more control points than a
/// coarse net.
pub fn begins_with_attempts(scene: &Scene) -> bool {
    scene.shapes().any(|shape| shape.attempts && shape.control_points.iter().any(|count| *count > COARSE))
}

/// The coarse net of a scene.
///
/// # Errors
/// As [`shape::coarse_net`].
pub fn coarse_net(scene: &Scene) -> Result<CoarseNet, SceneError> {
    shape::coarse_net(scene, COARSE)
}
