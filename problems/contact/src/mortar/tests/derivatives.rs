//! Derivatives against differences, and both directions against each other.

use super::super::derivative::NodeChange;
use super::super::{Along, Mortar, MortarNode, NodeSensitivity, Primitive};
use super::surface::{Surface, mortar, noise};

fn velocity(seed: usize, side: usize, node: u32) -> [f64; 3] {
    std::array::from_fn(|c| noise(seed + 1000 * side + 3 * node as usize + c))
}

/// Surfaces that are curved, distorted and do not match, with facets of one or both kinds; the master overhangs or
/// ends inside the slave. From kind 8 on, facets are of second degree.
pub fn surfaces(kind: usize) -> [Surface; 2] {
    let curved = |surface: Surface| surface.moved(|_, [x, y, z]| [x, y, z + 0.2 * x * x - 0.15 * y * y + 0.1 * x * y]);
    let end = if kind % 8 < 4 { [-0.13, 1.17, -0.07, 1.09] } else { [0.21, 0.83, -0.07, 0.71] };
    let slave = curved(Surface::unit(3, 0.0, true)).shaken(0.03, 5 + kind);
    let master = curved(Surface::grid([4, 3], end, 0.05, false)).shaken(0.03, 300 + kind);
    let place = |surface: Surface| surface.turned([1.0, 0.4, 0.2], 0.4).shifted([2.0, 1.0, -3.0]);
    let pair = match kind % 4 {
        0 => [place(slave), place(master)],
        1 => [place(slave.triangles()), place(master)],
        2 => [place(slave), place(master.triangles())],
        _ => [place(slave.triangles()), place(master.triangles())],
    };
    let sphere = Primitive::Sphere { point: [2.5, 1.5, -8.0], radius: 5.1 };
    let [slave, master] = pair;
    match kind < 8 {
        true => [slave, master],
        false => [slave.curved(0.02, 41 + kind, Some(sphere)), master.curved(0.02, 77 + kind, Some(sphere))],
    }
}

/// Directions of projection that a kind of surfaces is for: facets of second degree have normals of their own.
fn ways(kind: usize) -> &'static [Along] {
    if kind < 8 { &[Along::X3, Along::Normals] } else { &[Along::Normals] }
}

pub fn moved(surfaces: &[Surface; 2], seed: usize, step: f64) -> [Surface; 2] {
    std::array::from_fn(|side| {
        surfaces[side].clone().moved(|k, x| {
            let v = velocity(seed, side, k as u32);
            std::array::from_fn(|c| x[c] + step * v[c])
        })
    })
}

/// Normal, area and weights of all master nodes of each node that is covered by 1e-3 or more, or of `changes` of it.
fn dense(mortar: &Mortar, masters: usize, changes: Option<&[NodeChange]>) -> Vec<f64> {
    let mut numbers = Vec::new();
    for (k, node) in mortar.nodes.iter().enumerate() {
        let mut row = vec![0.0; masters + 5];
        let weights: Vec<f64> = match changes {
            Some(changes) => changes[k].weights.clone(),
            None => node.weights.iter().map(|(_, w)| *w).collect(),
        };
        let (area, normal) = changes.map_or((node.area, node.normal), |changes| (changes[k].area, changes[k].normal));
        row[3] = area;
        if node.covered > 1e-3 || !mortar.is_quadratic() {
            row[..3].copy_from_slice(&normal);
        }
        if node.covered > 1e-3 {
            row[masters + 4] = changes.map_or(node.gap, |changes| changes[k].gap);
            node.weights.iter().zip(weights).for_each(|(&(j, _), w)| row[4 + j as usize] = w);
        }
        numbers.extend(row);
    }
    numbers
}

#[test]
fn changes_agree_with_central_differences() {
    for kind in 0..16 {
        for &along in ways(kind) {
            let mut worst = 0.0_f64;
            let pair = surfaces(kind);
            let masters = pair[1].positions.len();
            let central = mortar(&pair[0], &pair[1], along);
            let change = dense(&central, masters, Some(&central.changes(&|side, node| velocity(17, side, node))));
            let at = |step: f64| {
                let [slave, master] = moved(&pair, 17, step);
                dense(&mortar(&slave, &master, along), masters, None)
            };
            let h = 2e-5;
            let [a, b, c, d] = [at(-2.0 * h), at(-h), at(h), at(2.0 * h)];
            let size = change.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(size > 0.1);
            for k in 0..change.len() {
                let difference = (8.0 * (c[k] - b[k]) - (d[k] - a[k])) / (12.0 * h);
                worst = worst.max((difference - change[k]).abs() / size);
            }
            println!("{kind} {along:?}: forward against differences {worst:.1e}");
            assert!(worst < 1e-6, "{kind} {along:?}: {worst:e}");
        }
    }
}

#[test]
fn pull_back_is_the_transpose_of_changes() {
    for kind in 0..16 {
        for &along in ways(kind) {
            let pair = surfaces(kind);
            let coupled = mortar(&pair[0], &pair[1], along);
            let sensitivity = |k: usize, weights: usize| NodeSensitivity {
                area: noise(31 + k),
                weights: (0..weights).map(|w| noise(900 + 20 * k + w)).collect(),
                normal: std::array::from_fn(|c| noise(5000 + 3 * k + c)),
                gap: if kind < 8 || weights == 0 { 0.0 } else { noise(7000 + k) },
            };
            let nodes = coupled.nodes.iter().enumerate();
            let count = |node: &MortarNode| if node.covered > 1e-3 { node.weights.len() } else { 0 };
            let own: Vec<NodeSensitivity> = nodes.map(|(k, node)| sensitivity(k, count(node))).collect();
            // Some nodes are at rest on both sides.
            let moves = |side: usize, node: u32| !(node as usize + side).is_multiple_of(3);
            let field = |side: usize, node: u32| if moves(side, node) { velocity(4, side, node) } else { [0.0; 3] };
            let (mut reverse, mut largest) = (0.0, 0.0_f64);
            let mut last = [None, None];
            coupled.pull_back(&own, [&|node| moves(0, node), &|node| moves(1, node)], &mut |side, node, part| {
                assert!(moves(side, node) && last[side].is_none_or(|last| last < node));
                last[side] = Some(node);
                let v = field(side, node);
                (0..3).for_each(|c| reverse += v[c] * part[c]);
                (0..3).for_each(|c| largest = largest.max((v[c] * part[c]).abs()));
            });
            let forward: f64 = coupled.changes(&field).iter().zip(&own).map(|(change, own)| paired(change, own)).sum();
            // Facets of which only 1e-5 is covered lose digits.
            let tolerance = if kind % 8 < 4 { 1e-12 } else { 1e-9 };
            println!("{kind} {along:?}: transpose {:.1e}", (forward - reverse).abs() / largest);
            assert!((forward - reverse).abs() < tolerance * largest, "{kind} {along:?}: {forward} {reverse}");
            assert!(largest > 1e-3);
        }
    }
}

fn paired(change: &NodeChange, own: &NodeSensitivity) -> f64 {
    let weights: f64 = change.weights.iter().zip(&own.weights).map(|(a, b)| a * b).sum();
    weights
        + change.area * own.area
        + change.gap * own.gap
        + (0..3).map(|c| change.normal[c] * own.normal[c]).sum::<f64>()
}

#[test]
fn a_common_motion_changes_only_the_normals() {
    for along in [Along::X3, Along::Normals] {
        let pair = surfaces(4);
        let coupled = mortar(&pair[0], &pair[1], along);
        for change in coupled.changes(&|_, _| [0.3, -0.2, 0.7]) {
            assert!(change.area.abs() < 1e-13 && change.weights.iter().all(|w| w.abs() < 1e-8), "{change:?}");
            assert!(change.normal.iter().all(|c| c.abs() < 1e-13));
        }
        // A rotation about the third axis for X3, about any axis for normals.
        let spin = if along == Along::X3 { [0.0, 0.0, 0.9] } else { [0.4, -0.5, 0.9] };
        let rotation = |x: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| spin[(k + 1) % 3] * x[(k + 2) % 3] - spin[(k + 2) % 3] * x[(k + 1) % 3])
        };
        let changes = coupled.changes(&|side, node| rotation(pair[side].positions[node as usize]));
        for (change, node) in changes.iter().zip(&coupled.nodes) {
            assert!(change.area.abs() < 1e-13 && change.weights.iter().all(|w| w.abs() < 1e-8), "{change:?}");
            let expected = rotation(node.normal);
            assert!((0..3).all(|c| (change.normal[c] - expected[c]).abs() < 1e-12));
        }
    }
}

#[test]
fn several_threads_give_the_same_bits() {
    let pair = surfaces(0);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let coupled = mortar(&pair[0], &pair[1], Along::Normals);
            let change = coupled.changes(&|side, node| velocity(17, side, node));
            (dense(&coupled, pair[1].positions.len(), None), change)
        })
    };
    assert_eq!(run(1), run(4));
}
