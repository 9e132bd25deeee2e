//! `study`: rows are what separate commands find, failures are rows, a study that was cut short goes on.

use serde_json::Value;
use testset::kit::{self, errors, json, refused, text};

const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");
const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

fn rows(study: &Value) -> &Vec<Value> {
    study["rows"].as_array().unwrap()
}

/// A row without its time.
fn outcomes(study: &Value) -> Vec<(Value, Value)> {
    rows(study).iter().map(|row| (row["options"].clone(), row["solved"].clone())).collect()
}

#[test]
fn every_row_is_what_evaluate_finds() {
    let study =
        json(SIGNORINI, &["study", "--mesh", "4", "--vary", "friction=0:0.6:3", "--vary", "load-factor=1,2", "--json"]);
    assert_eq!((&study["rows_in_all"], &study["failures"], rows(&study).len()), (&6.into(), &0.into(), 6));
    for row in rows(&study) {
        let options: Vec<&str> = row["options"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
        let single = json(SIGNORINI, &[&["evaluate", "--mesh", "4", "--json"], &options[..]].concat());
        let solved = &row["solved"];
        for key in ["objective", "peak_pressure", "total_normal_force", "status"] {
            assert_eq!(solved[key], single[key], "{key} of {options:?}");
        }
        let closed = solved["status"]["open"].as_u64().unwrap() < 25;
        let area = solved["contact_area"].as_f64().unwrap();
        assert!(closed && area > 0.0 && area <= 1e4 * (1.0 + 1e-12), "{area}");
    }
}

/// A field that has no option is varied by its path.
#[test]
fn fields_are_varied_by_their_paths() {
    let vary = [
        "--vary",
        "body[0].loads[0].traction=[0,0,1500],[0,0,3000]",
        "--vary",
        "body[0].material.young_modulus=1e5:2e5:2",
    ];
    let study = json(SIGNORINI, &[&["study", "--mesh", "4", "--json"], &vary[..]].concat());
    assert_eq!(rows(&study).len(), 4);
    for row in rows(&study) {
        let options: Vec<&str> = row["options"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
        let single = json(SIGNORINI, &[&["evaluate", "--mesh", "4", "--json"], &options[..]].concat());
        assert_eq!(row["solved"]["objective"], single["objective"], "{options:?}");
    }
    let half =
        json(SIGNORINI, &["evaluate", "--mesh", "4", "--load-factor", "0.5", "--young-modulus", "1e5", "--json"]);
    assert_eq!(rows(&study)[0]["solved"]["objective"], half["objective"]);
    let table = kit::run(SIGNORINI, &["study", "--mesh", "2", "--vary", "solver.kind=newton,direct"]).stdout;
    let table = String::from_utf8(table).unwrap();
    assert!(table.contains("solver.kind") && table.contains("newton ") && !table.contains("--set"), "{table}");
    for (vary, words) in [
        ("body[0].material.young_modul=1,2", "did you mean `young_modulus`?"),
        ("body[0].material.young_modulus=1,-2", "≥ 1e-9 and ≤ 1e15 (MPa)"),
        ("output.folder=a,b", "where results go"),
    ] {
        refused(SIGNORINI, &["study", "--vary", vary], &[words]);
    }
    let twice = ["study", "--vary", "friction=0,1", "--vary", "mesh=2", "--vary", "body[0].block.bricks=4"];
    refused(SIGNORINI, &twice, &["body[0].block.bricks", "once"]);
}

#[test]
fn a_row_that_fails_is_a_row_with_its_reason() {
    let arguments = ["study", "--mesh", "4", "--vary", "subdomains=3,2", "--vary", "load-factor=-1,1"];
    let output = kit::run(SIGNORINI, &arguments);
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", errors(&output));
    assert!(
        table.contains("--subdomains = 3 is not allowed")
            && table.contains("rows                          4 of 4, 3 failed"),
        "{table}"
    );
    let reason = json(SIGNORINI, &[&arguments[..], &["--json"]].concat())["rows"][2]["failed"].clone();
    assert!(reason.as_str().unwrap().contains("equilibrium"), "{reason}");
    let output = kit::run(SIGNORINI, &["study", "--mesh", "4", "--vary", "subdomains=3"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("every row has failed") && !output.stdout.is_empty());
}

/// Whatever the machine has, it has less memory than 64 million bricks need.
#[cfg(target_os = "linux")]
#[test]
fn a_mesh_beyond_the_memory_is_named_before_the_first_row() {
    let output = kit::run(SIGNORINI, &["study", "--vary", "mesh=2,400,4x4x2"]);
    let said = errors(&output);
    assert!(
        said.contains("row 2 will fail: body[0].block.bricks = 400x400x400 bricks")
            && !said.contains("row 3 will fail"),
        "{said}"
    );
    assert!(
        String::from_utf8_lossy(&output.stdout).contains("rows                          3 of 3, 1 failed"),
        "{said}"
    );
    let output = kit::run(SIGNORINI, &["--continuation", "2,400", "--max-evaluations", "2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("optimizer.continuation[1]: body[0].block.bricks = 400x400x400 bricks"),
        "{}",
        errors(&output)
    );
}

#[test]
fn an_optimized_study_goes_on_where_it_was_cut_short() {
    let scratch = kit::scratch();
    let [whole, cut] = ["whole", "cut"].map(|name| scratch.path().join(name));
    let study = ["study", "--mesh", "3", "--vary", "friction=0,0.3", "--optimize", "--max-evaluations", "4", "--json"];
    let expected = json(SIGNORINI, &[&study[..], &["--out", text(&whole)]].concat());
    let output = kit::run(SIGNORINI, &[&study[..], &["--out", text(&cut), "--time-limit", "1e-9"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("time limit") && errors(&output).contains("study --resume"),
        "{}",
        errors(&output)
    );
    let resumed = json(SIGNORINI, &["study", "--resume", text(&cut), "--time-limit", "1000", "--json"]);
    assert_eq!(outcomes(&resumed), outcomes(&expected));
    for (number, row) in (1..).zip(rows(&expected)) {
        let own = kit::read_json(&whole.join(format!("row_{number:03}/report.json")));
        assert_eq!(row["solved"]["objective"], own["objective"]);
        assert_eq!(row["solved"]["controls"], own["controls"]);
        assert_eq!(row["solved"]["optimization"]["evaluations"], 4);
    }
    let table = std::fs::read_to_string(whole.join("study.csv")).unwrap();
    assert_eq!((table.lines().count(), table.lines().next().unwrap().split(',').count()), (3, 16));
    let page = std::fs::read_to_string(whole.join("report.html")).unwrap();
    for part in ["figures/objective.svg", "row_002/report.html", "study.csv", "rows.json"] {
        assert!(page.contains(&format!("href=\"{part}\"")) && whole.join(part).exists(), "{part}");
    }
    // Killed within its second row, whose journal answers: no evaluation is made again.
    let rows_file = whole.join("rows.json");
    let kept = std::fs::read_to_string(&rows_file).unwrap();
    let mut first: Value = serde_json::from_str(&kept).unwrap();
    first.as_array_mut().unwrap().truncate(1);
    std::fs::write(&rows_file, first.to_string()).unwrap();
    let resumed = json(SIGNORINI, &["study", "--resume", text(&whole), "--json"]);
    assert_eq!(outcomes(&resumed), outcomes(&expected));
    assert_eq!(kit::read_json(&whole.join("row_002/report.json"))["resumed_evaluations"], 4);
    // More evaluations than the limit that ended the rows.
    let longer = json(CONTACT, &["study", "--resume", text(&whole), "--max-evaluations", "6", "--json"]);
    let at_once =
        ["study", "--mesh", "3", "--vary", "friction=0,0.3", "--optimize", "--max-evaluations", "6", "--json"];
    assert_eq!(outcomes(&longer), outcomes(&json(SIGNORINI, &at_once)));
    refused(SIGNORINI, &["--resume", text(&whole)], &["holds a study", "study --resume"]);
    let kept = std::fs::read(&rows_file).unwrap();
    refused(SIGNORINI, &["study", "--resume", text(&whole), "--max-evaluations", "2"], &["at least the 6"]);
    assert_eq!(std::fs::read(&rows_file).unwrap(), kept);
    refused(SIGNORINI, &["recheck", text(&whole)], &["holds a study"]);
    let row = whole.join("row_002");
    let scene = row.join("scene.toml");
    assert_eq!(json(CONTACT, &[text(&scene), "recheck", text(&row), "--json"])["agrees"], true);
}

/// What the error of a workshop does: none at 0; with a seed, the same as of `evaluate`.
#[test]
fn heights_that_are_off_change_the_pressure() {
    let errors = ["--vary", "height-error=0,0.1", "--vary", "seed=1:3:3"];
    let study = json(SIGNORINI, &[&["study", "--mesh", "4", "--json"], &errors[..]].concat());
    let value = |row: usize| rows(&study)[row]["solved"]["objective"].as_f64().unwrap();
    let exact = json(SIGNORINI, &["evaluate", "--mesh", "4", "--json"]);
    assert!((0..3).all(|row| exact["objective"] == value(row)));
    for (row, seed) in [(3, "1"), (4, "2"), (5, "3")] {
        let off = ["evaluate", "--mesh", "4", "--height-error", "0.1", "--seed", seed, "--json"];
        assert_eq!(json(SIGNORINI, &off)["objective"], value(row));
        assert!((value(row) / value(0) - 1.0).abs() > 1e-6);
    }
    let fixed = ["study", "--mesh", "4", "--json", "--height-error", "0.1", "--vary", "seed=2,3"];
    let fixed = json(SIGNORINI, &fixed);
    assert!((0..2).all(|row| rows(&fixed)[row]["solved"]["objective"] == value(4 + row)));
    let folder = kit::scratch();
    let file = folder.path().join("half.json");
    let heights: Vec<f64> = (0..36).map(|control| if control < 18 { 80.0 } else { 81.0 }).collect();
    std::fs::write(&file, format!("{heights:?}")).unwrap();
    let half = json(SIGNORINI, &[&["study", "--mesh", "4", "--json", "--controls", text(&file)], &errors[..]].concat());
    let single = json(SIGNORINI, &["evaluate", "--mesh", "4", "--json", "--controls", text(&file)]);
    assert_eq!(rows(&half)[0]["solved"]["objective"], single["objective"]);
    assert_eq!(rows(&half)[0]["solved"]["controls"], serde_json::to_value(&heights).unwrap());
    assert!(value(3) != value(4) && value(4) != value(5));
    for (arguments, words) in [
        (&["study", "--vary", "height-error=0,1", "--optimize"][..], "without --optimize"),
        (&["study", "--vary", "seed=1,2"], "height-error"),
        (&["evaluate", "--height-error", "-1"], "≥ 0"),
        (&["evaluate", "--seed", "1"], "--height-error"),
        (&["study", "--height-error", "0.1", "--vary", "friction=0", "--optimize"], "without --optimize"),
        (&["--height-error", "1"], "with study and evaluate only"),
    ] {
        refused(SIGNORINI, arguments, &[words]);
    }
}

#[test]
fn what_makes_no_study_is_refused() {
    refused(SIGNORINI, &["study"], &["--vary", "friction=0:0.8:5"]);
    refused(SIGNORINI, &["study", "--vary", "threads=1,2"], &["cannot be varied", "load-factor"]);
    refused(SIGNORINI, &["study", "--vary", "friction=-1"], &["--friction", "≥ 0"]);
    refused(SIGNORINI, &["study", "--vary", "friction=0", "--vary", "friction=1"], &["friction", "once"]);
    refused(SIGNORINI, &["--vary", "friction=0"], &["--vary", "with study only"]);
    refused(
        SIGNORINI,
        &["study", "--vary", "friction=0", "--max-evaluations", "3"],
        &["--max-evaluations", "study --optimize"],
    );
    let many = ["study", "--vary", "friction=0:1:100", "--vary", "load-factor=1:2:100"];
    refused(SIGNORINI, &many, &["--vary", "10000 rows", "at most 1000"]);
}

/// A folder of the name of the command is none of a scene; what failed is tried again; an edited plan is checked.
#[test]
fn a_study_in_a_folder_of_any_name_tries_failed_rows_again() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("study");
    let run = |arguments: &[&str]| {
        let output = kit::command(CONTACT, arguments).current_dir(scratch.path()).output().unwrap();
        (output.status.code(), errors(&output), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    json(SIGNORINI, &["study", "--mesh", "2", "--vary", "friction=0,0.3", "--json", "--out", text(&folder)]);
    let rows_file = folder.join("rows.json");
    let mut rows: Value = kit::read_json(&rows_file);
    let whole = rows.clone();
    rows[0].as_object_mut().unwrap().remove("solved");
    rows[0]["failed"] = "no space left".into();
    std::fs::write(&rows_file, rows.to_string()).unwrap();
    let (status, said, _) = run(&["study", "--resume", "study", "--json"]);
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(kit::read_json(&rows_file)[0]["solved"], whole[0]["solved"]);
    for (plan, words) in [
        (
            r#"{"vary":[{"name":"friction","values":["x"]}],"fixed":[],"optimize":false,"same_start":false}"#,
            "--friction",
        ),
        (r#"{"vary":[{"name":"friction","values":[]}],"fixed":[],"optimize":false,"same_start":false}"#, "0 rows"),
        ("{}", "study.json"),
    ] {
        std::fs::write(folder.join("study.json"), plan).unwrap();
        let (status, said, _) = run(&["study", "--resume", "study"]);
        assert!(status == Some(2) && said.contains(words), "{said}");
    }
}

/// A shape at a bound of the volume has another volume of bricks on every mesh; it can still be looked at.
#[test]
fn an_optimum_is_shown_on_other_meshes() {
    let scratch = kit::scratch();
    let out = scratch.path().join("run");
    let run = json(SIGNORINI, &["--mesh", "4", "--max-evaluations", "4", "--json", "--out", text(&out)]);
    assert!(run["evaluations"] == 4);
    let controls = out.join("controls.json");
    for mesh in ["3", "5", "7"] {
        json(SIGNORINI, &["evaluate", "--mesh", mesh, "--controls", text(&controls), "--json"]);
        let files = scratch.path().join(mesh);
        json(SIGNORINI, &["export", "--mesh", mesh, "--run", text(&out), "--csv", "--out", text(&files), "--json"]);
    }
}

/// What the program says when a run has not ended can be typed as it stands, without a scene.
#[test]
fn a_comparison_is_continued_without_its_scene() {
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let small = ["compare", "--mesh", "3", "--max-evaluations", "2", "--json"];
    let first = json(SIGNORINI, &[&small[..], &["--out", text(&folder)]].concat());
    let again = json(CONTACT, &["compare", "--resume", text(&folder), "--json"]);
    assert_eq!(again["shapes"], first["shapes"]);
    refused(CONTACT, &["evaluate", "--resume", text(&folder)], &["--resume"]);
    refused(CONTACT, &["none.toml", "compare", "--resume", text(&folder)], &["SCENE.toml and --resume"]);
}
