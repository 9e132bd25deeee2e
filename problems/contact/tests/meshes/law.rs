//! What every state must satisfy, computed without the library's elements, rows and law: the foot on the obstacle,
//! equilibrium at every node, Signorini's conditions, Coulomb's law.

use crate::elements::{body_forces, cross, dot, internal_forces, norm, plus, traction_forces};
use crate::grid::Point;
use crate::setting::mesh_of;
use contact::contact_shape::{ContactShape, ContactState};
use contact::equilibrium::ContactStatus;
use contact::scene::{CounterSurface, Held, LoadKind, Meridian, Revolution, Scene, Side};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// Largest violations, relative to the largest force, or to the largest displacement and gap.
#[derive(Debug, Default, Clone, Copy)]
pub struct Violation {
    /// Of the normal and the gap that the rows have.
    pub foot: f64,
    /// Force that is left at a node that nothing holds.
    pub equilibrium: f64,
    /// Difference of the forces that the state has to those of equilibrium.
    pub forces: f64,
    /// Tension, penetration, and force across a gap.
    pub signorini: f64,
    /// Friction beyond its bound, sliding of nodes that stick, friction of sliding nodes below its bound or not along
    /// the way that they slide.
    pub coulomb: f64,
}

impl Violation {
    pub fn largest(&self) -> f64 {
        [self.equilibrium, self.forces, self.signorini, self.coulomb].into_iter().fold(self.foot, f64::max)
    }
}

/// A function that is zero on an obstacle and positive inside it, with its gradient.
fn level(obstacle: &CounterSurface, y: Point) -> (f64, Point) {
    let inside = |side: Side| if side == Side::Outside { 1.0 } else { -1.0 };
    match *obstacle {
        CounterSurface::Plane { height } => (y[2] - height, [0.0, 0.0, 1.0]),
        CounterSurface::TiltedPlane { point, normal } => (dot(plus(y, -1.0, point), normal), normal),
        CounterSurface::Ball { centre, radius, side } => {
            let way = plus(centre, -1.0, y);
            (inside(side) * (radius * radius - dot(way, way)), way.map(|x| 2.0 * inside(side) * x))
        }
        CounterSurface::Revolution(ref surface) => {
            let Revolution { point, axis, side, ref meridian } = **surface;
            let Meridian::Line { radius, slope: 0.0 } = *meridian else { unreachable!("cylinders") };
            let across = cross(plus(y, -1.0, point), axis);
            let slope = cross(across, axis).map(|x| 2.0 * inside(side) * x);
            (inside(side) * (radius * radius * dot(axis, axis) - dot(across, across)), slope)
        }
        CounterSurface::Waves { base, first, second, period, .. } => {
            let angle = 2.0 * PI / period;
            let ((s1, c1), (s2, c2)) = ((angle * y[0]).sin_cos(), (angle * y[1]).sin_cos());
            (y[2] - base - first * s1 - second * c2, [-angle * first * c1, angle * second * s2, 1.0])
        }
        _ => unreachable!("obstacles of these tests"),
    }
}

/// Violation of what a unit normal and a gap of a place must be: the foot lies on the obstacle, which looks that way
/// there.
fn foot_violation(obstacle: &CounterSurface, x: Point, normal: Point, gap: f64) -> f64 {
    let (value, slope) = level(obstacle, plus(x, gap, normal));
    let size = norm(slope);
    let away = norm(plus(slope.map(|entry| entry / size), -1.0, normal));
    (value / size).abs().max(away)
}

/// Forces of the loads of a scene, whose tractions act on flat faces.
fn loads(scene: &Scene, positions: &[Point]) -> Vec<Point> {
    let mesh = mesh_of(scene);
    let mut sum = vec![[0.0; 3]; mesh.node_count()];
    for load in &scene.bodies[0].loads {
        let faces = load.place.as_ref().map(|name| &mesh.faces()[name][..]);
        let own = match &load.kind {
            LoadKind::Traction(traction) => traction_forces(mesh, positions, faces.unwrap_or_default(), *traction),
            LoadKind::BodyForce(force) => body_forces(mesh, positions, *force),
            _ => unreachable!("loads of these tests"),
        };
        sum.iter_mut().zip(own).for_each(|(sum, own)| *sum = plus(*sum, 1.0, own));
    }
    sum
}

/// The components that supports hold at every node.
fn held(scene: &Scene) -> Vec<[bool; 3]> {
    let mesh = mesh_of(scene);
    let mut held = vec![[false; 3]; mesh.node_count()];
    for support in &scene.bodies[0].supports {
        let Held::Components(components) = support.held else { unreachable!("supports of these tests") };
        let nodes = mesh.faces()[&support.face].iter().flat_map(|face| mesh.face_nodes(*face));
        nodes.for_each(|node| (0..3).for_each(|axis| held[node as usize][axis] |= components[axis].is_some()));
    }
    held
}

/// The facets of the contact face with middle nodes.
fn facets(scene: &Scene) -> Vec<Vec<u32>> {
    let mesh = mesh_of(scene);
    let faces = mesh.faces()[&scene.contacts[0].slave.face].iter();
    faces.map(|&face| mesh.face_nodes(face).collect()).filter(|nodes: &Vec<u32>| nodes.len() == 6).collect()
}

/// Middle nodes of the contact face with the ends of their edges.
fn middles(scene: &Scene) -> BTreeMap<u32, [u32; 2]> {
    let edges = |nodes: Vec<u32>| (0..3).map(move |edge| (nodes[3 + edge], [nodes[edge], nodes[(edge + 1) % 3]]));
    facets(scene).into_iter().flat_map(edges).collect()
}

/// ∫ψ_j 4λ_a λ_b / ∫ψ_j by quadrature over the plane facets of the corners, by corner and middle node; ψ = 4λ − 1.
fn weights(scene: &Scene, positions: &[Point]) -> BTreeMap<(u32, u32), f64> {
    // The square, whose side x = 1 becomes a point, with Gauss points in each direction.
    let gauss = [(0.5 - 0.15_f64.sqrt(), 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.15_f64.sqrt(), 5.0 / 18.0)];
    let mut sums: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    let mut whole: BTreeMap<u32, f64> = BTreeMap::new();
    for nodes in facets(scene) {
        let [x, y, z] = [0, 1, 2].map(|corner| positions[nodes[corner] as usize]);
        let area = norm(cross(plus(y, -1.0, x), plus(z, -1.0, x)));
        for ((s, first), (t, second)) in gauss.iter().flat_map(|a| gauss.iter().map(move |b| (*a, *b))) {
            let (lambda, weight) = ([s, t * (1.0 - s), (1.0 - t) * (1.0 - s)], first * second * (1.0 - s) * area);
            for corner in 0..3 {
                let psi = 4.0 * lambda[corner] - 1.0;
                *whole.entry(nodes[corner]).or_insert(0.0) += weight * psi;
                for edge in 0..3 {
                    let value = 4.0 * lambda[edge] * lambda[(edge + 1) % 3];
                    *sums.entry((nodes[corner], nodes[3 + edge])).or_insert(0.0) += weight * psi * value;
                }
            }
        }
    }
    sums.into_iter().map(|((corner, middle), sum)| ((corner, middle), sum / whole[&corner])).collect()
}

/// Values at corners, to which those at middle nodes less the mean of the ends are added with their weights, along the
/// components that supports leave free.
fn weighted(scene: &Scene, positions: &[Point], values: &[Point]) -> Vec<Point> {
    let (mut sums, held, ends) = (values.to_vec(), held(scene), middles(scene));
    for ((corner, middle), weight) in weights(scene, positions) {
        let [a, b] = ends[&middle].map(|end| values[end as usize]);
        let own = plus(plus(values[middle as usize], -0.5, a), -0.5, b);
        (0..3)
            .filter(|&axis| !held[corner as usize][axis])
            .for_each(|axis| sums[corner as usize][axis] += weight * own[axis]);
    }
    sums
}

/// Forces that are left at every node, f − ∫σ∇N, at corners of the contact face with half of those of the middle nodes
/// of their edges; what contact forces at corners put on middle nodes is taken off there. No component that a support
/// holds.
fn rest(scene: &Scene, positions: &[Point], u: &[Point]) -> Vec<Point> {
    let material = scene.bodies[0].material;
    let constants = [material.young_modulus(), material.poisson_ratio()];
    let internal = internal_forces(mesh_of(scene), positions, u, constants);
    let loads = loads(scene, positions);
    let mut rest: Vec<Point> = loads.iter().zip(internal).map(|(load, own)| plus(*load, -1.0, own)).collect();
    for (middle, ends) in middles(scene) {
        let own = rest[middle as usize];
        ends.into_iter().for_each(|end| rest[end as usize] = plus(rest[end as usize], 0.5, own));
    }
    for (rest, held) in rest.iter_mut().zip(held(scene)) {
        (0..3).filter(|&axis| held[axis]).for_each(|axis| rest[axis] = 0.0);
    }
    for ((corner, middle), weight) in weights(scene, positions) {
        rest[middle as usize] = plus(rest[middle as usize], -weight, rest[corner as usize]);
    }
    for (rest, held) in rest.iter_mut().zip(held(scene)) {
        (0..3).filter(|&axis| held[axis]).for_each(|axis| rest[axis] = 0.0);
    }
    rest
}

/// By how much a state at some positions of the nodes violates the equations of its scene.
pub fn violation(shape: &ContactShape, state: &ContactState) -> Violation {
    let problem = shape.problem();
    let scene = &problem.scene;
    let obstacle = scene.contacts[0].obstacle().unwrap();
    let bodies = shape.bodies(state).unwrap();
    let (positions, u) = (&bodies[0].positions[..], &bodies[0].displacement[..]);
    let rest = rest(scene, positions, u);
    let weighted = weighted(scene, positions, u);
    let largest = |vectors: &[Point]| vectors.iter().map(|x| norm(*x)).fold(0.0, f64::max);
    let (force, length) = (largest(&rest).max(largest(&loads(scene, positions))), largest(u));
    let mut found = Violation::default();
    let held = held(scene);
    let contact: BTreeSet<u32> = problem.boundary.points.iter().map(|point| point.node).collect();
    for node in (0..rest.len()).filter(|node| !contact.contains(&(*node as u32))) {
        found.equilibrium = found.equilibrium.max(norm(rest[node]) / force);
    }
    for (index, point) in problem.boundary.points.iter().enumerate() {
        let (node, row) = (point.node as usize, &state.rows.nodes[index]);
        found.foot = found.foot.max(foot_violation(obstacle, positions[node], row.normal, row.gap));
        let free = |x: Point| std::array::from_fn(|axis| if held[node][axis] { 0.0 } else { x[axis] });
        let across = free(row.normal);
        let normal = dot(across, rest[node]) / dot(across, across);
        // Where friction may act, the force along the directions that are free; supports carry the rest.
        let tangential = plus(rest[node], -normal, across);
        let left = dot(row.normal, weighted[node]) - row.gap;
        let along = |x: Point| plus(x, -dot(across, x) / dot(across, across), across);
        let slip = along(free(weighted[node]));
        let [normal_here, tangential_here] = [
            state.forces.normal[index],
            state.forces.tangential.get(index).map_or(0.0, |own| norm(plus(*own, -1.0, tangential))),
        ];
        found.forces = found.forces.max(((normal_here - normal).abs()).max(tangential_here) / force);
        let status = state.forces.status[index];
        let own = [(-normal).max(0.0) / force, left.max(0.0) / length, (normal * left).abs() / (force * length)];
        found.signorini = own.into_iter().fold(found.signorini, f64::max);
        let own = coulomb(status, point.friction * normal, tangential, slip, [force, length]);
        found.coulomb = found.coulomb.max(own);
    }
    found
}

/// The violation of Coulomb's law at a node; its status is checked as well.
fn coulomb(status: ContactStatus, bound: f64, tangential: Point, slip: Point, [force, length]: [f64; 2]) -> f64 {
    let (size, way) = (norm(tangential), norm(slip));
    let beyond = (size - bound).max(0.0) / force;
    match status {
        ContactStatus::Open => size / force,
        ContactStatus::Stick => beyond.max(way / length),
        // Friction of the body on the obstacle acts the way that the body slides, at its bound.
        ContactStatus::Slip => {
            let below = (bound - size).max(0.0) / force;
            let lag = (size * way - dot(tangential, slip)) / (force * length);
            beyond.max(below).max(lag)
        }
    }
}
