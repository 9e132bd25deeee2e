//! Scenes as TOML files: the format, its checks, and its conversion to [`Scene`](contact::scene::Scene).
//!
//! ```text
//! text → table → checked against the schema (unknown, missing, type, range) → [`SceneFile`] → [`Case`]
//! ```
//! The documentation of the fields below, with their units and ranges, is the only source of the JSON schema, of the
//! checks, of the comments that `--print-scene` writes and of the table in `docs/scenes.md`.

mod allowed;
mod bodies;
mod by_name;
mod case;
mod check;
mod contact_section;
mod continuation;
mod draft;
mod either;
mod general;
mod grid_file;
mod lattice;
mod limit;
mod load_case;
mod mesh_check;
mod mesh_file;
mod objective;
pub mod optimization;
mod parts;
mod print;
mod region;
mod scene_parts;
mod schema;
mod setting;
mod settings;
mod shapes;
mod short_form;
mod surfaces;
mod table;
mod text;
mod wanted_pressure;

pub use allowed::choices;
pub use bodies::{
    BodySection, Component, LoadSection, MaterialSection, MeshBodySection, SupportSection, UnitName, UpperSection,
    VolumeMaterialSection,
};
pub use case::Case;
pub use contact_section::{ContactSection, FrictionSection};
pub use continuation::ContinuationMesh;
pub use draft::draft;
pub use either::Either;
pub use lattice::{CylinderSection, LatticeSection, NodeBoundSection};
pub use limit::{LimitSection, QuantityName};
pub use load_case::{CaseBodySection, CasePartSection, CaseScene, CaseSection};
pub use objective::{AxisName, MeasureName, Objective, ObjectiveSection, WantedSection};
pub use parts::{BlockSection, FaceSection, PairSection, PartSection};
pub use region::RegionSection;
pub use schema::schema;
pub use setting::{Setting, check_path};
pub use settings::{AccuracyName, MeshSection, MethodName, OptimizerSection, OutputSection, SolverSection};
pub use short_form::default_subdomains;
pub use surfaces::{AdmissibleSection, CounterSection, FairnessSection, SplineName, StartSection, SurfaceSection};
pub use table::field_table;
pub use text::read_text;
pub use wanted_pressure::WantedPressure;

use contact::error::SceneError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Names of copies of the files of a scene, beside a copy of its own.
pub const FILES: [&str; 5] =
    ["counter_surface.csv", "start.csv", "wanted_pressure.csv", "continuation.msh", "body.msh"];

/// Largest scene file, bytes.
const LARGEST_FILE: u64 = 1 << 20;

/// A contact shape optimization problem: elastic bodies, some of them with a shape that is optimized, and what they
/// touch. Units: N, mm, MPa. Any number of bodies and of contacts are lists (`[[body]]`, `[[contact]]`). Scenes of one
/// optimized body have a short form: a block of bricks with an optimized top, over the base spanned by x1, x2 and
/// standing on x3 = 0 (size, lower, surface, admissible), or a mesh with a lattice of control points (`[body]`,
/// lattice), below a rigid obstacle or, of blocks, below a second elastic one (counter_surface, upper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Name for reports.
    pub name: String,
    /// Lengths a, b of the base of blocks along x1, x2. Default none: required for blocks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1e-9, max = 1e9)), extend("x-unit" = "mm"))]
    pub size: Option<[f64; 2]>,
    /// Coulomb friction coefficient of all contacts that have none of their own.
    #[schemars(range(min = 0.0, max = 1e6), extend("x-unit" = "1"))]
    pub friction: f64,
    /// What touches, along which normals: a table in the short form, else a list of pairs of faces.
    #[serde(default)]
    pub contact: Either<ContactSection, PairSection>,
    /// Bricks of blocks and tearing into subdomains, the same for both blocks.
    #[serde(default)]
    pub mesh: MeshSection,
    /// The body as a mesh, in place of blocks; or, as a list, all bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<Either<MeshBodySection, PartSection>>,
    /// The block whose upper surface is optimized.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<BodySection>,
    /// The elastic block above; left out for a rigid obstacle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub upper: Option<UpperSection>,
    /// The rigid obstacle, or the lower surface of the upper body. Required in the short form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counter_surface: Option<CounterSection>,
    /// The optimized surface of a block: its spline and its start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceSection>,
    /// The admissible set of control heights of a block; they also stay below the counter surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub admissible: Option<AdmissibleSection>,
    /// The shapes of a mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lattice: Option<LatticeSection>,
    /// What is minimised.
    #[serde(default)]
    pub objective: ObjectiveSection,
    /// Load cases: the shape is rated by its states in all of them. Default none: the scene itself is the only one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub case: Vec<CaseSection>,
    /// Bounds on what the shape leads to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limit: Vec<LimitSection>,
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

/// Whether a name is one of the copies of the files of a scene.
pub fn is_copy(name: &str) -> bool {
    FILES.iter().any(|copy| {
        let Some((stem, end)) = copy.rsplit_once('.') else { return false };
        let inner =
            name.strip_prefix(stem).and_then(|rest| rest.strip_suffix(end)).and_then(|rest| rest.strip_suffix('.'));
        let digits = |text: &str| text.trim_start_matches("-bottom").trim_start_matches("-top").to_owned();
        inner.is_some_and(|rest| {
            rest.is_empty() || digits(rest).strip_prefix('-').is_some_and(|n| n.parse::<usize>().is_ok())
        })
    })
}

/// The name of the copy of a file of one of several bodies or contacts, such as `body-1.msh`.
fn numbered(name: &str, index: usize, face: &str) -> String {
    let (stem, end) = name.rsplit_once('.').unwrap_or((name, ""));
    let face = if face.is_empty() { String::new() } else { format!("-{face}") };
    format!("{stem}{face}-{index}.{end}")
}

impl SceneFile {
    /// Reads the text of a scene file; `name` stands in messages.
    ///
    /// # Errors
    /// [`SceneError::File`] for text that is no TOML, [`SceneError::UnknownField`] with the nearest name, and
    /// [`SceneError::Field`] with the path of the field, its value and what is allowed.
    pub fn parse(text: &str, name: &str) -> Result<Self, SceneError> {
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

    /// The files that the scene names, each with the name of its copy beside a copy of the scene.
    pub fn files_mut(&mut self) -> Vec<(String, &mut String)> {
        let [counter, start, wanted, continuation, mesh] = FILES.map(str::to_owned);
        let mut files = Vec::new();
        if let Some(CounterSection::Grid { file, .. }) = &mut self.counter_surface {
            files.push((counter.clone(), file));
        }
        if let Some(StartSection::Grid { file }) = self.surface.as_mut().map(|surface| &mut surface.start) {
            files.push((start.clone(), file));
        }
        if let Some(WantedSection::Grid { file }) = &mut self.objective.wanted {
            files.push((wanted, file));
        }
        let meshes = self.optimizer.continuation.iter_mut().enumerate();
        files.extend(meshes.filter_map(|(index, mesh)| Some((numbered(&continuation, index, ""), mesh.file_mut()?))));
        let Self { body, contact, .. } = self;
        match body {
            Some(Either::One(section)) => files.push((mesh, &mut section.mesh)),
            Some(Either::Several(sections)) => {
                for (index, section) in sections.iter_mut().enumerate() {
                    files.extend(section.mesh.as_mut().map(|file| (numbered(&mesh, index, ""), file)));
                    if let Some(StartSection::Grid { file }) = section.surface.as_mut().map(|own| &mut own.start) {
                        files.push((numbered(&start, index, ""), file));
                    }
                    let faces = section
                        .block
                        .iter_mut()
                        .flat_map(|block| [("bottom", &mut block.bottom), ("top", &mut block.top)]);
                    for (name, face) in faces {
                        if let Some(CounterSection::Grid { file, .. }) = face {
                            files.push((numbered(&start, index, name), file));
                        }
                    }
                }
            }
            None => {}
        }
        for (index, pair) in contact.several_mut().iter_mut().enumerate() {
            if let Some(CounterSection::Grid { file, .. }) = &mut pair.obstacle {
                files.push((numbered(&counter, index, ""), file));
            }
        }
        files
    }

    /// The files of all bodies that are meshes.
    pub(crate) fn mesh_files_mut(&mut self) -> impl Iterator<Item = &mut String> {
        let (one, several) = match &mut self.body {
            Some(Either::One(body)) => (Some(&mut body.mesh), None),
            Some(Either::Several(bodies)) => (None, Some(bodies.iter_mut().filter_map(|body| body.mesh.as_mut()))),
            None => (None, None),
        };
        one.into_iter().chain(several.into_iter().flatten())
    }

    /// The bodies of a list.
    pub fn parts(&self) -> &[PartSection] {
        self.body.as_ref().map_or(&[], Either::several)
    }

    /// The only body, where it is a mesh.
    pub fn mesh_body(&self) -> Option<&MeshBodySection> {
        self.body.as_ref().and_then(Either::one)
    }

    /// The value of the field at a path such as `mesh.bricks` or `body[0].unit`, as it stands in a file; for a field
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
