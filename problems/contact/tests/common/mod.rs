//! What tests of states and of derivatives share.

#![allow(dead_code, reason = "either binary uses a part of it")]

use contact::scene::Scene;
use nonsmooth::Vector;
use testset::kit::wavy;

/// All heights of a scene at the start, mm.
pub fn start_height(scene: &Scene) -> f64 {
    scene.heights().expect("a height surface").start_height
}

/// Heights of a gently wavy surface just below the start.
pub fn bent(scene: &Scene) -> Vector {
    Vector::from_vec(wavy(start_height(scene), scene.control_count()))
}

/// A change of one of some controls by 1.
pub fn unit(count: usize, control: usize) -> Vec<f64> {
    (0..count).map(|index| f64::from(u8::from(index == control))).collect()
}

/// The length of a vector.
pub fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
