//! Poisson's ratio towards ½ and below zero; bodies of very different stiffness; friction from nothing to far beyond
//! one, where contraction, and with it the proof of uniqueness, is lost.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{block, footed, pair, with_materials};
use contact::body::elasticity::Formulation;
use contact::body::mesh::BlockFace;
use contact::scene::Load;

const LOCKED: &str = "λ ≫ μ in locked bricks: nearly every motion of a subdomain's boundary is stiff by λ/μ";
const ROUNDED: &str =
    "condensation rounds the rigid motion of the upper body at its own stiffness; TFETI keeps it apart";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let (standard, mean) = ((Formulation::Standard, "standard"), (Formulation::MeanDilatation, "mean dilatation"));
    let all = [-0.99, -0.5, 0.0, 0.499, 0.4999, 0.499_999];
    let ratios = all.map(|ratio| (standard, ratio)).into_iter().chain(all[3..].iter().map(|&ratio| (mean, ratio)));
    for ((formulation, label), ratio) in ratios {
        for (name, scene, young) in [("block", block(), [1.1e5, 0.0]), ("two bodies", pair(), [7.0e4, 2.1e5])] {
            let scene = with_materials(scene, young.map(|young| (young, ratio)), formulation);
            let mut case = ContactCase::new(scene).wavy();
            if ratio > 0.4985 && formulation == Formulation::Standard {
                // Next to the rounding floor, the last bits decide whether the floor is seen.
                case = case.limit([&["BeyondPrecision", "NotConverged"], &[]], LOCKED);
            }
            cases.push(case.case("Poisson's ratio", format!("ν = {ratio}, {label}, {name}")));
        }
    }
    for exponent in [-8, -6, -4, -2, 2, 4, 6, 8] {
        let materials = [(7.0e4, 0.35), (7.0e4 * 10.0_f64.powi(exponent), 0.29)];
        let mut case = ContactCase::new(with_materials(pair(), materials, Formulation::Standard)).wavy();
        if exponent >= 6 {
            case = case.limit([&[], &["BeyondPrecision"]], ROUNDED);
        }
        cases.push(case.case("stiffness ratio", format!("upper E = 1e{exponent} · lower E")));
    }
    cases
}

pub fn friction() -> Vec<Case> {
    let case = |friction: f64, name: &str, case: ContactCase| {
        case.with_paper().case("friction", format!("𝓕 = {friction:?}, {name}"))
    };
    let mut cases = Vec::new();
    for friction in [0.0, 1e-12, 0.3, 0.9, 1.5, 5.0] {
        for (name, scene) in [("block", block()), ("two bodies", pair())] {
            let scene = scene.map(|scene| scene.with_friction(friction));
            cases.push(case(friction, name, ContactCase::new(scene).wavy()));
        }
    }
    for friction in [0.3, 0.9, 1.5, 2.0, 3.0, 5.0] {
        let scene = footed(0.0).map(|mut scene| {
            let tractions = [(BlockFace::X1Max, [40.0, 7.0, 20.0]), (BlockFace::X1Min, [40.0, 0.0, 20.0])];
            scene.bodies[0].loads = tractions.map(|(face, traction)| Load::traction(face, traction)).into();
            scene.with_friction(friction)
        });
        cases.push(case(friction, "held base, pushed", ContactCase::new(scene)));
    }
    cases
}
