//! Scene files: the examples, their printed form, and what is refused with which words.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use contact::contact_shape::{ContactShape, SolverKind};
use contact::cost::{NodeWeight, PressureMeasure, Quantity};
use contact::scene;
use contact::scene::Held;
use nonsmooth::{Accuracy, StateSolver, Vector};
use scene_file::{Case, MethodName, SceneFile, field_tables, schema};
use serde_json::Value;
use std::path::{Path, PathBuf};
use testset::kit;

const SCENES: [&str; 11] = [
    "signorini",
    "hertz",
    "stack",
    "signorini_frictionless",
    "flat_punch",
    "tangential",
    "thin_layer",
    "just_touching",
    "seal",
    "support",
    "jack_seat",
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(format!("{name}.toml"))).unwrap()
}

fn read(name: &str) -> SceneFile {
    SceneFile::read(&folder().join(format!("{name}.toml"))).unwrap()
}

#[test]
fn the_embedded_scenes_are_the_paper_s_examples() {
    for (name, expected) in [("signorini", scene::signorini()), ("hertz", scene::hertz())] {
        let case = Case::new(&read(name), &folder()).unwrap();
        assert_eq!(case.scene, expected.unwrap());
        assert_eq!(case.start, None);
    }
}

/// A first scene is short: an only body needs no name, and its only contact names no body.
#[test]
fn the_only_body_has_a_name_by_default_and_one_of_two_needs_one() {
    let text = text("signorini").replace("name = \"lower\"\n", "");
    let only = Case::new(&SceneFile::parse(&text, "mine").unwrap(), &folder()).unwrap().scene;
    assert_eq!((&*only.bodies[0].name, only.contacts[0].slave.body), ("body", 0));
    let refused = |right: &str, wrong: &str| {
        let file = SceneFile::parse(&self::text("hertz").replacen(right, wrong, 1), "mine").unwrap();
        Case::new(&file, &folder()).unwrap_err().to_string()
    };
    let nameless = refused("name = \"lower\"\n", "");
    assert!(nameless.contains("body[0].name = missing"), "{nameless}");
    let bodiless = refused("body = \"lower\", ", "");
    assert!(bodiless.contains("contact[0].slave.body = missing") && bodiless.contains("lower, upper"), "{bodiless}");
}

#[test]
fn every_type_of_the_form_is_listed_once() {
    let all = field_tables(None).unwrap();
    let rows = all.lines().filter(|line| line.starts_with("* `")).count();
    assert!((150..=230).contains(&rows), "{rows} rows");
    for kind in ["scene", "body", "block", "material", "support", "load", "obstacle", "lattice", "region", "contact"] {
        assert_eq!(all.matches(&format!("### `{kind}`\n")).count(), 1, "{kind}");
        assert!(all.contains(&field_tables(Some(kind)).unwrap()));
    }
    let unknown = field_tables(Some("bdy")).unwrap_err().to_string();
    assert!(unknown.contains("bdy") && unknown.contains("body"), "{unknown}");
}

#[test]
fn a_printed_scene_reads_back_as_the_same_scene() {
    for name in SCENES {
        let file = read(name);
        let printed = file.print().unwrap();
        assert_eq!(SceneFile::parse(&printed, "printed").unwrap(), file);
        let commented = printed.lines().filter(|line| line.starts_with('#')).count();
        assert!(commented > 60, "{name}: {commented} lines of comment");
    }
}

/// Both contact solvers, which share no equations, agree on every example, and the residuals certify the state.
#[test]
fn all_examples_are_solved_and_certified_on_a_coarse_mesh() {
    for name in SCENES {
        let mut file = read(name);
        for block in file.body.iter_mut().filter_map(|body| body.block.as_mut()) {
            // The stack is coarse already, and its layers have bricks of their own.
            if name != "stack" {
                (block.bricks, block.subdomains) = ([4; 3], Some([2; 3]));
            }
        }
        let case = Case::new(&file, &folder()).unwrap();
        let solve = |kind| {
            let shape = ContactShape::new(case.scene.clone(), kind).unwrap();
            let controls = case.start.as_ref().map_or_else(|| shape.start(), |start| Vector::from_column_slice(start));
            shape.problem().admissible.check(&controls).unwrap();
            shape.solve(&controls, None, Accuracy::TIGHTEST).unwrap()
        };
        let (state, other) = (solve(SolverKind::Newton), solve(SolverKind::Direct));
        let residuals = &state.forces.residuals;
        let parts = [residuals.equilibrium, residuals.complementarity, residuals.friction_cone, residuals.dissipation];
        assert!(parts.iter().all(|residual| *residual <= 1e-10), "{name}: {residuals:?}");
        let largest = state.forces.normal.iter().copied().fold(0.0, f64::max);
        assert!(largest > 0.0, "{name}: no contact");
        for (a, b) in state.forces.normal.iter().zip(&other.forces.normal) {
            assert!((a - b).abs() <= 1e-7 * largest, "{name}: {a} {b}");
        }
    }
}

#[test]
fn misspelt_fields_suggest_the_nearest_one() {
    let scene = text("hertz");
    for (right, wrong, path) in [
        ("friction = 0.3", "frction = 0.3", "`frction` (did you mean `friction`?)"),
        ("bricks =", "brick =", "`body[0].block.brick` (did you mean `bricks`?)"),
        (
            "young_modulus = 2.1e5",
            "youngs_modulus = 2.1e5",
            "`body[1].material.youngs_modulus` (did you mean `young_modulus`?)",
        ),
        ("radius = 20.0", "raduis = 20.0", "`body[1].block.bottom.raduis` (did you mean `radius`?)"),
        ("traction = [500.0", "tration = [500.0", "`body[1].loads[1].tration` (did you mean `traction`?)"),
        ("[body.lattice]", "[body.latice]", "`body[0].latice` (did you mean `lattice`?)"),
        ("volume =", "zzz =", "`body[0].lattice.zzz`; allowed: heights, control_points, degrees"),
    ] {
        assert!(scene.contains(right), "{right}");
        let message = SceneFile::parse(&scene.replacen(right, wrong, 1), "my.toml").unwrap_err().to_string();
        assert!(message.contains(path) && message.starts_with("my.toml: "), "{message}");
    }
}

#[test]
fn bad_values_are_refused_with_path_value_and_what_is_allowed() {
    let scene = text("hertz");
    for (right, wrong, words) in [
        ("friction = 0.3", "friction = -0.5", ["friction = -0.5", "≥ 0"]),
        ("friction = 0.3", "friction = nan", ["friction = nan", "finite"]),
        ("friction = 0.3", "friction = \"much\"", ["friction = \"much\"", "number"]),
        ("friction = 0.3\n", "", ["friction is missing", "≥ 0"]),
        ("bricks = [12, 12, 12]", "bricks = [12, 12]", ["body[0].block.bricks = [12, 12]", "3 entries"]),
        ("bricks = [12, 12, 12]", "bricks = [12, 0, 12]", ["body[0].block.bricks[1] = 0", "≥ 1"]),
        ("bricks = [12, 12, 12]", "bricks = [12, 1.5, 12]", ["body[0].block.bricks[1] = 1.5", "integer"]),
        ("poisson_ratio = 0.29", "poisson_ratio = 0.5", ["body[1].material.poisson_ratio = 0.5", "< 0.5"]),
        ("form = \"sphere\"", "form = \"bowl\"", ["body[1].block.bottom.form = bowl", "form = \"sphere\""]),
        ("held = [\"u1\"]", "held = [\"u4\"]", ["body[0].supports[0].held[0] = \"u4\"", "\"u3\""]),
        ("radius = 20.0", "radius = 1e400", ["my.toml", "overflowed"]),
        ("[body.block]", "[body.block", ["my.toml", "TOML parse error at line"]),
    ] {
        assert!(scene.contains(right), "{right}");
        let message = SceneFile::parse(&scene.replacen(right, wrong, 1), "my.toml").unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}

#[test]
fn contradictions_between_fields_are_refused() {
    let scene = text("hertz");
    for (right, wrong, word) in [
        ("subdomains = [2, 2, 2]", "subdomains = [2, 5, 2]", "divisor of the 12 bricks"),
        ("heights = \"top\"", "heights = \"top\"\ndegrees = [6]", "1 ≤ degree ≤ 5"),
        ("heights = \"top\"", "heights = \"top\"\ndegrees = [3, 3, 3]", "lattice.degrees"),
        ("heights = \"top\"", "heights = \"top\"\nregion = [\"top\"]", "none beside lattice.heights"),
        ("thickness = 5.0", "", "lattice.thickness = missing"),
        ("face = \"bottom\"\nheld", "face = \"top\"\nheld", "any face but the contact boundary"),
        ("start = { form = \"plane\", height = 10.0 }", "controls = [1.0, 2.0]", "36"),
        ("start = { form = \"plane\", height = 10.0 }", "start = { form = \"grid\", file = \"none.csv\" }", "none.csv"),
        ("face = \"x1-max\"", "face = \"x1-mxa\"", "upper.loads[1].face"),
        ("face = \"x1-max\"", "face = \"x1-mxa\"", "x1-max"),
        ("weight = \"nodes\"", "quantity = \"peak-pressure\"\nexponent = 4", "objective.exponent"),
        ("[[contact]]", "[optimizer]\ncontinuation = [6, 6]\n[[contact]]", "optimizer.continuation"),
        (
            "held = [\"u1\"]",
            "held = [\"u1\"]\ndisplacement = [0.1, 0.2, 0.0]",
            "body[0].supports[0].displacement[1] = 0.2",
        ),
        ("held = [\"u1\"]", "held = [\"u1\"]\nnormal_displacement = 0.2", "body[0].supports[0].normal_displacement"),
    ] {
        assert!(scene.contains(right), "{right}");
        let file = SceneFile::parse(&scene.replacen(right, wrong, 1), "my.toml").unwrap();
        let message = Case::new(&file, &folder()).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn prescribed_displacements_and_interference_reach_the_scene() {
    let words = "held = [\"u1\", \"normal\"]\ndisplacement = [0.1, 0.0, 0.0]\nnormal_displacement = -0.1";
    let scene = text("hertz").replacen("held = [\"u1\"]", words, 1);
    let contact = "[[contact]]\ninterference = 0.02\n";
    let file = SceneFile::parse(&scene.replacen("[[contact]]\n", contact, 1), "my.toml").unwrap();
    let scene = Case::new(&file, &folder()).unwrap().scene;
    let held: Vec<Held> = scene.bodies[0].supports.iter().take(2).map(|support| support.held).collect();
    assert_eq!(held, [Held::Components([Some(0.1), None, None]), Held::Normal(-0.1)]);
    assert_eq!(scene.contacts[0].interference, 0.02);
}

#[test]
fn starts_of_all_forms_and_grids_from_files() {
    let folder = kit::scratch();
    let scratch = folder.path();
    std::fs::write(scratch.join("start.csv"), "# heights\n8.0, 9.0\n9.0, 10.0\n").unwrap();
    for (form, first, last) in [
        ("{ form = \"grid\", file = \"start.csv\" }", 8.0, 10.0),
        ("{ form = \"waves\", base = 9.0, first = 0.5, second = 0.25, period = 10.0 }", 9.25, 9.25),
    ] {
        let scene = text("hertz").replacen("{ form = \"plane\", height = 10.0 }", form, 1);
        let case = Case::new(&SceneFile::parse(&scene, "x").unwrap(), scratch).unwrap();
        let start = case.start.unwrap();
        assert_eq!(start.len(), 36);
        assert!((start[0] - first).abs() < 1e-12 && (start[35] - last).abs() < 1e-12, "{start:?}");
    }
    for (bad, word) in
        [("1,2\n3\n", "line 2"), ("1,x\n", "line 1, column 2 = \"x\""), ("", "2 to 2000"), ("1,inf\n2,3\n", "finite")]
    {
        std::fs::write(scratch.join("start.csv"), bad).unwrap();
        let form = "{ form = \"grid\", file = \"start.csv\" }";
        let scene = text("hertz").replacen("{ form = \"plane\", height = 10.0 }", form, 1);
        let message = Case::new(&SceneFile::parse(&scene, "x").unwrap(), scratch).unwrap_err().to_string();
        assert!(message.contains(word) && message.contains("start.csv"), "{message}");
    }
}

/// The schema is the documentation: every field says what it means, every number its unit and its range.
#[test]
fn every_field_is_documented_with_unit_and_range() {
    fn walk(place: &str, schema: &Value, visited: &mut usize) {
        let Some(fields) = schema["properties"].as_object() else { return };
        for (name, field) in fields {
            let place = format!("{place}.{name}");
            let table = ["$ref", "anyOf", "const"].iter().any(|word| field.get(word).is_some());
            assert!(table || field["description"].is_string(), "{place} has no description");
            let entry = field.get("items").unwrap_or(field);
            let numeric = |kind: &Value| kind.to_string().contains("number") || kind.to_string().contains("integer");
            if numeric(&entry["type"]) {
                *visited += 1;
                assert!(field["x-unit"].is_string(), "{place} has no unit");
                let bounds = ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"];
                assert!(bounds.iter().any(|bound| entry.get(bound).is_some()), "{place} has no range");
            }
        }
    }
    let mut visited = 0;
    walk("", schema(), &mut visited);
    for (name, definition) in schema()["$defs"].as_object().unwrap() {
        walk(name, definition, &mut visited);
        for choice in definition["oneOf"].as_array().unwrap_or(&Vec::new()) {
            walk(name, choice, &mut visited);
        }
    }
    assert!(visited >= 30, "{visited} numeric fields");
}

#[test]
fn the_page_of_fields_lists_all_of_them() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/fields.md")).unwrap();
    let fields = field_tables(None).unwrap();
    assert!(page.ends_with(&fields), "docs/fields.md must end with what `contact3d fields` prints:\n{fields}");
}

/// A scene with another section `[objective]`.
fn with_objective(section: &str) -> Result<Case, String> {
    let text = format!("{}\n[objective]\n{section}\n", text("hertz").split("[objective]").next().unwrap());
    let file = SceneFile::parse(&text, "my.toml").map_err(|error| error.to_string())?;
    assert_eq!(SceneFile::parse(&file.print().unwrap(), "printed").unwrap(), file);
    Case::new(&file, &folder()).map_err(|error| error.to_string())
}

#[test]
fn objectives_are_read_or_refused_with_the_field() {
    for section in [
        "quantity = \"pressure-deviation\"\nwanted = { form = \"formula\", pressure = \"100 + x1*x2\" }",
        "quantity = \"pressure-deviation\"\nwanted = { form = \"grid\", file = \"flat_punch.csv\" }",
        "quantity = \"open-area\"\npressure = 3.0",
        "quantity = \"stress-norm\"",
        "quantity = \"stress-norm\"\nexponent = 3.0\nregion = { body = \"upper\", x1 = [0.0, 5.0] }",
        "quantity = \"compliance\"",
        "quantity = \"stress\"\nwithout_held = true",
        "quantity = \"displacement\"\naxis = \"x3\"\nregion = { face = \"top\" }",
        "quantity = \"volume\"",
        "quantity = \"mean-pressure\"\ncontact = 0",
        "quantity = \"contact-moment\"\naxis = \"x1\"\nabout = [1.0, 2.0, 3.0]",
        "quantity = \"reaction\"\nregion = { face = \"x1-min\", body = \"lower\" }",
        "quantity = \"loaded-area\"\npressure = 10.0",
        "quantity = \"displacement\"\nrelative_to = { face = \"bottom\", body = \"lower\" }",
    ] {
        let case = with_objective(section).expect(section);
        let has_model = ["pressure-", "open-area", "volume", "mass"].iter().any(|name| section.contains(name));
        let expected = if has_model { MethodName::Composite } else { MethodName::Bundle };
        assert_eq!(case.method, expected, "{section}");
    }
    for (section, words) in [
        ("quantity = \"pressure-deviation\"", ["objective.wanted = missing", "form = \"formula\""]),
        ("quantity = \"open-area\"", ["objective.pressure = missing", "MPa"]),
        ("quantity = \"open-area\"\npressure = 0.0", ["objective.pressure = 0.0", "> 0"]),
        ("quantity = \"peak-pressure\"\nweight = \"nodes\"", ["objective.weight = nodes", "pressure-norm"]),
        ("weight = \"edges\"", ["objective.weight = \"edges\"", "\"area\", \"nodes\""]),
        ("quantity = \"compliance\"\nexponent = 3.0", ["objective.exponent = 3", "stress-norm"]),
        ("quantity = \"stress-norm\"\npressure = 3.0", ["objective.pressure = 3", "open-area, loaded-area"]),
        (
            "quantity = \"peak-pressure\"\nregion = { x1 = [0.0, 1.0] }",
            ["objective.region", "only with stress, stress-norm, displacement"],
        ),
        ("quantity = \"closed-area\"", ["objective.quantity = closed-area", "loaded-area or open-area"]),
        ("quantity = \"slip\"\naxis = \"x1\"", ["objective.axis = x1", "displacement, contact-force"]),
        ("quantity = \"stress-norm\"\nregion = { x2 = [3.0, 1.0] }", ["objective.region.x2 = [3, 1]", "smaller"]),
        ("quantity = \"stress-norm\"\nregion = { x4 = [3.0, 1.0] }", ["objective.region.x4", "allowed: body, x1"]),
        ("quantity = \"stress-norm\"\nregion = { body = \"both\" }", ["objective.region.body = \"both\"", "\"lower\""]),
        (
            "quantity = \"pressure-deviation\"\nwanted = { form = \"formula\", pressure = \"1/(x1 - 5)\" }",
            ["inf at x1 = 5, x2 = 0, x3 = 10 mm", "objective.wanted.pressure"],
        ),
        (
            "quantity = \"pressure-deviation\"\nwanted = { form = \"formula\", pressure = \"x1 + y\" }",
            ["objective.wanted.pressure = \"y\" at character 6", "names x1, x2, x3"],
        ),
        (
            "quantity = \"pressure-deviation\"\nwanted = { form = \"grid\", file = \"none.csv\" }",
            ["none.csv", "No such file"],
        ),
        (
            "quantity = \"stress\"\n[optimizer]\nmethod = \"composite\"",
            ["optimizer.method = composite", "allowed: \"bundle\" with this objective"],
        ),
    ] {
        let refusal = with_objective(section).expect_err(section);
        assert!(words.iter().all(|word| refusal.contains(word)), "{section}: {refusal}");
    }
}

/// The scenes of the published numbers say what they sum; other scenes integrate.
#[test]
fn a_norm_counts_nodes_by_their_area_unless_the_scene_says_nodes() {
    let weight = |case: Case| match case.objective {
        Quantity::Pressure(PressureMeasure::Norm { exponent, weight }) => (exponent, weight),
        other => panic!("{other:?}"),
    };
    assert_eq!(weight(with_objective("").unwrap()), (4.0, NodeWeight::Area));
    assert_eq!(weight(with_objective("weight = \"nodes\"\nexponent = 8.0").unwrap()), (8.0, NodeWeight::Nodes));
    for name in ["hertz", "signorini", "signorini_frictionless", "jack_seat", "flat_punch", "tangential"] {
        let file = SceneFile::parse(&text(name), name).unwrap();
        assert_eq!(weight(Case::new(&file, &folder()).unwrap()), (4.0, NodeWeight::Nodes), "{name}");
    }
}

/// Accuracy on demand is relative to Θ: a wanted pressure that is met has Θ = 0.
#[test]
fn accuracy_on_demand_is_refused_where_the_objective_can_vanish() {
    for objective in [
        "quantity = \"pressure-deviation\"\nwanted = { form = \"formula\", pressure = \"100\" }",
        "quantity = \"open-area\"\npressure = 3.0",
        "quantity = \"compliance\"",
        "quantity = \"displacement\"\naxis = \"x3\"\nregion = { face = \"top\" }",
    ] {
        let case = |accuracy: &str| with_objective(&format!("{objective}\n[optimizer]\naccuracy = \"{accuracy}\""));
        assert!(case("tightest").is_ok(), "{objective}");
        let refusal = case("on-demand").expect_err(objective);
        for words in ["optimizer.accuracy = on-demand", "allowed: \"tightest\"", "can reach or cross 0"] {
            assert!(refusal.contains(words), "{objective}: {refusal}");
        }
    }
    for objective in ["quantity = \"pressure-norm\"", "quantity = \"peak-pressure\"", "quantity = \"stress-norm\""] {
        with_objective(&format!("{objective}\n[optimizer]\naccuracy = \"on-demand\"")).expect(objective);
    }
}
