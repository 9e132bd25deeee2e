//! Rigid motions of points, and of points against each other.

/// Six motions per body: translations, and rotations about a common centre divided by a common length.
pub const MOTIONS: usize = 6;

/// What moves in a rigid motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// A point.
    Point([f64; 3]),
    /// The end of an arm against its beginning: translations do not change it.
    Arm([f64; 3]),
}

impl Place {
    /// Displacement (three components) in the six motions; `centre`, `length` in mm.
    pub fn motions(self, centre: [f64; 3], length: f64) -> [[f64; 3]; MOTIONS] {
        let (arm, one) = match self {
            Self::Point(point) => (std::array::from_fn(|axis| point[axis] - centre[axis]), 1.0),
            Self::Arm(arm) => (arm, 0.0),
        };
        let x = arm.map(|x: f64| x / length);
        [[one, 0.0, 0.0], [0.0, one, 0.0], [0.0, 0.0, one], [0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]]
    }

    /// The point; none for an arm.
    pub fn point(self) -> Option<[f64; 3]> {
        if let Self::Point(point) = self { Some(point) } else { None }
    }
}
