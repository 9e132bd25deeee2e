//! Random scenes in five families, as scene files: blocks whose contact normal is x₃.
//!
//! ```text
//! log₁₀(stiffness × gap range / load) ∈ [−1, 7],   𝓕 = 0 in a third of the scenes, else ∈ [0, 3],   ν ∈ [−0.9, 0.4999],
//! longest over shortest edge of a brick ≤ 1000,   3 … 8 bricks per edge
//! ```
//! Stiffness is E times the mean edge of the base, the gap range that of the obstacle over the start, the load the
//! largest force.

use std::fmt::Write;
use testset::kit::Random;

/// How the bodies are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Supports hold every body.
    Held,
    /// One body that contact alone holds, or nearly so.
    FreeBody,
    /// Two bodies, the upper one held by contact.
    FreeUpper,
    /// A block that can tilt, under a load beside its middle.
    Tilting,
    /// A small sphere under a light load.
    FewNodes,
}

impl Family {
    /// All families; the scene of an index belongs to `ALL[index % 5]`.
    pub const ALL: [Self; 5] = [Self::Held, Self::FreeBody, Self::FreeUpper, Self::Tilting, Self::FewNodes];
}

/// A value between bounds whose logarithm is uniform.
fn log_uniform(random: &mut Random, low: f64, high: f64) -> f64 {
    (low.ln() + (high / low).ln() * random.unit()).exp()
}

fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.unit()
}

/// Numbers that several parts of a scene share.
struct Sizes {
    base: [f64; 2],
    height: f64,
    range: f64,
    young: f64,
    force: f64,
    friction: f64,
}

/// The text of the scene with an index, for a seed.
pub fn scene(seed: u64, index: usize) -> (Family, String) {
    let family = Family::ALL[index % Family::ALL.len()];
    let random = &mut Random(seed.wrapping_mul(0x0100_0000_01B3).wrapping_add(index as u64));
    let friction = if random.below(3) == 0 { 0.0 } else { between(random, 0.0, 3.0) };
    let mesh: [usize; 3] = std::array::from_fn(|_| 3 + random.below(6));
    let first = log_uniform(random, 0.1, 1000.0);
    // Edges of a brick: the aspect is uniform in its logarithm, and any edge may be the longest.
    let aspect = log_uniform(random, 1.0, 1000.0);
    let middle = log_uniform(random, 1.0, aspect);
    let mut edges = [1.0, middle, aspect];
    edges.rotate_left(random.below(3));
    let scale = first / (edges[0] * mesh[0] as f64);
    let lengths: [f64; 3] = std::array::from_fn(|axis| edges[axis] * mesh[axis] as f64 * scale);
    let young = log_uniform(random, 1.0, 1e6);
    let range = log_uniform(random, 1e-4, 0.05) * lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let mean = (lengths[0] * lengths[1]).sqrt();
    let decades = if family == Family::FewNodes { between(random, 3.0, 7.0) } else { between(random, -1.0, 7.0) };
    let force = young * mean * range / 10_f64.powf(decades);
    let sizes = Sizes { base: [lengths[0], lengths[1]], height: lengths[2], range, young, force, friction };
    let block = format!("[body.block]\nsize = [{:e}, {:e}]\nbricks = {mesh:?}\n", lengths[0], lengths[1]);
    let [lower, upper] = bodies(family, &sizes, random);
    let (obstacle, shape) = (obstacle(family, &sizes, random), shape(&sizes, random));
    let head = format!("name = \"random {seed} {index}\"\nfriction = {friction:e}\n\n");
    let lower = format!("[[body]]\nname = \"lower\"\n\n{block}\n{lower}{shape}");
    let rest = if upper.is_empty() {
        format!("[[contact]]\nslave = {{ face = \"top\" }}\nnormal = \"x3\"\n\n[contact.obstacle]\n{obstacle}")
    } else {
        let top = format!("top = {{ form = \"plane\", height = {:e} }}\n", 2.0 * sizes.height + 2.0 * sizes.range);
        format!(
            "[[body]]\nname = \"upper\"\n\n{block}{top}\n[body.block.bottom]\n{obstacle}\n{upper}[[contact]]\n\
             slave = {{ body = \"lower\", face = \"top\" }}\nmaster = {{ body = \"upper\", face = \"bottom\" }}\n\
             normal = \"x3\"\n"
        )
    };
    (family, head + &lower + &rest)
}

fn material(text: &mut String, young: f64, random: &mut Random) {
    let ratio = if random.below(6) == 0 { 0.5 - log_uniform(random, 1e-4, 0.1) } else { between(random, -0.9, 0.45) };
    let formulation = if random.below(3) == 0 { "mean-dilatation" } else { "standard" };
    let _ = write!(
        text,
        "[body.material]\nyoung_modulus = {young:e}\npoisson_ratio = {ratio:e}\nformulation = \"{formulation}\"\n\n"
    );
}

fn support(text: &mut String, face: &str, held: &[&str]) {
    let _ = write!(text, "[[body.supports]]\nface = \"{face}\"\nheld = {held:?}\n\n");
}

fn load(text: &mut String, face: &str, traction: [f64; 3]) {
    let [a, b, c] = traction;
    let _ = write!(text, "[[body.loads]]\nface = \"{face}\"\ntraction = [{a:e}, {b:e}, {c:e}]\n\n");
}

/// Materials, supports and loads of the lower and of the upper body; nothing of an upper one that is not there.
fn bodies(family: Family, sizes: &Sizes, random: &mut Random) -> [String; 2] {
    let (mut lower, mut upper) = (String::new(), String::new());
    let pressure = sizes.force / (sizes.base[0] * sizes.base[1]);
    let side = sizes.force / (sizes.base[1] * sizes.height);
    // Without friction, a tangential load needs a support; with it, some loads are beyond the cone.
    let tangential = |random: &mut Random, held: bool| {
        let share = if held || sizes.friction > 0.0 { random.signed() * 0.4 * sizes.friction.max(0.3) } else { 0.0 };
        if random.below(2) == 0 { share } else { 0.0 }
    };
    match family {
        Family::Held => {
            material(&mut lower, sizes.young, random);
            support(&mut lower, "bottom", &["u1", "u2", "u3"]);
            let shares = [tangential(random, true), tangential(random, true)];
            load(&mut lower, "x1-max", [side * shares[0], side * shares[1], side]);
        }
        Family::FreeBody | Family::FewNodes => {
            material(&mut lower, sizes.young, random);
            match random.below(4) {
                0 => support(&mut lower, "x1-min", &["u1"]),
                1 => support(&mut lower, "x1-min", &["u1", "u2"]),
                _ => {}
            }
            let shares = [tangential(random, false), tangential(random, false)];
            load(&mut lower, "bottom", [pressure * shares[0], pressure * shares[1], pressure]);
        }
        Family::FreeUpper => {
            material(&mut lower, sizes.young, random);
            support(&mut lower, "bottom", &["u1", "u2", "u3"]);
            material(&mut upper, sizes.young * log_uniform(random, 0.01, 100.0), random);
            let shares = [tangential(random, false), tangential(random, false)];
            load(&mut upper, "top", [pressure * shares[0], pressure * shares[1], -pressure]);
        }
        Family::Tilting => {
            material(&mut lower, sizes.young, random);
            match random.below(3) {
                0 => support(&mut lower, "x1-min", &["u1"]),
                1 => support(&mut lower, "x2-min", &["u2", "u1"]),
                _ => {}
            }
            load(&mut lower, "bottom", [0.0, 0.0, pressure]);
            load(&mut lower, "x1-max", [0.0, 0.0, side * 0.6 * random.signed()]);
        }
    }
    [lower, upper]
}

/// What the lower body meets, or the bottom of the upper body.
fn obstacle(family: Family, sizes: &Sizes, random: &mut Random) -> String {
    let (top, range) = (sizes.height, sizes.range);
    let [a, b] = sizes.base;
    let gap = if random.below(2) == 0 { 0.0 } else { range * random.unit() };
    let (kind, height) = (random.below(4), top + gap);
    match (family, kind) {
        (_, 0) => {
            // A sphere over the corner (0, 0) that varies by the range over the base and covers it.
            let radius = ((a * a + b * b) / (2.0 * range)).max(1.01 * a.hypot(b));
            format!("form = \"sphere\"\napex = {height:e}\nradius = {radius:e}\n")
        }
        (family, 1) if family != Family::FewNodes => format!("form = \"plane\"\nheight = {height:e}\n"),
        _ => {
            // One hump or several: the lowest place is at ¾ of the period along x₁ and at ½ along x₂.
            let period = a * between(random, 0.3, 0.7) / 0.75 / if kind == 2 { 1.0 } else { between(random, 1.0, 2.0) };
            let (base, size) = (height + range, 0.5 * range);
            format!("form = \"waves\"\nbase = {base:e}\nfirst = {size:e}\nsecond = {size:e}\nperiod = {period:e}\n")
        }
    }
}

/// A rippled start below the obstacle, and a wide admissible set.
fn shape(sizes: &Sizes, random: &mut Random) -> String {
    let ripple = if random.below(2) == 0 { 0.0 } else { 0.5 * sizes.range };
    let heights: Vec<String> = (0..16).map(|_| format!("{:e}", sizes.height - ripple * random.unit())).collect();
    format!(
        "[body.lattice]\nheights = \"top\"\ncontrol_points = [4, 4]\nthickness = {:e}\nslope = 1e9\n\
         volume = [0.0, 1e27]\ncontrols = [{}]\n\n",
        0.1 * sizes.height,
        heights.join(", ")
    )
}
