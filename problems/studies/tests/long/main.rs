//! Studies of minutes: `cargo test --locked -p studies --features long-tests --test long`.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod accuracy;
mod composite;
mod examples;
mod headline;
mod meshes;
#[path = "../optimizer/mod.rs"]
mod optimizer;
mod pins;
mod stability;
mod tutorial;
