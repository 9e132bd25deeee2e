//! Which faces are seen, and in which order they are drawn so that what is nearer covers the rest.
//!
//! Of two faces that have an area of the drawing in common, the one that is nearer there lies in a higher layer. Faces
//! of one layer do not cover each other, so that a layer is drawn as a whole. The layers are drawn one after the other.

use super::canvas::Place;
use super::regions::{around, mean, turn};
use super::scale::extent;

/// Difference of depths from which one face covers another, points.
const MIN_DISTANCE: f64 = 1e-6;
/// Twice the least area in which one face covers another, square points.
const MIN_AREA: f64 = 1e-9;
/// Largest side of faces that are left out if corners and middle are hidden, points.
const MAX_HIDDEN: f64 = 12.0;

/// Triangles and quadrilaterals on the drawing, with the same sense of rotation, roughly in the order of their depths.
pub(super) struct Faces<'a> {
    pub faces: &'a [Vec<usize>],
    pub places: &'a [Place],
    /// How near the points are to the viewer.
    pub depths: &'a [f64],
}

impl Faces<'_> {
    /// The faces by layers; what is drawn first comes first. Most of the faces that are hidden are left out.
    pub fn layers(&self) -> Vec<Vec<usize>> {
        let mut pairs = self.pairs();
        let hidden = self.hidden(&pairs);
        pairs.retain(|&(behind, before)| !hidden[behind] && !hidden[before]);
        let numbers = numbers(&pairs, self.faces.len());
        let mut layers = vec![Vec::new(); numbers.iter().map(|number| number + 1).max().unwrap_or(0)];
        (0..self.faces.len()).filter(|&face| !hidden[face]).for_each(|face| layers[numbers[face]].push(face));
        layers
    }

    fn corners(&self, face: usize) -> Vec<(Place, f64)> {
        self.faces[face].iter().map(|&point| (self.places[point], self.depths[point])).collect()
    }

    fn triangles(&self, face: usize) -> Vec<Triangle> {
        let corners = self.corners(face);
        (2..corners.len()).map(|last| Triangle([corners[0], corners[last - 1], corners[last]])).collect()
    }

    /// Left and upper end of a face, and right and lower end.
    fn ends(&self, face: usize) -> [Place; 2] {
        let along = |axis: usize| self.faces[face].iter().map(move |&point| self.places[point][axis]);
        let ends = [0, 1].map(|axis| extent(along(axis)).unwrap_or((0.0, 0.0)));
        [ends.map(|end| end.0), ends.map(|end| end.1)]
    }

    /// (behind, before) for all faces that have an area in common, in order.
    fn pairs(&self) -> Vec<(usize, usize)> {
        let ends: Vec<[Place; 2]> = (0..self.faces.len()).map(|face| self.ends(face)).collect();
        // Cells of about the size of a face: only faces in the same cell are compared.
        let sides = ends.iter().map(|[low, high]| (high[0] - low[0]).max(high[1] - low[1]));
        let side = (sides.sum::<f64>() / ends.len() as f64).max(1.0);
        let cell = |place: Place| place.map(|coordinate| (coordinate / side).floor() as i64);
        let mut cells: Vec<([i64; 2], usize)> = Vec::new();
        for (face, [low, high]) in ends.iter().enumerate() {
            let [[left, top], [right, foot]] = [cell(*low), cell(*high)];
            cells.extend((left..=right).flat_map(|x| (top..=foot).map(move |y| ([x, y], face))));
        }
        cells.sort_unstable();
        let mut pairs = Vec::new();
        for cell_faces in cells.chunk_by(|a, b| a.0 == b.0) {
            for (index, &(at, a)) in cell_faces.iter().enumerate() {
                for &(_, b) in &cell_faces[..index] {
                    let common = [0, 1].map(|axis| ends[a][0][axis].max(ends[b][0][axis]));
                    let apart = (0..2).any(|axis| common[axis] >= ends[a][1][axis].min(ends[b][1][axis]));
                    // Pairs with several cells in common are compared in one of them.
                    if !apart && cell(common) == at {
                        pairs.extend(self.order(a, b));
                    }
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }

    /// Which of two faces is behind the other where they have an area in common, and which before.
    fn order(&self, a: usize, b: usize) -> Option<(usize, usize)> {
        let others = self.triangles(b);
        self.triangles(a).iter().flat_map(|one| others.iter().map(move |other| (one, other))).find_map(
            |(one, other)| {
                let place = one.common(other)?;
                let distance = other.depth(place) - one.depth(place);
                (distance.abs() > MIN_DISTANCE).then_some(if distance > 0.0 { (a, b) } else { (b, a) })
            },
        )
    }

    /// Small faces whose corners and middle are behind other faces.
    fn hidden(&self, pairs: &[(usize, usize)]) -> Vec<bool> {
        let mut hidden = vec![false; self.faces.len()];
        for pairs in pairs.chunk_by(|a, b| a.0 == b.0) {
            let behind = pairs[0].0;
            let [low, high] = self.ends(behind);
            if (high[0] - low[0]).max(high[1] - low[1]) > MAX_HIDDEN {
                continue;
            }
            let mut seen = self.corners(behind);
            let depth = seen.iter().map(|corner| corner.1).sum::<f64>() / seen.len() as f64;
            seen.push((mean(&seen.iter().map(|corner| corner.0).collect::<Vec<Place>>()), depth));
            for before in pairs.iter().flat_map(|pair| self.triangles(pair.1)) {
                // Faces may cut each other.
                seen.retain(|&(place, depth)| !before.holds(place) || before.depth(place) < depth - MIN_DISTANCE);
            }
            hidden[behind] = seen.is_empty();
        }
        hidden
    }
}

/// Places with their depths.
struct Triangle([(Place, f64); 3]);

impl Triangle {
    /// The parts of the area opposite to the corners that belong to a place, as shares.
    fn shares(&self, place: Place) -> [f64; 3] {
        let [a, b, c] = self.0.map(|corner| corner.0);
        [turn(place, b, c), turn(place, c, a), turn(place, a, b)].map(|part| part / turn(a, b, c))
    }

    fn depth(&self, place: Place) -> f64 {
        self.shares(place).iter().zip(self.0).map(|(share, corner)| share * corner.1).sum()
    }

    /// Whether a place is inside or at a side.
    fn holds(&self, place: Place) -> bool {
        let [a, b, c] = self.0.map(|corner| corner.0);
        let sense = turn(a, b, c).signum();
        let length = |a: Place, b: Place| (b[0] - a[0]).hypot(b[1] - a[1]);
        [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| sense * turn(a, b, place) >= -0.1 * length(a, b))
    }

    /// The middle of the area that two triangles have in common, if there is one.
    fn common(&self, other: &Self) -> Option<Place> {
        let mut area = self.0.map(|corner| corner.0).to_vec();
        let [a, b, c] = other.0.map(|corner| corner.0);
        let sense = turn(a, b, c).signum();
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let inside = |place: Place| sense * turn(from, to, place);
            let mut kept = Vec::with_capacity(area.len() + 1);
            for (one, next) in around(&area) {
                let (here, there) = (inside(one), inside(next));
                if here >= 0.0 {
                    kept.push(one);
                }
                if here * there < 0.0 {
                    kept.push([0, 1].map(|axis| one[axis] + here / (here - there) * (next[axis] - one[axis])));
                }
            }
            area = kept;
        }
        let size: f64 = (2..area.len()).map(|last| turn(area[0], area[last - 1], area[last])).sum();
        (size.abs() > MIN_AREA).then(|| mean(&area))
    }
}

/// The layer of every face; where faces cut each other, the first of them is drawn first.
fn numbers(pairs: &[(usize, usize)], faces: usize) -> Vec<usize> {
    let (mut numbers, mut behind, mut done) = (vec![0; faces], vec![0; faces], vec![false; faces]);
    pairs.iter().for_each(|&(_, before)| behind[before] += 1);
    let mut ready: Vec<usize> = (0..faces).filter(|&face| behind[face] == 0).collect();
    let mut rest = 0..faces;
    // Where none is ready, each face has another one behind it.
    while let Some(face) = ready.pop().or_else(|| rest.find(|&face| !done[face])) {
        done[face] = true;
        let first = pairs.partition_point(|pair| pair.0 < face);
        for &(_, before) in pairs[first..].iter().take_while(|pair| pair.0 == face) {
            behind[before] -= 1;
            if !done[before] {
                numbers[before] = numbers[before].max(numbers[face] + 1);
                ready.extend(Some(before).filter(|_| behind[before] == 0));
            }
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of side 10, each at a place and with depths at its left and right side.
    fn squares(squares: &[([f64; 2], [f64; 2])]) -> Vec<Vec<usize>> {
        let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let place = |at: [f64; 2]| corners.map(|corner| [at[0] + corner[0], at[1] + corner[1]]);
        let places: Vec<Place> = squares.iter().flat_map(|square| place(square.0)).collect();
        let depths: Vec<f64> = squares.iter().flat_map(|(_, [left, right])| [*left, *right, *right, *left]).collect();
        let faces: Vec<Vec<usize>> = (0..squares.len()).map(|face| (4 * face..4 * face + 4).collect()).collect();
        Faces { faces: &faces, places: &places, depths: &depths }.layers()
    }

    #[test]
    fn what_is_nearer_lies_in_a_higher_layer_and_what_is_hidden_in_none() {
        let far = ([0.5, 0.5], [0.0; 2]);
        let (near, aside) = (([5.5, 0.5], [3.0; 2]), ([30.5, 0.5], [9.0; 2]));
        assert_eq!(squares(&[near, aside, far]), [vec![1, 2], vec![0]]);
        assert_eq!(squares(&[far, ([0.5, 0.5], [2.0; 2])]), [vec![1]]);
        // The mean depth of the larger one would say otherwise.
        assert_eq!(squares(&[([0.5, 0.5], [9.0, 0.0]), ([7.5, 0.5], [4.0; 2])]), [vec![0], vec![1]]);
    }

    #[test]
    fn faces_that_cut_each_other_are_all_drawn() {
        let drawn = squares(&[([0.5, 0.5], [0.0, 4.0]), ([0.5, 0.5], [4.0, 0.0])]);
        assert_eq!(drawn.iter().map(Vec::len).sum::<usize>(), 2);
    }
}
