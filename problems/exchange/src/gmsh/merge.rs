//! Facets and cells that a file lists more than once.

use crate::gmsh::elements::FacetKind;
use crate::gmsh::mesh::GmshMesh;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;

/// How many facets and cells of a mesh are listed more than once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Repeated {
    /// Facets, each counted once.
    pub facets: usize,
    /// Cells, each counted once.
    pub cells: usize,
}

impl GmshMesh {
    /// The mesh with every facet and every cell once, the first one of the equal ones, in the groups of all of them.
    /// Cells of one kind on the same nodes are equal, and so are facets on the same corners; the order of the nodes
    /// does not matter.
    pub fn merged(&self) -> (Cow<'_, Self>, Repeated) {
        let (facets, facets_repeated) = first_equal(self.facets.iter().map(|facet| {
            let corners = if facet.kind == FacetKind::Quad4 { 4 } else { 3 };
            ascending(facet.nodes.get(..corners).unwrap_or(&facet.nodes))
        }));
        let (cells, cells_repeated) = first_equal(self.cells.iter().map(|cell| (cell.kind, ascending(&cell.nodes))));
        let repeated = Repeated { facets: facets_repeated, cells: cells_repeated };
        if repeated == Repeated::default() {
            return (Cow::Borrowed(self), repeated);
        }
        let mut mesh = self.clone();
        mesh.facets = kept(&self.facets, &facets);
        mesh.cells = kept(&self.cells, &cells);
        renumber(&mut mesh.surfaces, &places(&facets));
        renumber(&mut mesh.volumes, &places(&cells));
        (Cow::Owned(mesh), repeated)
    }
}

fn ascending(nodes: &[usize]) -> Vec<usize> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

/// The first item that is equal to each, and how many first items have equal ones behind them.
fn first_equal<K: Eq + Hash>(keys: impl Iterator<Item = K>) -> (Vec<usize>, usize) {
    let (mut seen, mut repeated) = (HashMap::new(), 0);
    let first = keys.enumerate().map(|(index, key)| {
        let (first, is_repeated) = seen.entry(key).or_insert((index, false));
        if *first != index && !std::mem::replace(is_repeated, true) {
            repeated += 1;
        }
        *first
    });
    (first.collect(), repeated)
}

/// The items that are the first of their kind.
fn kept<T: Clone>(items: &[T], first: &[usize]) -> Vec<T> {
    let firsts = items.iter().enumerate().zip(first).filter(|((index, _), first)| index == *first);
    firsts.map(|((_, item), _)| item.clone()).collect()
}

/// The place of every item among the kept ones.
fn places(first: &[usize]) -> Vec<usize> {
    let mut places = Vec::with_capacity(first.len());
    let mut next = 0;
    for (index, &first) in first.iter().enumerate() {
        places.push(if first == index { next } else { places[first] });
        next += usize::from(first == index);
    }
    places
}

fn renumber(groups: &mut BTreeMap<String, Vec<usize>>, places: &[usize]) {
    for members in groups.values_mut() {
        members.iter_mut().for_each(|member| *member = places[*member]);
        members.sort_unstable();
        members.dedup();
    }
}
