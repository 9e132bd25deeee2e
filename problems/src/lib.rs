//! State problems for the nonsmooth framework.

pub mod accuracy;
pub mod cli;
pub mod contact;
pub mod contact_shape;
pub mod cost;
pub mod direct;
pub mod elasticity;
pub mod error;
pub mod figure;
pub mod linear;
pub mod membrane;
pub mod memory;
pub mod mesh;
pub mod qp;
pub mod scalar;
pub mod scaling;
pub mod scene;
pub mod scene_file;
pub mod shape;
pub mod shape_load;
pub mod shape_sensitivity;
pub mod stability;
pub mod tfeti;
pub mod toy;
