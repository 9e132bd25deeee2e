//! Memory that a scene needs, estimated before any work, against what the machine has.

use crate::communication::Communication;
use crate::error::SceneError;
use crate::scene::{BodyScene, BodySize, Geometry, Scene, SceneSize};
use crate::solvers::{SolverKind, SolverPlan};
use crate::tfeti::{MAX_COLUMNS, PreconditionerKind};
use crate::work_estimate::{body_factor_values, factor_values};

/// Estimated bytes up to which `auto` condenses bodies: a constant, since free memory must not change a result.
pub(crate) const MAX_CONDENSED_BYTES: f64 = 4e9;
/// Bytes of one number.
const NUMBER: f64 = 8.0;
/// Dual vectors that a solve keeps: directions, their images and jumps, Krylov bases.
const DUAL_VECTORS: f64 = 140.0;
/// Bytes of one number in single precision.
const SINGLE: f64 = 4.0;
/// Dual vectors and torn vectors that each column of a Jacobian keeps while it advances, in single precision:
/// directions, their images, subdomain solutions.
const TANGENT_VECTORS: (f64, f64) = (36.0, 8.0);
/// Size of the interior factor, which the Dirichlet preconditioner needs, over that of a subdomain's factor.
const INTERIOR_SHARE: f64 = 0.45;
/// Share of a subdomain's factor that its copy in single precision adds.
const SINGLE_PRECISION_SHARE: f64 = 0.5;
/// Stored stiffness entries per dof (lower triangle of 27 neighbours).
const STIFFNESS_PER_DOF: f64 = 41.0;
/// Values that the factor of a whole body takes, with the fronts of its elimination, over those of the factor alone.
const CONDENSED_SHARE: f64 = 1.15;
/// Numbers per dof of a whole body beside its factor: matrix, patterns, places of entries, mesh.
const CONDENSED_PER_DOF: f64 = 500.0;
/// Share of the available memory that may be used.
const USABLE: f64 = 0.9;

/// Estimated bytes of one state: what the states of all load cases share, and what each of them takes.
pub(crate) struct Estimate {
    shared: f64,
    own: f64,
}

impl Estimate {
    /// The bytes of the states of so many load cases.
    pub(crate) fn of_cases(&self, cases: usize) -> f64 {
        self.shared + cases as f64 * self.own
    }
}

/// The estimate for a scene, with `columns` of the Jacobian of its forces (0: states and adjoints only), on that of so
/// many `processes` which owns most subdomains. The kind `auto` takes the larger of both solvers, as long as bodies are
/// small enough to be condensed.
pub(crate) fn estimate(
    scene: &Scene,
    kind: SolverKind,
    preconditioner: PreconditionerKind,
    columns: usize,
    processes: usize,
) -> Estimate {
    if kind == SolverKind::Auto {
        let [direct, torn] = [SolverKind::Direct, SolverKind::Newton]
            .map(|kind| estimate(scene, kind, preconditioner, columns, processes));
        let is_larger = (torn.of_cases(1)..=MAX_CONDENSED_BYTES).contains(&direct.of_cases(1));
        return if is_larger { direct } else { torn };
    }
    let size = SceneSize::of(scene);
    let contact = 3.0 * size.contact_nodes;
    if kind == SolverKind::Direct {
        // Factors with the fronts of their elimination, compliances; the Newton matrix and its LU of every case.
        let of_body = |body: &BodySize| {
            let (dofs, own) = (3.0 * body.nodes, 3.0 * body.contact_nodes);
            CONDENSED_SHARE * body_factor_values(body) + CONDENSED_PER_DOF * dofs + 2.0 * own * own
        };
        let shared = NUMBER * (size.sum(of_body) + contact * contact);
        return Estimate { shared, own: NUMBER * 2.0 * contact * contact };
    }
    let pieces = size.sum(|body| body.pieces);
    let interior = if preconditioner == PreconditionerKind::Dirichlet { INTERIOR_SHARE } else { 0.0 };
    let near = |body: &BodyScene| {
        let others = body.materials.iter().map(|(_, material)| material);
        others.chain([&body.material]).any(|material| material.compressible_neighbour().is_some())
    };
    let matrices = if scene.bodies.iter().any(near) { 2.0 } else { 1.0 };
    let of_piece = |body: &BodySize| {
        let dofs = 3.0 * body.piece_nodes;
        factor_values(dofs) * (1.0 + SINGLE_PRECISION_SHARE + interior) + (matrices * STIFFNESS_PER_DOF + 6.0) * dofs
    };
    let per_piece = size.sum(|body| body.pieces * of_piece(body)) / pieces;
    let torn_dofs = size.sum(|body| body.pieces * 3.0 * body.piece_nodes);
    let glued = size.sum(|body| (3.0 * (body.pieces * body.piece_nodes - body.nodes)).max(0.0));
    // The factor of the coarse matrix has blocks of six where that of a brick mesh has blocks of three; those of the
    // contact subdomains take six dense matrices: constant part, its factor, two active sets with their LU.
    let held = 6.0 * size.sum(|body| body.contact_pieces);
    let coarse = 1.3 * 4.0 * factor_values(3.0 * pieces) + 6.0 * held * held;
    let (dual, torn) = TANGENT_VECTORS;
    // Processes share factors, torn vectors and rows of B_E; every process has the contact rows and the coarse problem.
    let owned = (pieces / processes as f64).ceil();
    let rows = glued * owned / pieces + contact;
    let tangents = SINGLE * columns.min(MAX_COLUMNS) as f64 * (dual * rows + torn * owned * torn_dofs / pieces);
    Estimate { shared: NUMBER * owned * per_piece, own: NUMBER * (DUAL_VECTORS * rows + coarse) + tangents }
}

/// Memory that a plan needs in one process for all its load cases, bytes, roughly.
pub fn needed(plan: &SolverPlan) -> f64 {
    estimate(&plan.scene, plan.kind, plan.preconditioner, plan.columns(), 1).of_cases(plan.cases)
}

/// Refuses a scene that needs more memory than the machine has to give. Where the system does not
/// tell, nothing is refused. Of several processes, each looks at its own machine, and all refuse if one does.
///
/// # Errors
/// [`SceneError::OutOfRange`] with both figures; [`SceneError::OtherProcess`] if only another process refuses.
pub fn check(plan: &SolverPlan, communication: &dyn Communication) -> Result<(), SceneError> {
    let processes = communication.size();
    let one = estimate(&plan.scene, plan.kind, plan.preconditioner, plan.columns(), processes);
    let needed = one.of_cases(plan.cases);
    if processes == 1 {
        return compare(&plan.scene, needed, available());
    }
    let here = on_this_machine(communication) as f64;
    let own = compare(&plan.scene, here * needed, available());
    match (communication.agree(own.as_ref().err().map(ToString::to_string)), own) {
        (Some(reason), Ok(())) => Err(SceneError::OtherProcess { reason }),
        (_, own) => own,
    }
}

/// How many of the processes run on the machine of this one; all of them where the system does not tell.
fn on_this_machine(communication: &dyn Communication) -> usize {
    // The name of the machine's last start: the same for all processes of one machine, and for no other machine.
    let name = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let names = communication.gather_any(&name.bytes().map(f64::from).collect::<Vec<f64>>());
    names.iter().filter(|other| **other == names[communication.rank()]).count()
}

/// Refuses a scene that needs more bytes than are available, where that is known.
fn compare(scene: &Scene, needed: f64, available: Option<f64>) -> Result<(), SceneError> {
    match available {
        Some(available) if needed > USABLE * available => {
            let joined = |counts: [usize; 3]| counts.map(|count| count.to_string()).join("x");
            let nodes = |body: &BodySize| body.nodes;
            let largest = SceneSize::of(scene)
                .bodies
                .iter()
                .map(nodes)
                .enumerate()
                .fold((0, 0.0), |largest, other| if other.1 > largest.1 { other } else { largest });
            let (at, body) = (format!("body[{}]", largest.0), &scene.bodies[largest.0]);
            let (field, what) = match &body.geometry {
                Geometry::Block(block) => {
                    let (bricks, subdomains) = (joined(block.bricks), joined(block.subdomains));
                    (format!("{at}.block.bricks"), format!("{bricks} bricks with {subdomains} subdomains"))
                }
                Geometry::Mesh(geometry) => {
                    let (nodes, cells) = (geometry.mesh.node_count(), geometry.mesh.cell_count());
                    let pieces = geometry.piece_count();
                    (format!("{at}.mesh"), format!("{nodes} nodes and {cells} cells in about {pieces} pieces"))
                }
            };
            let allowed = format!("what fits into the {:.1} GB of memory available", available / 1e9);
            Err(SceneError::out_of_range(field, format!("{what} (about {:.1} GB)", needed / 1e9), allowed))
        }
        _ => Ok(()),
    }
}

/// Memory that the system can give, bytes; none where it does not tell.
fn available() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::communication::InProcess;
    use crate::scene::signorini;

    #[test]
    fn estimates_are_near_the_measured_peaks() {
        // Measured (docs/measurements.md): 0.65, 3.6, 8.5 and 2.2 GiB; 1.22 GiB with a Jacobian of 64 columns.
        for (mesh, subdomains, kind, columns, measured) in [
            (35, 5, SolverKind::Newton, 0, 0.72e9),
            (35, 5, SolverKind::Newton, 64, 1.31e9),
            (63, 9, SolverKind::Newton, 0, 3.92e9),
            (84, 12, SolverKind::Newton, 0, 9.16e9),
            (35, 5, SolverKind::Direct, 0, 2.33e9),
        ] {
            let scene = signorini().expect("a preset").with_bricks([mesh; 3], [subdomains; 3]);
            let needed = estimate(&scene, kind, PreconditionerKind::Dirichlet, columns, 1).of_cases(1);
            assert!(
                (needed / measured - 1.0).abs() < 0.15,
                "{mesh}/{subdomains}: {needed:.2e}, measured {measured:.2e}"
            );
        }
    }

    #[test]
    fn several_processes_share_the_factors_and_no_process_needs_more_than_one_alone() {
        // Measured at 24 bricks and 4 subdomains per edge: 236 MB on one process, 86 MB on each of four, of which some
        // 30 MB are those of a process without a scene.
        let scene = signorini().expect("a preset").with_bricks([24; 3], [4; 3]);
        let estimate =
            |kind, processes| estimate(&scene, kind, PreconditionerKind::Dirichlet, 0, processes).of_cases(1);
        let needed = |processes| estimate(SolverKind::Newton, processes);
        let shares = [2, 4, 64].map(|processes| needed(processes) / needed(1));
        assert!(0.2 < shares[1] && shares[1] < 0.4 && shares[0] < 1.0 && shares[2] < shares[1], "{shares:?}");
        let condensed = [1, 4].map(|processes| estimate(SolverKind::Direct, processes));
        assert_eq!(condensed[0], condensed[1]);
    }

    #[test]
    fn a_scene_beyond_any_machine_is_refused_with_the_figures() {
        let scene = signorini().expect("a preset").with_bricks([400; 3], [1; 3]);
        let needed = estimate(&scene, SolverKind::Direct, PreconditionerKind::Dirichlet, 0, 1).of_cases(1);
        let text = compare(&scene, needed, Some(1e12)).expect_err("needs more than a terabyte").to_string();
        assert!(text.contains("400x400x400 bricks") && text.contains("1000.0 GB of memory"), "{text}");
        assert_eq!(compare(&scene, needed, None).ok(), Some(()), "what is not known refuses nothing");
        let refused = check(&SolverPlan::new(scene, SolverKind::Direct), &InProcess).is_err();
        assert_eq!(refused, available().is_some());
    }
}
