//! Facets of a surface mesh and the part of the mesh they need.

use super::curve::{Curve, NODES, QuadraticFacet, Remainder};

/// Three or four corner nodes, counterclockwise seen from outside the own body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Facet {
    corners: [u32; 4],
    count: u8,
}

impl Facet {
    /// A facet with three or four corners; `None` for other numbers.
    pub fn new(corners: &[u32]) -> Option<Self> {
        match *corners {
            [a, b, c] => Some(Self { corners: [a, b, c, c], count: 3 }),
            [a, b, c, d] => Some(Self { corners: [a, b, c, d], count: 4 }),
            _ => None,
        }
    }

    pub fn corners(&self) -> &[u32] {
        &self.corners[..usize::from(self.count)]
    }
}

/// A surface: its facets, and the positions of all nodes of the mesh.
#[derive(Debug, Clone, Copy)]
pub struct Face<'a> {
    pub facets: &'a [Facet],
    pub positions: &'a [[f64; 3]],
    /// Middles of the edges, whose positions follow those of the nodes; one per facet, or none for flat facets.
    pub quadratic_facets: &'a [QuadraticFacet],
}

/// A facet of second degree in the numbers of a [`Patch`]: corners, then middles.
#[derive(Debug, Clone, Copy)]
pub struct LocalQuadratic {
    pub nodes: [usize; NODES],
    remainder: Option<Remainder>,
}

/// A facet in the numbers of a [`Patch`].
#[derive(Debug, Clone, Copy)]
pub struct Local {
    corners: [usize; 4],
    count: usize,
}

impl Local {
    pub fn corners(&self) -> &[usize] {
        &self.corners[..self.count]
    }

    /// The corners; the third twice in a triangle.
    pub fn pick_numbers(&self) -> [usize; 4] {
        self.corners
    }

    /// Values at the corners; the missing fourth corner of a triangle gets the value of the third.
    pub fn pick<T: Copy>(&self, values: &[T]) -> [T; 4] {
        self.corners.map(|corner| values[corner])
    }
}

/// A surface with nodes numbered from zero.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Nodes of the mesh, ascending.
    pub nodes: Vec<u32>,
    /// Middles of edges, ascending; none for flat facets.
    pub middles: Vec<u32>,
    /// Positions of the nodes, then of the middles.
    pub positions: Vec<[f64; 3]>,
    pub facets: Vec<Local>,
    /// One per facet; none for flat facets.
    pub quadratic_facets: Vec<LocalQuadratic>,
}

impl Patch {
    pub fn new(face: Face<'_>) -> Self {
        let mut nodes: Vec<u32> = face.facets.iter().flat_map(|facet| facet.corners().iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |node: u32| nodes.partition_point(|&other| other < node);
        let local = |facet: &Facet| Local { corners: facet.corners.map(number), count: facet.corners().len() };
        let facets: Vec<Local> = face.facets.iter().map(local).collect();
        let used =
            |(facet, quadratic): (&Facet, &QuadraticFacet)| quadratic.middles.into_iter().take(facet.corners().len());
        let mut middles: Vec<u32> = face.facets.iter().zip(face.quadratic_facets).flat_map(used).collect();
        middles.sort_unstable();
        middles.dedup();
        let middle = |number: u32| nodes.len() + middles.partition_point(|&other| other < number);
        let quadratic_facets = facets.iter().zip(face.quadratic_facets).map(|(facet, quadratic)| {
            let own = |k: usize| match k.checked_sub(4) {
                None => facet.corners[k],
                Some(edge) => middle(quadratic.middles[edge.min(facet.count - 1)]),
            };
            LocalQuadratic { nodes: std::array::from_fn(own), remainder: quadratic.remainder }
        });
        let quadratic_facets = quadratic_facets.collect();
        let positions = nodes.iter().chain(&middles).map(|&node| face.positions[node as usize]).collect();
        Self { nodes, middles, positions, facets, quadratic_facets }
    }

    /// Nodes and middles in the order of the positions.
    pub fn points(&self) -> impl Iterator<Item = u32> + '_ {
        self.nodes.iter().chain(&self.middles).copied()
    }

    /// A facet of second degree; none where facets are flat.
    pub fn curve(&self, facet: usize) -> Option<Curve> {
        let quadratic = self.quadratic_facets.get(facet)?;
        let nodes = quadratic.nodes.map(|node| self.positions[node]);
        Some(Curve { count: self.count(facet), nodes, remainder: quadratic.remainder })
    }

    /// The facets in the opposite sense, so that seen from the opposite surface they are counterclockwise.
    pub fn reversed(mut self) -> Self {
        for facet in &mut self.facets {
            let [a, b, c, d] = facet.corners;
            facet.corners = if facet.count == 4 { [a, d, c, b] } else { [a, c, b, b] };
        }
        for (quadratic, facet) in self.quadratic_facets.iter_mut().zip(&self.facets) {
            let order = if facet.count == 4 { [0, 3, 2, 1, 7, 6, 5, 4] } else { [0, 2, 1, 1, 6, 5, 4, 4] };
            quadratic.nodes = order.map(|k| quadratic.nodes[k]);
            if let Some(remainder) = &mut quadratic.remainder {
                remainder.start = order.map(|k| remainder.start[k]);
            }
        }
        self
    }

    /// Positions of the corners of a facet; see [`Local::pick`].
    pub fn corners(&self, facet: usize) -> [[f64; 3]; 4] {
        self.facets[facet].pick(&self.positions)
    }

    pub fn count(&self, facet: usize) -> usize {
        self.facets[facet].count
    }
}
