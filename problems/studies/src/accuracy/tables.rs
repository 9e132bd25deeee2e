//! The report as Markdown tables.

use crate::accuracy::algebra::AlgebraStudy;
use crate::accuracy::discretisation::MeshStudy;
use crate::accuracy::discretisation::QUANTITIES;
use crate::accuracy::manufactured::ManufacturedErrors;
use crate::accuracy::optimization::OptimizationStudy;
use crate::accuracy::optimization::TARGETS;
use crate::accuracy::report::AccuracyReport;
use crate::accuracy::subgradient::SubgradientStudy;
use crate::markdown::{or_dash, seconds, section, yes_or_no};
use crate::rates::observed;
use crate::scaling::option_name;

/// The tables of the report as Markdown.
pub fn markdown(report: &AccuracyReport) -> String {
    let mut text = format!(
        "{} threads run at once on this machine; the study took {:.0} s.\n",
        report.machine_threads, report.seconds
    );
    text += &smooth(&report.smooth);
    text.extend(report.discretisation.iter().map(discretisation));
    text.extend(report.algebra.iter().map(algebra));
    text.extend(report.subgradient.iter().map(subgradient));
    text.extend(report.optimization.iter().map(optimization));
    text
}

fn rate(value: Option<f64>) -> String {
    or_dash(value, |rate| format!("{rate:.2}"))
}

fn smooth(meshes: &[ManufacturedErrors]) -> String {
    let rows = meshes.iter().enumerate().map(|(index, row)| {
        let before = index.checked_sub(1).map(|index| &meshes[index]);
        let from_before =
            |error: fn(&ManufacturedErrors) -> f64| {
                rate(before.and_then(|before| {
                    observed([before.bricks as f64, row.bricks as f64], [error(before), error(row)])
                }))
            };
        vec![
            format!("{}³", row.bricks),
            row.dofs.to_string(),
            seconds(row.seconds),
            format!("{:.2e}", row.displacement),
            from_before(|row| row.displacement),
            format!("{:.2e}", row.energy),
            from_before(|row| row.energy),
        ]
    });
    let head = "bricks | dofs | seconds | L² error | rate | energy error | rate";
    section("Smooth solution of linear elasticity", head, rows)
}

fn discretisation(study: &MeshStudy) -> String {
    let rows = study.rows.iter().map(|row| {
        let mut cells = vec![format!("{}³", row.bricks), row.dofs.to_string(), seconds(row.seconds)];
        for (error, observed) in row.errors.iter().zip(row.rates) {
            cells.extend([format!("{error:.1e}"), rate(observed)]);
        }
        cells
    });
    let head = format!("bricks | dofs | seconds | {} | rate", QUANTITIES.join(" | rate | "));
    let limits = QUANTITIES.iter().zip(&study.limits).map(|(name, limit)| {
        format!("{name} {:.6e} (rate {:.2}, misfit {:.0e})", limit.limit, limit.rate, limit.misfit)
    });
    let limits: Vec<String> = limits.collect();
    let table = section(&format!("{}: error of the discretisation", option_name(&study.scene)), &head, rows);
    format!("{table}\nExtrapolated: {}.\n", limits.join("; "))
}

fn algebra(study: &AlgebraStudy) -> String {
    let rows = study.rows.iter().map(|row| {
        let mut cells = vec![row.method.to_owned(), format!("{:.0e}", row.tolerance)];
        cells.extend([seconds(row.seconds), row.products.to_string()]);
        let errors = [row.pressure, row.value, row.bound, row.corrected, row.subgradient];
        cells.extend(errors.map(|error| format!("{error:.1e}")));
        cells
    });
    let head =
        "solver | tolerance | seconds | products | pressure error | Θ error | bound reported | Θ corrected | ξ error";
    let title = format!("{}, {}³ bricks: error of the contact solvers", option_name(&study.scene), study.bricks);
    section(&title, head, rows)
        + &format!(
            "\nBound below the true error: {} of {} rows; bound over error among the {} rows above rounding: median {:.1}.\n",
            study.violations,
            study.rows.len(),
            study.compared,
            study.median_ratio
        )
}

fn subgradient(study: &SubgradientStudy) -> String {
    let tests = study.taylor.iter().map(|taylor| {
        vec![
            taylor.scene.clone(),
            format!("{:.6e}", taylor.test.directional_derivative),
            rate(taylor.test.fitted_slope),
            format!("{:.1e}", taylor.test.best_derivative_error),
        ]
    });
    let kinks = study.kinks.iter().map(|kink| {
        let mut cells = vec![kink.scene.clone(), kink.change.clone()];
        cells.extend([kink.before, kink.after, kink.product].map(|slope| format!("{slope:.6e}")));
        cells.extend([kink.weakly_active.to_string(), yes_or_no(kink.bracketed)]);
        cells
    });
    section("Taylor tables", "where | ⟨ξ, d⟩ | fitted slope | best relative error of the derivative", tests)
        + &section(
            "Kinks",
            "where | change of status | slope before | slope after | ⟨ξ, d⟩ at the kink | weakly active | bracketed",
            kinks,
        )
}

fn optimization(study: &OptimizationStudy) -> String {
    let courses = study.courses.iter().map(|course| {
        let mut cells = vec![
            course.strategy.to_owned(),
            format!("{} + {}", course.evaluations, course.coarse_evaluations),
            seconds(course.seconds),
            format!("{:.5e}", course.value),
        ];
        cells.extend(course.reached.map(|reached| {
            or_dash(reached, |point| format!("{}, {:.0}, {}", point.evaluations, point.work, seconds(point.seconds)))
        }));
        cells
    });
    let peaks = study.peaks.iter().map(|row| {
        let mut cells = vec![row.measure.clone(), row.evaluations.to_string(), seconds(row.seconds)];
        cells.extend([format!("{:.1}", row.peak), format!("{:.5e}", row.norm)]);
        cells
    });
    let targets = TARGETS.map(|target| format!("to {:.0} % above Θ*: evaluations, products, s", 100.0 * target));
    let head = format!("strategy | evaluations fine + coarse | seconds | Θ at the end | {}", targets.join(" | "));
    let (scene, fine) = (option_name(&study.scene), study.levels[study.levels.len() - 1]);
    let ends =
        format!("\nΘ at the start {:.5e}; Θ* = {:.5e} is the lowest of these runs.\n", study.start, study.lowest);
    let title = format!("{scene}, {}³ bricks: norms of the pressure against its peak", study.peak_mesh);
    section(&format!("{scene}, {fine}³ bricks: distance from the minimum"), &head, courses)
        + &ends
        + &section(&title, "minimised | evaluations | seconds | peak pressure, MPa | Σσ⁴", peaks)
}
