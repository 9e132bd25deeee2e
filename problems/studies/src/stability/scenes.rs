//! The scenes that cases are made of. Units: N, mm, MPa.

use contact::body::elasticity::{Formulation, Material};
use contact::body::mesh::BlockFace;
use contact::error::SceneError;
use contact::scene::{
    Block, BodyFace, BodyScene, ContactScene, CounterSurface, Geometry, Load, Master, Scene, Support, hertz, signorini,
};
use contact::shape::{LatticeShape, ShapedFace};

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
    let shape = LatticeShape::heights(ShapedFace::Top, [2, 2], [1, 1], 10.0);
    let below = Block::new([10.0, 10.0], 10.0, [4; 3], [2; 3]);
    let [bottom, top] = [10.0, 20.0].map(|height| CounterSurface::Plane { height });
    let above = Block { bottom, top, ..below.clone() };
    let lower = BodyScene {
        supports: vec![Support::new(BlockFace::Bottom, HELD)],
        loads: sides(),
        shape: Some(shape),
        ..BodyScene::new("lower", Geometry::Block(below), material)
    };
    let upper = BodyScene { loads: upper_loads, ..BodyScene::new("upper", Geometry::Block(above), material) };
    let master = Master::Body(BodyFace::new(1, BlockFace::Bottom));
    let contact = ContactScene::along_x3(BodyFace::new(0, BlockFace::Top), master, friction);
    Ok(Scene { name: "stacked".into(), bodies: vec![lower, upper], contacts: vec![contact] })
}

/// A scene with another surface above its lower block: the obstacle, or the bottom of the upper block.
pub fn below(mut scene: Scene, surface: CounterSurface) -> Scene {
    if let Some(Master::Obstacle(obstacle)) = scene.contacts.first_mut().map(|contact| &mut contact.master) {
        *obstacle = surface;
    } else if let Some(Geometry::Block(block)) = scene.bodies.get_mut(1).map(|body| &mut body.geometry) {
        block.bottom = surface;
    }
    scene
}

/// A block of 10 × 10 × 10 mm on a held base, sheared by a traction along x₁ on its sides and pressed from its sides,
/// below a rigid plane at a distance `gap`.
pub fn footed(gap: f64) -> Result<Scene, SceneError> {
    let mut scene = stacked(0.3, 1.0, 0.0)?;
    scene.name = "footed".into();
    scene.bodies.truncate(1);
    scene.contacts[0].master = Master::Obstacle(CounterSurface::Plane { height: 10.0 + gap });
    let lower = &mut scene.bodies[0];
    lower.material = Material::new(1000.0, 0.3)?;
    lower.loads =
        vec![Load::traction(BlockFace::X1Max, [-20.0, 0.0, 5.0]), Load::traction(BlockFace::X1Min, [20.0, 0.0, 5.0])];
    Ok(scene)
}

/// A scene with other materials: (E, ν) of the lower and the upper body.
pub fn with_materials(
    scene: Result<Scene, SceneError>,
    materials: [(f64, f64); 2],
    formulation: Formulation,
) -> Result<Scene, SceneError> {
    let mut scene = scene?;
    for (body, (young, poisson)) in scene.bodies.iter_mut().zip(materials) {
        body.material = Material::new(young, poisson)?.with_formulation(formulation);
    }
    Ok(scene)
}

/// A scene with all tractions times a factor.
pub fn with_loads(scene: Result<Scene, SceneError>, factor: f64) -> Result<Scene, SceneError> {
    let mut scene = scene?;
    for load in scene.bodies.iter_mut().flat_map(|body| &mut body.loads) {
        *load = load.scaled(factor);
    }
    Ok(scene)
}
