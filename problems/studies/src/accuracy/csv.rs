//! All numbers of a report as one long table.

use crate::accuracy::Report;
use crate::accuracy::discretisation::QUANTITIES;
use crate::scaling::word;
use std::fmt::Write;

/// `part,scene,series,parameter,quantity,value`, one number per line; `parameter` is bricks, tolerance, step or evaluation.
pub fn table(report: &Report) -> String {
    let mut text = String::from("part,scene,series,parameter,quantity,value\n");
    let mut put = |keys: [&str; 3], parameter: f64, quantity: &str, value: f64| {
        let [part, scene, series] = keys.map(|key| key.replace(',', ";"));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{part},{scene},{series},{parameter},{quantity},{value}");
    };
    for row in &report.smooth {
        let keys = ["smooth", "wave", "trilinear bricks"];
        for (quantity, value) in [("displacement error", row.displacement), ("energy error", row.energy)] {
            put(keys, row.bricks as f64, quantity, value);
        }
    }
    for study in &report.discretisation {
        for row in &study.rows {
            for (index, name) in QUANTITIES.into_iter().enumerate() {
                let keys = ["discretisation", &word(&study.scene), name];
                put(keys, row.bricks as f64, "value", row.values[index]);
                put(keys, row.bricks as f64, "error", row.errors[index]);
                put(keys, row.bricks as f64, "seconds", row.seconds);
            }
        }
    }
    for study in &report.algebra {
        for row in &study.rows {
            let numbers = [
                ("seconds", row.seconds),
                ("products", row.products as f64),
                ("residual", row.residual),
                ("pressure error", row.pressure),
                ("value error", row.value),
                ("value bound", row.bound),
                ("corrected value error", row.corrected),
                ("subgradient error", row.subgradient),
            ];
            for (quantity, value) in numbers {
                put(["algebra", &word(&study.scene), row.method], row.tolerance, quantity, value);
            }
        }
    }
    if let Some(study) = &report.subgradient {
        for taylor in &study.taylor {
            for row in &taylor.test.rows {
                put(["taylor", &taylor.scene, "remainder"], row.step, "remainder", row.remainder);
                put(["taylor", &taylor.scene, "remainder"], row.step, "derivative error", row.derivative_error);
            }
        }
        for kink in &study.kinks {
            let numbers = [("slope before", kink.before), ("slope after", kink.after), ("product", kink.product)];
            for (quantity, value) in numbers {
                put(["kink", &kink.scene, &kink.change], kink.position, quantity, value);
            }
        }
    }
    for study in &report.optimization {
        for course in &study.courses {
            for point in &course.points {
                let keys = ["optimization", &word(&study.scene), course.strategy];
                put(keys, point.evaluations as f64, "seconds", point.seconds);
                put(keys, point.evaluations as f64, "products", point.work);
                put(keys, point.evaluations as f64, "distance", point.best / study.lowest - 1.0);
            }
        }
        for row in &study.peaks {
            let keys = ["optimization", &word(&study.scene), row.measure.as_str()];
            put(keys, row.evaluations as f64, "peak pressure", row.peak);
            put(keys, row.evaluations as f64, "sum of fourth powers", row.norm);
        }
    }
    text
}
