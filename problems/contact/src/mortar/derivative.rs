//! Derivatives of the mortar weights by the positions of the nodes of both surfaces.
//!
//! ```text
//! A′ = diag(D′) M⁻¹ − A M′ M⁻¹,   W′ = A′ P + A P′,   m′ = (W′ − m D′)/D
//! transposed:  W̄ = m̄/D,  D̄ −= Σ_j m̄_j m_j/D,  P̄ = Aᵀ W̄,  Ā = W̄ Pᵀ,  D̄_i += Σ_k Ā_ik M⁻¹_ik,  M̄ = −Aᵀ Ā M⁻¹
//! ```

use super::cover::{Basis, Cover, Square, add, outer, product, projected, transposed};
use super::curve::NODES;
use super::facet::Patch;
use super::pair::{COLUMNS, GAP, INPUTS, Jacobian, NORMAL, OfNodes, Raw, SYMMETRIC, Wide, jacobian, row_sums};
use super::weights::Mortar;
use super::{Along, normals};
use crate::linear::parallel;

/// Derivatives of a function by the numbers of a node of the slave surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NodeSensitivity {
    pub area: f64,
    /// Aligned with the weights of the node; empty for none.
    pub weights: Vec<f64>,
    pub normal: [f64; 3],
    /// By the gap of facets of second degree.
    pub gap: f64,
}

/// Changes of the numbers of a node of the slave surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NodeChange {
    pub area: f64,
    /// Aligned with the weights of the node.
    pub weights: Vec<f64>,
    pub normal: [f64; 3],
    /// Of the gap of facets of second degree.
    pub gap: f64,
}

/// Changes of D and, per pair, of W.
type FacetChange = ([f64; 4], Vec<Wide<f64>>);

/// Sensitivities to the positions of the nodes of a slave facet and, per pair, of a master facet.
type FacetSensitivity = ([[f64; 3]; NODES], Vec<[[f64; 3]; NODES]>);

/// Sensitivities to D, W, gap and normal of all nodes.
struct Sensitivities {
    areas: Vec<f64>,
    values: Vec<f64>,
    /// By gap and N, in the columns after those of P.
    quadratic: Vec<[f64; COLUMNS]>,
}

impl Mortar {
    /// Derivatives of the integrals of all pairs, computed once.
    fn jacobians(&self) -> &[Vec<Jacobian>] {
        self.jacobians.get_or_init(|| {
            let of_facet = |facet: usize| {
                let Some(cover) = &self.covers[facet] else { return Vec::new() };
                let own = projected(&cover.frame, &self.slave, facet);
                let curve = self.slave.curve(facet);
                let of_pair = |master: usize| {
                    let other = self.master.curve(master);
                    let curves = curve.as_ref().zip(other.as_ref()).map(|(own, other)| [own, other]);
                    jacobian(&own, &projected(&cover.frame, &self.master, master), curves)
                };
                cover.pairs.iter().map(|pair| of_pair(pair.master)).collect()
            };
            parallel::map(self.covers.len(), &of_facet)
        })
    }

    /// Changes along velocities of the nodes: `velocity(side, node)`, side 0 the slave surface, 1 the master surface.
    /// One entry per entry of `nodes`.
    pub fn changes(&self, velocity: &dyn Fn(usize, u32) -> [f64; 3]) -> Vec<NodeChange> {
        let slave: Vec<_> = self.slave.points().map(|node| velocity(0, node)).collect();
        let master: Vec<_> = self.master.points().map(|node| velocity(1, node)).collect();
        let jacobians = self.jacobians();
        let changes: Vec<Option<FacetChange>> = parallel::map(self.covers.len(), &|facet| {
            self.facet_change(facet, self.covers[facet].as_ref()?, &jacobians[facet], [&slave, &master])
        });
        let mut areas = vec![0.0; self.slave.nodes.len()];
        let mut values = vec![0.0; self.places()];
        let mut quadratic = vec![[0.0; COLUMNS]; areas.len()];
        for (facet, cover) in self.covers() {
            let Some((sums, weights)) = &changes[facet] else { continue };
            let corners = self.slave.facets[facet].corners();
            corners.iter().zip(sums).for_each(|(&node, &change)| areas[node] += change);
            for (corner, &node) in corners.iter().enumerate() {
                let own = weights.iter().map(|weights| &weights[corner]);
                own.for_each(|row| (GAP..COLUMNS).for_each(|column| quadratic[node][column] += row[column]));
            }
            self.scatter(facet, cover, |slot, pair, i, j| values[slot] += weights[pair][i][j]);
        }
        let normals = match self.along {
            Along::X3 => vec![[0.0; 3]; areas.len()],
            Along::Normals if self.is_quadratic() => {
                let change = |row: &[f64; COLUMNS]| [row[NORMAL], row[NORMAL + 1], row[NORMAL + 2]];
                self.vector_areas
                    .iter()
                    .zip(&quadratic)
                    .map(|(&area, row)| normals::turned(area, change(row)))
                    .collect()
            }
            Along::Normals => normals::changes(&self.slave, &self.vector_areas, &slave),
        };
        let of_node = |node: usize| NodeChange {
            gap: self.quotient(node, quadratic[node][GAP], areas[node]),
            ..self.divided(node, areas[node], &values, normals[node])
        };
        (0..areas.len()).map(of_node).collect()
    }

    /// Number of weights, those of nodes without coverage included.
    fn places(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// The change of the gap of a node from those of its sum and its area.
    fn quotient(&self, index: usize, change: f64, area: f64) -> f64 {
        let node = &self.nodes[index];
        if node.area > 0.0 { (change - node.gap * area) / node.area } else { 0.0 }
    }

    fn divided(&self, index: usize, area: f64, values: &[f64], normal: [f64; 3]) -> NodeChange {
        let node = &self.nodes[index];
        let places = &values[self.starts[index]..self.starts[index + 1]];
        let quotient = |(&change, &(_, weight)): (&f64, &(u32, f64))| (change - weight * area) / node.area;
        let weights = places.iter().zip(&node.weights).map(quotient).collect();
        NodeChange { area: if node.area > 0.0 { area } else { 0.0 }, weights, normal, gap: 0.0 }
    }

    fn facet_change(
        &self,
        facet: usize,
        cover: &Cover,
        jacobians: &[Jacobian],
        [slave, master]: [&[[f64; 3]]; 2],
    ) -> Option<FacetChange> {
        let basis = cover.basis.as_ref()?;
        let own = of_nodes(&self.slave, facet, slave);
        let others: Vec<_> = cover.pairs.iter().map(|pair| of_nodes(&self.master, pair.master, master)).collect();
        if own.iter().chain(others.iter().flatten()).all(|&velocity| velocity == [0.0; 3]) {
            return None;
        }
        let nodes = own;
        let turning = cover.frame.turning(&own[..self.slave.count(facet)]);
        let planar = |corners: [[f64; 3]; 4], velocities: &[[f64; 3]; NODES]| -> [[f64; 2]; 4] {
            std::array::from_fn(|k| cover.frame.projected_velocity(corners[k], velocities[k], turning))
        };
        let own = planar(self.slave.corners(facet), &own);
        let raw = cover.pairs.iter().zip(&others).zip(jacobians).map(|((pair, velocities), jacobian)| {
            let other = planar(self.master.corners(pair.master), velocities);
            let inputs = std::array::from_fn(|k| if k < 8 { own[k / 2][k % 2] } else { other[k / 2 - 4][k % 2] });
            jacobian.forward(&inputs, &[nodes, *velocities])
        });
        Some(basis.change(cover, &raw.collect::<Vec<_>>()))
    }

    /// Add the derivatives of a function of area, weights and normals by the positions of the nodes that move, given
    /// its derivatives `own` by those numbers (one entry per entry of `nodes`). `moves` and `add` name the nodes by
    /// side: 0 for the slave surface, 1 for the master surface. Each node is added at most once per side: nodes
    /// ascending, then middles.
    pub fn pull_back(
        &self,
        own: &[NodeSensitivity],
        moves: [&(dyn Fn(u32) -> bool + Sync); 2],
        add: &mut dyn FnMut(usize, u32, [f64; 3]),
    ) {
        let sensitivities = self.sensitivities(own);
        let jacobians = self.jacobians();
        let moving = [(&self.slave, moves[0]), (&self.master, moves[1])]
            .map(|(patch, moves)| patch.points().map(moves).collect::<Vec<_>>());
        let parts: Vec<Option<FacetSensitivity>> = parallel::map(self.covers.len(), &|facet| {
            self.facet_sensitivity(facet, self.covers[facet].as_ref()?, &jacobians[facet], &sensitivities, &moving)
        });
        let mut sums = [&self.slave, &self.master].map(|patch| vec![[0.0; 3]; patch.positions.len()]);
        if self.along == Along::Normals && !self.is_quadratic() {
            let normals: Vec<_> = own.iter().map(|node| node.normal).collect();
            normals::pull_back(&self.slave, &self.vector_areas, &normals, &mut sums[0]);
        }
        for (facet, cover) in self.covers() {
            let Some((slave, masters)) = &parts[facet] else { continue };
            accumulate(&mut sums[0], (&self.slave, facet), slave);
            for (pair, master) in cover.pairs.iter().zip(masters) {
                accumulate(&mut sums[1], (&self.master, pair.master), master);
            }
        }
        for (side, patch) in [&self.slave, &self.master].into_iter().enumerate() {
            let nodes = patch.points().zip(&sums[side]).zip(&moving[side]);
            nodes.filter(|&(_, &moves)| moves).for_each(|((node, &sum), _)| add(side, node, sum));
        }
    }

    /// Sensitivities to D of all nodes and to W at all places.
    fn sensitivities(&self, own: &[NodeSensitivity]) -> Sensitivities {
        let mut quadratic = vec![[0.0; COLUMNS]; self.nodes.len()];
        let mut areas = vec![0.0; self.nodes.len()];
        let mut values = vec![0.0; self.places()];
        for (index, (node, given)) in self.nodes.iter().zip(own).enumerate().filter(|(_, (node, _))| node.area > 0.0) {
            areas[index] = given.area;
            if self.is_quadratic() {
                areas[index] -= given.gap * node.gap / node.area;
                quadratic[index][GAP] = given.gap / node.area;
                let normal = normals::turned(self.vector_areas[index], given.normal);
                quadratic[index][NORMAL..].copy_from_slice(&normal);
            }
            let places = &mut values[self.starts[index]..];
            for ((place, &(_, weight)), &factor) in places.iter_mut().zip(&node.weights).zip(&given.weights) {
                *place = factor / node.area;
                areas[index] -= factor * weight / node.area;
            }
        }
        Sensitivities { areas, values, quadratic }
    }

    fn facet_sensitivity(
        &self,
        facet: usize,
        cover: &Cover,
        jacobians: &[Jacobian],
        sensitivities: &Sensitivities,
        moving: &[Vec<bool>; 2],
    ) -> Option<FacetSensitivity> {
        let basis = cover.basis.as_ref()?;
        let any = |side: usize, patch: &Patch, facet: usize| {
            let middles = patch.quadratic_facets.get(facet).map_or(&[][..], |quadratic| &quadratic.nodes);
            patch.facets[facet].corners().iter().chain(middles).any(|&node| moving[side][node])
        };
        let own_moves = any(0, &self.slave, facet);
        let moves = |master: usize| own_moves || any(1, &self.master, master);
        if !cover.pairs.iter().any(|pair| moves(pair.master)) {
            return None;
        }
        let mut weights = vec![[[0.0; COLUMNS]; 4]; cover.pairs.len()];
        let mut sums = [0.0; 4];
        for (corner, &node) in self.slave.facets[facet].corners().iter().enumerate() {
            sums[corner] = sensitivities.areas[node];
            weights.iter_mut().for_each(|weights| weights[corner] = sensitivities.quadratic[node]);
        }
        self.scatter(facet, cover, |slot, pair, i, j| weights[pair][i][j] = sensitivities.values[slot]);
        let (own, mixed) = basis.pull_back(cover, sums, &weights);
        let (slave, mut turning) = (self.slave.corners(facet), [0.0; 2]);
        let (mut own_part, mut parts) = ([[0.0; 3]; NODES], vec![[[0.0; 3]; NODES]; cover.pairs.len()]);
        for (number, pair) in cover.pairs.iter().enumerate().filter(|(_, pair)| moves(pair.master)) {
            let (planar, spatial): (_, OfNodes) = jacobians[number].backward(&Raw { own, mixed: mixed[number] });
            let master = self.master.corners(pair.master);
            for corner in 0..INPUTS / 4 {
                let at = |k: usize| [planar[2 * k], planar[2 * k + 1]];
                let by_slave = cover.frame.lifted(slave[corner], at(corner), &mut turning);
                (0..3).for_each(|axis| own_part[corner][axis] += by_slave[axis]);
                parts[number][corner] = cover.frame.lifted(master[corner], at(4 + corner), &mut turning);
            }
            for (sum, part) in own_part.iter_mut().chain(&mut parts[number]).zip(spatial.iter().flatten()) {
                (0..3).for_each(|axis| sum[axis] += part[axis]);
            }
        }
        cover.frame.turned_back(turning, &mut own_part);
        Some((own_part, parts))
    }
}

/// Add what belongs to the nodes of a facet; those of a missing corner or middle have none.
fn accumulate(sums: &mut [[f64; 3]], (patch, facet): (&Patch, usize), parts: &[[f64; 3]; NODES]) {
    let count = patch.count(facet);
    let mut add = |node: usize, part: &[f64; 3]| (0..3).for_each(|axis| sums[node][axis] += part[axis]);
    patch.facets[facet].corners().iter().zip(parts).for_each(|(&corner, part)| add(corner, part));
    if let Some(quadratic) = patch.quadratic_facets.get(facet) {
        (4..4 + count).for_each(|middle| add(quadratic.nodes[middle], &parts[middle]));
    }
}

/// Values at the corners and, for facets of second degree, at the middles of a facet.
fn of_nodes(patch: &Patch, facet: usize, values: &[[f64; 3]]) -> [[f64; 3]; NODES] {
    match patch.quadratic_facets.get(facet) {
        Some(quadratic) => quadratic.nodes.map(|node| values[node]),
        None => {
            let corners = patch.facets[facet].pick(values);
            std::array::from_fn(|node| corners.get(node).copied().unwrap_or([0.0; 3]))
        }
    }
}

impl Basis {
    /// Changes of D and W for changes of the integrals of the pairs.
    fn change(&self, cover: &Cover, raw: &[Raw<f64>]) -> FacetChange {
        let mut matrix = [[0.0; 4]; 4];
        raw.iter().for_each(|raw| add(&mut matrix, &raw.matrix()));
        let sums = row_sums(&matrix);
        let by_matrix = product(&product(&self.dual, &matrix), &self.inverse);
        let dual: Square =
            std::array::from_fn(|i| std::array::from_fn(|k| sums[i] * self.inverse[i][k] - by_matrix[i][k]));
        let weights = cover.pairs.iter().zip(raw).map(|(pair, raw)| {
            let mut change = product(&dual, &pair.mixed);
            add(&mut change, &product(&self.dual, &raw.mixed));
            change
        });
        (sums, weights.collect())
    }

    /// Transpose of [`Self::change`]: sensitivities to M (packed, the same for all pairs) and to P of each pair.
    fn pull_back(&self, cover: &Cover, mut sums: [f64; 4], weights: &[Wide<f64>]) -> ([f64; 10], Vec<Wide<f64>>) {
        let transposed_dual = transposed(&self.dual);
        let mut dual = [[0.0; 4]; 4];
        for (pair, weights) in cover.pairs.iter().zip(weights) {
            add(&mut dual, &outer(weights, &pair.mixed));
        }
        for (i, sum) in sums.iter_mut().enumerate() {
            *sum += dual[i].iter().zip(&self.inverse[i]).map(|(a, b)| a * b).sum::<f64>();
        }
        let by_dual = product(&product(&transposed_dual, &dual), &self.inverse);
        let matrix = |k: usize, l: usize| sums[k] - by_dual[k][l];
        let packed = SYMMETRIC.map(|[k, l]| if k == l { matrix(k, l) } else { matrix(k, l) + matrix(l, k) });
        (packed, weights.iter().map(|weights| product(&transposed_dual, weights)).collect())
    }
}
