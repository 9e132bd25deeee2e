//! Whether a state means what it seems to mean: linear elasticity, the mesh, the contact zone, uniqueness.
//!
//! A warning does not say that the state is wrong: the state solves the discrete problem to its accuracy. It says that
//! the discrete problem may be far from the body it stands for. Every warning has a code that does not change.

use crate::body::elasticity::{Formulation, Material};
use crate::body::mesh::BlockFace;
use crate::deformation::Deformation;
use crate::equilibrium::{
    ContactFacets, ContactForces, ContactProblem, ContactRows, ContactStatus, FacetPressure, MAX_RESIDUAL, SolvedBody,
    facet_pressures,
};
use crate::scene::{CounterSurface, Scene};
use nalgebra::Vector3;
use serde::Serialize;
use std::fmt;

/// Largest displacement over the smallest extent of the bodies that small displacements allow.
const MAX_DISPLACEMENT: f64 = 0.05;
/// Largest rotation that small displacements allow, radians.
const MAX_ROTATION: f64 = 0.1;
/// Largest principal strain that linear elasticity allows.
const MAX_STRAIN: f64 = 0.02;
/// Smallest scaled Jacobian of a cell that resolves a stress.
const MIN_SCALED_JACOBIAN: f64 = 0.2;
/// Fewest edges per wave length of the obstacle.
const MIN_EDGES_PER_WAVE: f64 = 4.0;
/// Largest turn of the obstacle over one edge, degrees: 30° over four of them.
const MAX_TURN: f64 = 7.5;
/// Fewest closed nodes that resolve a contact zone.
const MIN_CLOSED_NODES: usize = 6;
/// Places per edge at which the obstacle is sampled.
const SAMPLES: usize = 8;
/// Turns, radians, that are rounding of a flat place.
const FLAT: f64 = 1e-9;
/// Pressures that differ by less than this share are equal: the residual of a state moves them.
const UNIFORM: f64 = 1e-6;
/// Poisson's ratio above which standard cells lock. On a bonded layer of four bricks under a sphere
/// (`thin_layer.toml`), their peak pressure is 1 % above that of mean-dilatation bricks at 0.45, 4 % at 0.47, 10 % at
/// 0.49, 71 % at 0.499, and four times as large at 0.4999.
const MAX_STANDARD_RATIO: f64 = 0.47;
/// Strain that the rounding of coordinates causes between bodies that just touch.
const ROUNDED_STRAIN: f64 = 1e-12;
/// Share of the square of a direction from which supports hold it.
const MOSTLY_HELD: f64 = 0.99;
/// Estimated contraction of the slip bounds from which a state may not be unique.
const MAX_CONTRACTION: f64 = 1.0;

/// A stable code and a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Stable code, such as `large-strain`.
    pub code: &'static str,
    /// What was found, and what is allowed.
    pub text: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.code, self.text)
    }
}

/// Adds a warning where a check fails.
fn warn(warnings: &mut Vec<Warning>, fails: bool, code: &'static str, text: impl FnOnce() -> String) {
    if fails {
        warnings.push(Warning { code, text: text() });
    }
}

/// What a solver estimates of a state.
#[derive(Debug, Clone, Copy)]
pub struct Estimates {
    /// Contraction of the slip bounds; 0 without friction.
    pub contraction: f64,
    /// What the rounding of the solver's matrices has taken of the contact forces, as a share of the load.
    pub force_rounding: f64,
}

/// What is implausible about a state.
pub fn warnings(
    problem: &ContactProblem,
    bodies: &[SolvedBody],
    (rows, forces): (&ContactRows, &ContactForces),
    Estimates { contraction, force_rounding: rounding }: Estimates,
) -> Vec<Warning> {
    let mut found = Vec::new();
    warn(&mut found, contraction >= MAX_CONTRACTION, "not-unique", || {
        format!(
            "the slip bounds contract by an estimated factor {contraction:.2} (below 1 needed): other equilibria may exist"
        )
    });
    warn(&mut found, rounding.is_nan() || rounding > MAX_RESIDUAL, "few-digits", || {
        format!(
            "condensation of these bodies leaves an error of {rounding:.0e} of the load in the contact forces (at most \
             {MAX_RESIDUAL:.0e}): total FETI keeps more digits where it converges"
        )
    });
    locking(problem, &mut found);
    uncovered(problem, &mut found);
    noise_of_facets(problem, (rows, forces), &mut found);
    deformation(bodies, &mut found);
    let facets = problem.contact_facets();
    obstacle(problem, bodies, (&facets, forces), &mut found);
    zone(problem, &facets, (rows, forces), &mut found);
    found
}

/// Standard cells of a nearly incompressible material.
fn locking(problem: &ContactProblem, found: &mut Vec<Warning>) {
    for body in problem.bodies.iter() {
        let locks = |material: &&Material| {
            material.formulation() == Formulation::Standard && material.poisson_ratio() > MAX_STANDARD_RATIO
        };
        let Some(material) = body.solid.materials().iter().find(locks) else { continue };
        let (ratio, name) = (material.poisson_ratio(), &body.name);
        let which = if name == "body" { "the body".to_owned() } else { format!("the {name} body") };
        let text = format!(
            "standard cells are too stiff for the Poisson's ratio {ratio} of {which} (at most {MAX_STANDARD_RATIO}): set \
             {name}.material.formulation = \"mean-dilatation\""
        );
        found.push(Warning { code: "volume-locking", text });
    }
}

/// Slave nodes that the master does not lie opposite to.
fn uncovered(problem: &ContactProblem, found: &mut Vec<Warning>) {
    for (contact, count) in problem.uncovered_nodes() {
        let face = &problem.scene.contacts[contact].slave;
        let name = &problem.scene.bodies[face.body].name;
        let text = format!(
            "{count} nodes of the slave face \"{}\" of {name} carry no force at the start: the master face covers less \
             than a thousandth of their area",
            face.face
        );
        found.push(Warning { code: "overhanging-face", text });
    }
}

/// Facets that decide a good part of the pressures.
fn noise_of_facets(problem: &ContactProblem, (rows, forces): (&ContactRows, &ContactForces), found: &mut Vec<Warning>) {
    for own in facet_pressures(problem, rows, forces).into_iter().filter(FacetPressure::is_noisy) {
        let contact = &problem.scene.contacts[own.contact];
        let names = std::iter::once(&contact.slave).chain(contact.master_face());
        let names: Vec<String> =
            names.map(|face| format!("\"{}\" of {}", face.face, problem.scene.bodies[face.body].name)).collect();
        let (why, remedy) = match own.is_curved {
            true => ("are known no better than their nodes tell", "finer meshes, or middle nodes on the surfaces"),
            false => ("count as flat facets", "geometry = \"curved\" for this contact, or finer meshes"),
        };
        let text = format!(
            "the faces {} {why}: that alone makes pressures uncertain by {:.3} MPa, where the mean of the closed nodes is \
             {:.3} MPa (at most a fifth of it): {remedy}",
            names.join(" and "),
            own.noise,
            own.mean
        );
        found.push(Warning { code: "facets", text });
    }
}

/// Displacement, rotation, strain and the shape of the cells.
fn deformation(bodies: &[SolvedBody], found: &mut Vec<Warning>) {
    let all = bodies.iter().map(|body| Deformation::of(&body.mesh, &body.positions, &body.displacement));
    let Deformation { displacement, rotation, strain, scaled_jacobian, extent } =
        all.fold(Deformation::NONE, Deformation::and);
    warn(found, displacement > MAX_DISPLACEMENT * extent, "large-displacement", || {
        format!(
            "the largest displacement is {displacement:.3} mm, {:.1} % of the smallest extent of the bodies (linear elasticity: \
             at most {:.0} %)",
            100.0 * displacement / extent,
            100.0 * MAX_DISPLACEMENT
        )
    });
    warn(found, rotation > MAX_ROTATION, "large-rotation", || {
        format!("the largest rotation is {rotation:.3} rad (linear elasticity: at most {MAX_ROTATION} rad)")
    });
    warn(found, strain > MAX_STRAIN, "large-strain", || {
        let (strain, allowed) = (100.0 * strain, 100.0 * MAX_STRAIN);
        format!("the largest principal strain is {strain:.1} % (linear elasticity: at most {allowed:.0} %)")
    });
    warn(found, scaled_jacobian < MIN_SCALED_JACOBIAN, "distorted-cells", || {
        format!(
            "the smallest scaled Jacobian of a cell is {scaled_jacobian:.3} (stresses need at least {MIN_SCALED_JACOBIAN})"
        )
    });
}

/// Waves and curvature of the counter surface against the edges of the facets of the contact zone.
fn obstacle(
    problem: &ContactProblem,
    bodies: &[SolvedBody],
    (facets, forces): (&ContactFacets, &ContactForces),
    found: &mut Vec<Warning>,
) {
    if bodies.is_empty() {
        return;
    }
    let closed = |place: usize| facets.points[place].is_some_and(|point| forces.status[point] != ContactStatus::Open);
    let in_zone = facets.edges().into_iter().filter(|([a, b], _)| closed(*a) || closed(*b));
    let turns: Vec<Turns> = in_zone
        .filter_map(|(ends, _)| {
            let point = ends.iter().find_map(|place| facets.points[*place])?;
            let contact = problem.boundary.points[point].contact;
            let ends = ends.map(|place| bodies[facets.bodies[place]].positions[facets.nodes[place] as usize]);
            match block_surface(&problem.scene, contact) {
                Some(surface) => Turns::along(ends, |x| upright_normal(surface, x)),
                None => Turns::along(ends, |x| problem.geometry.counter_normal(contact, x)),
            }
        })
        .collect();
    let turn = turns.iter().map(|turns| turns.angle).fold(0.0, f64::max).to_degrees();
    let edges_per_wave = edges_per_wave(&turns);
    let coarse = turn > MAX_TURN || edges_per_wave < MIN_EDGES_PER_WAVE;
    warn(found, coarse, "coarse-obstacle", || {
        let waves =
            if edges_per_wave.is_finite() { format!(", {edges_per_wave:.1} edges per wave") } else { String::new() };
        format!(
            "the mesh is too coarse for the obstacle: it turns by {turn:.1} degrees over one edge{waves} (at most {MAX_TURN} \
             degrees, at least {MIN_EDGES_PER_WAVE} edges per wave)"
        )
    });
}

/// The surface of a master face where it is that of a block which no control moves: its mesh says less of it.
fn block_surface(scene: &Scene, contact: usize) -> Option<&CounterSurface> {
    let master = scene.contacts[contact].master_face()?;
    let body = &scene.bodies[master.body];
    let block = body.block().filter(|_| body.shape.is_none())?;
    let faces = [(BlockFace::Bottom, &block.bottom), (BlockFace::Top, &block.top)];
    faces.into_iter().find(|(face, _)| face.name() == master.face).map(|(_, surface)| surface)
}

/// Unit normal of a surface of heights above or below a place; none where it has none.
fn upright_normal(surface: &CounterSurface, x: [f64; 3]) -> Option<[f64; 3]> {
    let slope = surface.foot_along_x3(x).gap_slope;
    let length = slope.iter().map(|x| x * x).sum::<f64>().sqrt();
    let normal = slope.map(|x| -x / length);
    normal.iter().all(|x| x.is_finite()).then_some(normal)
}

/// How the normal of the counter surface turns along an edge.
#[derive(Debug, Clone, Copy)]
struct Turns {
    /// Sum of the angles, radians.
    angle: f64,
    /// Number of times that it turns the other way, per length of the edge.
    reversals: f64,
}

impl Turns {
    /// The turns between samples along an edge; none where the surface has no normal.
    fn along(ends: [[f64; 3]; 2], normal: impl Fn([f64; 3]) -> Option<[f64; 3]>) -> Option<Self> {
        // The line goes on by half an edge at either end: waves that reverse at nodes count as well.
        let place = |sample: usize| uneven(sample, 2 * SAMPLES) / SAMPLES as f64 - 0.5;
        let at = |share: f64| std::array::from_fn(|axis| ends[0][axis] + share * (ends[1][axis] - ends[0][axis]));
        let known = |sample| {
            let share = place(sample);
            let inside = (0.0..=1.0).contains(&share);
            match normal(at(share)) {
                None if inside => Err(()),
                found => Ok(found.map(|normal| (share, inside, Vector3::from(normal)))),
            }
        };
        let samples = (0..=2 * SAMPLES).map(known).collect::<Result<Vec<_>, ()>>().ok()?;
        let samples: Vec<(f64, bool, Vector3<f64>)> = samples.into_iter().flatten().collect();
        let steps: Vec<Vector3<f64>> = samples.windows(2).map(|pair| pair[0].2.cross(&pair[1].2)).collect();
        let own = samples.windows(2).zip(&steps).filter(|(pair, _)| pair[0].1 && pair[1].1);
        let (angles, shares) =
            own.map(|(pair, step)| (step.norm(), pair[1].0 - pair[0].0)).unzip::<_, _, Vec<_>, Vec<_>>();
        let angle = angles.iter().sum::<f64>() / shares.iter().sum::<f64>();
        let largest = steps.iter().map(|step| step.norm()).fold(0.0, f64::max);
        let clear: Vec<_> = steps.iter().filter(|step| step.norm() > FLAT.max(FLAT * largest)).collect();
        let reversals = clear.windows(2).filter(|pair| pair[0].dot(pair[1]) < 0.0).count();
        let span = samples.last()?.0 - samples.first()?.0;
        let reversals = reversals as f64 / span;
        Some(Self { angle, reversals })
    }
}

/// Edges along which the surface turns both ways once: twice their number over that of all reversals. A hump has two
/// reversals, and no waves; edges along which the surface does not turn do not count.
fn edges_per_wave(turns: &[Turns]) -> f64 {
    let turning: Vec<&Turns> = turns.iter().filter(|turns| turns.angle > FLAT).collect();
    let reversals: f64 = turning.iter().map(|turns| turns.reversals).sum();
    if reversals == 0.0 { f64::INFINITY } else { 2.0 * turning.len() as f64 / reversals }
}

/// Places of samples between 0 and `last`, in steps: moved by up to half a step, so that no wave repeats itself.
fn uneven(sample: usize, last: usize) -> f64 {
    let ends = sample == 0 || sample == last;
    sample as f64 + if ends { 0.0 } else { 0.5 * (sample as f64 * 0.618_033_988_749_895).fract() }
}

/// The size of the contact zone, and where its pressure peaks.
fn zone(
    problem: &ContactProblem,
    facets: &ContactFacets,
    (rows, forces): (&ContactRows, &ContactForces),
    found: &mut Vec<Warning>,
) {
    let closed = forces.status.iter().filter(|status| **status != ContactStatus::Open).count();
    if closed == 0 {
        let text = "no node is closed: the bodies do not touch, and every pressure is zero".to_owned();
        return found.push(Warning { code: "no-contact", text });
    }
    let pressures = rows.pressures(&forces.normal);
    let Some(peak) = (0..pressures.len()).max_by(|a, b| pressures[*a].total_cmp(&pressures[*b])) else { return };
    let stiffest = problem.materials().map(Material::young_modulus).fold(0.0, f64::max);
    if problem.load() == 0.0 && pressures[peak] <= ROUNDED_STRAIN * stiffest {
        let text = "nothing loads the bodies, and every pressure is zero up to rounding".to_owned();
        return found.push(Warning { code: "no-contact", text });
    }
    warn(found, closed < MIN_CLOSED_NODES, "few-closed-nodes", || {
        format!("{closed} nodes are closed: the contact zone is not resolved (at least {MIN_CLOSED_NODES} needed)")
    });
    let (mut on_edge, mut beside_open) = (vec![false; pressures.len()], vec![false; pressures.len()]);
    for (ends, facet) in facets.edges() {
        let points = ends.map(|place| facets.points[place]);
        if facet.is_some_and(|facet| !is_symmetry(problem, facets, ends, facet)) {
            points.into_iter().flatten().for_each(|point| on_edge[point] = true);
        }
        if let [Some(a), Some(b)] = points {
            beside_open[a] |= forces.status[b] == ContactStatus::Open;
            beside_open[b] |= forces.status[a] == ContactStatus::Open;
        }
    }
    if on_edge.iter().all(|on_edge| *on_edge) {
        // Without a node inside, there is no pressure that one on the edge could exceed.
        return;
    }
    let inner = (0..pressures.len()).filter(|&node| !on_edge[node] && !beside_open[node]);
    let inner = inner.map(|node| pressures[node]).fold(0.0, f64::max);
    warn(found, pressures[peak] > (1.0 + UNIFORM) * inner, "peak-at-edge", || {
        let point = &problem.boundary.points[peak];
        let [x1, x2, x3] = problem.start_positions()[point.body][point.node as usize];
        let where_it_is = if on_edge[peak] { "edge of the contact face" } else { "edge of the contact zone" };
        format!(
            "the pressure peaks at the {where_it_is}, at ({x1:.2}, {x2:.2}, {x3:.2}) mm: it may grow with every refinement of \
             the mesh"
        )
    });
}

/// Whether supports hold both ends of an edge of the contact face against leaving it across the edge: the edge lies in
/// a plane of symmetry then.
fn is_symmetry(problem: &ContactProblem, facets: &ContactFacets, ends: [usize; 2], facet: usize) -> bool {
    let body = &problem.bodies[facets.bodies[ends[0]]];
    let positions = body.mesh.nodes();
    let at = |place: usize| Vector3::from(positions[facets.nodes[place] as usize]);
    let corners = &facets.facets[facet];
    let normal = (at(corners[1]) - at(corners[0])).cross(&(at(corners[2]) - at(corners[0])));
    let across = (at(ends[1]) - at(ends[0])).cross(&normal).normalize();
    ends.into_iter().all(|place| {
        let held = body.held(facets.nodes[place]).iter();
        let rest = held.map(|direction| across.dot(&Vector3::from(*direction)).powi(2)).sum::<f64>();
        rest > MOSTLY_HELD
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges per wave of a surface with these slopes over 12 edges of length 1.
    fn waves(slope: impl Fn(f64) -> f64) -> f64 {
        let normal = |x: [f64; 3]| {
            let length = slope(x[0]).hypot(1.0);
            Some([-slope(x[0]) / length, 0.0, 1.0 / length])
        };
        let edge = |index: u32| Turns::along([[f64::from(index), 0.0, 0.0], [f64::from(index + 1), 0.0, 0.0]], normal);
        edges_per_wave(&(0..12).filter_map(edge).collect::<Vec<_>>())
    }

    #[test]
    fn waves_are_as_long_as_they_are() {
        for length in [2.0, 2.4, 3.2, 4.3] {
            let found = waves(|x| 0.2 * (x * std::f64::consts::TAU / length).cos());
            // A reversal more or less at the ends, and those that fall between two edges.
            assert!((found / length - 1.0).abs() < 0.5, "{length}: {found}");
        }
        // A hump and a plane are no waves.
        assert_eq!([waves(|x| -0.02 * (x - 6.1)), waves(|_| 3.0)], [f64::INFINITY; 2]);
    }
}
