//! A contact surface as pictures show it: seen along its mean normal, as facets between its nodes.

use crate::commands::scene_words;
use contact::equilibrium::ContactProblem;
use contact::scene::BodyFace;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// One side of a contact projected along an axis.
pub struct ContactSurface {
    /// Its contact, by its place in the scene.
    pub contact: usize,
    /// The body that it is a face of.
    pub body: usize,
    /// The name of the face.
    pub face: String,
    /// What names of pictures end with: nothing where the scene has one contact.
    pub suffix: String,
    /// What the contact is called: nothing where the scene has one.
    pub label: String,
    /// What titles call the surface.
    pub owner: String,
    /// Its nodes in the mesh, ascending.
    nodes: Vec<u32>,
    /// The contact node at every node; none where supports hold the normal or nothing lies opposite, and on a master.
    points: Vec<Option<usize>>,
    /// The corners of the facets by their places among the nodes, counterclockwise seen from outside.
    faces: Vec<Vec<usize>>,
    /// Positions of the nodes at the start, mm.
    places: Vec<[f64; 3]>,
    /// The two axes of the plan.
    axes: [usize; 2],
    /// Mean outward normal.
    pub normal: [f64; 3],
}

/// Distance from a line, over the size of the surface, at which a node lies on it.
const ON_LINE: f64 = 1e-9;

impl ContactSurface {
    /// The slave faces of all contacts whose sides may part.
    pub fn all(problem: &ContactProblem) -> Vec<Self> {
        let contacts = problem.scene.contacts.iter().enumerate().filter(|(_, contact)| !contact.is_tied());
        contacts.map(|(index, contact)| Self::new(problem, index, &contact.slave)).collect()
    }

    /// The sides of contacts that controls move, slaves before masters; of contacts whose sides are glued only where a
    /// body has no other. The slave faces where controls move none of them.
    pub fn shaped(problem: &ContactProblem) -> Vec<Self> {
        let contacts = &problem.scene.contacts;
        let free = |body: usize| {
            let sides = contacts.iter().filter(|contact| !contact.is_tied());
            sides.flat_map(|contact| contact.faces()).any(|own| own.body == body)
        };
        let mut found: Vec<Self> = Vec::new();
        for (index, contact) in contacts.iter().enumerate() {
            for side in contact.faces() {
                if problem.map.shapes(side.body) && (!contact.is_tied() || !free(side.body)) {
                    let surface = Self::new(problem, index, side);
                    if !surface.nodes.iter().any(|&node| problem.map.moves(side.body, node)) {
                        continue;
                    }
                    let suffix = if *side == contact.slave { "" } else { "_master" };
                    found.push(Self { suffix: format!("{}{suffix}", surface.suffix), ..surface });
                }
            }
        }
        if found.is_empty() { Self::all(problem) } else { found }
    }

    /// A side of a contact.
    fn new(problem: &ContactProblem, contact: usize, side: &BodyFace) -> Self {
        let (scene, body) = (&problem.scene, side.body);
        let (mesh, positions) = (&problem.bodies[body].mesh, &problem.start_positions()[body]);
        let corners = |face| {
            let (mut nodes, count) = mesh.face_with_corners(face);
            nodes.truncate(count);
            nodes
        };
        let facets: Vec<Vec<u32>> = mesh.faces().get(&side.face).into_iter().flatten().copied().map(corners).collect();
        let mut nodes: Vec<u32> = facets.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| nodes.partition_point(|other| other < node);
        let faces: Vec<Vec<usize>> = facets.iter().map(|facet| facet.iter().map(place).collect()).collect();
        let own = problem.boundary.contact_points().iter().enumerate();
        let own = own.filter(|(_, point)| point.contact == contact && point.body == body);
        let known: HashMap<u32, usize> = own.map(|(index, point)| (point.node, index)).collect();
        let points = nodes.iter().map(|node| known.get(node).copied()).collect();
        let places: Vec<[f64; 3]> = nodes.iter().map(|&node| positions[node as usize]).collect();
        let (axes, normal) = plan_of(&places, &faces);
        let label = scene_words::contact_label(scene, contact);
        let suffix = if label.is_empty() { String::new() } else { format!("_contact_{}", contact + 1) };
        let owner = format!("contact surface {} of {}", side.face, scene.bodies[body].name);
        Self {
            contact,
            body,
            face: side.face.clone(),
            suffix,
            label,
            owner,
            nodes,
            points,
            faces,
            places,
            axes,
            normal,
        }
    }

    /// What the contact is called, as the end of a title.
    pub fn words(&self) -> String {
        if self.label.is_empty() { String::new() } else { format!(", {}", self.label) }
    }

    /// The nodes in the plan, mm.
    pub fn plan(&self) -> Vec<[f64; 2]> {
        self.places.iter().map(|x| self.axes.map(|axis| x[axis])).collect()
    }

    /// The facets by the places of their nodes.
    pub fn faces(&self) -> Vec<Vec<usize>> {
        self.faces.clone()
    }

    /// Nodes of the surface in the mesh of its body.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The contact node at every node; none where supports hold the normal.
    pub fn points(&self) -> &[Option<usize>] {
        &self.points
    }

    /// Values at the nodes from those at the contact nodes, `rest` at the others.
    pub fn spread<T: Clone>(&self, values: &[T], rest: T) -> Vec<T> {
        self.points.iter().map(|point| point.map_or_else(|| rest.clone(), |point| values[point].clone())).collect()
    }

    /// Names of the axes of the plan.
    pub fn axis_names(&self) -> [String; 2] {
        self.axes.map(|axis| format!("{} (mm)", NAMES[axis]))
    }

    /// Names of the axes of the plan without their unit.
    pub fn axis_symbols(&self) -> [&'static str; 2] {
        self.axes.map(|axis| NAMES[axis])
    }

    /// Vectors in the plan.
    pub fn in_plan(&self, vector: [f64; 3]) -> [f64; 2] {
        self.axes.map(|axis| vector[axis])
    }

    /// A field along the line on which the other coordinate of the plan is that of a node: (coordinate, value), in
    /// order.
    pub fn cut(&self, axis: usize, node: usize, values: &[f64]) -> Vec<(f64, f64)> {
        let (along, across) = (self.axes[axis], self.axes[1 - axis]);
        let level = self.places[node][across];
        let size = self.places.iter().map(|x| (x[across] - level).abs()).fold(0.0, f64::max);
        let mut found: BTreeMap<u64, (f64, f64)> = BTreeMap::new();
        let mut add = |place: f64, value: f64| {
            // Ordered like the places; a place that several facets share stands once.
            let key = ((place / size.max(f64::MIN_POSITIVE) / ON_LINE) as i64).wrapping_sub(i64::MIN) as u64;
            found.insert(key, (place, value));
        };
        for [a, b] in self.edges() {
            let [from, to] = [a, b].map(|node| self.places[node][across] - level);
            for (node, distance) in [(a, from), (b, to)] {
                if distance.abs() <= ON_LINE * size {
                    add(self.places[node][along], values[node]);
                }
            }
            if from.abs().min(to.abs()) > ON_LINE * size && from * to < 0.0 {
                let share = from / (from - to);
                let between = |x: f64, y: f64| x + share * (y - x);
                add(between(self.places[a][along], self.places[b][along]), between(values[a], values[b]));
            }
        }
        found.into_values().collect()
    }

    /// Edges between the nodes by their places, the smaller first, ascending.
    fn edges(&self) -> BTreeSet<[usize; 2]> {
        let of_facet = |facet: &Vec<usize>| {
            let ends = facet.iter().zip(facet.iter().cycle().skip(1));
            ends.map(|(&from, &to)| [from.min(to), from.max(to)]).collect::<Vec<_>>()
        };
        self.faces.iter().flat_map(of_facet).collect()
    }

    /// The node of the largest of some values.
    pub fn peak(&self, values: &[f64]) -> usize {
        (0..values.len()).fold(0, |best, node| if values[node] > values[best] { node } else { best })
    }

    /// The other coordinate of a node for a line along an axis of the plan, mm.
    pub fn level(&self, axis: usize, node: usize) -> f64 {
        self.places[node][self.axes[1 - axis]]
    }
}

/// The two axes of the plan of a surface, and its mean outward normal.
fn plan_of(places: &[[f64; 3]], faces: &[Vec<usize>]) -> ([usize; 2], [f64; 3]) {
    let mut normal = [0.0; 3];
    for facet in faces {
        for (index, &from) in facet.iter().enumerate() {
            let (a, b) = (places[from], places[facet[(index + 1) % facet.len()]]);
            (0..3).for_each(|i| normal[i] += 0.5 * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]));
        }
    }
    let across = (0..3).fold(2, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    ([[1, 2], [0, 2], [0, 1]][across], normal.map(|x| if length > 0.0 { x / length } else { 0.0 }))
}

/// Names of the axes.
const NAMES: [&str; 3] = ["x₁", "x₂", "x₃"];
