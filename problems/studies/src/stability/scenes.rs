//! The scenes that cases are made of. Units: N, mm, MPa.

use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::error::SceneError;
use contact::scene::{
    Blocks, BodyScene, ContactScene, CounterSurface, Geometry, Load, Scene, Support, UpperBody, hertz, signorini,
};
use contact::shape::{HeightShape, ShapeBounds, ShapeScene, SplineKind};

pub const HELD: [bool; 3] = [true; 3];

/// Example 5.1 on 4³ bricks in 2³ subdomains.
pub fn block() -> Result<Scene, SceneError> {
    Ok(signorini()?.with_bricks([4; 3], [2; 3]))
}

/// Example 5.2 on 4³ bricks in 2³ subdomains per body.
pub fn pair() -> Result<Scene, SceneError> {
    Ok(hertz()?.with_bricks([4; 3], [2; 3]))
}

/// Two flat blocks of 10 × 10 × 10 mm on each other in uniform stress: pressure `pressure`, shear `shear` along x₁
/// (MPa), carried by tractions on the top and on the sides; the lower block stands on its held base, the upper one is
/// held by contact only. E = 1000 MPa, ν = 0. The exact state is λ_N = pressure·A, λ_T = −shear·A along x₁ at every
/// node.
pub fn stacked(friction: f64, pressure: f64, shear: f64) -> Result<Scene, SceneError> {
    let material = Material::new(1000.0, 0.0)?;
    let sides = || {
        vec![Load::traction(BlockFace::X1Max, [0.0, 0.0, shear]), Load::traction(BlockFace::X1Min, [0.0, 0.0, -shear])]
    };
    let mut upper_loads = sides();
    upper_loads.push(Load::traction(BlockFace::Top, [shear, 0.0, -pressure]));
    Ok(Scene {
        name: "stacked".into(),
        geometry: Geometry::Blocks(Blocks { size: [10.0, 10.0], bricks: [4; 3], subdomains: [2; 3] }),
        lower: BodyScene::new(material, vec![Support::new(BlockFace::Bottom, HELD)], sides()),
        upper: Some(UpperBody { body: BodyScene::new(material, vec![], upper_loads), top: 20.0 }),
        counter_surface: CounterSurface::Plane { height: 10.0 },
        contact: ContactScene::along_x3(BlockFace::Top, friction),
        shape: ShapeScene::Heights(HeightShape {
            spline: SplineKind::BSpline(1),
            control_points: [2, 2],
            bounds: ShapeBounds { minimum_height: 1e-9, slope: 1e6, volume: [1e-9, 1e12] },
            start_height: 10.0,
            fairness: 0.0,
        }),
    })
}

/// A block of 10 × 10 × 10 mm on a held base, sheared by a traction along x₁ on its sides and pressed from its sides,
/// below a rigid plane at a distance `gap`.
pub fn footed(gap: f64) -> Result<Scene, SceneError> {
    let stacked = stacked(0.3, 1.0, 0.0)?;
    let mut lower = stacked.lower;
    lower.material = Material::new(1000.0, 0.3)?;
    lower.loads =
        vec![Load::traction(BlockFace::X1Max, [-20.0, 0.0, 5.0]), Load::traction(BlockFace::X1Min, [20.0, 0.0, 5.0])];
    Ok(Scene {
        name: "footed".into(),
        lower,
        upper: None,
        counter_surface: CounterSurface::Plane { height: 10.0 + gap },
        ..stacked
    })
}

/// A scene with other materials: (E, ν) of the lower and the upper body.
pub fn with_materials(scene: Result<Scene, SceneError>, materials: &[(f64, f64)]) -> Result<Scene, SceneError> {
    let mut scene = scene?;
    for (body, (young, poisson)) in scene.bodies_mut().zip(materials) {
        let formulation = body.material.formulation();
        body.material = Material::new(*young, *poisson)?.with_formulation(formulation);
    }
    Ok(scene)
}

/// A scene with all tractions times a factor.
pub fn with_loads(scene: Result<Scene, SceneError>, factor: f64) -> Result<Scene, SceneError> {
    let mut scene = scene?;
    for load in scene.bodies_mut().flat_map(|body| &mut body.loads) {
        *load = load.scaled(factor);
    }
    Ok(scene)
}
