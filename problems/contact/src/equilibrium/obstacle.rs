//! A rigid obstacle opposite to a slave face: nearest points, and the areas of the facets of the face.

use crate::body::elasticity::facet::tributary_areas;
use crate::equilibrium::contact_point::ContactPoint;
use crate::equilibrium::node_rows::dot;
use crate::equilibrium::numbers::{Numbers, Placed};
use crate::equilibrium::opposite::{Facing, Moves, Nodes, Opposite};
use crate::error::ContactError;
use crate::scalar::{Dual, Scalar};
use crate::scene::{AreaKind, CounterSurface, NormalKind};
use crate::shape::{Positions, Velocities};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A rigid obstacle, and the face that meets it.
#[derive(Debug, Clone)]
pub(crate) struct Obstacle {
    pub surface: CounterSurface,
    pub normal: NormalKind,
    pub face: SlaveFace,
}

/// The slave face as far as its areas are concerned.
#[derive(Debug, Clone)]
pub(crate) struct SlaveFace {
    pub body: usize,
    /// The nodes of every facet.
    pub facets: Arc<[Vec<u32>]>,
    pub area: AreaKind,
    /// Whether areas change with the shape.
    pub areas_change: bool,
}

/// An obstacle at one shape.
#[derive(Debug)]
struct ObstacleAt {
    face: SlaveFace,
    positions: Arc<Vec<[f64; 3]>>,
    /// By contact node.
    slopes: Vec<Slopes>,
}

/// Slopes of gap and normal by the place of a contact node.
#[derive(Debug, Clone, Copy)]
struct Slopes {
    gap: [f64; 3],
    normal: [[f64; 3]; 3],
}

impl Opposite for Obstacle {
    fn at(
        &self,
        points: &[ContactPoint],
        positions: &Positions,
    ) -> Result<(Vec<Placed>, Arc<dyn Facing>), ContactError> {
        let positions = Arc::clone(&positions[self.face.body]);
        let areas = self.face.areas(&positions);
        let (mut placed, mut slopes) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for point in points {
            let x = positions[point.node as usize];
            let foot = match self.normal {
                NormalKind::X3 => self.surface.foot_along_x3(x),
                NormalKind::Surface => self.surface.foot(x).map_err(|reason| ContactError::NoFoot {
                    node: point.node,
                    place: x,
                    reason,
                })?,
            };
            let area = areas.get(&point.node).copied().unwrap_or(0.0);
            let numbers = Numbers { normal: foot.normal, gap: foot.gap, area, weights: vec![1.0] };
            placed.push(Placed { numbers, is_covered: true });
            slopes.push(Slopes { gap: foot.gap_slope, normal: foot.normal_slope });
        }
        Ok((placed, Arc::new(ObstacleAt { face: self.face.clone(), positions, slopes })))
    }

    fn is_fixed(&self) -> bool {
        let plane = matches!(self.surface, CounterSurface::Plane { .. } | CounterSurface::TiltedPlane { .. });
        self.normal == NormalKind::X3 || plane
    }

    fn areas_change(&self) -> bool {
        self.face.areas_change
    }

    fn normal_at(&self, x: [f64; 3]) -> Option<[f64; 3]> {
        let normal = match self.normal {
            NormalKind::Surface => self.surface.foot(x).ok()?.normal,
            NormalKind::X3 => {
                let slope = self.surface.foot_along_x3(x).gap_slope;
                let length = slope.iter().map(|x| x * x).sum::<f64>().sqrt();
                slope.map(|x| -x / length)
            }
        };
        normal.iter().all(|x| x.is_finite()).then_some(normal)
    }
}

impl SlaveFace {
    /// Tributary areas by node.
    fn areas(&self, positions: &[[f64; 3]]) -> BTreeMap<u32, f64> {
        let mut areas = BTreeMap::new();
        for nodes in &*self.facets {
            let x: Vec<[f64; 3]> = nodes.iter().map(|&node| positions[node as usize]).collect();
            let own = tributary_areas(&x, self.area);
            nodes.iter().zip(own).for_each(|(node, area)| *areas.entry(*node).or_insert(0.0) += area);
        }
        areas
    }

    /// Their changes.
    fn area_changes(&self, positions: &[[f64; 3]], velocity: impl Fn(u32) -> [f64; 3]) -> BTreeMap<u32, f64> {
        let mut changes = BTreeMap::new();
        let dual = |&node: &u32| {
            let (x, v) = (positions[node as usize], velocity(node));
            std::array::from_fn(|axis| Dual::new(x[axis], v[axis]))
        };
        for nodes in self.facets.iter().filter(|_| self.areas_change) {
            let own = tributary_areas(&nodes.iter().map(dual).collect::<Vec<[Dual; 3]>>(), self.area);
            nodes.iter().zip(own).for_each(|(node, area)| *changes.entry(*node).or_insert(0.0) += area.derivative);
        }
        changes
    }

    /// Adds sensitivities by areas to those of the nodes that move.
    fn pull_back_areas(
        &self,
        positions: &[[f64; 3]],
        by_area: &BTreeMap<u32, f64>,
        moves: impl Fn(u32) -> bool,
        mut add: impl FnMut(u32, [f64; 3]),
    ) {
        let weight = |node: &u32| by_area.get(node).copied().unwrap_or(0.0);
        for nodes in self.facets.iter().filter(|nodes| nodes.iter().any(|node| weight(node) != 0.0)) {
            let mut x: Vec<[Dual; 3]> =
                nodes.iter().map(|&node| positions[node as usize].map(Dual::constant)).collect();
            for index in (0..nodes.len()).filter(|&index| moves(nodes[index])) {
                let mut sensitivity = [0.0; 3];
                for (axis, sum) in sensitivity.iter_mut().enumerate() {
                    x[index][axis].derivative = 1.0;
                    let areas = tributary_areas(&x, self.area);
                    *sum = nodes.iter().zip(areas).map(|(node, area)| weight(node) * area.derivative).sum();
                    x[index][axis].derivative = 0.0;
                }
                add(nodes[index], sensitivity);
            }
        }
    }
}

impl Facing for ObstacleAt {
    fn changes(&self, (points, _): Nodes<'_>, velocities: &Velocities<'_>, column: usize) -> Vec<Numbers> {
        let body = self.face.body;
        let areas = self.face.area_changes(&self.positions, |node| velocities.at(body, node, column));
        let of_node = |(point, slopes): (&ContactPoint, &Slopes)| {
            let velocity = velocities.at(body, point.node, column);
            Numbers {
                normal: slopes.normal.map(|row| dot(row, velocity)),
                gap: dot(slopes.gap, velocity),
                area: areas.get(&point.node).copied().unwrap_or(0.0),
                weights: Vec::new(),
            }
        };
        points.iter().zip(&self.slopes).map(of_node).collect()
    }

    fn pull_back(
        &self,
        (points, _): Nodes<'_>,
        sensitivities: &[Numbers],
        moves: Moves<'_>,
        add: &mut dyn FnMut(usize, u32, [f64; 3]),
    ) {
        let body = self.face.body;
        for ((point, slopes), own) in points.iter().zip(&self.slopes).zip(sensitivities) {
            let through_normal = |j: usize| (0..3).map(|i| own.normal[i] * slopes.normal[i][j]).sum::<f64>();
            add(body, point.node, std::array::from_fn(|j| own.gap * slopes.gap[j] + through_normal(j)));
        }
        if self.face.areas_change {
            let by_area = points.iter().zip(sensitivities).map(|(point, own)| (point.node, own.area)).collect();
            let moves = |node: u32| moves(body, node);
            self.face.pull_back_areas(&self.positions, &by_area, moves, |node, own| add(body, node, own));
        }
    }
}
