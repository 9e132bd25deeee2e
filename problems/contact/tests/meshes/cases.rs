//! Blocks pressed against obstacles of every kind: what derivatives are tested on.

use crate::grid::{Point, boxed, mesh};
use crate::setting::{held, pushed, scene};
use contact::body::mesh::CellKind;
use contact::scene::{CounterSurface, Meridian, MeshSurface, Profile, Revolution, Scene, Side};
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
        ("cylinder", CounterSurface::cylinder([5.0, 4.4, top + 40.0], [1.0, 0.4, 0.03], 40.0, Side::Outside)),
        ("torus", torus(top).into()),
        ("profile", Revolution { meridian: profile(), ..torus(top) }.into()),
        ("mesh", CounterSurface::Mesh(wavy_mesh(top))),
        ("waves", CounterSurface::Waves { base: top + 0.1, first: 0.08, second: 0.1, period: 13.0, origin: [0.0; 2] }),
    ]
}

/// A ring that stands obliquely on the block.
fn torus(top: f64) -> Revolution {
    let meridian = Meridian::Circle { major_radius: 25.0, minor_radius: 30.0 };
    Revolution { point: [4.6, 4.2, top + 55.0], axis: [1.0, 0.3, 0.05], side: Side::Outside, meridian }
}

/// A crowned roll with a shoulder.
fn profile() -> Meridian {
    let points = (0..13).map(|k| f64::from(k) - 6.0).map(|z| [55.0 - 0.02 * z * z - 0.002 * z * z * z, z]);
    Meridian::Profile(Profile::new(points.collect()).expect("a profile"))
}

/// Waves above the block between curved facets that look down.
fn wavy_mesh(top: f64) -> MeshSurface {
    let (count, step) = (9_u32, 2.3);
    let place = |i: u32, j: u32| {
        let (x, y) = (step * f64::from(i) - 5.0, step * f64::from(j) - 5.0);
        [x, y, top + 0.1 + 0.08 * (0.5 * x).sin() + 0.1 * (0.4 * y).cos()]
    };
    let nodes = (0..=count).flat_map(|i| (0..=count).map(move |j| place(i, j)));
    let number = |i: u32, j: u32| i * (count + 1) + j;
    let corners = |i: u32, j: u32| vec![number(i, j), number(i, j + 1), number(i + 1, j + 1), number(i + 1, j)];
    let facets = (0..count).flat_map(|i| (0..count).map(move |j| corners(i, j)));
    MeshSurface::new("mesh", nodes.collect(), facets.collect(), Side::Outside).expect("a surface")
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
