//! Ranks that are threads of one process, with channels between them.

use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};

/// One of several ranks, with a channel to and from each of them.
#[derive(Debug)]
pub struct Mailbox {
    /// Its number, from 0.
    pub rank: usize,
    to: Vec<Mutex<Sender<Vec<f64>>>>,
    from: Vec<Mutex<Receiver<Vec<f64>>>>,
}

impl Mailbox {
    /// So many connected ranks.
    pub fn all(count: usize) -> Vec<Self> {
        let mut ranks: Vec<Self> = (0..count).map(|rank| Self { rank, to: vec![], from: vec![] }).collect();
        for sender in 0..count {
            for receiver in 0..count {
                let (to, from) = channel();
                ranks[sender].to.push(Mutex::new(to));
                ranks[receiver].from.push(Mutex::new(from));
            }
        }
        ranks
    }

    /// How many ranks there are.
    pub fn size(&self) -> usize {
        self.to.len()
    }

    /// Sends numbers to a rank, itself included. Panics if that one has ended.
    pub fn send(&self, rank: usize, values: &[f64]) {
        self.to[rank].lock().expect("no panic while sending").send(values.to_vec()).expect("a rank that listens");
    }

    /// Waits for the next numbers of a rank. Panics if that one has ended.
    pub fn receive(&self, rank: usize) -> Vec<f64> {
        self.from[rank].lock().expect("no panic while waiting").recv().expect("a rank that speaks")
    }

    /// The numbers of all ranks, one after the other; all have to call it with the same counts.
    pub fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        (0..self.size()).for_each(|rank| self.send(rank, own));
        let received: Vec<Vec<f64>> = (0..self.size()).map(|rank| self.receive(rank)).collect();
        assert!(received.iter().map(Vec::len).eq(counts.iter().copied()), "numbers of other lengths than announced");
        received.concat()
    }
}
