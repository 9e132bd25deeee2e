//! The processes that MPI has started together.

use contact::communication::{Communication, Parcel};
use mpi::Count;
use mpi::datatype::PartitionMut;
use mpi::request::scope;
use mpi::topology::{Communicator, SimpleCommunicator};
use mpi::traits::{CommunicatorCollectives, Destination, Source};
use std::sync::{Mutex, PoisonError};

/// Most values in one call of MPI, which counts in 32 bits.
const MAX_VALUES: usize = Count::MAX as usize;

/// All processes of the run. Communicators of MPI stay in their thread, so that the world is asked for at each call.
#[derive(Debug)]
pub struct World {
    rank: usize,
    size: usize,
    /// Locked during each call: MPI was told that one thread calls it at a time.
    calling: Mutex<()>,
}

impl World {
    /// The processes of this run, after MPI was initialized.
    #[allow(clippy::new_without_default, reason = "it needs an initialized MPI")]
    pub fn new() -> Self {
        let world = SimpleCommunicator::world();
        // MPI states rank and size as signed integers that are not negative.
        Self { rank: world.rank() as usize, size: world.size() as usize, calling: Mutex::new(()) }
    }
}

impl Communication for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        let _calling = self.calling.lock().unwrap_or_else(PoisonError::into_inner);
        let world = SimpleCommunicator::world();
        let starts: Vec<usize> = running_sum(counts);
        let mut all = vec![0.0; counts.iter().sum()];
        for round in rounds(counts, MAX_VALUES) {
            let mine = &round[self.rank];
            let sizes: Vec<Count> = round.iter().map(|part| part.len() as Count).collect();
            let places = running_sum(&round.iter().map(ExactSizeIterator::len).collect::<Vec<_>>());
            let displacements: Vec<Count> = places.iter().map(|place| *place as Count).collect();
            let mut received = vec![0.0; round.iter().map(ExactSizeIterator::len).sum()];
            let mut partition = PartitionMut::new(&mut received[..], sizes, displacements);
            world.all_gather_varcount_into(&own[mine.clone()], &mut partition);
            for ((part, start), place) in round.iter().zip(&starts).zip(&places) {
                let target = start + part.start..start + part.end;
                all[target].copy_from_slice(&received[*place..place + part.len()]);
            }
        }
        all
    }

    fn exchange(&self, parcels: &mut [Parcel]) {
        let _calling = self.calling.lock().unwrap_or_else(PoisonError::into_inner);
        let world = SimpleCommunicator::world();
        scope(|scope| {
            let mut requests = Vec::new();
            let mut sends = Vec::new();
            for Parcel { rank, outgoing, incoming } in parcels {
                let other = world.process_at_rank(*rank as i32);
                // Parts arrive in the order in which they are sent.
                for part in incoming.chunks_mut(MAX_VALUES) {
                    requests.push(other.immediate_receive_into(scope, part));
                }
                for part in outgoing.chunks(MAX_VALUES) {
                    sends.push(other.immediate_send(scope, part));
                }
            }
            for request in requests {
                request.wait_without_status();
            }
            for send in sends {
                send.wait_without_status();
            }
        });
    }
}

/// The sum of all entries before each.
fn running_sum(counts: &[usize]) -> Vec<usize> {
    let sum = |sum: &mut usize, count: &usize| Some(std::mem::replace(sum, *sum + count));
    counts.iter().scan(0, sum).collect()
}

/// Parts of the values of all processes, round by round, with at most `limit` values in a round (but one of each
/// process); at least one round.
fn rounds(counts: &[usize], limit: usize) -> Vec<Vec<std::ops::Range<usize>>> {
    let each = if counts.iter().sum::<usize>() <= limit { limit } else { (limit / counts.len().max(1)).max(1) };
    let number = counts.iter().map(|count| count.div_ceil(each)).max().unwrap_or(0).max(1);
    let part = |round: usize, count: usize| (round * each).min(count)..((round + 1).saturating_mul(each)).min(count);
    (0..number).map(|round| counts.iter().map(|&count| part(round, count)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_hold_every_value_once_and_none_holds_too_many() {
        for (counts, limit, number) in
            [(vec![3, 0, 5], 100, 1), (vec![3, 0, 5], 6, 3), (vec![0, 0], 5, 1), (vec![7], 2, 4)]
        {
            let rounds = rounds(&counts, limit);
            assert_eq!(rounds.len(), number, "{counts:?}");
            for round in &rounds {
                assert!(round.iter().map(ExactSizeIterator::len).sum::<usize>() <= limit.max(counts.len()));
            }
            for (rank, count) in counts.iter().enumerate() {
                let values: Vec<usize> = rounds.iter().flat_map(|round| round[rank].clone()).collect();
                assert_eq!(values, (0..*count).collect::<Vec<_>>());
            }
        }
        assert_eq!(running_sum(&[2, 0, 3]), [0, 2, 2]);
    }
}
