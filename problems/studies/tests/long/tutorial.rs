//! The numbers of docs/tutorial_seat.md are those of today's build.

use problems::commands::{Arguments, execute};
use scene_file::SceneFile;
use serde_json::Value;
use std::path::Path;
use testset::kit::{scratch, text};

/// Relative difference allowed for printed pressures; the run to the optimum may end elsewhere on other processors.
const PEAKS: f64 = 0.02;

fn seat(options: &[&str]) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/jack_seat.toml");
    let arguments = Arguments::try_parse_from([&["contact3d"], options, &["--json"]].concat()).unwrap();
    let open = || Ok((SceneFile::read(&path)?, Some(path.clone())));
    serde_json::from_str(&execute(open, &arguments).unwrap()).unwrap()
}

fn peaks(study: &Value) -> Vec<f64> {
    let rows = study["rows"].as_array().unwrap();
    rows.iter().map(|row| row["solved"]["peak_pressure"].as_f64().unwrap()).collect()
}

/// The page says these peaks, in MPa.
fn compare(found: &[f64], page: &[f64]) {
    assert_eq!(found.len(), page.len());
    for (found, page) in found.iter().zip(page) {
        assert!((found / page - 1.0).abs() < PEAKS, "{found} MPa, on the page {page}");
    }
}

#[test]
fn the_seat_is_what_the_tutorial_says() {
    compare(&peaks(&seat(&["study", "--vary", "mesh=6,12,18,24"])), &[907.0, 987.7, 990.0, 992.2]);
    let folder = scratch();
    let out = folder.path().join("seat");
    let run = seat(&["--out", text(&out)]);
    assert!(run["termination"]["confirmed"] == true && run["warnings"].as_array().unwrap().is_empty(), "{run}");
    assert!((40..=60).contains(&run["all_evaluations"].as_u64().unwrap()), "{}", run["all_evaluations"]);
    let controls = out.join("controls.json");
    let study = |vary: &[&str]| peaks(&seat(&[&["study", "--controls", text(&controls)], vary].concat()));
    compare(&study(&["--vary", "mesh=12,18,24"]), &[67.9, 82.2, 97.3]);
    let loads = study(&["--vary", "friction=0,0.15,0.3", "--vary", "load-factor=0.5,1,1.5"]);
    compare(&loads, &[41.3, 69.7, 95.5, 39.7, 67.9, 94.0, 39.9, 67.6, 93.8]);
    let worst = study(&["--height-error", "0.01", "--seed", "6", "--vary", "mesh=12,18,24"]);
    compare(&worst, &[449.0, 611.1, 731.0]);
    let off = study(&["--vary", "height-error=0.005,0.01,0.02", "--vary", "seed=1:10:10"]);
    let ends = off.chunks(10).flat_map(|peaks| {
        [peaks.iter().copied().fold(f64::INFINITY, f64::min), peaks.iter().copied().fold(0.0, f64::max)]
    });
    compare(&ends.collect::<Vec<_>>(), &[115.9, 255.9, 187.3, 449.0, 288.0, 735.8]);
}
