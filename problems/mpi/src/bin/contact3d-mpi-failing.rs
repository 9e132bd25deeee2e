//! `contact3d-mpi` for the tests of failures: one process fails where the variable `FAILING_PROCESS` says so.
//!
//! `RANK CALL KIND`: process RANK fails in its call number CALL of the connection, by
//!
//! * `panic`, a panic;
//! * `kill`, the signal 9;
//! * `exit`, an exit without notice to MPI;
//! * `memory`, an allocation that no machine can serve;
//! * `flat`, bodies so flat that they cannot be factored: from that call on, it hears another height than 100 mm.

use contact::communication::{Communication, Parcel};
use problems_mpi::World;
use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The connection of a process that fails.
#[derive(Debug)]
struct Failing {
    inner: World,
    calls: AtomicUsize,
    at: usize,
    kind: String,
}

/// The height that `flat` replaces, and what it puts in its place, mm.
const HEIGHTS: [f64; 2] = [100.0, 1e-9];

/// So many equal numbers side by side are heights of controls; lengths of the scene are not so many.
const RUN: usize = 4;

impl Failing {
    /// Fails if it is time to.
    fn fail(&self) {
        if self.calls.fetch_add(1, Ordering::Relaxed) != self.at {
            return;
        }
        match self.kind.as_str() {
            "panic" => panic!("as the test wants"),
            "kill" => {
                let number = std::process::id().to_string();
                let killed = Command::new("kill").args(["-9", &number]).status();
                panic!("the signal 9 did not arrive: {killed:?}");
            }
            "exit" => std::process::exit(3),
            "memory" => {
                let most = std::hint::black_box(isize::MAX as usize);
                let bytes = std::hint::black_box(Vec::<u8>::with_capacity(most));
                panic!("there were {} bytes", bytes.capacity());
            }
            _ => {}
        }
    }

    /// What `flat` makes of an announcement: a length in bytes, and the bytes in numbers.
    fn flattened(&self, heard: Vec<f64>) -> Vec<f64> {
        let [old, new] = HEIGHTS.map(f64::to_le_bytes);
        let mut bytes: Vec<u8> = heard.iter().flat_map(|number| number.to_le_bytes()).collect();
        let run = old.repeat(RUN);
        let mut start = old.len();
        let mut inside = false;
        while start + old.len() <= bytes.len() {
            let here = bytes[start..].starts_with(&old);
            inside = here && (inside || bytes[start..].starts_with(&run));
            if inside {
                bytes[start..start + old.len()].copy_from_slice(&new);
            }
            start += if inside { old.len() } else { 1 };
        }
        bytes.chunks_exact(old.len()).map(|word| f64::from_le_bytes(word.try_into().expect("eight bytes"))).collect()
    }
}

impl Communication for Failing {
    fn rank(&self) -> usize {
        self.inner.rank()
    }

    fn size(&self) -> usize {
        self.inner.size()
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        self.fail();
        let all = self.inner.gather(own, counts);
        let heard = counts[1..].iter().all(|count| *count == 0) && counts[0] > 1;
        let time = self.calls.load(Ordering::Relaxed) > self.at;
        if self.kind == "flat" && heard && time { self.flattened(all) } else { all }
    }

    fn exchange(&self, parcels: &mut [Parcel]) {
        self.fail();
        self.inner.exchange(parcels);
    }
}

/// Rank, call and kind of the failure that the environment asks for.
fn wanted() -> Option<(usize, usize, String)> {
    let text = std::env::var("FAILING_PROCESS").ok()?;
    let mut words = text.split_whitespace();
    Some((words.next()?.parse().ok()?, words.next()?.parse().ok()?, words.next()?.to_owned()))
}

/// Exchanges values with all other processes before the command begins: as many as the ranks decide, none with some.
fn exchange_with_all(world: &World) {
    let number = |from: usize, to: usize| if from > to { 0 } else { 20_000 * from + to };
    let value = |from: usize, to: usize, index: usize| (1000 * from + to) as f64 + 1e-6 * index as f64;
    let values = |from, to| (0..number(from, to)).map(|index| value(from, to, index)).collect::<Vec<f64>>();
    let (own, others) = (world.rank(), (0..world.size()).filter(|rank| *rank != world.rank()));
    let parcel = |rank| Parcel { rank, outgoing: values(own, rank), incoming: vec![f64::NAN; number(rank, own)] };
    let mut parcels: Vec<Parcel> = others.map(parcel).collect();
    world.exchange(&mut parcels);
    for Parcel { rank, incoming, .. } in parcels {
        assert_eq!(incoming, values(rank, own), "from process {rank}");
    }
}

fn main() -> ExitCode {
    problems_mpi::run("contact3d-mpi", |inner| {
        exchange_with_all(&inner);
        match wanted() {
            Some((rank, at, kind)) if rank == inner.rank() => {
                Arc::new(Failing { inner, calls: AtomicUsize::new(0), at, kind })
            }
            _ => Arc::new(inner),
        }
    })
}
