//! `recheck`: the certificate of a run agrees with its files, and no longer when one of them is changed.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The folder of an optimization that is removed with the test.
struct Run(PathBuf);

impl Run {
    /// Optimizes Example 5.1 with some options.
    fn new(name: &str, options: &[&str]) -> Self {
        let path = std::env::temp_dir().join(format!("nonsmooth-recheck-{}-{name}", std::process::id()));
        let _absent = std::fs::remove_dir_all(&path);
        let this = Self(path);
        let output = signorini3d(&[options, &["--out", this.path()]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        this
    }

    fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }

    fn read(&self, file: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.0.join(file)).unwrap()).unwrap()
    }

    /// Changes a file, rechecks the folder, and restores the file.
    fn tampered(&self, file: &str, change: impl FnOnce(&mut Value)) -> Output {
        let original = std::fs::read(self.0.join(file)).unwrap();
        let mut value = self.read(file);
        change(&mut value);
        std::fs::write(self.0.join(file), value.to_string()).unwrap();
        let output = recheck(&self.0);
        std::fs::write(self.0.join(file), original).unwrap();
        output
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn signorini3d(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_signorini3d")).args(arguments).env_remove("RUST_LOG").output().unwrap()
}

/// Rechecks a folder with the scene that it holds.
fn recheck(folder: &Path) -> Output {
    let (scene, folder) = (folder.join("scene.toml"), folder.to_str().unwrap());
    let arguments = [scene.to_str().unwrap(), "recheck", folder, "--json"];
    Command::new(env!("CARGO_BIN_EXE_contact3d")).args(arguments).env_remove("RUST_LOG").output().unwrap()
}

/// The key of the JSON that a change of the certificate concerns, and the change.
type Forgery<'a> = (&'a str, &'a dyn Fn(&mut Value));

/// The JSON of a recheck with this exit status.
fn result(output: &Output, status: i32) -> Value {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{message}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {message}"))
}

#[test]
fn an_honest_certificate_agrees_and_a_changed_one_does_not() {
    let run = Run::new("honest", &["--mesh", "4", "--max-evaluations", "30"]);
    let honest = result(&recheck(&run.0), 0);
    assert_eq!([&honest["agrees"], &honest["point_equals_controls"]], [&json!(true); 2], "{honest}");
    let (report, certificate) = (run.read("report.json"), run.read("certificate.json"));
    for key in ["aggregate_norm", "aggregate_error"] {
        assert_eq!(honest[key]["recorded"], report["certificate"][key]);
    }
    // The binary with the scene built in says the same to people.
    let output = signorini3d(&["recheck", run.path(), "--mesh", "4"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("certificate                   agrees\n"), "{text}");

    let numbers = |value: &Value| value.as_array().is_some_and(|array| array.iter().all(Value::is_number));
    for plain in [&certificate["point"], &certificate["bound_multipliers"], &certificate["cuts"][0]["subgradient"]] {
        assert!(numbers(plain) && plain.as_array().unwrap().len() == 36, "{plain}");
    }
    let active = certificate["cuts"].as_array().unwrap().iter().position(|cut| cut["multiplier"].as_f64() > Some(0.1));
    let active = active.expect("a cut with a multiplier that matters");
    let change_by_a_percent = |value: &mut Value| *value = json!(1.01 * value.as_f64().unwrap());
    let forged: [Forgery<'_>; 5] = [
        ("aggregate_norm", &|certificate| change_by_a_percent(&mut certificate["aggregate_norm"])),
        ("aggregate_norm", &|certificate| change_by_a_percent(&mut certificate["cuts"][active]["subgradient"][0])),
        ("aggregate_error", &|certificate| change_by_a_percent(&mut certificate["cuts"][active]["value"])),
        ("multipliers_and_point_admissible", &|certificate| {
            change_by_a_percent(&mut certificate["cuts"][active]["multiplier"])
        }),
        ("point_equals_controls", &|certificate| change_by_a_percent(&mut certificate["point"][7])),
    ];
    for (key, change) in forged {
        let found = result(&run.tampered("certificate.json", change), 1);
        let verdict = if found[key].is_object() { &found[key]["agrees"] } else { &found[key] };
        assert_eq!([verdict, &found["agrees"]], [&json!(false); 2], "{key}: {found}");
    }
    let found = result(&run.tampered("controls.json", |controls| change_by_a_percent(&mut controls[0][3])), 1);
    assert_eq!([&found["point_equals_controls"], &found["aggregate_norm"]["agrees"]], [&json!(false), &json!(true)]);
}

#[test]
fn a_composite_proof_is_computed_again_from_jacobian_and_pressure_measure() {
    let run = Run::new("proof", &["--mesh", "6"]);
    assert_eq!(run.read("report.json")["termination"]["confirmed"], json!(true));
    let honest = result(&recheck(&run.0), 0);
    for key in ["value", "outer", "cuts"] {
        assert!(honest["composite"][key].as_f64() < Some(1e-12), "{honest}");
    }
    // The node of the peak: entries of open nodes do not matter.
    let outputs = run.read("certificate.json")["composite"]["outputs"].as_array().unwrap().clone();
    let larger = |a: &usize, b: &usize| outputs[*a].as_f64().unwrap().total_cmp(&outputs[*b].as_f64().unwrap());
    let peak = (0..outputs.len()).max_by(larger).unwrap();
    let forge = |certificate: &mut Value, place: &[&str]| {
        let entry = place.iter().fold(certificate, |value, key| &mut value[*key]);
        // A Jacobian has a row per node.
        let entry = if entry[peak].is_array() { &mut entry[peak][0] } else { &mut entry[peak] };
        *entry = json!(1.5 * entry.as_f64().unwrap() + 1.0);
    };
    for place in [&["composite", "jacobian"][..], &["composite", "outputs"]] {
        let found = result(&run.tampered("certificate.json", |certificate| forge(certificate, place)), 1);
        assert_eq!(found["agrees"], json!(false), "{place:?}: {found}");
    }
    let other = signorini3d(&["recheck", run.path(), "--mesh", "6", "--exponent", "3"]);
    assert_eq!(other.status.code(), Some(1), "{}", String::from_utf8_lossy(&other.stdout));
}

#[test]
fn the_certificate_of_growing_meshes_is_rechecked_on_the_last_one() {
    let run = Run::new("meshes", &["--continuation", "2,4", "--max-evaluations", "8"]);
    assert_eq!(result(&recheck(&run.0), 0)["agrees"], json!(true));
    let with_the_default_degree = ["recheck", run.path(), "--degrees", "3"];
    assert_eq!(signorini3d(&with_the_default_degree).status.code(), Some(0));
}

#[test]
fn what_is_no_certificate_of_the_scene_is_refused() {
    let run = Run::new("refused", &["--mesh", "2", "--max-evaluations", "3"]);
    let refused = |arguments: &[&str], status: i32, words: &str| {
        let output = signorini3d(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {message}");
        assert!(message.contains(words) && output.stdout.is_empty(), "{arguments:?}: {message}");
    };
    refused(&["recheck"], 2, "<DIR>");
    refused(&["evaluate", run.path()], 2, "is allowed with recheck only");
    refused(
        &["recheck", run.path(), "--out", run.path()],
        2,
        "--out is allowed with optimize, compare, study, look, evaluate, verify, tolerance and export only",
    );
    refused(&["recheck", run.path(), "--controls", "c.json"], 2, "--controls is allowed");
    // A surface with other controls is another scene.
    refused(
        &["recheck", run.path(), "--mesh", "2", "--control-points", "5x5"],
        1,
        "body[0].lattice.control_points is [6,6]",
    );
    refused(&["recheck", run.path()], 1, "body[0].block.bricks is [2,2,2] in the run and [12,12,12] here");
    refused(&["recheck", run.path(), "--mesh", "2", "--friction", "0.2"], 1, "friction is 0.3 in the run and 0.2 here");
    std::fs::write(run.0.join("certificate.json"), "null").unwrap();
    refused(&["recheck", run.path()], 1, "has no certificate");
    std::fs::write(run.0.join("certificate.json"), "{}").unwrap();
    refused(&["recheck", run.path()], 2, "expected the certificate");
    std::fs::remove_file(run.0.join("certificate.json")).unwrap();
    refused(&["recheck", run.path()], 2, "certificate.json");
}
