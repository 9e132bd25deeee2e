//! Stresses and displacements of blocks in a lattice, whose inner nodes move too, along true normals: contact rows
//! turn, and middle nodes of contact faces are tied to their ends.

use crate::cases::{obstacles, pressed, shape_and_direction};
use crate::field_check::{check, conclude};
use crate::grid::KINDS;
use crate::setting::PATHS;
use contact::body::mesh::CellKind;
use contact::cost::{PressureMeasure, Quantity, Region, WantedPressure};

/// How far shapes change, mm.
const LENGTH: f64 = 10.0;

fn measures() -> Vec<Quantity> {
    let face = |name: &str| Region { face: Some(name.into()), ..Region::WHOLE };
    let displacement = |region, axis, least| Quantity::Displacement { region, relative_to: None, axis, least };
    let far = Region { lower: [4.0, 0.0, 0.0], ..Region::WHOLE };
    vec![
        Quantity::Stress { region: Region::WHOLE, without_held: false },
        Quantity::Stress { region: Region::WHOLE, without_held: true },
        displacement(face("top"), Some(2), false),
        displacement(face("top"), Some(2), true),
        displacement(far.clone(), Some(0), true),
        displacement(far, None, false),
        Quantity::StressNorm { region: Region::WHOLE, exponent: 8.0 },
        Quantity::Compliance,
        Quantity::Displacement { region: face("top"), relative_to: Some(face("bottom")), axis: Some(0), least: true },
        Quantity::ContactForce { contact: None, axis: Some(1) },
        Quantity::ContactForce { contact: None, axis: None },
        Quantity::ContactMoment { contact: None, axis: None, about: [1.0, -2.0, 3.0] },
        Quantity::Reaction { region: face("x1-min"), axis: None },
        Quantity::MeanPressure { contact: Some(0) },
        Quantity::FrictionWork { contact: None },
        Quantity::Slip { contact: None },
        Quantity::Pressure(PressureMeasure::Deviation { wanted: WantedPressure::formula("", "3 + x1").unwrap() }),
    ]
}

fn check_cells(kind: CellKind) {
    let (name, obstacle) = obstacles().swap_remove(1);
    let scene = pressed(kind, obstacle, 0.3);
    let (measures, count) = (measures(), scene.control_count());
    for path in PATHS {
        let found = check(&scene, path, &measures, LENGTH, |seed| shape_and_direction(count, 2 * seed + 1));
        conclude(&format!("{kind:?}, {name}, {path:?}"), &measures, &found);
    }
}

#[test]
fn quantities_on_hexahedra() {
    check_cells(KINDS[0]);
}

#[test]
fn quantities_on_tetrahedra() {
    check_cells(KINDS[1]);
}
