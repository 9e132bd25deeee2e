//! Files read back: triangles keep their distance and close the body, the B-spline in a STEP file is the one that was
//! given, and the edges of its solid fit together.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use exchange::step::{self, SplineHeights};
use exchange::{ExchangeError, stl};
use std::collections::BTreeMap;
use testset::kit::step_file::{Entities, Surface, entities};
use testset::kit::stl_file::{edges, triangles, volume};

#[test]
fn triangles_are_read_back_and_close_a_body() {
    let corners =
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 5.0]].map(|x| x.map(|x: f64| x as f32));
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|face| face.map(|corner: usize| corners[corner]));
    let body = triangles(&stl(&faces).unwrap());
    assert_eq!((body.as_slice(), edges(&body)), (&faces[..], (6, 0)));
    assert!((volume(&body) - 5.0).abs() < 1e-12);
    // Without one triangle it is open.
    assert_eq!(edges(&body[1..]).1, 3);
}

/// x₁² + x₁x₂ + 50 over [0, 4] × [0, 2], of degrees 3 and 2 with inner knots: control heights are the polar forms at
/// the knots.
fn polynomial() -> SplineHeights {
    let knots = [vec![0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 1.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]];
    let inner = |axis: usize, index: usize, degree: usize| &knots[axis][index + 1..=index + degree];
    let mean = |knots: &[f64]| knots.iter().sum::<f64>() / knots.len() as f64;
    let square = |t: &[f64]| (t[0] * t[1] + t[0] * t[2] + t[1] * t[2]) / 3.0;
    let heights = (0..6).flat_map(|i| (0..4).map(move |j| (i, j))).map(|(i, j)| {
        let (first, second) = (inner(0, i, 3), inner(1, j, 2));
        16.0 * square(first) + 8.0 * mean(first) * mean(second) + 50.0
    });
    SplineHeights::new([3, 2], knots.clone(), ([0.0; 2], [4.0, 2.0]), &heights.collect::<Vec<_>>()).unwrap()
}

#[test]
fn the_surface_in_the_file_is_the_surface() {
    let spline = polynomial();
    for text in [step::surfaces("a", [("", spline.patch())]), step::solid("a", &spline, 0.0).unwrap()] {
        let surface = Surface::of(&entities(&text));
        assert_eq!((surface.degrees, surface.points.len()), ([3, 2], 6));
        for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
            let [s, t] = [i, j].map(|index| f64::from(index) / 20.0);
            let [x1, x2, x3] = surface.at([s, t]);
            assert!((x1 - 4.0 * s).abs() < 1e-14 && (x2 - 2.0 * t).abs() < 1e-14, "({x1}, {x2}) at ({s}, {t})");
            assert!((x3 - (x1 * x1 + x1 * x2 + 50.0)).abs() < 1e-12, "{x3} at ({x1}, {x2})");
        }
    }
}

/// The ends of the edges of a file, by their numbers.
fn ends(file: &Entities) -> BTreeMap<usize, [usize; 2]> {
    let edges = file.iter().filter(|(_, (name, _))| name == "EDGE_CURVE");
    edges.map(|(&number, (_, parts))| (number, [parts[1].reference(), parts[2].reference()])).collect()
}

#[test]
fn the_edges_of_the_solid_fit_together() {
    let file = entities(&step::solid("a", &polynomial(), 0.0).unwrap());
    let ends = ends(&file);
    assert_eq!(ends.len(), 12);
    let mut passes: BTreeMap<usize, Vec<bool>> = BTreeMap::new();
    let loops: Vec<_> = file.values().filter(|(name, _)| name == "EDGE_LOOP").collect();
    assert_eq!(loops.len(), 6);
    for (_, parts) in loops {
        let mut path = Vec::new();
        for edge in parts[1].list() {
            let (name, parts) = &file[&edge.reference()];
            assert_eq!(name, "ORIENTED_EDGE");
            let forward = format!("{:?}", parts[4]).contains(".T.");
            passes.entry(parts[3].reference()).or_default().push(forward);
            let [from, to] = ends[&parts[3].reference()];
            path.push(if forward { [from, to] } else { [to, from] });
        }
        assert!((0..4).all(|side| path[side][1] == path[(side + 1) % 4][0]), "{path:?}");
    }
    // Every edge bounds two faces, which pass it in opposite directions.
    passes.values_mut().for_each(|directions| directions.sort_unstable());
    assert!(passes.len() == 12 && passes.values().all(|directions| *directions == [false, true]), "{passes:?}");
    // A curved edge begins and ends at the vertices that it names.
    for (number, [from, to]) in ends {
        let (_, parts) = &file[&number];
        let (name, curve) = &file[&parts[3].reference()];
        if name == "B_SPLINE_CURVE_WITH_KNOTS" {
            let points = curve[2].list();
            let place = |point: usize| file[&point].1[1].clone();
            let vertex = |vertex: usize| place(file[&vertex].1[1].reference());
            assert_eq!(place(points[0].reference()), vertex(from));
            assert_eq!(place(points[points.len() - 1].reference()), vertex(to));
        }
    }
}

#[test]
fn splines_that_are_none_are_refused() {
    let flat = |knots: Vec<f64>, heights: usize| {
        SplineHeights::new([1, 1], [knots, vec![0.0, 0.0, 1.0, 1.0]], ([0.0; 2], [1.0; 2]), &vec![1.0; heights])
    };
    assert!(flat(vec![0.0, 0.0, 1.0, 1.0], 4).is_ok());
    assert!(matches!(flat(vec![0.0, 0.0, 1.0, 1.0], 3), Err(ExchangeError::Count { .. })));
    assert!(matches!(flat(vec![0.0, 0.5, 1.0, 1.0], 4), Err(ExchangeError::Number { .. })));
    assert!(matches!(flat(vec![0.0, 0.0, 1.0, 0.5, 1.0], 6), Err(ExchangeError::Number { .. })));
    assert!(matches!(flat(vec![0.0, 1.0], 0), Err(ExchangeError::Count { .. })));
    let spline = flat(vec![0.0, 0.0, 1.0, 1.0], 4).unwrap();
    assert!(matches!(step::solid("a", &spline, 1.0), Err(ExchangeError::Thickness { .. })));
}
