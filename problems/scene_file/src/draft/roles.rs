//! What faces are for, by their names, and the direction in which contact acts.

use crate::draft::face::{Face, Form, dot, length};
use crate::draft::text::{straight, tidy};

/// Parts of names that tell what a face is for; the first list that has one decides, and of several faces the order of
/// the words.
const TOUCHES: &[&str] = &[
    "contact",
    "touch",
    "seat",
    "nose",
    "foot",
    "sole",
    "bearing",
    "sealing",
    "interface",
    "slave",
    "raceway",
    "flank",
    "socket",
    "tread",
];
const SYMMETRIC: &[&str] = &["symm"];
const HELD: &[&str] = &["support", "wall", "fix", "clamp", "held", "hold", "bolt", "guide", "mount"];
const LOADED: &[&str] = &["load", "force", "press", "top", "head", "eye", "pin", "pull", "push", "hole"];

/// What says that a force may pull at a face.
const PULL: &str = "pull";
/// Part of the unit direction that a sum of normals must keep to say anything.
const CLEAR: f64 = 0.2;

/// What the names say.
pub(super) struct Roles<'a> {
    /// Faces that touch.
    pub contacts: Vec<&'a Face<'a>>,
    pub held: Vec<&'a Face<'a>>,
    pub symmetric: Vec<&'a Face<'a>>,
    /// Faces that may be loaded, the likeliest first.
    pub loaded: Vec<&'a Face<'a>>,
    /// Faces whose names say nothing.
    pub others: Vec<&'a Face<'a>>,
    /// The unit direction into what the body touches, within the planes of symmetry; none where contact goes around.
    pub direction: Option<[f64; 3]>,
}

impl<'a> Roles<'a> {
    pub fn new(faces: &'a [Face<'a>]) -> Self {
        let lists = [TOUCHES, SYMMETRIC, HELD, LOADED];
        let rank = |face: &Face<'_>, list: &[&str]| {
            let name = face.name.to_lowercase();
            list.iter().position(|part| name.contains(part))
        };
        let role = |face: &Face<'_>| lists.iter().position(|list| rank(face, list).is_some());
        let of_role = |number: Option<usize>| faces.iter().filter(|face| role(face) == number).collect::<Vec<_>>();
        let [contacts, symmetric, held, mut loaded] = [0, 1, 2, 3].map(|number| of_role(Some(number)));
        loaded.sort_by_key(|face| rank(face, LOADED));
        let direction = direction(&contacts, &symmetric);
        Self { contacts, held, symmetric, loaded, others: of_role(None), direction }
    }

    /// The area of the faces that touch.
    pub fn contact_area(&self) -> f64 {
        self.contacts.iter().map(|face| face.area).sum()
    }

    /// The axis along which contact acts.
    pub fn axis(&self) -> Option<usize> {
        let sizes = self.direction?.map(f64::abs);
        Some((1..3).fold(0, |best, axis| if sizes[axis] > sizes[best] { axis } else { best }))
    }

    /// The likeliest face that is loaded by its name, if a force in the direction of contact does not pull at it.
    pub fn pressed(&self) -> Option<&'a Face<'a>> {
        let direction = self.direction?;
        let pulls =
            |face: &Face<'_>| matches!(face.form, Form::Plane) && dot(face.normal, direction) > CLEAR * face.area;
        self.loaded.iter().find(|face| !pulls(face) || face.name.to_lowercase().contains(PULL)).copied()
    }

    /// The face without another purpose that looks most against the direction of contact.
    pub fn opposite(&self) -> Option<&'a Face<'a>> {
        let direction = self.direction?;
        let against = |face: &Face<'_>| -dot(face.normal, direction);
        let found = self.others.iter().filter(|face| against(face) > 0.0);
        found.max_by(|a, b| against(a).total_cmp(&against(b))).copied()
    }

    /// Whether planes of symmetry alone hold the body across the direction of contact.
    pub fn symmetry_holds(&self) -> bool {
        let across = |axis: usize| self.axis() != Some(axis);
        let holds = |axis: usize| self.symmetric.iter().any(|face| face.normal[axis].abs() > 0.9 * face.area);
        self.direction.is_some() && (0..3).filter(|&axis| across(axis)).all(holds)
    }
}

/// The direction of the sum of the outward normals, less what goes across planes of symmetry.
fn direction(contacts: &[&Face<'_>], symmetric: &[&Face<'_>]) -> Option<[f64; 3]> {
    let mut sum = [0.0; 3];
    for face in contacts {
        (0..3).for_each(|axis| sum[axis] += face.normal[axis]);
    }
    let sum = within(sum, symmetric);
    let (size, area) = (length(sum), contacts.iter().map(|face| face.area).sum::<f64>());
    (size > CLEAR * area).then(|| straight(sum).map(tidy))
}

/// The part of a vector along all planes of symmetry.
pub(super) fn within(mut vector: [f64; 3], symmetric: &[&Face<'_>]) -> [f64; 3] {
    for face in symmetric.iter().filter(|face| matches!(face.form, Form::Plane)) {
        let normal = face.normal.map(|part| part / length(face.normal));
        let across = dot(vector, normal);
        (0..3).for_each(|axis| vector[axis] -= across * normal[axis]);
    }
    vector
}
