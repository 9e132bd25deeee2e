//! The comparison of optimizations with and without friction: table, conclusion, JSON.

use crate::commands::facts::{Fact, Facts, Group};
use crate::commands::failure::Failure;
use crate::commands::limited_value::LimitedValue;
use crate::commands::numbers::{number, raised, rounded};
use crate::commands::optimize::summary::ending;
use crate::commands::report::Relief;
use crate::commands::scene_words;
use crate::commands::solved_shape::SolvedShape;
use contact::solvers::Usage;
use scene_file::optimization::ContactRun;
use serde::Serialize;

/// Relative loss of the objective up to which leaving friction out counts as cheap.
const MAX_NEGLIGIBLE_LOSS: f64 = 0.02;
/// Relative difference of the objective up to which two shapes count as equally good.
const MAX_EQUAL_DIFFERENCE: f64 = 1e-4;
/// Objectives below this share of the start's are zero up to rounding.
const ZERO: f64 = 1e-12;

/// Two optimizations, and their shapes solved in both models. Pairs hold the case with friction first.
pub struct Comparison<'a> {
    /// The optimizations, on their last mesh.
    pub runs: [&'a ContactRun; 2],
    /// Start and optimum of each, in its own model.
    pub own: [&'a [SolvedShape; 2]; 2],
    /// The shape found without friction, solved with friction; the shape found with friction, solved without.
    pub crossed: [SolvedShape; 2],
}

/// How far two surfaces are apart, mm.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SurfaceDifference {
    /// Difference of the mean heights, or of the mean outward displacements by a lattice.
    pub mean: f64,
    /// Root mean square of the rest.
    pub shape: f64,
    /// Root mean square by which the surface found with friction departs from a plane of its mean height.
    pub variation: f64,
}

impl Comparison<'_> {
    fn friction(&self) -> String {
        scene_words::friction(&self.runs[0].stage.objective.solver().problem().scene)
    }

    /// Θ of the shape found without friction over that of the shape found with friction, both with friction; none where
    /// the latter is zero up to rounding.
    pub fn loss(&self) -> Option<f64> {
        let [with, without] = self.with_friction();
        (with > ZERO * self.own[0][0].value).then_some(without / with)
    }

    /// Θ with friction of the shape found with friction, and of the shape found without.
    fn with_friction(&self) -> [f64; 2] {
        [self.own[0][1].value, self.crossed[0].value]
    }

    /// The distance of the two optimized surfaces over the nodes of all contact surfaces that controls move.
    pub fn surface_difference(&self) -> SurfaceDifference {
        let problem = self.runs[0].stage.objective.solver().problem();
        let positions = self.own.map(|shapes| problem.map.positions(shapes[1].controls.as_slice()));
        let (mut differences, mut heights) = (Vec::new(), Vec::new());
        for relief in Relief::all(problem) {
            let [with, without] = positions.each_ref().map(|positions| relief.outward(positions));
            differences.push(without.iter().zip(&with).map(|(a, b)| a - b).collect::<Vec<f64>>());
            heights.push(with);
        }
        let (mean, shape) = of_surfaces(&differences);
        SurfaceDifference { mean, shape, variation: of_surfaces(&heights).1 }
    }

    /// All facts: what friction is worth, whether that is confirmed, and the start and both optima in both models; with
    /// what several processes have used.
    ///
    /// # Errors
    /// [`Failure::Computation`] for a value that has no JSON.
    pub fn facts(&self, processes: Option<&Usage>) -> Result<Facts, Failure> {
        let names = ["start", "optimized with friction", "optimized without friction"];
        let [with, without] = self.own;
        let models = [[&with[0], &with[1], &self.crossed[0]], [&without[0], &self.crossed[1], &without[1]]];
        let (unit, friction) = (raised(&self.runs[0].stage.objective.unit()), format!("friction {}", self.friction()));
        let row = |key, name: &str, model: usize, unit: &str, value: fn(&SolvedShape) -> f64| {
            let name = format!("{name}, {}", [friction.as_str(), "no friction"][model]);
            Fact::row(key, &name, models[model].map(|shape| value(shape).into()).into(), unit)
        };
        let mut shapes = vec![
            Fact::row("shapes.shape", "", names.map(|name| name.to_owned().into()).into(), ""),
            row("shapes.peak_pressure_with_friction", "peak pressure", 0, "MPa", |shape| shape.peak_pressure),
            row("shapes.objective_with_friction", "objective Θ", 0, &unit, |shape| shape.value),
            row("shapes.peak_pressure_without_friction", "peak pressure", 1, "MPa", |shape| shape.peak_pressure),
            row("shapes.objective_without_friction", "objective Θ", 1, &unit, |shape| shape.value),
        ];
        let violations = models[0].map(|shape| shape.limit_violation().into());
        if models[0].iter().all(|shape| !shape.limits.is_empty()) {
            let name = "largest violation of a limit over its bound, with friction";
            shapes.push(Fact::row("shapes.limit_violation_with_friction", name, violations.into(), ""));
        }
        let columns = names.map(str::to_owned).into();
        let shapes = Group { title: "Shapes in both models", columns, facts: shapes, words: String::new() };
        let lead = self.conclusion();
        let mut rest = vec![
            Fact::json("friction", &self.runs[0].stage.objective.solver().problem().scene.friction())?,
            Fact::json("loss_without_friction_in_the_model", &self.loss())?,
            Fact::json("surface_difference", &self.surface_difference())?,
            Fact::json("evaluations", &self.runs.map(|run| run.report.counts.evaluations))?,
            Fact::json("terminations", &self.runs.map(|run| ending(&run.report)))?,
            Fact::json("controls_with_friction", &self.runs[0].report.solution.as_slice())?,
            Fact::json("controls_without_friction", &self.runs[1].report.solution.as_slice())?,
            Fact::json("conclusion", &lead)?,
        ];
        if let Some(usage) = processes {
            rest.push(Fact::object("processes", "processes", usage, usage.to_string())?);
        }
        Ok(Facts { lead, groups: vec![shapes, Group::new("", rest)] })
    }

    /// The conclusion: sentences that the numbers decide.
    pub fn conclusion(&self) -> Vec<String> {
        let difference = self.surface_difference();
        let mut sentences = self.violated();
        sentences.extend(self.loss().map_or_else(|| vec![self.vanished()], |loss| self.compared(loss)));
        sentences.push(format!(
            "The two surfaces differ by {} mm (root mean square over the contact nodes, without {} mm in the mean height); \
             the surface optimized with friction departs from flat by {} mm.",
            number(difference.shape),
            number(difference.mean.abs()),
            number(difference.variation)
        ));
        for (run, name) in self.runs.into_iter().zip(["with", "without"]) {
            if !run.report.is_confirmed() {
                sentences.push(format!(
                    "The run {name} friction ended unconfirmed ({}): read the comparison as one of the best \
                     shapes found in {} evaluations.",
                    run.report.termination, run.report.counts.evaluations
                ));
            }
        }
        sentences
    }

    /// A sentence for each run that found no shape within the limits.
    fn violated(&self) -> Vec<String> {
        let ends = [("with", &self.own[0][1]), ("without", &self.own[1][1])];
        let sentence = |(name, shape): (&str, &SolvedShape)| {
            let violated = shape.limits.iter().filter(|limit| limit.excess() > 0.0);
            let violated: Vec<String> = violated.map(LimitedValue::words).collect();
            (!violated.is_empty())
                .then(|| format!("The run {name} friction found NO shape within the limits: {}.", violated.join("; ")))
        };
        ends.into_iter().filter_map(sentence).collect()
    }

    /// The sentence where the objective of the shape found with friction is zero up to rounding.
    fn vanished(&self) -> String {
        let least = ZERO * self.own[0][0].value;
        let (friction, without) = (self.friction(), self.with_friction()[1]);
        let rest = if without > least {
            format!("the shape optimized without friction has {}", number(without))
        } else {
            "so is that of the shape optimized without friction".into()
        };
        format!(
            "With friction {friction}, the objective of the shape optimized with friction is zero up to rounding; {rest}."
        )
    }

    /// The sentences on the ratio of the objectives of both shapes.
    fn compared(&self, loss: f64) -> Vec<String> {
        let peaks = [self.own[0][1].peak_pressure, self.crossed[0].peak_pressure];
        let ratio = format!(
            "With friction {}, the shape optimized without friction has {} times the objective of the shape optimized \
             with friction (peak pressure {} against {} MPa).",
            self.friction(),
            number(loss),
            number(peaks[1]),
            number(peaks[0])
        );
        let meaning = if (loss - 1.0).abs() <= MAX_EQUAL_DIFFERENCE {
            "In these runs, both shapes are as good as each other with friction.".into()
        } else if loss > 1.0 + MAX_NEGLIGIBLE_LOSS {
            format!(
                "In these runs, leaving friction out of the optimization costs {} %: it is no approximation of the optimum with \
                 friction.",
                rounded(100.0 * (loss - 1.0), 3)
            )
        } else if loss >= 1.0 {
            format!(
                "In these runs, leaving friction out of the optimization costs only {} %.",
                rounded(100.0 * (loss - 1.0), 3)
            )
        } else {
            format!(
                "The run with friction stopped {} % above the other shape: a better shape than its own exists, and it may be \
                 continued from there (--start-controls).",
                rounded(100.0 * (1.0 / loss - 1.0), 3)
            )
        };
        vec![ratio, meaning]
    }
}

/// Mean over all surfaces, and root mean square of what is left of each without its own mean.
fn of_surfaces(surfaces: &[Vec<f64>]) -> (f64, f64) {
    let rest = surfaces.iter().flat_map(|values| {
        let mean = mean_and_deviation(values).0;
        values.iter().map(move |value| value - mean)
    });
    let square = rest.map(|value| value * value).sum::<f64>();
    let all = surfaces.concat();
    (mean_and_deviation(&all).0, (square / all.len().max(1) as f64).sqrt())
}

/// Mean, and root mean square of the rest.
fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (mean, (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt())
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_shift_is_mean_and_a_wave_is_shape() {
        let (mean, deviation) = super::mean_and_deviation(&[3.0, 5.0, 3.0, 5.0]);
        assert_eq!((mean, deviation), (4.0, 1.0));
        assert_eq!(super::mean_and_deviation(&[]), (0.0, 0.0));
    }
}
