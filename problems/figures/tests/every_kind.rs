//! Every kind of figure as SVG: titles hold signs that XML reserves, and
//! superscripts.

use figures::{
    ClassPanel, Classes, ColourScales, Convergence, Curve, Figure, LinePanel, Lines, Map, MapPanel, Step, grid_faces,
};

fn title() -> String {
    "p < 10^{−3} & \"Θ\" \u{1}".into()
}

fn axes() -> [String; 2] {
    ["x₁ < 1".into(), "x₂ (mm^{2})".into()]
}

fn plots() -> [Figure; 1] {
    let step =
        |kind: &str, value: f64| Step { kind: kind.into(), origin: "<cuts>".into(), value: Some(value), best: value };
    let convergence = Convergence {
        name: "convergence".into(),
        title: title(),
        quantity: "Θ".into(),
        unit: "MPa^{4}".into(),
        steps: vec![step("a \"start\"", 9e16), step("<serious>", 2e16), step("null", 1e15), step("refined", 1e14)],
        course: "best so far".into(),
        reference: Some(("bound & floor".into(), 1e13)),
    };
    [convergence.figure().expect("numbers")]
}

/// n₁ × n₂ points of a rectangle, index i·n₂ + j, that begins at a place on the diagonal.
fn rectangle([n1, n2]: [usize; 2], origin: f64, size: [f64; 2]) -> Vec<[f64; 2]> {
    let along = |axis: usize, share: f64| origin + size[axis] * share;
    let point = |node: usize| [(node / n2) as f64 / (n1 - 1) as f64, (node % n2) as f64 / (n2 - 1) as f64];
    (0..n1 * n2).map(point).map(|[s, t]| [along(0, s), along(1, t)]).collect()
}

fn map(scales: ColourScales, contours: bool) -> Figure {
    let panel = |caption: &str, origin: f64| MapPanel {
        caption: caption.into(),
        points: rectangle([3, 2], origin, [100.0, 50.0]),
        faces: grid_faces([3, 2]),
        values: vec![0.0, 1.0, 2.0, -3.0, 5.0, 8.0 + origin],
    };
    let map = Map {
        name: "pressure".into(),
        title: title(),
        quantity: "pressure".into(),
        unit: "MPa".into(),
        axes: axes(),
        scales,
        contours,
        panels: vec![panel("a > b", 0.0), panel("c", 7.0)],
    };
    map.figure().expect("numbers")
}

fn lines_and_classes() -> [Figure; 2] {
    let curve = Curve { name: "a < b".into(), points: vec![(0.0, 1.0), (1.0, 1e18)] };
    let panel = LinePanel { caption: "x₂ > 3".into(), across: axes()[0].clone(), curves: vec![curve] };
    let lines = Lines {
        name: "cuts".into(),
        title: title(),
        quantity: "q".into(),
        unit: "MPa".into(),
        columns: 2,
        panels: vec![panel.clone(), panel.clone(), panel],
    };
    let panel = ClassPanel {
        caption: "c".into(),
        points: rectangle([3, 2], 0.0, [100.0, 50.0]),
        faces: grid_faces([3, 2]),
        classes: vec![0, 1, 1, 1, 0, 0],
        arrows: vec![[1.0, -2.0]; 6],
    };
    let classes = Classes {
        name: "status".into(),
        title: title(),
        axes: axes(),
        classes: vec!["open".into(), "<closed>".into()],
        arrows: Some(("traction".into(), "MPa".into())),
        panels: vec![panel.clone(), panel],
    };
    [lines.figure(), classes.figure()].map(|figure| figure.expect("numbers"))
}

fn all() -> Vec<Figure> {
    let maps = [map(ColourScales::Common, false), map(ColourScales::Own, true)];
    plots().into_iter().chain(maps).chain(lines_and_classes()).collect()
}

#[test]
fn every_figure_is_well_formed_and_all_of_its_text_lies_inside() {
    for figure in all() {
        let document =
            roxmltree::Document::parse(&figure.svg).unwrap_or_else(|error| panic!("{}: {error}", figure.name));
        let number =
            |node: &roxmltree::Node, name: &str| node.attribute(name).and_then(|text| text.parse::<f64>().ok());
        let root = document.root_element();
        let size = ["width", "height"].map(|side| number(&root, side).expect("a size"));
        let texts: Vec<_> = document.descendants().filter(|node| node.has_tag_name("text")).collect();
        for bar in document.descendants().filter(|node| node.attribute("class") == Some("bar")) {
            // Both ends of a colour bar have a label at their height.
            let inside = |tag: &'static str| bar.descendants().filter(move |node| node.has_tag_name(tag));
            let sides = |node: roxmltree::Node| ["y", "height"].map(|name| number(&node, name).expect("a number"));
            let steps: Vec<[f64; 2]> = inside("rect").map(sides).collect();
            let ends = steps
                .iter()
                .fold([f64::INFINITY, 0.0], |[top, foot], [y, height]| [top.min(*y), f64::max(foot, y + height)]);
            let labelled =
                |end: f64| inside("text").filter_map(|text| number(&text, "y")).any(|y| (y - end - 4.1).abs() < 0.2);
            assert!(ends.into_iter().all(labelled), "{}: {ends:?}", figure.name);
        }
        assert!(texts.len() > 5, "{}", figure.name);
        for text in texts {
            let place = ["x", "y"].map(|axis| number(&text, axis).expect("a place"));
            assert!((0..2).all(|axis| (0.0..=size[axis]).contains(&place[axis])), "{}: {place:?}", figure.name);
        }
        assert!(figure.svg.contains("<title>p &lt; 10^{−3} &amp; \"Θ\"  </title>"), "{}", figure.name);
        assert!(!figure.svg.contains("NaN") && figure.svg.contains("10<tspan dy="), "{}", figure.name);
    }
}

#[test]
fn the_parts_of_a_figure_hold_all_of_its_text_but_the_title() {
    let mut parted = 0;
    for figure in all().into_iter().filter(|figure| !figure.parts.is_empty()) {
        parted += 1;
        let document = roxmltree::Document::parse(&figure.svg).expect("XML");
        let number = |node: &roxmltree::Node, name: &str| {
            node.attribute(name).and_then(|text| text.parse::<f64>().ok()).expect("a number")
        };
        let size = ["width", "height"].map(|side| number(&document.root_element(), side));
        for part in &figure.parts {
            let [left, top, width, height] = part.map(f64::from);
            assert!(
                width > 0.0 && height > 0.0 && left + width <= size[0] && top + height <= size[1],
                "{}: {part:?}",
                figure.name
            );
        }
        for text in document.descendants().filter(|node| node.has_tag_name("text")).skip(1) {
            let [x, y] = ["x", "y"].map(|axis| number(&text, axis));
            let holds = |[left, top, width, height]: [f64; 4]| {
                (left..=left + width).contains(&x) && (top..=top + height).contains(&y)
            };
            assert!(figure.parts.iter().any(|part| holds(part.map(f64::from))), "{}: ({x}, {y})", figure.name);
        }
        // What the parts refer to.
        let named = document.descendants().filter(|node| node.attribute("id") == Some(figure.name.as_str()));
        assert_eq!(named.count(), 1, "{}", figure.name);
    }
    assert_eq!(parted, 5);
}

/// On a narrow page the parts of a figure stand alone.
#[test]
fn every_panel_of_a_map_has_labels_of_its_own() {
    let figure = map(ColourScales::Common, false);
    let document = roxmltree::Document::parse(&figure.svg).expect("XML");
    let labels = document.descendants().filter(|node| node.attribute("text-anchor") == Some("end"));
    let places: Vec<f64> = labels.filter_map(|node| node.attribute("x")?.parse().ok()).collect();
    for [left, _, width, _] in &figure.parts[..2] {
        let inside = f64::from(*left)..f64::from(left + width);
        assert!(places.iter().filter(|x| inside.contains(x)).count() >= 3, "{places:?} {inside:?}");
    }
}

#[test]
fn axes_have_their_ticks_where_the_numbers_are() {
    let curve = Curve { name: "a".into(), points: vec![(0.0, 0.0), (10.0, 10.0), (20.0, 20.0)] };
    let panels = vec![LinePanel { caption: String::new(), across: "x".into(), curves: vec![curve] }];
    let (name, title, quantity, unit) = ("l".into(), "t".into(), "q".into(), String::new());
    let plot = Lines { name, title, quantity, unit, columns: 1, panels }.figure().expect("numbers");
    let document = roxmltree::Document::parse(&plot.svg).expect("XML");
    let number = |node: &roxmltree::Node, name: &str| node.attribute(name).and_then(|text| text.parse::<f64>().ok());
    let label = |tick: &str, anchor: &str| {
        let mut texts = document.descendants().filter(|node| node.attribute("text-anchor") == Some(anchor));
        let written =
            |node: &roxmltree::Node| node.descendants().filter_map(|part| part.text()).any(|text| text == tick);
        texts.find(written).expect("a label")
    };
    let points: Vec<_> = document.descendants().filter(|node| node.attribute("class") == Some("point")).collect();
    for (point, tick) in points.iter().zip(["0", "10", "20"]) {
        assert_eq!(number(point, "cx"), number(&label(tick, "middle"), "x"));
    }
    // A label stands in the middle of its height.
    let heights = [number(&points[1], "cy"), number(&label("10", "end"), "y")].map(|height| height.expect("a height"));
    assert!((heights[1] - heights[0] - 4.2).abs() < 0.11, "{heights:?}");
}

/// A map eight times as tall as wide, with a colour bar behind every panel.
#[test]
fn texts_of_a_slim_map_do_not_overlap() {
    let panel = |caption: &str| MapPanel {
        caption: caption.into(),
        points: rectangle([6, 3], 0.0, [1.0, 8.0]),
        faces: grid_faces([6, 3]),
        values: (0..18).map(|value| 100.0 * f64::from(value)).collect(),
    };
    for scales in [ColourScales::Common, ColourScales::Own] {
        let map = Map {
            name: "slim".into(),
            title: title(),
            quantity: "pressure".into(),
            unit: "MPa".into(),
            axes: axes(),
            scales,
            contours: false,
            panels: vec![panel("start, Θ = 4.2917e3"), panel("optimum, Θ = 2.8297e2")],
        };
        let figure = map.figure().expect("numbers");
        let document = roxmltree::Document::parse(&figure.svg).expect("XML");
        let number = |node: &roxmltree::Node, name: &str| node.attribute(name).and_then(|text| text.parse().ok());
        let mut spans: Vec<(i64, f64, f64)> = document
            .descendants()
            .filter(|node| node.has_tag_name("text") && node.attribute("transform").is_none())
            .map(|node| {
                let written = node.descendants().filter(roxmltree::Node::is_text).filter_map(|part| part.text());
                let letters = written.map(|text| text.chars().count());
                let size: f64 = number(&node, "font-size").expect("a size");
                // Digits are not narrower than half of their height.
                let width = 0.5 * size * letters.sum::<usize>() as f64;
                let share = match node.attribute("text-anchor") {
                    Some("middle") => 0.5,
                    Some("end") => 1.0,
                    _ => 0.0,
                };
                let x: f64 = number(&node, "x").expect("a place");
                let y: f64 = number(&node, "y").expect("a place");
                (y.round() as i64, x - share * width, x + (1.0 - share) * width)
            })
            .collect();
        spans.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        assert!(spans.len() > 20);
        for pair in spans.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            assert!(pair[0].2 <= pair[1].1, "{scales:?}: {pair:?}");
        }
    }
}
