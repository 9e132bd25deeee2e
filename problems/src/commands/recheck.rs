//! `recheck`: norm and error of a certificate computed again from the files that an optimization has left.

use crate::commands::arguments::Arguments;
use crate::commands::controls::{self, Layout};
use crate::commands::facts::{Fact, Facts, Group, Value, line};
use crate::commands::failure::Failure;
use crate::commands::folder::{SCENE, file_error, json};
use crate::commands::limit_check::{LimitCheck, MAX_ROUNDING, Number};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::run_kind::RunKind;
use crate::commands::scene_difference::{differences, is_below};
use nonsmooth::{Certificate, CertificateCheck, ProofCheck};
use scene_file::optimization::{PlannedRun, last_begun};
use scene_file::{SceneFile, read_text};
use serde::Serialize;
use std::path::Path;

/// Largest certificate file, bytes.
const LARGEST_FILE: u64 = 256 << 20;

/// Fields on which a certificate does not depend.
const LEFT_OUT: [&str; 7] =
    ["name", "solver", "optimizer", "output", "body.block.subdomains", "body.lattice.start", "body.lattice.controls"];

/// The keys of the JSON of `recheck`.
#[derive(Debug, Serialize)]
struct RecheckJson {
    aggregate_norm: Number,
    aggregate_error: Number,
    /// Whether the multipliers are those of a convex combination and of closed sides, and the point is admissible.
    multipliers_and_point_admissible: bool,
    multiplier_defect: f64,
    open_side_multiplier: f64,
    violation: f64,
    /// Whether the point of the certificate is that of controls.json.
    point_equals_controls: bool,
    /// Differences of the cuts from those that outputs, Jacobian and pressure measure give, where the composite model
    /// confirmed the point.
    composite: Option<ProofCheck>,
    /// The limits, where the scene has some.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    limits: Vec<LimitCheck>,
    agrees: bool,
}

pub fn run(loaded: &LoadedScene, arguments: &Arguments) -> Result<String, Failure> {
    let folder = arguments.certified.folder.as_path();
    if let Some(kind) = RunKind::of(folder)?.filter(|kind| *kind != RunKind::Optimization) {
        let words = "recheck takes one of its optimizations, which lie in folders below";
        return Err(Failure::Input(format!("{}: holds {}; {words}", folder.display(), kind.words())));
    }
    let certificate = read(&folder.join("certificate.json"))?;
    let own = own_scene(loaded, folder)?;
    let case = own.as_ref().map_or(&loaded.case, |own| &own.case);
    let controls = controls::read(&folder.join("controls.json"), Layout::of(&case.scene))?;
    let Some(PlannedRun { case, .. }) = last_begun(case, folder) else {
        return Err(Failure::computation("no mesh was begun"));
    };
    let (cost, bounds, problems) = case.cost()?;
    let foreign = |error| {
        Failure::Computation(format!("{}: the certificate is not one of this scene: {error}", folder.display()))
    };
    let check = certificate.recheck(problems[0].admissible.polyhedron()).map_err(foreign)?;
    let proof = certificate.composite.as_ref().map(|proof| proof.recheck(&certificate, &cost)).transpose();
    let proof = proof.map_err(foreign)?;
    let mut result = RecheckJson::new(&certificate, &check, certificate.point == controls);
    result.agrees &= proof.is_none_or(|proof| proof.largest() <= MAX_ROUNDING);
    result.composite = proof;
    let checks = match case.limits.is_empty() {
        true => Some(vec![]),
        false => LimitCheck::all(&certificate, (&cost, &bounds, &problems)),
    };
    result.limits = checks.ok_or_else(|| {
        let words = "the certificate does not hold the limits of its scene";
        Failure::Computation(format!("{}: {words}", folder.display()))
    })?;
    result.agrees &= result.limits.iter().all(|limit| limit.agrees);
    let text = arguments.printed(result.text(), json(&result)?);
    if result.agrees {
        return Ok(text);
    }
    let reason =
        format!("{}: the certificate does not agree with its cuts, its multipliers and the scene", folder.display());
    Err(Failure::Incomplete { text, reason, status: 1 })
}

/// The scene of the run in a folder, if the folder tells it.
///
/// # Errors
/// [`Failure::Computation`] if it is another one than that of the command, in more than its name, its tearing, its
/// start, its solver, its optimizer, and its outputs.
fn own_scene(here: &LoadedScene, folder: &Path) -> Result<Option<LoadedScene>, Failure> {
    let path = folder.join(SCENE);
    if !path.exists() {
        return Ok(None);
    }
    let own = LoadedScene::new(SceneFile::read(&path)?, Some(path.clone()))?;
    if let Some(difference) = differences(&own, here, |field| !is_below(field, &LEFT_OUT))?.first() {
        let words = format!("the certificate is not one of this scene: {difference}; {} is its scene", path.display());
        return Err(Failure::Computation(format!("{}: {words}", folder.display())));
    }
    Ok(Some(own))
}

fn read(file: &Path) -> Result<Certificate, Failure> {
    let text = read_text(file, LARGEST_FILE)?;
    let certificate: Option<Certificate> = serde_json::from_str(&text)
        .map_err(|error| file_error(file, format!("{error}; expected the certificate that an optimization writes")))?;
    let none = "the run solved no subproblem and has no certificate";
    certificate.ok_or_else(|| Failure::Computation(format!("{}: {none}", file.display())))
}

impl RecheckJson {
    fn new(certificate: &Certificate, check: &CertificateCheck, point_equals_controls: bool) -> Self {
        let slopes = certificate.cuts.iter().map(|cut| cut.multiplier * certificate.norm.dual_length(&cut.subgradient));
        let [norm_rounding, error_rounding] =
            [slopes.sum(), certificate.value.abs()].map(|scale: f64| MAX_ROUNDING * scale);
        let aggregate_norm = Number::new(certificate.aggregate_norm, check.aggregate_norm, norm_rounding);
        let aggregate_error = Number::new(certificate.aggregate_error, check.aggregate_error, error_rounding);
        let admissible = check.confirms(f64::INFINITY, f64::INFINITY);
        Self {
            agrees: aggregate_norm.agrees && aggregate_error.agrees && admissible && point_equals_controls,
            aggregate_norm,
            aggregate_error,
            multipliers_and_point_admissible: admissible,
            multiplier_defect: check.multiplier_defect,
            open_side_multiplier: check.open_side_multiplier,
            violation: check.violation,
            point_equals_controls,
            composite: None,
            limits: vec![],
        }
    }
}

impl RecheckJson {
    /// The text for people: the verdict first, then the numbers behind it.
    fn text(&self) -> String {
        let verdict = |agrees: bool| if agrees { "agrees" } else { "does NOT agree" };
        let admissible = if self.multipliers_and_point_admissible { "admissible" } else { "NOT admissible" };
        let equal = if self.point_equals_controls { "equals" } else { "does NOT equal" };
        let lead = vec![
            line("certificate", verdict(self.agrees)).trim_end().to_owned(),
            line("point", &format!("{equal} controls.json")).trim_end().to_owned(),
        ];
        let number = |name: &str, number: &Number| {
            let Number { recorded, recomputed, rounding, agrees } = *number;
            let values =
                vec![recorded.into(), recomputed.into(), Value::Rough(rounding), verdict(agrees).to_owned().into()];
            Fact::row("", name, values, "")
        };
        let mut numbers =
            vec![number("aggregate norm", &self.aggregate_norm), number("aggregate error", &self.aggregate_error)];
        numbers.extend(
            self.limits.iter().filter_map(|limit| {
                Some(number(&format!("{} beyond its limit", limit.name()), limit.excess.as_ref()?))
            }),
        );
        let columns = ["recorded", "recomputed", "rounding", ""].map(str::to_owned).into();
        let rough = |name: &str, value| Fact::new("", name, Value::Rough(value), "");
        let mut rest = vec![
            Fact::new("", "multipliers, point", admissible.to_owned(), ""),
            rough("multiplier defect", self.multiplier_defect),
            rough("at open sides", self.open_side_multiplier),
            rough("violation", self.violation),
        ];
        if let Some(ProofCheck { value, outer, cuts, .. }) = &self.composite {
            rest.push(rough("composite: objective", *value));
            rest.push(rough("pressure measure", *outer));
            rest.push(rough("cuts", *cuts));
        }
        for limit in &self.limits {
            rest.push(Fact::new("", &format!("multiplier of the {}", limit.name()), limit.multiplier, ""));
            let cuts = limit.cuts.map_or_else(|| "not computed again".to_owned().into(), Value::Rough);
            rest.push(Fact::new("", &format!("linearizations of the {}", limit.name()), cuts, ""));
        }
        let numbers = Group { columns, ..Group::new("", numbers) };
        Facts { lead, groups: vec![numbers, Group::new("", rest)] }.text(true)
    }
}
