//! What tests of states and of derivatives share.

use contact::scene::Scene;

/// All heights of a scene at the start, mm.
pub fn start_height(scene: &Scene) -> f64 {
    scene.heights().expect("a height surface").start_height
}

/// A change of one of some controls by 1.
pub fn unit(count: usize, control: usize) -> Vec<f64> {
    (0..count).map(|index| f64::from(u8::from(index == control))).collect()
}
