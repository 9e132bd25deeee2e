//! Meshes that cannot be drawn are refused with an error that names the place; meshes that are unusual are drawn.

use figures::{ClassPanel, Classes, ColourScales, Figure, FigureError, Map, MapPanel, grid_faces};

type Faces = Vec<Vec<usize>>;
type Drawn = Result<Figure, FigureError>;

fn plane() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0]]
}

fn map(points: Vec<[f64; 2]>, faces: Faces, values: Vec<f64>, contours: bool) -> Drawn {
    Map {
        name: "s".into(),
        title: "t".into(),
        quantity: "v".into(),
        unit: "MPa".into(),
        axes: ["x".into(), "y".into()],
        scales: ColourScales::Common,
        contours,
        panels: vec![MapPanel { caption: "c".into(), points, faces, values }],
    }
    .figure()
}

fn classes(points: Vec<[f64; 2]>, faces: Faces) -> Drawn {
    let classes = (0..points.len()).map(|point| point % 2).collect();
    Classes {
        name: "s".into(),
        title: "t".into(),
        axes: ["x".into(), "y".into()],
        classes: vec!["open".into(), "closed".into()],
        arrows: None,
        panels: vec![ClassPanel { caption: "c".into(), points, faces, classes, arrows: vec![] }],
    }
    .figure()
}

/// All figures of one mesh, each with the words for its part.
fn all(faces: &Faces) -> [(&'static str, Drawn); 2] {
    [("panel 0", map(plane(), faces.clone(), vec![1.0; 6], true)), ("panel 0", classes(plane(), faces.clone()))]
}

#[test]
fn faces_that_are_no_triangles_and_no_quadrilaterals_are_refused() {
    let wrong = [vec![0, 1], vec![], vec![0, 1, 2, 3, 4], vec![0, 1, 8], vec![0, usize::MAX, 2], vec![0, 1, 1]];
    for face in wrong {
        for (part, drawn) in all(&vec![vec![0, 1, 2], face.clone()]) {
            let error = drawn.expect_err("refused");
            assert!(matches!(&error, FigureError::Face { points, face: 1, .. } if *points == face), "{error}");
            assert!(error.to_string().starts_with(&format!("figure s: {part}, face 1 joins the points")), "{error}");
        }
    }
    for (part, drawn) in all(&vec![]) {
        let error = drawn.expect_err("refused");
        assert!(matches!(error, FigureError::Empty { .. }) && error.to_string().ends_with(part), "{error}");
    }
    for (_, drawn) in all(&vec![vec![0, 2, 3, 1], vec![2, 4, 5]]) {
        drawn.expect("a quadrilateral and a triangle");
    }
}

#[test]
fn numbers_that_cannot_be_drawn_are_refused_with_their_place() {
    let words = |drawn: Drawn| drawn.expect_err("refused").to_string();
    for number in [f64::NAN, f64::INFINITY, 1e301] {
        let (mut flat, mut values) = (plane(), vec![1.0; 6]);
        (flat[4][0], values[3]) = (number, number);
        let map_words = words(map(plane(), grid_faces([3, 2]), values, false));
        assert!(map_words.contains("panel 0, value 3 is"), "{map_words}");
        assert!(words(classes(flat, grid_faces([3, 2]))).contains("panel 0, x"));
    }
}

#[test]
fn counts_that_differ_and_meshes_without_extent_are_refused() {
    let few = map(plane(), grid_faces([3, 2]), vec![1.0; 5], false);
    assert!(matches!(few, Err(FigureError::Count { expected: 6, found: 5, .. })));
    let flat: Vec<[f64; 2]> = plane().into_iter().map(|[x, _]| [x, 3.0]).collect();
    assert!(matches!(classes(flat, grid_faces([3, 2])), Err(FigureError::Number { index: 1, .. })));
}

#[test]
fn a_map_of_triangles_and_quadrilaterals_has_one_area_and_a_text_per_point() {
    // A ring of eight quadrilaterals around a hole; two are cut into triangles, one turns the other way.
    let points: Vec<[f64; 2]> = (0..16).map(|point| [f64::from(point / 4), f64::from(point % 4)]).collect();
    let mut faces = grid_faces([4, 4]);
    faces.remove(4);
    faces[0].reverse();
    for cut in [1, 6] {
        let [a, b, c, d] = faces[cut][..] else { panic!("a quadrilateral") };
        faces[cut] = vec![a, b, c];
        faces.push(vec![a, c, d]);
    }
    let values = points.iter().map(|[x, _]| *x).collect();
    let figure = map(points.clone(), faces.clone(), values, true).expect("a map");
    assert_eq!(figure.svg.matches("<title>node ").count(), 16);
    assert!(figure.svg.contains("<title>node 7 at (1, 3): 1 MPa</title>"));
    let constant = map(points, faces, vec![2.0; 16], false).expect("a map");
    let document = roxmltree::Document::parse(&constant.svg).expect("XML");
    let areas = document
        .descendants()
        .filter(|node| node.has_tag_name("path") && node.attribute("fill").is_some_and(|fill| fill.starts_with('#')));
    let borders: Vec<usize> = areas.filter_map(|node| Some(node.attribute("d")?.matches('M').count())).collect();
    assert_eq!(borders, [2]);
}

#[test]
fn values_without_order_have_coarser_colours() {
    let points: Vec<[f64; 2]> = (0..90_000).map(|node| [f64::from(node / 300), f64::from(node % 300)]).collect();
    let values = (0..90_000).map(|node| (f64::from(node) * 1.7).sin() + f64::from(node % 7)).collect();
    let svg = map(points, grid_faces([300, 300]), values, false).expect("a map").svg;
    assert!(svg.len() < 2_500_000, "{}", svg.len());
}
