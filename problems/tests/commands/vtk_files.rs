//! Fields of solved shapes as VTU and PVD files, read back number by number.

use contact::contact_objective::ContactObjective;
use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::equilibrium::ContactStatus;
use contact::fields::Fields;
use contact::scene::{Scene, hertz, signorini};
use exchange::vtk::{Note, NoteValue};
use nonsmooth::{Accuracy, StateSolver};
use problems::vtk_files::{FieldState, FieldsError, vtk_files};
use std::collections::HashMap;
use testset::kit::vtu_file::{ReadGrid, read};

/// Fields of the flat start of a small scene, with sensitivities.
fn fields(scene: Scene) -> Fields {
    let shape = ContactShape::new(scene.with_bricks([4, 6, 2], [2, 3, 1]), SolverKind::Newton).unwrap();
    let control = shape.start();
    let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
    let objective = ContactObjective::new(shape, Quantity::Pressure(measure), &[]).unwrap();
    let states = objective.cases().solve(&control, None, Accuracy::TIGHTEST).unwrap();
    let sensitivity = objective.position_sensitivity(&control, &states).unwrap();
    let mut fields = objective.solver().fields(&states[0]).unwrap();
    fields.contact.set_sensitivity(objective.solver().problem(), &sensitivity);
    fields
}

fn files(fields: &Fields) -> HashMap<String, String> {
    vtk_files(&[FieldState { time: 0.0, name: "start", fields, notes: &[] }]).unwrap().into_iter().collect()
}

fn flat<const N: usize>(parts: impl IntoIterator<Item = [f64; N]>) -> Vec<f64> {
    parts.into_iter().flatten().collect()
}

#[test]
fn bodies_are_read_back_bit_by_bit() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let fields = fields(scene);
        let found = read(&files(&fields)["start_bodies.vtu"]);
        let bodies = &fields.bodies;
        let nodes: usize = bodies.iter().map(|body| body.mesh.node_count()).sum();
        let bricks: usize = bodies.iter().map(|body| body.mesh.cell_count()).sum();
        assert_eq!((nodes, bricks), (bodies.len() * 5 * 7 * 3, bodies.len() * 4 * 6 * 2));
        assert_eq!((found.points.len(), found.cells.len()), (nodes, bricks));
        assert!(found.kinds.iter().all(|&kind| kind == 12));
        let expected = [
            ("displacement", 3, flat(bodies.iter().flat_map(|body| body.displacement.clone()))),
            ("von_mises_nodal", 1, bodies.iter().flat_map(|body| body.nodal_von_mises.clone()).collect()),
        ];
        assert_eq!(found.point_data.len(), expected.len());
        for (name, components, values) in expected {
            assert_eq!(found.point_data[name], (components, values), "{name}");
        }
        let number = |body: usize| vec![body as f64 + 1.0; bodies[body].mesh.cell_count()];
        let expected: [(&str, u32, Vec<f64>); 4] = [
            ("body", 1, (0..bodies.len()).flat_map(number).collect()),
            ("subdomain", 1, bodies.iter().flat_map(|body| body.subdomain.iter().map(|&s| s as f64)).collect()),
            ("stress", 6, flat(bodies.iter().flat_map(|body| body.stress.clone()))),
            ("von_mises", 1, bodies.iter().flat_map(|body| body.von_mises.clone()).collect()),
        ];
        assert_eq!(found.cell_data.len(), expected.len());
        for (name, components, values) in expected {
            assert_eq!(found.cell_data[name], (components, values), "{name}");
        }
        check_hexahedra(&found, &fields);
    }
}

/// Every cell has the points and the volume of its brick, positive in VTK's order: face 0 1 2 3, then 4 5 6 7 above it.
fn check_hexahedra(found: &ReadGrid, fields: &Fields) {
    let own = fields.bodies.iter().flat_map(|body| {
        body.mesh.cells().enumerate().map(|(index, cell)| {
            let points: Vec<[f64; 3]> = cell.nodes.iter().map(|&node| body.positions[node as usize]).collect();
            (points, body.mesh.cell_nodes(index, &body.positions).volume())
        })
    });
    for (cell, (own, volume)) in found.cells.iter().zip(own) {
        let points: Vec<[f64; 3]> = cell.iter().map(|&point| found.points[point]).collect();
        assert_eq!(points, own);
        // Vertical columns: base area times mean height.
        let (lower, upper) = points.split_at(4);
        let heights: f64 = lower.iter().zip(upper).map(|(below, above)| (above[2] - below[2]) / 4.0).sum();
        let turn = |i: usize, j: usize| points[i][0] * points[j][1] - points[j][0] * points[i][1];
        let area = 0.5 * (turn(0, 1) + turn(1, 2) + turn(2, 3) + turn(3, 0));
        assert!(area > 0.0 && heights > 0.0);
        assert!((area * heights / volume - 1.0).abs() < 1e-12);
    }
}

#[test]
fn contact_boundary_is_read_back_bit_by_bit() {
    for (friction, scene) in [(0.3, signorini().unwrap()), (0.0, signorini().unwrap()), (0.3, hertz().unwrap())] {
        let fields = fields(scene.with_friction(friction));
        let contact = &fields.contact;
        let found = read(&files(&fields)["start_contact.vtu"]);
        assert_eq!(found.points, contact.position);
        assert_eq!((found.points.len(), found.cells.len()), (5 * 7, 4 * 6));
        assert!(found.kinds.iter().all(|&kind| kind == 9));
        let mut area = 0.0;
        for cell in &found.cells {
            let turn = |i: usize, j: usize| {
                let (first, second) = (found.points[cell[i]], found.points[cell[j]]);
                first[0] * second[1] - second[0] * first[1]
            };
            let part = 0.5 * (turn(0, 1) + turn(1, 2) + turn(2, 3) + turn(3, 0));
            assert!(part > 0.0, "a normal points down");
            area += part;
        }
        assert!((area / contact.area.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let code = |status: &ContactStatus| match status {
            ContactStatus::Open => 0.0,
            ContactStatus::Stick => 1.0,
            ContactStatus::Slip => 2.0,
        };
        let mut expected = vec![
            ("displacement", 3, flat(contact.displacement.clone())),
            ("normal", 3, flat(contact.normal.clone())),
            ("pressure", 1, contact.pressure.clone()),
            ("status", 1, contact.status.iter().map(code).collect()),
            ("area", 1, contact.area.clone()),
            ("gap", 1, contact.gap.clone()),
            ("remaining_gap", 1, contact.remaining_gap.clone()),
            ("sensitivity", 1, contact.sensitivity.clone().unwrap()),
        ];
        if friction > 0.0 {
            expected.push(("traction", 3, flat(contact.traction.clone().unwrap())));
            expected.push(("slip", 3, flat(contact.slip.clone().unwrap())));
        }
        assert_eq!(found.point_data.len(), expected.len());
        for (name, components, values) in expected {
            assert_eq!(found.point_data[name], (components, values), "{name}");
        }
    }
}

#[test]
fn the_list_names_every_file_with_its_time() {
    let fields = fields(hertz().unwrap());
    let states =
        [("start", 0.0), ("optimum", 1.0)].map(|(name, time)| FieldState { time, name, fields: &fields, notes: &[] });
    let files = vtk_files(&states).unwrap();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let grids = ["start_bodies.vtu", "start_contact.vtu", "optimum_bodies.vtu", "optimum_contact.vtu"];
    assert_eq!(names, [&grids[..], &["fields.pvd"]].concat());
    let document = roxmltree::Document::parse(&files[4].1).unwrap();
    let root = document.root_element();
    assert_eq!((root.tag_name().name(), root.attribute("type")), ("VTKFile", Some("Collection")));
    let sets = root.descendants().filter(|node| node.has_tag_name("DataSet"));
    let found: Vec<[&str; 4]> =
        sets.map(|set| ["timestep", "part", "name", "file"].map(|name| set.attribute(name).unwrap())).collect();
    let expected = [
        ["0", "0", "bodies", grids[0]],
        ["0", "1", "contact", grids[1]],
        ["1", "0", "bodies", grids[2]],
        ["1", "1", "contact", grids[3]],
    ];
    assert_eq!(found, expected);
}

#[test]
fn states_need_names_of_files_and_finite_fields() {
    let mut fields = fields(signorini().unwrap());
    let state = |name| FieldState { time: 0.0, name, fields: &fields, notes: &[] };
    for name in ["", "a/b", "..", "ä", "a b"] {
        let refused = vtk_files(&[state(name)]);
        assert!(matches!(refused, Err(FieldsError::Name { index: 0, .. })), "{name}");
    }
    assert!(matches!(vtk_files(&[state("a"), state("a")]), Err(FieldsError::Name { index: 1, .. })));
    fields.bodies[0].stress[5][2] = f64::NAN;
    let error = vtk_files(&[FieldState { time: 0.0, name: "start", fields: &fields, notes: &[] }]).unwrap_err();
    assert_eq!(error.to_string(), "fields of state `start`: array `stress`: value 32 is NaN, allowed: finite numbers");
}

#[test]
fn notes_and_active_arrays_stand_in_every_file() {
    let fields = fields(signorini().unwrap());
    let notes =
        [Note::new("objective", "µm", NoteValue::Number(4.5e17)), Note::new("evaluation", "", NoteValue::Integer(7))];
    let files = vtk_files(&[FieldState { time: 7.0, name: "start", fields: &fields, notes: &notes }]).unwrap();
    let active = [
        [(Some("von_mises_nodal"), Some("displacement")), (Some("von_mises"), None)],
        [(Some("pressure"), Some("displacement")), (None, None)],
    ];
    for ((_, text), expected) in files.iter().zip(active) {
        let document = roxmltree::Document::parse(text).unwrap();
        let field = document.descendants().find(|node| node.has_tag_name("FieldData")).unwrap();
        let arrays = field.children().filter(|node| node.has_tag_name("DataArray"));
        let found: Vec<[&str; 4]> = arrays
            .map(|array| {
                let attribute = |name| array.attribute(name).unwrap();
                assert_eq!(attribute("NumberOfTuples"), "1");
                [attribute("type"), attribute("Name"), attribute("format"), array.text().unwrap()]
            })
            .collect();
        let expected_notes = [["Float64", "objective", "ascii", "4.5e17"], ["Int32", "evaluation", "ascii", "7"]];
        assert_eq!(found, expected_notes);
        let types =
            document.descendants().filter(|node| node.has_tag_name("DataArray")).map(|node| node.attribute("type"));
        assert!(types.into_iter().all(|kind| kind != Some("String")), "meshio reads no text");
        for (section, expected) in ["PointData", "CellData"].into_iter().zip(expected) {
            let node = document.descendants().find(|node| node.has_tag_name(section)).unwrap();
            assert_eq!((node.attribute("Scalars"), node.attribute("Vectors")), expected, "{section}");
        }
    }
}
