//! One line per evaluation for people, one event for logs; and the place where an interruption takes effect.

use crate::commands::interrupt::interrupted;
use crate::commands::long_run::status::StatusLine;
use nonsmooth::{IterationRecord, Observer};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Progress of a run.
#[derive(Debug)]
pub struct Progress {
    /// Shown before every line: the stage.
    label: String,
    /// Largest number of evaluations.
    limit: usize,
    time_limit: Option<f64>,
    /// Evaluations answered from the journal; nothing is shown for them.
    replayed: usize,
    clock: Instant,
    status: StatusLine,
}

impl Progress {
    /// Progress towards the limits, shown where the status line is.
    pub fn new(label: &str, limit: usize, time_limit: Option<f64>, replayed: usize, status: StatusLine) -> Self {
        let this = Self { label: label.to_owned(), limit, time_limit, replayed, clock: Instant::now(), status };
        this.announce(replayed + 1);
        this
    }

    /// The evaluation that begins, on the status line.
    fn announce(&self, evaluation: usize) {
        if evaluation <= self.limit {
            tracing::debug!(evaluation, "evaluation begins");
            self.status.begin(format!("{}evaluation {evaluation:>4}/{}: ", self.label, self.limit));
        }
    }

    /// The line of an evaluation, as much of it as so many columns hold.
    fn line(&self, record: &IterationRecord, elapsed: Duration, columns: usize) -> String {
        let done = record.evaluation.saturating_sub(self.replayed).max(1);
        let left = self.limit.saturating_sub(record.evaluation);
        let elapsed = elapsed.as_secs_f64();
        let by_count = elapsed / done as f64 * left as f64;
        let remaining = self.time_limit.map_or(by_count, |limit| by_count.min((limit - elapsed).max(0.0)));
        let Self { label, limit, .. } = self;
        let IterationRecord { evaluation, kind, center_value: best, predicted_decrease, .. } = record;
        let whole = format!(
            "{label}evaluation {evaluation:>4}/{limit}  {kind:<10} best {best:.6e}  predicted decrease {predicted_decrease:.1e}  elapsed {}, at most {} to go",
            time(elapsed),
            time(remaining)
        );
        if whole.chars().count() <= columns {
            return whole;
        }
        let short = format!("{label}{evaluation}/{limit} {kind} {best:.3e} {}", time(elapsed));
        short.chars().take(columns).collect()
    }
}

impl Observer for Progress {
    fn observe(&mut self, record: &IterationRecord) -> ControlFlow<()> {
        if record.evaluation > self.replayed {
            tracing::info!(
                evaluation = record.evaluation,
                kind = %record.kind,
                best = record.center_value,
                predicted_decrease = record.predicted_decrease,
                seconds = record.seconds,
                "evaluation done"
            );
            if self.status.is_visible() {
                let columns = self.status.columns();
                self.status.print(&self.line(record, self.clock.elapsed(), columns));
            }
            self.announce(record.evaluation + 1);
        }
        if interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Seconds as people read them.
fn time(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..100 => format!("{seconds:.1} s"),
        100..6000 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nonsmooth::{Origin, StepKind};

    #[test]
    fn a_line_has_count_best_value_prediction_and_times() {
        let record = IterationRecord {
            evaluation: 30,
            kind: StepKind::Serious,
            origin: Origin::Cuts,
            value: Some(1.0),
            center_value: 1.5e16,
            predicted_decrease: 2e14,
            aggregate_norm: 0.0,
            aggregate_error: 0.0,
            weight: 1.0,
            step_length: 1.0,
            violation: 0.0,
            cuts: 3,
            convexification: 0.0,
            accuracy: 0.0,
            failure: None,
            jacobian: false,
            note: None,
            work: 0,
            seconds: 1.0,
        };
        // Ten evaluations after the resumption took 50 s: 120 more take ten minutes, the time limit leaves two.
        let mut progress = Progress::new("mesh 6: ", 150, None, 20, StatusLine::hidden());
        let line = progress.line(&record, Duration::from_secs(50), 200);
        for words in
            ["mesh 6: evaluation   30/150", "serious", "1.500000e16", "2.0e14", "elapsed 50.0 s", "at most 10 min 00 s"]
        {
            assert!(line.contains(words), "{line}");
        }
        progress.time_limit = Some(170.0);
        assert!(progress.line(&record, Duration::from_secs(50), 200).contains("at most 2 min 00 s"));
        assert_eq!(progress.line(&record, Duration::from_secs(50), 40), "mesh 6: 30/150 serious 1.500e16 50.0 s");
        assert_eq!(progress.line(&record, Duration::from_secs(50), 20), "mesh 6: 30/150 serio");
        assert_eq!(time(7300.0), "2 h 01 min");
    }
}
