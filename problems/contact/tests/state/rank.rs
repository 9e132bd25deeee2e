//! Several processes, played by threads.

use contact::communication::{Communication, Parcel};
use testset::kit::Mailbox;

/// One of several processes, played by a thread.
#[derive(Debug)]
pub struct Rank(Mailbox);

impl Rank {
    /// So many connected processes.
    pub fn all(count: usize) -> impl Iterator<Item = Self> {
        Mailbox::all(count).into_iter().map(Self)
    }
}

impl Communication for Rank {
    fn rank(&self) -> usize {
        self.0.rank
    }

    fn size(&self) -> usize {
        self.0.size()
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        self.0.gather(own, counts)
    }

    fn exchange(&self, parcels: &mut [Parcel]) {
        parcels.iter().for_each(|parcel| self.0.send(parcel.rank, &parcel.outgoing));
        for parcel in parcels {
            let incoming = self.0.receive(parcel.rank);
            assert_eq!(incoming.len(), parcel.incoming.len());
            parcel.incoming = incoming;
        }
    }
}
