//! What processes send each other, and what each of them uses.

use crate::communication::{Communication, Parcel};
use crate::solvers::SolverKind;
use serde::Serialize;
use std::fmt;
use std::fs::read_to_string;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Ticks of a second in /proc/self/stat.
const TICKS: f64 = 100.0;
/// Bytes of a number.
const NUMBER: u64 = 8;

/// A connection that counts what it is asked to send, and how long it makes the process wait.
#[derive(Debug)]
pub struct Counted {
    inner: Arc<dyn Communication>,
    counters: Arc<Counters>,
    /// Whether what is sent counts.
    counts: bool,
}

#[derive(Debug)]
struct Counters {
    bytes: AtomicU64,
    messages: AtomicU64,
    /// Processor time that went into communication, nanoseconds: most of it is waiting, which keeps a processor busy.
    waiting: AtomicU64,
    /// Processor time of the process when counting began, s.
    begun: Option<f64>,
}

/// What one process has sent and used; none where the system does not tell.
#[derive(Debug, Clone, Copy)]
pub struct Figures([Option<f64>; 4]);

impl Counted {
    /// Two connections to the same processes: the first counts what is sent, the second does not. Both count waiting.
    pub fn pair(inner: &Arc<dyn Communication>) -> [Arc<Self>; 2] {
        let (bytes, messages, waiting) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
        let counters = Arc::new(Counters { bytes, messages, waiting, begun: processor_seconds() });
        [true, false].map(|counts| Arc::new(Self { inner: Arc::clone(inner), counters: Arc::clone(&counters), counts }))
    }

    /// What the process has sent and used so far.
    pub fn figures(&self) -> Figures {
        let Counters { bytes, messages, waiting, begun } = &*self.counters;
        let count = |counter: &AtomicU64| Some(counter.load(Ordering::Relaxed) as f64);
        let waited = waiting.load(Ordering::Relaxed) as f64 * 1e-9;
        let worked = processor_seconds().zip(*begun).map(|(now, begun)| (now - begun - waited).max(0.0));
        let worked = worked.filter(|_| thread_nanoseconds().is_some());
        Figures([count(bytes), count(messages), peak_memory(), worked])
    }

    /// Does something that waits for other processes; counts what it sends.
    fn counted<T>(&self, values: usize, messages: usize, communicate: impl FnOnce() -> T) -> T {
        let Counters { bytes, messages: sent, waiting, .. } = &*self.counters;
        if self.counts {
            bytes.fetch_add(NUMBER * values as u64, Ordering::Relaxed);
            sent.fetch_add(messages as u64, Ordering::Relaxed);
        }
        let before = thread_nanoseconds();
        let result = communicate();
        if let (Some(before), Some(after)) = (before, thread_nanoseconds()) {
            waiting.fetch_add(after.saturating_sub(before), Ordering::Relaxed);
        }
        result
    }
}

impl Communication for Counted {
    fn rank(&self) -> usize {
        self.inner.rank()
    }

    fn size(&self) -> usize {
        self.inner.size()
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        self.counted(own.len(), 1, || self.inner.gather(own, counts))
    }

    fn exchange(&self, parcels: &mut [Parcel]) {
        let values = parcels.iter().map(|parcel| parcel.outgoing.len()).sum();
        self.counted(values, parcels.len(), || self.inner.exchange(parcels));
    }
}

impl Figures {
    /// The figures of all processes, in their order.
    pub fn gather(self, communication: &dyn Communication) -> Vec<Self> {
        let own = self.0.map(|figure| figure.unwrap_or(f64::NAN));
        let all = communication.gather(&own, &vec![own.len(); communication.size()]);
        let known = |figure: f64| figure.is_finite().then_some(figure);
        all.chunks_exact(own.len()).map(|of| Self(std::array::from_fn(|index| known(of[index])))).collect()
    }
}

/// The keys of the JSON about several processes.
#[derive(Debug, Clone, Serialize)]
pub struct Usage {
    /// How many there are.
    processes: usize,
    /// Whether every process did the same work, by direct condensation.
    repeated: bool,
    /// Products with the dual operator, those of adjoints and Jacobians included; those of failed states and of checks
    /// are not, though their bytes and messages count.
    products: usize,
    /// Bytes that a process hands over for the others, per product: the mean of all processes. Every value counts once,
    /// however many processes get it. Null without products.
    bytes_per_product: Option<f64>,
    /// Gathers and messages to single processes, per product: the mean of all processes.
    messages_per_product: Option<f64>,
    /// Largest resident memory of every process, bytes.
    peak_memory: Vec<Option<f64>>,
    /// Processor time of every process outside of communication, s.
    processor_seconds: Vec<Option<f64>>,
    /// The largest of these times over their mean.
    imbalance: Option<f64>,
}

impl Usage {
    /// From the figures of all processes, for so many products and a solver.
    pub fn new(figures: &[Figures], products: usize, solver: SolverKind) -> Self {
        let column = |index: usize| figures.iter().map(|Figures(of)| of[index]).collect::<Vec<_>>();
        let mean = |values: &[Option<f64>]| {
            let known: Option<Vec<f64>> = values.iter().copied().collect();
            known.map(|known| known.iter().sum::<f64>() / known.len() as f64)
        };
        let per_product = |index| mean(&column(index)).filter(|_| products > 0).map(|sum| sum / products as f64);
        let worked = column(3);
        let largest = worked.iter().flatten().copied().fold(0.0, f64::max);
        Self {
            processes: figures.len(),
            repeated: solver == SolverKind::Direct,
            products,
            bytes_per_product: per_product(0),
            messages_per_product: per_product(1),
            peak_memory: column(2),
            imbalance: mean(&worked).filter(|mean| *mean > 0.0).map(|mean| largest / mean),
            processor_seconds: worked,
        }
    }
}

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.processes)?;
        if self.repeated && self.processes > 1 {
            write!(f, ", each of which repeats the direct condensation")?;
        }
        if let (Some(bytes), Some(messages)) = (self.bytes_per_product, self.messages_per_product) {
            write!(f, "; {bytes:.3e} bytes in {messages:.1} messages per product and process")?;
        }
        let memory: Option<Vec<String>> =
            self.peak_memory.iter().map(|bytes| bytes.map(|bytes| format!("{:.0}", bytes / 1e6))).collect();
        if let Some(memory) = memory {
            write!(f, "; peak memory {} MB", memory.join(", "))?;
        }
        self.imbalance.map_or(Ok(()), |imbalance| write!(f, "; imbalance {imbalance:.2}"))
    }
}

/// Largest resident memory of this process so far, bytes.
fn peak_memory() -> Option<f64> {
    let text = read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kilobytes| 1024.0 * kilobytes)
}

/// Processor time of all threads of this process so far, s.
fn processor_seconds() -> Option<f64> {
    let text = read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in brackets, may hold anything.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / TICKS)
}

/// Processor time of this thread so far, nanoseconds.
fn thread_nanoseconds() -> Option<u64> {
    read_to_string("/proc/thread-self/schedstat").ok()?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::communication::InProcess;

    #[test]
    fn bytes_and_messages_are_counted_once_per_call() {
        let inner: Arc<dyn Communication> = Arc::new(InProcess);
        let [counted, uncounted] = Counted::pair(&inner);
        counted.gather(&[1.0; 5], &[5]);
        uncounted.gather(&[1.0; 7], &[7]);
        let parcel = Parcel { rank: 0, outgoing: vec![0.0; 3], incoming: vec![] };
        counted.exchange(&mut [parcel.clone(), parcel]);
        for connection in [&counted, &uncounted] {
            assert_eq!(connection.figures().0[..2], [Some(8.0 * 11.0), Some(3.0)]);
        }
    }

    #[test]
    fn usage_is_per_product_and_process() {
        let figures = [[800.0, 4.0, 3e6, 3.0], [400.0, 4.0, 1e6, 1.0]].map(|of| Figures(of.map(Some)));
        let usage = Usage::new(&figures, 6, SolverKind::Newton);
        assert_eq!((usage.bytes_per_product, usage.messages_per_product), (Some(100.0), Some(4.0 / 6.0)));
        assert_eq!((usage.imbalance, usage.peak_memory.len()), (Some(1.5), 2));
        let text = usage.to_string();
        assert!(text.starts_with("2; 1.000e2 bytes in 0.7") && text.contains("3, 1 MB; imbalance 1.50"), "{text}");
        let repeated = Usage::new(&[Figures([Some(0.0), Some(0.0), None, None]); 2], 0, SolverKind::Direct);
        assert_eq!(repeated.to_string(), "2, each of which repeats the direct condensation");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_system_tells_memory_and_time() {
        assert!(peak_memory().is_some_and(|bytes| bytes > 1e6 && bytes < 1e12));
        assert!(processor_seconds().is_some_and(|seconds| seconds < 1e6));
    }
}
