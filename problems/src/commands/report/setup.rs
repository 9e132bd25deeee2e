//! The sketch of a scene: bodies at a shape, supports and loads with their values.

use crate::commands::failure::Failure;
use crate::commands::solved_shape::ContactObjective;
use contact::body::mesh::{Block, Face};
use contact::scene::{BodyScene, Load, Support};
use figures::{Figure, Sign, Sketch, SketchBody, SketchMark, View, box_faces, grid_faces, nice_below, number};

/// Shares of a side at which marks stand.
const PLACES: [f64; 3] = [0.17, 0.5, 0.83];
/// Length of the arrows of loads, and of the triangles of supports, as shares of the largest side.
const ARROW: f64 = 0.17;
const TRIANGLE: f64 = 0.08;
/// Largest lift of what is above the contact surface, as a share of the largest side.
const MAX_LIFT: f64 = 0.25;

/// Bodies at the shape of some controls, with what holds and what loads them.
///
/// # Errors
/// [`Failure`] for controls without a shape, and for a sketch that cannot be drawn.
pub fn sketch(objective: &ContactObjective, controls: &[f64]) -> Result<Figure, Failure> {
    let problem = objective.solver().problem();
    let (scene, grid) = (&problem.scene, problem.grid);
    let blocks = problem.blocks(controls).map_err(Failure::computation)?;
    let [a, b] = grid.size;
    let tallest =
        blocks.iter().flat_map(|block| block.upper.iter().zip(&block.lower)).map(|(upper, lower)| upper - lower);
    let side = tallest.fold(a.max(b), f64::max);
    let lift = nice_below(MAX_LIFT * side);
    let counter = Counter::of(objective, side);
    let mut bodies = vec![body(&blocks[0], 0.0)];
    bodies.extend(blocks.get(1).map(|block| body(&counter.carved(block), lift)));
    let mut notes = Vec::new();
    if scene.upper.is_none() {
        let heights = grid.columns().map(|(i, j)| {
            let [x1, x2] = grid.position(i, j);
            [x1, x2, counter.drawn(scene.counter_surface.height(x1, x2)) + lift]
        });
        let faces = grid_faces([grid.cells[0] + 1, grid.cells[1] + 1]);
        bodies.push(SketchBody { points: heights.collect(), faces });
        notes.push("surface above: rigid obstacle".to_owned());
    }
    let mut marks = Vec::new();
    let names = ["lower body", "upper body"];
    for (((scene, block), name), lift) in problem.bodies().zip(&blocks).zip(names).zip([0.0, lift]) {
        let at = Place { block, name, lift, side };
        marks.extend(
            scene
                .supports
                .iter()
                .filter(|support| support.components.contains(&true))
                .map(|support| at.support(support)),
        );
        marks.extend(scene.loads.iter().filter_map(|load| at.load(load)));
        notes.push(material(name, scene));
    }
    notes.push(match scene.friction > 0.0 {
        true => format!("friction coefficient {}", number(scene.friction)),
        false => "no friction".into(),
    });
    notes.push(counter.words());
    notes.push(format!("what lies above the contact surface is lifted by {} mm", number(lift)));
    let sketch = Sketch {
        name: "sketch".into(),
        title: format!("{}: bodies, supports and loads", scene.name),
        axes: [format!("x₁ ({a} mm)"), format!("x₂ ({b} mm)"), "x₃".into()],
        bodies,
        view: View::default(),
        marks,
        notes,
    };
    sketch.figure().map_err(Failure::computation)
}

/// The counter surface as it is drawn: its heights over the lowest of them magnified, so that its curvature is seen.
struct Counter {
    low: f64,
    high: f64,
    times: f64,
}

impl Counter {
    /// The counter surface of an objective with bodies whose largest side has this length, mm.
    fn of(objective: &ContactObjective, side: f64) -> Self {
        /// Drawn difference of its heights, as a share of the largest side.
        const RELIEF: f64 = 0.12;
        /// Largest share of an upper body that the magnified surface cuts off.
        const MAX_CUT: f64 = 0.6;
        let problem = objective.solver().problem();
        let heights = problem.grid.columns().map(|(i, j)| {
            let [x1, x2] = problem.grid.position(i, j);
            problem.scene.counter_surface.height(x1, x2)
        });
        let extent = |(low, high): (f64, f64), height: f64| (low.min(height), high.max(height));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), extent);
        let room = problem.scene.upper.as_ref().map_or(f64::INFINITY, |upper| MAX_CUT * (upper.top - low));
        let drawn = (RELIEF * side).min(room);
        // Differences that are rounding are no curvature.
        let curved = high - low > 16.0 * f64::EPSILON * high.abs().max(side);
        Self { low, high, times: if curved { nice_below(drawn / (high - low)).max(1.0) } else { 1.0 } }
    }

    fn drawn(&self, height: f64) -> f64 {
        self.low + self.times * (height - self.low)
    }

    /// An upper body with the surface as it is drawn.
    fn carved(&self, block: &Block) -> Block {
        let lower = block.lower.iter().map(|height| self.drawn(*height)).collect();
        Block { lower, ..block.clone() }
    }

    fn words(&self) -> String {
        let [low, high] = [self.low, self.high].map(number);
        match self.times > 1.0 {
            true => format!("counter surface: heights {low} to {high} mm, drawn × {}", number(self.times)),
            false => format!("counter surface: heights {low} to {high} mm"),
        }
    }
}

fn body(block: &Block, lift: f64) -> SketchBody {
    let [n1, n2, n3] = block.grid.nodes();
    let nodes = (0..n1 * n2 * n3).map(|node| [node / (n2 * n3), node / n3 % n2, node % n3]);
    let lifted = |[x1, x2, x3]: [f64; 3]| [x1, x2, x3 + lift];
    let points = nodes.map(|node| lifted(block.coordinates(node))).collect();
    SketchBody { points, faces: box_faces([n1, n2, n3]) }
}

fn material(name: &str, scene: &BodyScene) -> String {
    let material = &scene.material;
    let [modulus, ratio] = [material.young_modulus(), material.poisson_ratio()].map(number);
    format!("{name}: E = {modulus} MPa, ν = {ratio}")
}

/// Where marks of a body stand.
struct Place<'a> {
    block: &'a Block,
    name: &'static str,
    /// By how much it is lifted, mm.
    lift: f64,
    /// Largest side of the bodies, mm.
    side: f64,
}

impl Place<'_> {
    /// Some nodes on a face; of a face that is turned away from the viewer, on those of its edges that are seen.
    fn nodes(&self, face: Face) -> Vec<[f64; 3]> {
        let grid = self.block.grid;
        let (normal, level) = grid.side(face);
        let [first, second] = [[1, 2], [0, 2], [0, 1]][normal];
        let shares: Vec<[f64; 2]> = match face {
            Face::X1Min => PLACES.map(|t| [0.0, t]).into(),
            Face::X2Max => PLACES.map(|t| [1.0, t]).into(),
            Face::Bottom => PLACES.map(|s| [s, 0.0]).into_iter().chain(PLACES.map(|t| [1.0, t])).collect(),
            Face::X1Max | Face::X2Min | Face::Top => PLACES.into_iter().flat_map(|s| PLACES.map(|t| [s, t])).collect(),
        };
        let along = |axis: usize, share: f64| (share * grid.cells[axis] as f64).round() as usize;
        let node = |[s, t]: [f64; 2]| {
            let mut node = [level; 3];
            node[first] = along(first, s);
            node[second] = along(second, t);
            let [x1, x2, x3] = self.block.coordinates(node);
            [x1, x2, x3 + self.lift]
        };
        shares.into_iter().map(node).collect()
    }

    /// The outward normal of a face, roughly for curved ones.
    fn outward(&self, face: Face) -> [f64; 3] {
        let (normal, level) = self.block.grid.side(face);
        let mut outward = [0.0; 3];
        outward[normal] = if level == 0 { -1.0 } else { 1.0 };
        outward
    }

    /// "lower body, x₁ = 0"
    fn words(&self, face: Face) -> String {
        let [a, b] = self.block.grid.size.map(number);
        let face = match face {
            Face::X1Min => "x₁ = 0".into(),
            Face::X1Max => format!("x₁ = {a} mm"),
            Face::X2Min => "x₂ = 0".into(),
            Face::X2Max => format!("x₂ = {b} mm"),
            Face::Bottom => "bottom".into(),
            Face::Top => "top".into(),
        };
        format!("{}, {face}", self.name)
    }

    fn support(&self, support: &Support) -> SketchMark {
        let held: Vec<&str> =
            support.components.iter().zip(["u₁", "u₂", "u₃"]).filter_map(|(held, name)| held.then_some(name)).collect();
        let outward = self.outward(support.face).map(|part| TRIANGLE * self.side * part);
        SketchMark {
            sign: Sign::Support,
            text: format!("{}: {} = 0", self.words(support.face), held.join(" = ")),
            lines: self.nodes(support.face).into_iter().map(|node| [sum(node, outward), node]).collect(),
        }
    }

    /// None without a traction.
    fn load(&self, load: &Load) -> Option<SketchMark> {
        let size = load.traction.iter().map(|part| part * part).sum::<f64>().sqrt();
        let arrow = load.traction.map(|part| ARROW * self.side * part / size);
        let inward =
            load.traction.iter().zip(self.outward(load.face)).map(|(part, outward)| part * outward).sum::<f64>() < 0.0;
        let [t1, t2, t3] = load.traction.map(number);
        let force = number(size * self.area(load.face));
        (size > 0.0).then(|| SketchMark {
            sign: Sign::Arrow,
            text: format!("{}: ({t1}, {t2}, {t3}) MPa, in all {force} N", self.words(load.face)),
            lines: self
                .nodes(load.face)
                .into_iter()
                .map(|node| if inward { [sum(node, arrow.map(|part| -part)), node] } else { [node, sum(node, arrow)] })
                .collect(),
        })
    }

    /// Area of a face that carries a load, mm²: the contact surface, which may be curved, carries none.
    fn area(&self, face: Face) -> f64 {
        let (block, grid) = (self.block, self.block.grid);
        let [a, b] = grid.size;
        let (normal, level) = grid.side(face);
        if normal == 2 {
            return a * b;
        }
        // Trapezoids between the columns of nodes along the face.
        let along = 1 - normal;
        let step = grid.size[along] / grid.cells[along] as f64;
        let heights = (0..=grid.cells[along]).map(|index| {
            let column = if normal == 0 { grid.column(level, index) } else { grid.column(index, level) };
            let share = if index == 0 || index == grid.cells[along] { 0.5 } else { 1.0 };
            share * (block.upper[column] - block.lower[column])
        });
        step * heights.sum::<f64>()
    }
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}
