//! The runs of an optimization: one, one per growing mesh, one per start, or attempts with a run from the best of them.

use crate::optimization::coarse_net::begins_with_attempts;
use crate::{Case, ContinuationMesh, MethodName, default_subdomains};
use contact::scene::BodyScene;
use nonsmooth::Journal;
use std::path::Path;

/// What a run is within its optimization.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The only run, or the one that goes on from the best attempt.
    Whole,
    /// One of several growing meshes.
    Mesh(MeshName),
    /// One of several starts, counted from 1: that of the scene, then others.
    Start(usize),
    /// A short attempt; the whole run goes on from the best of all.
    Try(Attempt),
    /// From a fairer shape that is as good as the one where the whole run has ended, if there is one.
    Fair,
}

/// One of several growing meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshName {
    /// Blocks, by the bricks along the axis that has most.
    Bricks(usize),
    /// The mesh of a file, counted from 1.
    File(usize),
}

/// A way to a shape that is worth to go on from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attempt {
    /// All controls from the start.
    Direct,
    /// A coarse net of controls from the start.
    Coarse,
    /// All controls from where the coarse net has ended, unless the direct way has ended as low.
    Refined,
    /// All controls from another start, counted from 2.
    Start(usize),
}

impl Part {
    /// Name of the folder of its journal; none for a single run.
    pub fn folder(self) -> Option<String> {
        match self {
            Self::Whole => None,
            Self::Mesh(MeshName::Bricks(bricks)) => Some(format!("stage_{bricks}")),
            Self::Mesh(MeshName::File(number)) => Some(format!("mesh_{number}")),
            Self::Start(number) => Some(format!("start_{number}")),
            Self::Try(Attempt::Direct) => Some("try_direct".into()),
            Self::Try(Attempt::Coarse) => Some("try_coarse".into()),
            Self::Try(Attempt::Refined) => Some("try_refined".into()),
            Self::Try(Attempt::Start(number)) => Some(format!("try_start_{number}")),
            Self::Fair => Some("fair".into()),
        }
    }

    /// Whether it is an attempt.
    pub fn is_attempt(self) -> bool {
        matches!(self, Self::Try(_))
    }
}

/// A run of an optimization, before it begins.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// What it is within the optimization.
    pub part: Part,
    /// What it optimizes.
    pub case: Case,
}

/// The attempts of a case: the direct way, coarse to fine in the controls, other starts. None where one run is asked
/// for or where no shape asks for them, and for functions of the displacements: their runs by cuts are long, and were
/// measured to end at the same values.
fn attempts(case: &Case) -> Vec<Attempt> {
    let optimizer = &case.optimizer;
    let single = optimizer.single || !optimizer.continuation.is_empty() || case.method == MethodName::Bundle;
    if single || !begins_with_attempts(&case.scene) {
        return vec![];
    }
    let starts = (2..=optimizer.starts).map(Attempt::Start);
    [Attempt::Direct, Attempt::Coarse, Attempt::Refined].into_iter().chain(starts).collect()
}

/// The runs of a case, in order: attempts, one from the best of them and one from a fairer shape, or one per mesh of
/// its continuation, else one per start. On the meshes of a continuation, the axis with most bricks of all blocks gets
/// the number asked for, and the others keep their proportion to it.
pub fn stages(case: &Case) -> Vec<PlannedRun> {
    let meshes = &case.optimizer.continuation;
    let starts = case.optimizer.starts;
    let attempts = attempts(case);
    if !attempts.is_empty() {
        let parts = attempts.into_iter().map(Part::Try).chain([Part::Whole, Part::Fair]);
        return parts.map(|part| PlannedRun { part, case: case.clone() }).collect();
    }
    if meshes.is_empty() && starts > 1 {
        return (1..=starts).map(|start| PlannedRun { part: Part::Start(start), case: case.clone() }).collect();
    }
    if meshes.is_empty() {
        return vec![PlannedRun { part: Part::Whole, case: case.clone() }];
    }
    if !case.meshes.is_empty() {
        let part = |index: usize| Part::Mesh(MeshName::File(index + 1));
        let meshes = case.meshes.iter().cloned().enumerate();
        return meshes.map(|(index, case)| PlannedRun { part: part(index), case }).collect();
    }
    let blocks = case.scene.bodies.iter().filter_map(BodyScene::block);
    let longest = blocks.flat_map(|block| block.bricks).max().unwrap_or(1);
    let stage = |bricks: usize| {
        let case = case.clone().with_blocks(|blocks| {
            let scaled = |count: usize| ((count * bricks) as f64 / longest as f64).round().max(1.0) as usize;
            blocks.bricks = blocks.bricks.map(scaled);
            let fits = blocks.bricks.iter().zip(&blocks.subdomains).all(|(mesh, count)| mesh.is_multiple_of(*count));
            if !fits {
                blocks.subdomains = blocks.bricks.map(default_subdomains);
            }
        });
        PlannedRun { part: Part::Mesh(MeshName::Bricks(bricks)), case }
    };
    meshes.iter().filter_map(ContinuationMesh::bricks).map(stage).collect()
}

/// The last of them that the run in a folder has begun.
pub fn last_begun(case: &Case, folder: &Path) -> Option<PlannedRun> {
    let begun = |stage: &PlannedRun| stage.part.folder().is_none_or(|name| Journal::exists(folder.join(name)));
    stages(case).into_iter().rev().find(begun)
}
