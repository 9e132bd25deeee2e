//! The sketch of a scene: bodies at a shape, supports and loads with their values.

use crate::commands::failure::Failure;
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::skin::{Skin, extent};
use crate::commands::solved_shape::ContactObjective;
use contact::body::Body;
use contact::body::mesh::CellFace;
use contact::equilibrium::{ContactProblem, Positions};
use contact::formula::Formula;
use contact::scene::{BodyScene, Held, Load, LoadKind, Scene, Support};
use figures::{Figure, Sign, Sketch, SketchBody, SketchMark, View, nice_below, number};

/// Most marks of one support or load.
const MARKS: usize = 9;
/// Length of the arrows of loads, and of the triangles of supports, as shares of the largest side.
const ARROW: f64 = 0.17;
const TRIANGLE: f64 = 0.08;
/// Largest lift of what is above the contact surface, as a share of the largest side.
const MAX_LIFT: f64 = 0.25;
/// Drawn relief of the counter surface, as a share of the largest side.
const RELIEF: f64 = 0.12;
/// Largest share of an upper body that the magnified surface cuts off.
const MAX_CUT: f64 = 0.6;

/// Bodies at the shape of some controls, with what holds and what loads them.
///
/// # Errors
/// [`Failure`] for controls without a shape, and for a sketch that cannot be drawn.
pub fn sketch(objective: &ContactObjective, controls: &[f64]) -> Result<Figure, Failure> {
    let problem = objective.solver().problem();
    let scene = &problem.scene;
    let positions = problem.positions(controls).map_err(Failure::computation)?;
    let sides: [f64; 3] = std::array::from_fn(|axis| {
        let lengths =
            positions.iter().map(|nodes| extent(nodes.iter().copied(), axis)).map(|[least, most]| most - least);
        lengths.fold(0.0, f64::max)
    });
    let side = sides.into_iter().fold(0.0, f64::max);
    let lift = nice_below(MAX_LIFT * side);
    let surface = ContactSurface::new(problem);
    let view = View::towards(surface.normal);
    let counter = Counter::new(problem, &positions, &surface, side)?;
    let mut bodies = vec![drawn(&problem.bodies[0], &positions[0], [0.0; 3])];
    let lifted = surface.normal.map(|part| lift * part);
    let upper: Option<Vec<[f64; 3]>> = positions.get(1).map(|nodes| counter.carved(scene, nodes));
    let mut notes = Vec::new();
    match &upper {
        Some(nodes) => bodies.push(drawn(&problem.bodies[1], nodes, lifted)),
        None => {
            let points = counter.drawn().into_iter().map(|x| sum(x, lifted)).collect();
            bodies.push(SketchBody { points, faces: surface.faces() });
            notes.push("surface above: rigid obstacle".to_owned());
        }
    }
    let mut marks = Vec::new();
    for (number, (body, (_, of_scene))) in problem.bodies.iter().zip(scene.bodies()).enumerate() {
        let (nodes, lift) =
            if number == 0 { (&positions[0][..], [0.0; 3]) } else { (upper.as_deref().unwrap_or(&[]), lifted) };
        let name = if body.name == "body" { "body".to_owned() } else { format!("{} body", body.name) };
        let at = Place { body, nodes, name: &name, lift, side, viewer: view.towards_viewer() };
        marks.extend(of_scene.supports.iter().filter_map(|support| at.support(support)));
        marks.extend(of_scene.loads.iter().filter_map(|load| at.load(load)));
        notes.extend(of_scene.loads.iter().filter_map(body_force));
        notes.extend(materials(&name, of_scene));
    }
    notes.push(match scene.contact.friction > 0.0 {
        true => format!("friction coefficient {}", number(scene.contact.friction)),
        false => "no friction".into(),
    });
    let regions = scene.contact.friction_by_region.iter();
    notes.extend(regions.map(|(region, friction)| format!("friction coefficient {} on {region}", number(*friction))));
    notes.push(counter.words());
    notes.push(format!("what lies above the contact surface is lifted by {} mm", number(lift)));
    let [a, b, _] = sides.map(number);
    let sketch = Sketch {
        name: "sketch".into(),
        title: format!("{}: bodies, supports and loads", scene.name),
        axes: [format!("x₁ ({a} mm)"), format!("x₂ ({b} mm)"), "x₃".into()],
        bodies,
        view,
        marks,
        notes,
    };
    sketch.figure().map_err(Failure::computation)
}

/// The counter surface as it is drawn: feet of the nodes of the contact surface, whose relief along the mean normal is
/// magnified so that its curvature is seen.
struct Counter {
    feet: Vec<[f64; 3]>,
    normal: [f64; 3],
    low: f64,
    high: f64,
    times: f64,
}

impl Counter {
    fn new(
        problem: &ContactProblem,
        positions: &Positions,
        surface: &ContactSurface,
        side: f64,
    ) -> Result<Self, Failure> {
        let rows = problem.rows(positions).map_err(Failure::computation)?;
        let node = |(&node, point): (&u32, &Option<usize>)| {
            let x = positions[0][node as usize];
            point.map_or(x, |point| {
                let row = &rows.nodes[point];
                sum(x, row.normal.map(|n| row.gap * n))
            })
        };
        let feet: Vec<[f64; 3]> = surface.nodes().iter().zip(surface.points()).map(node).collect();
        let levels = feet.iter().map(|foot| dot(*foot, surface.normal));
        let (low, high) =
            levels.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| (low.min(level), high.max(level)));
        let room = problem.scene.upper.as_ref().map_or(f64::INFINITY, |upper| MAX_CUT * (upper.top - low));
        let drawn = (RELIEF * side).min(room);
        // Differences that are rounding are no curvature.
        let curved = high - low > 16.0 * f64::EPSILON * high.abs().max(side);
        let times = if curved { nice_below(drawn / (high - low)).max(1.0) } else { 1.0 };
        Ok(Self { feet, normal: surface.normal, low, high, times })
    }

    /// By how much a level is drawn above its own.
    fn raised(&self, level: f64) -> f64 {
        (self.times - 1.0) * (level - self.low)
    }

    fn drawn(&self) -> Vec<[f64; 3]> {
        let raised = |foot: &[f64; 3]| sum(*foot, self.normal.map(|part| self.raised(dot(*foot, self.normal)) * part));
        self.feet.iter().map(raised).collect()
    }

    /// The nodes of an upper block whose lower surface is as it is drawn.
    fn carved(&self, scene: &Scene, nodes: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let Some(top) = scene.upper.as_ref().map(|upper| upper.top) else { return nodes.to_vec() };
        let carved = |&[x1, x2, x3]: &[f64; 3]| {
            let height = scene.counter_surface.height(x1, x2);
            [x1, x2, top - (top - x3) * (top - height - self.raised(height)) / (top - height)]
        };
        nodes.iter().map(carved).collect()
    }

    fn words(&self) -> String {
        let relief = number(self.high - self.low);
        match self.times > 1.0 {
            true => format!("counter surface: relief {relief} mm, drawn × {}", number(self.times)),
            false => format!("counter surface: relief {relief} mm"),
        }
    }
}

fn drawn(body: &Body, positions: &[[f64; 3]], lift: [f64; 3]) -> SketchBody {
    let skin = Skin::new(&body.mesh);
    let points = skin.nodes.iter().map(|&node| sum(positions[node as usize], lift)).collect();
    SketchBody { points, faces: skin.faces }
}

fn materials(name: &str, scene: &BodyScene) -> Vec<String> {
    let words = |name: &str, material: &contact::body::elasticity::Material| {
        let [modulus, ratio] = [material.young_modulus(), material.poisson_ratio()].map(number);
        format!("{name}: E = {modulus} MPa, ν = {ratio}")
    };
    let volumes = scene.materials.iter().map(|(volume, material)| words(&format!("{name}, {volume}"), material));
    std::iter::once(words(name, &scene.material)).chain(volumes).collect()
}

/// A load that acts in a volume, in words.
fn body_force(load: &Load) -> Option<String> {
    let LoadKind::BodyForce(force) = &load.kind else { return None };
    let [x1, x2, x3] = force.map(number);
    let place = load.place.as_deref().unwrap_or("the whole body");
    Some(format!("force per volume in {place}: ({x1}, {x2}, {x3}) N/mm³"))
}

/// Where marks of a body stand.
struct Place<'a> {
    body: &'a Body,
    nodes: &'a [[f64; 3]],
    name: &'a str,
    lift: [f64; 3],
    /// Largest side of the bodies, mm.
    side: f64,
    /// Towards the viewer.
    viewer: [f64; 3],
}

/// A place on a face, with its outward normal.
type Spot = ([f64; 3], [f64; 3]);

impl Place<'_> {
    fn faces(&self, name: &str) -> &[CellFace] {
        self.body.mesh.faces().get(name).map_or(&[], Vec::as_slice)
    }

    /// Some places on a face far from each other: on what is seen of it, else on all of it.
    fn spots(&self, name: &str) -> Vec<Spot> {
        let spot = |face: &CellFace| {
            let (nodes, corners) = self.body.mesh.face_with_corners(*face);
            let x: Vec<[f64; 3]> = nodes[..corners].iter().map(|&node| self.nodes[node as usize]).collect();
            let centre = std::array::from_fn(|axis| x.iter().map(|x| x[axis]).sum::<f64>() / corners as f64);
            let edge = |to: usize, from: usize| -> [f64; 3] { std::array::from_fn(|axis| x[to][axis] - x[from][axis]) };
            let (a, b) = if corners == 3 { (edge(1, 0), edge(2, 0)) } else { (edge(2, 0), edge(3, 1)) };
            let normal: [f64; 3] =
                std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
            let length = dot(normal, normal).sqrt();
            (sum(centre, self.lift), normal.map(|part| part / length))
        };
        let all: Vec<Spot> = self.faces(name).iter().map(spot).collect();
        let seen: Vec<Spot> = all.iter().copied().filter(|(_, normal)| dot(*normal, self.viewer) > 0.0).collect();
        far_apart(if seen.is_empty() { all } else { seen })
    }

    /// "lower body, x1-min"
    fn words(&self, face: &str) -> String {
        format!("{}, {face}", self.name)
    }

    /// None for a support that holds nothing.
    fn support(&self, support: &Support) -> Option<SketchMark> {
        // Components of one value share it.
        let mut values: Vec<(String, f64)> = Vec::new();
        match support.held {
            Held::Components(held) => {
                for (held, name) in held.iter().zip(["u₁", "u₂", "u₃"]) {
                    match (held, values.last_mut()) {
                        (Some(value), Some((names, last))) if value == last => *names += &format!(" = {name}"),
                        (Some(value), _) => values.push((name.into(), *value)),
                        (None, _) => {}
                    }
                }
            }
            Held::Normal(value) => values.push(("u along the normal".into(), value)),
        }
        let held: Vec<String> = values.iter().map(|(names, value)| format!("{names} = {}", number(*value))).collect();
        let lines = self.spots(&support.face).into_iter();
        let line = |(x, normal): Spot| [sum(x, normal.map(|part| TRIANGLE * self.side * part)), x];
        (!held.is_empty()).then(|| SketchMark {
            sign: Sign::Support,
            text: format!("{}: {}", self.words(&support.face), held.join(", ")),
            lines: lines.map(line).collect(),
        })
    }

    /// None for a load of no size, and for one that has no place on the skin.
    fn load(&self, load: &Load) -> Option<SketchMark> {
        let face = load.place.as_deref().filter(|_| !matches!(load.kind, LoadKind::BodyForce(_)))?;
        let vector = |vector: &[f64; 3]| {
            let [x1, x2, x3] = vector.map(number);
            format!("({x1}, {x2}, {x3})")
        };
        let size = |vector: &[f64; 3]| dot(*vector, *vector).sqrt();
        let words = match &load.kind {
            LoadKind::Traction(traction) => {
                format!("{} MPa, in all {} N", vector(traction), number(size(traction) * self.area(face)))
            }
            LoadKind::Pressure(pressure) => format!("pressure {} MPa", number(*pressure)),
            LoadKind::Resultant { force, moment, .. } => {
                format!("{} N with moment {} N mm", vector(force), vector(moment))
            }
            LoadKind::Formula(texts) => format!("traction ({}) MPa", texts.join(", ")),
            LoadKind::BodyForce(_) => String::new(),
        };
        let at = |(x, normal): &Spot| -> [f64; 3] {
            match &load.kind {
                LoadKind::Traction(traction) => *traction,
                LoadKind::Pressure(pressure) => normal.map(|part| -pressure * part),
                LoadKind::Resultant { force, .. } => *force,
                LoadKind::Formula(texts) => texts
                    .each_ref()
                    .map(|text| Formula::parse("formula", text).map_or(0.0, |formula| formula.value(*x))),
                LoadKind::BodyForce(_) => [0.0; 3],
            }
        };
        let spots = self.spots(face);
        let largest = spots.iter().map(|spot| size(&at(spot))).fold(0.0, f64::max);
        let line = |spot: &Spot| {
            let (x, normal) = *spot;
            let arrow = at(spot).map(|part| ARROW * self.side * part / largest);
            if dot(arrow, normal) < 0.0 { [sum(x, arrow.map(|part| -part)), x] } else { [x, sum(x, arrow)] }
        };
        (largest > 0.0).then(|| SketchMark {
            sign: Sign::Arrow,
            text: format!("{}: {words}", self.words(face)),
            lines: spots.iter().map(line).collect(),
        })
    }

    /// Area of a face, mm².
    fn area(&self, name: &str) -> f64 {
        self.faces(name).iter().map(|face| self.body.mesh.face_area(*face, self.nodes)).sum()
    }
}

/// Some of the places, each as far as possible from those before it.
fn far_apart(spots: Vec<Spot>) -> Vec<Spot> {
    let distance = |a: &Spot, b: &Spot| (0..3).map(|axis| (a.0[axis] - b.0[axis]).powi(2)).sum::<f64>();
    let mut chosen: Vec<Spot> = spots.first().copied().into_iter().collect();
    while chosen.len() < MARKS.min(spots.len()) {
        let nearest = |spot: &Spot| chosen.iter().map(|other| distance(spot, other)).fold(f64::INFINITY, f64::min);
        let Some(next) = spots.iter().max_by(|a, b| nearest(a).total_cmp(&nearest(b))) else { break };
        chosen.push(*next);
    }
    chosen
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}
