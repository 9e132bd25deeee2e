//! Bodies in space: what is hidden, edges, holes, views, sizes of files.

use figures::{Figure, Sign, Sketch, SketchBody, SketchMark, View, box_faces};
use std::f64::consts::TAU;

type Point = [f64; 3];

/// Points and faces.
type Skin = (Vec<Point>, Vec<Vec<usize>>);

/// A box with a corner at `at` and cells of length one; it bends upwards along the first axis.
fn block(cells: [usize; 3], at: Point, bend: f64) -> Skin {
    let nodes = cells.map(|count| count + 1);
    let points = (0..nodes.iter().product())
        .map(|node: usize| [node / (nodes[1] * nodes[2]), node / nodes[2] % nodes[1], node % nodes[2]])
        .map(|node| std::array::from_fn(|axis| at[axis] + node[axis] as f64))
        .map(|[x, y, z]: Point| [x, y, z + bend * (x - at[0]).powi(2)])
        .collect();
    (points, box_faces(nodes))
}

/// Half a disk on a square, 4 thick along the second axis, with a bore of radius 5; n quadrilaterals around it, every
/// third of which is cut into two triangles.
fn lug(around: usize, across: usize) -> Skin {
    let outside = |c: f64, s: f64| if s >= 0.0 { 10.0 } else { 10.0 / c.abs().max(0.5 * s.abs()) };
    let mut points = Vec::new();
    for step in 0..around {
        let (s, c) = (TAU * step as f64 / around as f64).sin_cos();
        for layer in 0..=across {
            let radius = 5.0 + layer as f64 / across as f64 * (outside(c, s) - 5.0);
            points.extend([0.0, 4.0].map(|y| [radius * c, y, radius * s]));
        }
    }
    let point = |step: usize, layer: usize, back: usize| (step % around * (across + 1) + layer) * 2 + back;
    let mut faces = Vec::new();
    for step in 0..around {
        let next = step + 1;
        let mut quads = Vec::new();
        for layer in 0..across {
            let ring = [(step, layer), (step, layer + 1), (next, layer + 1), (next, layer)];
            quads.push(ring.map(|(step, layer)| point(step, layer, 0)));
            quads.push([3, 2, 1, 0].map(|corner| point(ring[corner].0, ring[corner].1, 1)));
        }
        quads.push([(step, 0), (step, 1), (next, 1), (next, 0)].map(|(step, back)| point(step, across, back)));
        quads.push([(step, 0), (next, 0), (next, 1), (step, 1)].map(|(step, back)| point(step, 0, back)));
        for [a, b, c, d] in quads {
            match step % 3 {
                0 => faces.extend([vec![a, b, c], vec![a, c, d]]),
                _ => faces.push(vec![a, b, c, d]),
            }
        }
    }
    (points, faces)
}

fn sketch(skins: Vec<Skin>) -> Figure {
    let mark =
        |sign| SketchMark { sign, text: "u₁ = 0 & more".into(), lines: vec![[[0.4, 0.5, 0.5], [0.6, 0.5, 0.5]]] };
    let sketch = Sketch {
        name: "s".into(),
        title: "t".into(),
        axes: ["x".into(), "y".into(), "z".into()],
        bodies: skins.into_iter().map(|(points, faces)| SketchBody { points, faces }).collect(),
        view: View::default(),
        marks: vec![mark(Sign::Support), mark(Sign::Arrow)],
        notes: vec!["note".into()],
    };
    sketch.figure().expect("a body")
}

/// Lengths of the lines of a width in tenths of a point.
fn length(figure: &Figure, width: &str) -> f64 {
    let document = roxmltree::Document::parse(&figure.svg).expect("XML");
    let drawn = document.descendants().filter(|node| node.attribute("stroke-width") == Some(width));
    let steps = |path: &str| {
        let numbers: Vec<f64> = path.split(['l', ' ']).map(|number| number.parse().expect("a number")).collect();
        numbers.chunks(2).skip(1).map(|step| 0.1 * step[0].hypot(step[1])).sum::<f64>()
    };
    let lines = drawn.filter(|node| node.attribute("fill") == Some("none")).filter_map(|node| node.attribute("d"));
    lines.flat_map(|paths| paths.split('M').skip(1)).map(steps).sum()
}

/// Number of grey areas of the bodies.
fn layers(figure: &Figure) -> usize {
    figure.svg.matches("fill=\"#e6e6e6\"").count()
}

#[test]
fn what_is_hidden_leaves_no_trace() {
    let large = block([40, 40, 40], [0.0; 3], 0.0);
    let small = block([2, 2, 2], [20.0, 60.0, 4.0], 0.0);
    let [alone, both] = [vec![large.clone()], vec![large, small]].map(sketch);
    assert_eq!(layers(&alone), layers(&both));
    assert!((length(&alone, "7") - length(&both, "7")).abs() < 0.01 * length(&alone, "7"));
}

#[test]
fn bodies_that_bend_before_themselves_have_edges_only_where_they_have_some() {
    let mut meshed = block([2; 3], [0.0; 3], 0.0);
    meshed.0.iter_mut().flatten().for_each(|part| *part *= 0.5);
    let [meshed, once] = [meshed, block([1; 3], [0.0; 3], 0.0)].map(|skin| sketch(vec![skin]));
    // The edges stay; the lines between the faces are thinner.
    assert!(length(&meshed, "3.5") > 0.0 && length(&once, "3.5") == 0.0);
    assert!((length(&meshed, "7") - length(&once, "7")).abs() < 1.0);
    let bent = sketch(vec![block([8, 2, 2], [0.0; 3], 0.6)]);
    assert!(layers(&bent) > 1 && length(&bent, "7") > 0.0);
}

#[test]
fn bores_have_edges_and_fine_meshes_no_lines() {
    for (around, across) in [(24, 3), (96, 24)] {
        let sketch = sketch(vec![lug(around, across)]);
        assert_eq!(length(&sketch, "3.5") > 0.0, around == 24);
        assert!(length(&sketch, "7") > 1000.0);
    }
    let fine = lug(400, 60);
    assert!(fine.1.len() > 50_000);
    let figure = sketch(vec![fine.clone()]);
    assert!(figure.svg.len() < 100_000 && length(&figure, "3.5") == 0.0, "{}", figure.svg.len());
    assert_eq!(figure, sketch(vec![fine]));
}

#[test]
fn a_view_looks_at_the_face_with_its_normal() {
    let normals =
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    for normal in normals {
        let towards = View::towards(normal.map(|part| 3.0 * part)).towards_viewer();
        let height: f64 = towards.iter().zip(normal).map(|(part, normal)| part * normal).sum();
        assert!(height > 0.3, "{normal:?}");
    }
    assert_eq!([0, 1].map(|face| View::towards(normals[face])), [View::default(); 2]);
    assert_ne!(View::towards(normals[5]), View::default());
    for none in [[0.0; 3], [f64::NAN; 3], [f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(View::towards(none), View::default());
    }
}

#[test]
fn open_skins_are_seen_from_both_sides() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.0, 1.0, 0.0]];
    for face in [vec![0, 1, 2, 3], vec![3, 2, 1, 0], vec![2, 1, 0]] {
        assert_eq!(layers(&sketch(vec![(points.clone(), vec![face])])), 1);
    }
}

#[test]
fn every_mark_has_a_letter_at_its_place_and_in_the_legend() {
    for skin in [block([1; 3], [0.0; 3], 0.0), (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![vec![0, 1, 2]])]
    {
        let svg = sketch(vec![skin]).svg;
        assert_eq!((svg.matches(">A<").count(), svg.matches(">B<").count()), (2, 2));
        assert!(svg.contains("u₁ = 0 &amp; more") && svg.contains(">note<"));
    }
}
