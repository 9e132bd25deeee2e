//! Commands on scenes with lists of bodies and contacts.

use serde_json::Value;
use std::path::Path;
use testset::kit::{self, json, scratch, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

fn scene(name: &str) -> String {
    format!("{}/scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// A plate below a punch that is glued to a cap; the facing surfaces of plate and punch are optimized.
const FACING: &str = r#"
name = "facing"
friction = 0.2

[[body]]
name = "base plate"
material = { young_modulus = 7e4, poisson_ratio = 0.3 }
supports = [{ face = "bottom", held = ["u1", "u2", "u3"] }]
block = { size = [10.0, 10.0], bricks = [4, 4, 2] }
lattice = { heights = "top", control_points = [4, 4], start = { form = "plane", height = 5.0 }, thickness = 2.0, slope = 2.0, volume = [400.0, 600.0] }

[[body]]
name = "punch"
material = { young_modulus = 2.1e5, poisson_ratio = 0.3 }
block = { corner = [1.0, 1.0], size = [8.0, 8.0], bricks = [4, 4, 2], top = { form = "plane", height = 10.0 } }
lattice = { heights = "bottom", control_points = [4, 4], start = { form = "plane", height = 5.01 }, thickness = 2.0, slope = 2.0, volume = [200.0, 400.0] }

[[body]]
name = "cap"
material = { young_modulus = 1e5, poisson_ratio = 0.3 }
supports = [{ face = "x1-min", held = ["u1"] }, { face = "x2-min", held = ["u2"] }]
loads = [{ face = "top", traction = [0.0, 0.0, -100.0] }]

[body.block]
corner = [1.0, 1.0]
size = [8.0, 8.0]
bricks = [2, 2, 2]
bottom = { form = "plane", height = 10.0 }
top = { form = "plane", height = 13.0 }

[[contact]]
faces = [{ body = "base plate", face = "top" }, { body = "punch", face = "bottom" }]

[[contact]]
slave = { body = "cap", face = "bottom" }
master = { body = "punch", face = "top" }
tied = true
"#;

fn written(folder: &Path) -> String {
    let path = folder.join("facing.toml");
    std::fs::write(&path, FACING).unwrap();
    text(&path).to_owned()
}

#[test]
fn the_controls_of_several_bodies_are_one_list() {
    let folder = scratch();
    let (scene, run) = (written(folder.path()), folder.path().join("run"));
    let found = json(CONTACT, &[&scene, "--max-evaluations", "2", "--single", "--json", "--out", text(&run)]);
    let controls: Vec<f64> =
        serde_json::from_str(&std::fs::read_to_string(run.join("controls.json")).unwrap()).unwrap();
    assert_eq!(Value::from(controls.clone()), found["controls"]);
    assert_eq!(controls.len(), 32);
    let again = json(CONTACT, &[&scene, "evaluate", "--controls", text(&run.join("controls.json")), "--json"]);
    // The run has solved the state from that of the shape before.
    let ratio = again["objective"].as_f64().unwrap() / found["objective"].as_f64().unwrap();
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    let (bodies, contacts) = (&found["bodies"], &found["contacts"]);
    assert_eq!(
        (&bodies[1]["name"], &bodies[1]["controls"], &bodies[2]["controls"]),
        (&"punch".into(), &16.into(), &0.into())
    );
    let slave = &contacts[0]["slave"];
    assert!(slave["body"] == "base plate" && slave["face"] == "top" && contacts[1]["tied"] == true, "{contacts}");
    // A picture per contact that may open, and the relief of both faces that are optimized.
    for name in ["pressure_contact_1", "status_contact_1", "surface_map_contact_1", "surface_map_contact_1_master"] {
        assert!(run.join(format!("figures/{name}.svg")).exists(), "{name}");
    }
    let files = ["export", "--run", text(&run), "--out"];
    let out = folder.path().join("files");
    let printed = json(CONTACT, &[&[scene.as_str()], &files[..], &[text(&out), "--json"]].concat());
    let names: Vec<&str> =
        printed["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    let bodies = ["base_plate_body.stl", "punch_body.stl", "cap_body.stl"];
    let surfaces = ["base_plate_faces.step", "punch_faces.step"];
    let meshes = ["base_plate_body.msh", "punch_body.msh", "base_plate_body.vtu", "punch_body.vtu"];
    let expected = [&["controls.json", "surface.stl"], &bodies[..], &surfaces, &["change.csv"], &meshes];
    assert_eq!(names, expected.concat());
    let change = std::fs::read_to_string(out.join("change.csv")).unwrap();
    assert!(change.starts_with("body,face,node,") && change.contains("\nbase_plate,top,"), "{}", &change[..200]);
    let resumed = json(CONTACT, &["--resume", text(&run), "--max-evaluations", "3", "--json"]);
    assert_eq!(resumed["resumed_evaluations"], 2);
    json(CONTACT, &[&scene, "recheck", text(&run), "--json"]);
}

#[test]
fn what_several_bodies_do_not_have_is_refused_with_what_to_set() {
    let folder = scratch();
    let scene = written(folder.path());
    let out = folder.path().join("out");
    for (options, words) in [
        (&["evaluate", "--young-modulus", "1e5"][..], ["--young-modulus", "--set body[0].material.young_modulus"]),
        (&["export", "--friction-problem", "--out", text(&out)], ["contact[1].tied = true", "no glued faces"]),
        (&["evaluate", "--subdomains", "3"], ["--subdomains = 3", "a divisor of the 4 bricks"]),
        (&["evaluate", "--set", "body[2].block.top.height=9"], ["cap.block.top = 9", "above the bottom"]),
        (&["evaluate", "--set", "body[0].block.bricks=1.5"], ["body[0].block.bricks", "integer"]),
    ] {
        kit::refused(CONTACT, &[&[scene.as_str()], options].concat(), &words);
    }
    let listed = json(CONTACT, &[&scene, "evaluate", "--json", "--set", "body[0].material.young_modulus=6e4"]);
    assert_ne!(listed["objective"], json(CONTACT, &[&scene, "evaluate", "--json"])["objective"]);
}

/// Three bodies on each other: the table of contact nodes has the number of the contact, and so has the file of fields.
#[test]
fn results_of_several_contacts_name_the_contact() {
    let folder = scratch();
    let (stack, out) = (scene("stack"), folder.path().join("out"));
    json(CONTACT, &[&stack, "evaluate", "--mesh", "4x4x2", "--json", "--out", text(&out)]);
    let table = std::fs::read_to_string(out.join("pressure_shape.csv")).unwrap();
    let numbers: Vec<&str> = table.lines().map(|line| line.split(',').next().unwrap()).collect();
    assert!(numbers[0] == "contact" && numbers.contains(&"1") && numbers.contains(&"2"), "{table}");
    let fields = testset::kit::vtu_file::read(&std::fs::read_to_string(out.join("vtk/shape_contact.vtu")).unwrap());
    let (components, contacts) = &fields.cell_data["contact"];
    assert!(*components == 1 && contacts.contains(&1.0) && contacts.contains(&2.0), "{contacts:?}");
    let printed = kit::run(CONTACT, &[&stack, "evaluate", "--mesh", "4x4x2"]);
    let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
    assert!(printed.contains("bottom of pad on top of base, friction 0.2"), "{printed}");
}

#[test]
fn a_run_of_another_scene_of_lists_is_told_by_the_entry() {
    let folder = scratch();
    let (stack, run, out) = (scene("stack"), folder.path().join("run"), folder.path().join("out"));
    json(CONTACT, &[&stack, "--mesh", "2", "--single", "--max-evaluations", "1", "--json", "--out", text(&run)]);
    let export = |options: &[&str]| {
        let command = [stack.as_str(), "export", "--mesh", "2", "--run", text(&run), "--out", text(&out)];
        [&command[..], options].concat().into_iter().map(str::to_owned).collect::<Vec<String>>()
    };
    let words = export(&["--control-points", "4x4"]);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    kit::refused(
        CONTACT,
        &words,
        &["another surface: body[1].lattice.control_points is [5,5] in the run and [4,4] here"],
    );
    let words = export(&["--friction-problem", "--set", "body[0].material.young_modulus=1e5", "--json"]);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let told = json(CONTACT, &words)["differences"].to_string();
    assert!(told.contains("body[0].material.young_modulus is 210000.0 in the run and 100000.0 here"), "{told}");
}
