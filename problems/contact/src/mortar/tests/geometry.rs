//! Weights, areas and coverage of known surfaces.

use super::super::{Along, Mortar};
use super::surface::{Surface, finite, linear_error, mortar, row_error};

fn assert_identity(mortar: &Mortar, tolerance: f64) {
    for node in &mortar.nodes {
        let own = node.weights.iter().find(|(j, _)| *j == node.node).map_or(0.0, |(_, w)| *w);
        assert!((own - 1.0).abs() < tolerance, "{node:?}");
        assert!(node.weights.iter().all(|(j, w)| *j == node.node || w.abs() < tolerance), "{node:?}");
    }
}

#[test]
fn equal_grids_couple_node_by_node() {
    for triangles in [false, true] {
        let (mut slave, mut master) = (Surface::unit(4, 0.0, true), Surface::unit(4, 0.0, false));
        if triangles {
            // The diagonals of the master are those of the slave: both start at the first corner.
            (slave, master) = (slave.triangles(), master.triangles());
        }
        for along in [Along::X3, Along::Normals] {
            let mortar = mortar(&slave, &master, along);
            assert_identity(&mortar, 1e-12);
            for node in &mortar.nodes {
                assert!((node.covered - 1.0).abs() < 1e-12);
                let [x, y, _] = slave.positions[node.node as usize];
                let side = |s: f64| if s == 0.0 || s == 1.0 { 0.5 } else { 1.0 };
                if !triangles {
                    assert!((node.area - side(x) * side(y) / 16.0).abs() < 1e-15, "{node:?}");
                }
                assert!((node.normal[2] - 1.0).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn equal_distorted_grids_in_any_position() {
    for (axis, angle) in [([1.0, 2.0, -0.5], 0.3), ([0.0, 1.0, 0.0], 2.9), ([1.0, 0.0, 0.3], 1.6)] {
        let place = |surface: Surface| surface.distorted(0.05, 7).turned(axis, angle).shifted([3.0, -20.0, 5.0]);
        let (slave, master) = (place(Surface::unit(4, 0.0, true)), place(Surface::unit(4, 0.0, false)));
        let mortar = mortar(&slave, &master, Along::Normals);
        assert_identity(&mortar, 1e-12);
        let area: f64 = mortar.nodes.iter().map(|node| node.area).sum();
        assert!((area - 1.0).abs() < 1e-13);
    }
}

#[test]
fn projection_along_the_axis_does_not_care_which_side_is_the_slave() {
    let slave = Surface::unit(3, 0.0, false);
    let master = Surface::unit(4, 0.2, true);
    let mortar = mortar(&slave, &master, Along::X3);
    assert!(row_error(&mortar) < 1e-13 && linear_error(&mortar, &slave, &master) < 1e-13);
    assert!(mortar.nodes.iter().all(|node| node.normal == [0.0, 0.0, 1.0] && (node.covered - 1.0).abs() < 1e-12));
}

#[test]
fn linear_fields_are_exact_on_regular_grids() {
    for [n, m] in [[3, 4], [7, 5], [4, 3], [1, 6]] {
        for triangles in [[false, false], [true, false], [false, true], [true, true]] {
            let with = |surface: Surface, triangles: bool| if triangles { surface.triangles() } else { surface };
            let slave = with(Surface::unit(n, 0.0, true), triangles[0]);
            let master = with(Surface::unit(m, 0.1, false), triangles[1]);
            for along in [Along::X3, Along::Normals] {
                let mortar = mortar(&slave, &master, along);
                assert!(row_error(&mortar) < 1e-13);
                let error = linear_error(&mortar, &slave, &master);
                assert!(error < 1e-13, "{n} {m} {triangles:?}: {error:e}");
                let area: f64 = mortar.nodes.iter().map(|node| node.area).sum();
                assert!((area - 1.0).abs() < 1e-13);
                assert!(mortar.nodes.iter().all(|node| (node.covered - 1.0).abs() < 1e-12));
            }
        }
    }
}

/// The largest |Σ_i D_i m_ij − ∫ Nᵐ_j|, in parts of the mean ∫ Nᵐ_j; both surfaces cover each other.
fn force_error(mortar: &Mortar, swapped: &Mortar) -> f64 {
    let transferred = |master: u32| {
        let entries = mortar.nodes.iter().flat_map(|node| node.weights.iter().map(|&(j, w)| (j, node.area * w)));
        entries.filter(|&(j, _)| j == master).map(|(_, w)| w).sum::<f64>()
    };
    // A_j = D_j over the covered share is exact.
    let errors = swapped.nodes.iter().map(|node| (transferred(node.node) - node.area / node.covered).abs());
    errors.fold(0.0, f64::max) * swapped.nodes.len() as f64
}

#[test]
fn linear_fields_and_constant_pressures_on_distorted_grids() {
    for [n, m] in [[3, 4], [7, 5]] {
        for size in [0.0, 0.2] {
            let slave = Surface::unit(n, 0.0, true).distorted(size / n as f64, 1);
            let master = Surface::unit(m, 0.0, false).distorted(size / m as f64, 99);
            let coupled = mortar(&slave, &master, Along::X3);
            // ψ is biorthogonal to x = Σ N_k x_k with any rule, so linear fields are exact.
            assert!(row_error(&coupled) < 1e-13 && linear_error(&coupled, &slave, &master) < 1e-13);
            // Constant pressures are as exact as the rule for the inverse bilinear maps.
            let error = force_error(&coupled, &mortar(&master, &slave, Along::X3));
            println!("{n}:{m} distorted by {size}: constant pressure {error:.1e}");
            assert!(if size == 0.0 { error < 1e-12 } else { error < 1e-5 && error > 1e-12 });
        }
    }
}

#[test]
fn a_master_that_ends_inside_the_slave() {
    let slave = Surface::unit(5, 0.0, true);
    let master = Surface::grid([4, 3], [0.0, 0.63, -0.1, 1.1], 0.0, false);
    let mortar = mortar(&slave, &master, Along::Normals);
    assert!(row_error(&mortar) < 1e-12 && finite(&mortar));
    let area: f64 = mortar.nodes.iter().map(|node| node.area).sum();
    assert!((area - 0.63).abs() < 1e-13);
    for node in &mortar.nodes {
        let [x, ..] = slave.positions[node.node as usize];
        // Over [0.6, 0.8] only 0.15 of the facet is covered: the share of a hat function that is left.
        let share = match x {
            x if x < 0.5 => 1.0,
            x if x < 0.7 => 0.5 + 0.15 - 0.15 * 0.15 / 2.0,
            x if x < 0.9 => 0.15 * 0.15 / 2.0,
            _ => 0.0,
        };
        assert!((node.covered - share).abs() < 1e-12, "{node:?} {share}");
        assert_eq!(node.weights.is_empty(), share == 0.0);
    }
}

#[test]
fn slivers_give_finite_numbers() {
    for exponent in 1..=13 {
        let width = 10.0_f64.powi(-exponent);
        for master in [
            Surface::grid([2, 3], [-1.0, 0.5 + width, -0.1, 1.1], 0.0, false),
            Surface::grid([2, 3], [-1.0, 0.5 + width, -1.0, 0.5 + 0.7 * width], 0.0, false),
            Surface::grid([1, 3], [0.6, 0.6 + width, -0.1, 1.1], 0.0, false),
            Surface::grid([1, 3], [0.6, 0.6 + width, 0.2, 0.2 + width], 0.0, false),
        ] {
            for slave in [Surface::unit(2, 0.0, true), Surface::unit(2, 0.0, true).triangles()] {
                let mortar = mortar(&slave, &master, Along::Normals);
                assert!(finite(&mortar));
                let error = row_error(&mortar);
                assert!(error < 1e-10, "{width:e}: {error:e}");
                let changes = mortar.changes(&|side, node| [0.3 * side as f64, f64::from(node), 0.1]);
                let finite = |c: &f64| c.is_finite();
                assert!(changes.iter().all(|node| node.area.is_finite() && node.weights.iter().all(finite)));
            }
        }
    }
}

#[test]
fn only_the_nearest_layer_counts() {
    let slave = Surface::unit(3, 0.0, true);
    let near = Surface::unit(4, 0.3, false);
    let alone = mortar(&slave, &near, Along::Normals);
    let far = Surface::unit(5, 0.9, false);
    for both in [near.clone().joined(far.clone()), far.clone().joined(near.clone())] {
        let first = if both.positions[0][2] < 0.5 { 0 } else { far.positions.len() as u32 };
        let layered = mortar(&slave, &both, Along::Normals);
        for (a, b) in alone.nodes.iter().zip(&layered.nodes) {
            assert_eq!(a.area, b.area);
            assert!(a.weights.iter().zip(&b.weights).all(|(a, b)| a.0 + first == b.0 && (a.1 - b.1).abs() < 1e-14));
            assert_eq!(a.weights.len(), b.weights.len());
        }
    }
}

#[test]
fn facets_that_face_away_do_not_count() {
    let slave = Surface::unit(3, 0.0, true);
    let away = Surface::unit(4, 0.1, true);
    for along in [Along::X3, Along::Normals] {
        let mortar = mortar(&slave, &away, along);
        assert!(mortar.nodes.iter().all(|node| node.area == 0.0 && node.covered == 0.0 && node.weights.is_empty()));
    }
}

/// The four walls of a prism about the third axis, seen from outside or inside.
fn walls(half: f64, outward: bool, n: usize) -> Surface {
    let base = Surface::grid([n, 2], [-half, half, -0.5, 0.5], 0.0, true);
    let wall = |quarter: usize| {
        let angle = quarter as f64 * std::f64::consts::FRAC_PI_2;
        let upright = base.clone().turned([1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2);
        let placed = upright.shifted([0.0, -half, 0.0]).turned([0.0, 0.0, 1.0], angle);
        if outward { placed } else { placed.flipped() }
    };
    (1..4).fold(wall(0), |sum, quarter| sum.joined(wall(quarter)))
}

#[test]
fn a_box_about_a_pin() {
    // The inner walls of the box and its outer walls, which face away from the pin or lie behind the inner ones.
    let (pin, inner, outer) = (walls(1.0, true, 3), walls(1.1, false, 4), walls(1.5, true, 4));
    let alone = mortar(&pin, &inner, Along::Normals);
    let both = mortar(&pin, &inner.clone().joined(outer), Along::Normals);
    for (a, b) in alone.nodes.iter().zip(&both.nodes) {
        assert!((a.covered - 1.0).abs() < 1e-12, "{a:?}");
        assert_eq!((a.area, a.weights.len()), (b.area, b.weights.len()));
        // All weights on the wall that faces: it lies further out by 0.1 along the normal of the wall.
        let own = pin.positions[a.node as usize];
        let sum: Vec<f64> = (0..3)
            .map(|k| a.weights.iter().map(|&(j, w)| w * inner.positions[j as usize][k]).sum::<f64>() - own[k])
            .collect();
        let normal_distance: f64 = (0..3).map(|k| a.normal[k] * sum[k]).sum();
        assert!((normal_distance - 0.1).abs() < 1e-12, "{a:?} {sum:?}");
    }
}
