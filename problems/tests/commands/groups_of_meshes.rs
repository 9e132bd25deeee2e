//! Groups of meshes that have no elements, or that share facets, mean what they say.

use serde_json::Value;
use std::path::Path;
use testset::kit::{errors, json, run, scratch};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

fn scenes() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Puts the lug of hexahedra into a folder; its mesh has the names "ghost" of a surface and "gone" of a volume besides,
/// which have no elements.
fn lug(folder: &Path) -> String {
    let mesh = std::fs::read_to_string(scenes().join("lug_hex8.msh")).unwrap();
    let mesh = mesh.replacen("$PhysicalNames\n6\n", "$PhysicalNames\n8\n2 77 \"ghost\"\n3 78 \"gone\"\n", 1);
    std::fs::write(folder.join("lug_hex8.msh"), mesh).unwrap();
    let scene = folder.join("lug.toml");
    std::fs::copy(scenes().join("lug_hex8.toml"), &scene).unwrap();
    scene.display().to_string()
}

#[test]
fn a_name_without_elements_is_refused_wherever_something_is_asked_of_it() {
    let folder = scratch();
    let scene = lug(folder.path());
    let ghost = [
        r#"body.loads=[{ face = "ghost", force = [0.0, 0.0, -9.0] }]"#,
        r#"body.loads=[{ face = "top", force = [0.0, 0.0, -9.0] }, { face = "ghost", pressure = 1.0 }]"#,
        r#"body.loads=[{ face = "ghost", traction = [0.0, 0.0, -9.0] }]"#,
        r#"body.loads=[{ face = "ghost", force = [0.0, 0.0, 0.0], moment = [1.0, 0.0, 0.0] }]"#,
        r#"body.loads=[{ face = "ghost", formula = ["0", "0", "x1"] }]"#,
        r#"body.loads=[{ volume = "gone", body_force = [0.0, 0.0, -1.0] }]"#,
        r#"body.supports=[{ face = "ghost", held = ["u1", "u2"] }]"#,
        r#"body.materials=[{ volume = "gone", young_modulus = 1e5, poisson_ratio = 0.3 }]"#,
        r#"contact.slave.face="ghost""#,
        r#"contact.regions=[{ region = "ghost", friction = 0.1 }]"#,
        r#"body.lattice.region=["ghost"]"#,
        r#"body.lattice.fixed=["ghost"]"#,
        r#"limit=[{ quantity = "displacement", at_most = 1.0, region = { face = "ghost" } }]"#,
        r#"limit=[{ quantity = "stress", at_most = 1e3, region = { volume = "gone" } }]"#,
        r#"objective={ quantity = "stress-norm", region = { volume = "gone" } }"#,
    ];
    for setting in ghost {
        let output = run(CONTACT, &[&scene, "evaluate", "--set", setting]);
        let (message, name) = (errors(&output), if setting.contains("ghost") { "\"ghost\"" } else { "\"gone\"" });
        assert_eq!(output.status.code(), Some(2), "{setting}: {message}");
        let words = format!("{name}, a group without elements in lug_hex8.msh");
        assert!(message.contains(&words), "{setting}: {message}");
        let known = if setting.contains("volume") { "\"body\"" } else { "\"nose\"" };
        assert!(message.contains(known), "{setting}: {message}");
    }
    let looked: Value = json(CONTACT, &[&scene, "look", "--json"]);
    assert_eq!(looked["bodies"][0]["names_without_elements"], serde_json::json!(["ghost", "gone"]));
    let text = errors(&run(CONTACT, &[&scene, "look"]));
    assert!(text.contains("names without elements: \"ghost\", \"gone\""), "{text}");
}

#[test]
fn a_load_that_pulls_a_body_off_is_told() {
    let folder = scratch();
    let scene = lug(folder.path());
    let notes = |traction: &str| {
        let setting = format!(r#"body.loads=[{{ face = "top", traction = [0.0, 0.0, {traction}] }}]"#);
        String::from_utf8_lossy(&run(CONTACT, &[&scene, "look", "--set", &setting]).stdout).into_owned()
    };
    assert!(notes("800.0").contains("pull it off"), "{}", notes("800.0"));
    assert!(!notes("-800.0").contains("pull it off"), "{}", notes("-800.0"));
}

#[test]
fn look_tells_the_point_and_the_moment_of_a_load() {
    let folder = scratch();
    let scene = lug(folder.path());
    let setting =
        r#"body.loads=[{ face = "top", force = [0.0, 0.0, -9.0], moment = [7.0, 0.0, 0.0], point = [1.0, 2.0, 3.0] }]"#;
    let looked = String::from_utf8_lossy(&run(CONTACT, &[&scene, "look", "--set", setting]).stdout).into_owned();
    assert!(looked.contains("with moment (7, 0, 0) N mm at (1, 2, 3) mm"), "{looked}");
}

/// Cells that evaluation refuses are no shape for other programs.
#[test]
fn export_refuses_inverted_cells() {
    let folder = scratch();
    let scene = lug(folder.path());
    let controls: Vec<f64> =
        (0..81).map(|control| if control % 3 == 2 { [8.5, -8.5][control % 2] } else { 0.0 }).collect();
    let file = folder.path().join("controls.json");
    std::fs::write(&file, serde_json::to_string(&controls).unwrap()).unwrap();
    let box_of = r#"body.lattice.box=[[-20.0, 0.0, 0.0], [20.0, 30.0, 2.0]]"#;
    let bounds = "body.lattice.displacement=[-9.0, 9.0]";
    let common = ["--controls", &*file.display().to_string(), "--set", box_of, "--set", bounds].map(str::to_owned);
    let out = folder.path().join("out").display().to_string();
    let [evaluated, exported] = [vec!["evaluate"], vec!["export", "--out", &out]].map(|command| {
        let arguments: Vec<&str> =
            [&*scene].into_iter().chain(command).chain(common.iter().map(String::as_str)).collect();
        let output = run(CONTACT, &arguments);
        (output.status.success(), errors(&output))
    });
    assert!(!evaluated.0 && evaluated.1.contains("is inverted"), "{}", evaluated.1);
    assert!(!exported.0 && exported.1.contains("is inverted"), "{}", exported.1);
    assert!(!Path::new(&out).exists());
}
