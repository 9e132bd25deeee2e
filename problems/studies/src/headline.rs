//! The numbers that README.md and `docs/results.md` begin with, computed anew and printed as their tables.
//!
//! Every number comes from a command of the contact binaries, so that anybody gets it by that command as well.

use crate::scaling::{Case, SceneName, peak_memory};
use clap::Parser;
use problems::commands::{Arguments, Failure, execute};
use scene_file::SceneFile;
use serde_json::Value;
use std::process::ExitCode;

/// The tables of README.md and docs/results.md.
#[derive(Debug, Clone, Parser)]
#[command(version)]
struct Options {
    /// Also the runs of many minutes: one million dofs, and the optimizations at the paper's size.
    #[arg(long)]
    full: bool,
}

/// An optimization as its command reports it.
#[derive(Debug, Clone)]
pub struct Descent {
    /// The JSON of the command.
    report: Value,
}

/// Runs a command of the binary of a scene; its JSON.
///
/// # Errors
/// [`Failure`] of the command.
pub fn run(scene: SceneName, options: &[&str]) -> Result<Value, Failure> {
    let (name, text) = match scene {
        SceneName::Signorini => ("signorini.toml", include_str!("../../scenes/signorini.toml")),
        SceneName::Hertz => ("hertz.toml", include_str!("../../scenes/hertz.toml")),
    };
    let arguments = [&["contact"], options, &["--json"]].concat();
    let arguments = Arguments::try_parse_from(arguments).map_err(Failure::computation)?;
    let text = execute(|| Ok((SceneFile::parse(text, name)?, None)), &arguments)?;
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

impl Descent {
    /// Optimizes a scene with the options of its binary.
    ///
    /// # Errors
    /// [`Failure`] of the command.
    pub fn of(scene: SceneName, options: &[&str]) -> Result<Self, Failure> {
        Ok(Self { report: run(scene, options)? })
    }

    /// Θ at the start.
    pub fn start(&self) -> f64 {
        number(&self.report["objective_start"])
    }

    /// Least Θ found.
    pub fn value(&self) -> f64 {
        number(&self.report["objective"])
    }

    /// Θ at the start over the least Θ.
    pub fn reduction(&self) -> f64 {
        self.start() / self.value()
    }

    /// Evaluations in all.
    pub fn evaluations(&self) -> usize {
        self.report["history"].as_array().map_or(0, Vec::len)
    }

    /// Evaluations until Θ is at most `level`; none if it never is.
    pub fn evaluations_to(&self, level: f64) -> Option<usize> {
        let history = self.report["history"].as_array()?;
        // A failed evaluation has no value.
        history.iter().position(|value| value.as_f64().is_some_and(|value| value <= level)).map(|index| index + 1)
    }

    /// Largest pressure at the start and at the end, MPa.
    pub fn peaks(&self) -> String {
        let peaks = &self.report["peak_pressure"];
        format!("{} → {}", pressure(&peaks[0]), pressure(&peaks[1]))
    }

    /// A line of the table of README.md; `paper` is what stands beside the reduction.
    pub fn line(&self, name: &str, paper: &str, evaluations: &str) -> String {
        let (start, value, reduction) = (self.start(), self.value(), self.reduction());
        let values = format!("{} → {}", short(start, 3), short(value, if value < 2e16 { 4 } else { 3 }));
        format!("| {name} | {values} | {reduction:.1} ({paper}) | {} | {evaluations} |\n", self.peaks())
    }
}

/// A number with so many digits after the point, the exponent without a sign.
fn short(value: f64, digits: usize) -> String {
    format!("{value:.digits$e}")
}

/// Values of Θ whose price in evaluations README.md states for Example 5.1, as printed there.
pub const LEVELS: [&str; 3] = ["1.4985e16", "1.4835e16", "1.4771e16"];

/// The line of Example 5.1 (12³ bricks) in README.md.
///
/// # Errors
/// [`Failure`] of the command.
pub fn signorini_line() -> Result<String, Failure> {
    let descent = Descent::of(SceneName::Signorini, &["optimize"])?;
    let reached = LEVELS.map(|level| match descent.evaluations_to(level.parse().unwrap_or(f64::NAN)) {
        Some(count) => format!("{count} to {level}"),
        None => format!("{level} not reached"),
    });
    Ok(descent.line("Signorini (Example 5.1)", "35.9 at 35³ bricks", &reached.join(", ")))
}

/// The line of Example 5.2 (12³ bricks per body) in README.md.
///
/// # Errors
/// [`Failure`] of the command.
pub fn hertz_line() -> Result<String, Failure> {
    /// Reduction whose price is stated.
    const REDUCTION: f64 = 12.0;
    let descent = Descent::of(SceneName::Hertz, &["optimize"])?;
    let reached = descent.evaluations_to(descent.start() / REDUCTION);
    let reached = reached.map_or_else(|| "none".into(), |count| count.to_string());
    let evaluations = format!("{reached} to a reduction of {REDUCTION}, {} in all", descent.evaluations());
    Ok(descent.line("Hertz (Example 5.2)", "8.65 at 2 × 25³ bricks", &evaluations))
}

/// A line of the table of states in README.md: Example 5.1 at its flat start. Peak memory is that of the process so far.
///
/// # Errors
/// [`Failure`] of the command.
pub fn state_line(case: Case) -> Result<String, Failure> {
    let Case { mesh, subdomains } = case;
    let (bricks, pieces) = (mesh.to_string(), subdomains.to_string());
    let report = run(SceneName::Signorini, &["evaluate", "--mesh", &bricks, "--subdomains", &pieces])?;
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

/// The table of Example 5.3 in docs/results.md, and how many times the objective the shape found without friction has.
///
/// # Errors
/// [`Failure`] of the command.
pub fn friction_table() -> Result<(String, f64), Failure> {
    let report = run(SceneName::Signorini, &["compare"])?;
    let mut text = String::from(
        "| shape | Θ with friction 0.3 | peak, MPa | Θ without friction | peak, MPa |\n|---|---|---|---|---|\n",
    );
    for shape in report["shapes"].as_array().into_iter().flatten() {
        let cells = ["with", "without"].map(|model| {
            let objective = number(&shape[format!("objective_{model}_friction")]);
            format!("{} | {:.1}", short(objective, 6), number(&shape[format!("peak_pressure_{model}_friction")]))
        });
        text += &format!("| {} | {} |\n", shape["shape"].as_str().unwrap_or_default(), cells.join(" | "));
    }
    Ok((text, number(&report["loss_without_friction_in_the_model"])))
}

/// The table of Example 5.1 at the paper's size in docs/results.md.
fn paper_size_table() -> Result<String, Failure> {
    let mut text = String::from("| surface | options | Θ | evaluations |\n|---|---|---|---|\n");
    let size = ["optimize", "--mesh", "35", "--subdomains", "5"];
    for (name, options) in [
        ("clamped cubic B-spline 6×6", &["--max-evaluations", "50"][..]),
        ("Bézier 6×6", &["--surface", "bezier", "--max-evaluations", "50"]),
        ("Bézier 8×8", &["--surface", "bezier", "--control-points", "8x8", "--max-evaluations", "60"]),
    ] {
        let descent = Descent::of(SceneName::Signorini, &[&size, options].concat())?;
        let options = options.join(" ");
        text += &format!("| {name} | `{options}` | {} | {} |\n", short(descent.value(), 4), descent.evaluations());
    }
    Ok(text)
}

/// Runs the binary: prints the tables as they come.
pub fn main() -> ExitCode {
    match print_tables(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

fn print_tables(options: &Options) -> Result<(), Failure> {
    println!("States (Example 5.1, flat start, cold)\n");
    println!(
        "| bricks / subdomains | torn dofs | contact nodes | Θ | products with F (state + adjoint) | seconds | peak memory |"
    );
    println!("|---|---|---|---|---|---|---|");
    let sizes = [(12, 2), (35, 5), (63, 9)];
    // From small to large, so that the peak of the process is that of the line.
    for (mesh, subdomains) in sizes.into_iter().take(if options.full { 3 } else { 2 }) {
        print!("{}", state_line(Case { mesh, subdomains })?);
    }
    println!("\nOptimizations\n\n| scene | Θ start → found | reduction (paper's) | peak pressure, MPa | evaluations |");
    print!("|---|---|---|---|---|\n{}{}", signorini_line()?, hertz_line()?);
    println!("\nExample 5.3\n\n{}", friction_table()?.0);
    if options.full {
        println!("Example 5.1 at the paper's size\n\n{}", paper_size_table()?);
    }
    Ok(())
}
