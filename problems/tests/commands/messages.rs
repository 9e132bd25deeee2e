//! What the commands say to people: errors name the option or the field as written, its value, and what is allowed.

use std::path::Path;
use testset::kit::{self, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");
const HERTZ: &str = env!("CARGO_BIN_EXE_hertz3d");
const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");

#[test]
fn options_out_of_range_are_named_with_value_and_range() {
    for (option, value, allowed) in [
        ("--mesh", "0", "an integer ≥ 1 and ≤ 400"),
        ("--mesh", "-3", "an integer ≥ 1 and ≤ 400"),
        ("--mesh", "1e99", "an integer ≥ 1 and ≤ 400"),
        ("--subdomains", "0", "an integer ≥ 1"),
        ("--poisson-ratio", "0.5", "> -1 and < 0.5"),
        ("--young-modulus", "1e-300", "≥ 1e-9 and ≤ 1e15 (MPa)"),
        ("--friction", "1e7", "≥ 0 and ≤ 1e6"),
        ("--exponent", "65", "> 1 and ≤ 64"),
        ("--load-factor", "nan", "a finite number"),
        ("--load-factor", "1e300", "≤ 1e15 MPa"),
        ("--control-points", "6x400", "≥ 1 and ≤ 40"),
        ("--degrees", "x", "an integer ≥ 0 and ≤ 39"),
        ("--threads", "2000", "1..=256"),
        ("--threads", "-3", "1..=256"),
        ("--continuation", "x", "an integer ≥ 1 and ≤ 400"),
        ("--max-evaluations", "-3", "an integer ≥ 1 and ≤ 1e6"),
        ("--time-limit", "inf", "> 0 and ≤ 1e9 (s)"),
    ] {
        kit::refused(SIGNORINI, &["optimize", option, value], &[option, value, allowed]);
    }
    // What does not fit together is blamed on the option that was given, not on the field that it stands for.
    kit::refused(SIGNORINI, &["evaluate", "--subdomains", "5"], &["--subdomains = 5", "a divisor of the 12 bricks"]);
    kit::refused(SIGNORINI, &["compare", "--friction", "0"], &["--friction = 0", "> 0"]);
    kit::refused(SIGNORINI, &["evaluate", "--controls", "none.json"], &["--controls: none.json"]);
    kit::refused(SIGNORINI, &["--start-controls", "none.json"], &["--start-controls: none.json"]);
}

/// A field that the command line sets has the effect of the same field in the file, and the checks of the file.
#[test]
fn any_field_can_be_set() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let folder = kit::scratch();
    let file = folder.path().join("mine.toml");
    let hertz = std::fs::read_to_string(scenes.join("hertz.toml")).unwrap();
    let changed = hertz.replacen("2.1e5", "1.5e5", 1).replacen("[500.0, 0.0, -2000.0]", "[400, 0.0, -1900.0]", 1);
    assert_ne!(changed, hertz);
    std::fs::write(&file, &changed).unwrap();
    let fields = [
        "--set",
        "body[1].material.young_modulus=1.5e5",
        "--set",
        "body[1].loads[1].traction=[400, 0, -1900]",
        "--set",
        "body[0].block.bricks=4x4x2",
        "--set",
        "body[1].block.bricks=4x4x2",
        "--set",
        "solver.kind=direct",
    ];
    let set = kit::json(HERTZ, &[&["evaluate", "--json"], &fields[..]].concat());
    let stated = kit::json(
        CONTACT,
        &[text(&file), "evaluate", "--mesh", "4x4x2", "--solver", "direct", "--subdomains", "2", "--json"],
    );
    for key in ["objective", "subgradient", "peak_pressure", "solver"] {
        assert_eq!(set[key], stated[key], "{key}");
    }
    for (setting, words) in [
        ("body[1].material.young_modul=1", &["there is no field", "did you mean `young_modulus`?"][..]),
        ("body[1].material.young_modulus=-1", &["body[1].material.young_modulus = -1", "≥ 1e-9 and ≤ 1e15 (MPa)"]),
        ("solver.kind=newtn", &["solver.kind = \"newtn\"", "\"newton\", \"direct\""]),
        ("body[0].block.bricks=[6, 6]", &["body[0].block.bricks", "3 entries, each an integer ≥ 1 and ≤ 400"]),
        ("body[1].loads[7].face=top", &["body[1].loads[7].face", "without gap"]),
        ("body[1].block.bottom.form=pyramid", &["body[1].block.bottom.form = pyramid", "form = \"plane\""]),
        ("friction.x=1", &["there is no field `friction.x`", "a finite number ≥ 0"]),
        ("friction", &["FIELD=VALUE"]),
        ("body[0].block.subdomains=5", &["--set body[0].block.subdomains[0] = 5", "a divisor of the 12 bricks"]),
    ] {
        kit::refused(HERTZ, &["evaluate", "--set", setting], words);
    }
    let plane = kit::json(
        HERTZ,
        &["evaluate", "--mesh", "2", "--set", "body[1].block.bottom={form=\"plane\",height=10}", "--json"],
    );
    assert!(plane["peak_pressure"].as_f64().unwrap() > 0.0);
}

#[test]
fn options_of_other_commands_are_refused_with_the_commands_that_take_them() {
    for (arguments, words) in [
        (&["evaluate", "--vtk-history"][..], "--vtk-history is allowed with optimize only"),
        (&["verify", "--no-checks"], "--no-checks is allowed with optimize, compare, study and evaluate only"),
        (&["--controls", "x"], "--controls is allowed with study, look, evaluate, verify, tolerance and export only"),
        (&["--mesh", "4", "evaluate"], "--mesh is allowed after the command: evaluate --mesh"),
        (&["recheck", "x", "--out", "y"], "--out is allowed with"),
        (&["recheck"], "<DIR>"),
        (&["evaluate", "x"], "x is allowed with recheck only"),
        (&["evaluate", "--json", "--json"], "cannot be used multiple times"),
    ] {
        kit::refused(SIGNORINI, arguments, &[words]);
    }
}

#[test]
fn fields_that_contradict_each_other_are_named_as_in_the_file() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let hertz = std::fs::read_to_string(scenes.join("hertz.toml")).unwrap();
    let folder = kit::scratch();
    let file = folder.path().join("mine.toml");
    for (right, wrong, words) in [
        (
            "volume = [800.0, 1200.0]",
            "volume = [1200.0, 800.0]",
            ["lattice.volume = [1200, 800]", "the smallest volume, then"],
        ),
        (
            "thickness = ",
            "thickness = 40",
            ["what lies opposite to top of lower at (0, 0) = ", "at least lattice.thickness"],
        ),
        (
            "top = { form = \"plane\", height = ",
            "top = { form = \"plane\", height = -",
            ["upper.block.top = -", "above the bottom, which has the height"],
        ),
        ("young_modulus = 2.1e5", "young_modulus = 2.1e-300", ["body[1].material.young_modulus = 2.1e-300", "≥ 1e-9"]),
        ("height = 10.0", "height = 10.5", ["lattice.start: controls lie outside", "height of control"]),
    ] {
        assert!(hertz.contains(right), "{right}");
        std::fs::write(&file, hertz.replacen(right, wrong, 1)).unwrap();
        kit::refused(CONTACT, &[text(&file), "evaluate"], &words);
    }
}

#[test]
fn files_may_begin_with_a_byte_order_mark_and_must_not_be_endless() {
    let folder = kit::scratch();
    let (scene, controls) = (folder.path().join("marked.toml"), folder.path().join("marked.json"));
    let marked = |content: &str| format!("\u{feff}{content}");
    std::fs::write(&scene, marked(include_str!("../../scenes/signorini.toml"))).unwrap();
    std::fs::write(&controls, marked(&format!("{:?}", [100.0; 36]))).unwrap();
    kit::json(CONTACT, &[text(&scene), "evaluate", "--mesh", "3", "--controls", text(&controls), "--json"]);
    #[cfg(unix)]
    {
        let endless = ["too long", "at most 1 MiB"];
        kit::refused(CONTACT, &["/dev/zero", "evaluate"], &endless);
        kit::refused(SIGNORINI, &["evaluate", "--controls", "/dev/zero"], &endless);
        let punch = include_str!("../../scenes/flat_punch.toml").replace("flat_punch.csv", "/dev/zero");
        std::fs::write(&scene, punch).unwrap();
        kit::refused(CONTACT, &[text(&scene), "evaluate"], &["/dev/zero", "too long", "at most 128 MiB"]);
    }
}

/// A stdout that is full, closed by its reader, or closed from the beginning; with results that are in a folder too,
/// the latter is no failure, for programs give others a /dev/null that looks the same.
#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_printed_is_never_a_success() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/signorini.toml");
    let short = ["evaluate", "--mesh", "3", "--json"];
    let commands = [
        ("contact3d", [&[scene], &short[..]].concat()),
        ("hertz3d", short.to_vec()),
        ("signorini3d", ["optimize", "--mesh", "3", "--max-evaluations", "2"].to_vec()),
        ("signorini3d", ["--print-scene"].to_vec()),
        ("signorini3d", ["--help"].to_vec()),
        ("toy2d", ["--starts", "1"].to_vec()),
        ("toy2d", ["--version"].to_vec()),
    ];
    let output = |program: &str, redirection: &str, arguments: &[&str]| {
        // A reader that is to be gone first gets the time for it.
        let script = format!("{{ sleep 0.1; exec \"$0\" \"$@\"; }} {redirection}");
        kit::run("bash", &[&["-c", &script, crate::binary(program).unwrap()], arguments].concat())
    };
    for (program, arguments) in &commands {
        let redirections = [
            ("> /dev/full", "No space left"),
            ("| true; exit ${PIPESTATUS[0]}", "Broken pipe"),
            (">&-", "it is closed"),
        ];
        for (redirection, reason) in redirections {
            let output = output(program, redirection, arguments);
            let said = kit::errors(&output);
            assert_eq!(output.status.code(), Some(1), "{program} {arguments:?} {redirection}: {said}");
            assert!(said.contains("stdout") && said.contains(reason) && !said.contains("panicked"), "{said}");
        }
        let nowhere = output(program, "> /dev/null", arguments);
        assert!(nowhere.status.success() && nowhere.stderr.is_empty(), "{program}: {}", kit::errors(&nowhere));
    }
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    let kept = output("hertz3d", ">&-", &[&short[..], &["--out", text(&folder)]].concat());
    assert!(kept.status.success() && kit::errors(&kept).contains("the result is in"), "{}", kit::errors(&kept));
}

#[test]
fn help_has_the_defaults_and_results_name_their_files() {
    let printed = |program: &str, arguments: &[&str]| {
        let output = kit::run(program, arguments);
        assert!(output.status.success(), "{}", kit::errors(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    // Lines break where the terminal ends.
    let unbroken = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let help = unbroken(printed(SIGNORINI, &["--help"]));
    for default in [
        "[default: [12, 12, 12]]",
        "[default: 0.3]",
        "[default: 150]",
        "[default: 4 for pressures, 8 for stresses]",
        "[default: optimize]",
        "--set <FIELD=VALUE>",
    ] {
        assert!(help.contains(default), "{default}: {help}");
    }
    assert!(unbroken(printed(CONTACT, &["--help"])).contains("[default: friction of the scene]"));
    for name in ["contact3d", "hertz3d", "signorini3d", "toy2d"] {
        assert!(printed(crate::binary(name).unwrap(), &["-V"]).starts_with(&format!("{name} ")), "{name}");
    }
    let scratch = kit::scratch();
    let folder = scratch.path().join("run");
    for command in [&["evaluate"][..], &["optimize", "--max-evaluations", "2"]] {
        let text = printed(SIGNORINI, &[command, &["--mesh", "3", "--overwrite", "--out", text(&folder)]].concat());
        let page = format!(" {}", folder.join("report.html").display());
        assert!(text.lines().any(|line| line.starts_with("files ") && line.ends_with(&page)), "{text}");
    }
}

#[test]
fn the_largest_exponents_are_evaluated_and_optimized() {
    let evaluated =
        |options: &[&str]| kit::json(SIGNORINI, &[&["evaluate", "--mesh", "4", "--json"], options].concat());
    let value = |result: &serde_json::Value, key: &str| result[key].as_f64().unwrap();
    let largest = evaluated(&["--exponent", "64"]);
    assert_eq!(value(&largest, "objective_root"), 1.0);
    assert!((value(&largest, "objective").log10() - value(&largest, "log10_objective")).abs() < 1e-10);
    // Σσ^64 of pressures that are a hundred times larger is no double.
    let beyond = evaluated(&["--exponent", "64", "--load-factor", "100"]);
    let peak = value(&beyond, "peak_pressure");
    assert_eq!(value(&beyond, "objective_root"), 64.0);
    assert!((1.0..1.1).contains(&(value(&beyond, "objective") / peak)) && value(&beyond, "log10_objective") > 308.0);
    // The paper's exponent is computed as ever.
    assert_eq!(value(&evaluated(&[]), "objective_root"), 1.0);
    let optimized = kit::json(SIGNORINI, &["--mesh", "4", "--exponent", "64", "--max-evaluations", "30", "--json"]);
    assert!(value(&optimized, "objective") < 0.7 * value(&optimized, "objective_start"), "{optimized}");
}
