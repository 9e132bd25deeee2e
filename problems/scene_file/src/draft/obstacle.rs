//! The obstacle that a face touches, by the form of the face.

use crate::draft::face::{Face, Form, dot, length};
use crate::draft::roles::within;
use crate::draft::text::{plain, straight, unit_vector, vector};
use contact::patches::Primitive;

/// The lines of a section, or what the user must say first.
pub(super) enum Proposal {
    Lines(String),
    Question(String),
}

/// The obstacle for a face of a body with these planes of symmetry, to which a plane that it touches is normal.
pub(super) fn obstacle(face: &Face<'_>, symmetric: &[&Face<'_>]) -> Proposal {
    let normal = face.direction().map(|normal| match face.form {
        Form::Plane => normal,
        _ => straight(within(normal, symmetric)),
    });
    match (&face.form, normal) {
        (Form::Plane, Some(normal)) => Proposal::Lines(format!(
            "# The face is plane: a rigid plane that touches all of it.\n{}",
            plane(face, normal)
        )),
        (Form::Round(primitive, convex), Some(normal)) if *convex => Proposal::Lines(format!(
            "# The face bulges: a rigid plane that touches it where it lies farthest out. In a seat of its form instead:\n\
             {}{}",
            commented(&around(primitive, true)),
            plane(face, normal)
        )),
        (Form::Round(primitive, convex), _) => {
            let what = if *convex { "goes around the body: what surrounds it" } else { "is hollow: what fills it" };
            let rest = "has its form and just touches it; another radius is a clearance";
            Proposal::Lines(format!("# The face {what} {rest}.\n{}", around(primitive, *convex)))
        }
        (Form::Free, Some(normal)) if face.is_nearly_plane() => Proposal::Lines(format!(
            "# The face is curved: a rigid plane that touches it where it lies farthest out along its mean normal.\n{}",
            plane(face, normal)
        )),
        (Form::Several(count), _) => Proposal::Question(format!(
            "\"{}\" has {count} smooth parts, which meet at edges: give each a name and a contact of its own, or take \
             form = \"mesh\" with a face of a mesh of what it touches",
            face.name
        )),
        (_, _) => Proposal::Question(format!(
            "\"{}\" is no plane, cylinder, cone or sphere; form = \"mesh\" takes a face of a mesh of what it touches, \
             \"revolution\" a profile",
            face.name
        )),
    }
}

/// Lines as comments.
fn commented(lines: &str) -> String {
    lines.lines().map(|line| format!("#   {line}\n")).collect()
}

/// The plane that just touches a face along a normal.
fn plane(face: &Face<'_>, normal: [f64; 3]) -> String {
    let level = |x: &[f64; 3]| dot(*x, normal);
    let outermost = face.points.iter().max_by(|a, b| level(a).total_cmp(&level(b))).copied();
    format!(
        "form = \"tilted-plane\"\npoint = {}\nnormal = {}\n",
        vector(outermost.unwrap_or_default()),
        unit_vector(normal)
    )
}

/// The obstacle of the form of a face: around it, or inside of it.
fn around(primitive: &Primitive, convex: bool) -> String {
    let side = if convex { "inside" } else { "outside" };
    match *primitive {
        Primitive::Cylinder { point, axis, radius } => format!(
            "form = \"cylinder\"\npoint = {}\naxis = {}\nradius = {}\nside = \"{side}\"\n",
            vector(point),
            unit_vector(upwards(axis)),
            plain(radius)
        ),
        Primitive::Sphere { point, radius } => {
            format!("form = \"ball\"\ncentre = {}\nradius = {}\nside = \"{side}\"\n", vector(point), plain(radius))
        }
        Primitive::Cone { point, axis, radius, slope } => {
            // The radius grows along the axis of the section.
            let axis = if slope < 0.0 { axis.map(|part| -part) } else { axis };
            format!(
                "form = \"cone\"\npoint = {}\naxis = {}\nradius = {}\nhalf_angle = {}\nside = \"{side}\"\n",
                vector(point),
                unit_vector(axis),
                plain(radius),
                plain(slope.abs().atan().to_degrees())
            )
        }
        Primitive::Plane { point, normal } => {
            format!("form = \"tilted-plane\"\npoint = {}\nnormal = {}\n", vector(point), unit_vector(normal))
        }
    }
}

/// The sense of an axis in which its largest part is positive.
pub(super) fn upwards(axis: [f64; 3]) -> [f64; 3] {
    let largest = axis.into_iter().fold(0.0_f64, |best, part| if part.abs() > best.abs() + 1e-9 { part } else { best });
    let size = length(axis).copysign(largest);
    axis.map(|part| part / size)
}
