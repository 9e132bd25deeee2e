//! What can be wrong with a scene, and why a contact problem has no answer.

use crate::linear::FactorizationError;
use thiserror::Error;

/// What is said of a value that is not allowed.
fn found(value: &str) -> String {
    if value == "missing" { "is missing".into() } else { format!("= {value} is not allowed") }
}

/// Input that describes no scene we can compute. Every variant names the field, the value and what is allowed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A field is outside its range.
    #[error("{field} = {value} is not allowed; allowed: {allowed}")]
    OutOfRange {
        /// Name of the field or option.
        field: String,
        /// The value as it was found.
        value: String,
        /// The values that are allowed.
        allowed: String,
    },
    /// A field of a scene file is missing, of another type or outside its range.
    #[error("{file}: {path} {}; allowed: {allowed}", found(value))]
    Field {
        /// Path of the file.
        file: String,
        /// Path of the field in the file.
        path: String,
        /// Value found, or `missing`.
        value: String,
        /// The values that are allowed.
        allowed: String,
    },
    /// A scene file has a field that no scene has.
    #[error("{file}: there is no field `{path}`{suggestion}; allowed: {allowed}")]
    UnknownField {
        /// Path of the file.
        file: String,
        /// Path of the field in the file.
        path: String,
        /// The nearest name, as a question, or nothing.
        suggestion: String,
        /// All names at this place.
        allowed: String,
    },
    /// What a scene file says cannot be computed.
    #[error("{file}: {source}")]
    InFile {
        /// Path of the file.
        file: String,
        /// The error inside the file.
        source: Box<SceneError>,
    },
    /// A scene file leaves open what only the user knows.
    #[error("{source}; {}", open.join("; "))]
    Open {
        /// What cannot be computed without it.
        source: Box<SceneError>,
        /// The lines that ask.
        open: Vec<String>,
    },
    /// A list has the wrong length.
    #[error("{what}: {found} numbers found, {expected} expected")]
    WrongCount {
        /// Name of the list.
        what: String,
        /// Length it must have.
        expected: usize,
        /// The length of the list as it was found.
        found: usize,
    },
    /// Controls outside the admissible set.
    #[error("controls lie outside the admissible set: {constraint} = {value}, allowed: {allowed}")]
    NotAdmissible {
        /// The constraint that is violated.
        constraint: String,
        /// Value of its expression.
        value: f64,
        /// The interval that is admissible.
        allowed: String,
    },
    /// A file cannot be read or written, or does not hold what it should.
    #[error("{path}: {reason}")]
    File {
        /// Path as given by the user.
        path: String,
        /// What the system or the parser reported.
        reason: String,
    },
    /// Another process refuses what this one would accept: less memory is free where it runs.
    #[error("{reason}")]
    OtherProcess {
        /// What that process says.
        reason: String,
    },
    /// The admissible set is contradictory.
    #[error("admissible set: {0}")]
    Set(#[from] nonsmooth::InputError),
}

impl SceneError {
    /// A field outside its range.
    pub fn out_of_range(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self::OutOfRange { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// Refuses a field that is not `valid`.
    pub fn require(
        valid: bool,
        field: impl Into<String>,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> Result<(), Self> {
        if valid { Ok(()) } else { Err(Self::out_of_range(field, value, allowed)) }
    }
}

/// Why a contact problem was not solved.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A cell has no positive volume at an integration point or a corner: the shape folds.
    #[error("{body}: cell {cell} is inverted: det = {determinant:.6e}, allowed: > 0")]
    InvertedElement {
        /// Name of the body.
        body: String,
        /// Number of the cell in its mesh.
        cell: usize,
        /// Smallest Jacobian determinant at its integration points and corners, mm³ from the reference cell.
        determinant: f64,
    },
    /// A contact node has no unique nearest point on the counter surface.
    #[error("contact node {node} at {place:?} mm has no normal: {reason}")]
    NoFoot {
        /// The node of the lower body.
        node: u32,
        /// Its position, mm.
        place: [f64; 3],
        /// Why, in words.
        reason: &'static str,
    },
    /// A contact node no longer lies opposite to the facets that it had at the start.
    #[error(
        "contact node {node} at {place:?} mm slid too far along the master face, or away from the face that it is glued to \
         (allowed: shapes that move faces along each other by less than two facets, or within the bounds of lattices)"
    )]
    LeftMaster {
        /// The node of the slave body.
        node: u32,
        /// Its position, mm.
        place: [f64; 3],
    },
    /// A stiffness matrix resists a rigid motion, or is not finite.
    #[error(
        "the stiffness matrix of {body} resists rigid motions: |K R| = {ratio:.1e} |K| |R|, allowed: {allowed:.0e}"
    )]
    ResistsRigidMotions {
        /// Name of the body.
        body: String,
        /// max |K R| over the largest entry of K and that of R.
        ratio: f64,
        /// What counts as rounding.
        allowed: f64,
    },
    /// The load has a resultant along a motion that nothing holds.
    #[error(
        "no equilibrium: the load has the resultant {resultant:.6e} along {direction}, \
         which neither supports nor contact can carry (allowed: at most {allowed:.3e})"
    )]
    NoEquilibrium {
        /// The motion, in words.
        direction: String,
        /// Its generalised force (N for translations, N·mm/mm for scaled rotations).
        resultant: f64,
        /// Largest resultant that counts as zero.
        allowed: f64,
    },
    /// Only friction could hold the bodies, and contact cannot build up the normal forces that friction would need.
    #[error(
        "no equilibrium: the load has the resultant {resultant:.6e} N along {direction}, which only friction could hold, and \
         contact cannot build up the normal forces for more than {largest:.6e} N"
    )]
    FrictionTooWeak {
        /// The motion that the load does work on, in words; its slip is 1 in the root mean square over the contact
        /// nodes.
        direction: String,
        /// Work of the load on it per length, N.
        resultant: f64,
        /// The largest resistance of friction to it that any contact forces can have, N: an upper bound, proved.
        largest: f64,
    },
    /// The contact nodes that are closed at some iteration hold the bodies no longer.
    #[error(
        "the closed contact nodes leave a rigid motion free (pivot ratio {pivot_ratio:.1e}); the resultant is {resultant:.3e}"
    )]
    Unheld {
        /// Smallest over largest pivot of the coarse matrix.
        pivot_ratio: f64,
        /// Norm of the resultants of the loads, N.
        resultant: f64,
    },
    /// Subdomains cannot be joined to so many clusters.
    #[error("{count} clusters are not allowed: {reason}")]
    Clusters {
        /// Number of clusters.
        count: usize,
        /// Why, and what is allowed.
        reason: String,
    },
    /// A symbolic analysis failed, a matrix is not positive definite, or a factorisation is inaccurate.
    #[error("{what}: {reason}")]
    Factorization {
        /// The matrix that was to be factored.
        what: String,
        /// What the factorisation reported.
        reason: String,
    },
    /// An iteration ended above its tolerance.
    #[error(
        "{solver} stopped at relative residual {residual:.3e} (asked for {tolerance:.1e}) after {iterations} iterations"
    )]
    NotConverged {
        /// Name of the iteration.
        solver: &'static str,
        /// The relative residual that was reached.
        residual: f64,
        /// The relative residual that was asked for.
        tolerance: f64,
        /// The number of iterations spent.
        iterations: usize,
        /// Relative residual after every iteration.
        history: Vec<f64>,
    },
    /// The forces found do not satisfy the equations, recomputed from them.
    #[error("the forces found are no state: relative residuals {residuals}; allowed: at most {allowed:.1e}")]
    Inaccurate {
        /// All residuals, in words.
        residuals: String,
        /// The largest of them.
        largest: f64,
        /// Largest residual of a state.
        allowed: f64,
    },
    /// Every solver was tried.
    #[error("no state found. Total FETI ({products} products with F): {torn}. Direct condensation: {direct}")]
    Unsolved {
        /// Why total FETI found none.
        torn: Box<ContactError>,
        /// Products with the dual operator that it took.
        products: usize,
        /// Why direct condensation found none.
        direct: Box<ContactError>,
    },
    /// The data do not determine the answer to the accuracy asked for in double precision.
    #[error(
        "beyond double precision: rounding of the {what}: relative residuals below {floor:.1e} mean nothing \
         (reached {residual:.1e}, asked for {tolerance:.1e})"
    )]
    BeyondPrecision {
        /// Which data, and how they matter.
        what: &'static str,
        /// Relative residual that rounding alone causes.
        floor: f64,
        /// The relative residual that was reached.
        residual: f64,
        /// Relative residual that would have been accepted.
        tolerance: f64,
    },
    /// A state was handed to the solver of another mesh.
    #[error("the state was found on another mesh: {found} {what}, {expected} expected")]
    ForeignState {
        /// What the two numbers count.
        what: &'static str,
        /// How many this solver has.
        expected: usize,
        /// How many the state has.
        found: usize,
    },
    /// A state was handed to another kind of solver than the one that found it.
    #[error("the state was found by another kind of contact solver")]
    OtherSolver,
    /// Nobody waits for the state any more ([`nonsmooth::interruption`]).
    #[error("the contact problem was interrupted")]
    Interrupted,
    /// Another process failed where this one did not.
    #[error("{reason}")]
    OtherProcess {
        /// What that process says, with its number.
        reason: String,
    },
    /// A result is not finite.
    #[error("{what} is not finite")]
    NotFinite {
        /// The quantity that is not finite.
        what: &'static str,
    },
    /// The map from slip bounds to slip bounds does not contract: friction is too large for successive approximations.
    #[error(
        "successive approximations do not contract: estimated factor {factor:.3} after {} steps; \
         use the Newton solver or a smaller friction coefficient",
        history.len()
    )]
    NoContraction {
        /// The estimated contraction factor.
        factor: f64,
        /// Relative change of the slip bound in every step.
        history: Vec<f64>,
    },
    /// The dual quadratic program was not solved.
    #[error("dual problem: {0}")]
    DualProblem(#[from] crate::qp::QpError),
}

impl From<FactorizationError> for ContactError {
    fn from(error: FactorizationError) -> Self {
        Self::Factorization { what: error.what.into(), reason: error.reason }
    }
}

impl ContactError {
    /// Whether every solver would fail alike: by the scene, the shape or the caller, or because an end is asked for.
    pub fn ends_the_search(&self) -> bool {
        matches!(
            self,
            Self::InvertedElement { .. }
                | Self::NoFoot { .. }
                | Self::NoEquilibrium { .. }
                | Self::ResistsRigidMotions { .. }
                | Self::FrictionTooWeak { .. }
                | Self::ForeignState { .. }
                | Self::Interrupted
        )
    }

    /// The kind of the error: the name of its variant.
    pub fn kind(&self) -> String {
        format!("{self:?}").chars().take_while(|character| character.is_alphanumeric()).collect()
    }
}
