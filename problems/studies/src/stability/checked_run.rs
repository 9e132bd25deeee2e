//! From what the paths did to the outcome of a case.

use crate::stability::case::Case;
use crate::stability::contact::{
    Attempt, ContactCase, Expected, Found, LimitKinds, by_condensation, by_successive_approximations, by_tfeti,
};
use crate::stability::record::{CaseOutcome, Path, Record};
use contact::equilibrium::{ContactForces, ContactProblem};
use std::sync::Arc;

/// Largest relative residual of a solved state. A Newton residual of 1e-9 is accepted where rounding stops a solver;
/// residuals in other norms may be four times as large. The solvers themselves refuse a state only above 1e-8.
const CERTIFICATE: f64 = 4e-9;
/// Largest difference of forces between independent paths, over the largest force. Forces are less accurate than
/// residuals by the condition of the problem.
const AGREEMENT: f64 = 1e-6;
/// Largest difference of the sensitivities of the control heights.
const SUBGRADIENT_AGREEMENT: f64 = 1e-4;

/// Share of a brick's stiffness that is zero for a sensitivity.
const NEGLIGIBLE: f64 = 1e-6;

impl ContactCase {
    /// The case as a line of the matrix.
    pub fn case(self, group: &'static str, name: impl Into<String>) -> Case {
        Case::new(group, name, move || record(&self))
    }
}

/// Runs a contact case by all its paths and checks their results.
fn record(case: &ContactCase) -> Record {
    let mut record = Record::default();
    let scene = case.scene.as_ref().map_err(ToString::to_string);
    let problem = scene.and_then(|scene| ContactProblem::new(scene.clone()).map_err(|error| error.to_string()));
    let problem = match problem.map(Arc::new) {
        Ok(problem) => problem,
        Err(reason) => return refused_scene(record, case, reason),
    };
    let start = problem.scene.start();
    let controls = case.controls.as_ref().unwrap_or(&start);
    let (torn_path, torn) = by_tfeti(&problem, controls);
    let (direct_path, direct) = by_condensation(&problem, controls);
    record.paths = vec![torn_path, direct_path];
    if let Some(Ok(diagnosis)) = direct.as_ref().and_then(|found| found.diagnosis.as_ref()) {
        record.contraction = Some(diagnosis.contraction);
        record.condition = diagnosis.condition;
    }
    (record.outcome, record.remark) = verdict(&problem, case, &mut record, [torn.as_ref(), direct.as_ref()]);
    if record.contraction.is_some_and(|factor| factor >= 1.0) {
        let warning = "Φ does not contract: uniqueness is not proved, other equilibria may exist";
        record.remark = join(&record.remark, warning);
    }
    if case.paper {
        compare_with_paper(&mut record, by_successive_approximations(&problem, controls), torn.as_ref());
    }
    record
}

/// The outcome of the two Newton paths, and the remark.
fn verdict(
    problem: &ContactProblem,
    case: &ContactCase,
    record: &mut Record,
    [torn, direct]: [Option<&Found>; 2],
) -> (CaseOutcome, String) {
    match &case.expected {
        Expected::Refused(kind) => refused(kind, &record.paths),
        Expected::Limit(kinds, cause) if torn.is_none() || direct.is_none() => {
            limit(kinds, cause, record, torn.or(direct).map(|found| checked(problem, case, found)))
        }
        // At the edge of double precision a known limit may be solved after all: then it is.
        Expected::Solved | Expected::Limit(..) => match solved(problem, case, record, torn, direct) {
            Ok(remark) => (CaseOutcome::Solved, remark),
            Err(remark) => (CaseOutcome::Broken, remark),
        },
    }
}

/// Adds what the successive approximations did, and compares their forces with those of TFETI.
fn compare_with_paper(record: &mut Record, (path, found): Attempt, torn: Option<&Found>) {
    let reason = path.reason.clone().unwrap_or_default();
    let text = match (&found, torn) {
        (Some(found), Some(torn)) => {
            let difference = force_difference(&found.forces, &torn.forces);
            // An accurate pressure costs accuracy of the residual; where Φ does not contract, another equilibrium is
            // one.
            let contracts = record.contraction.is_none_or(|factor| factor < 1.0);
            if contracts && difference > 100.0 * AGREEMENT {
                record.outcome = CaseOutcome::Broken;
            }
            format!("{reason}, forces differ by {difference:.1e}")
        }
        _ => format!("{}: {reason}", path.refusal.clone().unwrap_or_default()),
    };
    record.remark = join(&record.remark, &format!("successive approximations: {text}"));
    record.paths.push(path);
}

fn join(first: &str, second: &str) -> String {
    [first, second].iter().filter(|text| !text.is_empty()).copied().collect::<Vec<_>>().join("; ")
}

/// A scene that is refused before any solver starts.
fn refused_scene(mut record: Record, case: &ContactCase, reason: String) -> Record {
    let expected = matches!(case.expected, Expected::Refused("Scene"));
    record.outcome = if expected { CaseOutcome::Refused } else { CaseOutcome::Broken };
    record.remark = reason;
    record
}

fn reasons(paths: &[Path]) -> String {
    let texts: Vec<String> = paths
        .iter()
        .map(|path| match &path.reason {
            Some(reason) => format!("{}: {}: {reason}", path.solver, path.refusal.clone().unwrap_or_default()),
            None => format!("{}: a state", path.solver),
        })
        .collect();
    texts.join("; ")
}

fn refused(kind: &str, paths: &[Path]) -> (CaseOutcome, String) {
    if paths.iter().all(|path| path.refusal.as_deref() == Some(kind)) {
        let reason = paths[0].reason.clone().unwrap_or_default();
        return (CaseOutcome::Refused, format!("{kind}: {reason}"));
    }
    (CaseOutcome::Broken, reasons(paths))
}

fn limit(
    kinds: &LimitKinds,
    cause: &str,
    record: &Record,
    found: Option<Result<String, String>>,
) -> (CaseOutcome, String) {
    let paths = &record.paths;
    let certified = record.largest_residual().is_none_or(|residual| residual <= CERTIFICATE);
    if !certified
        || paths
            .iter()
            .zip(kinds)
            .any(|(path, kinds)| !path.refusal.as_deref().map_or(kinds.is_empty(), |kind| kinds.contains(&kind)))
    {
        return (CaseOutcome::Broken, reasons(paths));
    }
    match found.transpose() {
        Ok(finding) => {
            let did = |path: &Path| format!("{}: {}", path.solver, path.refusal.as_deref().unwrap_or("a state"));
            let did: Vec<String> = paths.iter().map(did).collect();
            (CaseOutcome::Limit, join(&format!("{}; {cause}", did.join(", ")), &finding.unwrap_or_default()))
        }
        Err(wrong) => (CaseOutcome::Broken, join(&wrong, &reasons(paths))),
    }
}

/// Finite numbers and the case's own check.
fn checked(problem: &ContactProblem, case: &ContactCase, found: &Found) -> Result<String, String> {
    if !finite(&found.forces) {
        return Err("a result is not finite".into());
    }
    match &case.check {
        Some(check) => check(problem, &found.forces),
        None => Ok(String::new()),
    }
}

/// Certificates, agreement, finite numbers, and the case's own check.
fn solved(
    problem: &ContactProblem,
    case: &ContactCase,
    record: &mut Record,
    torn: Option<&Found>,
    direct: Option<&Found>,
) -> Result<String, String> {
    let (Some(torn), Some(direct)) = (torn, direct) else { return Err(reasons(&record.paths)) };
    let finding = checked(problem, case, torn)?;
    checked(problem, case, direct)?;
    let certificate = record.largest_residual().unwrap_or(f64::NAN);
    if certificate.is_nan() || certificate > CERTIFICATE {
        return Err(format!("certificate {certificate:.1e}"));
    }
    let difference = force_difference(&torn.forces, &direct.forces);
    record.force_difference = Some(difference);
    if difference.is_nan() || difference > AGREEMENT {
        return Err(format!("the paths' forces differ by {difference:.1e}"));
    }
    let heights = [&torn.heights, &direct.heights].map(|heights| heights.as_ref().map_err(Clone::clone));
    let [first, second] = heights;
    let (first, second) = (first?, second?);
    if torn.forces.kink.weakly_active == 0 && direct.forces.kink.weakly_active == 0 {
        // Where equilibrium alone determines the forces, sensitivities vanish up to rounding of a brick's stiffness.
        let body = &problem.scene.bodies[0];
        let brick = body.block().map_or(0.0, |block| block.size[0] / block.bricks[0] as f64);
        let floor = NEGLIGIBLE * body.material.young_modulus() * brick;
        let difference = difference_over(first, second, floor);
        record.subgradient_difference = Some(difference);
        if difference.is_nan() || difference > SUBGRADIENT_AGREEMENT {
            return Err(format!("the paths' subgradients differ by {difference:.1e}"));
        }
    } else if first.iter().chain(second).any(|value| !value.is_finite()) {
        return Err("a subgradient is not finite".into());
    }
    Ok(finding)
}

fn finite(forces: &ContactForces) -> bool {
    let values = forces.normal.iter().chain(&forces.opening).chain(forces.tangential.iter().flatten());
    values.chain(forces.slip.iter().flatten()).all(|value| value.is_finite())
}

/// Largest difference of contact forces over the largest normal force; 0 when there are none at all.
pub fn force_difference(first: &ContactForces, second: &ContactForces) -> f64 {
    let all = |forces: &ContactForces| -> Vec<f64> {
        forces.normal.iter().chain(forces.tangential.iter().flatten()).copied().collect()
    };
    difference_over(&all(first), &all(second), 0.0)
}

/// |a − b|∞ over the larger of |a|∞, |b|∞ and a floor; 0 if all vanish, NaN if a number is not finite.
pub fn difference_over(a: &[f64], b: &[f64], floor: f64) -> f64 {
    let (mut largest, mut difference) = (floor, 0.0_f64);
    for (a, b) in a.iter().zip(b) {
        if !a.is_finite() || !b.is_finite() {
            return f64::NAN;
        }
        largest = largest.max(a.abs()).max(b.abs());
        difference = difference.max((a - b).abs());
    }
    if largest == 0.0 { 0.0 } else { difference / largest }
}
