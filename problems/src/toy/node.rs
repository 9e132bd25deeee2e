//! One spring-held node on a support with Coulomb friction, in closed form.
//!
//! ```text
//! ⎡ k  κ ⎤ ⎡n⎤   ⎡ −P + λ_N ⎤      n ≥ h,  λ_N ≥ 0,  λ_N (n − h) = 0
//! ⎣ κ  k ⎦ ⎣w⎦ = ⎣  t − λ_T ⎦      |λ_T| ≤ 𝓕λ_N;   < ⇒ w = 0 (stick);   = ⇒ w = s λ_T, s ≥ 0 (slip)
//!
//! open    h ≤ n°           λ = 0,  (n, w) = K⁻¹(−P, t),  n° = −(kP + κt)/(k² − κ²)
//! stick   |t − κh| ≤ 𝓕(kh + P)    n = h,  w = 0,  λ_N = kh + P,  λ_T = t − κh
//! slip    otherwise        n = h,  λ_N = Λ_σ (h − n°),  λ_T = σ𝓕λ_N,  w = (t − κh − λ_T)/k,
//!                          Λ_σ = (k² − κ²)/(k + σ𝓕κ),  σ = sign w = sign(t − κh)
//! ```
//! Derivation: open is K⁻¹; stick puts n = h, w = 0 into both rows; slip takes w from the second row with λ_T = σ𝓕λ_N
//! and puts it into the first: λ_N (1 + σ𝓕κ/k) = (k − κ²/k) h + P + κt/k. As 𝓕|κ| < k, both Λ_σ are positive, so
//! exactly one case holds at every h and λ_N is continuous. σw > 0 gives σ(t − κh) = σkw + 𝓕λ_N > 0, which fixes σ
//! before w is known.
//!
//! Kinks: n°, and the two ends of stick h_σ = (t − σ𝓕P)/(κ + σ𝓕k) as far as they lie above n°. Between kinks S is
//! affine in h:
//!
//! ```text
//! d/dh (λ_N, λ_T, n, w) =   open (0, 0, 0, 0);   stick (k, −κ, 1, 0);   slip (Λ_σ, σ𝓕Λ_σ, 1, −(κ + σ𝓕Λ_σ)/k)
//! ```
//! h, n, w in mm, loads and forces in N, k and κ in N/mm, 𝓕 dimensionless. This is method.md (3.1)–(3.3) with one node.

use nonsmooth::InputError;
use serde::{Deserialize, Serialize};

/// Data of one node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct NodeData {
    /// Diagonal stiffness k > 0, N/mm.
    pub stiffness: f64,
    /// Stiffness κ between the normal and the tangential direction, |κ| < k, N/mm.
    pub coupling: f64,
    /// Friction coefficient 𝓕 > 0 with 𝓕|κ| < k (then the solution is unique).
    pub friction_coefficient: f64,
    /// Load P that presses the node down, N.
    pub pressing_load: f64,
    /// Load t along the support, N.
    pub tangential_load: f64,
}

/// A node with admissible data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    data: NodeData,
}

/// Contact status of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NodeStatus {
    /// The node does not touch the support.
    Open,
    /// The node touches the support and does not slide.
    Stick,
    /// Closed, sliding with w > 0 (σ = 1).
    SlipForward,
    /// Closed, sliding with w < 0 (σ = −1).
    SlipBackward,
}

impl std::fmt::Display for NodeStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Open => "open",
            Self::Stick => "stick",
            Self::SlipForward => "slip forward",
            Self::SlipBackward => "slip backward",
        })
    }
}

/// State of a node, or its derivative with respect to the height of the support.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct NodeValues {
    /// Normal force λ_N, positive under compression.
    pub normal_force: f64,
    /// λ_T, the tangential force of the node on the support; −λ_T acts on the node, see the equilibrium of the module.
    pub tangential_force: f64,
    /// n, the height of the node.
    pub height: f64,
    /// w, the tangential displacement.
    pub slip: f64,
}

impl NodeValues {
    /// Number of entries in a packed state.
    pub const LEN: usize = 4;

    /// (λ_N, λ_T, n, w).
    pub fn packed(&self) -> [f64; Self::LEN] {
        [self.normal_force, self.tangential_force, self.height, self.slip]
    }
}

/// A kink of the state and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Kink {
    /// Height h of the support at the kink.
    pub height: f64,
    /// Status for supports slightly below `height`.
    pub below: NodeStatus,
    /// Status for supports slightly above `height`.
    pub above: NodeStatus,
}

impl Node {
    /// A node with a unique state for every height of the support.
    ///
    /// # Errors
    /// [`InputError::OutOfRange`] unless the data are finite with k > 0, |κ| < k, 𝓕 > 0 and 𝓕|κ| < k.
    ///
    /// ```
    /// use problems::toy::{Node, NodeData, NodeStatus};
    /// let node = Node::new(NodeData {
    ///     stiffness: 2.0, coupling: 1.0, friction_coefficient: 0.25, pressing_load: 1.0, tangential_load: 1.0,
    /// })?;
    /// let (status, values) = node.solve(1.0);
    /// assert_eq!(status, NodeStatus::Stick);
    /// assert_eq!(values.normal_force, 3.0);
    /// # Ok::<(), nonsmooth::InputError>(())
    /// ```
    pub fn new(data: NodeData) -> Result<Self, InputError> {
        let NodeData { stiffness, coupling, friction_coefficient, pressing_load, tangential_load } = data;
        let unique = friction_coefficient > 0.0 && friction_coefficient * coupling.abs() < stiffness;
        let cone = "> 0, friction_coefficient·|coupling| < stiffness";
        for (setting, value, allowed, valid) in [
            ("stiffness", stiffness, "> 0, finite", stiffness > 0.0),
            ("coupling", coupling, "|coupling| < stiffness", coupling.abs() < stiffness),
            ("friction_coefficient", friction_coefficient, cone, unique),
            ("pressing_load", pressing_load, "finite", true),
            ("tangential_load", tangential_load, "finite", true),
        ] {
            if !(valid && value.is_finite()) {
                return Err(InputError::OutOfRange { setting, value: value.to_string(), allowed });
            }
        }
        Ok(Self { data })
    }

    /// The data of the node.
    pub fn data(&self) -> &NodeData {
        &self.data
    }

    /// n°, the height of the node without support.
    pub fn free_height(&self) -> f64 {
        let NodeData { stiffness: k, coupling: c, pressing_load: p, tangential_load: t, .. } = self.data;
        -(k * p + c * t) / (k * k - c * c)
    }

    /// Status and state on a support of the given height. On a kink the status is open (at n°) or stick.
    pub fn solve(&self, support: f64) -> (NodeStatus, NodeValues) {
        let status = self.status(support);
        (status, self.values(status, support))
    }

    /// The derivative of the state with respect to the height of the support while the status lasts.
    pub fn derivative(&self, status: NodeStatus) -> NodeValues {
        let NodeData { stiffness: k, coupling: c, friction_coefficient, .. } = self.data;
        let slip = |sign: f64| {
            let normal_force = self.slip_rate(sign);
            let tangential_force = sign * friction_coefficient * normal_force;
            NodeValues { normal_force, tangential_force, height: 1.0, slip: -(c + tangential_force) / k }
        };
        match status {
            NodeStatus::Open => NodeValues::default(),
            NodeStatus::Stick => NodeValues { normal_force: k, tangential_force: -c, height: 1.0, slip: 0.0 },
            NodeStatus::SlipForward => slip(1.0),
            NodeStatus::SlipBackward => slip(-1.0),
        }
    }

    /// All heights of the support where the state is not differentiable, ascending.
    pub fn kinks(&self) -> Vec<Kink> {
        let NodeData { stiffness: k, coupling: c, friction_coefficient: f, pressing_load: p, tangential_load: t } =
            self.data;
        let free = self.free_height();
        let ends = [1.0, -1.0].map(|sign| (t - sign * f * p) / (c + sign * f * k));
        let mut heights = vec![free];
        heights.extend(ends.into_iter().filter(|end| end.is_finite() && *end > free));
        heights.sort_by(f64::total_cmp);
        let middle = |i: usize| match (i.checked_sub(1), heights.get(i)) {
            (None, _) => free - 1.0 - free.abs(),
            (Some(below), Some(above)) => 0.5 * (heights[below] + above),
            (Some(below), None) => heights[below] + 1.0 + heights[below].abs(),
        };
        let status = |i| self.status(middle(i));
        heights
            .iter()
            .enumerate()
            .map(|(i, &height)| Kink { height, below: status(i), above: status(i + 1) })
            .filter(|kink| kink.below != kink.above)
            .collect()
    }

    /// Every status that occurs next to the given height, kinks within `width` included: one away from kinks, two on
    /// one.
    pub fn neighbouring_statuses(&self, support: f64, width: f64) -> Vec<NodeStatus> {
        let mut found = Vec::with_capacity(2);
        for kink in self.kinks().iter().filter(|kink| (kink.height - support).abs() <= width) {
            for status in [kink.below, kink.above] {
                if !found.contains(&status) {
                    found.push(status);
                }
            }
        }
        if found.is_empty() { vec![self.status(support)] } else { found }
    }

    fn status(&self, support: f64) -> NodeStatus {
        let NodeData { stiffness: k, coupling: c, friction_coefficient: f, pressing_load: p, tangential_load: t } =
            self.data;
        let drive = t - c * support;
        if support <= self.free_height() {
            NodeStatus::Open
        } else if drive.abs() <= f * (k * support + p) {
            NodeStatus::Stick
        } else if drive > 0.0 {
            NodeStatus::SlipForward
        } else {
            NodeStatus::SlipBackward
        }
    }

    fn values(&self, status: NodeStatus, support: f64) -> NodeValues {
        let NodeData { stiffness: k, coupling: c, friction_coefficient: f, pressing_load: p, tangential_load: t } =
            self.data;
        let slip = |sign: f64| {
            let normal_force = self.slip_rate(sign) * (support - self.free_height());
            let tangential_force = sign * f * normal_force;
            NodeValues {
                normal_force,
                tangential_force,
                height: support,
                slip: (t - c * support - tangential_force) / k,
            }
        };
        match status {
            NodeStatus::Open => {
                let slip = (k * t + c * p) / (k * k - c * c);
                NodeValues { height: self.free_height(), slip, ..NodeValues::default() }
            }
            NodeStatus::Stick => NodeValues {
                normal_force: k * support + p,
                tangential_force: t - c * support,
                height: support,
                slip: 0.0,
            },
            NodeStatus::SlipForward => slip(1.0),
            NodeStatus::SlipBackward => slip(-1.0),
        }
    }

    /// The rate Λ_σ.
    fn slip_rate(&self, sign: f64) -> f64 {
        let NodeData { stiffness: k, coupling: c, friction_coefficient: f, .. } = self.data;
        (k * k - c * c) / (k + sign * f * c)
    }
}
