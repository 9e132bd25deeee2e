//! The auxiliary plane of a slave facet.
//!
//! ```text
//! N = d₁ × d₂  (diagonals, or two edges of a triangle),   n₀ = N/|N|  or ±e₃
//! projection of y:  ((y − c)·t₁, (y − c)·t₂),   height h = (y − c)·n₀
//! change:  t_a·y′ − h t_a·n₀′,   n₀′ = (I − n₀ n₀ᵀ) N′/|N|
//! ```
//!
//! The change leaves out that of c and the spin of t₁, t₂ about n₀: both move all projections alike, and no integral
//! depends on them.

use super::Along;
use super::vector::{across, cross, dot, length, plus};

/// A facet seen less than this (sine of the angle) from the direction of projection is left out.
const EDGE_ON: f64 = 1e-9;

/// A plane with an orthonormal basis; the slave facet is counterclockwise in it.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    centre: [f64; 3],
    tangents: [[f64; 3]; 2],
    normal: [f64; 3],
    tilt: Option<Tilt>,
}

/// How the normal depends on the facet.
#[derive(Debug, Clone, Copy)]
struct Tilt {
    diagonals: [[f64; 3]; 2],
    /// |N|.
    size: f64,
    triangle: bool,
}

/// The two vectors whose cross product is along the normal in the centre: twice the vector area.
fn diagonals(corners: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let between = |from: usize, to: usize| plus(corners[to], -1.0, corners[from]);
    if corners.len() == 4 { [between(0, 2), between(1, 3)] } else { [between(0, 1), between(0, 2)] }
}

/// Twice the vector area of a facet.
pub fn doubled_area(corners: &[[f64; 3]]) -> [f64; 3] {
    let [first, second] = diagonals(corners);
    cross(first, second)
}

/// The mean of the corners and the largest distance from it.
pub fn circle(corners: &[[f64; 3]]) -> ([f64; 3], f64) {
    let share = 1.0 / corners.len() as f64;
    let centre = corners.iter().fold([0.0; 3], |sum, &corner| plus(sum, share, corner));
    (centre, corners.iter().map(|&corner| length(plus(corner, -1.0, centre))).fold(0.0, f64::max))
}

impl Frame {
    /// The plane of a facet, unless it has no area or is seen edge-on.
    pub fn new(corners: &[[f64; 3]], along: Along) -> Option<Self> {
        let (centre, radius) = circle(corners);
        let area = doubled_area(corners);
        let size = length(area);
        if size.is_nan() || size <= EDGE_ON * radius * radius {
            return None;
        }
        match along {
            Along::X3 => {
                let sign = area[2].signum();
                let tangents = [[1.0, 0.0, 0.0], [0.0, sign, 0.0]];
                let frame = Self { centre, tangents, normal: [0.0, 0.0, sign], tilt: None };
                (area[2].abs() > EDGE_ON * size).then_some(frame)
            }
            Along::Normals => {
                let normal = area.map(|component| component / size);
                let tilt = Tilt { diagonals: diagonals(corners), size, triangle: corners.len() == 3 };
                Some(Self { centre, tangents: across(normal), normal, tilt: Some(tilt) })
            }
        }
    }

    /// Whether the projections of a facet with this centre and radius may meet that of the own facet, and the facet
    /// faces the plane.
    pub fn may_meet(&self, radius: f64, other: &Bound) -> bool {
        let offset = plus(other.centre, -1.0, self.centre);
        let inside = |reach: f64| self.tangents.iter().map(|&t| dot(t, offset).powi(2)).sum::<f64>() <= reach * reach;
        inside(radius + other.radius) && dot(other.normal, self.normal) < -EDGE_ON
    }

    /// Whether a box may have a facet in it whose projection meets that of the own facet, of this radius.
    pub fn may_reach(&self, radius: f64, lower: [f64; 3], upper: [f64; 3]) -> bool {
        let centre: [f64; 3] = std::array::from_fn(|axis| 0.5 * (lower[axis] + upper[axis]));
        let offset = plus(centre, -1.0, self.centre);
        // Half of the extent of the box along a direction.
        let extent = |t: [f64; 3]| (0..3).map(|axis| 0.5 * (upper[axis] - lower[axis]) * t[axis].abs()).sum::<f64>();
        self.tangents.iter().all(|&t| dot(t, offset).abs() <= radius + extent(t))
    }

    pub fn project(&self, position: [f64; 3]) -> [f64; 2] {
        let offset = plus(position, -1.0, self.centre);
        self.tangents.map(|t| dot(t, offset))
    }

    pub fn height(&self, position: [f64; 3]) -> f64 {
        dot(self.normal, plus(position, -1.0, self.centre))
    }

    /// t_a·n₀′ for velocities of the corners of the own facet.
    pub fn turning(&self, velocities: &[[f64; 3]]) -> [f64; 2] {
        let Some(tilt) = self.tilt else { return [0.0; 2] };
        let [d1, d2] = tilt.diagonals;
        let [v1, v2] = diagonals(velocities);
        let change = plus(cross(v1, d2), 1.0, cross(d1, v2));
        self.tangents.map(|t| dot(t, change) / tilt.size)
    }

    /// Velocity of the projection of a point.
    pub fn projected_velocity(&self, position: [f64; 3], velocity: [f64; 3], turning: [f64; 2]) -> [f64; 2] {
        let height = self.height(position);
        std::array::from_fn(|a| dot(self.tangents[a], velocity) - height * turning[a])
    }

    /// Transpose of [`Self::projected_velocity`]: the sensitivity to the position; adds the one to the turning.
    pub fn lifted(&self, position: [f64; 3], planar: [f64; 2], turning: &mut [f64; 2]) -> [f64; 3] {
        let height = self.height(position);
        (0..2).for_each(|a| turning[a] -= height * planar[a]);
        plus(self.tangents[0].map(|component| component * planar[0]), planar[1], self.tangents[1])
    }

    /// Transpose of [`Self::turning`]: adds the sensitivities to the corners of the own facet.
    pub fn turned_back(&self, turning: [f64; 2], corners: &mut [[f64; 3]]) {
        let Some(tilt) = self.tilt else { return };
        let [d1, d2] = tilt.diagonals;
        let force: [f64; 3] =
            std::array::from_fn(|k| (0..2).map(|a| turning[a] * self.tangents[a][k]).sum::<f64>() / tilt.size);
        let (first, second) = (cross(d2, force), cross(force, d1));
        let ends = if tilt.triangle { [[0, 1], [0, 2]] } else { [[0, 2], [1, 3]] };
        for ([from, to], part) in ends.into_iter().zip([first, second]) {
            corners[from] = plus(corners[from], -1.0, part);
            corners[to] = plus(corners[to], 1.0, part);
        }
    }
}

/// What decides quickly whether facets may meet.
#[derive(Debug, Clone, Copy)]
pub struct Bound {
    pub centre: [f64; 3],
    pub radius: f64,
    /// Of unit length, outward; zero for a facet without area.
    normal: [f64; 3],
}

impl Bound {
    /// Bound a master facet whose corners are in the order of [`super::facet::Patch::reversed`].
    pub fn of_reversed(corners: &[[f64; 3]]) -> Self {
        let (centre, radius) = circle(corners);
        let area = doubled_area(corners);
        let size = length(area);
        let normal = if size > EDGE_ON * radius * radius { area.map(|component| -component / size) } else { [0.0; 3] };
        Self { centre, radius, normal }
    }
}
