//! What passes between the processes of a run, and nothing else does.
//!
//! All processes run the same program and call the same functions of [`Communication`] in the same order. Sums over all
//! subdomains are formed from gathered pieces in an order that does not depend on the number of processes, so that
//! results are the same to the last bit for any number of them.

use std::fmt::Debug;

/// One process of a run.
pub trait Communication: Debug + Send + Sync {
    /// The number of this process, from 0.
    fn rank(&self) -> usize;

    /// Number of connected processes.
    fn size(&self) -> usize;

    /// The values of all processes, in order. `counts`: how many values each process gives, equal everywhere.
    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64>;

    /// Sends every parcel to its process and fills it with what that process sends here. Two processes that exchange
    /// values have one parcel for each other.
    fn exchange(&self, parcels: &mut [Parcel]);
}

/// What this process exchanges with another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Parcel {
    /// The process to which the parcel goes and from which its answer comes.
    pub rank: usize,
    /// Values sent to that process.
    pub outgoing: Vec<f64>,
    /// Values from it; their number is known beforehand.
    pub incoming: Vec<f64>,
}

impl dyn Communication + '_ {
    /// The values of all processes, as many as each of them has.
    pub fn gather_any(&self, own: &[f64]) -> Vec<Vec<f64>> {
        let counts = self.gather(&[own.len() as f64], &vec![1; self.size()]);
        let counts: Vec<usize> = counts.into_iter().map(|count| count as usize).collect();
        let mut values = self.gather(own, &counts).into_iter();
        counts.iter().map(|&count| values.by_ref().take(count).collect()).collect()
    }

    /// The values that process 0 has; what the others give is ignored. What depends on time, files or the user is
    /// decided there.
    pub fn all_of_first(&self, values: Vec<f64>) -> Vec<f64> {
        let counts = |count: usize| (0..self.size()).map(|rank| if rank == 0 { count } else { 0 }).collect::<Vec<_>>();
        let own: fn(&[f64]) -> &[f64] = if self.rank() == 0 { |values| values } else { |_| &[] };
        let count = self.gather(own(&[values.len() as f64]), &counts(1))[0] as usize;
        self.gather(own(&values), &counts(count))
    }

    /// The failure of the first process that reports one, known to all; none if no process has failed. A process that
    /// fails and goes on alone would leave the others waiting.
    pub fn agree(&self, failure: Option<String>) -> Option<String> {
        let failed = self.gather(&[f64::from(failure.is_some())], &vec![1; self.size()]);
        if failed.iter().all(|&failed| failed == 0.0) {
            return None;
        }
        let bytes: Vec<f64> = failure.unwrap_or_default().bytes().map(f64::from).collect();
        let messages = self.gather_any(&bytes);
        let first = failed.iter().position(|&failed| failed != 0.0)?;
        let bytes: Vec<u8> = messages[first].iter().map(|&byte| byte as u8).collect();
        Some(String::from_utf8_lossy(&bytes).into_owned())
    }
}

/// The only process of a run: nothing is sent.
#[derive(Debug, Clone, Copy, Default)]
pub struct InProcess;

impl Communication for InProcess {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn gather(&self, own: &[f64], _counts: &[usize]) -> Vec<f64> {
        own.to_vec()
    }

    fn exchange(&self, _parcels: &mut [Parcel]) {}
}
