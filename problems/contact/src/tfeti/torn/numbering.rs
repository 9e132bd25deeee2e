//! The order of the subdomains: neighbours in the order are neighbours in the bodies, so that a range of it is compact.
//!
//! ```text
//! a box of clusters is halved across its longest axis, again and again;   cluster k of the lower body, k of the upper one, k + 1 …
//! ```
//! The subdomains of a cluster follow each other, in an order of the same kind; without clusters, every subdomain is
//! one. The order does not depend on the number of processes. Each gets a range of it by recursive bisection.

use crate::body::mesh::{Subdomain, Tearing};
use crate::lattice;

/// Numbers of the subdomains of all bodies.
#[derive(Debug)]
pub struct Numbering {
    /// Bodies and places of the subdomains, by number.
    places: Vec<(usize, Subdomain)>,
    /// Numbers of the subdomains of every body, by their index in the tearing.
    numbers: Vec<Vec<usize>>,
    /// Numbers of the clusters of every body, by their index in the box of clusters.
    clusters: Vec<Vec<usize>>,
    members: usize,
}

impl Numbering {
    /// Numbers the subdomains of bodies that are all torn alike, `counts` per axis, in clusters of `shape` subdomains
    /// per axis, which divides `counts`.
    pub fn new(tearing: &Tearing, counts: [usize; 3], shape: [usize; 3], bodies: usize) -> Self {
        let boxes: [usize; 3] = std::array::from_fn(|axis| counts[axis] / shape[axis]);
        let (mut order, mut inner) = (Vec::new(), Vec::new());
        bisect([0; 3], boxes, &mut |place| order.push(place));
        bisect([0; 3], shape, &mut |place| inner.push(place));
        let (mut numbers, mut clusters) =
            (vec![vec![0; tearing.subdomains.len()]; bodies], vec![vec![0; order.len()]; bodies]);
        let mut places = Vec::with_capacity(bodies * tearing.subdomains.len());
        for cluster in order {
            let first: [usize; 3] = std::array::from_fn(|axis| cluster[axis] * shape[axis]);
            for body in 0..bodies {
                clusters[body][lattice::index(boxes, cluster)] = places.len() / inner.len();
                for &place in &inner {
                    let index = lattice::index(counts, lattice::add(first, place));
                    numbers[body][index] = places.len();
                    places.push((body, tearing.subdomains[index].clone()));
                }
            }
        }
        Self { places, numbers, clusters, members: inner.len() }
    }

    /// Number of subdomains of a cluster.
    pub fn members(&self) -> usize {
        self.members
    }

    pub fn cluster_count(&self) -> usize {
        self.count() / self.members
    }

    /// The number of a cluster of a body, by its index in the box of clusters.
    pub fn cluster(&self, body: usize, index: usize) -> usize {
        self.clusters[body][index]
    }

    pub fn count(&self) -> usize {
        self.places.len()
    }

    pub fn body_count(&self) -> usize {
        self.numbers.len()
    }

    /// Body and place of the subdomain of a number.
    pub fn place(&self, number: usize) -> (usize, &Subdomain) {
        let (body, place) = &self.places[number];
        (*body, place)
    }

    /// The number of a subdomain of a body.
    pub fn number(&self, body: usize, index: usize) -> usize {
        self.numbers[body][index]
    }

    /// The numbers and places of the subdomains of a body, in the order of the tearing.
    pub fn of_body(&self, body: usize) -> impl Iterator<Item = (usize, &Subdomain)> {
        self.numbers[body].iter().map(|&number| (number, self.place(number).1))
    }
}

/// Visits the points from `first` to `end` of a box, each half after the other.
fn bisect(first: [usize; 3], end: [usize; 3], visit: &mut impl FnMut([usize; 3])) {
    let size = lattice::subtract(end, first);
    let axis = (0..3).max_by_key(|&axis| (size[axis], 2 - axis)).unwrap_or(0);
    if size[axis] == 1 {
        visit(first);
        return;
    }
    let (mut middle_end, mut middle) = (end, first);
    middle[axis] += size[axis] / 2;
    middle_end[axis] = middle[axis];
    bisect(first, middle_end, visit);
    bisect(middle, end, visit);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::mesh::Grid;

    #[test]
    fn every_subdomain_has_a_number_and_ranges_are_boxes() {
        let counts = [3, 4, 2];
        let tearing = Tearing::new(&Grid { cells: [6, 8, 2], size: [1.0, 1.0] }, counts);
        let numbering = Numbering::new(&tearing, counts, [1; 3], 2);
        assert_eq!(numbering.count(), 48);
        for body in 0..2 {
            for (index, place) in tearing.subdomains.iter().enumerate() {
                assert_eq!(numbering.place(numbering.number(body, index)), (body, place));
            }
            assert_eq!(numbering.of_body(body).count(), 24);
        }
        // Half of the order is half of the box, across its longest axis.
        assert!((0..24).all(|number| numbering.place(number).1.first_cell[1] < 4));
        assert!((24..48).all(|number| numbering.place(number).1.first_cell[1] >= 4));
    }

    #[test]
    fn the_subdomains_of_a_cluster_follow_each_other() {
        let (counts, shape) = ([6, 4, 2], [3, 2, 1]);
        let tearing = Tearing::new(&Grid { cells: [6, 4, 2], size: [1.0, 1.0] }, counts);
        let numbering = Numbering::new(&tearing, counts, shape, 2);
        assert_eq!((numbering.members(), numbering.cluster_count()), (6, 16));
        for body in 0..2 {
            for (index, place) in tearing.subdomains.iter().enumerate() {
                let number = numbering.number(body, index);
                assert_eq!(numbering.place(number), (body, place));
                let cluster = std::array::from_fn(|axis| place.first_cell[axis] / shape[axis]);
                assert_eq!(number / 6, numbering.cluster(body, lattice::index([2, 2, 2], cluster)));
            }
        }
    }
}
