//! Feet of points on counter surfaces: slopes by differences, feet of moved surfaces, places without a unique foot.

use contact::scene::{CounterSurface, HeightGrid, Meridian, MeshSurface, Profile, Revolution, Side};

fn surfaces() -> Vec<CounterSurface> {
    let ball = |side| CounterSurface::Ball { centre: [4.0, -3.0, 40.0], radius: 30.0, side };
    let bore = |side| CounterSurface::cylinder([1.0, 2.0, 33.0], [3.0, 1.0, 0.5], 20.0, side);
    let turned = |side, meridian| {
        CounterSurface::from(Revolution { point: [1.0, 2.0, 33.0], axis: [3.0, 1.0, 0.5], side, meridian })
    };
    let torus = |side, major_radius, minor_radius| turned(side, Meridian::Circle { major_radius, minor_radius });
    let profile = (0..9).map(|k| f64::from(k) * 8.0 - 32.0).map(|z| [20.0 - 0.01 * z * z + 0.1 * z, z]).collect();
    let profile = Profile::new(profile).expect("a profile");
    vec![
        CounterSurface::Plane { height: 12.0 },
        CounterSurface::Waves { base: 12.0, first: 0.5, second: -0.8, period: 25.0, origin: [2.0, -7.0] },
        CounterSurface::Sphere { apex: 11.0, radius: 50.0, centre: [3.0, 4.0] },
        CounterSurface::TiltedPlane { point: [0.0, 0.0, 12.0], normal: [0.2, -0.6, 2.0] },
        ball(Side::Outside),
        ball(Side::Inside),
        bore(Side::Outside),
        bore(Side::Inside),
        turned(Side::Outside, Meridian::Line { radius: 20.0, slope: 0.3 }),
        turned(Side::Inside, Meridian::Line { radius: 30.0, slope: -0.6 }),
        torus(Side::Outside, 12.0, 8.0),
        torus(Side::Outside, -80.0, 100.0),
        torus(Side::Inside, 25.0, 4.0),
        turned(Side::Outside, Meridian::Profile(profile.clone())),
        turned(Side::Inside, Meridian::Profile(profile)),
        CounterSurface::Mesh(wavy(Side::Outside, 12.0)),
        CounterSurface::Mesh(wavy(Side::Inside, 12.0)),
        CounterSurface::Mesh(bowl(8)),
        CounterSurface::Grid(HeightGrid::new([40.0; 2], [2, 2], vec![12.0, 13.0, 11.0, 15.0]).expect("a grid")),
    ]
}

/// Facets of a surface over two parameters, whose outside looks to that of the parameters' sense.
fn facets(counts: [usize; 2], place: impl Fn(f64, f64) -> [f64; 3]) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let [m, n] = counts;
    let share = |k: usize, count: usize| k as f64 / count as f64;
    let nodes = (0..=m).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| place(share(i, m), share(j, n)));
    let number = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let facets = (0..m).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        corners.map(|(i, j)| number(i, j)).to_vec()
    });
    (nodes.collect(), facets.collect())
}

/// Waves about a height over a square, with the body below them: its outside looks down.
fn wavy(side: Side, height: f64) -> MeshSurface {
    let (nodes, mut facets) = facets([12, 12], |s, t| {
        let (x, y) = (60.0 * s - 20.0, 60.0 * t - 20.0);
        [x, y, height + 0.6 * (0.15 * x).sin() + 0.5 * (0.12 * y).cos()]
    });
    if side == Side::Outside {
        facets.iter_mut().for_each(|facet| facet.reverse());
    }
    MeshSurface::new("mesh", nodes, facets, side).expect("a surface")
}

/// A part of a sphere of radius 30 about (4, −3, 40) that looks outwards, below its centre.
fn bowl(count: usize) -> MeshSurface {
    let (nodes, facets) = facets([count, count], |s, t| {
        let (a, b) = (0.8 - 1.6 * s, 1.6 * t - 0.8);
        [4.0 + 30.0 * a.sin(), -3.0 + 30.0 * a.cos() * b.sin(), 40.0 - 30.0 * a.cos() * b.cos()]
    });
    MeshSurface::new("mesh", nodes, facets, Side::Outside).expect("a surface")
}

/// A mesh on a sphere has the feet of the sphere, and beyond its rim those of its rim.
#[test]
fn meshes_on_primitives_have_their_feet() {
    let ball = CounterSurface::Ball { centre: [4.0, -3.0, 40.0], radius: 30.0, side: Side::Outside };
    let bowl = CounterSurface::Mesh(bowl(8));
    for x in [[5.0, 7.0, 8.0], [-9.0, 2.0, 9.0], [4.0, -3.0, 12.0]] {
        let (one, other) = (ball.foot(x).expect("a foot"), bowl.foot(x).expect("a foot"));
        assert!((one.gap - other.gap).abs() < 1e-11, "{one:?} {other:?}");
        let both = |of: fn(&contact::scene::Foot) -> [f64; 12]| of(&one).into_iter().zip(of(&other));
        let numbers = |foot: &contact::scene::Foot| {
            let mut all = [0.0; 12];
            all[..3].copy_from_slice(&foot.normal);
            all[3..].copy_from_slice(foot.normal_slope.as_flattened());
            all
        };
        assert!(both(numbers).all(|(a, b)| (a - b).abs() < 1e-10), "{one:?} {other:?}");
    }
    let beside = bowl.foot([80.0, -3.0, 30.0]).expect("a foot");
    let rim = (0..=16_000).map(|k| f64::from(k) * 1e-4 - 0.8).map(|b| {
        let place = [30.0 * 0.8_f64.sin(), 30.0 * 0.8_f64.cos() * b.sin(), -30.0 * 0.8_f64.cos() * b.cos()];
        (place[0] - 76.0).hypot(place[1]).hypot(place[2] + 10.0)
    });
    let expected = rim.fold(f64::INFINITY, f64::min);
    // Middles of the edges of the rim lie on the sphere, not on the circle.
    assert!((beside.gap - expected).abs() < 0.1 && beside.normal[0] < -0.9, "{beside:?}");
}

/// Gaps of a free-form mesh are of third order at least, its normals of second.
#[test]
fn meshes_converge_to_their_surface() {
    let waves = CounterSurface::Waves { base: 12.0, first: 0.6, second: -0.8, period: 25.0, origin: [2.0, -7.0] };
    let errors = [16, 32, 64].map(|count| {
        let (nodes, mut facets) = facets([count, count], |s, t| {
            let (x, y) = (50.0 * s - 20.0, 50.0 * t - 20.0);
            [x, y, waves.height(x, y)]
        });
        facets.iter_mut().for_each(|facet| facet.reverse());
        let mesh = CounterSurface::Mesh(MeshSurface::new("mesh", nodes, facets, Side::Outside).expect("a surface"));
        let places = (0..20).flat_map(|i| (0..20).map(move |j| [f64::from(i) - 7.3, f64::from(j) - 8.1, 10.5]));
        places.fold([0.0_f64; 2], |[gap, normal], x| {
            let (one, other) = (waves.foot(x).expect("a foot"), mesh.foot(x).expect("a foot"));
            let turned = (0..3).map(|axis| (one.normal[axis] - other.normal[axis]).abs()).fold(0.0, f64::max);
            [gap.max((one.gap - other.gap).abs()), normal.max(turned)]
        })
    });
    for pair in errors.windows(2) {
        let [gap, normal] = [0, 1].map(|k| pair[0][k] / pair[1][k]);
        assert!(gap > 7.0 && normal > 3.4, "{errors:?}");
    }
}

/// Gap and normal go on across edges of facets, and off the rim.
#[test]
fn feet_on_meshes_are_continuous() {
    let step =
        [[0.0, 0.0, 0.0], [0.0, 10.0, 0.0], [10.0, 10.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 6.0], [10.0, 0.0, 6.0]];
    // A block above the body, seen from below, with its side wall.
    let facets = vec![vec![0, 1, 2, 3], vec![3, 2, 4, 5]];
    let block = CounterSurface::Mesh(MeshSurface::new("mesh", step.to_vec(), facets, Side::Outside).expect("a block"));
    let gap = |x| block.foot(x).expect("a foot").gap;
    for (x, expected) in [
        ([5.0, 5.0, -1.0], 1.0),
        ([13.0, 5.0, -4.0], 5.0),
        ([12.0, 5.0, 3.0], 2.0),
        ([5.0, 5.0, 0.5], -0.5),
        ([9.0, 5.0, 2.0], -1.0),
        ([-3.0, 5.0, -4.0], 5.0),
    ] {
        assert!((gap(x) - expected).abs() < 1e-13, "{x:?}: {}", gap(x));
    }
    let waves = CounterSurface::Mesh(wavy(Side::Outside, 12.0));
    let mut last: Option<contact::scene::Foot> = None;
    for k in 0..6000 {
        let foot = waves.foot([-15.0 + 0.005 * f64::from(k), 1.7 + 0.002 * f64::from(k), 10.0]).expect("a foot");
        if let Some(last) = last {
            let turned = (0..3).map(|axis| (foot.normal[axis] - last.normal[axis]).abs()).fold(0.0, f64::max);
            assert!((foot.gap - last.gap).abs() < 2e-3 && turned < 2e-3, "{k}: {foot:?} {last:?}");
        }
        last = Some(foot);
    }
}

#[test]
fn what_is_no_surface_is_refused() {
    let nodes = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    for (facets, words) in [
        (vec![vec![0, 1, 5]], "o: facet = [0, 1, 5] is not allowed"),
        (vec![vec![0, 1]], "o: facet = [0, 1] is not allowed"),
        (vec![vec![0, 1, 1]], "o: facets = none"),
        (vec![vec![0, 1, 2], vec![1, 2, 3]], "o: an edge = from [1.0, 0.0, 0.0] to [0.0, 1.0, 0.0] is not allowed"),
    ] {
        let refusal = MeshSurface::new("o", nodes.clone(), facets, Side::Outside).expect_err(words).to_string();
        assert!(refusal.starts_with(words) && refusal.contains("; allowed: "), "{refusal}");
    }
    let refusal = MeshSurface::new("o", vec![[f64::NAN; 3]], Vec::new(), Side::Outside).expect_err("NaN").to_string();
    assert!(refusal.starts_with("o: node 1 = [NaN"), "{refusal}");
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
                assert!((gap - foot.gap_slope[axis]).abs() < 1e-7, "{surface:?} {axis}: {gap} {:?}", foot.gap_slope);
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
