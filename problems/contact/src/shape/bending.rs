//! How much the net of controls of a lattice bends.
//!
//! ```text
//! αᵀBα = ∫ Σ_a (∂_aa F)² + 2 Σ_{a<b} (∂_ab F)²     divided differences between Greville abscissae, along lines of the coordinates
//! ```
//! A coordinate across a body of which one face moves counts for nothing: the net is that of the face. Over d
//! coordinates the integral is divided by ℓ^{d−2}, ℓ their mean length, so that it has no unit. The net of a plane lies
//! in that plane, and nothing bends; the net exists for every degree, where second derivatives do not.

use crate::error::SceneError;
use crate::scene::{Block, BodyScene, Scene};
use crate::shape::LatticeShape;
use nonsmooth::{Matrix, Vector};

/// A coordinate of the net: the operators that act along it.
struct Line {
    shares: Matrix,
    slopes: Matrix,
    curvatures: Matrix,
    length: f64,
}

/// Rows R with B = RᵀR: the bending is |Rα|² in the controls; `block`: the block at the start, for lattices in its
/// coordinates.
///
/// # Errors
/// [`SceneError::OutOfRange`] when there are too few control points for the degree.
pub(crate) fn lattice_bending_rows(shape: &LatticeShape, block: Option<&Block>) -> Result<Matrix, SceneError> {
    let (bases, lengths) = (shape.bases()?, shape.coordinates.lengths(block));
    let line = |axis: usize| {
        let places: Vec<f64> = bases[axis].greville().into_iter().map(|place| lengths[axis] * place).collect();
        let [shares, slopes, curvatures] = bending_line(&places, lengths[axis]);
        Line { shares, slopes, curvatures, length: lengths[axis] }
    };
    let lines: [Option<Line>; 3] = std::array::from_fn(|axis| (!shape.is_across(axis)).then(|| line(axis)));
    let along = |axis: usize, order: usize| match (&lines[axis], order) {
        (Some(line), 0) => line.shares.clone(),
        (Some(line), 1) => line.slopes.clone(),
        (Some(line), _) => line.curvatures.clone(),
        // The layer that moves.
        (None, _) if shape.frozen[axis][0] == 0 => Matrix::from_row_slice(1, 2, &[1.0, 0.0]),
        (None, _) => Matrix::from_row_slice(1, 2, &[0.0, 1.0]),
    };
    let whole =
        |orders: [usize; 3]| along(0, orders[0]).kronecker(&along(1, orders[1])).kronecker(&along(2, orders[2]));
    let own: Vec<&Line> = lines.iter().flatten().collect();
    let mean = own.iter().map(|line| line.length).product::<f64>().powf((own.len() as f64).recip());
    let scale = mean.powi(2 - own.len() as i32).sqrt();
    let axes: Vec<usize> = (0..3).filter(|&axis| lines[axis].is_some()).collect();
    let mut parts = Vec::new();
    for (place, &a) in axes.iter().enumerate() {
        for &b in &axes[place..] {
            let mut orders = [0; 3];
            orders[a] += 1;
            orders[b] += 1;
            let rows = whole(orders) * if a == b { scale } else { scale * std::f64::consts::SQRT_2 };
            parts.extend(on_controls(shape, &rows));
        }
    }
    Ok(stacked(&parts, shape.control_count()))
}

/// Rows over the control points as rows over the controls, for every direction.
fn on_controls(shape: &LatticeShape, rows: &Matrix) -> Vec<Matrix> {
    let controls = shape.controls();
    let of = |way: usize| {
        let mut own = Matrix::zeros(rows.nrows(), controls.len());
        for (mut column, control) in own.column_iter_mut().zip(&controls) {
            for &(point, _, factor) in control.iter().filter(|(_, own, _)| *own == way) {
                column.axpy(factor, &rows.column(point), 1.0);
            }
        }
        own
    };
    shape.ways().into_iter().map(of).collect()
}

/// Rows R of the controls of all bodies: their bending is |Rα|².
///
/// # Errors
/// [`SceneError::OutOfRange`] when there are too few control points for a degree.
pub fn bending_rows(scene: &Scene) -> Result<Matrix, SceneError> {
    let rows =
        |body: &BodyScene| body.shape.as_ref().map(|shape| lattice_bending_rows(shape, body.start_block().as_ref()));
    let parts = scene.bodies.iter().filter_map(rows).collect::<Result<Vec<_>, SceneError>>()?;
    let mut whole = Matrix::zeros(parts.iter().map(Matrix::nrows).sum(), scene.control_count());
    let (mut row, mut column) = (0, 0);
    for part in &parts {
        whole.view_mut((row, column), part.shape()).copy_from(part);
        (row, column) = (row + part.nrows(), column + part.ncols());
    }
    Ok(whole)
}

/// Some rows below each other.
fn stacked(parts: &[Matrix], columns: usize) -> Matrix {
    let mut rows = Matrix::zeros(parts.iter().map(Matrix::nrows).sum(), columns);
    let mut first = 0;
    for part in parts {
        rows.rows_mut(first, part.nrows()).copy_from(part);
        first += part.nrows();
    }
    rows
}

/// Values, first and second divided differences between some places of a length, each times the root of the length that
/// belongs to it.
pub(crate) fn bending_line(places: &[f64], length: f64) -> [Matrix; 3] {
    [shares(places, length), slopes(places), curvatures(places)]
}

/// Roots of the lengths that belong to the places, on the diagonal; of a single one, the whole length.
fn shares(places: &[f64], length: f64) -> Matrix {
    let gap = |i: usize| places.get(i + 1).map_or(0.0, |next| next - places[i]);
    let own = |i: usize| if places.len() == 1 { length } else { 0.5 * (gap(i) + i.checked_sub(1).map_or(0.0, gap)) };
    let lengths = (0..places.len()).map(|i| own(i).sqrt());
    Matrix::from_diagonal(&Vector::from_iterator(places.len(), lengths))
}

/// Slopes between neighbours, times the roots of their distances.
fn slopes(places: &[f64]) -> Matrix {
    let mut rows = Matrix::zeros(places.len() - 1, places.len());
    for (i, pair) in places.windows(2).enumerate() {
        let weight = (pair[1] - pair[0]).sqrt().recip();
        (rows[(i, i)], rows[(i, i + 1)]) = (-weight, weight);
    }
    rows
}

/// Second divided differences, times the roots of the lengths that belong to the places in the middle.
fn curvatures(places: &[f64]) -> Matrix {
    let mut rows = Matrix::zeros(places.len().saturating_sub(2), places.len());
    for (i, three) in places.windows(3).enumerate() {
        let (before, after) = (three[1] - three[0], three[2] - three[1]);
        let weight = 2.0 / (before + after) * (0.5 * (before + after)).sqrt();
        rows[(i, i)] = weight / before;
        rows[(i, i + 1)] = -weight * (1.0 / before + 1.0 / after);
        rows[(i, i + 2)] = weight / after;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Coordinates, Directions, ShapedFace};

    /// |Rα|² of a function at the Greville abscissae of a lattice of degree 2.
    fn energy(lattice: &LatticeShape, block: Option<&Block>, value: impl Fn([f64; 3]) -> f64) -> f64 {
        let lengths = lattice.coordinates.lengths(block);
        let places = lattice.bases().expect("valid").map(|basis| basis.greville());
        let counts = lattice.control_points;
        let point = |control: &crate::shape::lattice::Control| {
            let point = control[0].0;
            let index = [point / (counts[1] * counts[2]), point / counts[2] % counts[1], point % counts[2]];
            value(std::array::from_fn(|axis| lengths[axis] * places[axis][index[axis]]))
        };
        let controls = Vector::from_vec(lattice.controls().iter().map(point).collect());
        let rows = lattice_bending_rows(lattice, block).expect("valid");
        let (squares, form) = ((&rows * &controls).norm_squared(), controls.dot(&(rows.tr_mul(&rows) * &controls)));
        // The quadratic form loses the digits of 1/h⁴, the squares of differences do not.
        assert!((form - squares).abs() < 1e-8 * (1.0 + squares), "{form} {squares}");
        squares
    }

    #[test]
    fn planes_do_not_bend_and_a_bowl_bends_as_its_integral_says() {
        let block = Block::new([3.0, 5.0], 7.0, [1; 3], [1; 3]);
        let bowl = |[x, y, _]: [f64; 3]| x * x + 0.5 * x * y + 0.3 * y * y;
        // (2² + 2·0.5² + 0.6²)·15 mm², but for the half intervals at the edges.
        let exact = (4.0 + 0.5 + 0.36) * 15.0;
        for face in [ShapedFace::Top, ShapedFace::Bottom] {
            let surface = LatticeShape::heights(face, [20, 20], [2, 2], 7.0);
            assert!(energy(&surface, Some(&block), |[x, y, _]| 2.0 + 0.3 * x - 0.7 * y) < 1e-18);
            let found = energy(&surface, Some(&block), bowl);
            assert!((found / exact - 1.0).abs() < 0.1, "{found} {exact}");
        }
        // In space, over the thickness of 7 mm, divided by the mean length.
        let edges = [[3.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 7.0]];
        let box_of = |control_points: [usize; 3]| LatticeShape {
            degrees: control_points.map(|count| 2.min(count - 1)),
            directions: Directions::Axes([false, true, false]),
            ..LatticeShape::new(Coordinates::Cartesian { corner: [0.0; 3], edges }, control_points, [-1.0, 1.0])
        };
        for points in [[20, 20, 1], [12, 12, 3]] {
            let found = energy(&box_of(points), None, bowl);
            let expected = exact * 7.0 / 105.0_f64.cbrt();
            assert!((found / expected - 1.0).abs() < 2.0 / points[0] as f64, "{points:?}: {found} {expected}");
        }
    }
}
