//! The text of a draft.

use crate::UnitName;
use crate::draft::face::{Face, Form};
use crate::draft::lattice::lattice;
use crate::draft::obstacle::{Proposal, obstacle};
use crate::draft::roles::Roles;
use crate::draft::text::{commented, quoted, rounded, vector};
use std::fmt::Write;

/// Young's modulus (MPa) and Poisson's ratio of steel.
const STEEL: [f64; 2] = [2.1e5, 0.3];
/// Mean pressure of the load over Young's modulus.
const PRESSURE: f64 = 1e-4;

/// A part with its mesh.
pub(super) struct Part<'a> {
    /// Name of the file without its ending, and with it.
    pub stem: &'a str,
    pub file: &'a str,
    pub unit: UnitName,
    pub volumes: &'a [String],
    pub smallest_side: f64,
    pub faces: &'a [Face<'a>],
}

/// The scene of a part.
pub(super) fn scene(part: &Part<'_>, roles: &Roles<'_>) -> String {
    let mut text = head(part);
    text += &body(part, roles);
    text += &contacts(roles);
    text += "# What is minimised; peak-pressure, stress-norm and others are in docs/scenes.md.\n[objective]\n\
             quantity = \"pressure-norm\"\n\n# No more volume than at the start.\n[[limit]]\n\
             quantity = \"relative-volume\"\nat_most = 1.0\n";
    if let (Some(face), Some(force)) = (roles.pressed(), force(roles)) {
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "\n# A second load case:\n# [[case]]\n# name = \"first\"\n#\n# [[case]]\n# name = \"second\"\n\
             # body = [{{ loads = [{{ face = {}, force = {} }}] }}]\n",
            quoted(face.name),
            vector(force.map(|part| 2.0 * part))
        );
    }
    text
}

fn head(part: &Part<'_>) -> String {
    let [stem, file] = [part.stem, part.file].map(commented);
    let faces: Vec<String> = part.faces.iter().map(|face| format!("{} ({})", face.name, face.words())).collect();
    let faces = commented(&faces.join(", "));
    format!(
        "# A first scene for {file}, from the names and the form of its faces. Change what does not fit, then\n\
         #   contact3d {stem}.toml look --out results/{stem}_look   shows it before any solve,\n\
         #   contact3d {stem}.toml evaluate --out results/{stem}    solves it,\n\
         #   contact3d {stem}.toml --out results/{stem}_optimum     optimizes the shape.\n\
         # Lines such as \"# load: …\" ask what only you can know: look lists them until you delete them.\n\
         # Units: N, mm, MPa. docs/scenes.md explains scenes, docs/fields.md lists the fields.\n\
         # Faces: {faces}.\n\
         name = {}\n\
         # Coulomb friction coefficient: dry steel on steel has about 0.15 to 0.3.\n\
         friction = 0.15\n\n",
        quoted(part.stem)
    )
}

fn body(part: &Part<'_>, roles: &Roles<'_>) -> String {
    let unit = match part.unit {
        UnitName::Mm => "# Lengths in the file are mm; unit = \"m\" and others are allowed.",
        _ => "# The part would be shorter than 1 mm if its lengths were mm.\nunit = \"m\"",
    };
    let mut text = format!(
        "[[body]]\nmesh = {}\n{unit}\n# Steel.\nmaterial = {{ young_modulus = {:e}, poisson_ratio = {} }}\n",
        quoted(part.file),
        STEEL[0],
        STEEL[1]
    );
    if let [first, _, ..] = part.volumes {
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "# Volumes: {}. One of other material:\n\
             # materials = [{{ volume = {}, young_modulus = 7e4, poisson_ratio = 0.33 }}]\n",
            commented(&part.volumes.join(", ")),
            quoted(first)
        );
    }
    text += &supports(roles);
    text += &loads(roles);
    text += "\n";
    if roles.contacts.is_empty() {
        text += "# shape: the face that touches is not known; its lattice, for a plane face across x3\n\
                 # [body.lattice]\n# region = [\"the face\"]\n# control_points = [4, 4, 1]\n# directions = [3]\n\
                 # displacement = [-0.1, 0.1]\n\n";
    } else {
        text += &lattice(roles, part.smallest_side);
        text += "\n";
    }
    text
}

/// Planes of symmetry along their normals, other held faces across the direction of contact.
fn supports(roles: &Roles<'_>) -> String {
    let axes = (0..3).filter(|axis| roles.axis() != Some(*axis)).map(|axis| ["\"u1\"", "\"u2\"", "\"u3\""][axis]);
    let across = axes.collect::<Vec<_>>().join(", ");
    let line = |face: &&Face<'_>, held: &str, why: &str| {
        format!("    {{ face = {}, held = [{held}] }}, # {why}", quoted(face.name))
    };
    let why = if roles.axis().is_some() { "by its name, across the direction of contact" } else { "by its name" };
    let symmetric = roles.symmetric.iter().map(|face| line(face, "\"normal\"", "by its name"));
    let lines: Vec<String> = symmetric.chain(roles.held.iter().map(|face| line(face, &across, why))).collect();
    let mut text =
        "# Held displacements: u1, u2, u3 along the axes, or \"normal\". They and contact must carry the loads.\n"
            .to_owned();
    if !lines.is_empty() {
        text += &format!("supports = [\n{}\n]\n", lines.join("\n"));
    }
    if roles.held.is_empty() && !roles.symmetry_holds() {
        text += "# support: no name says what holds the body across the direction of contact, where only friction does now\n";
        if let Some(face) = roles.pressed().or_else(|| roles.opposite()) {
            let rest = "a face that is guided";
            text += &format!("#   {{ face = {}, held = [{across}] }} in supports: {rest}\n", quoted(face.name));
        }
    }
    text
}

/// The force that gives the contact a mean pressure of E/10⁴, along the direction of contact.
fn force(roles: &Roles<'_>) -> Option<[f64; 3]> {
    Some(roles.direction?.map(|part| rounded(STEEL[0] * PRESSURE * roles.contact_area() * part)))
}

fn loads(roles: &Roles<'_>) -> String {
    let line = |face: &Face<'_>, force: [f64; 3]| {
        format!("loads = [{{ face = {}, force = {} }}]\n", quoted(face.name), vector(force))
    };
    let force = force(roles);
    if let (Some(face), Some(force)) = (roles.pressed(), force) {
        let others = roles.loaded.iter().filter(|other| other.name != face.name).map(|other| other.name);
        let others = commented(&others.collect::<Vec<_>>().join(", "));
        let others = if others.is_empty() { others } else { format!("; so are, by their names, {others}") };
        let within = if roles.symmetric.is_empty() { "" } else { ", within the planes of symmetry" };
        return format!(
            "# What presses the body on: a face that is loaded by its name{others}.\n\
             # Total force, N, in the direction of contact{within}, for a mean pressure of E/10⁴.\n{}",
            line(face, force)
        );
    }
    let named = roles.loaded.first().map(|face| format!("\"{}\" is loaded by its name", commented(face.name)));
    let why = match (&named, force) {
        (Some(named), Some(_)) => format!("{named}, but a force in the direction of contact would pull at it"),
        (Some(named), None) => format!("{named}; in which direction, and with how many newtons"),
        (None, _) => "no name says which face is loaded".to_owned(),
    };
    let proposal = match (roles.opposite(), force, roles.loaded.first()) {
        (Some(face), Some(force), _) => {
            format!(
                "# Opposite to the contact lies \"{}\" ({}):\n# {}",
                commented(face.name),
                face.words(),
                line(face, force)
            )
        }
        (_, None, Some(face)) if matches!(face.form, Form::Plane) => {
            let inward = face.normal.map(|part| rounded(-STEEL[0] * PRESSURE * part));
            format!("# {}", line(face, inward))
        }
        _ => "# loads = [{ face = \"…\", force = [0.0, 0.0, -1000.0] }]\n".to_owned(),
    };
    format!("# load: {why}\n{proposal}")
}

fn contacts(roles: &Roles<'_>) -> String {
    if roles.contacts.is_empty() {
        let faces: Vec<String> =
            roles.others.iter().map(|face| format!("\"{}\" ({})", face.name, face.words())).collect();
        let faces = if faces.is_empty() { "none".to_owned() } else { faces.join(", ") };
        return format!(
            "# contact: no name says which face touches; without another purpose are {}\n\
             # [[contact]]\n# slave = {{ face = \"…\" }}\n# obstacle = {{ form = \"tilted-plane\", point = [0.0, 0.0, 0.0], \
             normal = [0.0, 0.0, -1.0] }}\n\n",
            commented(&faces)
        );
    }
    roles.contacts.iter().map(|face| contact(face, &roles.symmetric)).collect()
}

fn contact(face: &Face<'_>, symmetric: &[&Face<'_>]) -> String {
    let head = format!("[[contact]]\nslave = {{ face = {} }}\n", quoted(face.name));
    match obstacle(face, symmetric) {
        Proposal::Lines(lines) => {
            format!("# It touches by its name: {}.\n{head}\n[contact.obstacle]\n{lines}\n", commented(face.name))
        }
        Proposal::Question(words) => {
            let head: String = head.lines().map(|line| format!("# {line}\n")).collect();
            format!("# obstacle: {}\n{head}# obstacle = {{ form = \"…\" }}\n\n", commented(&words))
        }
    }
}
