//! The contact surface as pictures show it: seen along its mean normal, as facets between its nodes.

use contact::equilibrium::{ContactFacets, ContactProblem};
use std::collections::BTreeMap;

/// The contact surface projected along an axis.
pub struct ContactSurface {
    facets: ContactFacets,
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
    pub fn new(problem: &ContactProblem) -> Self {
        let (facets, positions) = (problem.contact_facets(), &problem.start_positions()[0]);
        let places: Vec<[f64; 3]> = facets.nodes.iter().map(|&node| positions[node as usize]).collect();
        let mut normal = [0.0; 3];
        for facet in &facets.facets {
            for (index, &from) in facet.iter().enumerate() {
                let (a, b) = (places[from], places[facet[(index + 1) % facet.len()]]);
                (0..3).for_each(|i| {
                    normal[i] += 0.5 * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
                });
            }
        }
        let across = (0..3).fold(2, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
        let axes = [[1, 2], [0, 2], [0, 1]][across];
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        Self { facets, places, axes, normal: normal.map(|x| if length > 0.0 { x / length } else { 0.0 }) }
    }

    /// The nodes in the plan, mm.
    pub fn plan(&self) -> Vec<[f64; 2]> {
        self.places.iter().map(|x| self.axes.map(|axis| x[axis])).collect()
    }

    /// The facets by the places of their nodes.
    pub fn faces(&self) -> Vec<Vec<usize>> {
        self.facets.facets.clone()
    }

    /// Nodes of the surface in the mesh.
    pub fn nodes(&self) -> &[u32] {
        &self.facets.nodes
    }

    /// The contact node at every node; none where supports hold the normal.
    pub fn points(&self) -> &[Option<usize>] {
        &self.facets.points
    }

    /// Values at the nodes from those at the contact nodes, `rest` at the others.
    pub fn spread<T: Clone>(&self, values: &[T], rest: T) -> Vec<T> {
        self.facets
            .points
            .iter()
            .map(|point| point.map_or_else(|| rest.clone(), |point| values[point].clone()))
            .collect()
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
        for ([a, b], _) in self.facets.edges() {
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

    /// The node of the largest of some values.
    pub fn peak(&self, values: &[f64]) -> usize {
        (0..values.len()).fold(0, |best, node| if values[node] > values[best] { node } else { best })
    }

    /// The other coordinate of a node for a line along an axis of the plan, mm.
    pub fn level(&self, axis: usize, node: usize) -> f64 {
        self.places[node][self.axes[1 - axis]]
    }
}

/// Names of the axes.
const NAMES: [&str; 3] = ["x₁", "x₂", "x₃"];
