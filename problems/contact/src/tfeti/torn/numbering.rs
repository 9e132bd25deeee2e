//! The order of the subdomains: neighbours in the order are neighbours in the bodies, so that a range of it is compact.
//!
//! ```text
//! pieces of all bodies ─ by clusters of one body ─ halved across the longest extent of their centres, again and again
//! ```
//! The subdomains of a cluster follow each other, in an order of the same kind; without clusters, every subdomain is
//! one. The order does not depend on the number of processes. Each gets a range of it by recursive bisection.

use crate::body::{Body, Piece};
use crate::linear::ordering::longest_axis;
use std::ops::Range;

/// Numbers of the subdomains of all bodies.
#[derive(Debug)]
pub struct Numbering {
    /// Bodies and pieces of the subdomains, by number.
    places: Vec<(usize, usize)>,
    /// Numbers of the subdomains of every body, by their pieces.
    numbers: Vec<Vec<usize>>,
    /// First dof of every subdomain, then the number of torn dofs.
    starts: Vec<usize>,
    /// First subdomain of every cluster, then the number of subdomains.
    clusters: Vec<usize>,
    /// The cluster of every subdomain.
    cluster_of: Vec<usize>,
}

/// A point with what it stands for.
type Placed<T> = ([f64; 3], T);
/// Pieces that belong together, as (body, piece).
type Group = Vec<Placed<(usize, usize)>>;

impl Numbering {
    /// Numbers the pieces of bodies, in about so many clusters; none: every piece is one.
    pub fn new(bodies: &[Body], clusters: Option<usize>) -> Self {
        let all: usize = bodies.iter().map(|body| body.pieces.len()).sum();
        let mut groups: Vec<Placed<Group>> = Vec::new();
        for (number, body) in bodies.iter().enumerate() {
            let piece = |(index, piece): (usize, &Piece)| (centre(body, piece), (number, index));
            let pieces: Group = body.pieces.iter().enumerate().map(piece).collect();
            let share = |count: usize| (count * pieces.len() + all / 2) / all;
            let count = clusters.map_or(pieces.len(), share).clamp(1, pieces.len());
            let mut own = Vec::new();
            divide(pieces, count, &mut own);
            groups.extend(own.into_iter().map(|group| (mean(&group), group)));
        }
        let mut order = Vec::with_capacity(groups.len());
        let count = groups.len();
        divide(groups, count, &mut order);
        let (mut places, mut cluster_starts) = (Vec::with_capacity(all), vec![0]);
        for (_, group) in order.into_iter().flatten() {
            let (count, mut inner) = (group.len(), Vec::new());
            divide(group, count, &mut inner);
            places.extend(inner.into_iter().flatten().map(|(_, place)| place));
            cluster_starts.push(places.len());
        }
        let mut numbers: Vec<Vec<usize>> = bodies.iter().map(|body| vec![0; body.pieces.len()]).collect();
        let mut starts = vec![0];
        for (number, &(body, piece)) in places.iter().enumerate() {
            numbers[body][piece] = number;
            starts.push(starts[number] + bodies[body].pieces[piece].dof_count());
        }
        let of_cluster = |(cluster, pair): (usize, &[usize])| std::iter::repeat_n(cluster, pair[1] - pair[0]);
        let cluster_of = cluster_starts.windows(2).enumerate().flat_map(of_cluster).collect();
        Self { places, numbers, starts, clusters: cluster_starts, cluster_of }
    }

    /// Whether clusters consist of several subdomains.
    pub fn is_joined(&self) -> bool {
        self.cluster_count() < self.count()
    }

    pub fn cluster_count(&self) -> usize {
        self.clusters.len() - 1
    }

    /// The subdomains of a cluster.
    pub fn members(&self, cluster: usize) -> Range<usize> {
        self.clusters[cluster]..self.clusters[cluster + 1]
    }

    /// First subdomain of every cluster, then the number of subdomains.
    pub fn cluster_starts(&self) -> &[usize] {
        &self.clusters
    }

    /// The cluster of a subdomain.
    pub fn cluster_of(&self, number: usize) -> usize {
        self.cluster_of[number]
    }

    /// Number of subdomains.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Number of torn dofs.
    pub fn dof_count(&self) -> usize {
        self.starts[self.count()]
    }

    /// First dof of every subdomain, then the number of torn dofs.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// The subdomain of a torn dof.
    pub fn owner(&self, dof: usize) -> usize {
        self.starts.partition_point(|&start| start <= dof) - 1
    }

    /// Body and piece of the subdomain of a number.
    pub fn place(&self, number: usize) -> (usize, usize) {
        self.places[number]
    }

    /// The number of a piece of a body.
    pub fn number(&self, body: usize, piece: usize) -> usize {
        self.numbers[body][piece]
    }
}

/// Mean of the nodes of a piece at the reference shape.
fn centre(body: &Body, piece: &Piece) -> [f64; 3] {
    let points: Vec<Placed<()>> = piece.positions(body.mesh.nodes()).map(|point| (point, ())).collect();
    mean(&points)
}

fn mean<T>(points: &[Placed<T>]) -> [f64; 3] {
    let count = points.len().max(1) as f64;
    std::array::from_fn(|axis| points.iter().map(|(point, _)| point[axis]).sum::<f64>() / count)
}

/// Divides points into so many groups across their longest extent, again and again: into halves, or, where the groups
/// are equal, into as many parts as the smallest factor of their number, so that boxes of points are divided into
/// boxes.
fn divide<T>(mut points: Vec<Placed<T>>, count: usize, groups: &mut Vec<Vec<Placed<T>>>) {
    if count <= 1 {
        return groups.push(points);
    }
    let axis = longest_axis(points.iter().map(|(point, _)| *point));
    points.sort_by(|(a, _), (b, _)| a[axis].total_cmp(&b[axis]));
    let size = points.len();
    let are_equal = size > count && size.is_multiple_of(count);
    let parts = (2..=count).find(|factor| are_equal && count.is_multiple_of(*factor)).unwrap_or(2);
    let before = |part: usize| count * part / parts;
    for part in (0..parts).map(|part| before(part)..before(part + 1)) {
        let rest = points.split_off(points.len() * part.len() / (count - part.start));
        divide(std::mem::replace(&mut points, rest), part.len(), groups);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_divided_evenly_and_compactly() {
        let points: Vec<Placed<usize>> = (0..24).map(|i| ([(i % 6) as f64, (i / 6) as f64, 0.0], i)).collect();
        let mut groups = Vec::new();
        divide(points, 4, &mut groups);
        assert!(groups.iter().all(|group| group.len() == 6));
        let extent = |axis: usize| {
            let length = |group: &Vec<Placed<usize>>| {
                let along = || group.iter().map(|(point, _)| point[axis]);
                along().fold(0.0, f64::max) - along().fold(9.0, f64::min)
            };
            groups.iter().map(length).fold(0.0, f64::max)
        };
        assert!(extent(0) <= 2.0 && extent(1) <= 1.0, "{groups:?}");
    }

    #[test]
    fn a_box_of_points_is_divided_into_equal_boxes() {
        let points: Vec<Placed<usize>> =
            (0..216).map(|i| ([(i % 6) as f64, (i / 6 % 6) as f64, (i / 36) as f64], i)).collect();
        let mut groups = Vec::new();
        divide(points, 27, &mut groups);
        assert_eq!(groups.len(), 27);
        for group in groups {
            let first = group[0].0.map(|x| (x / 2.0).floor());
            assert!(group.len() == 8 && group.iter().all(|(x, _)| x.map(|x| (x / 2.0).floor()) == first), "{group:?}");
        }
    }
}
