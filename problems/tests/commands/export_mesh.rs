//! `export` of the shape of a mesh.

use serde_json::json;
use testset::kit::{self, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

#[test]
fn the_change_of_a_mesh_is_what_lies_between_the_shapes() {
    raised("false");
}

/// Supports do not hold the nodes in the middles of the edges of the nose, which contact ties to their ends.
#[test]
fn nodes_of_the_contact_face_move_where_supports_hold_others() {
    raised("true");
}

/// The lug moved up by 0.1 mm as a whole: its files agree with each other, with the nose, a cylinder, and with the top.
/// `hold`: whether supports, which hold the wall along x1 and x2, hold nodes in the shape too.
fn raised(hold: &str) {
    let hold = format!("lattice.hold_supports={hold}");
    let scene = format!("{}/scenes/lug_tet10.toml", env!("CARGO_MANIFEST_DIR"));
    let folder = kit::scratch();
    let count =
        kit::json(CONTACT, &[&scene, "evaluate", "--no-checks", "--json"])["subgradient"].as_array().unwrap().len();
    // Displacements of control points are their three components in turn; all of them go up by a tenth.
    let controls: Vec<f64> = (0..count).map(|index| if index % 3 == 2 { 0.1 } else { 0.0 }).collect();
    let file = folder.path().join("controls.json");
    std::fs::write(&file, json!(controls).to_string()).unwrap();
    let out = folder.path().join("shape");
    let options = ["export", "--controls", text(&file), "--set", &hold, "--out", text(&out), "--json"];
    let printed = kit::json(CONTACT, &[&[scene.as_str()], &options[..]].concat());
    let names: Vec<&str> =
        printed["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    let expected = ["controls.json", "surface.stl", "lower_body.stl", "change.csv", "lower_body.msh", "lower_body.vtu"];
    assert_eq!(names, expected);
    let table = std::fs::read_to_string(out.join("change.csv")).unwrap();
    let rows = |face: &str| -> Vec<Vec<f64>> {
        let own = table.lines().filter_map(|line| line.strip_prefix(face));
        own.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect()
    };
    let (nose, top) = (rows("nose,"), rows("top,"));
    assert!(nose.len() > 100 && top.len() > 50, "{}", &table[..400]);
    for row in top {
        assert!(row[6] > 1.0 - 1e-12 && (row[7] + 0.1).abs() < 1e-12, "{row:?}");
    }
    let mut largest = 0.0_f64;
    for row in &nose {
        let (from, normal, amount, to) = (&row[1..4], &row[4..7], row[7], &row[8..11]);
        let moved: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        assert!(moved[0] == 0.0 && moved[1] == 0.0 && (moved[2] - 0.1).abs() < 1e-12, "{row:?}");
        // The nose is a cylinder of radius 60 mm about (0, 0, 60): its normal points away from its axis.
        let radius = [from[0], from[2] - 60.0].map(|part| part / 60.0);
        assert!((normal[0] - radius[0]).abs() < 0.08 && (normal[2] - radius[1]).abs() < 0.08, "{row:?}");
        // Upwards is into the body. The displacement along the normal is the amount, up to the curvature and to what
        // slides along the nose.
        let along: f64 = normal.iter().zip(from.iter().zip(to)).map(|(n, (from, to))| n * (from - to)).sum();
        assert!(amount > -1e-3 && (amount - along).abs() < 5e-3, "{amount} {along}");
        largest = largest.max(amount);
    }
    assert!(largest > 0.09 && largest < 0.101, "{largest}");
    let grid = std::fs::read_to_string(out.join("lower_body.vtu")).unwrap();
    let nodes = std::fs::read(out.join("lower_body.msh")).unwrap();
    let mesh = exchange::gmsh::read(&nodes).unwrap();
    assert!(grid.contains(&format!("NumberOfPoints=\"{}\"", mesh.nodes.len())) && grid.contains("Name=\"change\""));
}
