//! Blocks pressed against obstacles of every kind: what derivatives are tested on.

use crate::grid::{Point, boxed, mesh};
use crate::setting::{held, pushed, scene};
use contact::body::mesh::CellKind;
use contact::scene::{CounterSurface, Scene, Side};
use nonsmooth::Vector;
use nonsmooth::verify::seeded_direction;

const SIZE: Point = [10.0, 8.0, 6.0];
/// The least gap on the way of the load, mm.
const GAP: f64 = 0.02;

/// Obstacles above the top, all of them oblique to the axes there.
pub fn obstacles() -> Vec<(&'static str, CounterSurface)> {
    let top = SIZE[2] + GAP;
    vec![
        ("plane", CounterSurface::TiltedPlane { point: [5.0, 4.0, top], normal: [0.03, -0.05, 1.0] }),
        ("ball", CounterSurface::Ball { centre: [4.2, 4.5, top + 60.0], radius: 60.0, side: Side::Outside }),
        ("socket", CounterSurface::Ball { centre: [5.2, 3.5, top + 0.3 - 50.0], radius: 50.0, side: Side::Inside }),
        (
            "cylinder",
            CounterSurface::Cylinder {
                point: [5.0, 4.4, top + 40.0],
                axis: [1.0, 0.4, 0.03],
                radius: 40.0,
                side: Side::Outside,
            },
        ),
        ("waves", CounterSurface::Waves { base: top + 0.1, first: 0.08, second: 0.1, period: 13.0, origin: [0.0; 2] }),
    ]
}

/// A distorted block pressed and pushed from below, held along its near side: nodes of that side have cut rows.
pub fn pressed(kind: CellKind, obstacle: CounterSurface, friction: f64) -> Scene {
    let mut scene = scene(mesh(kind, [3, 3, 2], 0.2, boxed(SIZE)), obstacle, friction);
    scene.bodies[0].supports = vec![held("x1-min", [true, true, false])];
    scene.bodies[0].loads = vec![pushed("bottom", [3.0, 2.0, 25.0]), pushed("x1-max", [-2.0, 1.0, 1.0])];
    scene
}

/// A shape and a direction by their number.
pub fn shape_and_direction(count: usize, seed: u64) -> [Vector; 2] {
    [seeded_direction(count, seed) * 0.04, seeded_direction(count, seed + 1000)]
}
