//! Best values of optimizations on 12³ bricks, pinned; those on smaller meshes are compared by the tests of `problems`.

use serde_json::Value;
use studies::headline::run;
use studies::scaling::SceneName;
use testset::kit::check_pins;

const PINS: &str = include_str!("../../../tests/data/pins.json");

#[test]
fn optimizations_come_as_low_as_pinned() {
    let wanted = |pin: &Value| pin["command"] == "optimize" && pin["mesh"] == "12";
    check_pins(PINS, wanted, |name, arguments| {
        let scene = if name == "hertz3d" { SceneName::Hertz } else { SceneName::Signorini };
        run(scene, arguments).unwrap()
    });
}
