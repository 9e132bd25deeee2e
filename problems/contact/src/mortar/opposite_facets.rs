//! The master facets that may lie opposite to a slave facet, from a tree of boxes.

use super::frame::{Bound, Frame};
use rstar::{AABB, Envelope, RTree, RTreeObject, SelectionFunction};

/// The facets of a master face.
pub struct OppositeFacets(RTree<Leaf>);

/// A facet with its bound.
struct Leaf {
    facet: usize,
    bound: Bound,
}

impl RTreeObject for Leaf {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let Bound { centre, radius, .. } = self.bound;
        AABB::from_corners(centre.map(|x| x - radius), centre.map(|x| x + radius))
    }
}

/// The facets that may meet the projection of a facet of this radius.
struct Facing<'a> {
    frame: &'a Frame,
    radius: f64,
}

impl SelectionFunction<Leaf> for Facing<'_> {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 3]>) -> bool {
        // A face without facets has an empty box.
        envelope.area() >= 0.0 && self.frame.may_reach(self.radius, envelope.lower(), envelope.upper())
    }

    fn should_unpack_leaf(&self, leaf: &Leaf) -> bool {
        self.frame.may_meet(self.radius, &leaf.bound)
    }
}

impl OppositeFacets {
    /// The tree of facets with these bounds, in the order of their numbers.
    pub fn new(bounds: impl IntoIterator<Item = Bound>) -> Self {
        let leaves = bounds.into_iter().enumerate().map(|(facet, bound)| Leaf { facet, bound });
        Self(RTree::bulk_load(leaves.collect()))
    }

    /// The facets that may meet the projection of a facet with this frame and radius, ascending.
    pub fn facing(&self, frame: &Frame, radius: f64) -> Vec<usize> {
        let found = self.0.locate_with_selection_function(Facing { frame, radius });
        let mut facets: Vec<usize> = found.map(|leaf| leaf.facet).collect();
        facets.sort_unstable();
        facets
    }
}

#[cfg(test)]
mod tests {
    use super::super::Along;
    use super::*;
    use proptest::prelude::*;
    use testset::kit::Random;

    proptest! {
        #[test]
        fn all_pairs_find_the_same_facets(count in 0_usize..200, seed in 1_u64..10_000, flat in 0.0_f64..1.0) {
            let mut random = Random(seed);
            let mut triangle = |size: f64| -> [[f64; 3]; 3] {
                let place: [f64; 3] = std::array::from_fn(|axis| random.signed() * if axis == 2 { flat } else { 1.0 });
                std::array::from_fn(|_| std::array::from_fn(|axis| place[axis] + size * random.signed()))
            };
            let bounds: Vec<Bound> = (0..count).map(|_| Bound::of_reversed(&triangle(0.2))).collect();
            let tree = OppositeFacets::new(bounds.iter().copied());
            for _facet in 0..20 {
                let Some(frame) = Frame::new(&triangle(0.2), Along::Normals) else { continue };
                let all = (0..count).filter(|&facet| frame.may_meet(0.2, &bounds[facet]));
                prop_assert_eq!(tree.facing(&frame, 0.2), all.collect::<Vec<_>>());
            }
        }
    }
}
