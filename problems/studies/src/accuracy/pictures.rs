//! The pictures of a report.

use crate::accuracy::algebra::{AlgebraRow, AlgebraStudy};
use crate::accuracy::discretisation::{MeshStudy, QUANTITIES};
use crate::accuracy::optimization::{Course, Milestone, OptimizationStudy};
use crate::accuracy::report::AccuracyReport;
use crate::accuracy::subgradient::{SubgradientStudy, TaylorStudy};
use crate::scaling::option_name;
use figures::{Figure, FigureError, LogPlot, Series};

/// All pictures of a report.
///
/// # Errors
/// [`FigureError`] for numbers that are not finite.
pub fn all(report: &AccuracyReport) -> Result<Vec<Figure>, FigureError> {
    let mut plots = Vec::new();
    plots.extend(report.discretisation.iter().map(mesh));
    for study in &report.algebra {
        plots.extend([solvers(study), estimate(study), slopes(study)]);
    }
    plots.extend(report.subgradient.as_ref().map(taylor));
    for study in &report.optimization {
        plots.push(optimization(study, "seconds", "seconds", |point| point.seconds));
        let products = "products with the dual operator of the finest mesh";
        plots.push(optimization(study, "work", products, |point| point.work));
    }
    plots.iter().map(LogPlot::figure).collect()
}

/// Guides of the rates 1 and 2 through the first error of the first quantity.
fn mesh(study: &MeshStudy) -> LogPlot {
    let anchor = study.rows.first().map_or((1.0, 1.0), |row| (row.bricks as f64, row.errors[0]));
    let guide = |rate: f64| (format!("rate {rate}"), anchor.1 * anchor.0.powf(rate), -rate);
    let of = |(index, name): (usize, &&str)| Series {
        name: (*name).to_owned(),
        points: study.rows.iter().map(|row| (row.bricks as f64, row.errors[index])).collect(),
        joined: true,
    };
    LogPlot {
        name: format!("accuracy_mesh_{}", option_name(&study.scene)),
        title: format!("{}: error of the discretisation", option_name(&study.scene)),
        x: "bricks per edge of each body".into(),
        y: "error relative to the extrapolated limit".into(),
        series: QUANTITIES.iter().enumerate().map(of).collect(),
        guides: vec![guide(1.0), guide(2.0)],
    }
}

fn by_method(study: &AlgebraStudy, joined: bool, point: impl Fn(&AlgebraRow) -> (f64, f64)) -> Vec<Series> {
    let mut series: Vec<Series> = Vec::new();
    for row in &study.rows {
        match series.iter_mut().find(|series| series.name == row.method) {
            Some(series) => series.points.push(point(row)),
            None => series.push(Series { name: row.method.to_owned(), points: vec![point(row)], joined }),
        }
    }
    series
}

fn solvers(study: &AlgebraStudy) -> LogPlot {
    LogPlot {
        name: format!("accuracy_solvers_{}", option_name(&study.scene)),
        title: format!("{}, {}³ bricks: what a smaller error of Θ costs", option_name(&study.scene), study.bricks),
        x: "seconds of state and subgradient".into(),
        y: "relative error of Θ by the solver".into(),
        series: by_method(study, true, |row| (row.seconds, row.value)),
        guides: vec![],
    }
}

fn estimate(study: &AlgebraStudy) -> LogPlot {
    LogPlot {
        name: format!("accuracy_estimate_{}", option_name(&study.scene)),
        title: format!("{}: the bound reported against the true error of Θ", option_name(&study.scene)),
        x: "true relative error of Θ".into(),
        y: "relative bound reported by the solver".into(),
        series: by_method(study, false, |row| (row.value, row.bound)),
        guides: vec![("bound = error".into(), 1.0, 1.0)],
    }
}

fn slopes(study: &AlgebraStudy) -> LogPlot {
    LogPlot {
        name: format!("accuracy_subgradient_{}", option_name(&study.scene)),
        title: format!("{}, {}³ bricks: error of the subgradient", option_name(&study.scene), study.bricks),
        x: "relative accuracy asked for".into(),
        y: "|ξ − ξ*|/|ξ*|".into(),
        series: by_method(study, true, |row| (row.tolerance, row.subgradient)),
        guides: vec![("error = accuracy".into(), 1.0, 1.0)],
    }
}

fn taylor(study: &SubgradientStudy) -> LogPlot {
    let of = |taylor: &TaylorStudy| {
        let value = taylor.test.rows.first().map_or(1.0, |row| row.remainder);
        Series {
            name: taylor.scene.clone(),
            points: taylor.test.rows.iter().map(|row| (row.step, row.remainder / value)).collect(),
            joined: true,
        }
    };
    let series: Vec<Series> = study.taylor.iter().map(of).collect();
    let anchor = series.first().and_then(|series| series.points.first()).map_or(1.0, |point| point.0);
    LogPlot {
        name: "accuracy_taylor".into(),
        title: "Taylor remainder of Θ with the subgradient (2 is right)".into(),
        x: "step along a random direction".into(),
        y: "|Θ(α + hd) − Θ(α) − h⟨ξ, d⟩|, scaled".into(),
        series,
        guides: vec![("slope 2".into(), anchor.powi(-2), 2.0)],
    }
}

/// Distance from the lowest Θ over a measure of the price: the name of the axis in the file, its title, and the value.
fn optimization(study: &OptimizationStudy, axis_name: &str, axis: &str, price: fn(&Milestone) -> f64) -> LogPlot {
    let of = |course: &Course| Series {
        name: course.strategy.to_owned(),
        points: course.points.iter().map(|point| (price(point), point.best / study.lowest - 1.0)).collect(),
        joined: true,
    };
    let fine = study.levels[study.levels.len() - 1];
    LogPlot {
        name: format!("accuracy_optimization_{axis_name}_{}", option_name(&study.scene)),
        title: format!("{}, {fine}³ bricks: distance from the lowest Θ found", option_name(&study.scene)),
        x: axis.into(),
        y: "(Θ(best) − Θ*)/Θ*".into(),
        series: study.courses.iter().map(of).collect(),
        guides: vec![],
    }
}
