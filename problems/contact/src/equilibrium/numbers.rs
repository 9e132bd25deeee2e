//! What geometry says of a contact node.

/// Normal, gap, area and weights of a contact node: their values, their changes along velocities of the nodes, or
/// sensitivities by them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Numbers {
    /// The unit normal from the slave body outwards.
    pub normal: [f64; 3],
    /// The distance of the shapes along it, mm.
    pub gap: f64,
    /// The tributary area, mm².
    pub area: f64,
    /// The weights of the sides; empty where they do not change.
    pub weights: Vec<f64>,
}

/// The numbers of a contact node at a shape.
#[derive(Debug, Clone)]
pub(crate) struct Placed {
    pub numbers: Numbers,
    /// Whether anything lies opposite to the node.
    pub is_covered: bool,
}
