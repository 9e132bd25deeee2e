//! The nodes by which the subdomains of a cluster are held together.
//!
//! ```text
//! interface: the nodes that the same subdomains share, all of one cluster;   joints: up to four of them, far apart
//! ```
//! Three nodes of an interface leave its subdomains no motion against each other; few nodes keep the factors small.

use crate::body::Body;
use crate::tfeti::torn::copies::Copies;
use crate::tfeti::torn::numbering::Numbering;
use std::collections::{BTreeMap, HashMap};

/// Joints of an interface.
const COUNT: usize = 4;

/// The clusters of the nodes that are joints, by body.
#[derive(Debug, Default)]
pub struct Joints {
    clusters: Vec<HashMap<u32, usize>>,
}

impl Joints {
    /// The joints of all clusters; none where every subdomain is a cluster.
    pub fn new(bodies: &[Body], copies: &[Copies], numbering: &Numbering) -> Self {
        if !numbering.is_joined() {
            return Self { clusters: vec![HashMap::new(); bodies.len()] };
        }
        let of_body = |(body, copies): (&Body, &Copies)| {
            let mut interfaces: BTreeMap<Vec<usize>, Vec<u32>> = BTreeMap::new();
            for node in 0..body.mesh.node_count() as u32 {
                let subdomains: Vec<usize> = copies.of(node).iter().map(|&dof| numbering.owner(dof)).collect();
                let mut clusters = subdomains.iter().map(|&subdomain| numbering.cluster_of(subdomain));
                let first = clusters.next();
                if subdomains.len() > 1 && clusters.all(|cluster| Some(cluster) == first) {
                    interfaces.entry(subdomains).or_default().push(node);
                }
            }
            let mut joints = HashMap::new();
            for (subdomains, nodes) in interfaces {
                let cluster = numbering.cluster_of(subdomains[0]);
                joints.extend(far_apart(body.mesh.nodes(), &nodes).into_iter().map(|node| (node, cluster)));
            }
            joints
        };
        Self { clusters: bodies.iter().zip(copies).map(of_body).collect() }
    }

    /// The cluster that a node holds together, if it is a joint.
    pub fn cluster_of(&self, body: usize, node: u32) -> Option<usize> {
        self.clusters[body].get(&node).copied()
    }
}

/// Up to four of some nodes: the first, then each as far as possible from those before it.
fn far_apart(points: &[[f64; 3]], nodes: &[u32]) -> Vec<u32> {
    let distance = |a: u32, b: u32| -> f64 {
        (0..3).map(|axis| (points[a as usize][axis] - points[b as usize][axis]).powi(2)).sum()
    };
    let mut chosen = vec![nodes[0]];
    while chosen.len() < COUNT.min(nodes.len()) {
        let nearest = |node: u32| chosen.iter().map(|&other| distance(node, other)).fold(f64::INFINITY, f64::min);
        let largest = nodes.iter().map(|&node| nearest(node)).fold(0.0, f64::max);
        // Of nodes that are as far up to rounding, the first.
        let next = nodes.iter().copied().find(|&node| nearest(node) >= (1.0 - 1e-9) * largest);
        chosen.extend(next);
    }
    chosen
}
