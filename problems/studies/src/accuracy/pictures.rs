//! The pictures of a report: what a smaller error costs.

use crate::accuracy::algebra::AlgebraStudy;
use crate::accuracy::cli::AccuracyReport;
use crate::accuracy::discretisation::{MeshStudy, QUANTITIES};
use crate::accuracy::optimization::OptimizationStudy;
use crate::scaling::option_name;
use figures::{Figure, FigureError, LogPlot, Series};

/// All pictures of a report.
///
/// # Errors
/// [`FigureError`] for numbers that are not finite.
pub fn all(report: &AccuracyReport) -> Result<Vec<Figure>, FigureError> {
    let meshes = report.discretisation.iter().map(mesh);
    let plots = meshes.chain(report.algebra.iter().map(solvers)).chain(report.optimization.iter().map(optimization));
    plots.map(|plot| plot.figure()).collect()
}

fn joined(name: &str, points: impl Iterator<Item = (f64, f64)>) -> Series {
    Series { name: name.to_owned(), points: points.collect(), joined: true }
}

/// Guides of the rates 1 and 2 through the first error of the first quantity.
fn mesh(study: &MeshStudy) -> LogPlot {
    let anchor = study.rows.first().map_or((1.0, 1.0), |row| (row.bricks as f64, row.errors[0]));
    let of = |(index, name): (usize, &&str)| {
        joined(name, study.rows.iter().map(|row| (row.bricks as f64, row.errors[index])))
    };
    let scene = option_name(&study.scene);
    LogPlot {
        name: format!("accuracy_mesh_{scene}"),
        title: format!("{scene}: error of the discretisation"),
        x: "bricks per edge of each body".into(),
        y: "error relative to the extrapolated limit".into(),
        series: QUANTITIES.iter().enumerate().map(of).collect(),
        guides: [1.0, 2.0].map(|rate| (format!("rate {rate}"), anchor.1 * anchor.0.powf(rate), -rate)).into(),
    }
}

fn solvers(study: &AlgebraStudy) -> LogPlot {
    let of_method = study.rows.chunk_by(|one, next| one.method == next.method);
    let scene = option_name(&study.scene);
    LogPlot {
        name: format!("accuracy_solvers_{scene}"),
        title: format!("{scene}, {}³ bricks: what a smaller error of Θ costs", study.bricks),
        x: "seconds of state and subgradient".into(),
        y: "relative error of Θ by the solver".into(),
        series: of_method.map(|rows| joined(rows[0].method, rows.iter().map(|row| (row.seconds, row.value)))).collect(),
        guides: vec![],
    }
}

fn optimization(study: &OptimizationStudy) -> LogPlot {
    let distance = |best: f64| best / study.lowest - 1.0;
    let courses = study.courses.iter();
    let scene = option_name(&study.scene);
    LogPlot {
        name: format!("accuracy_optimization_work_{scene}"),
        title: format!("{scene}, {}³ bricks: distance from the lowest Θ found", study.fine),
        x: "products with the dual operator of the finest mesh".into(),
        y: "(Θ(best) − Θ*)/Θ*".into(),
        series: courses
            .map(|course| joined(course.strategy, course.points.iter().map(|point| (point.work, distance(point.best)))))
            .collect(),
        guides: vec![],
    }
}
