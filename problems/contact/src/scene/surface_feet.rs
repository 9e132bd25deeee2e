//! The foot of a point on the counter surface: unit normal and gap, with their derivatives by the position of the
//! point.
//!
//! ```text
//! exact distance:  n from the body into the obstacle,  gap = n·(foot − x),   gap′ = −n·x′
//! plane n′ = 0;   sphere n′ = −s (I − nnᵀ) x′/|c − x|;   signed distance: see there
//! heights g:  (y − x) + (g(y) − x₃) ∇g(y) = 0,  n = (−∇g, 1)/√(1 + |∇g|²),  H = I + ∇g∇gᵀ + (g − x₃) G
//!             H y′ = x₁₂′ + ∇g x₃′,   n′ = (I − nnᵀ)(−G y′, 0)/√(1 + |∇g|²)
//! along x₃:   n = e₃,  gap = g(x₁, x₂) − x₃
//! ```
//! The foot on a surface of heights is unique near the surface if H is positive definite: the gap is smaller than the
//! radius of curvature.

use crate::scene::counter_surface::CounterSurface;
use crate::scene::foot::Foot;
use crate::scene::jet::Jet;
use crate::scene::side::Side;

/// Steps of Newton's method for a foot.
const MAX_STEPS: usize = 60;
/// Length of a step, relative to the lengths involved, that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Length of a step from which the next one must be shorter.
const NEAR: f64 = 1e-9;

impl CounterSurface {
    /// The foot of a point by the exact distance.
    ///
    /// # Errors
    /// The reason in words where there is no unique foot.
    pub fn foot(&self, x: [f64; 3]) -> Result<Foot, &'static str> {
        match *self {
            Self::Plane { height } => Ok(flat([0.0, 0.0, 1.0], height - x[2])),
            Self::Sphere { apex, radius, centre: [c1, c2] } => {
                round(subtract([c1, c2, apex + radius], x), radius, Side::Outside)
            }
            Self::TiltedPlane { point, normal } => {
                let normal = scaled(normal, 1.0 / length(normal));
                Ok(flat(normal, dot(subtract(point, x), normal)))
            }
            Self::Ball { centre, radius, side } => round(subtract(centre, x), radius, side),
            Self::Revolution(ref surface) => surface.foot(x),
            Self::Mesh(ref surface) => surface.foot(x),
            Self::Waves { .. } | Self::Grid(_) => self.height_foot(x),
            Self::Punch { .. } => Err("the surface has a step, where it has no normal"),
        }
    }

    /// The foot of a point straight above it; not a number where the surface has no height.
    pub fn foot_along_x3(&self, x: [f64; 3]) -> Foot {
        let Jet { height, slopes: [first, second], .. } = self.jet(x[0], x[1]);
        Foot { gap_slope: [first, second, -1.0], ..flat([0.0, 0.0, 1.0], height - x[2]) }
    }

    /// Height with its derivatives at (x₁, x₂).
    fn jet(&self, x1: f64, x2: f64) -> Jet {
        let height = self.height(x1, x2);
        match self {
            &Self::Waves { first, second, period, origin: [o1, o2], .. } => {
                let angle = 2.0 * std::f64::consts::PI / period;
                let ((s1, c1), (s2, c2)) = ((angle * (x1 - o1)).sin_cos(), (angle * (x2 - o2)).sin_cos());
                let square = angle * angle;
                Jet {
                    height,
                    slopes: [angle * first * c1, -angle * second * s2],
                    second: [[-square * first * s1, 0.0], [0.0, -square * second * c2]],
                }
            }
            &Self::Sphere { radius, centre, .. } => {
                let r = [x1 - centre[0], x2 - centre[1]];
                let depth = (radius * radius - r[0] * r[0] - r[1] * r[1]).sqrt();
                let second =
                    |i: usize, j: usize| f64::from(u8::from(i == j)) / depth + r[i] * r[j] / (depth * depth * depth);
                Jet { height, slopes: r.map(|r| r / depth), second: [0, 1].map(|i| [0, 1].map(|j| second(i, j))) }
            }
            Self::Grid(grid) => grid.jet(x1, x2),
            _ => Jet { height, slopes: [0.0; 2], second: [[0.0; 2]; 2] },
        }
    }

    /// The foot on a surface of heights, by Newton's method from the place of the point.
    fn height_foot(&self, x: [f64; 3]) -> Result<Foot, &'static str> {
        let mut y = [x[0], x[1]];
        let mut last = f64::INFINITY;
        for _step in 0..MAX_STEPS {
            let jet = self.jet(y[0], y[1]);
            let (p, rise) = (jet.slopes, jet.height - x[2]);
            let rest = [0, 1].map(|i| y[i] - x[i] + rise * p[i]);
            let step = solve(&hessian(&jet, rise), rest);
            y = [0, 1].map(|i| y[i] - step[i]);
            let size = step[0].hypot(step[1]);
            let scale = y[0].abs().max(y[1].abs()).max(rise.abs());
            if size <= ROUNDING * scale || (size <= NEAR * scale && size >= last) {
                return self.foot_at(x, y);
            }
            last = size;
        }
        Err("no nearest point of the surface was found: it is too far away, or the surface has kinks there")
    }

    /// The foot over a place where the surface is perpendicular to the way to the point.
    fn foot_at(&self, x: [f64; 3], y: [f64; 2]) -> Result<Foot, &'static str> {
        let jet = self.jet(y[0], y[1]);
        let Jet { height, slopes: p, second } = jet;
        let h = hessian(&jet, height - x[2]);
        if !(h[0][0] > 0.0 && h[0][0] * h[1][1] - h[0][1] * h[1][0] > 0.0) {
            return Err("its nearest point on the surface is not unique: the gap exceeds the radius of curvature");
        }
        let slope = (1.0 + p[0] * p[0] + p[1] * p[1]).sqrt();
        let normal = [-p[0] / slope, -p[1] / slope, 1.0 / slope];
        let mut foot = flat(normal, dot(normal, subtract([y[0], y[1], height], x)));
        for axis in 0..3 {
            let right = match axis {
                2 => p,
                _ => [0, 1].map(|i| f64::from(u8::from(i == axis))),
            };
            let moved = solve(&h, right);
            let turned = [0, 1].map(|i| -(second[i][0] * moved[0] + second[i][1] * moved[1]) / slope);
            let turned = [turned[0], turned[1], 0.0];
            let along = dot(normal, turned);
            (0..3).for_each(|i| foot.normal_slope[i][axis] = turned[i] - along * normal[i]);
        }
        Ok(foot)
    }
}

/// H of a jet and the rise g − x₃.
fn hessian(jet: &Jet, rise: f64) -> [[f64; 2]; 2] {
    let (p, g) = (jet.slopes, jet.second);
    [0, 1].map(|i| [0, 1].map(|j| f64::from(u8::from(i == j)) + p[i] * p[j] + rise * g[i][j]))
}

fn solve(m: &[[f64; 2]; 2], b: [f64; 2]) -> [f64; 2] {
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    [(b[0] * m[1][1] - m[0][1] * b[1]) / determinant, (m[0][0] * b[1] - m[1][0] * b[0]) / determinant]
}

/// The foot on a plane.
fn flat(normal: [f64; 3], gap: f64) -> Foot {
    Foot { normal, gap, gap_slope: normal.map(|n| -n), normal_slope: [[0.0; 3]; 3] }
}

/// The foot on a sphere, from the way v to the centre.
fn round(v: [f64; 3], radius: f64, side: Side) -> Result<Foot, &'static str> {
    let distance = length(v);
    if distance <= f64::EPSILON * radius {
        return Err("it lies at the centre of the surface, where every normal is as good");
    }
    let sign = if side == Side::Outside { 1.0 } else { -1.0 };
    let normal = scaled(v, sign / distance);
    let slope = |i: usize, j: usize| -sign * (f64::from(u8::from(i == j)) - normal[i] * normal[j]) / distance;
    let normal_slope = std::array::from_fn(|i| std::array::from_fn(|j| slope(i, j)));
    Ok(Foot { normal_slope, ..flat(normal, sign * (distance - radius)) })
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn scaled(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|x| factor * x)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
