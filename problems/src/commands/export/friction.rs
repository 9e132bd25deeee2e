//! The friction problem of a shape as matrices (Matrix Market) and lists (JSON).

use crate::commands::export::files::OutputFile;
use crate::commands::export::shape::failure;
use crate::commands::failure::Failure;
use crate::commands::scene_words;
use contact::equilibrium::ContactProblem;
use contact::error::SceneError;
use contact::friction_problem::{FrictionProblem, ROWS};
use contact::scene::Scene;
use exchange::matrix_market::{general, symmetric};
use serde::Serialize;

/// Most displacements: matrices of a gigabyte.
const MOST_UNKNOWNS: usize = 300_000;

/// The lists beside the matrices.
#[derive(Debug, Serialize)]
struct FrictionJson<'a> {
    /// What the numbers mean.
    equations: &'static str,
    units: String,
    stiffness: &'static str,
    contact: &'static str,
    load: &'a [f64],
    gaps: &'a [f64],
    slips: &'a [[f64; 2]],
    friction: &'a [f64],
    places: &'a [[f64; 3]],
    areas: &'a [f64],
    normals: &'a [[f64; 3]],
    tangents: &'a [[[f64; 3]; 2]],
    unknowns: &'a [[usize; 3]],
}

const EQUATIONS: &str = "K u = f + H^T r; w = H u + (g, s1, s2) per contact node; 0 <= r_N, w_N; r_N w_N = 0; |r_T| <= mu r_N; \
                         w_T = -k r_T with k >= 0, k = 0 where |r_T| < mu r_N";
const UNITS: [&str; 2] = [
    "K in N/mm; load f in N; gaps g, slips s of prescribed displacements and places in mm; areas in mm^2; unknowns: body (",
    "), node, component (0 to 2: along x1, x2, x3; at nodes held along other directions, along the free ones)",
];

/// What the numbers of the lists are, with the names of the bodies.
fn units(scene: &Scene) -> String {
    let names = scene.bodies.iter().enumerate().map(|(number, body)| format!("{number} {}", body.name));
    let [before, after] = UNITS;
    format!("{before}{}{after}", names.collect::<Vec<_>>().join(", "))
}

/// Refuses a mesh whose matrices would be too large, and faces that are glued.
///
/// # Errors
/// [`SceneError::OutOfRange`] naming the mesh.
pub fn check(problem: &ContactProblem) -> Result<(), SceneError> {
    let (most, scene) = (FrictionProblem::most_unknowns(problem), &problem.scene);
    let tied = (0..scene.contacts.len()).find(|contact| scene.contacts[*contact].is_tied());
    if let Some(contact) = tied {
        let allowed = "no glued faces with --friction-problem: its equations are those of contact that may open";
        return Err(SceneError::out_of_range(format!("contact[{contact}].tied"), true, allowed));
    }
    let allowed =
        format!("with --friction-problem at most {MOST_UNKNOWNS} displacements, of which this mesh has {most}");
    match scene.bodies[0].block() {
        _ if most <= MOST_UNKNOWNS => Ok(()),
        Some(block) => Err(SceneError::out_of_range("body[0].block.bricks", format!("{:?}", block.bricks), allowed)),
        None => Err(SceneError::out_of_range("body[0].mesh", scene_words::mesh(scene), allowed)),
    }
}

/// The matrices of a shape.
///
/// # Errors
/// [`Failure::Input`] for an inverted cell.
pub fn matrices(problem: &ContactProblem, controls: &[f64]) -> Result<Vec<OutputFile>, Failure> {
    let matrices = FrictionProblem::new(problem, controls).map_err(|error| Failure::Input(error.to_string()))?;
    let (unknowns, nodes) = (matrices.unknowns.len(), matrices.gaps.len());
    let words = format!("{}: stiffness K, N/mm; lower triangle", problem.scene.name);
    let stiffness = symmetric(unknowns, &matrices.stiffness, &words).map_err(failure)?;
    let words = format!("{}: contact matrix H; rows per contact node: normal, two tangents", problem.scene.name);
    let contact = general([ROWS * nodes, unknowns], &matrices.contact, &words).map_err(failure)?;
    let lists = FrictionJson {
        equations: EQUATIONS,
        units: units(&problem.scene),
        stiffness: "stiffness.mtx",
        contact: "contact.mtx",
        load: &matrices.load,
        gaps: &matrices.gaps,
        slips: &matrices.slips,
        friction: &matrices.friction,
        places: &matrices.places,
        areas: &matrices.areas,
        normals: &matrices.normals,
        tangents: &matrices.tangents,
        unknowns: &matrices.unknowns,
    };
    let lists = serde_json::to_string(&lists).map_err(Failure::computation)? + "\n";
    Ok(vec![
        OutputFile::text(
            "friction/stiffness.mtx",
            stiffness,
            format!("stiffness matrix K of {unknowns} displacements"),
        ),
        OutputFile::text("friction/contact.mtx", contact, format!("contact matrix H of {nodes} contact nodes")),
        OutputFile::text("friction/problem.json", lists, "loads, gaps, friction coefficients, and what they mean"),
    ])
}
