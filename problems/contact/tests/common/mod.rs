//! What tests of states and of derivatives share.

#![allow(dead_code, reason = "either binary uses a part of it")]

use contact::body::elasticity::Material;
use contact::body::mesh::BlockFace;
use contact::scene::{Block, BodyFace, BodyScene, CounterSurface, Geometry, Load, Master, Scene, Support};
use nonsmooth::Vector;
use testset::kit::wavy;

/// All heights of a scene at the start, mm.
pub fn start_height(scene: &Scene) -> f64 {
    scene.heights().expect("heights of a face").start
}

/// Heights of a gently wavy surface just below the start.
pub fn bent(scene: &Scene) -> Vector {
    Vector::from_vec(wavy(start_height(scene), scene.control_count()))
}

/// What lies opposite to the lower body: the obstacle, or the bottom of the upper block.
pub fn counter_surface(scene: &Scene) -> &CounterSurface {
    match &scene.contacts[0].master {
        Master::Obstacle(surface) => surface,
        Master::Body(face) => &scene.bodies[face.body].block().expect("a block").bottom,
    }
}

/// Changes what lies opposite to the lower body.
pub fn change_counter_surface(scene: &mut Scene, change: impl Fn(&CounterSurface) -> CounterSurface) {
    let changed = change(counter_surface(scene));
    match &mut scene.contacts[0].master {
        Master::Obstacle(surface) => *surface = changed,
        Master::Body(face) => {
            let Geometry::Block(block) = &mut scene.bodies[face.body].geometry else { panic!("no block") };
            block.bottom = changed;
        }
    }
}

/// Lets the upper block end in a plane at some height.
pub fn set_top(scene: &mut Scene, height: f64) {
    let Geometry::Block(block) = &mut scene.bodies[1].geometry else { panic!("no block") };
    block.top = CounterSurface::Plane { height };
}

/// Puts a block in the place of the obstacle: its bottom has the heights of the obstacle, its top is a plane.
pub fn set_upper_block(scene: &mut Scene, top: f64, material: Material, supports: Vec<Support>, loads: Vec<Load>) {
    let bottom = counter_surface(scene).clone();
    let top = CounterSurface::Plane { height: top };
    let block = Block { bottom, top, ..scene.bodies[0].block().expect("a block").clone() };
    scene.bodies.push(BodyScene { supports, loads, ..BodyScene::new("upper", Geometry::Block(block), material) });
    scene.contacts[0].master = Master::Body(BodyFace::new(1, BlockFace::Bottom));
}

/// A change of one of some controls by 1.
pub fn unit(count: usize, control: usize) -> Vec<f64> {
    (0..count).map(|index| f64::from(u8::from(index == control))).collect()
}

/// The length of a vector.
pub fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
