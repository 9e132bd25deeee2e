//! Changes of a mesh: those after which it means the same, and those after which it must be refused.

use crate::model::{EDGES, Element, HEX8, Model, POINT, QUAD4, TET4, TRI3, corner_count, dimension};
use std::collections::BTreeSet;
use testset::kit::Random;

/// Names that the scene does not use, by dimension.
const UNUSED: [(usize, &str); 4] = [(2, "painted"), (2, "back"), (1, "line"), (3, "lower")];
/// Names that it uses.
pub const USED: [(usize, &str); 8] =
    [(2, "bottom"), (2, "top"), (2, "left"), (2, "right"), (2, "front"), (2, "between"), (0, "rim"), (3, "upper")];

fn one_of<T: Copy>(items: &[T], random: &mut Random) -> T {
    items[random.below(items.len())]
}

/// A random order of the first numbers.
fn order(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    (1..count).rev().for_each(|last| order.swap(last, random.below(last + 1)));
    order
}

/// Some elements of a dimension, at least one.
fn some(model: &Model, dimension: usize, random: &mut Random) -> Vec<usize> {
    let elements = model.of_dimension(dimension);
    let count = 1 + random.below(elements.len().min(5));
    order(elements.len(), random)[..count].iter().map(|&place| elements[place]).collect()
}

/// Nodes of an element in another order: a rotation of a cell, any order of the corners of a facet.
fn turned(element: &Element, random: &mut Random) -> Vec<usize> {
    let corners = corner_count(element.kind);
    let order = match (dimension(element.kind), element.kind) {
        (3, HEX8) => {
            let mut order: Vec<usize> = (0..8).collect();
            for _ in 0..4 {
                let turn = one_of(&[[1, 2, 3, 0, 5, 6, 7, 4], [0, 3, 7, 4, 1, 2, 6, 5]], random);
                order = turn.iter().map(|&place| order[place]).collect();
            }
            order
        }
        (3, _) => {
            let mut order: Vec<usize> = (0..4).collect();
            for _ in 0..3 {
                let turn = one_of(&[[1, 2, 0, 3], [0, 2, 3, 1]], random);
                order = turn.iter().map(|&place| order[place]).collect();
            }
            order
        }
        _ => self::order(corners, random),
    };
    with_middles(element, &order)
}

/// Nodes of an element with its corners in another order; middles of edges follow.
fn with_middles(element: &Element, order: &[usize]) -> Vec<usize> {
    let corners = corner_count(element.kind);
    let mut nodes: Vec<usize> = order.iter().map(|&place| element.nodes[place]).collect();
    let edges = if dimension(element.kind) == 3 { &EDGES[..] } else { &[[0, 1], [1, 2], [2, 0]] };
    for edge in edges.iter().take(element.nodes.len() - corners) {
        let ends = edge.map(|corner| order[corner]);
        let place = edges.iter().position(|edge| ends.iter().all(|end| edge.contains(end))).unwrap();
        nodes.push(element.nodes[corners + place]);
    }
    nodes
}

/// A change after which the mesh means the same.
pub fn equal(model: &mut Model, random: &mut Random) -> &'static str {
    match random.below(14) {
        0 => double(model, 2, random),
        1 => double(model, 3, random),
        2 => double_into_new_group(model, random),
        3 | 4 => turn(model, random),
        5 => {
            renumber_nodes(model, random);
            "renumber nodes"
        }
        6 => {
            let order = order(model.elements.len(), random);
            model.elements = order.iter().map(|&place| model.elements[place].clone()).collect();
            "order of elements"
        }
        7 => {
            let order = order(model.elements.len(), random);
            model.element_tags = order.iter().map(|&place| 3 * place as u64 + 5).collect();
            "renumber elements"
        }
        8 => {
            let tags = order(model.groups.len(), random);
            model.groups.values_mut().zip(tags).for_each(|(tag, place)| *tag = 7 * place as u32 + 2);
            "renumber groups"
        }
        9 => {
            model.elements.iter_mut().for_each(|element| element.entity = random.below(4));
            "split and merge entities"
        }
        10 => rename(model, &[one_of(&UNUSED, random)], "renamed"),
        11 => {
            // What two groups have in common stands in one.
            rename(model, &[UNUSED[0], UNUSED[1]], "merged")
        }
        12 => split_or_drop_unused(model, random),
        _ => {
            for _ in 0..1 + random.below(3) {
                model.nodes.push([random.signed(), random.signed(), 7.0]);
                model.node_tags.push(model.node_tags.iter().max().unwrap() + 1);
            }
            let apart = model.nodes.len() - 1;
            model.add(POINT, vec![apart], &[]);
            "nodes apart"
        }
    }
}

fn double(model: &mut Model, dimension: usize, random: &mut Random) -> &'static str {
    let keeps_groups = random.below(2) == 0;
    for element in some(model, dimension, random) {
        for _ in 0..1 + random.below(2) {
            let nodes = turned(&model.elements[element], random);
            let groups = if keeps_groups { model.elements[element].groups.clone() } else { BTreeSet::new() };
            model.add_copy(element, nodes, groups);
        }
    }
    if dimension == 2 { "double facets" } else { "double cells" }
}

/// Facets once more in a group of their own, all outer or all inner.
fn double_into_new_group(model: &mut Model, random: &mut Random) -> &'static str {
    let is_inner = random.below(4) == 0;
    let inner = model.of_group(2, "between");
    for element in some(model, 2, random) {
        if same_as_any(model, element, &inner) == is_inner {
            let nodes = turned(&model.elements[element], random);
            let name = if is_inner { "new inner" } else { "new outer" };
            let tag = model.groups.values().max().unwrap() + 1;
            model.groups.entry((2, name.into())).or_insert(tag);
            model.add_copy(element, nodes, BTreeSet::from([name.into()]));
        }
    }
    "double facets in a new group"
}

/// Whether a facet lies where one of some others does.
fn same_as_any(model: &Model, element: usize, others: &[usize]) -> bool {
    let corners = |element: usize| {
        let Element { kind, nodes, .. } = &model.elements[element];
        nodes[..corner_count(*kind)].iter().copied().collect::<BTreeSet<_>>()
    };
    others.iter().any(|&other| corners(other) == corners(element))
}

fn turn(model: &mut Model, random: &mut Random) -> &'static str {
    let dimension = 2 + random.below(2);
    for element in some(model, dimension, random) {
        model.elements[element].nodes = turned(&model.elements[element], random);
    }
    if dimension == 2 { "turn facets" } else { "turn cells" }
}

fn renumber_nodes(model: &mut Model, random: &mut Random) {
    let order = order(model.nodes.len(), random);
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, &old)| place[old] = new);
    model.nodes = order.iter().map(|&old| model.nodes[old]).collect();
    model.elements.iter_mut().flat_map(|element| &mut element.nodes).for_each(|node| *node = place[*node]);
    model.node_tags = self::order(order.len(), random).iter().map(|&place| 5 * place as u64 + 11).collect();
}

/// Gives groups of one dimension a common new name.
fn rename(model: &mut Model, names: &[(usize, &str)], new: &str) -> &'static str {
    let mut tag = None;
    for &(dimension, name) in names {
        let Some(own) = model.groups.remove(&(dimension, name.into())) else { continue };
        let (dimension, tag) = (dimension, *tag.get_or_insert(own));
        let renamed = format!("{new} {dimension}");
        for element in model.of_group(dimension, name) {
            let groups = &mut model.elements[element].groups;
            groups.remove(name);
            groups.insert(renamed.clone());
        }
        // Where the name exists from another change, that group takes the members.
        model.groups.entry((dimension, renamed)).or_insert(tag);
    }
    "rename or merge unused groups"
}

/// Drops a group that is not used, or divides it into two.
fn split_or_drop_unused(model: &mut Model, random: &mut Random) -> &'static str {
    let (dimension, name) = one_of(&UNUSED, random);
    if model.groups.remove(&(dimension, name.into())).is_none() {
        return "nothing";
    }
    let drops = random.below(2) == 0;
    let tag = model.groups.values().max().unwrap() + 1;
    for element in model.of_group(dimension, name) {
        // Copies of one element go into one group, or a cell would be in two.
        let half = model.elements[element].nodes.iter().min().unwrap() % 2;
        let groups = &mut model.elements[element].groups;
        groups.remove(name);
        if !drops {
            groups.insert(format!("{name} {half}"));
            model.groups.entry((dimension, format!("{name} {half}"))).or_insert(tag + half as u32);
        }
    }
    if drops { "drop an unused group" } else { "split an unused group" }
}

/// A change after which the mesh must be refused, and the words of which the reason must have one.
pub fn refused(model: &mut Model, random: &mut Random) -> (&'static str, Vec<String>) {
    let (group_dimension, name) = one_of(&USED, random);
    let quoted = vec![format!("\"{name}\"")];
    let words = |words: &[&str]| words.iter().map(|&word| word.into()).collect::<Vec<String>>();
    match random.below(11) {
        0 => (rename(model, &[(group_dimension, name)], "other"), quoted),
        1 => {
            model.groups.remove(&(group_dimension, name.into()));
            let members = model.of_group(group_dimension, name);
            let keeps = group_dimension == 3 || random.below(2) == 0;
            for element in members.into_iter().rev() {
                model.elements[element].groups.remove(name);
                if !keeps {
                    model.remove(element);
                }
            }
            ("drop a used group", quoted)
        }
        2 => {
            let faces: Vec<&str> = USED[..5].iter().map(|(_, face)| *face).filter(|face| *face != name).collect();
            let (from, to) = if group_dimension == 2 && name != "between" { (name, faces[0]) } else { ("top", "left") };
            model.groups.remove(&(2, from.into()));
            for element in model.of_group(2, from) {
                let groups = &mut model.elements[element].groups;
                groups.remove(from);
                groups.insert(to.into());
            }
            ("merge a used group into another one", vec![format!("\"{from}\"")])
        }
        3 => {
            model.groups.remove(&(group_dimension, name.into()));
            let tag = model.groups.values().max().unwrap() + 1;
            for half in 0..2 {
                model.groups.insert((group_dimension, format!("{name} {half}")), tag + half);
            }
            for element in model.of_group(group_dimension, name) {
                let half = model.elements[element].nodes.iter().min().unwrap() % 2;
                let groups = &mut model.elements[element].groups;
                groups.remove(name);
                groups.insert(format!("{name} {half}"));
            }
            ("split a used group", quoted)
        }
        4 => {
            let cell = one_of(&model.of_group(3, "upper"), random);
            let nodes = turned(&model.elements[cell], random);
            model.groups.entry((3, "second".into())).or_insert(500);
            model.add_copy(cell, nodes, BTreeSet::from(["second".into()]));
            ("double a cell in another volume", words(&["\"second\" and \"upper\""]))
        }
        5 => (overlap(model, random), words(&["overlap"])),
        6 => {
            let cell = some(model, 3, random)[0];
            let mirror = if model.elements[cell].kind == HEX8 { &[4, 5, 6, 7, 0, 1, 2, 3][..] } else { &[1, 0, 2, 3] };
            let mirrored = with_middles(&model.elements[cell], mirror);
            // All copies, of which the first one counts.
            for copy in same_cells(model, cell) {
                model.elements[copy].nodes.clone_from(&mirrored);
            }
            ("mirror a cell", words(&["inverted"]))
        }
        7 => {
            // Without cells of their own these facets are no faces of the skin.
            let facet = one_of(&model.of_group(2, "bottom"), random);
            let corners = model.elements[facet].nodes[..corner_count(model.elements[facet].kind)].to_vec();
            let cells = model.of_dimension(3);
            let has_it = |cell: &&usize| corners.iter().all(|node| model.elements[**cell].nodes.contains(node));
            let cell = *cells.iter().find(has_it).unwrap();
            same_cells(model, cell).into_iter().rev().for_each(|copy| model.remove(copy));
            (
                "drop a cell",
                words(&["no face of a cell", "no volume element uses node", "outer faces of cells", "parts"]),
            )
        }
        8 => {
            let used: BTreeSet<usize> =
                model.elements.iter().flat_map(|element| element.nodes.iter().copied()).collect();
            let last = *used.iter().max().unwrap();
            model.nodes.truncate(last);
            model.node_tags.truncate(last);
            ("drop a node", words(&["is unknown"]))
        }
        9 => {
            model.groups.insert((2, "hull".into()), 601);
            let (facet, other) = (one_of(&model.of_group(2, "between"), random), "hull".to_string());
            let outer = one_of(&model.of_group(2, "right"), random);
            [facet, outer].into_iter().for_each(|facet| _ = model.elements[facet].groups.insert(other.clone()));
            ("merge inner and outer facets", words(&["\"hull\""]))
        }
        _ => {
            let (cell, groups) = (some(model, 3, random)[0], "top");
            let nodes = model.elements[cell].nodes.clone();
            let across = if model.elements[cell].kind == HEX8 { vec![0, 1, 6, 7] } else { vec![0, 1, 2] };
            match across.len() {
                4 => model.add(QUAD4, across.iter().map(|&place| nodes[place]).collect(), &[groups]),
                _ => {
                    let others = model.of_dimension(3);
                    let far = others.iter().flat_map(|&other| &model.elements[other].nodes[..4]);
                    let far = *far.max_by_key(|node| (!nodes.contains(node), **node)).unwrap();
                    let faces: BTreeSet<BTreeSet<usize>> =
                        others.iter().flat_map(|&cell| model.faces(cell)).map(BTreeSet::from_iter).collect();
                    let sides =
                        [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]].map(|[a, b]| vec![nodes[a], nodes[b], far]);
                    let free = sides.into_iter().find(|side| !faces.contains(&side.iter().copied().collect())).unwrap();
                    model.add(TRI3, free, &[groups]);
                }
            }
            ("a facet across cells", words(&["no face of a cell"]))
        }
    }
}

/// All elements on the nodes of a cell.
fn same_cells(model: &Model, cell: usize) -> Vec<usize> {
    let nodes = |cell: usize| model.elements[cell].nodes.iter().copied().collect::<BTreeSet<_>>();
    model.of_dimension(3).into_iter().filter(|&other| nodes(other) == nodes(cell)).collect()
}

/// Adds a tetrahedron or a hexahedron on a face of a cell, on its side of the face.
fn overlap(model: &mut Model, random: &mut Random) -> &'static str {
    loop {
        let cell = some(model, 3, random)[0];
        let element = model.elements[cell].clone();
        if element.kind == HEX8 {
            // The lower side of one cell and the upper side of another one above it, whatever way these are turned.
            let on =
                |cell: &Element, axis: usize| cell.nodes.iter().map(|&node| model.nodes[node][axis]).sum::<f64>() / 8.0;
            let cells = model.of_dimension(3);
            let is_above = |other: &&usize| {
                let other = &model.elements[**other];
                (0..2).all(|axis| (on(other, axis) - on(&element, axis)).abs() < 1e-9)
                    && on(other, 2) > on(&element, 2) + 1e-9
            };
            let Some(&above) = cells.iter().find(is_above) else { continue };
            let side = |cell: usize, sign: f64| {
                let height = |face: &Vec<usize>| sign * face.iter().map(|&node| model.nodes[node][2]).sum::<f64>();
                model.faces(cell).into_iter().max_by(|a, b| height(a).total_cmp(&height(b))).unwrap()
            };
            let (mut low, high) = (side(cell, -1.0), side(above, 1.0));
            low.reverse();
            let under =
                |a: usize, b: usize| (0..2).all(|axis| (model.nodes[a][axis] - model.nodes[b][axis]).abs() < 1e-9);
            let start = high.iter().position(|&node| under(node, low[0])).unwrap();
            let top = (0..4).map(|place| high[(start + place) % 4]);
            let nodes: Vec<usize> = low.iter().copied().chain(top).collect();
            model.add(HEX8, nodes, &["lower"]);
            if !model.groups.contains_key(&(3, "lower".into())) {
                model.elements.last_mut().unwrap().groups.clear();
            }
            return "overlapping hexahedra";
        }
        let face = model.faces(cell)[0].clone();
        let candidates: Vec<usize> =
            model.of_dimension(3).iter().flat_map(|&cell| model.elements[cell].nodes[..4].to_vec()).collect();
        let apex = one_of(&candidates, random);
        if element.nodes.contains(&apex) || volume(model, [face[0], face[2], face[1], apex]) < 1e-3 {
            continue;
        }
        let corners = [face[0], face[2], face[1], apex];
        let mut nodes = corners.to_vec();
        if element.kind != TET4 {
            for edge in EDGES {
                let ends = edge.map(|corner| corners[corner]);
                nodes.push(middle(model, ends));
            }
        }
        model.add(element.kind, nodes, &[]);
        return "overlapping tetrahedra";
    }
}

/// Six times the volume of a tetrahedron.
fn volume(model: &Model, nodes: [usize; 4]) -> f64 {
    let [o, a, b, c] = nodes.map(|node| model.nodes[node]);
    let [a, b, c] = [a, b, c].map(|x| [0, 1, 2].map(|axis| x[axis] - o[axis]));
    (0..3).map(|i| c[i] * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])).sum()
}

/// The node in the middle of an edge: that of a cell, or a new one.
fn middle(model: &mut Model, ends: [usize; 2]) -> usize {
    for cell in model.of_dimension(3) {
        let nodes = &model.elements[cell].nodes;
        let is_it = |edge: &[usize; 2]| edge.iter().all(|&corner| ends.contains(&nodes[corner]));
        if let Some(place) = EDGES.iter().position(is_it) {
            return nodes[4 + place];
        }
    }
    let [a, b] = ends.map(|node| model.nodes[node]);
    model.nodes.push([0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis])));
    model.node_tags.push(model.node_tags.iter().max().unwrap() + 1);
    model.nodes.len() - 1
}
