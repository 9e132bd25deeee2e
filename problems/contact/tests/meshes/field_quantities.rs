//! Stresses and displacements of blocks in a lattice, whose inner nodes move too, along true normals: contact rows
//! turn, and middle nodes of contact faces are tied to their ends.

use crate::cases::{obstacles, pressed, shape_and_direction};
use crate::field_check::{check, conclude};
use crate::grid::KINDS;
use crate::setting::PATHS;
use contact::body::mesh::CellKind;
use contact::cost::{FieldMeasure, Region};

/// How far shapes change, mm.
const LENGTH: f64 = 10.0;

fn measures() -> Vec<FieldMeasure> {
    let face = |name: &str| Region { face: Some(name.into()), ..Region::WHOLE };
    let displacement = |region, component, least| FieldMeasure::Displacement { region, component, least };
    let far = Region { lower: [4.0, 0.0, 0.0], ..Region::WHOLE };
    vec![
        FieldMeasure::PeakStress { region: Region::WHOLE, without_held: false },
        FieldMeasure::PeakStress { region: Region::WHOLE, without_held: true },
        displacement(face("top"), Some(2), false),
        displacement(face("top"), Some(2), true),
        displacement(far.clone(), Some(0), true),
        displacement(far, None, false),
        FieldMeasure::StressNorm { region: Region::WHOLE, exponent: 8.0 },
        FieldMeasure::Compliance,
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
