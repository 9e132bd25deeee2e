//! Coarse nets of controls: splines with fewer knots, or of a lower degree where one polynomial is left.
//!
//! ```text
//! N^coarse_j = Σ_i P_ij N_i,     F_β = F_{Pβ}     exactly: knot insertion and degree elevation
//! ```
//! P is found by interpolation at the Greville abscissae of the fine basis, where that is always possible. Control
//! points that do not move, and mirrored ones, take the nearest values that the controls can give.

use crate::error::SceneError;
use crate::scene::Scene;
use crate::shape::LatticeShape;
use crate::shape::bspline::Basis;
use nonsmooth::{Matrix, Vector};

/// Part of a direction that must not lie in those before it for the direction to count.
const INDEPENDENT: f64 = 1e-8;

/// Coarse nets of controls of all bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseNet {
    /// From the controls of the nets to changes of those of the scene, with independent columns.
    pub directions: Matrix,
    /// Numbers of columns that belong to the bodies with controls, in their order.
    pub counts: Vec<usize>,
}

/// Nets of about so many control points along every coordinate of every lattice, at most those that it has.
///
/// # Errors
/// [`SceneError::OutOfRange`] for fewer than two control points, and where a system of equations is singular.
pub fn coarse_net(scene: &Scene, count: usize) -> Result<CoarseNet, SceneError> {
    let parts = scene.shapes().map(|shape| coarse_directions(shape, count)).collect::<Result<Vec<_>, SceneError>>()?;
    let counts: Vec<usize> = parts.iter().map(Matrix::ncols).collect();
    let mut directions = Matrix::zeros(scene.control_count(), counts.iter().sum());
    let (mut row, mut column) = (0, 0);
    for part in &parts {
        directions.view_mut((row, column), part.shape()).copy_from(part);
        (row, column) = (row + part.nrows(), column + part.ncols());
    }
    Ok(CoarseNet { directions, counts })
}

/// Changes of the controls for those of a coarse net, with independent columns.
fn coarse_directions(shape: &LatticeShape, count: usize) -> Result<Matrix, SceneError> {
    let mut points = Matrix::identity(1, 1);
    for fine in shape.bases()? {
        points = points.kronecker(&refinement(&fine, &coarser(&fine, count)?)?);
    }
    let controls = shape.controls();
    let mut columns: Vec<Vector> = Vec::new();
    let mut orthonormal: Vec<Vector> = Vec::new();
    for point in 0..points.ncols() {
        for way in shape.ways() {
            // The nearest values of the control points that each control can give.
            let value = |control: &crate::shape::lattice::Control| {
                let own = || control.iter().filter(|(_, own, _)| *own == way);
                let square: f64 = own().map(|(.., factor)| factor * factor).sum();
                let sum: f64 = own().map(|&(fine, _, factor)| factor * points[(fine, point)]).sum();
                if square > 0.0 { sum / square } else { 0.0 }
            };
            let column = Vector::from_iterator(controls.len(), controls.iter().map(value));
            let mut rest = column.clone();
            // Twice, against rounding.
            for known in orthonormal.iter().chain(&orthonormal) {
                rest -= known * known.dot(&rest);
            }
            if rest.norm() > INDEPENDENT * points.column(point).norm() {
                orthonormal.push(rest.normalize());
                columns.push(column);
            }
        }
    }
    Ok(Matrix::from_columns(&columns))
}

/// A basis of about so many functions within the span of a fine one.
fn coarser(fine: &Basis, count: usize) -> Result<Basis, SceneError> {
    if count >= fine.count() {
        return Ok(fine.clone());
    }
    if count <= fine.degree() + 1 {
        return Basis::clamped_uniform(count.saturating_sub(1), count);
    }
    let (spans, wanted) = (fine.count() - fine.degree(), count - fine.degree());
    let kept = |index: usize| fine.knots()[fine.degree() + (index * spans + wanted / 2) / wanted];
    Ok(Basis::clamped_at(fine.degree(), (1..wanted).map(kept)))
}

/// P along one axis.
fn refinement(fine: &Basis, coarse: &Basis) -> Result<Matrix, SceneError> {
    let places = fine.greville();
    let values = |basis: &Basis| {
        let rows: Vec<f64> = places.iter().flat_map(|&place| basis.values(place)).collect();
        Matrix::from_row_slice(places.len(), basis.count(), &rows)
    };
    let solved = values(fine).lu().solve(&values(coarse));
    solved.ok_or_else(|| SceneError::out_of_range("lattice.control_points", fine.count(), "a basis that interpolates"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Coordinates, ShapedFace};

    /// The heights of a coarse surface are those of the fine one, at places that are no knots.
    #[test]
    fn refinement_is_exact() {
        for (degrees, counts) in [([3, 3], [6, 9]), ([2, 2], [7, 5]), ([1, 1], [6, 5]), ([6, 4], [7, 5])] {
            let fine = LatticeShape::heights(ShapedFace::Top, counts, degrees, 1.0);
            for count in 2..9 {
                let bases: [Basis; 2] =
                    std::array::from_fn(|axis| coarser(&fine.bases().expect("valid")[axis], count).expect("valid"));
                assert!((0..2).all(|axis| bases[axis].count() == count.min(counts[axis])));
                let coarse = crate::shape::SplineSurface::new(bases);
                let directions = coarse_directions(&fine, count).expect("regular");
                let controls: Vec<f64> = (0..directions.ncols()).map(|k| (1.0 + 7.0 * k as f64).sin()).collect();
                let refined = directions * Vector::from_vec(controls.clone());
                let surface = fine.surface().expect("valid");
                for place in (0..=1600).map(|k| [f64::from(k / 40) / 40.0, f64::from(k % 40) / 40.0]) {
                    let off = coarse.height(&controls, place) - surface.height(refined.as_slice(), place);
                    assert!(off.abs() < 1e-14, "{degrees:?} {counts:?} from {count}: {off:e}");
                }
            }
        }
    }

    /// Mirrored controls and still layers leave as many directions as coarse nets have controls of their own.
    #[test]
    fn directions_are_independent() {
        let coordinates =
            Coordinates::Cartesian { corner: [0.0; 3], edges: [[3.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 7.0]] };
        let mut lattice = LatticeShape::new(coordinates, [6, 5, 4], [-1.0, 1.0]);
        assert_eq!(coarse_directions(&lattice, 3).expect("regular").shape(), (360, 81));
        lattice.frozen[2] = [1, 0];
        let still = coarse_directions(&lattice, 3).expect("regular");
        assert_eq!(still.nrows(), 270);
        assert!((54..=81).contains(&still.ncols()), "{}", still.ncols());
        lattice.symmetric[0] = true;
        let symmetric = coarse_directions(&lattice, 3).expect("regular");
        assert_eq!(symmetric.nrows(), lattice.control_count());
        let lower = |matrix: &Matrix| matrix.clone().svd(false, false).singular_values.min();
        assert!(symmetric.ncols() < still.ncols() && lower(&symmetric) > 1e-8 && lower(&still) > 1e-8);
    }
}
