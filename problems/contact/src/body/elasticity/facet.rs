//! Integrals over the faces of cells: quad4 with 2 × 2 Gauss points, tri6 with a rule of six points and degree 4.
//!
//! ```text
//! ∫_face f dA = Σ w f |a × b|,   a = ∂x/∂ξ,  b = ∂x/∂η
//! ```

use crate::scalar::Scalar;

/// A point of a rule over a face, in the face itself.
#[derive(Debug, Clone)]
pub struct FacePoint<'a, T> {
    /// Shape functions of all nodes of the face.
    pub values: &'a [f64],
    /// Linear or bilinear shape functions of its corners.
    pub corner_values: &'a [f64],
    /// Its position, mm.
    pub position: [T; 3],
    /// a × b times the weight, mm²: outward for nodes counterclockwise seen from outside.
    pub area: [T; 3],
}

/// A point of a rule over a reference face.
struct RulePoint<const N: usize, const C: usize> {
    values: [f64; N],
    corner_values: [f64; C],
    /// Slopes of the shape functions along ξ and η.
    slopes: [[f64; 2]; N],
    weight: f64,
}

/// ξ, η of the corners of a quadrilateral, counterclockwise.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

fn quad4(corner: usize) -> RulePoint<4, 4> {
    let abscissa = 1.0 / 3.0_f64.sqrt();
    let [xi, eta] = CORNERS[corner].map(|s| s * abscissa);
    let values = CORNERS.map(|[s, t]| (1.0 + s * xi) * (1.0 + t * eta) / 4.0);
    RulePoint {
        values,
        corner_values: values,
        slopes: CORNERS.map(|[s, t]| [s * (1.0 + t * eta) / 4.0, t * (1.0 + s * xi) / 4.0]),
        weight: 1.0,
    }
}

/// Barycentric coordinates and weights (of the area) of the rule of degree 4 \[Dunavant1985\].
const TRIANGLE: [([f64; 3], f64); 6] = {
    const A: f64 = 0.445_948_490_915_964_9;
    const B: f64 = 0.091_576_213_509_770_74;
    const WA: f64 = 0.223_381_589_678_011_47;
    const WB: f64 = 0.109_951_743_655_321_87;
    [
        ([1.0 - 2.0 * A, A, A], WA),
        ([A, 1.0 - 2.0 * A, A], WA),
        ([A, A, 1.0 - 2.0 * A], WA),
        ([1.0 - 2.0 * B, B, B], WB),
        ([B, 1.0 - 2.0 * B, B], WB),
        ([B, B, 1.0 - 2.0 * B], WB),
    ]
};

/// Nodes 3 to 5 of a triangle of second order lie between these vertices.
const MIDDLES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

fn tri6((l, weight): ([f64; 3], f64)) -> RulePoint<6, 3> {
    let slope = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let value = |v: usize| match v.checked_sub(3) {
        None => l[v] * (2.0 * l[v] - 1.0),
        Some(edge) => 4.0 * l[MIDDLES[edge][0]] * l[MIDDLES[edge][1]],
    };
    let along = |v: usize, k: usize| match v.checked_sub(3) {
        None => (4.0 * l[v] - 1.0) * slope[v][k],
        Some(edge) => {
            let [a, b] = MIDDLES[edge];
            4.0 * (l[a] * slope[b][k] + l[b] * slope[a][k])
        }
    };
    RulePoint {
        values: std::array::from_fn(value),
        corner_values: l,
        slopes: std::array::from_fn(|v| [along(v, 0), along(v, 1)]),
        weight: 0.5 * weight,
    }
}

/// Visits the points of the rule over a face: four nodes of a quadrilateral, or six of a triangle of second order.
pub fn integrate<T: Scalar>(nodes: &[[T; 3]], mut visit: impl FnMut(FacePoint<'_, T>)) {
    if nodes.len() == 4 {
        (0..4).map(quad4).for_each(|point| visit(point.on(nodes)));
    } else {
        TRIANGLE.into_iter().map(tri6).for_each(|point| visit(point.on(nodes)));
    }
}

impl<const N: usize, const C: usize> RulePoint<N, C> {
    fn on<T: Scalar>(&self, nodes: &[[T; 3]]) -> FacePoint<'_, T> {
        let zero = || [T::constant(0.0); 3];
        let (mut position, mut a, mut b) = (zero(), zero(), zero());
        for ((node, &value), slopes) in nodes.iter().zip(&self.values).zip(&self.slopes) {
            for axis in 0..3 {
                position[axis] += node[axis] * T::constant(value);
                a[axis] += node[axis] * T::constant(slopes[0]);
                b[axis] += node[axis] * T::constant(slopes[1]);
            }
        }
        let weight = T::constant(self.weight);
        let cross = |i: usize, j: usize| (a[i] * b[j] - a[j] * b[i]) * weight;
        let area = [cross(1, 2), cross(2, 0), cross(0, 1)];
        FacePoint { values: &self.values, corner_values: &self.corner_values, position, area }
    }
}

/// Length of a vector that is not zero.
pub fn length<T: Scalar>([x, y, z]: [T; 3]) -> T {
    (x * x + y * y + z * z).sqrt()
}

/// How the size of a surface element is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "AreaName", transform = crate::schema::names_only))]
pub enum AreaKind {
    /// On the surface itself.
    #[default]
    Surface,
    /// Projected along x₃, as in the paper.
    Projected,
}

/// ∫ ψ_v dA of the linear or bilinear shape functions ψ of the corners of a face, mm².
pub fn tributary_areas<T: Scalar>(nodes: &[[T; 3]], kind: AreaKind) -> Vec<T> {
    let mut areas = vec![T::constant(0.0); if nodes.len() == 4 { 4 } else { 3 }];
    integrate(nodes, |point| {
        let area = match kind {
            AreaKind::Surface => length(point.area),
            AreaKind::Projected if point.area[2].value() < 0.0 => T::constant(-1.0) * point.area[2],
            AreaKind::Projected => point.area[2],
        };
        areas.iter_mut().zip(point.corner_values).for_each(|(sum, &value)| *sum += area * T::constant(value));
    });
    areas
}
