//! Examples of README, pages and the folder examples.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

mod documented_examples;
mod examples;
mod harness_example;
#[path = "../common/pages.rs"]
mod pages;
mod readme_example;
