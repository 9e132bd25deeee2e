//! A mesh as a list of elements with groups: what a file says, in whatever form it says so.

use exchange::gmsh::{CellKind, GmshMesh, read};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

/// Numbers of element types of Gmsh.
pub const POINT: i32 = 15;
const LINE: i32 = 1;
pub const TRI3: i32 = 2;
pub const QUAD4: i32 = 3;
pub const TET4: i32 = 4;
pub const HEX8: i32 = 5;
const TRI6: i32 = 9;
pub const TET10: i32 = 11;

/// Edges of a tetrahedron in the order of their middles.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];
/// Faces of a hexahedron and of a tetrahedron by their corners.
const HEX_FACES: [&[usize]; 6] =
    [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
const TET_FACES: [&[usize]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]];

/// An element: places of its nodes in the list of nodes, names of its groups, the entity of its groups that it is on.
#[derive(Debug, Clone)]
pub struct Element {
    pub kind: i32,
    pub nodes: Vec<usize>,
    pub groups: BTreeSet<String>,
    pub entity: usize,
}

/// Nodes and elements with their tags; tags of groups by dimension and name.
#[derive(Debug, Clone, Default)]
pub struct Model {
    pub nodes: Vec<[f64; 3]>,
    pub node_tags: Vec<u64>,
    pub elements: Vec<Element>,
    pub element_tags: Vec<u64>,
    pub groups: BTreeMap<(usize, String), u32>,
}

/// Dimension of elements of a type.
pub fn dimension(kind: i32) -> usize {
    match kind {
        POINT => 0,
        LINE => 1,
        TRI3 | QUAD4 | TRI6 => 2,
        _ => 3,
    }
}

/// How many of its nodes are corners.
pub fn corner_count(kind: i32) -> usize {
    match kind {
        POINT => 1,
        LINE => 2,
        TRI3 | TRI6 => 3,
        HEX8 => 8,
        _ => 4,
    }
}

impl Model {
    pub fn add(&mut self, kind: i32, nodes: Vec<usize>, groups: &[&str]) {
        let groups: BTreeSet<String> = groups.iter().map(|&name| name.into()).collect();
        self.element_tags.push(self.element_tags.iter().max().map_or(1, |tag| tag + 1));
        self.elements.push(Element { kind, nodes, groups, entity: 0 });
    }

    /// Adds a copy of an element with other nodes.
    pub fn add_copy(&mut self, element: usize, nodes: Vec<usize>, groups: BTreeSet<String>) {
        let Element { kind, entity, .. } = self.elements[element];
        self.element_tags.push(self.element_tags.iter().max().map_or(1, |tag| tag + 1));
        self.elements.push(Element { kind, nodes, groups, entity });
    }

    /// Elements of a dimension.
    pub fn of_dimension(&self, dimension: usize) -> Vec<usize> {
        (0..self.elements.len()).filter(|&element| self::dimension(self.elements[element].kind) == dimension).collect()
    }

    /// Elements of a group.
    pub fn of_group(&self, dimension: usize, name: &str) -> Vec<usize> {
        let has_it = |element: &usize| self.elements[*element].groups.contains(name);
        self.of_dimension(dimension).into_iter().filter(has_it).collect()
    }

    pub fn remove(&mut self, element: usize) {
        self.elements.remove(element);
        self.element_tags.remove(element);
    }

    /// Corners of the faces of an element, outward.
    pub fn faces(&self, element: usize) -> Vec<Vec<usize>> {
        let Element { kind, nodes, .. } = &self.elements[element];
        let faces = if *kind == HEX8 { &HEX_FACES[..] } else { &TET_FACES[..] };
        faces.iter().map(|face| face.iter().map(|&corner| nodes[corner]).collect()).collect()
    }

    /// How many facets and cells are listed more than once; with `by_group` an element is listed for each of its
    /// groups.
    pub fn repeated(&self, by_group: bool) -> [usize; 2] {
        [2, 3].map(|dimension| {
            let mut listed = HashMap::new();
            for element in self.of_dimension(dimension) {
                let Element { kind, nodes, groups, .. } = &self.elements[element];
                let count = if dimension == 2 { corner_count(*kind) } else { nodes.len() };
                let mut key = nodes[..count].to_vec();
                key.sort_unstable();
                *listed.entry(key).or_insert(0) += if by_group { groups.len().max(1) } else { 1 };
            }
            listed.values().filter(|count| **count > 1).count()
        })
    }
}

fn ascending(mut nodes: Vec<usize>) -> Vec<usize> {
    nodes.sort_unstable();
    nodes
}

/// A mesh of the folder `exchange/tests/data` with groups by place: six sides, one that overlaps two of them, two
/// halves and the facets between them, points and lines.
pub fn base(file: &str, second_order: bool) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../exchange/tests/data").join(file);
    let mesh = read(&std::fs::read(path).unwrap()).unwrap();
    let mut model = Model { nodes: mesh.nodes.clone(), ..Model::default() };
    let middle = add_cells(&mut model, &mesh, second_order);
    add_facets(&mut model, &middle);
    let at = |model: &Model, wanted: [usize; 2]| -> Vec<usize> {
        let [low, high] = bounds(model);
        let on = |x: &[f64; 3]| x[wanted[0]] == low[wanted[0]] && x[wanted[1]] == high[wanted[1]];
        let mut found: Vec<usize> = (0..model.nodes.len()).filter(|&node| on(&model.nodes[node])).collect();
        found.sort_by(|a, b| model.nodes[*a][1].total_cmp(&model.nodes[*b][1]));
        found
    };
    let rim = at(&model, [0, 2]);
    rim.iter().for_each(|&node| model.add(POINT, vec![node], &["rim"]));
    rim.windows(2).for_each(|ends| model.add(LINE, ends.to_vec(), &["line"]));
    model.node_tags = (1..=model.nodes.len() as u64).collect();
    for element in &model.elements {
        for name in &element.groups {
            let tag = model.groups.len() as u32 + 1;
            model.groups.entry((dimension(element.kind), name.clone())).or_insert(tag);
        }
    }
    model
}

/// Least and largest coordinates.
pub fn bounds(model: &Model) -> [[f64; 3]; 2] {
    let of =
        |choose: fn(f64, f64) -> f64| [0, 1, 2].map(|axis| model.nodes.iter().map(|x| x[axis]).reduce(choose).unwrap());
    [of(f64::min), of(f64::max)]
}

/// Adds the cells in their halves; returns the nodes in the middles of edges.
fn add_cells(model: &mut Model, mesh: &GmshMesh, second_order: bool) -> HashMap<Vec<usize>, usize> {
    let (mut middles, [low, high]) = (HashMap::new(), bounds(model));
    for cell in &mesh.cells {
        let centre = cell.nodes.iter().map(|&node| mesh.nodes[node][2]).sum::<f64>() / cell.nodes.len() as f64;
        let half = if centre > 0.5 * (low[2] + high[2]) { "upper" } else { "lower" };
        let mut nodes = cell.nodes.clone();
        if second_order {
            for ends in EDGES.map(|edge| edge.map(|corner| cell.nodes[corner])) {
                let middle = *middles.entry(ascending(ends.to_vec())).or_insert_with(|| {
                    let [a, b] = ends.map(|node| model.nodes[node]);
                    model.nodes.push([0, 1, 2].map(|axis| 0.5 * (a[axis] + b[axis])));
                    model.nodes.len() - 1
                });
                nodes.push(middle);
            }
        }
        let kind = match (cell.kind, second_order) {
            (CellKind::Hex8, _) => HEX8,
            (_, true) => TET10,
            (_, false) => TET4,
        };
        model.add(kind, nodes, &[half]);
    }
    middles
}

/// Adds the faces of the skin and those between the halves.
fn add_facets(model: &mut Model, middles: &HashMap<Vec<usize>, usize>) {
    let mut found: BTreeMap<Vec<usize>, (Vec<usize>, Vec<String>)> = BTreeMap::new();
    for cell in 0..model.elements.len() {
        for face in model.faces(cell) {
            let entry = found.entry(ascending(face.clone())).or_insert((face, Vec::new()));
            entry.1.extend(model.elements[cell].groups.clone());
        }
    }
    let sides = [["left", "right"], ["front", "back"], ["bottom", "top"]];
    let bounds = bounds(model);
    for (mut nodes, halves) in found.into_values() {
        let mut groups = Vec::new();
        if let [one, other] = &halves[..] {
            groups.extend((one != other).then_some("between"));
        } else {
            let is_on =
                |axis: usize, end: usize| nodes.iter().all(|&node| model.nodes[node][axis] == bounds[end][axis]);
            let on = (0..6).filter(|side| is_on(side / 2, side % 2)).map(|side| sides[side / 2][side % 2]);
            groups.extend(on);
            groups.extend(["left", "top"].contains(&groups[0]).then_some("painted"));
        }
        if groups.is_empty() {
            continue;
        }
        let kind = if nodes.len() == 4 { QUAD4 } else { TRI3 };
        let corners = nodes.clone();
        let edges = [[0, 1], [1, 2], [2, 0]].map(|edge| ascending(edge.map(|corner| corners[corner]).to_vec()));
        nodes.extend(edges.iter().filter_map(|edge| middles.get(edge)));
        model.add(if nodes.len() == 6 { TRI6 } else { kind }, nodes, &groups);
    }
}
