//! The status line of a terminal: which evaluation is under way, and which stage of the contact solver.
//!
//! The contact solvers tell their stages as `tracing` events ([`contact::equilibrium::Stage`]); [`StageLayer`] listens
//! and [`StatusLine`] shows the last one. Where stderr is no terminal there is neither line nor listener.

use contact::equilibrium::STAGE_TARGET;
use std::fmt::{Debug, Write};
use std::io::{IsTerminal, Write as _};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use terminal_size::{Width, terminal_size_of};
use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;

/// Time between two drawings of the line.
const REDRAW_INTERVAL: Duration = Duration::from_millis(200);
/// Columns of a terminal that does not tell.
const USUAL_COLUMNS: usize = 80;
/// Return to the beginning of the line, and the control sequence that erases it.
const ERASE: &str = "\r\x1b[2K";

/// A line that is overwritten in place, below the lines that stay. Copies are handles of the same line.
#[derive(Debug, Clone)]
pub struct StatusLine(Option<Arc<Mutex<Shown>>>);

/// What the line shows.
#[derive(Debug)]
struct Shown {
    task: String,
    stage: String,
    begun: Instant,
}

impl StatusLine {
    /// The line of stderr, hidden if that is no terminal that erases lines. It is drawn while any handle of it is left.
    pub fn of_stderr() -> Self {
        let cannot_erase = std::env::var("TERM").is_ok_and(|name| name == "dumb");
        if !std::io::stderr().is_terminal() || cannot_erase {
            return Self::hidden();
        }
        let shown = Arc::new(Mutex::new(Shown { task: String::new(), stage: String::new(), begun: Instant::now() }));
        let drawn = Arc::downgrade(&shown);
        std::thread::spawn(move || {
            while let Some(shown) = drawn.upgrade() {
                lock(&shown).draw();
                drop(shown);
                std::thread::sleep(REDRAW_INTERVAL);
            }
        });
        Self(Some(shown))
    }

    /// A line that is not drawn.
    pub fn hidden() -> Self {
        Self(None)
    }

    /// Whether the line is drawn.
    pub fn is_visible(&self) -> bool {
        self.0.is_some()
    }

    /// How many columns the terminal has.
    pub fn columns(&self) -> usize {
        terminal_size_of(std::io::stderr()).map_or(USUAL_COLUMNS, |(Width(columns), _)| columns.into())
    }

    /// What is under way until further notice; its time begins now.
    pub fn begin(&self, task: String) {
        self.change(|shown| *shown = Shown { task, stage: String::new(), begun: Instant::now() });
    }

    /// The stage of what is under way.
    pub fn stage(&self, stage: String) {
        self.change(|shown| shown.stage = stage);
    }

    /// A line that stays.
    pub fn print(&self, line: &str) {
        self.change(|_| write_stderr(&format!("{ERASE}{line}\n")));
    }

    /// Takes the line off the terminal, until something begins.
    pub fn clear(&self) {
        self.change(|shown| {
            shown.task.clear();
            write_stderr(ERASE);
        });
    }

    fn change(&self, change: impl FnOnce(&mut Shown)) {
        if let Some(shown) = &self.0 {
            change(&mut lock(shown));
        }
    }
}

impl Shown {
    fn draw(&self) {
        if !self.task.is_empty() {
            // The terminal cuts the line off instead of wrapping it, and what others write begins at the left.
            let seconds = self.begun.elapsed().as_secs();
            write_stderr(&format!("{ERASE}\x1b[?7l{}{}  {seconds} s\x1b[?7h\r", self.task, self.stage));
        }
    }
}

/// A thread that ended in the middle of a change leaves a text that can still be shown.
fn lock(shown: &Mutex<Shown>) -> MutexGuard<'_, Shown> {
    shown.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A terminal that is gone need not be told.
fn write_stderr(text: &str) {
    let mut stderr = std::io::stderr().lock();
    let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
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
