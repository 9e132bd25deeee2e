//! What a folder of a run says about itself, and what is refused or said before its work begins.

use std::path::Path;
use testset::kit::{self, errors, json, refused, text};

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");
const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// A scene of the examples with some lines in place of its objective.
fn scene(folder: &Path, name: &str, objective: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let whole = std::fs::read_to_string(path).unwrap();
    let file = folder.join("scene.toml");
    std::fs::write(&file, format!("{}\n[objective]\n{objective}\n", whole.split("[objective]").next().unwrap()))
        .unwrap();
    text(&file).to_owned()
}

#[test]
fn a_file_says_what_the_run_in_a_folder_is() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    for (kind, command) in [
        ("optimization", &["--max-evaluations", "2"][..]),
        ("comparison", &["compare", "--max-evaluations", "2"]),
        ("study", &["study", "--vary", "friction=0,0.3"]),
    ] {
        let begun = [command, &["--mesh", "2", "--overwrite", "--out", text(&folder)]].concat();
        assert!(kit::run(SIGNORINI, &begun).status.success());
        let file = folder.join("run.json");
        assert_eq!(kit::read_json(&file), serde_json::json!({ "kind": kind }));
        // An optimization is the default and has no word of its own.
        let word = if kind == "optimization" { "optimize" } else { command[0] };
        let other = if kind == "study" { "compare" } else { "study" };
        refused(SIGNORINI, &[other, "--resume", text(&folder)], &["holds a", kind, "continue it with"]);
        std::fs::write(&file, "{\"kind\": \"dream\"}").unwrap();
        refused(SIGNORINI, &[word, "--resume", text(&folder)], &["run.json", "dream"]);
        std::fs::remove_file(&file).unwrap();
        refused(SIGNORINI, &[word, "--resume", text(&folder)], &["run.json", "is missing", "export --run"]);
    }
}

#[test]
fn a_resumed_run_says_that_its_time_limit_holds_again() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let limits = ["--mesh", "2", "--max-evaluations", "2", "--time-limit", "600", "--out", text(&folder)];
    assert!(kit::run(SIGNORINI, &limits).status.success());
    let resumed = kit::run(SIGNORINI, &["--resume", text(&folder), "--json"]);
    assert!(resumed.status.success() && errors(&resumed).contains("600 s, the time limit that the run was begun with"));
    let other = kit::run(SIGNORINI, &["--resume", text(&folder), "--json", "--time-limit", "500"]);
    assert!(other.status.success() && !errors(&other).contains("time limit"), "{}", errors(&other));
}

/// The formula has a pole at x1 = 4, a node of the second mesh only, not of the scene's and the first one.
#[test]
fn an_objective_without_a_value_on_a_later_mesh_is_refused_at_the_start() {
    let scratch = kit::scratch();
    let out = scratch.path().join("run");
    let wanted = "quantity = \"pressure-deviation\"\nwanted = { form = \"formula\", pressure = \"1/(x1 - 4)\" }";
    let file = scene(scratch.path(), "tangential.toml", wanted);
    let run = [&file, "--continuation", "2,10", "--max-evaluations", "2", "--out", text(&out)];
    refused(CONTACT, &run, &["optimizer.continuation[1]: objective.wanted.pressure", "x1 = 4, x2 = 0"]);
    assert!(!out.exists());
    json(CONTACT, &[&file, "--continuation", "2", "--max-evaluations", "2", "--json"]);
    let file = scene(scratch.path(), "tangential.toml", &wanted.replace("1/(x1 - 4)", "sin x1"));
    refused(CONTACT, &[&file], &["objective.wanted.pressure", "\"x1\" at character 5", "a parenthesis after sin"]);
}

/// Where Θ is constant or at its least value, a run ends at once and says why.
#[test]
fn a_run_that_cannot_gain_anything_says_so() {
    let scratch = kit::scratch();
    let warning = |objective: &str, options: &[&str]| {
        let file = scene(scratch.path(), "tangential.toml", objective);
        let run = json(CONTACT, &[&[file.as_str(), "--mesh", "4", "--json"], options].concat());
        let found = run["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .find(|warning| ["flat-objective", "least-objective"].contains(&warning["code"].as_str().unwrap()));
        found.map(|warning| format!("{}: {}", warning["code"].as_str().unwrap(), warning["text"].as_str().unwrap()))
    };
    let area = |pressure: &str| format!("quantity = \"open-area\"\npressure = {pressure}");
    let above = warning(&area("1e6"), &[]).unwrap();
    assert!(above.contains("flat-objective") && above.contains("choose less than the largest pressure"), "{above}");
    let below = warning(&area("1e-6"), &[]).unwrap();
    assert!(below.contains("flat-objective") && below.contains("choose more than the least pressure"), "{below}");
    assert_eq!(warning(&area("200.0"), &["--max-evaluations", "3"]), None);
    let idle = warning("quantity = \"compliance\"", &["--load-factor", "0"]).unwrap();
    assert!(idle.contains("flat-objective") && idle.contains("nothing loads the bodies"), "{idle}");
}

/// Only a proof makes an optimum.
#[test]
fn a_shape_without_a_proof_is_called_the_best_found() {
    let scratch = kit::scratch();
    let page = |evaluations: &str| {
        let folder = scratch.path().join(evaluations);
        let run = json(SIGNORINI, &["--mesh", "4", "--max-evaluations", evaluations, "--json", "--out", text(&folder)]);
        let columns = kit::read_json(&folder.join("key_numbers.json"))["columns"].clone();
        let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
        (run["termination"]["confirmed"].clone(), columns, page)
    };
    let (confirmed, columns, limited) = page("2");
    assert_eq!((confirmed, columns), (false.into(), serde_json::json!(["start", "best found"])));
    assert!(limited.contains("<th>best found</th>") && !limited.contains("optimum, "), "{limited:.300}");
    let (confirmed, columns, converged) = page("60");
    assert_eq!((confirmed, columns), (true.into(), serde_json::json!(["start", "optimum"])));
    assert!(converged.contains("<th>optimum</th>") && !converged.contains("best found"));
    let folder = scratch.path().join("study");
    let study = ["study", "--optimize", "--mesh", "4", "--max-evaluations", "2", "--vary", "friction=0,0.3"];
    json(SIGNORINI, &[&study[..], &["--json", "--out", text(&folder)]].concat());
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(page.contains("2 of 2 optimizations ended unconfirmed") && page.contains("friction 0, best found"));
}

#[test]
fn rows_of_another_grid_do_not_take_the_controls() {
    let scratch = kit::scratch();
    let file = scratch.path().join("c.json");
    std::fs::write(&file, format!("{:?}", [[100.0; 6]; 6])).unwrap();
    let study = ["study", "--mesh", "2", "--vary", "control-points=6x6,4x9", "--controls", text(&file), "--json"];
    let rows = json(SIGNORINI, &study)["rows"].clone();
    let reason = rows[1]["failed"].as_str().unwrap();
    assert!(rows[0].get("solved").is_some() && reason.contains("6x6") && reason.contains("4x9"), "{reason}");
}
