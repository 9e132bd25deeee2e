//! The interfaces between ranks, counted on the tearing of a scene by one process.

use contact::communication::{Communication, Parcel};
use contact::equilibrium::ContactProblem;
use contact::tfeti::{TornModel, TornOptions};
use problems::commands::Failure;
use std::sync::Arc;

/// Dofs of other ranks that a rank needs, in the mean over all ranks.
pub fn mean_ghosts(problem: &Arc<ContactProblem>, ranks: usize) -> Result<f64, Failure> {
    let mut sum = 0;
    for rank in 0..ranks {
        let options = TornOptions { communication: Arc::new(Imagined { rank, ranks }), ..TornOptions::default() };
        sum += TornModel::new(Arc::clone(problem), options).map_err(Failure::computation)?.ghost_count();
    }
    Ok(sum as f64 / ranks as f64)
}

/// One rank among others that are not there and whose values are zeros: enough to tear bodies, which needs no values.
#[derive(Debug)]
struct Imagined {
    rank: usize,
    ranks: usize,
}

impl Communication for Imagined {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.ranks
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        let first: usize = counts[..self.rank].iter().sum();
        let mut all = vec![0.0; counts.iter().sum()];
        all[first..first + own.len()].copy_from_slice(own);
        all
    }

    fn exchange(&self, _parcels: &mut [Parcel]) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact::scene;

    #[test]
    fn two_halves_need_the_face_between_them() {
        let scene = scene::signorini().expect("a scene").with_bricks([4; 3], [2; 3]);
        let problem = Arc::new(ContactProblem::new(scene).expect("a problem"));
        assert_eq!(mean_ghosts(&problem, 1).expect("one"), 0.0);
        // Four subdomains with 3 × 3 nodes on the face.
        assert_eq!(mean_ghosts(&problem, 2).expect("two"), 4.0 * 9.0 * 3.0);
    }
}
