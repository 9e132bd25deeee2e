//! The sketch of a scene: bodies at a shape, supports and loads with their values.

use crate::commands::failure::Failure;
use crate::commands::report::bodies::apart;
use crate::commands::report::contact_surface::ContactSurface;
use crate::commands::report::skin::{Skin, extent};
use crate::commands::scene_words;
use crate::commands::vectors::{dot, sum};
use contact::body::Body;
use contact::body::mesh::CellFace;
use contact::equilibrium::{ContactProblem, ContactRows, Positions};
use contact::formula::Formula;
use contact::scene::{Block, BodyScene, CounterSurface, Load, LoadKind, Scene, Support};
use contact::shape::ShapedFace;
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
/// Least relief that is magnified, as a share of the largest side.
const SEEN: f64 = 1e-6;
/// Largest share of an upper body that the magnified surface cuts off.
const MAX_CUT: f64 = 0.6;

/// Bodies at the shape of some controls, with what holds and what loads them.
///
/// # Errors
/// [`Failure`] for controls without a shape, and for a sketch that cannot be drawn.
pub fn sketch(problem: &ContactProblem, controls: &[f64]) -> Result<Figure, Failure> {
    let scene = &problem.scene;
    let positions = problem.positions(controls).map_err(Failure::computation)?;
    let sides: [f64; 3] = std::array::from_fn(|axis| {
        let lengths =
            positions.iter().map(|nodes| extent(nodes.iter().copied(), axis)).map(|[least, most]| most - least);
        lengths.fold(0.0, f64::max)
    });
    let side = sides.into_iter().fold(0.0, f64::max);
    let lift = nice_below(MAX_LIFT * side);
    let surfaces = ContactSurface::all(problem);
    let view = View::towards(surfaces.first().map_or([0.0, 0.0, 1.0], |surface| surface.normal));
    let counters = Counter::all(problem, &positions, &surfaces, side)?;
    let lifts = apart(scene, &surfaces, |surface| surface.normal.map(|part| lift * part));
    let nodes: Vec<Vec<[f64; 3]>> =
        positions.iter().enumerate().map(|(body, nodes)| carved(scene, &counters, (body, nodes))).collect();
    let parts = problem.bodies.iter().zip(&nodes).zip(&lifts);
    let mut bodies: Vec<SketchBody> = parts.clone().map(|((body, nodes), lift)| drawn(body, nodes, *lift)).collect();
    let mut notes = Vec::new();
    for counter in counters.iter().filter(|counter| counter.block.is_none()) {
        let surface = counter.surface;
        let lifted = sum(lifts[surface.body], surface.normal.map(|part| lift * part));
        bodies.push(SketchBody {
            points: counter.drawn().into_iter().map(|x| sum(x, lifted)).collect(),
            faces: surface.faces(),
        });
        notes.push(match surface.label.as_str() {
            "" => format!("surface {}: rigid obstacle", side_of(surface.normal)),
            label => format!("{label}: rigid obstacle"),
        });
    }
    let mut marks = Vec::new();
    for (((body, nodes), lift), of_scene) in parts.zip(&scene.bodies) {
        let name = scene_words::body(&body.name);
        let at = Place { body, nodes, name: &name, lift: *lift, side, viewer: view.towards_viewer() };
        marks.extend(of_scene.supports.iter().filter_map(|support| at.support(support)));
        marks.extend(of_scene.loads.iter().filter_map(|load| at.load(load)));
        notes.extend(of_scene.loads.iter().filter_map(body_force));
        notes.extend(materials(&name, of_scene));
    }
    notes.extend((0..scene.contacts.len()).flat_map(|contact| frictions(scene, contact)));
    notes.extend(counters.iter().map(Counter::words));
    notes.push(format!("bodies are drawn apart by {} mm along the normals of their contact", number(lift)));
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

/// The friction of a contact in words.
fn frictions(scene: &Scene, index: usize) -> Vec<String> {
    let contact = &scene.contacts[index];
    let label = scene_words::contact_label(scene, index);
    let lead = if label.is_empty() { label } else { format!("{label}: ") };
    if contact.is_tied() {
        return vec![if lead.is_empty() {
            scene_words::sides(scene, index)
        } else {
            lead.trim_end_matches(": ").into()
        }];
    }
    let own = match contact.friction > 0.0 {
        true => format!("{lead}friction coefficient {}", number(contact.friction)),
        false => format!("{lead}no friction"),
    };
    let regions = contact.friction_by_region.iter();
    let regions =
        regions.map(|(region, friction)| format!("{lead}friction coefficient {} on {region}", number(*friction)));
    std::iter::once(own).chain(regions).collect()
}

/// A counter surface as it is drawn: feet of the nodes of a contact surface, whose relief along the mean normal is
/// magnified so that its curvature is seen. It is an obstacle, or the bottom of a block.
struct Counter<'a> {
    surface: &'a ContactSurface,
    /// The body whose bottom it is.
    block: Option<usize>,
    feet: Vec<[f64; 3]>,
    low: f64,
    high: f64,
    times: f64,
}

impl<'a> Counter<'a> {
    /// The counter surfaces that are drawn: obstacles, and bottoms of blocks that no control moves.
    fn all(
        problem: &ContactProblem,
        positions: &Positions,
        surfaces: &'a [ContactSurface],
        side: f64,
    ) -> Result<Vec<Self>, Failure> {
        let rows = problem.rows(positions).map_err(Failure::computation)?;
        let mut found: Vec<Self> = Vec::new();
        for surface in surfaces {
            let block = match problem.scene.contacts[surface.contact].master_face() {
                None => None,
                Some(master) => match bottom_of(&problem.scene.bodies[master.body], &master.face) {
                    // Several contacts of one bottom would magnify it in several ways.
                    Some(_) if found.iter().all(|other| other.block != Some(master.body)) => Some(master.body),
                    _ => continue,
                },
            };
            found.push(Self::new(problem, &positions[surface.body], &rows, (surface, block), side));
        }
        Ok(found)
    }

    fn new(
        problem: &ContactProblem,
        positions: &[[f64; 3]],
        rows: &ContactRows,
        (surface, body): (&'a ContactSurface, Option<usize>),
        side: f64,
    ) -> Self {
        let node = |(&node, point): (&u32, &Option<usize>)| {
            let x = positions[node as usize];
            point.map_or(x, |point| {
                let row = &rows.nodes[point];
                sum(x, row.normal.map(|n| row.gap * n))
            })
        };
        let block = body.and_then(|body| problem.scene.bodies[body].block());
        let feet: Vec<[f64; 3]> = match block {
            None => surface.nodes().iter().zip(surface.points()).map(node).collect(),
            Some(block) => block.grid().places().map(|[x1, x2]| [x1, x2, block.bottom.height(x1, x2)]).collect(),
        };
        let levels = feet.iter().map(|foot| dot(*foot, surface.normal));
        let (low, high) =
            levels.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), level| (low.min(level), high.max(level)));
        let top = block.map_or(f64::INFINITY, least_top);
        let drawn = (RELIEF * side).min(MAX_CUT * (top - low));
        // Nobody sees a millionth of the size, and the normal of a plane may be rounded.
        let curved = high - low > SEEN * high.abs().max(side);
        let times = if curved { nice_below(drawn / (high - low)).max(1.0) } else { 1.0 };
        Self { surface, block: body, feet, low, high, times }
    }

    /// By how much a level is drawn above its own.
    fn raised(&self, level: f64) -> f64 {
        (self.times - 1.0) * (level - self.low)
    }

    fn drawn(&self) -> Vec<[f64; 3]> {
        let normal = self.surface.normal;
        let raised = |foot: &[f64; 3]| sum(*foot, normal.map(|part| self.raised(dot(*foot, normal)) * part));
        self.feet.iter().map(raised).collect()
    }

    fn words(&self) -> String {
        let relief = number(self.high - self.low);
        let label = &self.surface.label;
        let lead = if label.is_empty() { String::new() } else { format!("{label}: ") };
        match self.times > 1.0 {
            true => format!("{lead}counter surface: relief {relief} mm, drawn × {}", number(self.times)),
            false => format!("{lead}counter surface: relief {relief} mm"),
        }
    }
}

/// The bottom of a block where a face is that and no control moves the block.
fn bottom_of<'s>(body: &'s BodyScene, face: &str) -> Option<&'s CounterSurface> {
    let is_bottom = face == ShapedFace::Bottom.block_face().name();
    body.block().filter(|_| is_bottom && body.shape.is_none()).map(|block| &block.bottom)
}

/// The least height of the top of a block.
fn least_top(block: &Block) -> f64 {
    block.heights()[1].iter().copied().fold(f64::INFINITY, f64::min)
}

/// The nodes of a body, whose bottom is as it is drawn where it is a counter surface.
fn carved(scene: &Scene, counters: &[Counter<'_>], (body, nodes): (usize, &[[f64; 3]])) -> Vec<[f64; 3]> {
    let counter = counters.iter().find(|counter| counter.block == Some(body));
    let (Some(counter), Some(block)) = (counter, scene.bodies[body].block()) else { return nodes.to_vec() };
    let carved = |&[x1, x2, x3]: &[f64; 3]| {
        let (top, height) = (block.top.height(x1, x2), block.bottom.height(x1, x2));
        [x1, x2, top - (top - x3) * (top - height - counter.raised(height)) / (top - height)]
    };
    nodes.iter().map(carved).collect()
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
            let normal = self.body.mesh.face_vector(*face, self.nodes);
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
        let lines = self.spots(&support.face).into_iter();
        let line = |(x, normal): Spot| [sum(x, normal.map(|part| TRIANGLE * self.side * part)), x];
        scene_words::held(support).map(|held| SketchMark {
            sign: Sign::Support,
            text: format!("{}: {held}", self.words(&support.face)),
            lines: lines.map(line).collect(),
        })
    }

    /// None for a load of no size, and for one that has no place on the skin.
    fn load(&self, load: &Load) -> Option<SketchMark> {
        let face = load.place.as_deref().filter(|_| !matches!(load.kind, LoadKind::BodyForce(_)))?;
        let size = |vector: &[f64; 3]| dot(*vector, *vector).sqrt();
        let words = scene_words::load(load, || self.area(face));
        let at = |(x, normal): &Spot| -> [f64; 3] {
            match &load.kind {
                LoadKind::Traction(traction) => *traction,
                LoadKind::Pressure(pressure) => normal.map(|part| -pressure * part),
                // A moment alone is drawn along its axis.
                LoadKind::Resultant { force: [0.0, 0.0, 0.0], moment, .. } => *moment,
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

/// Where a surface with a normal from the body into it lies, in words.
fn side_of(normal: [f64; 3]) -> &'static str {
    match normal[2] {
        up if up >= 0.5 => "above",
        up if up <= -0.5 => "below",
        _ => "beside",
    }
}
