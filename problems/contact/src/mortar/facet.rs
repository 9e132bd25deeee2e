//! Facets of a surface mesh and the part of the mesh they need.

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
    pub positions: Vec<[f64; 3]>,
    pub facets: Vec<Local>,
}

impl Patch {
    pub fn new(face: Face<'_>) -> Self {
        let mut nodes: Vec<u32> = face.facets.iter().flat_map(|facet| facet.corners().iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let number = |node: u32| nodes.partition_point(|&other| other < node);
        let local = |facet: &Facet| Local { corners: facet.corners.map(number), count: facet.corners().len() };
        let facets = face.facets.iter().map(local).collect();
        let positions = nodes.iter().map(|&node| face.positions[node as usize]).collect();
        Self { nodes, positions, facets }
    }

    /// The facets in the opposite sense, so that seen from the opposite surface they are counterclockwise.
    pub fn reversed(mut self) -> Self {
        for facet in &mut self.facets {
            let [a, b, c, d] = facet.corners;
            facet.corners = if facet.count == 4 { [a, d, c, b] } else { [a, c, b, b] };
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
