//! The stages that a state and its subgradient tell a listener.

use contact::contact_shape::SolverKind;
use contact::solvers::Processes;
use nonsmooth::{Accuracy, StateSolver};
use problems::commands::StageLayer;
use problems::commands::objective;
use scene_file::{Case, SceneFile};
use std::path::Path;
use std::sync::{Arc, Mutex};
use tracing_subscriber::layer::SubscriberExt;

/// What a listener hears of one state with its subgradient.
fn heard(solver: SolverKind) -> Vec<String> {
    let mut file = SceneFile::parse(include_str!("../../scenes/signorini.toml"), "signorini.toml").unwrap();
    file.body[0].block.as_mut().unwrap().bricks = [4; 3];
    let mut case = Case::new(&file, Path::new("")).unwrap();
    case.solver = solver;
    let theta = objective(&case, &Processes::alone()).unwrap();
    let words = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&words);
    let layer = StageLayer(move |stage| sink.lock().unwrap().push(stage));
    tracing::subscriber::with_default(tracing_subscriber::registry().with(layer), || {
        let start = theta.solver().start();
        let state = theta.cases().solve(&start, None, Accuracy::TIGHTEST).unwrap();
        theta.differentiate(&start, &state).unwrap();
    });
    let words = words.lock().unwrap();
    words.clone()
}

/// The stages without the steps of their iterations.
fn entered(words: &[String]) -> Vec<&str> {
    words.iter().map(String::as_str).filter(|word| !word.contains(',')).collect()
}

#[test]
fn every_solver_tells_its_stages_in_order_and_the_residual_of_every_step() {
    let torn = ["equilibrium", "factorization", "coarse space", "contact", "recovery", "adjoint", "shape derivative"];
    for solver in [SolverKind::Newton, SolverKind::AugmentedLagrangian] {
        assert_eq!(entered(&heard(solver)), torn, "{solver:?}");
    }
    let condensed = ["equilibrium", "factorization", "contact", "adjoint", "shape derivative"];
    let words = heard(SolverKind::Direct);
    assert_eq!(entered(&words), condensed);
    let steps: Vec<&String> = words.iter().filter(|word| word.starts_with("contact, step ")).collect();
    assert!(steps.len() >= 3, "{words:?}");
    let residual = |word: &String| word.split("residual ").nth(1).unwrap().parse::<f64>().unwrap();
    assert!(residual(steps[steps.len() - 1]) < 1e-9 && residual(steps[0]) > 1e-9, "{steps:?}");
}
