//! Numbers pinned to the last bit: Θ and ξ of states, histories of optimizations.
//!
//! The dense kernels choose their instructions by the processor: where it lacks those of the processor that wrote the
//! pins (AVX-512), numbers are compared to 1e-8, and of a history only the first 15, which rounding cannot yet have led
//! apart.

use crate::kit::numbers;
use serde_json::Value;

/// How far a number may be off where the kernels round differently.
const OTHER_PROCESSOR: f64 = 1e-8;

/// How far above the pinned best value that of an optimization may lie, relative to it.
const BEST_MARGIN: f64 = 0.1;

/// Whether the dense kernels round as on the processor that wrote the pins and the tables of the pages.
#[cfg(target_arch = "x86_64")]
pub fn rounds_alike() -> bool {
    std::arch::is_x86_feature_detected!("avx512f")
}

/// Whether the dense kernels round as on the processor that wrote the pins and the tables of the pages.
#[cfg(not(target_arch = "x86_64"))]
pub fn rounds_alike() -> bool {
    false
}

fn text<'a>(pin: &'a Value, key: &str) -> &'a str {
    pin[key].as_str().unwrap_or_else(|| panic!("{key} is no text"))
}

/// Compares the pins of `file` that are `wanted` with what `run` finds now: the JSON of the binary of this name with
/// these arguments and `--json`.
///
/// # Panics
/// When a number differs, when the file is no list of pins, or when no pin is wanted.
pub fn check_pins(file: &str, wanted: impl Fn(&Value) -> bool, run: impl Fn(&str, &[&str]) -> Value) {
    let pins: Vec<Value> = serde_json::from_str(file).expect("a list of pins");
    let (mut wrong, mut count) = (Vec::new(), 0);
    for pin in pins.iter().filter(|pin| wanted(pin)) {
        count += 1;
        let optimize = text(pin, "command") == "optimize";
        let mut arguments = vec![text(pin, "command"), "--mesh", text(pin, "mesh"), "--solver", text(pin, "solver")];
        if optimize {
            arguments.extend(["--optimizer", "bundle", "--max-evaluations", "60"]);
        }
        let report = run(text(pin, "binary"), &arguments);
        let expected = numbers(&pin["values"]);
        let found = if optimize {
            let course = report["course"].as_array().map_or(&[][..], Vec::as_slice);
            course.iter().map(|entry| entry["objective"].as_f64().unwrap_or(f64::NAN)).collect()
        } else {
            let objective = report["objective"].as_f64().unwrap_or(f64::NAN);
            [vec![objective], numbers(&report["subgradient"])].concat()
        };
        if optimize {
            // Rounding leads two courses apart: the best values are compared, with room.
            let best = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
            let (expected, found) = (best(&expected), best(&found));
            if found > (1.0 + BEST_MARGIN) * expected {
                wrong.push(format!("{} {} mesh {}: {found:e}", pin["binary"], pin["solver"], pin["mesh"]));
            }
            continue;
        }
        let scale = expected.iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
        let allowed = if rounds_alike() { 0.0 } else { OTHER_PROCESSOR * scale };
        let equal = expected.len() == found.len() && expected.iter().zip(&found).all(|(a, b)| (a - b).abs() <= allowed);
        if !equal {
            let first = expected.iter().zip(&found).position(|(a, b)| a != b);
            wrong.push(format!("{} {} mesh {}: entry {first:?}", pin["binary"], pin["solver"], pin["mesh"]));
        }
    }
    assert!(wrong.is_empty() && count > 0, "{count} pins compared, wrong: {wrong:#?}");
}
