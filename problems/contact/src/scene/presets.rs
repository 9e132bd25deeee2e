//! The paper's examples; data and readings in method.md sections 7 and 8.

use crate::body::elasticity::Material;
use crate::body::mesh::BlockFace;
use crate::error::SceneError;
use crate::scene::{Blocks, BodyScene, ContactScene, CounterSurface, Geometry, Load, Scene, Support, UpperBody};
use crate::shape::{HeightShape, ShapeBounds, ShapeScene, SplineKind};

const ALONG_X1: [bool; 3] = [true, false, false];
const ALONG_X2: [bool; 3] = [false, true, false];
const ALONG_X3: [bool; 3] = [false, false, true];

/// Example 5.1: an elastic block pressed from below against a rigid wavy obstacle.
///
/// # Errors
/// Never for the constants used here; the material's check is passed on.
pub fn signorini() -> Result<Scene, SceneError> {
    Ok(Scene {
        name: "signorini".into(),
        geometry: Geometry::Blocks(Blocks { size: [100.0, 100.0], bricks: [12; 3], subdomains: [2; 3] }),
        lower: BodyScene::new(
            Material::new(1.1e5, 0.33)?,
            vec![Support::new(BlockFace::X1Min, [true, true, false])],
            vec![Load::traction(BlockFace::Bottom, [0.0, 0.0, 3000.0])],
        ),
        upper: None,
        counter_surface: CounterSurface::Waves {
            base: 103.0,
            first: 1.0,
            second: 2.0,
            period: 100.0,
            origin: [0.0; 2],
        },
        contact: ContactScene::along_x3(BlockFace::Top, 0.3),
        shape: ShapeScene::Heights(HeightShape {
            spline: SplineKind::BSpline(3),
            control_points: [6, 6],
            bounds: ShapeBounds { minimum_height: 50.0, slope: 5.0, volume: [0.8e6, 1.2e6] },
            start_height: 100.0,
            fairness: 0.0,
        }),
    })
}

/// Example 5.2: a quarter of a symmetric contact of an elastic body with a spherical indenter.
///
/// # Errors
/// Never for the constants used here; the material's check is passed on.
pub fn hertz() -> Result<Scene, SceneError> {
    let symmetry = || vec![Support::new(BlockFace::X1Min, ALONG_X1), Support::new(BlockFace::X2Min, ALONG_X2)];
    let mut lower_supports = symmetry();
    lower_supports.push(Support::new(BlockFace::Bottom, ALONG_X3));
    let loads = vec![
        Load::traction(BlockFace::Top, [0.0, 0.0, -2000.0]),
        Load::traction(BlockFace::X1Max, [500.0, 0.0, -2000.0]),
    ];
    Ok(Scene {
        name: "hertz".into(),
        geometry: Geometry::Blocks(Blocks { size: [10.0, 10.0], bricks: [12; 3], subdomains: [2; 3] }),
        lower: BodyScene::new(Material::new(7.0e4, 0.35)?, lower_supports, vec![]),
        upper: Some(UpperBody { body: BodyScene::new(Material::new(2.1e5, 0.29)?, symmetry(), loads), top: 20.0 }),
        counter_surface: CounterSurface::Sphere { apex: 10.0, radius: 20.0, centre: [0.0; 2] },
        contact: ContactScene::along_x3(BlockFace::Top, 0.3),
        shape: ShapeScene::Heights(HeightShape {
            spline: SplineKind::BSpline(3),
            control_points: [6, 6],
            bounds: ShapeBounds { minimum_height: 5.0, slope: 5.0, volume: [800.0, 1200.0] },
            start_height: 10.0,
            fairness: 0.0,
        }),
    })
}
