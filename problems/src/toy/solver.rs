//! The toy's state map S and its coderivative.
//!
//! ```text
//! h = B α,   B = ⎡3/4 1/4⎤      y = S(α) = (y¹(h₁), y²(h₂)),   yⁱ = (λ_N, λ_T, n, w) of node i        node.rs
//!                ⎣1/4 3/4⎦      D*S(α)(y*) ∋ Bᵀ (⟨y¹*, dy¹/dh⟩, ⟨y²*, dy²/dh⟩)
//! ```
//! The surface of the support is the linear spline with the two control heights α over [0, 1]; the nodes stand at 1/4
//! and 3/4. On a kink `coderivative` uses the derivative of the status that `solve` reports; B is regular and the nodes
//! are independent, so any pair of one-sided derivatives is a limit of Jacobians and the result an element of
//! D*S(α)(y*) and of the Clarke set.

use super::node::{Kink, Node, NodeStatus, NodeValues};
use nonsmooth::{Accuracy, Coderivative, InputError, OracleError, Sensitivity, StateSolver, Vector};

/// B, control heights to heights under the nodes.
pub const SURFACE: [[f64; 2]; 2] = [[0.75, 0.25], [0.25, 0.75]];

/// Two nodes on a support whose surface is given by two control heights.
#[derive(Debug, Clone, PartialEq)]
pub struct ToyContact {
    nodes: [Node; 2],
}

/// State of one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeState {
    /// Height h of the support under the node.
    pub support: f64,
    /// Contact status; on a kink open or stick.
    pub status: NodeStatus,
    /// Forces and displacements of the node.
    pub values: NodeValues,
}

/// State of the toy: both nodes. The dual has 8 entries, (λ_N, λ_T, n, w) of the first node, then of the second.
#[derive(Debug, Clone, PartialEq)]
pub struct ToyState {
    /// States of the two nodes.
    pub nodes: [NodeState; 2],
}

impl ToyState {
    /// Number of entries of the state and of its dual.
    pub const LEN: usize = 2 * NodeValues::LEN;

    /// The state as a vector, in the layout of its dual.
    pub fn packed(&self) -> Vector {
        Vector::from_iterator(Self::LEN, self.nodes.iter().flat_map(|node| node.values.packed()))
    }
}

impl ToyContact {
    /// The toy with given nodes.
    pub fn new(nodes: [Node; 2]) -> Self {
        Self { nodes }
    }

    /// The data of the two nodes.
    pub fn nodes(&self) -> &[Node; 2] {
        &self.nodes
    }

    /// h = Bα for two finite controls.
    ///
    /// # Errors
    /// [`InputError`] on another number of controls, NaN and infinity.
    pub fn support_heights(&self, control: &Vector) -> Result<[f64; 2], InputError> {
        InputError::check_vector("control", 2, control)?;
        Ok(SURFACE.map(|row| row[0] * control[0] + row[1] * control[1]))
    }

    /// For each node the kink nearest to its support, and the distance.
    ///
    /// # Errors
    /// As [`support_heights`](Self::support_heights).
    pub fn nearest_kinks(&self, control: &Vector) -> Result<[Option<(Kink, f64)>; 2], InputError> {
        let heights = self.support_heights(control)?;
        Ok(std::array::from_fn(|i| {
            let distance = |kink: Kink| (kink, (kink.height - heights[i]).abs());
            self.nodes[i].kinks().into_iter().map(distance).min_by(|a, b| a.1.total_cmp(&b.1))
        }))
    }

    /// Bᵀ (⟨y¹*, dy¹/dh⟩, ⟨y²*, dy²/dh⟩) with the derivatives of the given statuses.
    pub(super) fn pull_back(&self, statuses: [NodeStatus; 2], direction: &Vector) -> Vector {
        let mut slopes = [0.0; 2];
        for (i, (node, status)) in self.nodes.iter().zip(statuses).enumerate() {
            let dual = direction.iter().skip(i * NodeValues::LEN);
            slopes[i] = node.derivative(status).packed().iter().zip(dual).map(|(rate, dual)| rate * dual).sum();
        }
        Vector::from_fn(2, |j, _| SURFACE[0][j] * slopes[0] + SURFACE[1][j] * slopes[1])
    }
}

impl StateSolver for ToyContact {
    type State = ToyState;
    type WarmStart = ();

    fn control_dimension(&self) -> usize {
        2
    }

    fn solve(&self, control: &Vector, _start: Option<&()>, _accuracy: Accuracy) -> Result<ToyState, OracleError> {
        let heights = self.support_heights(control)?;
        let nodes = std::array::from_fn(|i| {
            let (status, values) = self.nodes[i].solve(heights[i]);
            NodeState { support: heights[i], status, values }
        });
        Ok(ToyState { nodes })
    }

    fn warm_start(&self, _state: &ToyState) {}
}

impl Coderivative for ToyContact {
    fn coderivative(
        &self,
        _control: &Vector,
        state: &ToyState,
        direction: &Vector,
    ) -> Result<Sensitivity, OracleError> {
        if direction.len() != ToyState::LEN {
            let (expected, found) = (ToyState::LEN, direction.len());
            return Err(InputError::Dimension { what: "dual of the state", expected, found }.into());
        }
        Ok(Sensitivity::exact(self.pull_back(state.nodes.map(|node| node.status), direction)))
    }
}
