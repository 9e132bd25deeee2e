//! Changes after which a mesh must be refused.

use super::changes::{one_of, rename, some, turned, with_middles};
use super::model::{EDGES, Element, HEX8, Model, QUAD4, TET4, TRI3, corner_count};
use std::collections::BTreeSet;
use testset::kit::Random;

/// Names that the scene uses, by dimension.
pub const USED: [(usize, &str); 8] =
    [(2, "bottom"), (2, "top"), (2, "left"), (2, "right"), (2, "front"), (2, "between"), (0, "rim"), (3, "upper")];

/// A change after which the mesh must be refused, and the words of which the reason must have one.
pub fn refused(model: &mut Model, random: &mut Random) -> (&'static str, Vec<String>) {
    let group = one_of(&USED, random);
    let quoted = vec![format!("\"{}\"", group.1)];
    let words = |words: &[&str]| words.iter().map(|&word| word.into()).collect::<Vec<String>>();
    match random.below(11) {
        0 => (rename(model, &[group], "other"), quoted),
        1 => (drop_group(model, group, random), quoted),
        2 => merge_group(model, group),
        3 => (split_group(model, group), quoted),
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
            same_cells(model, cell).into_iter().for_each(|copy| model.elements[copy].nodes.clone_from(&mirrored));
            ("mirror a cell", words(&["inverted"]))
        }
        7 => {
            let reasons = ["no face of a cell", "no volume element uses node", "outer faces of cells", "parts"];
            (drop_cell(model, random), words(&reasons))
        }
        8 => {
            let used = model.elements.iter().flat_map(|element| &element.nodes).max();
            let last = *used.unwrap();
            model.nodes.truncate(last);
            model.node_tags.truncate(last);
            ("drop a node", words(&["is unknown"]))
        }
        9 => {
            model.groups.insert((2, "hull".into()), 601);
            let (inner, outer) =
                (one_of(&model.of_group(2, "between"), random), one_of(&model.of_group(2, "right"), random));
            [inner, outer].into_iter().for_each(|facet| _ = model.elements[facet].groups.insert("hull".into()));
            ("merge inner and outer facets", words(&["\"hull\""]))
        }
        _ => (facet_across(model, random), words(&["no face of a cell"])),
    }
}

/// Drops a group, with its facets or without.
fn drop_group(model: &mut Model, (dimension, name): (usize, &str), random: &mut Random) -> &'static str {
    model.groups.remove(&(dimension, name.into()));
    let keeps = dimension == 3 || random.below(2) == 0;
    for element in model.of_group(dimension, name).into_iter().rev() {
        model.elements[element].groups.remove(name);
        if !keeps {
            model.remove(element);
        }
    }
    "drop a used group"
}

/// Puts a face that the scene uses into another one, and what must be told of.
fn merge_group(model: &mut Model, (dimension, name): (usize, &str)) -> (&'static str, Vec<String>) {
    let other = if name == "bottom" { "top" } else { "bottom" };
    let (from, to) = if dimension == 2 && name != "between" { (name, other) } else { ("top", "left") };
    model.groups.remove(&(2, from.into()));
    for element in model.of_group(2, from) {
        let groups = &mut model.elements[element].groups;
        groups.remove(from);
        groups.insert(to.into());
    }
    ("merge a used group into another one", vec![format!("\"{from}\"")])
}

fn split_group(model: &mut Model, (dimension, name): (usize, &str)) -> &'static str {
    model.groups.remove(&(dimension, name.into()));
    let tag = model.groups.values().max().unwrap() + 1;
    for half in 0..2 {
        model.groups.insert((dimension, format!("{name} {half}")), tag + half);
    }
    for element in model.of_group(dimension, name) {
        // Copies of one element go into one group, or a cell would be in two.
        let half = model.elements[element].nodes.iter().min().unwrap() % 2;
        let groups = &mut model.elements[element].groups;
        groups.remove(name);
        groups.insert(format!("{name} {half}"));
    }
    "split a used group"
}

/// Drops a cell with all its copies: its named facets are no faces of the skin then.
fn drop_cell(model: &mut Model, random: &mut Random) -> &'static str {
    let facet = one_of(&model.of_group(2, "bottom"), random);
    let corners = model.elements[facet].nodes[..corner_count(model.elements[facet].kind)].to_vec();
    let cells = model.of_dimension(3);
    let has_it = |cell: &&usize| corners.iter().all(|node| model.elements[**cell].nodes.contains(node));
    let cell = *cells.iter().find(has_it).unwrap();
    same_cells(model, cell).into_iter().rev().for_each(|copy| model.remove(copy));
    "drop a cell"
}

/// Adds a facet through cells to a face.
fn facet_across(model: &mut Model, random: &mut Random) -> &'static str {
    let cell = some(model, 3, random)[0];
    let nodes = model.elements[cell].nodes.clone();
    if model.elements[cell].kind == HEX8 {
        model.add(QUAD4, [0, 1, 6, 7].map(|place| nodes[place]).to_vec(), &["top"]);
        return "a facet across cells";
    }
    let cells = model.of_dimension(3);
    let corners = cells.iter().flat_map(|&other| &model.elements[other].nodes[..4]);
    let far = *corners.max_by_key(|node| (!nodes.contains(node), **node)).unwrap();
    let faces: BTreeSet<BTreeSet<usize>> =
        cells.iter().flat_map(|&cell| model.faces(cell)).map(BTreeSet::from_iter).collect();
    let across = EDGES.map(|edge| BTreeSet::from([nodes[edge[0]], nodes[edge[1]], far]));
    let across = across.into_iter().find(|corners| !faces.contains(corners)).unwrap();
    model.add(TRI3, across.into_iter().collect(), &["top"]);
    "a facet across cells"
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
