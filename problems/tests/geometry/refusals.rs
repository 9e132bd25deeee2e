//! What a scene of a mesh may get wrong: refused, or doubted, by the field with what is allowed.

use std::fs;
use std::process::Command;
use testset::kit::scratch;

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// What `evaluate` says of the scene of the lug with some text replaced, and whether it refuses.
fn said(right: &str, wrong: &str, options: &[&str]) -> (bool, String) {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let scene = fs::read_to_string(format!("{scenes}/lug_hex8.toml")).expect("a scene");
    assert!(scene.contains(right), "{right}");
    let scene = scene.replacen(right, wrong, 1).replace("lug_hex8.msh", &format!("{scenes}/lug_hex8.msh"));
    let folder = scratch();
    let file = folder.path().join("lug.toml");
    fs::write(&file, scene).expect("a file");
    let output = Command::new(CONTACT).arg(&file).arg("evaluate").args(options).output().expect("an answer");
    (output.status.code() == Some(2), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn fields_that_mean_nothing_on_the_mesh_are_refused() {
    let plane = "normal = [0.05, -0.01, -1.0]";
    for (right, wrong, words) in [
        ("face = \"nose\"", "face = \"nsoe\"", ["contact[0].slave.face = \"nsoe\"", "did you mean \"nose\"?"]),
        ("face = \"wall\"", "face = \"wal\"", ["supports[0]", "did you mean \"wall\"?"]),
        ("face = \"top\"", "face = \"topp\"", ["loads[0].face", "did you mean \"top\"?"]),
        ("box = [[-20.0", "box = [[120.0", ["lattice.box", "least coordinates first"]),
        (
            "box = [[-20.0, 0.0, 0.0], [20.0,",
            "box = [[60.0, 0.0, 0.0], [80.0,",
            ["lattice", "around nodes that may move"],
        ),
        (plane, "normal = [0.0, 0.0, 0.0]", ["contact[0].obstacle", "normal"]),
        ("{ face = \"nose\" }", "{ face = \"wall\" }\narea = \"projected\"", ["contact[0].area", "no area"]),
        ("at_most = 1.0", "at_most = 0.5", ["limit[0].at_least", "at most"]),
        ("quantity = \"relative-volume\"", "quantity = \"weight\"", ["limit[0].quantity", "relative-volume"]),
        ("lug_hex8.msh", "lug_hex9.msh", ["lug_hex9.msh", "No such file"]),
    ] {
        let (refused, message) = said(right, wrong, &[]);
        assert!(refused && words.iter().all(|word| message.contains(word)), "{wrong}: {message}");
    }
}

#[test]
fn options_of_blocks_are_refused_for_a_mesh() {
    for option in ["--mesh", "--subdomains"] {
        let (refused, message) = said("friction = 0.3", "friction = 0.3", &[option, "4"]);
        assert!(refused && message.contains(option) && message.contains("a block of bricks"), "{message}");
    }
}

/// A unit or a load that cannot be meant is told before any work.
#[test]
fn sizes_and_strains_that_cannot_be_meant_are_doubted() {
    for (right, wrong, words) in [
        ("[[body]]", "[[body]]\nunit = \"m\"", "is body[0].unit the unit of the mesh?"),
        ("-800.0", "-8e7", "are body[0].unit, the loads (N, MPa) and young_modulus (MPa) what they should be?"),
    ] {
        let (_, message) = said(right, wrong, &[]);
        assert!(message.contains(words), "{wrong}: {message}");
    }
}
