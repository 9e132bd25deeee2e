//! Bodies and surfaces in space: what covers what, edges, holes, views, sizes of files.

use figures::{
    Figure, Sign, Sketch, SketchBody, SketchMark, SolidBody, SolidPanel, Solids, SurfacePanel, Surfaces, View,
    box_faces, grid_faces,
};
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

/// Bodies with values.
fn solids(view: View, bodies: Vec<(Skin, Vec<f64>)>) -> Figure {
    let body = |((points, faces), values)| SolidBody { points, faces, values };
    let solids = Solids {
        name: "s".into(),
        title: "t".into(),
        quantity: "v".into(),
        unit: String::new(),
        axes: ["x".into(), "y".into(), "z".into()],
        note: "n".into(),
        view,
        panels: vec![SolidPanel { caption: "c".into(), bodies: bodies.into_iter().map(body).collect() }],
    };
    solids.figure().expect("bodies")
}

/// Bodies each with the same value at all points.
fn plain(bodies: Vec<(Skin, f64)>) -> Figure {
    let valued = |(skin, value): (Skin, f64)| {
        let values = vec![value; skin.0.len()];
        (skin, values)
    };
    solids(View::default(), bodies.into_iter().map(valued).collect())
}

fn sketch(view: View, (points, faces): Skin) -> Figure {
    let mark =
        |sign| SketchMark { sign, text: "u₁ = 0 & more".into(), lines: vec![[[0.4, 0.5, 0.5], [0.6, 0.5, 0.5]]] };
    let sketch = Sketch {
        name: "s".into(),
        title: "t".into(),
        axes: ["x".into(), "y".into(), "z".into()],
        bodies: vec![SketchBody { points, faces }],
        view,
        marks: vec![mark(Sign::Support), mark(Sign::Arrow)],
        notes: vec!["note".into()],
    };
    sketch.figure().expect("a body")
}

/// Colour and outlines of everything that is filled in the first panel of a figure, in the order of drawing.
fn areas(figure: &Figure) -> Vec<(String, Vec<Vec<[f64; 2]>>)> {
    let document = roxmltree::Document::parse(&figure.svg).expect("XML");
    let panel = document.descendants().find(|node| node.attribute("class") == Some("panel")).expect("a panel");
    let filled = |node: &roxmltree::Node| node.attribute("fill").is_some_and(|fill| fill != "none");
    let area = |node: roxmltree::Node| {
        let paths = node.attribute("d").expect("a path").split('M').skip(1).map(|path| {
            let numbers: Vec<f64> =
                path.trim_end_matches('z').split(['l', ' ']).map(|number| number.parse().expect("a number")).collect();
            let mut at = [0.0; 2];
            let steps = numbers.chunks(2).map(|step| {
                at = [at[0] + 0.1 * step[0], at[1] + 0.1 * step[1]];
                at
            });
            steps.collect::<Vec<[f64; 2]>>()
        });
        (node.attribute("fill").expect("a colour").to_owned(), paths.collect())
    };
    panel.descendants().filter(filled).map(area).collect()
}

/// The colour of the largest values.
fn largest(figure: &Figure) -> String {
    let document = roxmltree::Document::parse(&figure.svg).expect("XML");
    let bar = document.descendants().find(|node| node.attribute("class") == Some("bar")).expect("a bar");
    let mut steps = bar.descendants().filter(|node| node.has_tag_name("rect"));
    steps.next_back().and_then(|step| step.attribute("fill")).expect("a colour").to_owned()
}

/// Whether closed lines run round a place.
fn encloses(lines: &[Vec<[f64; 2]>], [x, y]: [f64; 2]) -> bool {
    let turns = |line: &Vec<[f64; 2]>| -> i32 {
        let sides = line.iter().zip(line.iter().cycle().skip(1));
        let crossing = |(a, b): (&[f64; 2], &[f64; 2])| {
            let right = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x;
            i32::from(right) * (i32::from(a[1] <= y && y < b[1]) - i32::from(b[1] <= y && y < a[1]))
        };
        sides.map(crossing).sum()
    };
    lines.iter().map(turns).sum::<i32>() != 0
}

/// The colour seen where the default view shows a point of a body that fills the drawing.
fn seen(figure: &Figure, points: &[Point], [x, y, z]: Point) -> Option<String> {
    let ((sin, cos), (rise_sin, rise_cos)) = (35.0_f64.to_radians().sin_cos(), 30.0_f64.to_radians().sin_cos());
    let place = |[x, y, z]: Point| [x * cos + y * sin, rise_sin * (x * sin - y * cos) - rise_cos * z];
    let ends = |places: &mut dyn Iterator<Item = f64>| {
        places.fold([f64::MAX, f64::MIN], |[low, high], place| [low.min(place), high.max(place)])
    };
    let areas = areas(figure);
    let at = [0, 1].map(|axis| {
        let all = ends(&mut points.iter().map(|&point| place(point)[axis]));
        let drawn = ends(&mut areas.iter().flat_map(|area| area.1.iter().flatten()).map(|place| place[axis]));
        drawn[0] + (place([x, y, z])[axis] - all[0]) / (all[1] - all[0]) * (drawn[1] - drawn[0])
    });
    areas.into_iter().rfind(|(_, lines)| encloses(lines, at)).map(|area| area.0)
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

#[test]
fn what_is_nearer_covers_the_rest_in_any_order_of_the_bodies() {
    let (front, back) = (block([2, 2, 2], [0.0; 3], 0.0), block([2, 2, 2], [0.5, 4.0, 0.0], 0.0));
    let all = [front.0.clone(), back.0.clone()].concat();
    for swapped in [false, true] {
        let mut bodies = vec![(front.clone(), 1.0), (back.clone(), 0.0)];
        if swapped {
            bodies.reverse();
        }
        let figure = plain(bodies);
        // The upper corner of the front box hides a side of the box behind it.
        let [near, far] = [[1.9, 0.1, 2.0], [2.0, 5.0, 2.0]].map(|point| seen(&figure, &all, point));
        assert!(near.is_some() && far.is_some() && near != far, "{near:?} {far:?}");
    }
}

#[test]
fn what_is_hidden_leaves_no_trace() {
    let large = block([40, 40, 40], [0.0; 3], 0.0);
    let alone = plain(vec![(large.clone(), 1.0)]);
    let small = block([2, 2, 2], [20.0, 60.0, 4.0], 0.0);
    let figure = plain(vec![(large, 1.0), (small, 0.0)]);
    assert_eq!((areas(&alone).len(), areas(&figure).len()), (1, 1));
}

#[test]
fn bodies_that_bend_before_themselves_have_edges_only_where_they_have_some() {
    let mut meshed = block([2; 3], [0.0; 3], 0.0);
    meshed.0.iter_mut().flatten().for_each(|part| *part *= 0.5);
    let [meshed, once] = [meshed, block([1; 3], [0.0; 3], 0.0)].map(|skin| sketch(View::default(), skin));
    // The edges stay; the lines between the faces are thinner.
    assert!(length(&meshed, "3.5") > 0.0 && length(&once, "3.5") == 0.0);
    assert!((length(&meshed, "7") - length(&once, "7")).abs() < 1.0);
    let bent = plain(vec![(block([8, 2, 2], [0.0; 3], 0.6), 1.0)]);
    assert!(areas(&bent).len() > 1 && length(&bent, "7") > 0.0);
}

#[test]
fn through_a_bore_one_sees_the_ground_and_its_wall() {
    // The value is the distance from the front.
    for (around, across) in [(24, 3), (96, 24)] {
        let skin = lug(around, across);
        let points = skin.0.clone();
        let values = points.iter().map(|point| point[1]).collect();
        let figure = solids(View::default(), vec![(skin, values)]);
        let see = |point: Point| seen(&figure, &points, point);
        let front = see([0.0, 0.0, -12.0]).expect("the front");
        // The front hides the wall of the bore at the right, and the back; the wall at the left is seen.
        for place in [[7.0, 0.0, 0.0], [-7.0, 0.0, 0.0], [0.0, 0.0, 7.0], [5.5, 0.0, 2.0], [-9.0, 0.0, -9.0]] {
            assert_eq!(see(place), Some(front.clone()), "{around} {place:?}");
        }
        assert!(see([-4.8, 2.0, 1.0]).is_some_and(|wall| wall != front));
        assert_eq!(see([0.5, 2.0, 0.5]), None);
        let sketch = sketch(View::default(), lug(around, across));
        // Mesh lines of fine meshes are not drawn; edges are.
        assert_eq!(length(&sketch, "3.5") > 0.0, around == 24);
        assert!(length(&sketch, "7") > 1000.0);
    }
}

#[test]
fn a_view_shows_the_face_with_the_normal_it_looks_at() {
    let cube = block([3; 3], [-1.5; 3], 0.0);
    let normals =
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    for normal in normals {
        let view = View::towards(normal.map(|part| 3.0 * part));
        // Whether the face with a normal, which has values of its own inside, is seen.
        let shown = |normal: Point| {
            let inside = |point: &Point| {
                let height: f64 = point.iter().zip(normal).map(|(part, normal)| part * normal).sum();
                height > 1.0 && point.iter().filter(|part| part.abs() > 1.0).count() == 1
            };
            let values = cube.0.iter().map(|point| if inside(point) { 1.0 } else { 0.0 }).collect();
            let figure = solids(view, vec![(cube.clone(), values)]);
            areas(&figure).iter().any(|(colour, _)| *colour == largest(&figure))
        };
        assert!(shown(normal) && !shown(normal.map(|part| -part)), "{normal:?}");
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
        let value = vec![1.0; 4];
        assert_eq!(areas(&solids(View::default(), vec![((points.clone(), vec![face]), value)])).len(), 1);
    }
}

#[test]
fn fine_meshes_stay_small_and_have_no_mesh_lines() {
    let paper = block([35, 35, 35], [0.0; 3], 0.002);
    let wave = |[x, y, z]: &Point| (0.2 * x).sin() * (0.3 * y).cos() * (0.1 * z).sin();
    let values = paper.0.iter().map(wave).collect();
    let figure = solids(View::default(), vec![(paper, values)]);
    assert!(figure.svg.len() < 100_000 && length(&figure, "3.5") == 0.0, "{}", figure.svg.len());
    let fine = lug(400, 60);
    assert!(fine.1.len() > 50_000);
    let values = fine.0.iter().map(|[x, y, z]| 1.0 / (1.0 + (x - 5.0).hypot(*z)) + 0.01 * y).collect();
    let bodies: Vec<(Skin, Vec<f64>)> = vec![(fine, values)];
    let figure = solids(View::default(), bodies.clone());
    assert!(figure.svg.len() < 100_000, "{}", figure.svg.len());
    assert_eq!(figure, solids(View::default(), bodies));
}

#[test]
fn every_mark_has_a_letter_at_its_place_and_in_the_legend() {
    for skin in [block([1; 3], [0.0; 3], 0.0), (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![vec![0, 1, 2]])]
    {
        let svg = sketch(View::default(), skin).svg;
        assert_eq!((svg.matches(">A<").count(), svg.matches(">B<").count()), (2, 2));
        assert!(svg.contains("u₁ = 0 &amp; more") && svg.contains(">note<"));
    }
}

/// Heights over 3 × 2 points.
fn surfaces(heights: [f64; 6]) -> Figure {
    let point = |(node, height): (usize, f64)| [1.5 * (node / 2) as f64, (node % 2) as f64, height];
    let points = heights.into_iter().enumerate().map(point).collect();
    let surfaces = Surfaces {
        name: "s".into(),
        title: "t".into(),
        quantity: "h".into(),
        unit: "mm".into(),
        panels: vec![SurfacePanel { caption: "c".into(), points, faces: grid_faces([3, 2]) }],
    };
    surfaces.figure().expect("numbers")
}

#[test]
fn flat_surfaces_are_not_magnified_and_small_differences_are() {
    let flat = surfaces([7.0; 6]);
    assert!(flat.svg.contains("heights × 1<"), "a flat surface has nothing to magnify");
    // Grey walls stand on the two sides that are turned towards the viewer.
    assert_eq!(areas(&flat).len(), 2);
    // A difference of 0.001 may be drawn up to 0.9 high: 500 times.
    let waved = surfaces([7.0, 7.0, 7.001, 7.0, 7.0, 7.0]);
    assert!(waved.svg.contains("heights × 500<"));
    assert_eq!(waved, surfaces([7.0, 7.0, 7.001, 7.0, 7.0, 7.0]));
}
