//! Examples of README, pages and the folder examples.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod documented_examples;
mod examples;
mod readme_example;
