//! Feet of points on counter surfaces: slopes by differences, feet of moved surfaces, places without a unique foot.

use contact::scene::{CounterSurface, HeightGrid, Side};

fn surfaces() -> Vec<CounterSurface> {
    let ball = |side| CounterSurface::Ball { centre: [4.0, -3.0, 40.0], radius: 30.0, side };
    let bore = |side| CounterSurface::Cylinder { point: [1.0, 2.0, 33.0], axis: [3.0, 1.0, 0.5], radius: 20.0, side };
    vec![
        CounterSurface::Plane { height: 12.0 },
        CounterSurface::Waves { base: 12.0, first: 0.5, second: -0.8, period: 25.0, origin: [2.0, -7.0] },
        CounterSurface::Sphere { apex: 11.0, radius: 50.0, centre: [3.0, 4.0] },
        CounterSurface::TiltedPlane { point: [0.0, 0.0, 12.0], normal: [0.2, -0.6, 2.0] },
        ball(Side::Outside),
        ball(Side::Inside),
        bore(Side::Outside),
        bore(Side::Inside),
        CounterSurface::Grid(HeightGrid::new([40.0; 2], [2, 2], vec![12.0, 13.0, 11.0, 15.0]).expect("a grid")),
    ]
}

/// Slopes are those of central differences; a gap by the exact distance falls along the normal.
#[test]
fn slopes_are_those_of_differences() {
    for surface in surfaces() {
        for x in [[5.0, 7.0, 10.0], [9.0, 2.0, 9.0]] {
            let foot = surface.foot(x).expect("a foot");
            let step = 1e-4;
            for axis in 0..3 {
                let at = |way: f64| {
                    let mut moved = x;
                    moved[axis] += way * step;
                    surface.foot(moved).expect("a foot")
                };
                let (before, after) = (at(-1.0), at(1.0));
                let gap = (after.gap - before.gap) / (2.0 * step);
                assert!((gap - foot.gap_slope[axis]).abs() < 1e-7, "{surface:?}");
                for i in 0..3 {
                    let normal = (after.normal[i] - before.normal[i]) / (2.0 * step);
                    assert!((normal - foot.normal_slope[i][axis]).abs() < 1e-8, "{surface:?} {i} {axis}");
                }
            }
            assert!((foot.normal.map(|n| n * n).iter().sum::<f64>().sqrt() - 1.0).abs() < 1e-14);
        }
    }
}

/// The foot lies on the surface: the point moved along the normal by the gap has no gap left.
#[test]
fn the_foot_lies_on_the_surface() {
    for surface in surfaces() {
        let x = [5.0, 7.0, 10.0];
        let foot = surface.foot(x).expect("a foot");
        let y = std::array::from_fn(|axis| x[axis] + foot.gap * foot.normal[axis]);
        let rest = surface.foot(y).expect("a foot").gap;
        assert!(rest.abs() < 1e-12, "{surface:?}: {rest}");
    }
}

/// Feet and heights of a moved surface are those of the surface, moved.
#[test]
fn moved_surfaces_have_moved_feet() {
    let by = [1.5, -0.75, 0.25];
    let punch = CounterSurface::Punch { height: 11.0, half_width: 4.0, relief: 3.0, centre: 1.0 };
    for surface in surfaces().into_iter().chain([punch]) {
        let moved = surface.moved(by);
        for x in [[5.0, 7.0, 10.0], [9.0, 2.0, 9.0], [-2.0, 1.0, 9.5]] {
            let y = std::array::from_fn(|axis| x[axis] + by[axis]);
            match (surface.foot(x), moved.foot(y)) {
                (Ok(foot), Ok(other)) => {
                    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
                    assert!(close(foot.gap, other.gap), "{surface:?}");
                    assert!((0..3).all(|axis| close(foot.normal[axis], other.normal[axis])), "{surface:?}");
                }
                (one, other) => assert_eq!(one, other, "{surface:?}"),
            }
            if surface.has_heights() {
                let heights = [surface.height(x[0], x[1]) + by[2], moved.height(y[0], y[1])];
                assert!((heights[0] - heights[1]).abs() < 1e-12, "{surface:?}: {heights:?}");
            }
        }
        let back = moved.moved(by.map(|x| -x));
        assert_eq!(back, surface);
    }
}

#[test]
fn where_there_is_no_unique_foot_the_reason_is_told() {
    // Waves of curvature radius 1/(0.8 (2π/25)²) ≈ 20, seen from 60 above their centre of curvature.
    let waves = CounterSurface::Waves { base: 12.0, first: 0.0, second: 0.8, period: 25.0, origin: [0.0; 2] };
    let reason = waves.foot([5.0, 0.0, -60.0]).expect_err("not unique");
    assert!(reason.contains("not unique") || reason.contains("no nearest point"), "{reason}");
    let ball = CounterSurface::Ball { centre: [1.0; 3], radius: 2.0, side: Side::Inside };
    assert!(ball.foot([1.0; 3]).expect_err("centre").contains("centre"));
    let punch = CounterSurface::Punch { height: 1.0, half_width: 2.0, relief: 3.0, centre: 0.0 };
    assert!(punch.foot([0.0; 3]).expect_err("step").contains("step"));
}
