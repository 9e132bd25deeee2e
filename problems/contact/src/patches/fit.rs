//! The primitive that the nodes of a face lie on.
//!
//! ```text
//! Gauss-Newton on Σ (distance of node)²,  from the directions of facet normals:
//! axis of a cylinder or cone: along which the normals vary least
//! ```

use crate::mortar::Primitive;
use crate::mortar::vector::{across, dot, length, plus};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Largest distance of a node from its primitive, as a part of the size of the face.
const NEAR: f64 = 1e-6;

/// Steps of Gauss-Newton.
const STEPS: usize = 20;

/// Nodes above the number of parameters that make a fit mean something.
const SPARE: usize = 2;

/// The first primitive, of plane, cylinder, cone and sphere, that all points lie on; `normals`: of the facets.
pub(crate) fn primitive(points: &[[f64; 3]], normals: &[[f64; 3]]) -> Option<Primitive> {
    let centre = mean(points);
    let size = points.iter().map(|&x| length(plus(x, -1.0, centre))).fold(0.0, f64::max);
    let fits = |primitive: &Primitive| points.iter().all(|&x| primitive.distance(x).abs() <= NEAR * size);
    let plane = plane(points);
    if fits(&plane) {
        return Some(plane);
    }
    let axis = least_spread(normals, |_| 1.0);
    let (point, radius) = circle(points, axis, centre)?;
    let cylinder = Primitive::Cylinder { point, axis, radius };
    let cone = Primitive::Cone { point, axis, radius, slope: slope(points, point, axis) };
    let sphere = sphere(points, centre)?;
    let candidates = [(cylinder, 5), (cone, 6), (sphere, 4)];
    let enough = candidates.into_iter().filter(|(_, parameters)| points.len() >= parameters + SPARE);
    enough.filter_map(|(start, _)| improved(start, points, size)).find(fits)
}

pub(crate) fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    points.iter().fold([0.0; 3], |sum, &x| plus(sum, 1.0 / points.len() as f64, x))
}

/// The plane of least squares.
pub(super) fn plane(points: &[[f64; 3]]) -> Primitive {
    Primitive::Plane { point: mean(points), normal: least_spread(points, |_| 1.0) }
}

/// The direction along which some vectors, with their weights, vary least.
pub(crate) fn least_spread(vectors: &[[f64; 3]], weight: impl Fn(usize) -> f64) -> [f64; 3] {
    let total: f64 = (0..vectors.len()).map(&weight).sum();
    let add = |sum, (index, vector): (usize, &[f64; 3])| plus(sum, weight(index) / total, *vector);
    let middle = vectors.iter().enumerate().fold([0.0; 3], add);
    let mut sum = Matrix3::zeros();
    for (index, vector) in vectors.iter().enumerate() {
        let from = Vector3::from(plus(*vector, -1.0, middle));
        sum += weight(index) * from * from.transpose();
    }
    let eigen = sum.symmetric_eigen();
    let vector = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    [vector[0], vector[1], vector[2]]
}

/// The circle of least squares through the points seen along an axis: its centre and radius.
pub(crate) fn circle(points: &[[f64; 3]], axis: [f64; 3], centre: [f64; 3]) -> Option<([f64; 3], f64)> {
    let [a, b] = across(axis);
    let from = |x: [f64; 3]| {
        let from = plus(x, -1.0, centre);
        [dot(a, from), dot(b, from)]
    };
    let matrix = DMatrix::from_fn(points.len(), 3, |row, k| if k < 2 { 2.0 * from(points[row])[k] } else { 1.0 });
    let right = DVector::from_fn(points.len(), |row, _| from(points[row]).iter().map(|x| x * x).sum());
    let [x, y, rest] = solved(matrix, &right)?[..] else { return None };
    let square = rest + x * x + y * y;
    (square > 0.0).then(|| (plus(plus(centre, x, a), y, b), square.sqrt()))
}

/// The sphere of least squares.
pub(crate) fn sphere(points: &[[f64; 3]], centre: [f64; 3]) -> Option<Primitive> {
    let from = |row: usize| plus(points[row], -1.0, centre);
    let matrix = DMatrix::from_fn(points.len(), 4, |row, k| if k < 3 { 2.0 * from(row)[k] } else { 1.0 });
    let right = DVector::from_fn(points.len(), |row, _| dot(from(row), from(row)));
    let [x, y, z, rest] = solved(matrix, &right)?[..] else { return None };
    let square = rest + x * x + y * y + z * z;
    (square > 0.0).then(|| Primitive::Sphere { point: plus(centre, 1.0, [x, y, z]), radius: square.sqrt() })
}

/// How the distance from an axis grows along it.
fn slope(points: &[[f64; 3]], point: [f64; 3], axis: [f64; 3]) -> f64 {
    let place = |x: &[f64; 3]| {
        let from = plus(*x, -1.0, point);
        let along = dot(axis, from);
        [along, length(plus(from, -along, axis))]
    };
    let count = points.len() as f64;
    let [mut along, mut across] = [0.0; 2];
    points.iter().map(place).for_each(|[z, r]| (along, across) = (along + z / count, across + r / count));
    let sums = points
        .iter()
        .map(place)
        .fold([0.0; 2], |[square, mixed], [z, r]| [square + (z - along).powi(2), mixed + (z - along) * (r - across)]);
    if sums[0] > 0.0 { sums[1] / sums[0] } else { 0.0 }
}

/// The least-squares solution with scaled columns.
fn solved(mut matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<Vec<f64>> {
    let scales: Vec<f64> = matrix.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, scale) in matrix.column_iter_mut().zip(&scales) {
        column /= *scale;
    }
    let solution = matrix.svd(true, true).solve(right, 1e-13).ok()?;
    let values: Vec<f64> = solution.iter().zip(&scales).map(|(x, scale)| x / scale).collect();
    values.iter().all(|x| x.is_finite()).then_some(values)
}

/// A primitive after steps of Gauss-Newton.
fn improved(mut primitive: Primitive, points: &[[f64; 3]], size: f64) -> Option<Primitive> {
    let distances = |primitive: &Primitive| DVector::from_fn(points.len(), |row, _| primitive.distance(points[row]));
    for _ in 0..STEPS {
        let here = distances(&primitive);
        // Central differences of an analytic function: the step decides nothing but the speed of convergence.
        let step = 1e-5;
        let count = moved(&primitive, &[0.0; 6], size).1;
        let columns: Vec<DVector<f64>> = (0..count)
            .map(|k| {
                let at = |sign: f64| {
                    let change: [f64; 6] = std::array::from_fn(|l| if l == k { sign * step } else { 0.0 });
                    distances(&moved(&primitive, &change, size).0)
                };
                (at(1.0) - at(-1.0)) / (2.0 * step)
            })
            .collect();
        let change = solved(DMatrix::from_columns(&columns), &-here)?;
        let mut all = [0.0; 6];
        all.iter_mut().zip(&change).for_each(|(entry, own)| *entry = own.clamp(-0.5, 0.5));
        primitive = moved(&primitive, &all, size).0;
        if all.iter().all(|x| x.abs() < 1e-14) {
            break;
        }
    }
    Some(primitive)
}

/// A primitive with changed parameters, lengths in units of the size of the face, and the number of its parameters.
fn moved(primitive: &Primitive, change: &[f64; 6], size: f64) -> (Primitive, usize) {
    let about = |point: [f64; 3], axis: [f64; 3]| {
        let [a, b] = across(axis);
        let point = plus(plus(point, size * change[0], a), size * change[1], b);
        let turned = plus(plus(axis, change[2], a), change[3], b);
        let long = length(turned);
        (point, turned.map(|x| x / long))
    };
    match *primitive {
        Primitive::Plane { .. } => (*primitive, 0),
        Primitive::Cylinder { point, axis, radius } => {
            let (point, axis) = about(point, axis);
            (Primitive::Cylinder { point, axis, radius: radius + size * change[4] }, 5)
        }
        Primitive::Cone { point, axis, radius, slope } => {
            let (point, axis) = about(point, axis);
            (Primitive::Cone { point, axis, radius: radius + size * change[4], slope: slope + change[5] }, 6)
        }
        Primitive::Sphere { point, radius } => {
            let point = plus(point, size, [change[0], change[1], change[2]]);
            (Primitive::Sphere { point, radius: radius + size * change[3] }, 4)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mortar::vector::cross;

    /// A surface over two parameters.
    type Place<'a> = &'a dyn Fn(f64, f64) -> [f64; 3];

    /// Points about a turned axis, and normals of the facets between them.
    fn grid(place: impl Fn(f64, f64) -> [f64; 3]) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let at = |i: usize, j: usize| place(0.3 * i as f64, 0.5 * j as f64);
        let points = (0..5).flat_map(|i| (0..4).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
        let normal = |(i, j): (usize, usize)| {
            let (first, second) = (plus(at(i + 1, j + 1), -1.0, at(i, j)), plus(at(i, j + 1), -1.0, at(i + 1, j)));
            let normal = cross(first, second);
            normal.map(|x| x / length(normal))
        };
        (points, (0..4).flat_map(|i| (0..3).map(move |j| (i, j))).map(normal).collect())
    }

    fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
        [100.0 + 0.6 * x - 0.8 * z, y - 7.0, 0.8 * x + 0.6 * z]
    }

    #[test]
    fn primitives_are_found_in_their_order() {
        let cases: [(&str, Place<'_>); 4] = [
            ("Plane", &|s, t| turned([s, t, 0.0])),
            ("Cylinder", &|s, t| turned([5.0 * s.cos(), 5.0 * s.sin(), t])),
            ("Cone", &|s, t| turned([(5.0 + 0.2 * t) * s.cos(), (5.0 + 0.2 * t) * s.sin(), t])),
            ("Sphere", &|s, t| turned([9.0 * s.cos() * t.cos(), 9.0 * s.sin() * t.cos(), 9.0 * t.sin()])),
        ];
        for (name, place) in cases {
            let (points, normals) = grid(place);
            let found = primitive(&points, &normals).expect(name);
            assert!(format!("{found:?}").starts_with(name), "{found:?}");
            let worst = points.iter().map(|&x| found.distance(x).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-11, "{name}: {worst:e}");
        }
        let (points, normals) = grid(|s, t| turned([s, t, 0.1 * s.powi(3) + 0.2 * s * t]));
        assert_eq!(primitive(&points, &normals), None);
    }
}
