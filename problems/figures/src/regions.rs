//! Triangles and quadrilaterals over points: their sides, lines along these, and the borders of areas that are made of
//! parts of the faces.

use super::canvas::Place;
use std::collections::BTreeMap;

/// What a corner of an area is: point a is [a, a], a place between the points a < b is [a, b]; the middle of face k
/// counts as point n + k, n being the number of points. Areas that have a corner in common know it by this.
pub(super) type Key = [usize; 2];

/// A corner of an area and its place.
pub(super) type Corner = (Key, Place);

/// Neighbours on a closed line.
pub(super) fn around<T: Copy>(ring: &[T]) -> impl Iterator<Item = (T, T)> {
    (0..ring.len()).map(|index| (ring[index], ring[(index + 1) % ring.len()]))
}

/// The ends a < b of every side, with the faces that have it.
pub(super) fn sides(faces: &[Vec<usize>]) -> BTreeMap<[usize; 2], Vec<usize>> {
    let mut sides: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for (index, face) in faces.iter().enumerate() {
        for (a, b) in around(face) {
            sides.entry([a.min(b), a.max(b)]).or_default().push(index);
        }
    }
    sides
}

/// The corners of a face.
pub(super) fn ring(face: &[usize], places: &[Place]) -> Vec<Corner> {
    face.iter().map(|&point| ([point, point], places[point])).collect()
}

/// Every face in parts, one for each of its points: between the point, the middles of two sides and the middle of the
/// face.
pub(super) fn parts(faces: &[Vec<usize>], places: &[Place]) -> impl Iterator<Item = (usize, Vec<Corner>)> {
    let middle = |a: usize, b: usize| ([a.min(b), a.max(b)], mean(&[places[a], places[b]]));
    faces.iter().enumerate().flat_map(move |(index, face)| {
        let corners: Vec<Place> = face.iter().map(|&point| places[point]).collect();
        let centre = ([places.len() + index; 2], mean(&corners));
        (0..face.len()).map(move |k| {
            let [before, point, after] = [face.len() - 1, 0, 1].map(|step| face[(k + step) % face.len()]);
            (point, vec![([point; 2], places[point]), middle(point, after), centre, middle(before, point)])
        })
    })
}

/// Twice the area of a face, with a sign: positive if it runs from the first axis to the second.
pub(super) fn area(face: &[usize], places: &[Place]) -> f64 {
    (2..face.len()).map(|last| turn(places[face[0]], places[face[last - 1]], places[face[last]])).sum()
}

/// Twice the area of a triangle, with a sign.
pub(super) fn turn(a: Place, b: Place, c: Place) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The mean of some places.
pub(super) fn mean(places: &[Place]) -> Place {
    [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64)
}

/// The borders of all areas together: closed lines. A side that two areas run along in opposite directions is inside.
pub(super) fn borders(areas: impl Iterator<Item = Vec<Corner>>) -> Vec<Vec<Place>> {
    // Lower and upper end, whether the area runs from the lower to the upper one, and the place where it begins.
    let mut sides: Vec<(Key, Key, bool, Place)> = Vec::new();
    for area in areas {
        sides.extend(around(&area).map(|((a, place), (b, _))| (a.min(b), a.max(b), a < b, place)));
    }
    sides.sort_unstable_by_key(|side| (side.0, side.1, side.2));
    let mut onward: BTreeMap<Key, Vec<(Key, Place)>> = BTreeMap::new();
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let down = same.partition_point(|side| !side.2);
        let inside = down.min(same.len() - down);
        for &(low, high, upward, place) in &same[inside..same.len() - inside] {
            let (from, to) = if upward { (low, high) } else { (high, low) };
            onward.entry(from).or_default().push((to, place));
        }
    }
    let mut borders = Vec::new();
    while let Some((&start, _)) = onward.first_key_value() {
        let mut border = Vec::new();
        let mut at = start;
        while let Some(ways) = onward.get_mut(&at) {
            let way = ways.pop();
            if ways.is_empty() {
                onward.remove(&at);
            }
            let Some((to, place)) = way else { break };
            border.push(place);
            at = to;
        }
        border.push(border[0]);
        border = straightened(&border);
        border.pop();
        borders.push(border);
    }
    borders
}

/// Sides of faces joined to long lines: at each point a line goes on along the side that bends it least, by less than
/// 60°.
pub(super) fn lines(sides: &[[usize; 2]], places: &[Place]) -> Vec<Vec<Place>> {
    let mut free: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (a, b) in sides.iter().flat_map(|&[a, b]| [(a, b), (b, a)]) {
        free.entry(a).or_default().push(b);
    }
    let step = |a: usize, b: usize| [0, 1].map(|axis| places[b][axis] - places[a][axis]);
    let onward = |line: &[usize], free: &BTreeMap<usize, Vec<usize>>| {
        let [.., from, here] = *line else { return None };
        let cosine = |to: usize| {
            let ([x, y], [dx, dy]) = (step(from, here), step(here, to));
            (x * dx + y * dy) / (x.hypot(y) * dx.hypot(dy))
        };
        let ways = free[&here].iter().map(|&to| (cosine(to), to)).filter(|way| way.0 >= 0.5);
        ways.max_by(|a, b| a.0.total_cmp(&b.0)).map(|way| way.1)
    };
    let mut lines = Vec::new();
    for &[a, b] in sides.iter() {
        let mut line = vec![a];
        let mut next = Some(b).filter(|b| free[&a].contains(b));
        for _ in 0..2 {
            while let (Some(to), Some(&here)) = (next, line.last()) {
                for (end, other) in [(here, to), (to, here)] {
                    free.entry(end).or_default().retain(|point| *point != other);
                }
                line.push(to);
                next = onward(&line, &free);
            }
            line.reverse();
            next = onward(&line, &free);
        }
        if line.len() > 1 {
            let line: Vec<Place> = line.into_iter().map(|point| places[point]).collect();
            lines.push(straightened(&line));
        }
    }
    lines
}

/// A line without the points that lie on straight lines between others.
fn straightened(line: &[Place]) -> Vec<Place> {
    /// Distance from a line that is not seen, points.
    const UNSEEN: f64 = 0.02;
    let mut kept: Vec<Place> = line.first().copied().into_iter().collect();
    let mut pieces = vec![line];
    while let Some(piece) = pieces.pop() {
        let [a, inner @ .., b] = piece else { continue };
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = (along[0] * along[0] + along[1] * along[1]).max(f64::MIN_POSITIVE);
        let distance = |place: &Place| {
            let [x, y] = [place[0] - a[0], place[1] - a[1]];
            let share = ((x * along[0] + y * along[1]) / square).clamp(0.0, 1.0);
            (x - share * along[0]).hypot(y - share * along[1])
        };
        let furthest = inner.iter().map(distance).enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
        match furthest.filter(|furthest| furthest.1 > UNSEEN) {
            Some((index, _)) => pieces.extend([&piece[index + 1..], &piece[..=index + 1]]),
            None => kept.push(*b),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid_faces;

    fn places(counts: [usize; 2]) -> Vec<Place> {
        (0..counts[0] * counts[1]).map(|node| [(node / counts[1]) as f64, (node % counts[1]) as f64]).collect()
    }

    #[test]
    fn areas_with_common_sides_have_one_border_and_holes_one_each() {
        let (places, mut faces) = (places([4, 4]), grid_faces([4, 4]));
        let border = |faces: &[Vec<usize>]| borders(faces.iter().map(|face| ring(face, &places)));
        assert_eq!(border(&faces), [[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]]]);
        faces.remove(4);
        assert_eq!(border(&faces).len(), 2);
        // The parts of all points fill the faces.
        assert_eq!(borders(parts(&faces, &places).map(|(_, part)| part)).len(), 2);
    }

    #[test]
    fn sides_of_a_grid_become_its_lines() {
        let sides: Vec<[usize; 2]> = sides(&grid_faces([5, 3])).into_keys().collect();
        let lines = lines(&sides, &places([5, 3]));
        assert!(lines.len() == 8 && lines.iter().all(|line| line.len() == 2), "{lines:?}");
    }

    #[test]
    fn straight_lines_keep_their_ends_only_and_bent_ones_their_points() {
        let run = |bend: f64| {
            let ends = [[4.0, -9.0], [0.0, -9.0]];
            straightened(&(0..=4).map(|j| [f64::from(j), bend * f64::from(j * j)]).chain(ends).collect::<Vec<Place>>())
        };
        assert_eq!(run(0.0), [[0.0, 0.0], [4.0, 0.0], [4.0, -9.0], [0.0, -9.0]]);
        assert_eq!(run(0.5).len(), 7);
        assert_eq!(straightened(&[[0.0; 2]; 3]).len(), 2);
    }
}
