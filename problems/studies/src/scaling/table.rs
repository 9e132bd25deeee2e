//! The report as Markdown tables.

use crate::scaling::cases::{Variant, word};
use crate::scaling::measure::COLD;
use crate::scaling::repeat::TIMED;
use crate::scaling::report::Report;
use crate::scaling::row::Row;
use crate::scaling::solve::Start;
use contact::equilibrium::StageSeconds;
use std::fmt::Write;

/// One line for the terminal.
pub fn progress(row: &Row) -> String {
    format!(
        "{} {} {}: {} dofs, cold {:.2} s, {} products",
        word(&row.scene),
        row.case,
        word(&row.variant),
        row.dofs,
        row.cold.seconds(),
        row.cold.state.applications()
    )
}

/// All tables.
pub fn markdown(report: &Report) -> String {
    let parts = [
        format!("{} threads run at once on this machine.\n", report.machine_threads),
        section("Counts (products with the dual operator)", &counts(report)),
        section("The paper's path: steps of the cold state to 1e-8, products and error of Σσ⁴ at 1e-6", &paper(report)),
        section("Seconds and memory (state to 1e-8 and subgradient to 1e-8)", &seconds(report)),
        section("Threads (cold state and subgradient)", &threads(report)),
        section("Dual operator and memory bandwidth", &bandwidth(report)),
        section("Against direct condensation", &direct(report)),
        section("Growth at H/h = 7", &growth(report)),
        section("Not reached", &failures(report)),
    ];
    parts.concat()
}

fn section(title: &str, body: &str) -> String {
    if body.lines().count() <= 2 { String::new() } else { format!("\n### {title}\n\n{body}") }
}

/// Head and rule of a table.
fn head(columns: &[&str]) -> String {
    format!("| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()))
}

fn line(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn name(row: &Row) -> [String; 3] {
    [row.case.to_string(), row.case.ratio().to_string(), word(&row.variant)]
}

fn or_dash<T>(value: Option<T>, show: impl Fn(T) -> String) -> String {
    value.map_or_else(|| "–".into(), show)
}

fn short(seconds: f64) -> String {
    if seconds < 0.1 { format!("{seconds:.4}") } else { format!("{seconds:.2}") }
}

fn counts(report: &Report) -> String {
    let mut text = head(&[
        "N/S",
        "H/h",
        "solver",
        "dofs",
        "multipliers",
        "contact nodes",
        "Newton steps, 1e-8",
        "cold 1e-6",
        "1e-8",
        "1e-10",
        "warm 1e-8",
        "1e-10",
        "adjoint 1e-8",
    ]);
    for row in report.rows.iter().filter(|row| row.variant != Variant::Direct) {
        let count = |start, tolerance| or_dash(row.solve(start, tolerance), |solve| solve.applications().to_string());
        let mut cells = name(row).to_vec();
        cells.extend(
            [row.dofs, row.multipliers, row.contact_nodes, row.cold.state.work.newton_steps].map(|n| n.to_string()),
        );
        cells.extend([COLD[0], TIMED, COLD[1]].map(|tolerance| count(Start::Cold, tolerance)));
        cells.extend([TIMED, COLD[1]].map(|tolerance| count(Start::Warm, tolerance)));
        cells.push(row.cold.adjoint.applications.to_string());
        text += &line(&cells);
    }
    text
}

fn paper(report: &Report) -> String {
    let mut text =
        head(&["N/S", "H/h", "Tresca problems", "cg", "expansion", "proportioning", "products, 1e-6", "error of Σσ⁴"]);
    for row in report.rows.iter().filter(|row| row.variant == Variant::AugmentedLagrangian) {
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
        text += &line(&cells);
    }
    text
}

/// The row of the same case with another solver.
fn alike<'a>(report: &'a Report, row: &Row, variant: Variant) -> Option<&'a Row> {
    report.rows.iter().find(|other| other.case == row.case && other.scene == row.scene && other.variant == variant)
}

fn seconds(report: &Report) -> String {
    let mut text = head(&[
        "N/S",
        "H/h",
        "solver",
        "setup, once",
        "assembly + factors",
        "coarse space",
        "Newton/Krylov",
        "rest",
        "adjoint",
        "shape derivative",
        "cold",
        "warm",
        "peak GiB",
    ]);
    for row in &report.rows {
        let stages = row.cold.state.stages;
        let stage = |value: fn(&StageSeconds) -> f64| or_dash(stages.as_ref(), |stages| short(value(stages)));
        let mut cells = name(row).to_vec();
        cells.push(short(row.setup_seconds));
        cells.extend([stage(|s| s.factorization), stage(|s| s.coarse_space), stage(|s| s.newton)]);
        cells.push(stage(|s| s.equilibrium + s.recovery));
        let torn = row.variant != Variant::Direct;
        cells.push(short(row.cold.adjoint.seconds));
        cells.push(if torn { short(row.cold.adjoint.shape_seconds) } else { "–".into() });
        cells.push(short(row.cold.seconds()));
        cells.push(or_dash(row.warm.as_ref(), |warm| short(warm.seconds())));
        cells.push(row.peak_memory.map_or_else(|| "not told by this system".into(), |gib| format!("{gib:.2}")));
        text += &line(&cells);
    }
    text
}

fn threads(report: &Report) -> String {
    let mut text = head(&["N/S", "H/h", "solver", "1 thread, s", "2 threads, s", "speedup", "bitwise equal (1, 2, 4)"]);
    for (row, threads) in report.rows.iter().filter_map(|row| Some((row, row.threads.as_ref()?))) {
        let times: Vec<f64> = threads.samples.iter().map(|sample| sample.sample.seconds()).collect();
        let mut cells = name(row).to_vec();
        cells.extend(times.iter().map(|time| short(*time)));
        cells.push(format!("{:.2}", times[0] / times[times.len() - 1]));
        cells.push(if threads.bitwise_equal { "yes" } else { "no" }.into());
        text += &line(&cells);
    }
    text
}

fn bandwidth(report: &Report) -> String {
    let mut text = head(&[
        "N/S",
        "H/h",
        "solver",
        "threads",
        "ms per F",
        "ms per preconditioner",
        "factor values, MiB",
        "F reads, GB/s (two sweeps)",
        "triad, GB/s",
        "fraction",
    ]);
    for (row, b) in report.rows.iter().flat_map(|row| row.bandwidth.iter().map(move |b| (row, b))) {
        let mut cells = name(row).to_vec();
        cells.push(b.threads.to_string());
        cells.extend([1e3 * b.application_seconds, 1e3 * b.preconditioner_seconds].map(|ms| format!("{ms:.2}")));
        cells.push(format!("{:.1}", b.factor_bytes / (1024.0 * 1024.0)));
        cells.extend([b.operator_bytes_per_second, b.triad_bytes_per_second].map(|rate| format!("{:.1}", 1e-9 * rate)));
        cells.push(format!("{:.2}", b.fraction));
        text += &line(&cells);
    }
    text
}

fn direct(report: &Report) -> String {
    let mut text = head(&["N/S", "direct cold, s", "warm", "TFETI (dirichlet) cold, s", "warm", "ratio cold", "warm"]);
    for direct in report.rows.iter().filter(|row| row.variant == Variant::Direct) {
        let Some(torn) = alike(report, direct, Variant::Dirichlet) else { continue };
        let warm = |row: &Row| row.warm.as_ref().map(|warm| warm.seconds());
        let times = [Some(direct.cold.seconds()), warm(direct), Some(torn.cold.seconds()), warm(torn)];
        let mut cells = vec![direct.case.to_string()];
        cells.extend(times.map(|time| or_dash(time, short)));
        for (slow, fast) in [(times[0], times[2]), (times[1], times[3])] {
            cells.push(or_dash(slow.zip(fast), |(slow, fast)| format!("{:.2}", slow / fast)));
        }
        text += &line(&cells);
    }
    text
}

fn growth(report: &Report) -> String {
    let mut text =
        head(&["solver", "exponent of cold seconds in dofs", "from s = 3", "warm", "cold counts relative to s = 3"]);
    for growth in &report.growth {
        let exponents = [growth.cold_exponent, growth.cold_exponent_large, growth.warm_exponent];
        let mut counts = String::new();
        for count in growth.counts.iter().filter(|count| !count.growth.is_empty()) {
            let entries: Vec<String> =
                count.growth.iter().map(|(s, growth)| format!("s = {s}: {:+.0} %", 100.0 * growth)).collect();
            // Writing to a string cannot fail.
            let _ = write!(counts, "{:e}: {}; ", count.tolerance, entries.join(", "));
        }
        let mut cells = vec![word(&growth.variant)];
        cells.extend(exponents.map(|exponent| or_dash(exponent, |exponent| format!("{exponent:.2}"))));
        cells.push(counts.trim_end_matches("; ").into());
        text += &line(&cells);
    }
    text
}

fn failures(report: &Report) -> String {
    let mut text = head(&["N/S", "H/h", "solver", "what"]);
    for row in &report.rows {
        for failure in &row.failures {
            let mut cells = name(row).to_vec();
            cells.push(failure.clone());
            text += &line(&cells);
        }
    }
    text
}
