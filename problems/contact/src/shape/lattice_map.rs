//! x₀ and N of a lattice: where the nodes of a body lie in it, and what moves them.

use crate::body::mesh::{Mesh, bounding_box};
use crate::error::SceneError;
use crate::names::{find_face, nodes_of};
use crate::patches::MiddlePoint;
use crate::scene::Block;
use crate::shape::BodyMap;
use crate::shape::bspline::Basis;
use crate::shape::coordinates::{AXES, Coordinates, Place, combine, dot, length, unit};
use crate::shape::lattice::{Directions, LatticeShape, Movers, ShapedFace};
use std::collections::{BTreeMap, BTreeSet, HashMap};

impl LatticeShape {
    /// The map of a body with this mesh, of a block where it is one; `held`: orthonormal directions in which supports
    /// hold a node.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for names that the mesh does not have, and for a lattice that holds no node that may
    /// move.
    pub(crate) fn map<'b>(
        &self,
        (mesh, block): (&Mesh, Option<&Block>),
        points: &[MiddlePoint],
        held: impl Fn(u32) -> &'b [[f64; 3]],
    ) -> Result<BodyMap, SceneError> {
        let (bases, movers) = (self.bases()?, self.movers());
        let region = self.region_nodes(mesh)?;
        let mut fixed = BTreeSet::new();
        for name in &self.fixed {
            fixed.extend(nodes_of("lattice.fixed", name, mesh)?);
        }
        let normals = match &self.directions {
            Directions::Axes(_) => None,
            Directions::Normal(face) => {
                let faces = find_face("lattice.normal", face, mesh)?;
                Some(crate::body::nodal_normals(mesh, mesh.nodes(), faces))
            }
        };
        let (mut rows, mut moved) = (Vec::with_capacity(3 * mesh.node_count()), 0);
        // A middle is fixed, or in the region, where both ends of its edge are.
        let row = |x: [f64; 3], ends: &[u32], held: &[[f64; 3]]| {
            let is_in = |set: &BTreeSet<u32>| ends.iter().all(|end| set.contains(end));
            let free = !is_in(&fixed) && region.as_ref().is_none_or(is_in);
            let place = self.place(x, ends, block).filter(|_| free);
            let directions = match (&normals, place) {
                (_, None) => None,
                (None, Some((_, frame))) => Some(frame.to_vec()),
                (Some(normals), Some(_)) => mean_normal(ends.iter().map(|end| normals.get(end))).map(|n| vec![n]),
            };
            match (place, directions) {
                (Some((xi, _)), Some(directions)) => self.rows(xi, &directions, &bases, &movers, held),
                _ => [vec![], vec![], vec![]],
            }
        };
        for node in 0..mesh.node_count() as u32 {
            let row = row(mesh.nodes()[node as usize], &[node], held(node));
            moved += usize::from(row.iter().any(|row| !row.is_empty()));
            rows.extend(row);
        }
        let at_zero = |(node, x): (usize, &[f64; 3])| self.at_zero(node, *x, block);
        let mut base: Vec<[f64; 3]> = mesh.nodes().iter().enumerate().map(at_zero).collect();
        for MiddlePoint { ends, place } in points {
            // Facets between heights stay flat: their middles move as the mean of the ends.
            let own = match self.face() {
                Some(_) => mean_rows(&rows, *ends),
                None => row(*place, ends, &common(ends.map(&held))),
            };
            let [a, b] = ends.map(|end| base[end as usize]);
            let is_flat = self.face().is_some() && own.iter().any(|row| !row.is_empty());
            base.push(if is_flat { combine(a, 0.5, b, 0.5) } else { *place });
            rows.extend(own);
        }
        if moved == 0 {
            let [least, most] = bounding_box(mesh.nodes());
            let allowed = format!("a box around nodes that may move; the body lies between {least:?} and {most:?} mm");
            return Err(SceneError::out_of_range("lattice", "a box without such nodes", allowed));
        }
        Ok(BodyMap { base, middles: points.len(), controls: self.control_count(), rows })
    }

    /// Where a node would be for controls 0, from its place at the start. Heights leave the other face alone, without
    /// the rounding of a difference.
    fn at_zero(&self, node: usize, x: [f64; 3], block: Option<&Block>) -> [f64; 3] {
        let (Some(face), Some(block)) = (self.face(), block) else { return x };
        let up = block.grid().share(node)[2];
        let (share, other) = match face {
            ShapedFace::Top => (1.0 - up, &block.bottom),
            ShapedFace::Bottom => (up, &block.top),
        };
        [x[0], x[1], share * other.height(x[0], x[1])]
    }

    /// The place of a node, or of the middle between some.
    fn place(&self, x: [f64; 3], ends: &[u32], block: Option<&Block>) -> Option<Place> {
        let Some(block) = block.filter(|_| self.coordinates == Coordinates::Block) else {
            return self.coordinates.place(x);
        };
        let ends = ends.iter().map(|&end| block.grid().share(end as usize));
        let count = ends.len() as f64;
        let sum = ends.fold([0.0; 3], |sum, place| combine(sum, 1.0, place, 1.0));
        Some((sum.map(|x| x / count), AXES))
    }

    /// The nodes of the region; none where all nodes in the box move.
    fn region_nodes(&self, mesh: &Mesh) -> Result<Option<BTreeSet<u32>>, SceneError> {
        if self.region.is_empty() {
            return Ok(None);
        }
        let mut region = BTreeSet::new();
        for name in &self.region {
            region.extend(nodes_of("lattice.region", name, mesh)?);
        }
        Ok(Some(region))
    }

    /// The rows of N of a node at lattice coordinates ξ, whose control points move along `directions`.
    fn rows(
        &self,
        xi: [f64; 3],
        directions: &[[f64; 3]],
        bases: &[Basis; 3],
        movers: &Movers,
        held: &[[f64; 3]],
    ) -> [Vec<(usize, f64)>; 3] {
        let values: [Vec<f64>; 3] = std::array::from_fn(|axis| bases[axis].values(xi[axis]));
        let (counts, ways, along) = (self.control_points, self.ways(), self.along(directions));
        let mut sums: HashMap<usize, [f64; 3]> = HashMap::new();
        for (i, a) in values[0].iter().enumerate().filter(|(_, a)| **a != 0.0) {
            for (j, b) in values[1].iter().enumerate().filter(|(_, b)| **b != 0.0) {
                for (l, c) in values[2].iter().enumerate().filter(|(_, c)| **c != 0.0) {
                    let point = (i * counts[1] + j) * counts[2] + l;
                    for (&way, &direction) in ways.iter().zip(&along) {
                        for &(control, factor) in movers.get(&(point, way)).into_iter().flatten() {
                            let sum = sums.entry(control).or_default();
                            (0..3).for_each(|axis| sum[axis] += a * b * c * factor * direction[axis]);
                        }
                    }
                }
            }
        }
        let mut rows = [vec![], vec![], vec![]];
        let mut sums: Vec<(usize, [f64; 3])> = sums.into_iter().collect();
        sums.sort_unstable_by_key(|(control, _)| *control);
        for (control, mut sum) in sums {
            for direction in held.iter().filter(|_| self.hold_supports) {
                let share = dot(*direction, sum);
                (0..3).for_each(|axis| sum[axis] -= share * direction[axis]);
            }
            let size = length(sum);
            for axis in (0..3).filter(|&axis| sum[axis].abs() > 1e-14 * size) {
                rows[axis].push((control, sum[axis]));
            }
        }
        rows
    }

    /// Of the directions at a node, those along which control points move.
    fn along(&self, directions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match self.directions {
            Directions::Normal(_) => directions.to_vec(),
            Directions::Axes(_) => self.ways().into_iter().map(|way| directions[way]).collect(),
        }
    }
}

/// The rows of N of the middle between two nodes.
pub(crate) fn mean_rows(rows: &[Vec<(usize, f64)>], ends: [u32; 2]) -> [Vec<(usize, f64)>; 3] {
    std::array::from_fn(|axis| {
        let mut sums = BTreeMap::new();
        let ends = ends.iter().flat_map(|&end| &rows[3 * end as usize + axis]);
        ends.for_each(|&(control, value)| *sums.entry(control).or_insert(0.0) += 0.5 * value);
        sums.into_iter().collect()
    })
}

/// The held directions of the first that the second has too.
fn common([first, second]: [&[[f64; 3]]; 2]) -> Vec<[f64; 3]> {
    let is_held = |direction: &&[f64; 3]| {
        let square: f64 = second.iter().map(|other| dot(**direction, *other).powi(2)).sum();
        (square - 1.0).abs() < 1e-8
    };
    first.iter().filter(is_held).copied().collect()
}

/// The mean of unit normals at length one; none where one is missing.
fn mean_normal<'n>(normals: impl Iterator<Item = Option<&'n [f64; 3]>>) -> Option<[f64; 3]> {
    let all: Vec<[f64; 3]> = normals.map(Option::<&[f64; 3]>::copied).collect::<Option<_>>()?;
    if let [only] = all[..] {
        return Some(only);
    }
    let sum = all.iter().fold([0.0; 3], |sum, normal| combine(sum, 1.0, *normal, 1.0));
    Some(unit(sum))
}
