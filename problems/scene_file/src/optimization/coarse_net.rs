//! A coarse net of controls within those of a height surface.

use contact::contact_objective::ContactObjective;
use contact::error::SceneError;
use contact::shape::HeightShape;
use nonsmooth::Matrix;

/// Control points per axis of a coarse net: a bowl or a saddle, with every slope. Nets of 4 were measured to end higher
/// on the seat of the tutorial, and nets of 3 and then 4 to take more evaluations for the same ends.
const COARSE: usize = 3;

/// Whether a height surface has more control points than a coarse net.
pub fn has_coarse_net(heights: &HeightShape) -> bool {
    heights.control_points.iter().any(|count| *count > COARSE)
}

/// The controls of a coarse net within those of the surface, as directions; none for other shapes.
///
/// # Errors
/// [`SceneError`] for a surface that is none.
pub fn coarse_directions(objective: &ContactObjective) -> Result<Option<Matrix>, SceneError> {
    let Some(heights) = objective.solver().problem().scene.heights() else { return Ok(None) };
    let surface = heights.surface()?;
    Ok(Some(surface.refinement(&surface.coarser(COARSE)?)?))
}
