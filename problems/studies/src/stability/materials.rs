//! Poisson's ratio towards ½ and below zero; bodies of very different stiffness.

use crate::stability::case::Case;
use crate::stability::contact::ContactCase;
use crate::stability::scenes::{block, pair, with_materials};
use contact::body::elasticity::Formulation;

const POISSON: &str = "Poisson's ratio";
const STIFFNESS: &str = "stiffness ratio";
const LOCKED: &str = "λ ≫ μ in locked bricks: nearly every motion of a subdomain's boundary is stiff by λ/μ";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (formulation, label) in [(Formulation::Standard, "standard"), (Formulation::MeanDilatation, "mean dilatation")]
    {
        for ratio in [-0.99, -0.5, 0.0, 0.499, 0.4999, 0.499_999] {
            if ratio <= 0.0 && formulation == Formulation::MeanDilatation {
                continue;
            }
            for (name, scene, materials) in
                [("block", block(), vec![(1.1e5, ratio)]), ("two bodies", pair(), vec![(7.0e4, ratio), (2.1e5, ratio)])]
            {
                let scene = with_materials(scene, &materials).map(|mut scene| {
                    for body in &mut scene.bodies {
                        body.material = body.material.with_formulation(formulation);
                    }
                    scene
                });
                let mut case = ContactCase::new(scene).wavy();
                if ratio > 0.4985 && formulation == Formulation::Standard {
                    // Next to the rounding floor, the last bits decide whether the floor is seen.
                    case = case.limit([&["BeyondPrecision", "NotConverged"], &[]], LOCKED);
                }
                let case = case.case(POISSON, format!("ν = {ratio}, {label}, {name}"));
                cases.push(if ratio > 0.4995 { case.slow() } else { case });
            }
        }
    }
    for exponent in [-8, -6, -4, -2, 2, 4, 6, 8] {
        let ratio = 10.0_f64.powi(exponent);
        let scene = with_materials(pair(), &[(7.0e4, 0.35), (7.0e4 * ratio, 0.29)]);
        let mut case = ContactCase::new(scene).wavy();
        if exponent >= 6 {
            let cause =
                "condensation rounds the rigid motion of the upper body at its own stiffness; TFETI keeps it apart";
            case = case.limit([&[], &["BeyondPrecision"]], cause);
        }
        cases.push(case.case(STIFFNESS, format!("upper E = 1e{exponent} · lower E")));
    }
    cases
}
