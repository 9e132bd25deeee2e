//! The rows as Markdown tables.

use crate::markdown::{or_dash, seconds as short, section};
use crate::rates::exponent;
use crate::scaling::cases::{RATIO, Variant, option_name};
use crate::scaling::measure::{COLD, ScalingRow, Start, TIMED};
use contact::equilibrium::StageSeconds;

/// One line for the terminal.
pub fn progress(row: &ScalingRow) -> String {
    let (seconds, products) = (row.cold().total_seconds(), row.cold().applications());
    format!("{}: {} dofs, cold {seconds:.2} s, {products} products", name(row).join(" "), row.dofs)
}

/// All tables.
pub fn markdown(machine_threads: usize, rows: &[ScalingRow]) -> String {
    let failed =
        rows.iter().flat_map(|row| row.failures.iter().map(|failure| [name(row), vec![failure.clone()]].concat()));
    format!("{machine_threads} threads run at once on this machine.\n")
        + &counts(rows)
        + &seconds(rows)
        + &growth(rows)
        + &of_files(rows)
        + &section("Not reached", "scene | solver | what", failed)
}

fn name(row: &ScalingRow) -> Vec<String> {
    let clusters = if row.clusters == 1 { String::new() } else { format!(", clusters of {}³", row.clusters) };
    vec![row.name.clone(), option_name(&row.variant) + &clusters]
}

fn counts(rows: &[ScalingRow]) -> String {
    let rows = rows.iter().filter(|row| row.variant != Variant::Direct).map(|row| {
        let count = |start, tolerance| or_dash(row.solve(start, tolerance), |solve| solve.applications().to_string());
        let mut cells = name(row);
        cells.extend([row.dofs, row.multipliers, row.contact_nodes].map(|n| n.to_string()));
        cells.push(or_dash(row.coarse_unknowns, |n| n.to_string()));
        cells.push(row.cold().work.newton_steps.to_string());
        cells.extend([COLD[0], TIMED, COLD[1]].map(|tolerance| count(Start::Cold, tolerance)));
        cells.extend([TIMED, COLD[1]].map(|tolerance| count(Start::Warm, tolerance)));
        cells.push(row.cold().adjoint.unwrap_or_default().applications.to_string());
        cells
    });
    let head = "scene | solver | dofs | rows of B | contact nodes | coarse unknowns | Newton steps, 1e-8 | cold 1e-6 | 1e-8 | \
                1e-10 | warm 1e-8 | 1e-10 | adjoint 1e-8";
    section("Counts (products with the dual operator)", head, rows)
}

fn seconds(rows: &[ScalingRow]) -> String {
    let rows = rows.iter().map(|row| {
        let stages = row.cold().stages;
        let stage = |value: fn(&StageSeconds) -> f64| or_dash(stages.as_ref(), |stages| short(value(stages)));
        let mut cells = name(row);
        cells.push(short(row.setup_seconds));
        cells.extend([stage(|s| s.factorization), stage(|s| s.coarse_space), stage(|s| s.newton)]);
        cells.push(short(row.cold().adjoint.unwrap_or_default().seconds));
        cells.extend(
            [Start::Cold, Start::Warm]
                .map(|start| or_dash(row.solve(start, TIMED), |solve| short(solve.total_seconds()))),
        );
        cells.push(or_dash(row.peak_memory, |gib| format!("{gib:.2}")));
        cells
    });
    let head = "scene | solver | setup, once | assembly + factors | coarse space | Newton/Krylov | adjoint | cold | warm | \
                peak GiB";
    section("Seconds and memory (state to 1e-8 and subgradient to 1e-8)", head, rows)
}

/// How the time of the default solver grows at fixed H/h.
fn growth(rows: &[ScalingRow]) -> String {
    let of = |least: usize| {
        let alike = rows.iter().filter(move |row| {
            let default = row.variant == Variant::Dirichlet && row.clusters == 1;
            default && row.case.is_some_and(|case| case.ratio() == RATIO && case.subdomains >= least)
        });
        exponent(alike.map(|row| [row.dofs as f64, row.cold().total_seconds()]))
    };
    let show = |exponent| or_dash(exponent, |exponent: f64| format!("{exponent:.2}"));
    format!("\nExponent of cold seconds in dofs at H/h = {RATIO}: {}; from s = 3 on: {}.\n", show(of(1)), show(of(3)))
}

/// How time and memory grow over scene files, per solver.
fn of_files(rows: &[ScalingRow]) -> String {
    let of = |variant: Variant| {
        let rows = || rows.iter().filter(move |row| row.case.is_none() && row.variant == variant);
        let seconds = exponent(rows().map(|row| [row.dofs as f64, row.cold().total_seconds()]))?;
        let memory = exponent(rows().filter_map(|row| Some([row.dofs as f64, row.peak_memory?])));
        let memory = or_dash(memory, |exponent: f64| format!("{exponent:.2}"));
        let name = option_name(&variant);
        Some(format!("\nExponents of {name} over the files: cold seconds {seconds:.2}, peak memory {memory}.\n"))
    };
    [Variant::Dirichlet, Variant::Lumped, Variant::Direct].into_iter().filter_map(of).collect()
}
