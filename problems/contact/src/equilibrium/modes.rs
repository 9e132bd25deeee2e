//! Rigid body motions of the whole scene: what supports leave free, what contact must carry, what nothing holds.
//!
//! ```text
//! equilibrium needs   Zᵀ (f − Bᵀλ) = 0   for the motions Z that supports leave free, with λ in the friction cone
//! ```
//! A load outside that cone has no equilibrium and is refused before any iteration; a motion that neither supports nor
//! closed contact restrains, and that the load does not drive, is grounded (its resultant is zero).

use crate::body::{MOTIONS, rigid_motions};
use crate::equilibrium::ContactBoundary;
use crate::error::ContactError;
use nalgebra::{DMatrix, DVector};

/// Part of a motion's restraint that others do not share, relative to the restraint, that counts as zero.
const FREE: f64 = 1e-11;

/// Restraint of a motion, relative to a unit in every row, that counts as rounding.
const UNHELD: f64 = 1e-13;

/// Relative resultant that counts as zero.
const UNLOADED: f64 = 1e-9;

/// Rounding of a resultant relative to the load.
const ROUNDING: f64 = 1e-15;

/// Times the load or the forces of the fit that the forces which balance a load may sum up to.
const MARGIN: f64 = 10.0;

/// What the rotations of a body refer to.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// Centre: among the held nodes.
    pub centre: [f64; 3],
    /// Length that scales the rotations, mm.
    pub length: f64,
}

impl Frame {
    /// The frame of a body by its held nodes and all its nodes: the mean of the first ones, or of all where none is
    /// held; the largest distance along an axis, so that no motion moves a node by more than one.
    pub(crate) fn new(held: &[[f64; 3]], nodes: &[[f64; 3]]) -> Self {
        let points = if held.is_empty() { nodes } else { held };
        let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
        let centre: [f64; 3] = std::array::from_fn(mean);
        let distances = nodes.iter().flat_map(|point| (0..3).map(move |axis| (point[axis] - centre[axis]).abs()));
        Self { centre, length: distances.fold(0.0, f64::max) }
    }

    /// Displacement of the six motions at a point.
    pub(crate) fn motions(&self, point: [f64; 3]) -> [[f64; 3]; MOTIONS] {
        rigid_motions(point, self.centre, self.length)
    }
}

/// A part of a contact row: body, point in mm, direction times weight.
pub type RowPart = (usize, [f64; 3], [f64; 3]);

/// What the analysis needs to know of a scene's geometry.
#[derive(Debug, Clone)]
pub struct RigidScene {
    /// Names of the bodies.
    pub names: Vec<String>,
    /// Held directions: (body, point in mm, direction).
    pub held: Vec<(usize, [f64; 3], [f64; 3])>,
    /// Nodal loads: (body, point in mm, force in N).
    pub loads: Vec<(usize, [f64; 3], [f64; 3])>,
    /// The rows of every contact node: the normal one, then the tangential ones; none where nothing lies opposite.
    pub contact: Vec<Vec<Vec<RowPart>>>,
    /// What the rotations of each body refer to.
    pub frames: Vec<Frame>,
}

/// A motion of one body: six coefficients.
pub type OwnMotion = [f64; MOTIONS];

/// A motion of all bodies: six coefficients per body.
pub type Motion = Vec<f64>;

impl RigidScene {
    /// Total load Σ|f|₁ over the nodes, N.
    pub fn total_load(&self) -> f64 {
        self.loads.iter().map(|(_, _, force)| force.iter().map(|f| f.abs()).sum::<f64>()).sum()
    }

    /// The work of a force on all motions.
    fn row(&self, &(body, point, force): &RowPart) -> DVector<f64> {
        let mut row = DVector::zeros(MOTIONS * self.frames.len());
        for (mode, motion) in self.frames[body].motions(point).iter().enumerate() {
            row[MOTIONS * body + mode] = (0..3).map(|axis| motion[axis] * force[axis]).sum();
        }
        row
    }

    /// The jumps of a contact row in all motions.
    fn contact_row(&self, parts: &[RowPart]) -> DVector<f64> {
        parts.iter().map(|part| self.row(part)).fold(DVector::zeros(MOTIONS * self.frames.len()), |sum, row| sum + row)
    }

    /// The motions that supports of one body leave free, orthonormal.
    pub(crate) fn own_motions(&self, body: usize) -> Vec<OwnMotion> {
        let held = self.held.iter().filter(|(holder, ..)| *holder == body);
        let work = |&(_, point, direction): &RowPart| DVector::from_row_slice(&self.works(body, point, direction));
        let free = kernel(&held.map(work).collect::<Vec<_>>(), MOTIONS);
        free.iter().map(|motion| std::array::from_fn(|mode| motion[mode])).collect()
    }

    /// The work of a force on the six motions of a body.
    fn works(&self, body: usize, point: [f64; 3], force: [f64; 3]) -> [f64; MOTIONS] {
        let motions = self.frames[body].motions(point);
        motions.map(|motion| (0..3).map(|axis| motion[axis] * force[axis]).sum())
    }

    /// Resultant of the loads of a body along one of its motions, N.
    pub(crate) fn resultant(&self, body: usize, motion: &OwnMotion) -> f64 {
        let loads = self.loads.iter().filter(|(loaded, ..)| *loaded == body);
        loads.map(|&(_, point, force)| self.works_along(body, motion, point, force)).sum()
    }

    /// What loads and packed contact forces, N, leave along the motions that the supports of each body leave free, N.
    pub(crate) fn imbalance(&self, boundary: &ContactBoundary, forces: &[f64]) -> f64 {
        let rows = || boundary.points.iter().zip(&self.contact).flat_map(|(point, rows)| point.rows().zip(rows));
        let left = |body: usize, motion: &OwnMotion| {
            let jump = |row: &[RowPart]| -> f64 {
                let own = row.iter().filter(|(own, ..)| *own == body);
                own.map(|&(_, point, direction)| self.works_along(body, motion, point, direction)).sum()
            };
            self.resultant(body, motion) - rows().map(|(index, row)| forces[index] * jump(row)).sum::<f64>()
        };
        let of_body = |body: usize| self.own_motions(body).into_iter().map(move |motion| left(body, &motion));
        (0..self.frames.len()).flat_map(of_body).fold(0.0, f64::hypot)
    }

    /// The work of a force on a motion of a body.
    fn works_along(&self, body: usize, motion: &OwnMotion, point: [f64; 3], force: [f64; 3]) -> f64 {
        self.works(body, point, force).iter().zip(motion).map(|(work, share)| work * share).sum()
    }

    /// Displacement of a place of a body in one of its motions.
    pub(crate) fn displacement(&self, body: usize, motion: &[f64], point: [f64; 3]) -> [f64; 3] {
        let basis = self.frames[body].motions(point);
        std::array::from_fn(|axis| basis.iter().zip(motion).map(|(basis, share)| basis[axis] * share).sum())
    }

    /// Checks that contact within its friction cone can carry the load; returns the motions that nothing holds, which
    /// are to be grounded.
    ///
    /// # Errors
    /// [`ContactError::NoEquilibrium`] naming the motion and the resultant that cannot be carried.
    pub(crate) fn analyse(&self, boundary: &ContactBoundary) -> Result<Vec<Motion>, ContactError> {
        let held = self.held.iter().map(|part| self.row(part));
        let free = kernel(&held.collect::<Vec<_>>(), MOTIONS * self.frames.len());
        if free.is_empty() {
            return Ok(Vec::new());
        }
        let project = |row: &DVector<f64>| DVector::from_iterator(free.len(), free.iter().map(|mode| mode.dot(row)));
        let load = self.contact_row(&self.loads);
        let contact = self.contact.iter().map(|rows| rows.iter().map(|row| project(&self.contact_row(row))).collect());
        let rows: Vec<Vec<DVector<f64>>> = contact.collect();
        let friction =
            boundary.points.iter().map(|point| (!point.is_tied).then_some(point.friction)).collect::<Vec<_>>();
        let scale = self.total_load();
        let (rest, doubt) = ConeProjection { rows: &rows, friction: &friction }.residual(&project(&load));
        let allowed = doubt.max(UNLOADED * scale);
        let motion = |coefficients: &DVector<f64>| -> DVector<f64> {
            free.iter().zip(coefficients.iter()).map(|(mode, coefficient)| mode * *coefficient).sum()
        };
        if rest.norm() > allowed {
            return Err(ContactError::NoEquilibrium {
                direction: self.describe(&motion(&rest)),
                resultant: rest.norm(),
                allowed,
            });
        }
        let grounded = kernel(&rows.concat(), free.len());
        Ok(grounded.iter().map(|coefficients| motion(coefficients).iter().copied().collect()).collect())
    }

    /// The largest parts of a motion in words.
    fn describe(&self, motion: &DVector<f64>) -> String {
        let largest = motion.amax();
        let parts: Vec<String> = motion
            .iter()
            .enumerate()
            .filter(|(_, value)| value.abs() > 0.3 * largest)
            .map(|(index, value)| {
                let body = &self.names[index / MOTIONS];
                let body = match body.as_str() {
                    "body" => "the body".to_owned(),
                    "lower" | "upper" => format!("the {body} body"),
                    other => format!("the body \"{other}\""),
                };
                let sign = if *value < 0.0 { "negative " } else { "" };
                let kind = if index % MOTIONS < 3 { "translation along" } else { "rotation about" };
                format!("{sign}{kind} x{} of {body}", index % 3 + 1)
            })
            .collect();
        parts.join(" with ")
    }
}

/// Orthonormal basis of the common kernel of some rows of this length, whose entries for translations are 1 before any
/// projection. Every motion counts in units of its own restraint: lever arms differ by the proportions of the bodies.
///
/// ```text
/// (rows · units) P = Q [R₁₁ R₁₂]   (columns of least new restraint last),   kernel = units · P [−R₁₁⁻¹ R₁₂; I]
/// ```
fn kernel(rows: &[DVector<f64>], size: usize) -> Vec<DVector<f64>> {
    let rounding = UNHELD * (rows.len() as f64).sqrt();
    let length = |motion: usize| rows.iter().map(|row| row[motion] * row[motion]).sum::<f64>().sqrt();
    let lengths: Vec<f64> = (0..size).map(length).collect();
    let unit = |motion: usize| if lengths[motion] > rounding { lengths[motion].recip() } else { 0.0 };
    let units: Vec<f64> = (0..size).map(unit).collect();
    let factors = DMatrix::from_fn(rows.len().max(size), size, |i, j| rows.get(i).map_or(0.0, |row| row[j]) * units[j]);
    let factors = factors.col_piv_qr();
    let triangle = factors.r();
    let mut order = DMatrix::from_fn(1, size, |_, motion| motion);
    factors.p().permute_columns(&mut order);
    let held = (0..size).take_while(|&k| triangle[(k, k)].abs() > FREE).count();
    let shares =
        triangle.view((0, 0), (held, held)).solve_upper_triangular(&triangle.view((0, held), (held, size - held)));
    let shares = shares.expect("invariant: no entry of the diagonal is zero");
    let motion = |free: usize| {
        let mut motion = DVector::zeros(size);
        (0..held).for_each(|k| motion[order[k]] = -shares[(k, free)] * units[order[k]]);
        let own = order[held + free];
        motion[own] = if units[own] > 0.0 { units[own] } else { 1.0 };
        motion
    };
    let free: Vec<DVector<f64>> = (0..size - held).map(motion).collect();
    if free.is_empty() {
        return free;
    }
    DMatrix::from_columns(&free).qr().q().column_iter().map(|column| column.into_owned()).collect()
}

/// Projection of a resultant onto the cone of contact resultants, by a nonnegative least squares active set whose
/// columns are generated from the exact friction cones.
struct ConeProjection<'a> {
    /// Per node: the normal row and its tangential rows, in coordinates of the free motions.
    rows: &'a [Vec<DVector<f64>>],
    /// Per node; none where it is glued.
    friction: &'a [Option<f64>],
}

impl ConeProjection<'_> {
    /// What remains of `load` less a near resultant of the cone, and what may remain of a load within the cone.
    ///
    /// With unit forces c of the cone, weights w and rest r = load − Σ w c, a load within the cone has |r|² = r·load ≤
    /// Σ w* max c·r for the weights w* that balance it.
    fn residual(&self, load: &DVector<f64>) -> (DVector<f64>, f64) {
        let mut columns: Vec<DVector<f64>> = Vec::new();
        let mut weights: Vec<f64> = Vec::new();
        let mut rest = load.clone();
        let rounding = ROUNDING * load.norm();
        let mut taken = 0.0;
        for _iteration in 0..400 {
            let Some((share, column)) = self.support(&rest) else { break };
            taken = share;
            if rest.norm() <= 1e-13 * load.norm() || taken <= rounding {
                break;
            }
            columns.push(column);
            weights.push(0.0);
            nonnegative_fit(&mut columns, &mut weights, load);
            rest = load.clone();
            for (column, weight) in columns.iter().zip(&weights) {
                rest -= column * *weight;
            }
        }
        let fitted: f64 = columns.iter().zip(&weights).map(|(column, weight)| weight * column.norm()).sum();
        let doubt = (MARGIN * fitted.max(load.norm()) * taken.max(rounding)).sqrt();
        (rest, doubt)
    }

    /// The extreme force of unit normal part whose resultant has the largest product with `direction` for its length,
    /// with that product.
    fn support(&self, direction: &DVector<f64>) -> Option<(f64, DVector<f64>)> {
        let mut best: Option<(f64, DVector<f64>)> = None;
        let mut offer = |column: DVector<f64>| {
            let norm = column.norm();
            let value = if norm > 0.0 { column.dot(direction) / norm } else { 0.0 };
            if best.as_ref().is_none_or(|(largest, _)| value > *largest) {
                best = Some((value, column));
            }
        };
        for (rows, friction) in self.rows.iter().zip(self.friction) {
            if rows.is_empty() {
                continue;
            }
            let Some(friction) = friction else {
                // Glue pulls as well as it pushes.
                rows.iter().for_each(|row| offer(if row.dot(direction) < 0.0 { -row } else { row.clone() }));
                continue;
            };
            let tangential: Vec<f64> = rows[1..].iter().map(|row| row.dot(direction)).collect();
            let length = tangential.iter().map(|t| t * t).sum::<f64>().sqrt();
            let mut column = rows[0].clone();
            if length > 0.0 {
                for (row, entry) in rows[1..].iter().zip(&tangential) {
                    column += row * (friction * entry / length);
                }
            }
            offer(column);
        }
        best
    }
}

/// Lawson–Hanson inner loop: least squares on all columns, with columns of negative weight taken out on the way.
fn nonnegative_fit(columns: &mut Vec<DVector<f64>>, weights: &mut Vec<f64>, load: &DVector<f64>) {
    for _pass in 0..columns.len() + 1 {
        let matrix = DMatrix::from_columns(columns);
        let Ok(fit) = matrix.svd(true, true).solve(load, 1e-13) else { return };
        let blocking = (0..fit.len()).filter(|&i| fit[i] < 0.0);
        let step = blocking.map(|i| weights[i] / (weights[i] - fit[i])).fold(1.0, f64::min);
        for (weight, fit) in weights.iter_mut().zip(fit.iter()) {
            *weight += step * (fit - *weight);
        }
        if step == 1.0 {
            return;
        }
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let pairs = columns.drain(..).zip(weights.drain(..));
        (*columns, *weights) = pairs.filter(|(_, weight)| *weight > 1e-15 * largest).unzip();
        if columns.is_empty() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::body::mesh::BlockFace;
    use crate::equilibrium::ContactProblem;
    use crate::scene::{CounterSurface, Geometry, Master, Scene, Support, hertz, signorini};

    /// Supports of two bodies, friction, expected numbers.
    type Stack<'a> = ([&'a [Support]; 2], f64, [usize; 3]);

    /// Numbers of motions that supports leave free to the lower body and to all, and that contact leaves free as well.
    fn counts(mut scene: Scene, supports: [&[Support]; 2], height: f64, friction: f64) -> [usize; 3] {
        let plane = |height: f64| CounterSurface::Plane { height };
        for (body, supports) in scene.bodies.iter_mut().zip(supports) {
            (body.supports, body.loads) = (supports.to_vec(), Vec::new());
        }
        if let Master::Obstacle(surface) = &mut scene.contacts[0].master {
            *surface = plane(height);
        }
        if let Some(Geometry::Block(block)) = scene.bodies.get_mut(1).map(|body| &mut body.geometry) {
            (block.bottom, block.top) = (plane(height), plane(3.0 * height));
        }
        let scene = scene.with_friction(friction).with_bricks([4; 3], [2; 3]);
        let scene = scene.with_blocks(|blocks| blocks.size = [1.0; 2]).with_shapes(|heights| {
            (heights.start, heights.thickness) = (height, Some(0.5 * height));
            (heights.slope, heights.volume) = (Some(1.0), Some([0.0, 2.0 * height]));
        });
        let problem = ContactProblem::new(scene).expect("a problem");
        let positions = problem.positions(&[height; 36]).expect("a block");
        let rigid = problem.rigid_scene(&positions, &problem.rows(&positions).expect("rows"));
        let own: Vec<usize> = (0..rigid.frames.len()).map(|body| rigid.own_motions(body).len()).collect();
        [own[0], own.iter().sum(), rigid.analyse(&problem.boundary).expect("nothing is loaded").len()]
    }

    /// What supports and contact leave free does not depend on the proportions of the bodies.
    #[test]
    fn proportions_hide_no_restraint() {
        let support = |face: BlockFace, held: [u8; 3]| Support::new(face, held.map(|held| held == 1));
        let foot = support(BlockFace::Bottom, [1, 1, 1]);
        let plane = support(BlockFace::Bottom, [0, 0, 1]);
        let (x1, x2) = (support(BlockFace::X1Min, [1, 0, 0]), support(BlockFace::X2Min, [0, 1, 0]));
        let across = support(BlockFace::X2Min, [1, 0, 0]);
        let one: [(&[Support], f64, [usize; 3]); 10] = [
            (std::slice::from_ref(&foot), 0.0, [0, 0, 0]),
            (&[foot.clone(), x1.clone()], 0.0, [0, 0, 0]),
            (&[x1.clone(), x2.clone()], 0.0, [1, 1, 0]),
            (std::slice::from_ref(&x1), 0.0, [3, 3, 1]),
            (std::slice::from_ref(&x1), 0.3, [3, 3, 0]),
            (&[plane.clone(), across.clone()], 0.0, [2, 2, 2]),
            (&[plane.clone(), across.clone()], 0.3, [2, 2, 0]),
            (std::slice::from_ref(&plane), 0.0, [3, 3, 3]),
            (&[], 0.0, [6, 6, 3]),
            (&[], 0.3, [6, 6, 0]),
        ];
        let two: [Stack<'_>; 5] = [
            ([std::slice::from_ref(&foot), &[]], 0.0, [0, 6, 3]),
            ([std::slice::from_ref(&foot), &[]], 0.3, [0, 6, 0]),
            ([&[x1.clone(), plane.clone()], std::slice::from_ref(&x1)], 0.0, [1, 4, 2]),
            ([&[x1.clone(), plane.clone()], std::slice::from_ref(&x1)], 0.3, [1, 4, 1]),
            ([&[], &[]], 0.3, [6, 12, 6]),
        ];
        for height in [1e-7, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6, 1e7] {
            for (supports, friction, expected) in &one {
                let found = counts(signorini().expect("a scene"), [supports, &[]], height, *friction);
                assert_eq!(found, *expected, "{height:e}, friction {friction}: {supports:?}");
            }
            for (supports, friction, expected) in &two {
                let found = counts(hertz().expect("a scene"), *supports, height, *friction);
                assert_eq!(found, *expected, "{height:e}, friction {friction}: {supports:?}");
            }
        }
    }
}
