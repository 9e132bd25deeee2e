//! The numbers that `docs/measurements.md` begins with, computed anew and printed as their tables.
//!
//! Every number comes from a command of the contact binaries, so that anybody gets it by that command as well.

use crate::markdown::table;
use crate::scaling::{Case, SceneName, peak_memory};
use clap::Parser;
use problems::commands::{Arguments, Failure, arguments, execute, finish, print};
use scene_file::SceneFile;
use serde_json::Value;
use std::process::ExitCode;

/// The tables that docs/measurements.md begins with.
#[derive(Debug, Clone, Parser)]
#[command(name = "headline", version)]
struct Options {
    /// Also the runs of many minutes: one million dofs, and the optimizations at the paper's size.
    #[arg(long)]
    full: bool,
}

/// Runs a command of the binary of a scene; its JSON.
pub fn run(scene: SceneName, options: &[&str]) -> Result<Value, Failure> {
    let (name, text) = match scene {
        SceneName::Signorini => ("signorini.toml", include_str!("../../scenes/signorini.toml")),
        SceneName::Hertz => ("hertz.toml", include_str!("../../scenes/hertz.toml")),
    };
    let arguments = [&["contact"], options, &["--json"]].concat();
    let arguments = Arguments::try_parse_from(arguments).map_err(Failure::computation)?;
    let mut file = SceneFile::parse(text, name)?;
    // As by the binaries of these examples.
    file.optimizer.single = true;
    let text = execute(|| Ok((file.clone(), None)), &arguments)?;
    serde_json::from_str(&text).map_err(Failure::computation)
}

/// A number of a report.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// A pressure in MPa with its thousands apart.
fn pressure(value: &Value) -> String {
    let whole = number(value).round() as u64;
    if whole < 1000 { whole.to_string() } else { format!("{} {:03}", whole / 1000, whole % 1000) }
}

/// Evaluations of an optimization until Θ is at most `level`; none if it never is.
fn evaluations_to(report: &Value, level: f64) -> Option<usize> {
    // A failed evaluation has no value.
    let reached = |entry: &Value| entry["objective"].as_f64().is_some_and(|value| value <= level);
    report["course"].as_array()?.iter().position(reached).map(|index| index + 1)
}

/// A line of the table of docs/measurements.md for an optimization; `paper` is what stands beside the reduction.
fn line(report: &Value, name: &str, paper: &str, evaluations: &str) -> String {
    let (start, value) = (number(&report["objective_start"]), number(&report["objective"]));
    let values = format!("{} → {}", short(start, 3), short(value, if value < 2e16 { 4 } else { 3 }));
    let peaks = [0, 1].map(|end| pressure(&report["peak_pressure"][end])).join(" → ");
    format!("| {name} | {values} | {:.1} ({paper}) | {peaks} | {evaluations} |\n", start / value)
}

/// A number with so many digits after the point, the exponent without a sign.
fn short(value: f64, digits: usize) -> String {
    format!("{value:.digits$e}")
}

/// Values of Θ whose price in evaluations docs/measurements.md states for Examples 5.1 and 5.2, as printed there.
const LEVELS: [&str; 2] = ["1.4835e16", "1.8272e16"];

/// The line of an optimization in docs/measurements.md: Example 5.1 (0) or 5.2 (1) on 12³ bricks per body.
pub fn optimization_line(example: usize) -> Result<String, Failure> {
    let (scene, name, paper) = match example {
        0 => (SceneName::Signorini, "Signorini (Example 5.1)", "35.9 at 35³ bricks"),
        _ => (SceneName::Hertz, "Hertz (Example 5.2)", "8.65 at 2 × 25³ bricks"),
    };
    let (report, level) = (run(scene, &["optimize"])?, LEVELS[example.min(1)]);
    let reached = match evaluations_to(&report, level.parse().unwrap_or(f64::NAN)) {
        Some(count) => format!("{count} to {level}"),
        None => format!("{level} not reached"),
    };
    let end = if report["termination"]["confirmed"] == true { "confirmed" } else { "not confirmed" };
    Ok(line(&report, name, paper, &format!("{reached}, {} in all, {end}", report["evaluations"])))
}

/// A line of the table of states: Example 5.1 at its flat start by total FETI. Peak memory is that of the process.
pub fn state_line(case: Case) -> Result<String, Failure> {
    let Case { mesh, subdomains } = case;
    let (bricks, pieces) = (mesh.to_string(), subdomains.to_string());
    let size = ["--mesh", &bricks, "--subdomains", &pieces];
    let report = run(SceneName::Signorini, &[&["evaluate", "--solver", "newton"], &size[..]].concat())?;
    let work = |key: &str| report["work"][key].as_u64().unwrap_or(0);
    let adjoint = work("adjoint_applications");
    let nodes = ["open", "stick", "slip"].map(|status| report["status"][status].as_u64().unwrap_or(0));
    let seconds = number(&report["seconds"]["state"]) + number(&report["seconds"]["subgradient"]);
    let memory = peak_memory().map_or_else(|| "not told by this system".into(), |gib| format!("{gib:.2} GiB"));
    Ok(format!(
        "| {mesh}³ / {subdomains}³ | {} | {} | {} | {} + {adjoint} | {seconds:.1} | {memory} |\n",
        3 * (mesh + subdomains).pow(3),
        nodes.iter().sum::<u64>(),
        short(number(&report["objective"]), 10),
        work("dual_operator_applications") - adjoint,
    ))
}

/// The table of Example 5.3, and how many times the objective the shape found without friction has.
pub fn friction_table() -> Result<(String, f64), Failure> {
    let report = run(SceneName::Signorini, &["compare"])?;
    let rows = report["shapes"].as_array().into_iter().flatten().map(|shape| {
        let mut cells = vec![shape["shape"].as_str().unwrap_or_default().to_owned()];
        for model in ["with", "without"] {
            cells.push(short(number(&shape[format!("objective_{model}_friction")]), 6));
            cells.push(format!("{:.1}", number(&shape[format!("peak_pressure_{model}_friction")])));
        }
        cells
    });
    let text = table("shape | Θ with friction 0.3 | peak, MPa | Θ without friction | peak, MPa", rows);
    Ok((text, number(&report["loss_without_friction_in_the_model"])))
}

/// The table of Example 5.1 at the paper's size.
fn paper_size_table() -> Result<String, Failure> {
    let size = ["optimize", "--mesh", "35", "--subdomains", "5"];
    let mut rows = Vec::new();
    for (name, options) in [
        ("clamped cubic B-spline 6×6", &["--max-evaluations", "50"][..]),
        ("Bézier 6×6", &["--degrees", "5", "--max-evaluations", "50"]),
        ("Bézier 8×8", &["--degrees", "7", "--control-points", "8x8", "--max-evaluations", "60"]),
    ] {
        let report = run(SceneName::Signorini, &[&size, options].concat())?;
        let (options, value) = (format!("`{}`", options.join(" ")), short(number(&report["objective"]), 4));
        rows.push(vec![name.to_owned(), options, value, report["evaluations"].to_string()]);
    }
    Ok(table("surface | options | Θ | evaluations", rows))
}

/// Runs the binary: prints the tables as they come.
pub fn main() -> ExitCode {
    finish(print_tables(&arguments()).map(|()| String::new()), None)
}

fn print_tables(options: &Options) -> Result<(), Failure> {
    let states = "bricks / subdomains | torn dofs | contact nodes | Θ | products with F (state + adjoint) | seconds | peak memory";
    say(&format!("States (Example 5.1, flat start, cold)\n\n{}", table(states, [])))?;
    let sizes = [(12, 2), (35, 5), (63, 9)];
    // From small to large, so that the peak of the process is that of the line.
    for (mesh, subdomains) in sizes.into_iter().take(if options.full { 3 } else { 2 }) {
        say(&state_line(Case { mesh, subdomains })?)?;
    }
    let optimizations = "scene | Θ start → found | reduction (paper's) | peak pressure, MPa | evaluations";
    let lines = [table(optimizations, []), optimization_line(0)?, optimization_line(1)?];
    say(&format!("\nOptimizations\n\n{}", lines.concat()))?;
    say(&format!("\nExample 5.3\n\n{}\n", friction_table()?.0))?;
    if options.full {
        say(&format!("Example 5.1 at the paper's size\n\n{}\n", paper_size_table()?))?;
    }
    Ok(())
}

/// Prints a part of the page.
fn say(text: &str) -> Result<(), Failure> {
    print(text).map_err(|error| Failure::Computation(format!("stdout: {error}; the result was not printed")))
}
