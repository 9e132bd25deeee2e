//! The runs of an optimization: attempts, and meshes of blocks and of files.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use scene_file::optimization::{Attempt, MeshName, Part, PlannedRun, optimize, stages};
use scene_file::{Case, ContinuationMesh, SceneFile};
use std::path::{Path, PathBuf};

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes")
}

fn scene(name: &str) -> SceneFile {
    SceneFile::read(&scenes().join(name)).unwrap()
}

fn parts(case: &Case) -> Vec<Part> {
    stages(case).iter().map(|stage| stage.part).collect()
}

fn files(names: &[&str]) -> Vec<ContinuationMesh> {
    names.iter().map(|name| ContinuationMesh::File((*name).to_owned())).collect()
}

#[test]
fn meshes_of_blocks_keep_their_proportions() {
    let mut case = Case::new(&scene("thin_layer.toml"), &scenes()).unwrap();
    let [direct, coarse, refined] = [Attempt::Direct, Attempt::Coarse, Attempt::Refined].map(Part::Try);
    assert_eq!(parts(&case), [direct, coarse, refined, Part::Whole, Part::Fair]);
    case.optimizer.single = true;
    assert_eq!(parts(&case), [Part::Whole]);
    case.optimizer.continuation = [6, 12, 25].map(ContinuationMesh::Bricks).to_vec();
    let blocks = |stage: &PlannedRun| stage.case.scene.bodies[0].block().unwrap().clone();
    let meshes: Vec<_> = stages(&case).iter().map(|stage| (blocks(stage).bricks, blocks(stage).subdomains)).collect();
    assert_eq!(meshes, [([6, 6, 2], [2, 2, 1]), ([12, 12, 4], [2, 2, 1]), ([25, 25, 8], [5, 5, 2])]);
}

/// Controls do not depend on the mesh: the second mesh begins where the first has ended.
#[test]
fn controls_go_from_mesh_to_mesh() {
    let mut file = scene("lug_tet10.toml");
    file.body[0].lattice.as_mut().unwrap().bounds_of_box = None;
    file.limit.clear();
    file.optimizer.max_evaluations = 6;
    file.optimizer.continuation = files(&["lug_hex8.msh", "lug_tet10.msh"]);
    let case = Case::new(&file, &scenes()).unwrap();
    assert_eq!(parts(&case), [1, 2].map(|number| Part::Mesh(MeshName::File(number))));
    // One lattice, whatever box lies around a mesh.
    let shape = |case: &Case| case.scene.bodies[0].shape.clone();
    assert!(case.meshes.iter().all(|mesh| shape(mesh) == shape(&case) && shape(mesh).is_some()));
    let runs = optimize(&case).unwrap();
    let [coarse, fine] = &runs.ended[..] else { panic!("{} runs", runs.ended.len()) };
    assert_eq!(fine.stage.start, coarse.report.solution);
    assert_ne!(coarse.report.solution, coarse.stage.start);
    assert!(fine.report.value <= fine.report.start_value && fine.report.is_feasible(), "{}", fine.report);
    // The fine mesh alone, with the evaluations of both: what the coarse one has found is not worse to begin with.
    file.optimizer.continuation = vec![];
    let alone = optimize(&Case::new(&file, &scenes()).unwrap()).unwrap();
    let alone = &alone.chosen().unwrap().report;
    assert!(fine.report.start_value < alone.start_value && fine.report.value <= alone.value, "{alone}");
    assert_eq!(runs.evaluations(), 12);
}

#[test]
fn meshes_that_do_not_fit_the_scene_are_refused() {
    let refused = |name: &str, meshes: Vec<ContinuationMesh>, words: &[&str]| {
        let mut file = scene(name);
        file.optimizer.continuation = meshes;
        let error = Case::new(&file, &scenes()).unwrap_err().to_string();
        assert!(words.iter().all(|words| error.contains(words)), "{error}");
    };
    let bricks = || ContinuationMesh::Bricks(4);
    refused("lug_tet10.toml", vec![bricks()], &["optimizer.continuation = [4]", "files of meshes"]);
    refused(
        "thin_layer.toml",
        files(&["a.msh"]),
        &["optimizer.continuation = [\"a.msh\"]", "no body of the scene is a mesh"],
    );
    refused("taper.toml", files(&["a.msh"]), &["2 bodies that are meshes"]);
    refused("lug_tet10.toml", [files(&["lug_hex8.msh"]), vec![bricks()]].concat(), &["bricks alone", "files alone"]);
    refused("lug_tet10.toml", files(&["lug_hex8.msh", "none.msh"]), &["none.msh"]);
    let other = ["optimizer.continuation[0] = \"bracket.msh\"", "\"top\" in bracket.msh"];
    refused("lug_tet10.toml", files(&["bracket.msh"]), &other);
}
