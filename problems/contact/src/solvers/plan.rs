//! A scene and how it is to be solved.

use crate::error::SceneError;
use crate::scene::Scene;
use crate::solvers::SolverKind;
use crate::tfeti::PreconditionerKind;
use serde::{Deserialize, Serialize};

/// What a solver will be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wanted {
    /// States and their adjoints.
    States,
    /// The Jacobian of all contact forces too.
    Jacobians,
}

/// A scene and how it is to be solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolverPlan {
    /// The scene, with all that its file refers to.
    pub scene: Scene,
    /// The contact solver by name.
    pub kind: SolverKind,
    /// The preconditioner of total FETI.
    pub preconditioner: PreconditionerKind,
    /// Number of clusters of subdomains of all bodies (hybrid total FETI); none: every subdomain by itself.
    pub clusters: Option<usize>,
    /// What the solver will be asked for: the choice of `auto` depends on it.
    pub wanted: Wanted,
}

impl SolverPlan {
    /// States of a scene by a solver of this kind, the rest by default.
    pub fn new(scene: Scene, kind: SolverKind) -> Self {
        Self { scene, kind, preconditioner: PreconditionerKind::default(), clusters: None, wanted: Wanted::States }
    }

    /// Columns of a Jacobian that is wanted, else 0.
    pub(crate) fn columns(&self) -> usize {
        if self.wanted == Wanted::Jacobians { self.scene.control_points.iter().product() } else { 0 }
    }

    /// Subdomains per axis of a cluster.
    ///
    /// # Errors
    /// As [`cluster_shape`].
    pub(crate) fn cluster_shape(&self) -> Result<[usize; 3], SceneError> {
        self.clusters.map_or(Ok([1; 3]), |count| cluster_shape(&self.scene, self.kind, count))
    }

    /// Refuses processes that would own no cluster. Direct condensation takes any number of processes.
    pub(crate) fn check_processes(&self, processes: usize) -> Result<(), SceneError> {
        let (most, of) = match self.clusters {
            Some(clusters) => (clusters, "clusters (solver.clusters)"),
            None => (subdomain_count(&self.scene), "subdomains (mesh.subdomains)"),
        };
        if self.kind == SolverKind::Direct || processes <= most {
            return Ok(());
        }
        let allowed = format!("at most {most}, as many as there are {of}");
        Err(SceneError::out_of_range("number of processes", processes, allowed))
    }
}

fn body_count(scene: &Scene) -> usize {
    if scene.upper.is_some() { 2 } else { 1 }
}

fn subdomain_count(scene: &Scene) -> usize {
    body_count(scene) * scene.subdomains.iter().product::<usize>()
}

/// Subdomains per axis of a cluster where so many clusters, equal boxes of subdomains, divide all bodies. Of several
/// boxes the one with the smallest surface is taken.
///
/// # Errors
/// [`SceneError::OutOfRange`] for a number that no boxes have, and for a solver without subdomains.
pub fn cluster_shape(scene: &Scene, kind: SolverKind, count: usize) -> Result<[usize; 3], SceneError> {
    let refused = |allowed: String| Err(SceneError::out_of_range("solver.clusters", count, allowed));
    if kind == SolverKind::Direct {
        return refused("no clusters with solver.kind = \"direct\", which has no subdomains".into());
    }
    let divisors =
        |axis: usize| (1..=scene.subdomains[axis]).filter(move |&n| scene.subdomains[axis].is_multiple_of(n));
    let boxes: Vec<[usize; 3]> =
        divisors(0).flat_map(|i| divisors(1).flat_map(move |j| divisors(2).map(move |k| [i, j, k]))).collect();
    let of = |counts: &[usize; 3]| body_count(scene) * counts.iter().product::<usize>();
    let surface = |counts: &[usize; 3]| {
        let [a, b, c]: [usize; 3] = std::array::from_fn(|axis| scene.mesh[axis] / counts[axis]);
        a * b + b * c + c * a
    };
    match boxes.iter().filter(|counts| of(counts) == count).min_by_key(|counts| surface(counts)) {
        Some(counts) => Ok(std::array::from_fn(|axis| scene.subdomains[axis] / counts[axis])),
        None => {
            let below = boxes.iter().map(of).filter(|&other| other < count).max();
            let above = boxes.iter().map(of).filter(|&other| other > count).min();
            let near = below.into_iter().chain(above).map(|count| count.to_string()).collect::<Vec<_>>().join(" and ");
            refused(format!(
                "numbers of equal boxes that the {} subdomains make, the nearest are {near}",
                subdomain_count(scene)
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{hertz, signorini};

    #[test]
    fn clusters_are_the_boxes_of_smallest_surface() {
        let torn = |scene: Scene, mesh, subdomains| Scene { mesh, subdomains, ..scene };
        let one = torn(signorini().expect("a preset"), [12; 3], [4; 3]);
        let two = torn(hertz().expect("a preset"), [12; 3], [4; 3]);
        let shape = |scene: &Scene, count| cluster_shape(scene, SolverKind::Newton, count).expect("allowed");
        assert_eq!((shape(&one, 8), shape(&one, 1), shape(&one, 64)), ([2; 3], [4; 3], [1; 3]));
        assert_eq!((shape(&two, 16), shape(&two, 2)), ([2; 3], [4; 3]));
        // A flat body: four clusters side by side, not above each other.
        assert_eq!(shape(&torn(one.clone(), [12, 12, 4], [4; 3]), 4), [2, 2, 4]);
        for (scene, kind, count, words) in [
            (&one, SolverKind::Newton, 5, "the nearest are 4 and 8"),
            (&one, SolverKind::Newton, 65, "the nearest are 64"),
            (&two, SolverKind::Auto, 1, "the nearest are 2"),
            (&one, SolverKind::Direct, 8, "no clusters with solver.kind = \"direct\""),
        ] {
            let error = cluster_shape(scene, kind, count).expect_err("not allowed").to_string();
            assert!(error.contains(&format!("solver.clusters = {count}")) && error.contains(words), "{error}");
        }
    }
}
