//! Changes of a mesh after which it means the same.

use super::model::{EDGES, Element, HEX8, Model, POINT, corner_count, dimension};
use std::collections::BTreeSet;
use testset::kit::Random;

/// Names that the scene does not use, by dimension.
const UNUSED: [(usize, &str); 4] = [(2, "painted"), (2, "back"), (1, "line"), (3, "lower")];
pub fn one_of<T: Copy>(items: &[T], random: &mut Random) -> T {
    items[random.below(items.len())]
}

/// A random order of the first numbers.
fn order(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    (1..count).rev().for_each(|last| order.swap(last, random.below(last + 1)));
    order
}

/// Some elements of a dimension, at least one.
pub fn some(model: &Model, dimension: usize, random: &mut Random) -> Vec<usize> {
    let elements = model.of_dimension(dimension);
    let count = 1 + random.below(elements.len().min(5));
    order(elements.len(), random)[..count].iter().map(|&place| elements[place]).collect()
}

/// Nodes of an element in another order: a rotation of a cell, any order of the corners of a facet.
pub fn turned(element: &Element, random: &mut Random) -> Vec<usize> {
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
pub fn with_middles(element: &Element, order: &[usize]) -> Vec<usize> {
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
pub fn rename(model: &mut Model, names: &[(usize, &str)], new: &str) -> &'static str {
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
