//! A first scene for a mesh, from the names of its faces: commented, to be changed.
//!
//! The names say which face touches, which is held, which is loaded; where they do not, the face opposite to the one
//! that touches is loaded, and guided across. The obstacle is the plane that just touches the face along its mean
//! normal n or, for a face around the body, a cylinder along an axis. The load presses the face on it with a mean
//! pressure of E/10⁴.

use crate::UnitName;
use crate::mesh_file;
use contact::body::mesh::{CellFace, Mesh, bounding_box};
use contact::error::SceneError;
use std::fmt::Write;
use std::path::Path;

/// Parts of names that tell what a face is for; the first list that has one decides.
const TOUCHES: &[&str] =
    &["contact", "touch", "seat", "nose", "foot", "sole", "bearing", "sealing", "interface", "slave", "raceway"];
const SYMMETRIC: &[&str] = &["symm"];
const HELD: &[&str] = &["support", "wall", "fix", "clamp", "held", "hold", "bolt", "guide", "mount"];
const LOADED: &[&str] = &["load", "force", "press", "top", "head", "eye", "pin", "pull", "push", "hole"];
/// Longest side, in the unit of the file, below which lengths are taken for metres.
const METRES: f64 = 1.0;
/// Part of the area of a face that its mean normal has at least, where the face is taken for a plane.
const PLANE: f64 = 0.5;
/// Young's modulus (MPa) and Poisson's ratio of steel.
const STEEL: [f64; 2] = [2.1e5, 0.3];
/// Mean pressure of the load over Young's modulus.
const PRESSURE: f64 = 1e-4;
/// Bound of the displacements of control points over the smallest side of the body.
const MOVED: f64 = 0.02;

/// A face with what the draft asks of it.
struct Face<'a> {
    name: &'a str,
    area: f64,
    /// ∫n dA.
    normal: [f64; 3],
    /// ∫n_i² dA.
    squares: [f64; 3],
    /// ∫n·x dA.
    moment: f64,
    points: Vec<[f64; 3]>,
}

/// The text of a scene for a mesh in a Gmsh file, to be saved beside it.
///
/// ```
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");
/// let text = scene_file::draft(format!("{folder}/lug_tet10.msh").as_ref())?;
/// let scene = scene_file::SceneFile::parse(&text, "draft")?;
/// let case = scene_file::Case::new(&scene, folder.as_ref())?;
/// assert_eq!(case.scene.contacts[0].slave.face, "nose");
/// # Ok::<(), contact::error::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError`] for a file that is no mesh of one body, and for a mesh that names fewer than two faces.
pub fn draft(file: &Path) -> Result<String, SceneError> {
    let read = mesh_file::read(file, UnitName::Mm)?;
    let longest = sides(&read.mesh).into_iter().fold(0.0, f64::max);
    let unit = if longest < METRES { UnitName::M } else { UnitName::Mm };
    let mesh = read.mesh.moved(|x| x.map(|x| unit.millimetres() * x));
    let faces: Vec<Face<'_>> = mesh.faces().iter().map(|(name, faces)| Face::new(&mesh, name, faces)).collect();
    if faces.len() < 2 {
        let value = format!("{:?}", mesh.faces().keys().collect::<Vec<_>>());
        let allowed = "at least two physical surfaces, one that touches and one that is loaded or held (Gmsh: \
                       addPhysicalGroup(2, [tags], name=\"contact\"))";
        return Err(SceneError::out_of_range(format!("{}: named faces", file.display()), value, allowed));
    }
    let name =
        |path: Option<&std::ffi::OsStr>| path.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Ok(Draft::new(&mesh, &faces, unit).text(&name(file.file_stem()), &name(file.file_name())))
}

/// Lengths of the box around a mesh.
fn sides(mesh: &Mesh) -> [f64; 3] {
    let [low, high] = bounding_box(mesh.nodes());
    std::array::from_fn(|axis| high[axis] - low[axis])
}

fn is_among(name: &str, parts: &[&str]) -> bool {
    let name = name.to_lowercase();
    parts.iter().any(|part| name.contains(part))
}

impl<'a> Face<'a> {
    fn new(mesh: &Mesh, name: &'a str, faces: &[CellFace]) -> Self {
        let mut this = Self { name, area: 0.0, normal: [0.0; 3], squares: [0.0; 3], moment: 0.0, points: Vec::new() };
        for &face in faces {
            let (nodes, count) = mesh.face_with_corners(face);
            let x: Vec<[f64; 3]> = nodes[..count].iter().map(|&node| mesh.nodes()[node as usize]).collect();
            let normal = mesh.face_vector(face, mesh.nodes());
            let area = dot(normal, normal).sqrt();
            this.area += area;
            this.moment += x.iter().map(|x| dot(normal, *x)).sum::<f64>() / count as f64;
            for axis in 0..3 {
                this.normal[axis] += normal[axis];
                this.squares[axis] += normal[axis].powi(2) / area.max(f64::MIN_POSITIVE);
            }
            this.points.extend(x);
        }
        this
    }

    /// Whether its mean normal is one of the whole face.
    fn is_plane(&self) -> bool {
        dot(self.normal, self.normal).sqrt() >= PLANE * self.area
    }

    /// How far it looks against a direction.
    fn against(&self, direction: [f64; 3]) -> f64 {
        -dot(self.normal, direction)
    }
}

/// What the names say, and what fills their gaps.
struct Draft<'a> {
    unit: UnitName,
    faces: &'a [Face<'a>],
    contact: &'a Face<'a>,
    /// Whether a name has said it, here and below.
    contact_is_named: bool,
    held: Vec<&'a Face<'a>>,
    symmetric: Vec<&'a Face<'a>>,
    loaded: &'a Face<'a>,
    loaded_is_named: bool,
    /// The unit normal of a plane face that touches; of a face around the body the direction of its load.
    direction: [f64; 3],
    smallest_side: f64,
    volumes: Vec<&'a str>,
}

impl<'a> Draft<'a> {
    fn new(mesh: &'a Mesh, faces: &'a [Face<'a>], unit: UnitName) -> Self {
        let role =
            |face: &Face<'_>| [TOUCHES, SYMMETRIC, HELD, LOADED].iter().position(|parts| is_among(face.name, parts));
        let of_role = |number: usize| faces.iter().filter(|face| role(face) == Some(number)).collect::<Vec<_>>();
        let [touching, symmetric, held, loaded] = [0, 1, 2, 3].map(of_role);
        let height = |face: &Face<'_>| face.points.iter().map(|x| x[2]).sum::<f64>() / face.points.len().max(1) as f64;
        let lowest = faces.iter().filter(|face| role(face).is_none());
        let lowest = lowest.min_by(|a, b| height(a).total_cmp(&height(b)));
        let contact = touching.first().copied().or(lowest).unwrap_or(&faces[0]);
        let direction = contact.direction();
        let others = faces.iter().filter(|face| face.name != contact.name);
        let opposite = others.max_by(|a, b| a.against(direction).total_cmp(&b.against(direction)));
        let but_contact =
            |own: Vec<&'a Face<'a>>| -> Vec<_> { own.into_iter().filter(|face| face.name != contact.name).collect() };
        let named_load = but_contact(loaded).first().copied();
        Self {
            unit,
            faces,
            contact,
            contact_is_named: !touching.is_empty(),
            held: but_contact(held),
            symmetric: but_contact(symmetric),
            loaded: named_load.or(opposite).unwrap_or(&faces[0]),
            loaded_is_named: named_load.is_some(),
            direction,
            smallest_side: sides(mesh).into_iter().fold(f64::INFINITY, f64::min),
            volumes: mesh.volumes().iter().map(String::as_str).collect(),
        }
    }

    /// The axis along which contact acts.
    fn axis(&self) -> usize {
        largest(self.direction.map(f64::abs))
    }

    fn text(&self, stem: &str, file: &str) -> String {
        let mut text = String::new();
        let name = self.contact.name;
        let guess = |is_named: bool| if is_named { "by its name" } else { "a guess: no name says it" };
        let mut line = |words: &str| {
            let _ = writeln!(text, "{words}");
        };
        let [stem_words, file_words] = [stem, file].map(commented);
        line(&format!("# A first scene for {file_words}, from the names of its faces. Change what does not fit, then"));
        line(&format!(
            "#   contact3d {stem_words}.toml look --out results/{stem_words}_look   shows it before any solve,"
        ));
        line(&format!("#   contact3d {stem_words}.toml evaluate --out results/{stem_words}    solves it,"));
        line(&format!("#   contact3d {stem_words}.toml --out results/{stem_words}_optimum     optimizes the shape."));
        line("# Units: N, mm, MPa. docs/scenes.md explains every field.");
        line(&format!(
            "# Faces: {}.",
            commented(&self.faces.iter().map(|face| face.name).collect::<Vec<_>>().join(", "))
        ));
        line(&format!("name = {}", quoted(stem)));
        line("# Coulomb friction coefficient: dry steel on steel has about 0.15 to 0.3.");
        line("friction = 0.15\n");
        line("[[body]]");
        line(&format!("mesh = {}", quoted(file)));
        line(match self.unit {
            UnitName::Mm => "# Lengths in the file are mm; unit = \"m\" and others are allowed.",
            _ => "# The part would be shorter than 1 mm if its lengths were mm.\nunit = \"m\"",
        });
        line("# Steel.");
        line(&format!("material = {{ young_modulus = {:e}, poisson_ratio = {} }}", STEEL[0], STEEL[1]));
        if self.volumes.len() > 1 {
            let volume = quoted(self.volumes[0]);
            line(&format!("# Volumes: {}. One of other material:", commented(&self.volumes.join(", "))));
            line(&format!("# materials = [{{ volume = {volume}, young_modulus = 7e4, poisson_ratio = 0.33 }}]"));
        }
        line("# Held displacements: u1, u2, u3 along the axes, or \"normal\". They and contact must carry the loads.");
        line(&self.supports());
        line(&format!("# What presses the body on the obstacle ({}). Total force, N.", guess(self.loaded_is_named)));
        let force = self.direction.map(|part| rounded(STEEL[0] * PRESSURE * self.contact.area * part));
        let face = quoted(self.loaded.name);
        line(&format!("loads = [{{ face = {face}, force = {} }}]\n", vector(force)));
        line("[body.lattice]");
        line(&self.lattice());
        line("[[contact]]");
        line(&format!("# The face that may touch ({}).", guess(self.contact_is_named)));
        line(&format!("slave = {{ face = {} }}\n", quoted(name)));
        line("[contact.obstacle]");
        line(&self.obstacle());
        line("# What is minimised; peak-pressure, stress-norm and others are in docs/scenes.md.");
        line("[objective]\nquantity = \"pressure-norm\"\n");
        line("# No more volume than at the start.");
        line("[[limit]]\nquantity = \"relative-volume\"\nat_most = 1.0\n");
        line("# A second load case:");
        line(&format!(
            "# [[case]]\n# name = \"first\"\n#\n# [[case]]\n# name = \"second\"\n# body = [{{ loads = [{{ face = {face}, force = {} }}] }}]",
            vector(force.map(|part| 2.0 * part))
        ));
        text
    }

    /// Symmetry planes along their normals, other held faces across the direction of contact.
    fn supports(&self) -> String {
        let across: Vec<&str> =
            (0..3).filter(|axis| *axis != self.axis()).map(|axis| ["\"u1\"", "\"u2\"", "\"u3\""][axis]).collect();
        let mut lines: Vec<String> = self
            .symmetric
            .iter()
            .map(|face| format!("    {{ face = {}, held = [\"normal\"] }},", quoted(face.name)))
            .collect();
        let guided = if self.held.is_empty() { vec![self.loaded] } else { self.held.clone() };
        let held = guided.iter().map(|face| {
            let why = if self.held.is_empty() { " # a guess: no name says what holds the body" } else { "" };
            format!("    {{ face = {}, held = [{}] }},{why}", quoted(face.name), across.join(", "))
        });
        lines.extend(held);
        format!("supports = [\n{}\n]", lines.join("\n"))
    }

    fn obstacle(&self) -> String {
        let face = self.contact;
        if face.is_plane() {
            let level = |x: &[f64; 3]| dot(*x, self.direction);
            let outermost = face.points.iter().max_by(|a, b| level(a).total_cmp(&level(b))).copied();
            return format!(
                "# A rigid plane that just touches the face; ball, cylinder and others are in docs/scenes.md.\n\
                 form = \"tilted-plane\"\npoint = {}\nnormal = {}\n",
                vector(outermost.unwrap_or_default()),
                vector(self.direction)
            );
        }
        let axis = face.round_axis();
        let [low, high] = bounding_box(&face.points);
        let centre: [f64; 3] = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        let across =
            |x: &[f64; 3]| (0..3).filter(|i| *i != axis).map(|i| (x[i] - centre[i]).powi(2)).sum::<f64>().sqrt();
        // A face that looks away from the axis is a shaft, and what it touches a bore around it.
        let (radius, side) = match face.moment > dot(face.normal, centre) {
            true => (face.points.iter().map(across).fold(0.0, f64::max), "inside"),
            false => (face.points.iter().map(across).fold(f64::INFINITY, f64::min), "outside"),
        };
        let direction: [f64; 3] = std::array::from_fn(|i| f64::from(u8::from(i == axis)));
        format!(
            "# A rigid cylinder that just touches the face.\nform = \"cylinder\"\npoint = {}\naxis = {}\n\
             radius = {}\nside = \"{side}\"\n",
            vector(centre),
            vector(direction),
            plain(radius)
        )
    }

    fn lattice(&self) -> String {
        let (face, bound) = (quoted(self.contact.name), rounded(MOVED * self.smallest_side));
        let bounds =
            format!("# Bounds of the displacements of the control points, mm.\ndisplacement = [{}, {bound}]\n", -bound);
        if !self.contact.is_plane() {
            return format!(
                "# Control points that move the nodes of the face along its normals.\nnormal = {face}\n\
                 control_points = [4, 4, 4]\n{bounds}"
            );
        }
        let axis = self.axis();
        let list = |value: &dyn Fn(usize) -> String| (0..3).map(value).collect::<Vec<_>>().join(", ");
        format!(
            "# Control points that move the face in the direction of contact.\nregion = [{face}]\n\
             control_points = [{}]\ndirections = [{}]\n{bounds}",
            list(&|i| if i == axis { "1".into() } else { "4".into() }),
            axis + 1
        )
    }
}

impl Face<'_> {
    /// The unit mean normal; of a face around the body the axis of x₁, x₂, x₃ along which it is pressed.
    fn direction(&self) -> [f64; 3] {
        let length = dot(self.normal, self.normal).sqrt();
        if self.is_plane() {
            return self.normal.map(|part| tidy(part / length));
        }
        let across = (self.round_axis() + 2) % 3;
        std::array::from_fn(|axis| if axis == across { -1.0 } else { 0.0 })
    }

    /// The axis that the normals of a face around the body are perpendicular to.
    fn round_axis(&self) -> usize {
        largest(self.squares.map(|square| -square))
    }
}

/// The place of the largest number.
fn largest(numbers: [f64; 3]) -> usize {
    (1..3).fold(0, |best, axis| if numbers[axis] > numbers[best] { axis } else { best })
}

/// A part of a unit vector in three decimals.
fn tidy(part: f64) -> f64 {
    let rounded = (part * 1e3).round() / 1e3;
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// A number of two digits.
fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return 0.0;
    }
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// A number of TOML without rounding errors: nine decimals.
fn plain(part: f64) -> String {
    let part = (part * 1e9).round() / 1e9;
    if part == part.trunc() && part.abs() < 1e15 { format!("{part:.1}") } else { format!("{part}") }
}

fn vector(vector: [f64; 3]) -> String {
    format!("[{}]", vector.map(plain).join(", "))
}

/// A text in a comment, whose line it must not end.
fn commented(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// A text of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
