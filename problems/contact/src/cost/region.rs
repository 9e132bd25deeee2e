//! A part of the bodies: the bricks whose centres lie in a box.

use crate::body::elasticity::brick::volume;
use crate::equilibrium::ContactProblem;
use crate::error::{ContactError, SceneError};

/// A box of coordinates, its faces included, in one body or in all.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Smallest x₁, x₂, x₃, mm.
    pub lower: [f64; 3],
    /// Largest x₁, x₂, x₃, mm.
    pub upper: [f64; 3],
    /// 0 for the lower body alone, 1 for the upper one alone, none for all bodies.
    pub body: Option<usize>,
}

/// The bricks of a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionBricks {
    /// Bricks (i, j, k) of every body, lower first.
    pub bricks: Vec<Vec<[usize; 3]>>,
    /// Volume of these bricks at the start height, mm³.
    pub volume: f64,
}

/// Distance over the size of the scene at which a centre still counts as inside a box: rounding of its coordinates.
const ROUNDING: f64 = 1e-12;

impl Region {
    /// The bricks whose centres lie in the box.
    ///
    /// The lower body is taken as a block of the start height, so that no brick enters or leaves the region as the
    /// shape changes.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] if there is none, for a body that the scene does not have, and for an upper body that
    /// is inverted.
    pub fn bricks(&self, problem: &ContactProblem) -> Result<RegionBricks, SceneError> {
        let (grid, scene) = (&problem.grid, &problem.scene);
        let inverted = |error: ContactError| {
            SceneError::out_of_range("the bodies of objective.region", error, "bricks of positive volume")
        };
        let flat = vec![scene.start_height; scene.control_points.iter().product()];
        let blocks = problem.blocks(&flat).map_err(inverted)?;
        if let Some(body) = self.body.filter(|body| *body >= blocks.len()) {
            let allowed = "a body of the scene, which has no upper one";
            return Err(SceneError::out_of_range(
                "objective.body",
                if body == 1 { "upper" } else { "unknown" },
                allowed,
            ));
        }
        let slack = ROUNDING * scene.size[0].max(scene.size[1]).max(scene.start_height);
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut found = RegionBricks { bricks: vec![Vec::new(); blocks.len()], volume: 0.0 };
        for (body, block) in blocks.iter().enumerate().filter(|(body, _)| self.body.is_none_or(|own| own == *body)) {
            for brick in grid.bricks() {
                let nodes = block.brick(brick);
                let centre: [f64; 3] =
                    std::array::from_fn(|axis| nodes.iter().map(|node| node[axis]).sum::<f64>() / 8.0);
                let inside =
                    |axis: usize| centre[axis] >= self.lower[axis] - slack && centre[axis] <= self.upper[axis] + slack;
                if (0..3).all(inside) {
                    found.bricks[body].push(brick);
                    found.volume += volume(&nodes);
                }
                for axis in 0..3 {
                    least[axis] = least[axis].min(centre[axis]);
                    most[axis] = most[axis].max(centre[axis]);
                }
            }
        }
        if found.bricks.iter().all(Vec::is_empty) {
            let value = format!("{:?} to {:?}", self.lower, self.upper);
            let allowed = format!("a box that holds the centre of a brick; they lie between {least:?} and {most:?} mm");
            return Err(SceneError::out_of_range("objective.region", value, allowed));
        }
        Ok(found)
    }
}
