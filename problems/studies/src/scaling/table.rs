//! The report as Markdown tables.

use crate::markdown::{or_dash, seconds as short, section};
use crate::scaling::cases::{Variant, option_name};
use crate::scaling::measure::{COLD, TIMED};
use crate::scaling::report::ScalingReport;
use crate::scaling::rows::{ScalingRow, Start};
use contact::equilibrium::StageSeconds;

/// One line for the terminal.
pub fn progress(row: &ScalingRow) -> String {
    format!(
        "{} {} {}: {} dofs, cold {:.2} s, {} products",
        option_name(&row.scene),
        name(row)[0],
        option_name(&row.variant),
        row.dofs,
        row.cold.seconds(),
        row.cold.state.applications()
    )
}

/// The tables of the report as Markdown.
pub fn markdown(report: &ScalingReport) -> String {
    let machine = format!("{} threads run at once on this machine.\n", report.machine_threads);
    [
        machine,
        counts(report),
        paper(report),
        seconds(report),
        clusters(report),
        direct(report),
        growth(report),
        failures(report),
    ]
    .concat()
}

fn name(row: &ScalingRow) -> Vec<String> {
    let clusters = if row.clusters == 1 { String::new() } else { format!(", clusters of {}³", row.clusters) };
    vec![format!("{}{clusters}", row.case), row.case.ratio().to_string(), option_name(&row.variant)]
}

fn counts(report: &ScalingReport) -> String {
    let rows = report.rows.iter().filter(|row| row.variant != Variant::Direct).map(|row| {
        let count = |start, tolerance| or_dash(row.solve(start, tolerance), |solve| solve.applications().to_string());
        let mut cells = name(row);
        cells.extend(
            [row.dofs, row.multipliers, row.contact_nodes, row.cold.state.work.newton_steps].map(|n| n.to_string()),
        );
        cells.extend([COLD[0], TIMED, COLD[1]].map(|tolerance| count(Start::Cold, tolerance)));
        cells.extend([TIMED, COLD[1]].map(|tolerance| count(Start::Warm, tolerance)));
        cells.push(row.cold.adjoint.applications.to_string());
        cells
    });
    let head = "N/S | H/h | solver | dofs | multipliers | contact nodes | Newton steps, 1e-8 | cold 1e-6 | 1e-8 | 1e-10 | \
                warm 1e-8 | 1e-10 | adjoint 1e-8";
    section("Counts (products with the dual operator)", head, rows)
}

fn paper(report: &ScalingReport) -> String {
    let rows = report.rows.iter().filter(|row| row.variant == Variant::AugmentedLagrangian).map(|row| {
        let newton = alike(report, row, Variant::Dirichlet).and_then(|row| row.solve(Start::Cold, COLD[1]));
        let coarse = row.solve(Start::Cold, COLD[0]);
        let work = row.cold.state.work;
        let mut cells = vec![row.case.to_string(), row.case.ratio().to_string()];
        let steps = [work.fixed_point_steps, work.cg_steps, work.expansion_steps, work.proportioning_steps];
        cells.extend(steps.map(|count| count.to_string()));
        cells.push(or_dash(coarse, |solve| solve.applications().to_string()));
        cells.push(or_dash(coarse.zip(newton), |(paper, newton)| {
            format!("{:.1e}", (paper.objective / newton.objective - 1.0).abs())
        }));
        cells
    });
    let head = "N/S | H/h | Tresca problems | cg | expansion | proportioning | products, 1e-6 | error of Σσ⁴";
    section("The paper's path: steps of the cold state to 1e-8, products and error of Σσ⁴ at 1e-6", head, rows)
}

/// The row of the same case with another solver.
fn alike<'a>(report: &'a ScalingReport, row: &ScalingRow, variant: Variant) -> Option<&'a ScalingRow> {
    report.rows.iter().find(|other| {
        other.case == row.case && other.clusters == row.clusters && other.scene == row.scene && other.variant == variant
    })
}

fn seconds(report: &ScalingReport) -> String {
    let rows = report.rows.iter().map(|row| {
        let stages = row.cold.state.stages;
        let stage = |value: fn(&StageSeconds) -> f64| or_dash(stages.as_ref(), |stages| short(value(stages)));
        let mut cells = name(row);
        cells.push(short(row.setup_seconds));
        cells.extend([stage(|s| s.factorization), stage(|s| s.coarse_space), stage(|s| s.newton)]);
        cells.push(stage(|s| s.equilibrium + s.recovery));
        let torn = row.variant != Variant::Direct;
        cells.push(short(row.cold.adjoint.seconds));
        cells.push(or_dash(torn.then_some(row.cold.adjoint.shape_seconds), short));
        cells.push(short(row.cold.seconds()));
        cells.push(or_dash(row.warm.as_ref(), |warm| short(warm.seconds())));
        cells.push(row.peak_memory.map_or_else(|| "not told by this system".into(), |gib| format!("{gib:.2}")));
        cells
    });
    let head = "N/S | H/h | solver | setup, once | assembly + factors | coarse space | Newton/Krylov | rest | adjoint | \
                shape derivative | cold | warm | peak GiB";
    section("Seconds and memory (state to 1e-8 and subgradient to 1e-8)", head, rows)
}

/// What clusters cost and save, where there are any.
fn clusters(report: &ScalingReport) -> String {
    if report.rows.iter().all(|row| row.clusters == 1) {
        return String::new();
    }
    let rows = report.rows.iter().filter_map(|row| {
        let (unknowns, stages) = (row.coarse_unknowns?, row.cold.state.stages?);
        let products = |tolerance| or_dash(row.solve(Start::Cold, tolerance), |solve| solve.applications().to_string());
        let mut cells = vec![row.case.to_string(), row.case.ratio().to_string(), option_name(&row.variant)];
        cells.extend(
            [row.clusters.pow(3), row.case.subdomains.pow(3) / row.clusters.pow(3), unknowns].map(|n| n.to_string()),
        );
        cells.extend([products(TIMED), products(COLD[1]), row.cold.adjoint.applications.to_string()]);
        let seconds = [row.setup_seconds, stages.factorization, stages.coarse_space, stages.newton, row.cold.seconds()];
        cells.extend(seconds.map(short));
        cells.push(row.peak_memory.map_or_else(|| "not told by this system".into(), |gib| format!("{gib:.2}")));
        Some(cells)
    });
    let head = "N/S | H/h | solver | subdomains per cluster | clusters per body | coarse unknowns | cold 1e-8 | 1e-10 | adjoint 1e-8 | \
                setup, once, s | assembly + factors | coarse space | Newton/Krylov | cold | peak GiB";
    section("Clusters", head, rows)
}

fn direct(report: &ScalingReport) -> String {
    let rows = report.rows.iter().filter(|row| row.variant == Variant::Direct).filter_map(|direct| {
        let torn = alike(report, direct, Variant::Dirichlet)?;
        let warm = |row: &ScalingRow| row.warm.as_ref().map(|warm| warm.seconds());
        let times = [Some(direct.cold.seconds()), warm(direct), Some(torn.cold.seconds()), warm(torn)];
        let mut cells = vec![direct.case.to_string()];
        cells.extend(times.map(|time| or_dash(time, short)));
        for (slow, fast) in [(times[0], times[2]), (times[1], times[3])] {
            cells.push(or_dash(slow.zip(fast), |(slow, fast)| format!("{:.2}", slow / fast)));
        }
        Some(cells)
    });
    let head = "N/S | direct cold, s | warm | TFETI (dirichlet) cold, s | warm | ratio cold | warm";
    section("Against direct condensation", head, rows)
}

fn growth(report: &ScalingReport) -> String {
    let rows = report.growth.iter().map(|growth| {
        let exponents = [growth.cold_exponent, growth.cold_exponent_large, growth.warm_exponent];
        let relative = |(s, growth): &(usize, f64)| format!("s = {s}: {:+.0} %", 100.0 * growth);
        let counts = growth.counts.iter().filter(|count| !count.growth.is_empty()).map(|count| {
            let entries: Vec<String> = count.growth.iter().map(relative).collect();
            format!("{:e}: {}", count.tolerance, entries.join(", "))
        });
        let mut cells = vec![option_name(&growth.variant)];
        cells.extend(exponents.map(|exponent| or_dash(exponent, |exponent| format!("{exponent:.2}"))));
        cells.push(counts.collect::<Vec<String>>().join("; "));
        cells
    });
    let head = "solver | exponent of cold seconds in dofs | from s = 3 | warm | cold counts relative to s = 3";
    section("Growth at H/h = 7", head, rows)
}

fn failures(report: &ScalingReport) -> String {
    let failed = |row: &ScalingRow, failure: &String| [name(row), vec![failure.clone()]].concat();
    let rows = report.rows.iter().flat_map(|row| row.failures.iter().map(move |failure| failed(row, failure)));
    section("Not reached", "N/S | H/h | solver | what", rows)
}
