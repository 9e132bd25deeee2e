//! Random scenes: the default finds an equilibrium wherever any path does, never a wrong one, at a bounded cost.

mod paths;
mod scenes;

use crate::markdown;
use contact::contact_shape::SolverKind;
use paths::{Examined, Found, MAX_RESIDUAL, PathResult};
use rayon::prelude::*;
use scene_file::{Case, SceneFile};
use scenes::Family;
use serde::Serialize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

/// Relative difference of Θ up to which two paths agree.
const MAX_DIFFERENCE: f64 = 1e-6;
/// Two paths may differ by this many times the effect that the rounding of the heights has on Θ.
const MAX_ROUNDINGS: f64 = 10.0;
/// The default may take this many times the operations of the cheapest path, and one factorisation besides.
const MAX_COST: f64 = 3.0;
/// Of so many scenes, one has its cone programs solved although the default has found a state.
const CONE_EVERY: usize = 10;

/// Numbers of scenes by result.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Counts {
    pub scenes: usize,
    /// States that any path returned.
    pub states: usize,
    /// States whose residual, computed anew, is above 1e-8.
    pub wrong: usize,
    /// Scenes on which a path panicked.
    pub panics: usize,
    /// Scenes that any path solves.
    pub solvable: usize,
    /// Scenes that the default solves.
    pub solved: usize,
    /// Scenes without friction that any path solves.
    pub frictionless_solvable: usize,
    /// Scenes without friction that the default solves.
    pub frictionless_solved: usize,
    /// Scenes on which the default cost more than allowed.
    pub beyond_cost: usize,
    /// Scenes on which two paths differ without a warning that the state may not be unique.
    pub disagreeing: usize,
    /// Scenes that rigid statics refuse.
    pub no_equilibrium: usize,
}

/// The report of a study.
#[derive(Debug, Serialize)]
pub struct RandomReport {
    /// Counts of all scenes.
    #[serde(flatten)]
    pub counts: Counts,
    seconds: f64,
    families: Vec<(String, Counts)>,
    /// Everything that fell short: name, reason, scene file.
    short: Vec<Short>,
}

/// A scene that fell short.
#[derive(Debug, Clone, Serialize)]
pub struct Short {
    /// Number of the scene in the sequence of its seed.
    pub index: usize,
    /// Message about the shortcoming.
    pub reason: String,
    /// Text of the scene file.
    #[serde(skip)]
    pub text: String,
}

impl RandomReport {
    /// Scenes with a shortcoming, each with its reason.
    pub fn short(&self) -> &[Short] {
        &self.short
    }

    /// The table of docs/stability.md.
    pub fn markdown(&self) -> String {
        let all = [("all".to_owned(), self.counts.clone())];
        let rows = self.families.iter().chain(&all).map(|(name, counts)| {
            let Counts { scenes, states, wrong, panics, solvable, solved, beyond_cost, disagreeing, .. } = counts;
            let (frictionless, of) = (counts.frictionless_solved, counts.frictionless_solvable);
            vec![
                name.clone(),
                scenes.to_string(),
                counts.no_equilibrium.to_string(),
                format!("{solved} of {solvable}"),
                format!("{frictionless} of {of}"),
                states.to_string(),
                wrong.to_string(),
                panics.to_string(),
                beyond_cost.to_string(),
                disagreeing.to_string(),
            ]
        });
        let head = "family | scenes | no statics | solved of solvable | without friction | states | wrong | panics | beyond cost | \
                    disagreeing";
        markdown::table(head, rows)
    }
}

struct Examination {
    family: Family,
    frictionless: bool,
    outcome: Result<Paths, String>,
    text: String,
}

/// The paths of one scene.
struct Paths {
    default: PathResult,
    others: Vec<PathResult>,
    cost_bound: f64,
    has_statics: bool,
    rounding: f64,
    smallest: f64,
}

/// Examines scenes 0 … count − 1 of a seed on all threads; the counts do not depend on their number.
pub fn run(seed: u64, count: usize) -> RandomReport {
    let clock = Instant::now();
    let done: Vec<(usize, Examination)> =
        (0..count).into_par_iter().map(|index| (index, examine(seed, index))).collect();
    collect(&done, clock.elapsed().as_secs_f64())
}

fn examine(seed: u64, index: usize) -> Examination {
    let (family, text) = scenes::scene(seed, index);
    let case = SceneFile::parse(&text, "random").and_then(|file| Case::new(&file, Path::new(".")));
    let (frictionless, outcome) = match case {
        Err(error) => (false, Err(format!("no scene: {error}"))),
        Ok(case) => {
            let outcome = catch_unwind(AssertUnwindSafe(|| paths_of(&case, index)));
            (!case.scene.has_friction(), outcome.unwrap_or_else(|_| Err("panic".into())))
        }
    };
    Examination { family, frictionless, outcome, text }
}

fn paths_of(case: &Case, index: usize) -> Result<Paths, String> {
    let examined = Examined::new(case)?;
    let (default, direct) = (examined.by(SolverKind::Auto), examined.by(SolverKind::Direct));
    let cheapest =
        [&default, &direct].into_iter().flatten().map(|found| found.operations).fold(f64::INFINITY, f64::min);
    let mut others = vec![direct];
    if default.is_err() && examined.has_statics() {
        others.push(examined.by(SolverKind::Newton));
    }
    if examined.has_statics() && (default.is_err() || index.is_multiple_of(CONE_EVERY)) {
        others.push(examined.by_cone_programs());
    }
    let differ = default.as_ref().is_ok_and(|found| {
        others.iter().flatten().any(|other| difference(found, other, examined.smallest) > MAX_DIFFERENCE)
    });
    let factorization = examined.estimate.torn_factorization.max(examined.estimate.condensation);
    Ok(Paths {
        default,
        others,
        cost_bound: MAX_COST * cheapest + factorization,
        has_statics: examined.has_statics(),
        rounding: if differ { examined.rounding() } else { 0.0 },
        smallest: examined.smallest,
    })
}

/// Relative difference of Θ.
fn difference(a: &Found, b: &Found, smallest: f64) -> f64 {
    (a.objective - b.objective).abs() / a.objective.abs().max(b.objective.abs()).max(smallest).max(f64::MIN_POSITIVE)
}

fn collect(done: &[(usize, Examination)], seconds: f64) -> RandomReport {
    let mut short = Vec::new();
    let mut counts = Counts::default();
    let mut families = Family::ALL.map(|family| (format!("{family:?}"), Counts::default()));
    for (index, examination) in done {
        let mut add = |reason: String| short.push(Short { index: *index, reason, text: examination.text.clone() });
        let one = count(examination, &mut add);
        let position = Family::ALL.iter().position(|family| *family == examination.family).unwrap_or(0);
        counts.add(&one);
        families[position].1.add(&one);
    }
    RandomReport { counts, seconds, families: families.into(), short }
}

/// The counts of one scene; `short` hears what fell short.
fn count(examination: &Examination, short: &mut impl FnMut(String)) -> Counts {
    let mut counts = Counts { scenes: 1, ..Counts::default() };
    let paths = match &examination.outcome {
        Ok(paths) => paths,
        Err(reason) => {
            counts.panics = usize::from(reason == "panic");
            short(reason.clone());
            return counts;
        }
    };
    let all = || std::iter::once(&paths.default).chain(&paths.others).flatten();
    counts.no_equilibrium = usize::from(!paths.has_statics);
    counts.states = all().count();
    for found in all().filter(|found| found.residual.is_nan() || found.residual > MAX_RESIDUAL) {
        counts.wrong += 1;
        short(format!("wrong: residual {:.1e} by {}", found.residual, found.path));
    }
    let (solvable, solved) = (all().next().is_some(), paths.default.is_ok());
    (counts.solvable, counts.solved) = (usize::from(solvable), usize::from(solved));
    if examination.frictionless {
        (counts.frictionless_solvable, counts.frictionless_solved) = (counts.solvable, counts.solved);
    }
    match &paths.default {
        Err(reason) if solvable => short(format!("not solved: {reason}")),
        Err(reason) if paths.has_statics => short(format!("solved by no path: {reason}")),
        Err(_) => {}
        Ok(found) => {
            if found.operations > paths.cost_bound {
                counts.beyond_cost = 1;
                short(format!("cost {:.1e}, allowed {:.1e}", found.operations, paths.cost_bound));
            }
            let allowed = MAX_DIFFERENCE.max(MAX_ROUNDINGS * paths.rounding);
            let warned = all().any(|found| found.may_not_be_unique);
            let largest =
                paths.others.iter().flatten().map(|other| difference(found, other, paths.smallest)).fold(0.0, f64::max);
            if largest > allowed && !warned {
                counts.disagreeing = 1;
                short(format!("paths differ by {largest:.1e}, allowed {allowed:.1e}"));
            }
        }
    }
    counts
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.scenes += other.scenes;
        self.states += other.states;
        self.wrong += other.wrong;
        self.panics += other.panics;
        self.solvable += other.solvable;
        self.solved += other.solved;
        self.frictionless_solvable += other.frictionless_solvable;
        self.frictionless_solved += other.frictionless_solved;
        self.beyond_cost += other.beyond_cost;
        self.disagreeing += other.disagreeing;
        self.no_equilibrium += other.no_equilibrium;
    }
}
