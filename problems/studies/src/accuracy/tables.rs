//! The report as Markdown tables.

use crate::accuracy::discretisation::QUANTITIES;
use crate::accuracy::optimization::TARGETS;
use crate::accuracy::{AlgebraStudy, MeshStudy, OptimizationStudy, Report, SubgradientStudy};
use crate::scaling::word;

/// All tables.
pub fn markdown(report: &Report) -> String {
    let mut text = format!(
        "{} threads run at once on this machine; the study took {:.0} s.\n",
        report.machine_threads, report.seconds
    );
    if !report.smooth.is_empty() {
        text += &smooth(report);
    }
    report.discretisation.iter().for_each(|study| text += &discretisation(study));
    report.algebra.iter().for_each(|study| text += &algebra(study));
    if let Some(study) = &report.subgradient {
        text += &subgradient(study);
    }
    report.optimization.iter().for_each(|study| text += &optimization(study));
    text
}

fn head(title: &str, columns: &[&str]) -> String {
    format!("\n### {title}\n\n| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()))
}

fn line(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn short(seconds: f64) -> String {
    if seconds < 0.1 { format!("{seconds:.4}") } else { format!("{seconds:.2}") }
}

fn rate(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), |rate| format!("{rate:.2}"))
}

fn smooth(report: &Report) -> String {
    let mut text = head(
        "Smooth solution of linear elasticity",
        &["bricks", "dofs", "seconds", "L² error", "rate", "energy error", "rate"],
    );
    for (index, row) in report.smooth.iter().enumerate() {
        let before = index.checked_sub(1).map(|index| report.smooth[index]);
        let observed = |error: fn(&crate::accuracy::ManufacturedErrors) -> f64| {
            before.and_then(|before| {
                crate::accuracy::rates::observed(
                    [before.bricks as f64, row.bricks as f64],
                    [error(&before), error(row)],
                )
            })
        };
        text += &line(&[
            format!("{}³", row.bricks),
            row.dofs.to_string(),
            short(row.seconds),
            format!("{:.2e}", row.displacement),
            rate(observed(|row| row.displacement)),
            format!("{:.2e}", row.energy),
            rate(observed(|row| row.energy)),
        ]);
    }
    text
}

fn discretisation(study: &MeshStudy) -> String {
    let mut columns = vec!["bricks", "dofs", "seconds"];
    for name in QUANTITIES {
        columns.extend([name, "rate"]);
    }
    let mut text = head(&format!("{}: error of the discretisation", word(&study.scene)), &columns);
    for row in &study.rows {
        let mut cells = vec![format!("{}³", row.bricks), row.dofs.to_string(), short(row.seconds)];
        for (error, observed) in row.errors.iter().zip(row.rates) {
            cells.extend([format!("{error:.1e}"), rate(observed)]);
        }
        text += &line(&cells);
    }
    let limits = QUANTITIES.iter().zip(&study.limits);
    let limits: Vec<String> = limits
        .map(|(name, limit)| {
            format!("{name} {:.6e} (rate {:.2}, misfit {:.0e})", limit.limit, limit.rate, limit.misfit)
        })
        .collect();
    text + "\nExtrapolated: " + &limits.join("; ") + ".\n"
}

fn algebra(study: &AlgebraStudy) -> String {
    let columns = [
        "solver",
        "tolerance",
        "seconds",
        "products",
        "pressure error",
        "Θ error",
        "bound reported",
        "Θ corrected",
        "ξ error",
    ];
    let title = format!("{}, {}³ bricks: error of the contact solvers", word(&study.scene), study.bricks);
    let mut text = head(&title, &columns);
    for row in &study.rows {
        text += &line(&[
            row.method.to_owned(),
            format!("{:.0e}", row.tolerance),
            short(row.seconds),
            row.products.to_string(),
            format!("{:.1e}", row.pressure),
            format!("{:.1e}", row.value),
            format!("{:.1e}", row.bound),
            format!("{:.1e}", row.corrected),
            format!("{:.1e}", row.subgradient),
        ]);
    }
    text + &format!(
        "\nBound below the true error: {} of {} rows; bound over error among the {} rows above rounding: median {:.1}.\n",
        study.violations,
        study.rows.len(),
        study.judged,
        study.median_ratio
    )
}

fn subgradient(study: &SubgradientStudy) -> String {
    let mut text = head("Taylor tables", &["where", "⟨ξ, d⟩", "fitted slope", "best relative error of the derivative"]);
    for taylor in &study.taylor {
        text += &line(&[
            taylor.scene.clone(),
            format!("{:.6e}", taylor.test.directional_derivative),
            rate(taylor.test.fitted_slope),
            format!("{:.1e}", taylor.test.best_derivative_error),
        ]);
    }
    let columns = [
        "where",
        "change of status",
        "slope before",
        "slope after",
        "⟨ξ, d⟩ at the kink",
        "weakly active",
        "bracketed",
    ];
    text += &head("Kinks", &columns);
    for kink in &study.kinks {
        text += &line(&[
            kink.scene.clone(),
            kink.change.clone(),
            format!("{:.6e}", kink.before),
            format!("{:.6e}", kink.after),
            format!("{:.6e}", kink.product),
            kink.weakly_active.to_string(),
            if kink.bracketed { "yes" } else { "no" }.into(),
        ]);
    }
    text
}

fn optimization(study: &OptimizationStudy) -> String {
    let targets = TARGETS.map(|target| format!("to {:.0} % above Θ*: evaluations, products, s", 100.0 * target));
    let mut columns = vec!["strategy", "evaluations fine + coarse", "seconds", "Θ at the end"];
    columns.extend(targets.iter().map(String::as_str));
    let fine = study.levels[study.levels.len() - 1];
    let mut text = head(&format!("{}, {fine}³ bricks: distance from the minimum", word(&study.scene)), &columns);
    for course in &study.courses {
        let mut cells = vec![
            course.strategy.to_owned(),
            format!("{} + {}", course.evaluations, course.coarse_evaluations),
            short(course.seconds),
            format!("{:.5e}", course.value),
        ];
        cells.extend(course.reached.map(|reached| {
            reached.map_or_else(
                || "–".into(),
                |point| format!("{}, {:.0}, {}", point.evaluations, point.work, short(point.seconds)),
            )
        }));
        text += &line(&cells);
    }
    text += &format!("\nΘ at the start {:.5e}; Θ* = {:.5e} is the lowest of these runs.\n", study.start, study.lowest);
    let title = format!("{}, {}³ bricks: norms of the pressure against its peak", word(&study.scene), study.peak_mesh);
    text += &head(&title, &["minimised", "evaluations", "seconds", "peak pressure, MPa", "Σσ⁴"]);
    for row in &study.peaks {
        text += &line(&[
            row.measure.clone(),
            row.evaluations.to_string(),
            short(row.seconds),
            format!("{:.1}", row.peak),
            format!("{:.5e}", row.norm),
        ]);
    }
    text
}
