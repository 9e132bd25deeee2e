//! Random surfaces.

use super::super::Along;
use super::surface::{Surface, finite, mortar, row_error};
use proptest::prelude::*;

fn placed(surface: Surface, axis: [f64; 3], angle: f64) -> Surface {
    surface.turned(axis, angle).shifted([0.3, 0.1, 2.0])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_pairs_have_finite_numbers_and_row_sums_of_one(
        n in 1_usize..5, ratio in 1_usize..9, swap: bool, kinds in 0_usize..4, along: bool,
        tilt in -0.4_f64..0.4, turn in -3.0_f64..3.0, angle in 0.0_f64..3.0,
        shake in 0.0_f64..0.3, size in 0.3_f64..2.0, seed in 0_usize..10_000,
    ) {
        let [fine, coarse] = [(n * ratio).min(12), n];
        let [own, other] = if swap { [fine, coarse] } else { [coarse, fine] };
        let slave = Surface::unit(own, 0.0, true).shaken(shake / own as f64, seed);
        let master = Surface::grid([other, other], [0.5 - size / 2.0, 0.5 + size / 2.0, 0.0, size], 0.05, false);
        let master = master.shaken(shake / other as f64, seed + 5000);
        let master = master.turned([0.0, 0.0, 1.0], 0.1 * turn).turned([1.0, 0.3, 0.0], tilt);
        let with = |surface: Surface, triangles: bool| if triangles { surface.triangles() } else { surface };
        let axis = [1.0, turn, 0.5];
        let slave = placed(with(slave, kinds % 2 == 1), axis, angle);
        let master = placed(with(master, kinds > 1), axis, angle);
        let along = if along { Along::Normals } else { Along::X3 };
        let coupled = mortar(&slave, &master, along);
        prop_assert!(finite(&coupled));
        prop_assert!(row_error(&coupled) < 1e-10, "{:e}", row_error(&coupled));
        // Facets that are seen nearly edge-on are far from parallelograms: of 20 000 pairs, one was above 1e-4.
        prop_assert!(coupled.nodes.iter().all(|node| node.area >= 0.0 && node.covered < 1.0 + 1e-3));
        let changes = coupled.changes(&|side, node| [1.0, side as f64, 0.1 * f64::from(node)]);
        prop_assert!(changes.iter().flat_map(|c| c.weights.iter().chain([&c.area])).all(|x| x.is_finite()));
    }
}
