//! The unknowns of a condensed body: weighted displacements at the corners of its contact faces, in coordinates in
//! which supports hold axes.
//!
//! ```text
//! v:  Q w_j at corners (held components: those of u_j),   Q û_m at middle nodes,   Q u elsewhere
//! u = T v:   u_j = w_j − P_j Σ_m d_jm û_m,   u_m = û_m + ½(u_a + u_b);         v̂ = Tᵀ f of forces,   K̂ = Tᵀ K T
//! ```
//! w, d, P: [`Trace`]. Contact rows see w alone, so that bodies are condensed onto their corners. Where there are no
//! middle nodes, T is the rotation Q of the [`NodalAxes`].

use crate::body::mesh::narrow;
use crate::body::{Body, NodalAxes, Piece, Trace, TraceWeights, lower_pattern};
use crate::direct::congruence::{Block, BlockColumn, transform};
use crate::error::ContactError;
use crate::linear::cholesky::SymbolicFactor;
use crate::linear::symmetric::LowerPattern;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The unknowns of a body, for all its shapes.
#[derive(Debug)]
pub(super) struct Coordinates {
    pub axes: NodalAxes,
    /// The pattern of K̂.
    pub lower: Arc<LowerPattern>,
    /// Where the entries of K are in it; none where the patterns are the same.
    places: Option<Vec<u32>>,
    /// The nodes of the piece, ascending.
    nodes: Vec<u32>,
}

impl Coordinates {
    /// The unknowns of a whole body, with the symbolic factor that eliminates those of `last` nodes at the end.
    ///
    /// # Errors
    /// [`ContactError::Factorization`] when the analysis fails.
    pub fn new(body: &Body, piece: &Piece, last: &[usize]) -> Result<(Self, Arc<SymbolicFactor>), ContactError> {
        let (axes, nodes) = (NodalAxes::new(body, piece), piece.nodes.clone());
        if body.trace.is_empty() {
            let lower = Arc::clone(&piece.pattern.lower);
            return Ok((Self { axes, lower, places: None, nodes }, piece.pattern.symbolic(last)?));
        }
        let graph = coupled(&body.trace, piece);
        let (base, lower) = (&piece.pattern.lower, Arc::new(lower_pattern(&graph)));
        let columns = (0..base.dimension()).flat_map(|column| {
            let rows = base.rows()[base.starts()[column]..base.starts()[column + 1]].iter();
            rows.map(move |&row| (row, column))
        });
        let place = |(row, column)| narrow(lower.position(row, column).expect("invariant: more nodes are coupled"));
        let places = Some(columns.map(place).collect());
        let symbolic = piece.pattern.symbolic_of((&lower, &graph), last)?;
        Ok((Self { axes, lower, places, nodes }, symbolic))
    }

    fn local(&self, node: u32) -> usize {
        self.nodes.binary_search(&node).expect("invariant: nodes of the trace are nodes of the body")
    }

    /// K̂ over [`lower`](Self::lower) from K over the pattern of the piece.
    pub fn matrix(&self, (body, piece): (&Body, &Piece), weights: &TraceWeights, stiffness: Vec<f64>) -> Vec<f64> {
        let mut values = stiffness;
        if let Some(places) = &self.places {
            let mut all = vec![0.0; self.lower.entry_count()];
            places.iter().zip(&values).for_each(|(&place, value)| all[place as usize] = *value);
            values = all;
            let graph = piece.pattern.graph();
            let [ends, middles] = self.columns(&body.trace, weights);
            transform(&mut values, &self.lower, graph, &ends);
            transform(&mut values, &self.lower, graph, &middles);
        }
        self.axes.turn_matrix(&self.lower, &mut values);
        values
    }

    /// E of u_m = û_m + ½(u_a + u_b), and E of u_j = w_j − P_j Σ_m d_jm û_m.
    fn columns(&self, trace: &Trace, weights: &TraceWeights) -> [Vec<BlockColumn>; 2] {
        let mut ends: BTreeMap<usize, Vec<(usize, Block)>> = BTreeMap::new();
        let unit = |axis: usize| -> [f64; 3] { std::array::from_fn(|other| if other == axis { 1.0 } else { 0.0 }) };
        let half = [0, 1, 2].map(|axis| unit(axis).map(|x| 0.5 * x));
        for middle in trace.middles() {
            let place = self.local(middle.node);
            middle.ends.iter().for_each(|&end| ends.entry(self.local(end)).or_default().push((place, half)));
        }
        let mut middles: BTreeMap<usize, Vec<(usize, Block)>> = BTreeMap::new();
        for corner in trace.corners() {
            // P is symmetric: its rows are the images of the axes.
            let projection = [0, 1, 2].map(|axis| trace.projected(corner, unit(axis)));
            for (middle, weight) in trace.terms(weights, corner) {
                let block = projection.map(|row| row.map(|x| -weight * x));
                middles.entry(self.local(middle.node)).or_default().push((self.local(corner), block));
            }
        }
        [ends, middles].map(|columns| columns.into_iter().collect())
    }

    /// Tᵀ f in place.
    pub fn forces(&self, trace: &Trace, weights: &TraceWeights, forces: &mut [f64]) {
        let vectors = forces.as_chunks_mut::<3>().0;
        for middle in trace.middles() {
            let own = vectors[self.local(middle.node)];
            middle.ends.iter().for_each(|&end| add(&mut vectors[self.local(end)], 0.5, own));
        }
        for corner in trace.corners() {
            let own = trace.projected(corner, vectors[self.local(corner)]);
            trace.terms(weights, corner).for_each(|(middle, d)| add(&mut vectors[self.local(middle.node)], -d, own));
        }
        self.axes.turn(forces);
    }

    /// As [`forces`](Self::forces), with 0 at held unknowns.
    pub fn free_forces(&self, trace: &Trace, weights: &TraceWeights, forces: &mut [f64]) {
        self.forces(trace, weights, forces);
        self.hold(forces);
    }

    /// Sets forces on held unknowns, which supports carry, to 0.
    pub fn hold(&self, forces: &mut [f64]) {
        forces.iter_mut().zip(&self.axes.held).filter(|(_, held)| **held).for_each(|(force, _)| *force = 0.0);
    }

    /// u = T v in place, along the axes.
    pub fn displacements(&self, trace: &Trace, weights: &TraceWeights, v: &mut [f64]) {
        self.axes.turn_back(v);
        let vectors = v.as_chunks_mut::<3>().0;
        for corner in trace.corners() {
            let mut sum = [0.0; 3];
            trace.terms(weights, corner).for_each(|(middle, d)| add(&mut sum, -d, vectors[self.local(middle.node)]));
            add(&mut vectors[self.local(corner)], 1.0, trace.projected(corner, sum));
        }
        for middle in trace.middles() {
            let [a, b] = middle.ends.map(|end| vectors[self.local(end)]);
            let own = &mut vectors[self.local(middle.node)];
            add(own, 0.5, a);
            add(own, 0.5, b);
        }
    }

    /// What supports prescribe to held unknowns, mm; 0 at free ones.
    pub fn lift(&self, body: &Body, piece: &Piece) -> Vec<f64> {
        let prescribed = |node: u32| body.prescribed(node);
        self.axes.lift(piece, |node| match body.trace.middle(node) {
            Some(middle) => middle.value(&prescribed),
            None => prescribed(node),
        })
    }
}

/// The neighbours of the nodes of a piece in K̂.
fn coupled(trace: &Trace, piece: &Piece) -> Vec<Vec<u32>> {
    let base = piece.pattern.graph();
    let local = |node: u32| narrow(piece.local(node).expect("invariant: nodes of the trace are nodes of the body"));
    // Per node: the middle nodes whose columns take over its column, and itself.
    let mut taken: Vec<Vec<u32>> = (0..piece.nodes.len() as u32).map(|node| vec![node]).collect();
    for corner in trace.corners() {
        let middles = trace.support(corner).into_iter().filter(|&node| trace.middle(node).is_some());
        taken[local(corner) as usize].extend(middles.map(local));
    }
    let mut graph = base.to_vec();
    for corner in trace.corners() {
        let corner = local(corner) as usize;
        let others = base[corner].iter().copied().chain([corner as u32]);
        let rows: Vec<u32> = others.flat_map(|other| taken[other as usize].iter().copied()).collect();
        for &middle in &taken[corner][1..] {
            graph[middle as usize].extend_from_slice(&rows);
            rows.iter().for_each(|&row| graph[row as usize].push(middle));
        }
    }
    for (node, neighbours) in graph.iter_mut().enumerate() {
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours.retain(|other| *other as usize != node);
    }
    graph
}

fn add(sum: &mut [f64; 3], factor: f64, vector: [f64; 3]) {
    (0..3).for_each(|axis| sum[axis] += factor * vector[axis]);
}
