//! The lattice of a draft, by the kind of the faces that touch.

use crate::draft::face::{Face, Form, dot, length};
use crate::draft::obstacle::upwards;
use crate::draft::roles::Roles;
use crate::draft::text::{plain, quoted, rounded, unit_vector, vector};
use contact::body::mesh::bounding_box;
use contact::patches::Primitive;

/// Bound of the displacements of control points over the smallest side of the body.
const MOVED: f64 = 0.02;
/// Part of the largest side of a face below which it has no extent along an axis.
const THIN: f64 = 0.2;
/// Control points along a coordinate in which a face extends.
const COUNT: usize = 4;
/// Part by which the sector of a tube around a face is wider than the face.
const MARGIN: f64 = 0.01;
/// Part of a unit vector along an axis from which it is that axis.
const ALONG: f64 = 1.0 - 1e-6;

/// The lines of the lattice.
pub(super) fn lattice(roles: &Roles<'_>, smallest_side: f64) -> String {
    let bound = rounded(MOVED * smallest_side);
    let lines = match roles.contacts[..] {
        [face] => one(face),
        _ => several(roles),
    };
    format!(
        "[body.lattice]\n{lines}# Bounds of the displacements of the control points, mm.\ndisplacement = [{}, {bound}]\n",
        -bound
    )
}

/// The axis that a direction has.
fn axis_of(direction: [f64; 3]) -> Option<usize> {
    (0..3).find(|&axis| direction[axis].abs() >= ALONG)
}

fn counts(count: impl Fn(usize) -> usize) -> String {
    format!("{:?}", [0, 1, 2].map(count))
}

/// Control points along axes in which faces extend, one along others.
fn spread<'f>(points: impl Iterator<Item = &'f [f64; 3]>) -> impl Fn(usize) -> usize {
    let points: Vec<[f64; 3]> = points.copied().collect();
    let [low, high] = bounding_box(&points);
    let side = move |axis: usize| high[axis] - low[axis];
    move |axis| if side(axis) < THIN * (0..3).map(&side).fold(0.0, f64::max) { 1 } else { COUNT }
}

fn one(face: &Face<'_>) -> String {
    let name = quoted(face.name);
    match (&face.form, face.direction().and_then(axis_of)) {
        (Form::Plane, Some(axis)) => format!(
            "# Control points that move the plane face along x{0}.\nregion = [{name}]\ncontrol_points = {1}\n\
             directions = [{0}]\n",
            axis + 1,
            counts(|k| if k == axis { 1 } else { COUNT })
        ),
        (Form::Round(Primitive::Cylinder { point, axis, .. } | Primitive::Cone { point, axis, .. }, _), _) => {
            tube(face, *point, upwards(*axis))
        }
        _ => format!(
            "# Control points that move the nodes of the face along its normals.\nnormal = {name}\n\
             control_points = {}\n",
            counts(spread(face.points.iter()))
        ),
    }
}

/// A lattice over angle and height of a cylinder or cone; over the height alone where the face goes around.
fn tube(face: &Face<'_>, point: [f64; 3], axis: [f64; 3]) -> String {
    let across = |x: [f64; 3]| -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|k| x[k] - point[k]);
        let along = dot(from, axis);
        std::array::from_fn(|k| from[k] - along * axis[k])
    };
    let range = |values: &mut dyn Iterator<Item = f64>, margin: f64| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let wider = MARGIN * (high - low).max(margin);
        [low - wider, high + wider]
    };
    let radii = range(&mut face.points.iter().map(|&x| length(across(x))), length(across(face.points[0])));
    let heights = range(&mut face.points.iter().map(|&x| dot(x, axis) - dot(point, axis)), 0.0);
    let is_closed = face.direction().is_none();
    let sum = face.points.iter().fold([0.0; 3], |sum, &x| {
        let own = across(x);
        std::array::from_fn(|k| sum[k] + own[k])
    });
    let zero = if is_closed { across(face.points[0]) } else { sum };
    let zero = zero.map(|part| part / length(zero));
    let second: [f64; 3] =
        std::array::from_fn(|i| axis[(i + 1) % 3] * zero[(i + 2) % 3] - axis[(i + 2) % 3] * zero[(i + 1) % 3]);
    let angle = |x: [f64; 3]| dot(across(x), second).atan2(dot(across(x), zero)).to_degrees();
    let angles = if is_closed { [-180.0, 180.0] } else { range(&mut face.points.iter().map(|&x| angle(x)), 0.0) };
    let pair = |[low, high]: [f64; 2]| format!("[{}, {}]", plain(low), plain(high));
    let (words, around) = match is_closed {
        true => ("along its height; the face stays round", 1),
        false => ("along its normals, over angle and height", COUNT),
    };
    format!(
        "# Control points that move the face {words}.\nnormal = {}\ncontrol_points = [1, {around}, {COUNT}]\n\
         cylinder = {{ point = {}, axis = {}, zero = {}, radius = {}, angle = {}, height = {} }}\n",
        quoted(face.name),
        vector(point),
        unit_vector(axis),
        unit_vector(zero),
        pair(radii),
        pair(angles),
        pair(heights)
    )
}

/// A lattice around all faces that touch.
fn several(roles: &Roles<'_>) -> String {
    let names: Vec<String> = roles.contacts.iter().map(|face| quoted(face.name)).collect();
    let axis = roles.axis();
    let spread = spread(roles.contacts.iter().flat_map(|face| &face.points));
    let points = counts(|k| if axis == Some(k) { 1 } else { spread(k) });
    let directions = axis.map_or_else(String::new, |axis| format!("directions = [{}]\n", axis + 1));
    format!(
        "# Control points that move all faces that touch.\nregion = [{}]\ncontrol_points = {points}\n{directions}",
        names.join(", ")
    )
}
