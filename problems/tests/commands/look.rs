//! `new` and `look`: from the names in a mesh to a scene that can be seen before any solve.

use std::path::{Path, PathBuf};
use testset::kit::{self, json, refused, scratch, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// A mesh alone in a folder, and the scene that is made for it.
#[test]
fn a_mesh_becomes_a_scene_that_is_solved_and_optimized() {
    let folder = scratch();
    for mesh in ["lug_hex8", "lug_tet10"] {
        let (file, scene) = (folder.path().join(format!("{mesh}.msh")), folder.path().join(format!("{mesh}.toml")));
        std::fs::copy(scenes().join(format!("{mesh}.msh")), &file).unwrap();
        let output = kit::run(CONTACT, &["new", text(&file)]);
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && printed.contains("next: contact3d") && printed.contains("look --out"));
        let seen = json(CONTACT, &[text(&scene), "look", "--json"]);
        let roles = |name: &str| {
            let faces = seen["bodies"][0]["faces"].as_array().unwrap();
            faces.iter().find(|face| face["name"] == name).unwrap()["roles"].to_string()
        };
        assert!(
            roles("nose").contains("on the obstacle, friction 0.15") && roles("wall").contains("held: u₁ = u₂ = 0")
        );
        assert!(roles("top").contains("load (0, 0, −26000) N\"") && roles("side") == "[]", "{}", seen["bodies"]);
        assert_eq!(seen["hints"].as_array().unwrap().len(), 0, "{}", seen["hints"]);
        assert_eq!(seen["open"], serde_json::json!([]));
        // The load of the draft, and nothing else, is carried by the obstacle.
        let state = json(CONTACT, &[text(&scene), "evaluate", "--no-checks", "--json"]);
        assert!((state["total_normal_force"].as_f64().unwrap() / 26_000.0 - 1.0).abs() < 1e-3, "{state}");
        if mesh == "lug_tet10" {
            let found = json(CONTACT, &[text(&scene), "--max-evaluations", "4", "--json"]);
            assert!(found["objective"].as_f64() < found["objective_start"].as_f64(), "{}", found["objective"]);
        }
        let again = kit::run(CONTACT, &["new", text(&file)]);
        assert_eq!(again.status.code(), Some(2));
        assert!(kit::errors(&again).contains("exists, and is not overwritten"), "{}", kit::errors(&again));
    }
    refused(CONTACT, &["new"], &["new MESH.msh", "MESH.toml"]);
    refused(CONTACT, &["new", "none.msh"], &["none.msh"]);
}

#[test]
fn a_scene_is_seen_before_any_solve() {
    let folder = scratch();
    for (scene, cases) in [("lug_cases", 3), ("stack", 1), ("tangential", 1)] {
        let (file, out) = (scenes().join(format!("{scene}.toml")), folder.path().join(scene));
        let seen = json(CONTACT, &[text(&file), "look", "--out", text(&out), "--json"]);
        assert_eq!(seen["cases"].as_array().unwrap().len(), cases);
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        assert!(
            page.contains("class=\"space\"")
                && page.contains("The scene, complete")
                && page.contains("nothing is solved")
        );
        assert!(out.join("look.json").exists());
        // What evaluate says of the cases before its solves is the same.
        let state = json(CONTACT, &[text(&file), "evaluate", "--no-checks", "--json"]);
        for case in 0..cases {
            assert_eq!(state["cases"][case]["before"], seen["cases"][case]["before"], "{scene}");
        }
    }
    let text = kit::run(CONTACT, &[text(&scenes().join("stack.toml")), "look"]);
    let printed = String::from_utf8_lossy(&text.stdout).into_owned();
    for words in ["3 bodies, 2 contacts", "top of pad on bottom of head", "held: u₁ = 0", "in all 11760 N", "evaluate"]
    {
        assert!(printed.contains(words), "{words}: {printed}");
    }
}

/// What is wrong is said with what to do about it.
#[test]
fn scenes_that_cannot_stand_are_told_so() {
    let scene = scenes().join("lug_tet10.toml");
    let hints = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|field| ["--set", field]).collect();
        json(CONTACT, &[&[text(&scene), "look", "--json"], &set[..]].concat())["hints"].to_string()
    };
    for (set, words) in [
        (&["contact[0].obstacle.point=[0.0,0.0,1.0]"][..], "contact nodes overlap what they touch, by up to"),
        (&["contact[0].obstacle.point=[0.0,0.0,-5.0]"], "begin 4.92000 mm apart"),
        (&["body[0].loads=[]", "contact[0].obstacle.point=[0.0,0.0,-5.0]"], "no load acts and nothing overlaps"),
        (&["body.supports=[]"], "friction alone holds the body along x1, x2"),
        (&["body.supports=[]", "friction=0.0"], "nothing holds the body along x1, x2: add supports or friction"),
        (&["body.supports=[]", "body.loads=[{face=\"top\",force=[0.0,0.0,5.0]}]"], "do not press nose"),
    ] {
        let found = hints(set);
        assert!(found.contains(words), "{set:?}: {found}");
    }
}
