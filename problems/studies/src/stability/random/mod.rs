//! Random scenes: the default finds an equilibrium wherever any path does, never a wrong one, at a bounded cost.

mod paths;
mod scenes;

use crate::markdown;
use contact::contact_shape::SolverKind;
use paths::{Examined, Found, MAX_RESIDUAL, PathResult};
use rayon::prelude::*;
use scene_file::{Case, SceneFile};
use scenes::Family;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Relative difference of Θ up to which two paths agree.
const MAX_DIFFERENCE: f64 = 1e-6;
/// Two paths may differ by this many times the effect that the rounding of the heights has on Θ.
const MAX_ROUNDINGS: f64 = 10.0;
/// The default may take this many times the operations of the cheapest path, and one factorisation besides.
const MAX_COST: f64 = 3.0;
/// Of so many scenes, one has its cone programs solved although the default has found a state.
const CONE_EVERY: usize = 10;

/// What was found out about a scene.
#[derive(Debug, Default)]
struct Findings {
    frictionless: bool,
    /// Whether a path panicked.
    panicked: bool,
    /// Whether rigid statics refuse it.
    no_equilibrium: bool,
    /// States that any path returned.
    states: usize,
    /// States whose residual, computed anew, is above 1e-8.
    wrong: usize,
    /// Whether the default solves it.
    solved: bool,
    /// Whether the default cost more than allowed.
    beyond_cost: bool,
    /// Whether two paths differ without a warning that the state may not be unique.
    disagreeing: bool,
    /// What fell short.
    short: Vec<String>,
}

/// Numbers of scenes by result.
pub type Counts = BTreeMap<&'static str, usize>;

/// What is counted of a scene.
type Count = fn(&Findings) -> usize;
/// The columns of the table.
const COUNTS: [(&str, Count); 11] = [
    ("scenes", |_| 1),
    ("no statics", |scene| scene.no_equilibrium.into()),
    ("solvable", |scene| usize::from(scene.states > 0)),
    ("solved", |scene| scene.solved.into()),
    ("solvable without friction", |scene| usize::from(scene.frictionless && scene.states > 0)),
    ("solved without friction", |scene| usize::from(scene.frictionless && scene.solved)),
    ("states", |scene| scene.states),
    ("wrong", |scene| scene.wrong),
    ("panics", |scene| scene.panicked.into()),
    ("beyond cost", |scene| scene.beyond_cost.into()),
    ("disagreeing", |scene| scene.disagreeing.into()),
];

fn counts<'f>(scenes: impl Iterator<Item = &'f Findings>) -> Counts {
    let scenes: Vec<&Findings> = scenes.collect();
    COUNTS.iter().map(|(name, count)| (*name, scenes.iter().map(|scene| count(scene)).sum())).collect()
}

/// A scene that fell short.
#[derive(Debug)]
pub struct Short {
    /// Number of the scene in the sequence of its seed.
    pub index: usize,
    /// Message about the shortcoming.
    pub reason: String,
    /// Text of the scene file.
    pub text: String,
}

/// The report of a study.
#[derive(Debug)]
pub struct RandomReport {
    /// Counts of all scenes.
    pub counts: Counts,
    families: Vec<(Family, Counts)>,
    /// Everything that fell short.
    pub short: Vec<Short>,
}

impl RandomReport {
    /// The table of docs/stability.md.
    pub fn markdown(&self) -> String {
        let all = [("all".to_owned(), &self.counts)];
        let families = self.families.iter().map(|(family, counts)| (format!("{family:?}"), counts));
        let rows = families.chain(all).map(|(name, counts)| {
            let cells = COUNTS.iter().map(|(column, _)| counts[column].to_string());
            std::iter::once(name).chain(cells).collect()
        });
        markdown::table(&format!("family | {}", COUNTS.map(|(name, _)| name).join(" | ")), rows)
    }
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
    let done: Vec<(Family, Findings, String)> = (0..count).into_par_iter().map(|index| examine(seed, index)).collect();
    let of = |family| counts(done.iter().filter(|(of, ..)| *of == family).map(|(_, findings, _)| findings));
    let short = done.iter().enumerate().flat_map(|(index, (_, findings, text))| {
        findings.short.iter().map(move |reason| Short { index, reason: reason.clone(), text: text.clone() })
    });
    RandomReport {
        counts: counts(done.iter().map(|(_, findings, _)| findings)),
        families: Family::ALL.map(|family| (family, of(family))).into(),
        short: short.collect(),
    }
}

fn examine(seed: u64, index: usize) -> (Family, Findings, String) {
    let (family, text) = scenes::scene(seed, index);
    let case = SceneFile::parse(&text, "random").and_then(|file| Case::new(&file, Path::new(".")));
    let mut findings = Findings::default();
    match case {
        Err(error) => findings.short.push(format!("no scene: {error}")),
        Ok(case) => {
            findings.frictionless = !case.scene.has_friction();
            match catch_unwind(AssertUnwindSafe(|| paths_of(&case, index))) {
                Ok(Ok(paths)) => findings.judge(&paths),
                Ok(Err(reason)) => findings.short.push(reason),
                Err(_) => {
                    findings.panicked = true;
                    findings.short.push("panic".into());
                }
            }
        }
    }
    (family, findings, text)
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

impl Findings {
    /// Compares the paths of the scene.
    fn judge(&mut self, paths: &Paths) {
        let all = || std::iter::once(&paths.default).chain(&paths.others).flatten();
        self.no_equilibrium = !paths.has_statics;
        (self.states, self.solved) = (all().count(), paths.default.is_ok());
        for found in all().filter(|found| found.residual.is_nan() || found.residual > MAX_RESIDUAL) {
            self.wrong += 1;
            self.short.push(format!("wrong: residual {:.1e} by {}", found.residual, found.path));
        }
        match &paths.default {
            Err(reason) if self.states > 0 => self.short.push(format!("not solved: {reason}")),
            Err(reason) if paths.has_statics => self.short.push(format!("solved by no path: {reason}")),
            Err(_) => {}
            Ok(found) => {
                self.beyond_cost = found.operations > paths.cost_bound;
                if self.beyond_cost {
                    self.short.push(format!("cost {:.1e}, allowed {:.1e}", found.operations, paths.cost_bound));
                }
                let allowed = MAX_DIFFERENCE.max(MAX_ROUNDINGS * paths.rounding);
                let differences = paths.others.iter().flatten().map(|other| difference(found, other, paths.smallest));
                let largest = differences.fold(0.0, f64::max);
                self.disagreeing = largest > allowed && !all().any(|found| found.may_not_be_unique);
                if self.disagreeing {
                    self.short.push(format!("paths differ by {largest:.1e}, allowed {allowed:.1e}"));
                }
            }
        }
    }
}
