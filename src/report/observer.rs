//! Watching a run: observers, closures as observers, and a table for people.

use super::record::IterationRecord;
use std::io::Write;
use std::ops::ControlFlow;

/// Sees every evaluation of a run as it happens; `Break` stops the run.
///
/// ```
/// use nonsmooth::{BundleTrust, BundleTrustConfig, FnObjective, IterationRecord, Termination, Vector};
/// use std::ops::ControlFlow;
/// let theta = FnObjective::new(1, |x: &Vector| (x[0].abs(), Vector::from_element(1, x[0].signum())));
/// let mut seen = 0;
/// let report = BundleTrust::new(BundleTrustConfig::default()).unwrap()
///     .observer(|record: &IterationRecord| {
///         seen += 1;
///         if record.evaluation == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
///     })
///     .minimize(&theta, Vector::from_element(1, 10.5)).unwrap();
/// assert_eq!(report.termination, Termination::StoppedByObserver);
/// assert_eq!(seen, 2);
/// ```
pub trait Observer {
    /// Called once per evaluation, after the step is decided.
    fn observe(&mut self, record: &IterationRecord) -> ControlFlow<()>;
}

impl<F: FnMut(&IterationRecord) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, record: &IterationRecord) -> ControlFlow<()> {
        self(record)
    }
}

/// Writes one line per evaluation, with a header now and then. A writer that fails is ignored.
#[derive(Debug)]
pub struct TablePrinter<W: Write> {
    writer: W,
    lines: usize,
}

impl<W: Write> TablePrinter<W> {
    /// Prints to a writer, for example `std::io::stderr()`.
    pub fn new(writer: W) -> Self {
        Self { writer, lines: 0 }
    }

    fn header(&mut self) -> std::io::Result<()> {
        writeln!(
            self.writer,
            "{:>5} {:<10} {:<12} {:>15} {:>15} {:>9} {:>9} {:>9} {:>9} {:>9} {:>4} {:>8}",
            "eval",
            "step",
            "origin",
            "trial",
            "center",
            "predicted",
            "|aggr.g|",
            "aggr.err",
            "weight",
            "length",
            "cuts",
            "seconds"
        )
    }

    fn line(&mut self, record: &IterationRecord) -> std::io::Result<()> {
        let trial = record.value.map_or_else(|| "-".to_owned(), |value| format!("{value:.8e}"));
        writeln!(
            self.writer,
            "{:>5} {:<10} {:<12} {:>15} {:>15.8e} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.2e} {:>9.2e} {:>4} {:>8.2}",
            record.evaluation,
            record.kind,
            record.origin,
            trial,
            record.center_value,
            record.predicted_decrease,
            record.aggregate_norm,
            record.aggregate_error,
            record.weight,
            record.step_length,
            record.cuts,
            record.seconds
        )
    }
}

impl<W: Write> Observer for TablePrinter<W> {
    fn observe(&mut self, record: &IterationRecord) -> ControlFlow<()> {
        let header = if self.lines.is_multiple_of(40) { self.header() } else { Ok(()) };
        self.lines += 1;
        // A table that cannot be written must not end an expensive run.
        let _ignored = header.and_then(|()| self.line(record));
        ControlFlow::Continue(())
    }
}
