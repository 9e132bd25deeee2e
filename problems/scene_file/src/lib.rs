//! Scenes as TOML files: the format, its checks, and its conversion to [`Scene`](contact::scene::Scene).
//!
//! ```text
//! text → table → checked against the schema (unknown, missing, type, range) → [`SceneFile`] → [`Case`]
//! ```
//! The documentation of the fields below, with their units and ranges, is the only source of the JSON schema, of the
//! checks, of the comments that `--print-scene` writes and of the list in `docs/fields.md`: five copies would not stay
//! equal. Checks of several fields stand in the conversion.

mod allowed;
mod bodies;
mod case;
mod check;
mod contact_section;
mod continuation;
mod conversion;
mod draft;
mod grid_file;
mod lattice;
mod limit;
mod load_case;
mod loading;
mod lookup;
mod mesh_check;
mod mesh_file;
mod objective;
mod obstacle_mesh;
pub mod optimization;
mod print;
mod quantity;
mod region;
mod report;
mod schema;
mod setting;
mod settings;
mod shapes;
mod surfaces;
mod table;
mod text;

pub use allowed::choices;
pub use bodies::{BlockSection, BodySection, default_subdomains};
pub use case::Case;
pub use contact_section::{ContactSection, FaceSection, FrictionSection};
pub use continuation::ContinuationMesh;
pub use draft::{draft, open_questions};
pub use lattice::{CylinderSection, LatticeSection, NodeBoundSection};
pub use limit::LimitSection;
pub use load_case::{CaseBodySection, CaseScene, CaseSection};
pub use loading::{Component, LoadSection, MaterialSection, SupportSection, UnitName, VolumeMaterialSection};
pub use objective::ObjectiveSection;
pub use quantity::{AxisName, BaseSection, Details, QuantityName, WantedSection};
pub use region::RegionSection;
pub use report::ReportSection;
pub use schema::schema;
pub use setting::{Setting, check_path, set_field};
pub use settings::{AccuracyName, MethodName, OptimizerSection, OutputSection, SolverSection};
pub use surfaces::ObstacleSection;
pub use table::field_tables;
pub use text::read_text;

use contact::error::SceneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Names of copies of the files of a scene, beside a copy of its own.
pub const FILES: [&str; 7] = [
    "obstacle.csv",
    "obstacle.msh",
    "obstacle.stl",
    "start.csv",
    "wanted_pressure.csv",
    "continuation.msh",
    "body.msh",
];

/// Largest scene file, bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// A contact shape optimization problem: elastic bodies, some of them with a shape that is optimized, and what they
/// touch. Units: N, mm, MPa.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Name for reports.
    pub name: String,
    /// Coulomb friction coefficient of all contacts that have none of their own.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub friction: f64,
    /// The bodies.
    pub body: Vec<BodySection>,
    /// What touches what.
    pub contact: Vec<ContactSection>,
    /// What is minimised.
    #[serde(default)]
    pub objective: ObjectiveSection,
    /// Load cases: the shape is rated by its states in all of them. Default: the scene itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub case: Vec<CaseSection>,
    /// Bounds on what the shape leads to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limit: Vec<LimitSection>,
    /// Quantities that are told for every shape.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub report: Vec<ReportSection>,
    /// How the contact problem is solved.
    #[serde(default)]
    pub solver: SolverSection,
    /// Settings of the bundle-trust method.
    #[serde(default)]
    pub optimizer: OptimizerSection,
    /// What is written.
    #[serde(default)]
    pub output: OutputSection,
}

/// The name of the copy of a file of one of several bodies or contacts, such as `body-1.msh`; that of the only one has
/// no number.
fn numbered(name: &str, index: usize, count: usize, face: &str) -> String {
    let (stem, end) = name.rsplit_once('.').unwrap_or((name, ""));
    let face = if face.is_empty() { String::new() } else { format!("-{face}") };
    let number = if count == 1 { String::new() } else { format!("-{index}") };
    format!("{stem}{face}{number}.{end}")
}

impl SceneFile {
    /// Reads the text of a scene file; `name` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::File`] for text that is no TOML, [`SceneError::UnknownField`] with the nearest name, and
    /// [`SceneError::Field`] with the path of the field, its value and what is allowed; [`SceneError::Open`] with one
    /// of these for a text that leaves something open.
    pub fn parse(text: &str, name: &str) -> Result<Self, SceneError> {
        Self::parse_table(text, name).map_err(|source| match open_questions(text) {
            open if open.is_empty() => source,
            open => SceneError::Open { source: Box::new(source), open },
        })
    }

    fn parse_table(text: &str, name: &str) -> Result<Self, SceneError> {
        let failed = |reason: String| SceneError::File { path: name.to_owned(), reason };
        let table: toml::Table =
            toml::from_str(text).map_err(|error| failed(error.to_string().trim_end().to_owned()))?;
        check::check(&table, name)?;
        // What the schema admits, the types admit too; a difference between the two is reported like a bad file.
        table.try_into().map_err(|error: toml::de::Error| failed(error.to_string().trim_end().to_owned()))
    }

    /// Reads a scene file.
    ///
    /// # Errors
    /// [`SceneError::File`] for a file that cannot be read, and as [`parse`](Self::parse).
    pub fn read(file: &Path) -> Result<Self, SceneError> {
        let path = file.display().to_string();
        Self::parse(&read_text(file, LARGEST_FILE)?, &path)
    }

    /// What a scene file leaves open: [`open_questions`] of its text.
    ///
    /// # Errors
    /// As [`read_text`].
    pub fn open_questions(file: &Path) -> Result<Vec<String>, SceneError> {
        Ok(open_questions(&read_text(file, LARGEST_FILE)?))
    }

    /// The files that the scene names, each with the name of its copy beside a copy of the scene.
    pub fn files_mut(&mut self) -> Vec<(String, &mut String)> {
        let [_, _, _, start, wanted, continuation, mesh] = FILES;
        let Self { body: bodies, contact: contacts, optimizer, objective, limit: limits, report: reports, .. } = self;
        let mut files = Vec::new();
        let of_limits = limits.iter_mut().map(|limit| &mut limit.details);
        let of_reports = reports.iter_mut().map(|report| &mut report.details);
        let count = 1 + of_limits.len() + of_reports.len();
        let details = std::iter::once(&mut objective.details).chain(of_limits).chain(of_reports);
        for (index, details) in details.enumerate() {
            if let Some(WantedSection::Grid { file }) = &mut details.wanted {
                files.push((numbered(wanted, index, count, ""), file));
            }
        }
        let (count, meshes) = (optimizer.continuation.len(), optimizer.continuation.iter_mut().enumerate());
        let name = |index| numbered(continuation, index, count, "");
        files.extend(meshes.filter_map(|(index, mesh)| Some((name(index), mesh.file_mut()?))));
        let count = bodies.len();
        for (index, body) in bodies.iter_mut().enumerate() {
            files.extend(body.mesh.as_mut().map(|file| (numbered(mesh, index, count, ""), file)));
            if let Some(ObstacleSection::Grid { file, .. }) = body.lattice.as_mut().and_then(|own| own.start.as_mut()) {
                files.push((numbered(start, index, count, ""), file));
            }
            let faces =
                body.block.iter_mut().flat_map(|block| [("bottom", &mut block.bottom), ("top", &mut block.top)]);
            for (name, face) in faces {
                if let Some(ObstacleSection::Grid { file, .. }) = face {
                    files.push((numbered(start, index, count, name), file));
                }
            }
        }
        let count = contacts.len();
        for (index, contact) in contacts.iter_mut().enumerate() {
            let own = contact.obstacle.as_mut().and_then(ObstacleSection::file_mut);
            files.extend(own.map(|(name, file)| (numbered(name, index, count, ""), file)));
        }
        files
    }

    /// The files of all bodies that are meshes.
    pub(crate) fn mesh_files_mut(&mut self) -> impl Iterator<Item = &mut String> {
        self.body.iter_mut().filter_map(|body| body.mesh.as_mut())
    }

    /// The value of the field at a path such as `solver.kind` or `body[0].unit`, as it stands in a file; for a field
    /// that is not set, what its documentation says of that.
    pub fn value(&self, path: &str) -> String {
        let table = toml::Table::try_from(self).unwrap_or_default();
        setting::value_at(&table, path).map_or_else(|| allowed::default(path), |value| value.to_string())
    }

    /// The complete file with a comment on every field; reads back as the same scene.
    ///
    /// # Errors
    /// [`SceneError::File`] if a value has no form in TOML.
    pub fn print(&self) -> Result<String, SceneError> {
        print::print(self)
    }
}
