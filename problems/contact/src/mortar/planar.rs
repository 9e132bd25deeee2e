//! Facets in the auxiliary plane, their convex pieces and shape functions.
//!
//! ```text
//! bilinear:  x = c + a ξ + b η + d ξη,  p = x − c:
//!   (a × d) ξ² + (a × b − p × d) ξ − p × b = 0,   η = (p − a ξ)·(b + d ξ) / |b + d ξ|²
//! with derivatives:  N_k(x) = N_k + ∇N_k·(x − Σ N_l x_l),  N and ∇N at the value of x
//! ```

use super::polygon::{Polygon, cross, minus, scaled};
use crate::scalar::Scalar;

/// Corner angles and areas below this part of the square of the size count as none.
const FLAT: f64 = 1e-10;

/// ξ, η of the corners of a quadrilateral, counterclockwise.
pub const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// A projected facet, counterclockwise.
#[derive(Debug, Clone, Copy)]
pub struct Planar<T> {
    pub corners: [[T; 2]; 4],
    /// Three or four.
    pub count: usize,
}

/// A convex piece of a facet: all of it, or half of a quadrilateral that is not convex.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    corners: [usize; 4],
    count: usize,
}

/// A piece with what evaluates its shape functions.
#[derive(Debug, Clone, Copy)]
pub struct Element<'a, T> {
    pub facet: &'a Planar<T>,
    pub plain: &'a Planar<f64>,
    pub piece: Piece,
}

/// Shape functions of the four corners and their gradients; those of missing corners are zero.
struct Local {
    values: [f64; 4],
    gradients: [[f64; 2]; 4],
}

impl<T: Scalar> Planar<T> {
    /// The values without derivatives.
    pub fn plain(&self) -> Planar<f64> {
        Planar { corners: self.corners.map(|corner| corner.map(T::value)), count: self.count }
    }
}

impl Planar<f64> {
    /// Convex pieces of a facet that does not fold over; otherwise none.
    pub fn pieces(&self) -> impl Iterator<Item = Piece> + use<> {
        let [first, second] = match self.count {
            4 => self.quadrilaterals(),
            _ => [self.triangle([0, 1, 2]), None],
        };
        first.into_iter().chain(second)
    }

    /// (x_{k+1} − x_k) × (x_{k−1} − x_k).
    fn turn(&self, [before, here, after]: [usize; 3]) -> f64 {
        let x = |k: usize| self.corners[k];
        cross(minus(x(after), x(here)), minus(x(before), x(here)))
    }

    fn flat(&self) -> f64 {
        let squared = |k: usize, l: usize| minus(self.corners[k], self.corners[l]).iter().map(|d| d * d).sum::<f64>();
        FLAT * (0..self.count).flat_map(|k| (0..k).map(move |l| (k, l))).map(|(k, l)| squared(k, l)).fold(0.0, f64::max)
    }

    fn triangle(&self, [a, b, c]: [usize; 3]) -> Option<Piece> {
        (self.turn([a, b, c]) > self.flat()).then_some(Piece { corners: [a, b, c, c], count: 3 })
    }

    fn quadrilaterals(&self) -> [Option<Piece>; 2] {
        let turns: [f64; 4] = std::array::from_fn(|k| self.turn([(k + 3) % 4, k, (k + 1) % 4]));
        let flat = self.flat();
        if turns.iter().all(|&turn| turn > flat) {
            return [Some(Piece { corners: [0, 1, 2, 3], count: 4 }), None];
        }
        let halves = if turns[1].min(turns[3]) >= turns[0].min(turns[2]) {
            [[0, 1, 2], [2, 3, 0]]
        } else {
            [[1, 2, 3], [3, 0, 1]]
        };
        let folded = halves.iter().any(|&half| self.turn(half) < -flat);
        if folded { [None, None] } else { halves.map(|half| self.triangle(half)) }
    }

    /// ∫ N_k over the whole facet.
    pub fn tributary(&self) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for piece in self.pieces() {
            let element = Element { facet: self, plain: self, piece };
            if piece.count == 3 {
                let [a, b, c, _] = piece.corners;
                let third = self.turn([a, b, c]) / 6.0;
                [a, b, c].into_iter().for_each(|k| sums[k] += third);
            } else {
                let abscissa = 1.0 / 3.0_f64.sqrt();
                for local in CORNERS.map(|corner| corner.map(|s| s * abscissa)) {
                    let density = element.bilinear().determinant(local);
                    (0..4).for_each(|k| sums[k] += density * bilinear_values(local)[k]);
                }
            }
        }
        sums
    }
}

impl Piece {
    pub fn polygon<T: Scalar>(&self, facet: &Planar<T>) -> Polygon<T> {
        Polygon::new(self.corners[..self.count].iter().map(|&k| facet.corners[k]))
    }
}

impl<T: Scalar> Element<'_, T> {
    /// Shape functions of the facet at a point of the piece.
    pub fn shape(&self, point: [T; 2]) -> [T; 4] {
        let Local { values, gradients } = self.locate(point.map(T::value));
        let mut rest = point;
        for (corner, &value) in self.facet.corners.iter().zip(&values) {
            (0..2).for_each(|axis| rest[axis] += scaled(corner[axis], -value));
        }
        std::array::from_fn(|k| {
            T::constant(values[k]) + scaled(rest[0], gradients[k][0]) + scaled(rest[1], gradients[k][1])
        })
    }

    fn locate(&self, point: [f64; 2]) -> Local {
        if self.piece.count == 3 { self.barycentric(point) } else { self.bilinear().locate(point) }
    }

    fn barycentric(&self, point: [f64; 2]) -> Local {
        let mut local = Local { values: [0.0; 4], gradients: [[0.0; 2]; 4] };
        let [a, b, c, _] = self.piece.corners;
        let doubled = self.plain.turn([a, b, c]);
        for [own, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
            let (start, edge) = (self.plain.corners[from], minus(self.plain.corners[to], self.plain.corners[from]));
            local.values[own] = cross(edge, minus(point, start)) / doubled;
            local.gradients[own] = [-edge[1] / doubled, edge[0] / doubled];
        }
        local
    }

    fn bilinear(&self) -> Bilinear {
        let combined = |signs: [f64; 4]| {
            std::array::from_fn(|axis| (0..4).map(|k| signs[k] * self.plain.corners[k][axis]).sum::<f64>() / 4.0)
        };
        Bilinear {
            centre: combined([1.0; 4]),
            a: combined([-1.0, 1.0, 1.0, -1.0]),
            b: combined([-1.0, -1.0, 1.0, 1.0]),
            d: combined([1.0, -1.0, 1.0, -1.0]),
        }
    }
}

/// The map of a convex quadrilateral.
struct Bilinear {
    centre: [f64; 2],
    a: [f64; 2],
    b: [f64; 2],
    d: [f64; 2],
}

fn bilinear_values([xi, eta]: [f64; 2]) -> [f64; 4] {
    CORNERS.map(|[s, t]| (1.0 + s * xi) * (1.0 + t * eta) / 4.0)
}

impl Bilinear {
    /// ∂x/∂ξ and ∂x/∂η.
    fn tangents(&self, [xi, eta]: [f64; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|k| match k {
            0 => std::array::from_fn(|axis| self.a[axis] + self.d[axis] * eta),
            _ => std::array::from_fn(|axis| self.b[axis] + self.d[axis] * xi),
        })
    }

    fn determinant(&self, local: [f64; 2]) -> f64 {
        let [along, across] = self.tangents(local);
        cross(along, across)
    }

    fn locate(&self, point: [f64; 2]) -> Local {
        let p = minus(point, self.centre);
        let mut local = self.start(p);
        for _ in 0..2 {
            local = self.improved(local, p);
        }
        let [along, across] = self.tangents(local);
        let determinant = cross(along, across).max(f64::MIN_POSITIVE);
        let [xi, eta] = local;
        let gradients = CORNERS.map(|[s, t]| {
            let (by_xi, by_eta) = (s * (1.0 + t * eta) / 4.0, t * (1.0 + s * xi) / 4.0);
            [
                (by_xi * across[1] - by_eta * along[1]) / determinant,
                (by_eta * along[0] - by_xi * across[0]) / determinant,
            ]
        });
        Local { values: bilinear_values(local), gradients }
    }

    /// The root of the quadratic equation that belongs to the inside; both denominators are positive there.
    fn start(&self, p: [f64; 2]) -> [f64; 2] {
        let square = cross(self.a, self.d);
        let linear = cross(self.a, self.b) - cross(p, self.d);
        let constant = cross(p, self.b);
        let root = (linear * linear + 4.0 * square * constant).max(0.0).sqrt();
        let xi = (2.0 * constant / (linear + root).max(f64::MIN_POSITIVE)).clamp(-2.0, 2.0);
        let [_, across] = self.tangents([xi, 0.0]);
        let rest = [p[0] - self.a[0] * xi, p[1] - self.a[1] * xi];
        let squared = (across[0] * across[0] + across[1] * across[1]).max(f64::MIN_POSITIVE);
        [xi, ((rest[0] * across[0] + rest[1] * across[1]) / squared).clamp(-2.0, 2.0)]
    }

    /// One step of Newton.
    fn improved(&self, [xi, eta]: [f64; 2], p: [f64; 2]) -> [f64; 2] {
        let [along, across] = self.tangents([xi, eta]);
        let determinant = cross(along, across);
        if determinant <= 0.0 {
            return [xi, eta];
        }
        let rest: [f64; 2] = std::array::from_fn(|axis| p[axis] - self.a[axis] * xi - across[axis] * eta);
        let step = [cross(rest, across) / determinant, cross(along, rest) / determinant];
        [(xi + step[0]).clamp(-2.0, 2.0), (eta + step[1]).clamp(-2.0, 2.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    fn quadrilateral(corners: [[f64; 2]; 4]) -> Planar<f64> {
        Planar { corners, count: 4 }
    }

    fn area(facet: &Planar<f64>) -> f64 {
        facet.pieces().map(|piece| piece.polygon(facet).area()).sum()
    }

    #[test]
    fn shape_functions_invert_the_bilinear_map() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let parallelogram = [[0.0, 0.0], [2.0, 0.5], [3.0, 2.0], [1.0, 1.5]];
        let trapezoids =
            [[[0.0, 0.0], [2.0, 0.0], [1.2, 1.0], [0.3, 1.0]], [[0.0, 0.0], [1.0, -1.0], [1.0, 2.0], [0.0, 1.0]]];
        let nearly_flat = [[0.0, 0.0], [1.0, 0.0], [0.5001, 0.5], [0.0, 1.0]];
        for corners in [square, parallelogram, trapezoids[0], trapezoids[1], nearly_flat] {
            let facet = quadrilateral(corners);
            let piece = facet.pieces().next().expect("a convex quadrilateral");
            for local in [[0.0, 0.0], [0.7, -0.9], [-0.999, 0.999], [1.0, 1.0], [0.3, 1.0]] {
                let values = bilinear_values(local);
                let at = |axis: usize| (0..4).map(|k| values[k] * corners[k][axis]).sum::<f64>();
                let shape = Element { facet: &facet, plain: &facet, piece }.shape([at(0), at(1)]);
                assert!((0..4).all(|k| (shape[k] - values[k]).abs() < 1e-11), "{corners:?} {local:?} {shape:?}");
            }
        }
    }

    #[test]
    fn derivatives_of_shape_functions() {
        let at = |step: f64| {
            let moved = |k: usize, c: usize| step * (1.0 + (2 * k + c) as f64).sin();
            let corners = [[0.0, 0.0], [2.0, 0.1], [1.4, 1.2], [-0.2, 1.0]];
            let corners: [[f64; 2]; 4] = std::array::from_fn(|k| std::array::from_fn(|c| corners[k][c] + moved(k, c)));
            (quadrilateral(corners), [0.6 + 0.3 * step, 0.5 - 0.7 * step])
        };
        let values = |step: f64| {
            let (facet, point) = at(step);
            let piece = facet.pieces().next().expect("a convex quadrilateral");
            Element { facet: &facet, plain: &facet, piece }.shape(point)
        };
        let ((plain, point), (next, moved)) = (at(0.0), at(1.0));
        let dual = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|c| Dual::new(a[c], b[c] - a[c]));
        let corners = std::array::from_fn(|k| dual(plain.corners[k], next.corners[k]));
        let piece = plain.pieces().next().expect("a convex quadrilateral");
        let shape = Element { facet: &Planar { corners, count: 4 }, plain: &plain, piece }.shape(dual(point, moved));
        let (low, high) = (values(-1e-5), values(1e-5));
        assert!((0..4).all(|k| (shape[k].derivative - (high[k] - low[k]) / 2e-5).abs() < 1e-9));
        assert!(shape.iter().any(|number| number.derivative.abs() > 0.1));
    }

    #[test]
    fn facets_that_are_not_convex() {
        // An arrow is two triangles, whichever corner comes first; one that folds over is none.
        let arrow = [[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]];
        for first in 0..4 {
            let facet = quadrilateral(std::array::from_fn(|k| arrow[(k + first) % 4]));
            assert_eq!(facet.pieces().count(), 2);
            assert!((area(&facet) - 1.0).abs() < 1e-15);
            assert!((facet.tributary().iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
        assert_eq!(quadrilateral([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.2]]).pieces().count(), 0);
        // Two corners in one place leave a triangle.
        let collapsed = quadrilateral([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]]);
        assert!(collapsed.pieces().count() == 1 && (area(&collapsed) - 0.5).abs() < 1e-15);
        let clockwise = quadrilateral([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        assert_eq!(clockwise.pieces().count(), 0);
    }
}
