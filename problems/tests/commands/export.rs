//! `export`: files read back by readers of their own, shapes from runs, and what is refused.

use contact::contact_shape::{ContactShape, SolverKind};
use contact::scene::{BodyScene, Scene, hertz, signorini};
use contact::shape::LatticeShape;
use serde_json::{Value, json};
use std::path::Path;
use testset::kit::step_file::{Surface, entities};
use testset::kit::stl_file::{edges, triangles, volume};
use testset::kit::{self, read_json, read_rows, scratch, text};

const HERTZ: &str = env!("CARGO_BIN_EXE_hertz3d");
const SIGNORINI: &str = env!("CARGO_BIN_EXE_signorini3d");
const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

/// Controls that are not flat, inside the admissible set.
fn uneven(scene: &Scene) -> Vec<f64> {
    let start = scene.start().into_iter().enumerate();
    start.map(|(index, height)| height * (0.985 + 0.01 * (1.7 * index as f64).sin())).collect()
}

fn surface_of(scene: &Scene) -> &LatticeShape {
    scene.heights().unwrap()
}

fn size(scene: &Scene) -> [f64; 2] {
    scene.bodies[0].block().unwrap().size
}

/// The height of the surface at a place, mm: basis functions by Cox and de Boor's recursion on the knots 0 … 1.
fn height(scene: &Scene, controls: &[f64], place: [f64; 2]) -> f64 {
    fn basis(knots: &[f64], degree: usize, index: usize, t: f64) -> f64 {
        if degree == 0 {
            let last = knots[index + 1] == 1.0 && t == 1.0;
            return f64::from(u8::from((knots[index] <= t && t < knots[index + 1]) || (last && knots[index] < 1.0)));
        }
        let ratio = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let (left, right) = (knots[index], knots[index + degree + 1]);
        ratio(t - left, knots[index + degree] - left) * basis(knots, degree - 1, index, t)
            + ratio(right - t, right - knots[index + 1]) * basis(knots, degree - 1, index + 1, t)
    }
    let along = |axis: usize| -> Vec<f64> {
        let count = surface_of(scene).control_points[axis];
        let degree = surface_of(scene).degrees[axis];
        let spans = (count - degree) as f64;
        let knot = |index: usize| index.clamp(degree, count).saturating_sub(degree) as f64 / spans;
        let knots: Vec<f64> = (0..count + degree + 1).map(knot).collect();
        (0..count).map(|index| basis(&knots, degree, index, place[axis] / size(scene)[axis])).collect()
    };
    let (first, second) = (along(0), along(1));
    let row = |i: usize| -> f64 { second.iter().zip(&controls[i * second.len()..]).map(|(b, c)| b * c).sum() };
    first.iter().enumerate().map(|(i, a)| a * row(i)).sum()
}

#[test]
fn the_files_hold_the_surface_and_the_bodies() {
    let cases = [
        (HERTZ, hertz().unwrap(), vec![]),
        (SIGNORINI, signorini().unwrap().with_shapes(|heights| heights.degrees = [5, 5, 1]), vec!["--degrees", "5"]),
        (HERTZ, hertz().unwrap().with_shapes(|heights| heights.degrees = [1; 3]), vec!["--degrees", "1"]),
    ];
    for (program, scene, options) in cases {
        let folder = scratch();
        let (file, out) = (folder.path().join("c.json"), folder.path().join("out"));
        let controls = uneven(&scene);
        std::fs::write(&file, json!(controls).to_string()).unwrap();
        let command = ["export", "--json", "--controls", text(&file), "--out", text(&out)];
        let printed = kit::json(program, &[&command, &options[..]].concat());
        assert_eq!(read_rows(&out.join("controls.json")), json!(controls));
        let names: Vec<&str> =
            printed["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
        let upper = scene.bodies.get(1).map(|_| "upper_body.stl");
        let expected = [
            &["controls.json", "surface.stl", "lower_body.stl"][..],
            upper.as_slice(),
            &["surface.step", "lower_body.step", "surface.csv", "change.csv"],
        ];
        assert_eq!(names, expected.concat());
        check_triangles(&out, &scene, &controls);
        for name in ["surface.step", "lower_body.step"] {
            let surface = Surface::of(&entities(&std::fs::read_to_string(out.join(name)).unwrap()));
            let mut largest = 0.0_f64;
            for index in 0..1000_u32 {
                let places = [0.618_034, 0.754_878].map(|step| (f64::from(index) * step).fract());
                let [x1, x2, x3] = surface.at(places);
                let place = [size(&scene)[0] * places[0], size(&scene)[1] * places[1]];
                let distance = (x1 - place[0]).abs().max((x2 - place[1]).abs());
                largest = largest.max(distance).max((x3 - height(&scene, &controls, place)).abs());
            }
            // Rounding of sums of heights of 100 mm.
            assert!(largest < 2e-13 * size(&scene)[0].max(surface_of(&scene).start), "{name}: {largest} mm");
        }
        check_table(&out, &scene, &controls);
    }
}

/// Closed bodies of the right volume, and a contact face whose corners lie on the surface.
fn check_triangles(out: &Path, scene: &Scene, controls: &[f64]) {
    let read = |name: &str| triangles(&std::fs::read(out.join(name)).unwrap());
    let (surface, lower) = (read("surface.stl"), read("lower_body.stl"));
    assert_eq!(edges(&lower).1, 0, "the lower body is closed");
    let block = scene.bodies[0].block().unwrap();
    assert_eq!(surface.len(), 2 * block.bricks[0] * block.bricks[1]);
    for point in surface.iter().flatten().map(|point| point.map(f64::from)) {
        // Single precision, on slopes below 5 %.
        let off = (point[2] - height(scene, controls, [point[0], point[1]])).abs();
        assert!(off < 2e-7 * point[2], "{off} mm at {point:?}");
    }
    let base = size(scene)[0] * size(scene)[1];
    let mean: f64 = surface_of(scene).surface().unwrap().integrals().iter().zip(controls).map(|(a, b)| a * b).sum();
    // The facets are off by h²/8 times the curvature.
    let off = 1e-3 * mean;
    assert!((volume(&lower) - base * mean).abs() <= off * base, "{} {}", volume(&lower), base * mean);
    if let Some(upper) = scene.bodies.get(1).and_then(BodyScene::block) {
        let body = read("upper_body.stl");
        assert_eq!(edges(&body).1, 0, "the upper body is closed");
        // The mean height of the sphere by the midpoint rule.
        let places = (0..400 * 400).map(|index| [index / 400, index % 400].map(|i| (f64::from(i) + 0.5) / 400.0));
        let sum: f64 = places.map(|[s, t]| upper.bottom.height(size(scene)[0] * s, size(scene)[1] * t)).sum();
        let expected = base * (upper.top.height(0.0, 0.0) - sum / 160_000.0);
        assert!((volume(&body) - expected).abs() <= off * base, "{} {expected}", volume(&body));
    }
}

fn check_table(out: &Path, scene: &Scene, controls: &[f64]) {
    let table = std::fs::read_to_string(out.join("surface.csv")).unwrap();
    assert!(table.contains("101 x 101 points") && table.contains("spacing"), "{}", &table[..200]);
    let rows: Vec<[f64; 3]> = table
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        .map(|line| line.split(',').map(|number| number.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap())
        .collect();
    assert_eq!(rows.len(), 101 * 101);
    assert_eq!([rows[0][0], rows[0][1], rows[10_200][0], rows[10_200][1]], [0.0, 0.0, size(scene)[0], size(scene)[1]]);
    for [x1, x2, x3] in rows.into_iter().step_by(37) {
        assert!((x3 - height(scene, controls, [x1, x2])).abs() < 1e-12 * x3, "({x1}, {x2})");
    }
}

/// A journal whose points have lost their last entry.
fn shortened(journal: &str) -> String {
    let line = |line: &str| {
        let mut line: Value = serde_json::from_str(line).unwrap();
        match line.get_mut("point").and_then(Value::as_array_mut) {
            Some(point) => drop(point.pop()),
            None => line["dimension"] = json!(35),
        }
        format!("{line}\n")
    };
    journal.lines().map(line).collect()
}

#[test]
fn shapes_come_from_runs_by_their_optimum_or_any_evaluation() {
    let folder = scratch();
    let at = |name: &str| folder.path().join(name);
    let run = at("run");
    let report = kit::json(SIGNORINI, &["--mesh", "4", "--max-evaluations", "6", "--json", "--out", text(&run)]);
    let export = |name: &str, options: &[&str]| {
        let out = at(name);
        let command = ["export", "--csv", "--json", "--mesh", "4", "--out", text(&out)];
        (kit::json(SIGNORINI, &[&command, options].concat()), read_rows(&out.join("controls.json")))
    };
    let (optimum, controls) = export("optimum", &["--run", text(&run)]);
    assert_eq!((&controls, &optimum["shape"]["objective"]), (&report["controls"], &report["objective"]));
    // The best evaluation is the optimum; that of the start is flat. Both shapes begin an optimization.
    let course = report["course"].as_array().unwrap();
    let best = course.iter().find(|entry| entry["objective"] == report["objective"]).unwrap();
    let (evaluation, found) = export("best", &["--run", text(&run), "--evaluation", &best["evaluation"].to_string()]);
    assert_eq!((&found, &evaluation["shape"]["evaluation"]), (&controls, &best["evaluation"]));
    assert_eq!(export("first", &["--run", text(&run), "--evaluation", "1"]).1, json!([100.0; 36].to_vec()));
    let file = at("best").join("controls.json");
    let begun =
        kit::json(SIGNORINI, &["--mesh", "4", "--max-evaluations", "1", "--json", "--start-controls", text(&file)]);
    assert!((begun["objective"].as_f64().unwrap() / report["objective"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    // A run that has not ended: the best of its journal.
    std::fs::remove_file(run.join("report.json")).unwrap();
    let (unended, found) = export("unended", &["--run", text(&run)]);
    assert_eq!((&found, &unended["shape"]["evaluation"]), (&controls, &best["evaluation"]));
    assert!(unended["shape"]["source"].as_str().unwrap().contains("has not ended"), "{unended}");
    let refused = |options: &[&str], words: &[&str]| {
        let out = at("refused");
        let command = ["export", "--out", text(&out), "--run", text(&run)];
        kit::refused(SIGNORINI, &[&command, options].concat(), words);
        assert!(!out.exists());
    };
    refused(&["--evaluation", "7"], &["--evaluation = 7", "1 to 6, the evaluations in"]);
    refused(&["--evaluation", "0"], &["--evaluation = 0", "1 to 6"]);
    refused(
        &["--control-points", "5x5"],
        &[
            "--run",
            "another surface: body[0].lattice.control_points is [6,6] in the run and [5,5] here",
            "scene.toml export",
        ],
    );
    refused(&["--controls", text(&file)], &["--controls is allowed without --run"]);
    // A journal that was tampered with: points without their last entry.
    let journal = std::fs::read_to_string(run.join("journal.jsonl")).unwrap();
    std::fs::write(run.join("journal.jsonl"), shortened(&journal)).unwrap();
    refused(&["--evaluation", "1"], &["controls of evaluation 1", "35 numbers found, 36 expected"]);
    std::fs::write(run.join("journal.jsonl"), journal).unwrap();
    kit::refused(HERTZ, &["export", "--run", text(&run), "--out", text(&at("other"))], &["another surface: "]);
    kit::refused(
        SIGNORINI,
        &["export", "--run", text(folder.path()), "--out", text(&at("none"))],
        &["holds no optimization"],
    );
}

#[test]
fn a_part_of_a_run_is_named_where_it_has_several() {
    let folder = scratch();
    let at = |name: &str| folder.path().join(name);
    let (meshes, compared, out) = (at("meshes"), at("compared"), at("out"));
    let report =
        kit::json(SIGNORINI, &["--continuation", "2,4", "--max-evaluations", "3", "--json", "--out", text(&meshes)]);
    let export = |run: &Path, options: &[&str]| -> Value {
        let command = ["export", "--csv", "--json", "--overwrite", "--out", text(&out), "--run", text(run)];
        kit::json(SIGNORINI, &[&command, options].concat());
        read_rows(&out.join("controls.json"))
    };
    assert_eq!(export(&meshes, &[]), report["controls"]);
    let words = ["--evaluation is allowed for one mesh or one start", "stage_2 or --run", "stage_4"];
    kit::refused(SIGNORINI, &["export", "--out", text(&at("x")), "--run", text(&meshes), "--evaluation", "1"], &words);
    assert_eq!(export(&meshes.join("stage_2"), &["--evaluation", "1"]), json!([100.0; 36].to_vec()));
    // The best of the last mesh is what the run reports.
    assert_eq!(export(&meshes.join("stage_4"), &[]), report["controls"]);
    kit::run(SIGNORINI, &["compare", "--mesh", "2", "--max-evaluations", "2", "--out", text(&compared)]);
    let words = ["holds a comparison", "with_friction or", "without_friction"];
    kit::refused(SIGNORINI, &["export", "--out", text(&at("x")), "--run", text(&compared)], &words);
    assert_eq!(export(&compared.join("with_friction"), &["--evaluation", "1"]), json!([100.0; 36].to_vec()));
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    let folder = scratch();
    let out = folder.path().join("out");
    let out = text(&out);
    for (options, words) in [
        (&["export"][..], &["export needs --out DIR"][..]),
        (&["evaluate", "--stl"], &["--stl is allowed with export only"]),
        (&["--run", "x"], &["--run is allowed with tolerance and export only"]),
        (&["evaluate", "--friction-problem"], &["--friction-problem is allowed with export only"]),
        (&["export", "--out", out, "--evaluation", "1"], &["--run"]),
        (&["export", "--out", out, "--resume", "x"], &["--resume is allowed with optimize, compare and study only"]),
        (&["export", "--out", out, "--diagnose"], &["--diagnose is allowed with evaluate only"]),
        (&["export", "--out", out, "--controls", "none.json"], &["--controls: none.json"]),
        (&["export", "--out", out, "--mesh", "60", "--friction-problem"], &["--mesh = [60, 60, 60]", "at most 300000"]),
        (&["--vtk-history"], &["--vtk-history is allowed with --out or --resume only"]),
        (&["evaluate", "--vtk-history", "--out", out], &["--vtk-history is allowed with optimize only"]),
    ] {
        kit::refused(SIGNORINI, options, words);
        assert!(!Path::new(out).exists(), "{options:?}");
    }
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/flat_punch.toml");
    kit::json(CONTACT, &[scene, "export", "--json", "--overwrite", "--out", out]);
}

/// (row, column, value), counted from 0.
type Entries = Vec<(usize, usize, f64)>;

fn matrix(path: &Path) -> ([usize; 2], Entries) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('%'));
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').map(|number| number.parse().unwrap()).collect() };
    let head = numbers(lines.next().unwrap());
    let entries: Entries =
        lines.map(numbers).map(|line| (line[0] as usize - 1, line[1] as usize - 1, line[2])).collect();
    assert_eq!(entries.len(), head[2] as usize);
    ([head[0] as usize, head[1] as usize], entries)
}

#[test]
fn matrices_balance_the_forces_of_the_program() {
    let folder = scratch();
    let out = folder.path().join("out");
    let options = ["--mesh", "4", "--out", text(&out), "--json"];
    kit::json(HERTZ, &[&["export", "--friction-problem"], &options[..]].concat());
    assert!(!out.join("surface.stl").exists(), "a format that is named stands alone");
    let friction = out.join("friction");
    let (sizes, stiffness) = matrix(&friction.join("stiffness.mtx"));
    let (contact_sizes, contact) = matrix(&friction.join("contact.mtx"));
    let lists = read_json(&friction.join("problem.json"));
    let numbers = |key: &str| -> Vec<f64> { serde_json::from_value(lists[key].clone()).unwrap() };
    let unknowns: Vec<[usize; 3]> = serde_json::from_value(lists["unknowns"].clone()).unwrap();
    assert_eq!((sizes, contact_sizes), ([unknowns.len(); 2], [75, unknowns.len()]));
    let scene = hertz().unwrap().with_bricks([4; 3], [2; 3]);
    let shape = ContactShape::new(scene, SolverKind::Direct).unwrap();
    let control = shape.start();
    let state = nonsmooth::StateSolver::solve(&shape, &control, None, nonsmooth::Accuracy::TIGHTEST).unwrap();
    let bodies = shape.fields(&state).unwrap().bodies;
    let u: Vec<f64> = unknowns.iter().map(|&[body, node, axis]| bodies[body].displacement[node][axis]).collect();
    let tangents: Vec<[[f64; 3]; 2]> = serde_json::from_value(lists["tangents"].clone()).unwrap();
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let forces = state.forces.normal.iter().zip(&state.forces.tangential).zip(&tangents);
    let rows = |((normal, tangential), [first, second]): ((&f64, &[f64; 3]), &[[f64; 3]; 2])| {
        [*normal, dot(*first, *tangential), dot(*second, *tangential)]
    };
    let r: Vec<f64> = forces.flat_map(rows).collect();
    let mut rest: Vec<f64> = numbers("load").iter().map(|force| -force).collect();
    for (row, column, value) in stiffness {
        rest[row] += value * u[column];
        if row != column {
            rest[column] += value * u[row];
        }
    }
    contact.iter().for_each(|(row, column, value)| rest[*column] -= value * r[*row]);
    let largest = rest.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
    assert!(largest < 1e-10 * state.forces.total_normal_force(), "{largest} N");
    assert_eq!(numbers("friction"), [0.3; 25]);
    assert!((numbers("areas").iter().sum::<f64>() - 100.0).abs() < 1e-12);
}

#[test]
fn a_friction_problem_that_is_not_that_of_the_run_says_so() {
    let folder = scratch();
    let run = folder.path().join("run");
    kit::json(
        SIGNORINI,
        &["--mesh", "3", "--friction", "0.1", "--max-evaluations", "2", "--json", "--out", text(&run)],
    );
    let differences = |name: &str, options: &[&str]| {
        let out = folder.path().join(name);
        let command = ["export", "--run", text(&run), "--mesh", "3", "--json", "--out", text(&out)];
        kit::json(SIGNORINI, &[&command, options].concat())["differences"].clone()
    };
    assert_eq!(differences("other", &["--friction-problem"])[0], "friction is 0.1 in the run and 0.3 here");
    assert_eq!(differences("same", &["--friction-problem", "--friction", "0.1", "--subdomains", "3"]), Value::Null);
    assert_eq!(differences("surface", &["--step", "--degrees", "3"]), Value::Null);
    // The optimum of a coarse-to-fine run belongs to its last mesh.
    let run = folder.path().join("growing");
    kit::json(SIGNORINI, &["--continuation", "2,4", "--max-evaluations", "2", "--json", "--out", text(&run)]);
    let mesh = |run: &Path, name: &str| {
        let command = ["export", "--run", text(run), "--mesh", "2", "--friction-problem", "--json", "--out"];
        kit::json(SIGNORINI, &[&command[..], &[text(&folder.path().join(name))]].concat())["differences"].clone()
    };
    assert_eq!(mesh(&run, "last")[0], "body[0].block.bricks is [4,4,4] in the run and [2,2,2] here");
    assert_eq!(mesh(&run.join("stage_2"), "first"), Value::Null);
}

#[test]
fn the_history_has_every_serious_step() {
    let folder = scratch();
    let out = folder.path().join("run");
    let history = || std::fs::read_to_string(out.join("vtk/history.pvd")).unwrap();
    let begin = ["--mesh", "3", "--vtk-history", "--max-evaluations", "4", "--json", "--out", text(&out)];
    kit::json(SIGNORINI, &begin);
    let begun = history();
    let resumed = kit::json(SIGNORINI, &["--resume", text(&out), "--vtk-history", "--max-evaluations", "8", "--json"]);
    let course = resumed["course"].as_array().unwrap();
    let steps: Vec<&Value> = course
        .iter()
        .filter(|entry| ["start", "serious"].contains(&entry["kind"].as_str().unwrap().to_lowercase().as_str()))
        .collect();
    assert!(steps.len() > 2, "{course:?}");
    let list = history();
    assert!(list.starts_with(begun.strip_suffix("</Collection>\n</VTKFile>\n").unwrap()), "the series goes on");
    let document = roxmltree::Document::parse(&list).unwrap();
    let sets: Vec<[&str; 3]> = document
        .descendants()
        .filter(|node| node.has_tag_name("DataSet"))
        .map(|set| ["timestep", "name", "file"].map(|name| set.attribute(name).unwrap()))
        .collect();
    assert_eq!(sets.len(), 2 * steps.len());
    for (index, [time, name, file]) in sets.into_iter().enumerate() {
        let step = steps[index / 2];
        assert_eq!((time, name), (step["evaluation"].to_string().as_str(), ["bodies", "contact"][index % 2]));
        let grid = std::fs::read_to_string(out.join("vtk").join(file)).unwrap();
        let grid = roxmltree::Document::parse(&grid).unwrap();
        let note = |name: &str| {
            let array = grid.descendants().find(|node| node.attribute("Name") == Some(name)).unwrap();
            array.text().unwrap().to_owned()
        };
        assert_eq!(note("evaluation"), time);
        let (objective, expected): (f64, f64) =
            (note("objective").parse().unwrap(), step["objective"].as_f64().unwrap());
        assert!((objective / expected - 1.0).abs() < 1e-8, "{objective} {expected}");
    }
    assert!(out.join("vtk/view.py").exists() && out.join("vtk/fields.pvd").exists());
}
