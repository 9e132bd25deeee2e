//! The copies of nodes in subdomains.

use crate::body::Body;
use crate::tfeti::torn::numbering::Numbering;

/// First torn dofs of the copies of every node of a body, by ascending subdomain, with their stiffnesses.
#[derive(Debug)]
pub struct Copies {
    starts: Vec<u32>,
    dofs: Vec<usize>,
    /// Of copies that are not the only one: what their subdomain resists motions of the node with, roughly, N/mm.
    stiffness: Vec<f64>,
}

impl Copies {
    /// The copies of the nodes of a body.
    pub fn new(number: usize, body: &Body, numbering: &Numbering) -> Self {
        let mut pieces: Vec<(usize, usize)> =
            (0..body.pieces.len()).map(|piece| (numbering.number(number, piece), piece)).collect();
        pieces.sort_unstable();
        let mut starts = vec![0_u32; body.mesh.node_count() + 1];
        let nodes = || pieces.iter().flat_map(|&(_, piece)| body.pieces[piece].nodes.iter());
        nodes().for_each(|&node| starts[node as usize + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        let (mut next, mut dofs) = (starts.clone(), vec![0; starts[starts.len() - 1] as usize]);
        let mut stiffness = vec![0.0; dofs.len()];
        let is_shared = |node: &u32| starts[*node as usize + 1] - starts[*node as usize] > 1;
        for &(subdomain, piece) in &pieces {
            let piece = &body.pieces[piece];
            for &cell in &piece.cells {
                let (cell, nodes) = (cell as usize, body.mesh.cell(cell as usize).nodes);
                if nodes.iter().any(is_shared) {
                    let own = body.mesh.cell_nodes(cell, body.mesh.nodes()).node_stiffness();
                    let modulus = body.solid.material(cell).shear_modulus();
                    nodes
                        .iter()
                        .zip(own)
                        .for_each(|(&node, own)| stiffness[next[node as usize] as usize] += modulus * own);
                }
            }
            for (local, &node) in piece.nodes.iter().enumerate() {
                dofs[next[node as usize] as usize] = numbering.starts()[subdomain] + 3 * local;
                next[node as usize] += 1;
            }
        }
        Self { starts, dofs, stiffness }
    }

    /// Stiffnesses of the copies of a node.
    pub fn stiffness_of(&self, node: u32) -> &[f64] {
        let node = node as usize;
        &self.stiffness[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// First torn dofs of the copies of a node.
    pub fn of(&self, node: u32) -> &[usize] {
        let node = node as usize;
        &self.dofs[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}
