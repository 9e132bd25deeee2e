//! Whether a state means what it seems to mean: linear elasticity, the mesh, the contact zone, uniqueness.
//!
//! A warning does not say that the state is wrong: the state solves the discrete problem to its accuracy. It says that
//! the discrete problem may be far from the body it stands for. Every warning has a code that does not change.

use crate::body::elasticity::Formulation;
use crate::deformation::Deformation;
use crate::equilibrium::{ContactForces, ContactProblem, ContactStatus, MAX_RESIDUAL, SolvedBody};
use serde::Serialize;
use std::fmt;

/// Largest displacement over the smallest edge of the bodies that small displacements allow.
const MAX_DISPLACEMENT: f64 = 0.05;
/// Largest rotation that small displacements allow, radians.
const MAX_ROTATION: f64 = 0.1;
/// Largest principal strain that linear elasticity allows.
const MAX_STRAIN: f64 = 0.02;
/// Smallest scaled Jacobian of a brick that resolves a stress.
const MIN_SCALED_JACOBIAN: f64 = 0.2;
/// Fewest bricks per wave length of the obstacle.
const MIN_BRICKS_PER_WAVE: f64 = 4.0;
/// Largest turn of the obstacle over one brick, degrees: 30° over four of them.
const MAX_TURN: f64 = 7.5;
/// Fewest closed nodes that resolve a contact zone.
const MIN_CLOSED_NODES: usize = 6;
/// Places per brick at which the obstacle is sampled.
const SAMPLES: usize = 8;
/// Slopes below this share of the steepest one are rounding of a flat place.
const FLAT: f64 = 1e-9;
/// Pressures that differ by less than this share are equal: the residual of a state moves them.
const UNIFORM: f64 = 1e-6;
/// Poisson's ratio above which standard bricks lock. On a bonded layer of four bricks under a sphere
/// (`thin_layer.toml`), their peak pressure is 1 % above that of mean-dilatation bricks at 0.45, 4 % at 0.47, 10 % at
/// 0.49, 71 % at 0.499, and four times as large at 0.4999.
const MAX_STANDARD_RATIO: f64 = 0.47;
/// Strain that the rounding of coordinates causes between bodies that just touch.
const ROUNDED_STRAIN: f64 = 1e-12;
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
    forces: &ContactForces,
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
    deformation(bodies, &mut found);
    obstacle(problem, forces, &mut found);
    zone(problem, forces, &mut found);
    found
}

/// Standard bricks of a nearly incompressible material.
fn locking(problem: &ContactProblem, found: &mut Vec<Warning>) {
    let scene = &problem.scene;
    let bodies = [("lower", Some(&scene.lower)), ("upper", scene.upper.as_ref().map(|upper| &upper.body))];
    for (name, material) in bodies.into_iter().filter_map(|(name, body)| Some((name, &body?.material))) {
        let ratio = material.poisson_ratio();
        let locks = material.formulation() == Formulation::Standard && ratio > MAX_STANDARD_RATIO;
        warn(found, locks, "volume-locking", || {
            format!(
                "standard bricks are too stiff for the Poisson's ratio {ratio} of the {name} body (at most {MAX_STANDARD_RATIO}): \
                 set {name}.material.formulation = \"mean-dilatation\""
            )
        });
    }
}

/// Displacement, rotation, strain and the shape of the bricks.
fn deformation(bodies: &[SolvedBody], found: &mut Vec<Warning>) {
    let all = bodies.iter().map(|body| Deformation::of(&body.block, &body.displacement));
    let Deformation { displacement, rotation, strain, scaled_jacobian, edge } =
        all.fold(Deformation::NONE, Deformation::and);
    warn(found, displacement > MAX_DISPLACEMENT * edge, "large-displacement", || {
        format!(
            "the largest displacement is {displacement:.3} mm, {:.1} % of the smallest edge of the bodies (linear elasticity: \
             at most {:.0} %)",
            100.0 * displacement / edge,
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
    warn(found, scaled_jacobian < MIN_SCALED_JACOBIAN, "distorted-bricks", || {
        format!(
            "the smallest scaled Jacobian of a brick is {scaled_jacobian:.3} (stresses need at least {MIN_SCALED_JACOBIAN})"
        )
    });
}

/// Waves and curvature of the obstacle against the bricks of the contact zone.
fn obstacle(problem: &ContactProblem, forces: &ContactForces, found: &mut Vec<Warning>) {
    let grid = &problem.grid;
    let closed = |i: usize, j: usize| forces.status[grid.column(i, j)] != ContactStatus::Open;
    let (mut turn, mut bricks_per_wave) = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        let [along, across] = [grid.cells[axis], grid.cells[1 - axis]];
        let step = grid.size[axis] / (along * SAMPLES) as f64;
        let places: Vec<f64> = (0..=along * SAMPLES).map(|sample| uneven(sample, along * SAMPLES) * step).collect();
        for line in 0..=across {
            let node = |k: usize| if axis == 0 { (k, line) } else { (line, k) };
            let is_closed: Vec<bool> = (0..=along).map(|k| closed(node(k).0, node(k).1)).collect();
            if !is_closed.contains(&true) {
                continue;
            }
            let start = grid.position(node(0).0, node(0).1);
            let height = |&offset: &f64| {
                let mut place = start;
                place[axis] += offset;
                problem.scene.counter_surface.height(place[0], place[1])
            };
            let heights: Vec<f64> = places.iter().map(height).collect();
            let rises = heights.windows(2).zip(places.windows(2));
            let slopes: Vec<f64> = rises.map(|(h, x)| (h[1] - h[0]) / (x[1] - x[0])).collect();
            let turns: Vec<f64> = slopes.windows(2).map(|pair| pair[1].atan() - pair[0].atan()).collect();
            for brick in (0..along).filter(|&brick| is_closed[brick] || is_closed[brick + 1]) {
                let within = &turns[brick * SAMPLES..((brick + 1) * SAMPLES).min(turns.len())];
                turn = turn.max(within.iter().map(|turn| turn.abs()).sum::<f64>().to_degrees());
            }
            bricks_per_wave = bricks_per_wave.min(shortest_wave(&places, &slopes) / (step * SAMPLES as f64));
        }
    }
    let coarse = turn > MAX_TURN || bricks_per_wave < MIN_BRICKS_PER_WAVE;
    warn(found, coarse, "coarse-obstacle", || {
        let waves =
            if bricks_per_wave.is_finite() { format!(", {bricks_per_wave:.1} bricks per wave") } else { String::new() };
        format!(
            "the mesh is too coarse for the obstacle: it turns by {turn:.1} degrees over one brick{waves} (at most {MAX_TURN} \
             degrees, at least {MIN_BRICKS_PER_WAVE} bricks per wave)"
        )
    });
}

/// Places of samples between 0 and `last`, in steps: moved by up to half a step, so that no wave repeats itself.
fn uneven(sample: usize, last: usize) -> f64 {
    let ends = sample == 0 || sample == last;
    sample as f64 + if ends { 0.0 } else { 0.5 * (sample as f64 * 0.618_033_988_749_895).fract() }
}

/// The shortest wave of heights with these slopes between the places: from an extremum to the next but one, or twice
/// the distance of the only two; ∞ where there are fewer, since a single one is a hump.
fn shortest_wave(places: &[f64], slopes: &[f64]) -> f64 {
    let flat = FLAT * slopes.iter().fold(0.0, |steepest, slope| slope.abs().max(steepest));
    let middles = places.windows(2).map(|x| 0.5 * (x[0] + x[1]));
    let steep: Vec<(f64, f64)> = middles.zip(slopes.iter().copied()).filter(|(_, slope)| slope.abs() > flat).collect();
    let turns = steep.windows(2).filter(|pair| pair[0].1 * pair[1].1 < 0.0);
    let extrema: Vec<f64> =
        turns.map(|p| p[0].0 + (p[1].0 - p[0].0) * p[0].1.abs() / (p[0].1.abs() + p[1].1.abs())).collect();
    match extrema[..] {
        [first, second] => 2.0 * (second - first),
        _ => extrema.windows(3).map(|three| three[2] - three[0]).fold(f64::INFINITY, f64::min),
    }
}

/// The size of the contact zone, and where its pressure peaks.
fn zone(problem: &ContactProblem, forces: &ContactForces, found: &mut Vec<Warning>) {
    let grid = &problem.grid;
    let closed = forces.status.iter().filter(|status| **status != ContactStatus::Open).count();
    if closed == 0 {
        let text = "no node is closed: the bodies do not touch, and every pressure is zero".to_owned();
        return found.push(Warning { code: "no-contact", text });
    }
    let pressure = |(i, j): (usize, usize)| forces.normal[grid.column(i, j)] / grid.tributary_area(i, j);
    let Some((i, j)) = grid.columns().max_by(|a, b| pressure(*a).total_cmp(&pressure(*b))) else { return };
    let bodies = std::iter::once(&problem.scene.lower).chain(problem.scene.upper.as_ref().map(|upper| &upper.body));
    let stiffest = bodies.map(|body| body.material.young_modulus()).fold(0.0, f64::max);
    if problem.scene.load() == 0.0 && pressure((i, j)) <= ROUNDED_STRAIN * stiffest {
        let text = "nothing loads the bodies, and every pressure is zero up to rounding".to_owned();
        return found.push(Warning { code: "no-contact", text });
    }
    warn(found, closed < MIN_CLOSED_NODES, "few-closed-nodes", || {
        format!("{closed} nodes are closed: the contact zone is not resolved (at least {MIN_CLOSED_NODES} needed)")
    });
    let [n1, n2] = [grid.cells[0], grid.cells[1]];
    let on_edge = |(i, j): (usize, usize)| {
        // Where supports hold the nodes of a face against leaving it, the face is a plane of symmetry and no edge.
        let free = |axis: usize| !problem.scene.lower.held(grid, [i, j, grid.cells[2]])[axis];
        ((i == 0 || i == n1) && free(0)) || ((j == 0 || j == n2) && free(1))
    };
    let beside_open = |(i, j): (usize, usize)| {
        let neighbours = [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)];
        let mut inside = neighbours.into_iter().filter(|&(i, j)| i <= n1 && j <= n2);
        inside.any(|(i, j)| forces.status[grid.column(i, j)] == ContactStatus::Open)
    };
    if grid.columns().all(on_edge) {
        // Without a node inside, there is no pressure that one on the edge could exceed.
        return;
    }
    let inner = grid.columns().filter(|node| !on_edge(*node) && !beside_open(*node)).map(pressure).fold(0.0, f64::max);
    let at_edge = pressure((i, j)) > (1.0 + UNIFORM) * inner;
    warn(found, at_edge, "peak-at-edge", || {
        let [x1, x2] = grid.position(i, j);
        let where_it_is = if on_edge((i, j)) { "edge of the body" } else { "edge of the contact zone" };
        format!(
            "the pressure peaks at the {where_it_is}, at ({x1:.2}, {x2:.2}) mm: it may grow with every refinement of the mesh"
        )
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shortest wave of heights over 12 bricks of length 1.
    fn wave(height: impl Fn(f64) -> f64) -> f64 {
        let last = 12 * SAMPLES;
        let places: Vec<f64> = (0..=last).map(|sample| uneven(sample, last) / SAMPLES as f64).collect();
        let slopes: Vec<f64> = places.windows(2).map(|x| (height(x[1]) - height(x[0])) / (x[1] - x[0])).collect();
        shortest_wave(&places, &slopes)
    }

    #[test]
    fn a_wave_is_as_long_as_it_is_wherever_it_begins() {
        for length in [2.0, 2.4, 3.2, 3.96, 4.3, 7.0] {
            for shift in [0.0, 0.3, 1.1, 2.7] {
                let found = wave(|x| 5.0 + 0.2 * ((x - shift) * std::f64::consts::TAU / length).cos());
                assert!((found - length).abs() < 0.02 * length, "{length} {shift}: {found}");
            }
        }
        // A hump, a plane and a plateau with flanks are no waves.
        for found in [wave(|x| -(x - 6.1).powi(2)), wave(|x| 3.0 * x), wave(|x| (x - 6.0).abs().max(2.0))] {
            assert_eq!(found, f64::INFINITY);
        }
    }

    #[test]
    fn a_wave_as_long_as_the_steps_between_samples_is_seen() {
        for waves_per_step in [1.0, 2.0] {
            let found = wave(|x| (x * waves_per_step * SAMPLES as f64 * std::f64::consts::TAU).sin());
            assert!(found < 1.0, "{found}");
        }
    }
}
