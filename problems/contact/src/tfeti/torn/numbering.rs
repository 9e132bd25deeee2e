//! The order of the subdomains: neighbours in the order are neighbours in the bodies, so that a range of it is compact.
//!
//! ```text
//! a box of subdomains is halved across its longest axis, again and again;   subdomain k of the lower body, k of the upper one, k + 1 …
//! ```
//! The order does not depend on the number of processes. Every one of them gets a range of it: a recursive bisection.

use crate::body::mesh::{Subdomain, Tearing};
use crate::lattice;

/// Numbers of the subdomains of all bodies.
#[derive(Debug)]
pub struct Numbering {
    /// Bodies and places of the subdomains, by number.
    places: Vec<(usize, Subdomain)>,
    /// Numbers of the subdomains of every body, by their index in the tearing.
    numbers: Vec<Vec<usize>>,
}

impl Numbering {
    /// Numbers the subdomains of bodies that are all torn alike, `counts` per axis.
    pub fn new(tearing: &Tearing, counts: [usize; 3], bodies: usize) -> Self {
        let mut order = Vec::with_capacity(tearing.subdomains.len());
        bisect([0; 3], counts, &mut |place| order.push(lattice::index(counts, place)));
        let mut numbers = vec![vec![0; order.len()]; bodies];
        let mut places = Vec::with_capacity(bodies * order.len());
        for index in order {
            for (body, numbers) in numbers.iter_mut().enumerate() {
                numbers[index] = places.len();
                places.push((body, tearing.subdomains[index].clone()));
            }
        }
        Self { places, numbers }
    }

    /// Number of subdomains.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Number of bodies.
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
        let numbering = Numbering::new(&tearing, counts, 2);
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
}
