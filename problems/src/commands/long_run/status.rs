//! The status line of a terminal: which evaluation is under way, and which stage of the contact solver.
//!
//! The contact solvers tell their stages as `tracing` events ([`contact::equilibrium::Stage`]); [`StageLayer`] listens and
//! [`StatusLine`] shows the last one. Where stderr is no terminal there is neither line nor listener.

use contact::equilibrium::STAGE_TARGET;
use indicatif::{ProgressBar, ProgressStyle};
use std::fmt::{Debug, Write};
use std::io::IsTerminal;
use std::time::Duration;
use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;

/// Time between two drawings of the line.
const TICK: Duration = Duration::from_millis(200);

/// A line that is overwritten in place, below the lines that stay.
#[derive(Debug, Clone)]
pub struct StatusLine(ProgressBar);

impl StatusLine {
    /// The line of stderr, hidden if that is no terminal.
    pub fn of_stderr() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::hidden();
        }
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}{msg}  {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    /// A line that nobody sees.
    pub fn hidden() -> Self {
        Self(ProgressBar::hidden())
    }

    /// Whether anybody sees the line.
    pub fn is_visible(&self) -> bool {
        !self.0.is_hidden()
    }

    /// What is under way until further notice, with a clock of its own.
    pub fn begin(&self, what: String) {
        self.0.set_prefix(what);
        self.0.set_message("");
        self.0.reset_elapsed();
    }

    /// The stage of it.
    pub fn stage(&self, stage: String) {
        self.0.set_message(stage);
    }

    /// A line that stays.
    pub fn print(&self, line: &str) {
        self.0.println(line);
    }

    /// Takes the line off the terminal.
    pub fn clear(&self) {
        self.0.finish_and_clear();
    }
}

/// Hands the stages of the contact solvers, in words, to a function.
#[derive(Debug)]
pub struct StageLayer<F>(pub F);

impl<S: Subscriber, F: Fn(String) + 'static> Layer<S> for StageLayer<F> {
    fn on_event(&self, event: &Event<'_>, _context: Context<'_, S>) {
        if event.metadata().target() == STAGE_TARGET {
            let mut words = Words::default();
            event.record(&mut words);
            (self.0)(words.0);
        }
    }
}

/// "contact, step 12, residual 3.1e-7"
#[derive(Default)]
struct Words(String);

impl Visit for Words {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        // Writing to a string cannot fail.
        let _ = match field.name() {
            "stage" => write!(self.0, "{value:?}"),
            "steps" => write!(self.0, ", step {value:?}"),
            _ => Ok(()),
        };
    }

    fn record_f64(&mut self, field: &Field, value: f64) {
        if field.name() == "residual" {
            let _ = write!(self.0, ", residual {value:.1e}");
        }
    }
}
