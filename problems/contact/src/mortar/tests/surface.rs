//! Surfaces for the tests.

use super::super::{Along, Face, Facet, Mortar, NO_MIDDLE, Primitive, QuadraticFacet, Remainder};
use std::collections::BTreeMap;

/// A surface that owns its mesh.
#[derive(Debug, Clone)]
pub struct Surface {
    pub facets: Vec<Facet>,
    /// Of nodes, then of middles of edges.
    pub positions: Vec<[f64; 3]>,
    pub quadratic_facets: Vec<QuadraticFacet>,
}

/// A number in (−1, 1) that looks random.
pub fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898 + 4.1414).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

impl Surface {
    /// nx by ny quadrilaterals over [x0, x1] × [y0, y1] at the height z, seen from above (+1) or below (−1).
    pub fn grid([nx, ny]: [usize; 2], [x0, x1, y0, y1]: [f64; 4], z: f64, up: bool) -> Self {
        let mut positions = Vec::new();
        for j in 0..=ny {
            for i in 0..=nx {
                let (s, t) = (i as f64 / nx as f64, j as f64 / ny as f64);
                positions.push([x0 + (x1 - x0) * s, y0 + (y1 - y0) * t, z]);
            }
        }
        let node = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
        let mut facets = Vec::new();
        for j in 0..ny {
            for i in 0..nx {
                let ring = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
                let ring = if up { ring } else { [ring[0], ring[3], ring[2], ring[1]] };
                facets.push(Facet::new(&ring).expect("four corners"));
            }
        }
        Self { facets, positions, quadratic_facets: Vec::new() }
    }

    pub fn unit(n: usize, z: f64, up: bool) -> Self {
        Self::grid([n, n], [0.0, 1.0, 0.0, 1.0], z, up)
    }

    /// Every quadrilateral becomes two triangles.
    pub fn triangles(mut self) -> Self {
        let halves = |facet: &Facet| match *facet.corners() {
            [a, b, c, d] => vec![[a, b, c], [c, d, a]],
            _ => Vec::new(),
        };
        let facets = self.facets.iter().flat_map(halves);
        self.facets = facets.filter_map(|corners| Facet::new(&corners)).collect();
        self
    }

    pub fn moved(mut self, map: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Self {
        self.positions = self.positions.iter().enumerate().map(|(k, &x)| map(k, x)).collect();
        self
    }

    /// Nodes inside the unit square move in the plane by up to `size`.
    pub fn distorted(self, size: f64, seed: usize) -> Self {
        let inside = |s: f64| s > 1e-9 && s < 1.0 - 1e-9;
        self.moved(|k, [x, y, z]| match inside(x) && inside(y) {
            true => [x + size * noise(seed + 2 * k), y + size * noise(seed + 2 * k + 1), z],
            false => [x, y, z],
        })
    }

    /// All coordinates move by up to `size`.
    pub fn shaken(self, size: f64, seed: usize) -> Self {
        self.moved(|k, x| std::array::from_fn(|c| x[c] + size * noise(seed + 3 * k + c)))
    }

    /// Rotate about an axis through the origin, then shift.
    pub fn turned(self, axis: [f64; 3], angle: f64) -> Self {
        let size = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        let u = axis.map(|c| c / size);
        let (s, c) = angle.sin_cos();
        self.moved(|_, x| {
            let along = (0..3).map(|k| u[k] * x[k]).sum::<f64>();
            let across = [u[1] * x[2] - u[2] * x[1], u[2] * x[0] - u[0] * x[2], u[0] * x[1] - u[1] * x[0]];
            std::array::from_fn(|k| c * x[k] + s * across[k] + (1.0 - c) * along * u[k])
        })
    }

    /// Seen from the other side.
    pub fn flipped(mut self) -> Self {
        let reversed = |facet: &Facet| facet.corners().iter().rev().copied().collect::<Vec<_>>();
        self.facets = self.facets.iter().filter_map(|facet| Facet::new(&reversed(facet))).collect();
        self
    }

    pub fn shifted(self, by: [f64; 3]) -> Self {
        self.moved(|_, x| std::array::from_fn(|c| x[c] + by[c]))
    }

    /// Facets of second degree whose middles lie off their chords by up to `size`, with a primitive or without.
    pub fn curved(mut self, size: f64, seed: usize, primitive: Option<Primitive>) -> Self {
        let mut known: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for facet in self.facets.clone() {
            let corners = facet.corners();
            let (mut middles, mut start) = ([NO_MIDDLE; 4], [[0.0; 3]; 8]);
            for (edge, &a) in corners.iter().enumerate() {
                let b = corners[(edge + 1) % corners.len()];
                let [x, y] = [a, b].map(|node| self.positions[node as usize]);
                middles[edge] = *known.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let k = self.positions.len();
                    let off = |c: usize| size * noise(seed + 3 * k + c);
                    self.positions.push(std::array::from_fn(|c| 0.5 * (x[c] + y[c]) + off(c)));
                    k as u32
                });
                start[edge] = x;
                start[4 + edge] = self.positions[middles[edge] as usize];
            }
            self.quadratic_facets
                .push(QuadraticFacet { middles, remainder: primitive.map(|primitive| Remainder { primitive, start }) });
        }
        self
    }

    /// Both surfaces in one.
    pub fn joined(mut self, other: Self) -> Self {
        let first = self.positions.len() as u32;
        let renumbered = |facet: Facet| {
            let corners: Vec<u32> = facet.corners().iter().map(|corner| corner + first).collect();
            Facet::new(&corners).expect("as many corners")
        };
        self.facets.extend(other.facets.into_iter().map(renumbered));
        self.positions.extend(other.positions);
        self
    }

    pub fn face(&self) -> Face<'_> {
        Face { facets: &self.facets, positions: &self.positions, quadratic_facets: &self.quadratic_facets }
    }
}

pub fn mortar(slave: &Surface, master: &Surface, along: Along) -> Mortar {
    Mortar::new(slave.face(), master.face(), along)
}

/// The largest |Σ_j m_ij − 1| of the nodes with weights.
pub fn row_error(mortar: &Mortar) -> f64 {
    let rows = mortar.nodes.iter().filter(|node| !node.weights.is_empty());
    rows.map(|node| (node.weights.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs()).fold(0.0, f64::max)
}

/// The largest |Σ_j m_ij x_j − x_i| in the plane of x₁ and x₂.
pub fn linear_error(mortar: &Mortar, slave: &Surface, master: &Surface) -> f64 {
    let mut worst = 0.0_f64;
    for node in &mortar.nodes {
        for axis in 0..2 {
            let sum: f64 = node.weights.iter().map(|&(j, w)| w * master.positions[j as usize][axis]).sum();
            worst = worst.max((sum - slave.positions[node.node as usize][axis]).abs());
        }
    }
    worst
}

pub fn finite(mortar: &Mortar) -> bool {
    mortar.nodes.iter().all(|node| {
        let numbers = node.normal.iter().chain([&node.area, &node.covered]);
        numbers.chain(node.weights.iter().map(|(_, w)| w)).all(|number| number.is_finite())
    })
}
