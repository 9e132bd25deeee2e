//! What a scene is made of, and what is allowed.

use crate::body::mesh::{BlockFace, Grid, Mesh};
use crate::error::SceneError;
use crate::names::find;
use crate::scene::{BodyScene, ContactScene, CounterSurface, Held, LoadKind, NormalKind};
use crate::shape::{HeightShape, ShapeBounds, ShapeScene};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Where the meshes of the bodies come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Geometry {
    /// Blocks of bricks over one base.
    Blocks(Blocks),
    /// A mesh of the only body.
    Mesh(MeshGeometry),
}

/// Blocks over one base: the lower one from 0 to the optimized surface, the upper one from the counter surface upwards.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Blocks {
    /// Lengths a, b of the base, mm.
    pub size: [f64; 2],
    /// Bricks along x₁, x₂, x₃ of each body.
    pub bricks: [usize; 3],
    /// Subdomains along x₁, x₂, x₃ of each body.
    pub subdomains: [usize; 3],
}

/// A mesh with the number of its pieces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeshGeometry {
    /// Nodes, cells and names; lengths in mm.
    pub mesh: Arc<Mesh>,
    /// Pieces that total FETI divides it into, about; none: by the number of cells.
    pub pieces: Option<usize>,
}

/// An elastic body above the contact boundary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UpperBody {
    /// Material, supports and loads of the body.
    pub body: BodyScene,
    /// Height of its flat top, mm.
    pub top: f64,
}

/// A contact problem with an optimizable lower body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The name of the scene in reports.
    pub name: String,
    /// The meshes of the bodies.
    pub geometry: Geometry,
    /// The body whose shape is optimized.
    pub lower: BodyScene,
    /// The elastic body above; none for a rigid obstacle.
    pub upper: Option<UpperBody>,
    /// The obstacle, or F², the lower surface of the upper body.
    pub counter_surface: CounterSurface,
    /// What touches, and how.
    pub contact: ContactScene,
    /// The controls of the shape.
    pub shape: ShapeScene,
}

/// Cells of a piece, about, where the scene does not say how many pieces there are: larger ones take too long to
/// factor, smaller ones make the coarse problem large.
const CELLS_PER_PIECE: [usize; 2] = [512, 400];

impl MeshGeometry {
    /// Pieces, about.
    pub fn piece_count(&self) -> usize {
        let mesh = &self.mesh;
        let second = mesh.cells().filter(|cell| cell.nodes.len() > 8).count();
        let cells = if 2 * second > mesh.cell_count() { CELLS_PER_PIECE[1] } else { CELLS_PER_PIECE[0] };
        self.pieces.unwrap_or_else(|| mesh.cell_count().div_ceil(cells))
    }
}

impl Blocks {
    /// The grid that both bodies share.
    pub fn grid(&self) -> Grid {
        Grid { cells: self.bricks, size: self.size }
    }
}

impl Scene {
    /// The blocks of the scene, where its bodies are blocks.
    pub fn blocks(&self) -> Option<&Blocks> {
        match &self.geometry {
            Geometry::Blocks(blocks) => Some(blocks),
            Geometry::Mesh(_) => None,
        }
    }

    /// The height surface that shapes the lower body, where a height surface does.
    pub fn heights(&self) -> Option<&HeightShape> {
        match &self.shape {
            ShapeScene::Heights(heights) => Some(heights),
            ShapeScene::Lattice(_) => None,
        }
    }

    /// The scene with other bricks and subdomains of its blocks; a scene of a mesh stays as it is.
    #[must_use]
    pub fn with_bricks(mut self, bricks: [usize; 3], subdomains: [usize; 3]) -> Self {
        if let Geometry::Blocks(blocks) = &mut self.geometry {
            *blocks = Blocks { bricks, subdomains, ..*blocks };
        }
        self
    }

    /// The scene with changed blocks; a scene of a mesh stays as it is.
    #[must_use]
    pub fn with_blocks(mut self, change: impl FnOnce(&mut Blocks)) -> Self {
        if let Geometry::Blocks(blocks) = &mut self.geometry {
            change(blocks);
        }
        self
    }

    /// The scene with a changed height surface; a scene of a lattice stays as it is.
    #[must_use]
    pub fn with_heights(mut self, change: impl FnOnce(&mut HeightShape)) -> Self {
        if let ShapeScene::Heights(heights) = &mut self.shape {
            change(heights);
        }
        self
    }

    /// The scene with another friction coefficient.
    #[must_use]
    pub fn with_friction(mut self, friction: f64) -> Self {
        self.contact.friction = friction;
        self
    }

    /// Checks every field that needs no mesh.
    ///
    /// # Errors
    /// [`SceneError`] naming the field, its value and what is allowed.
    pub fn validate(&self) -> Result<(), SceneError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let coefficients = self.contact.friction_by_region.iter().map(|(_, friction)| *friction);
        for friction in std::iter::once(self.contact.friction).chain(coefficients) {
            let valid = friction == 0.0 || positive(friction);
            SceneError::require(valid, "friction", friction, "a finite number ≥ 0")?;
        }
        let interference = self.contact.interference;
        SceneError::require(interference.is_finite(), "contact.interference", interference, "a finite number (mm)")?;
        self.counter_surface.check("counter_surface")?;
        self.validate_normals()?;
        match (&self.geometry, &self.shape) {
            (Geometry::Blocks(blocks), ShapeScene::Heights(heights)) => self.validate_blocks(blocks, heights)?,
            (Geometry::Mesh(_), ShapeScene::Heights(_)) => {
                let allowed = "a lattice: a height surface shapes blocks only";
                return Err(SceneError::out_of_range("surface", "a height surface of a mesh", allowed));
            }
            (_, ShapeScene::Lattice(lattice)) => lattice.validate()?,
        }
        if self.upper.is_some() && self.blocks().is_none() {
            let allowed = "none: a mesh touches a rigid obstacle";
            return Err(SceneError::out_of_range("upper", "an upper body above a mesh", allowed));
        }
        if self.upper.is_some() && self.heights().is_none() {
            let allowed = "none with a lattice: its nodes would leave those of the upper body";
            return Err(SceneError::out_of_range("upper", "an upper body above a lattice", allowed));
        }
        Ok(())
    }

    /// Checks that the counter surface has the normals that the scene asks for.
    fn validate_normals(&self) -> Result<(), SceneError> {
        let refused = |allowed: &str| Err(SceneError::out_of_range("contact.normal", "\"surface\"", allowed));
        match self.contact.normal {
            NormalKind::Surface if self.upper.is_some() => {
                refused("\"x3\" between two bodies, whose nodes meet along x3")
            }
            NormalKind::Surface if matches!(self.counter_surface, CounterSurface::Punch { .. }) => {
                refused("\"x3\" with a punch, which has a step")
            }
            NormalKind::X3 if !self.counter_surface.has_heights() => {
                let allowed = "\"surface\" with a counter surface that is no height over x1 and x2";
                Err(SceneError::out_of_range("contact.normal", "\"x3\"", allowed))
            }
            _ => Ok(()),
        }
    }

    fn validate_blocks(&self, blocks: &Blocks, heights: &HeightShape) -> Result<(), SceneError> {
        for (axis, (&mesh, &subdomains)) in blocks.bricks.iter().zip(&blocks.subdomains).enumerate() {
            SceneError::require(
                (1..=400).contains(&mesh),
                format!("mesh.bricks[{axis}]"),
                mesh,
                "1 … 400 bricks per edge",
            )?;
            let divides = subdomains > 0 && mesh.is_multiple_of(subdomains);
            let allowed = format!("a divisor of the {mesh} bricks per edge");
            SceneError::require(divides, format!("mesh.subdomains[{axis}]"), subdomains, allowed)?;
        }
        let positive = |value: f64| value > 0.0 && value.is_finite();
        for (axis, &length) in blocks.size.iter().enumerate() {
            SceneError::require(positive(length), format!("size[{axis}]"), length, "a finite length > 0 mm")?;
        }
        let height = heights.start_height;
        SceneError::require(positive(height), "surface.start", height, "a finite mean height > 0 mm")?;
        if self.counter_surface.has_heights() {
            self.validate_heights(blocks, heights)?;
        }
        Self::validate_block("lower", &self.lower, BlockFace::Top)?;
        if let Some(upper) = &self.upper {
            Self::validate_block("upper", &upper.body, BlockFace::Bottom)?;
        }
        Ok(())
    }

    /// Checks that there is room between the bounds of the shape, the counter surface, and the top of the upper body.
    fn validate_heights(&self, blocks: &Blocks, heights: &HeightShape) -> Result<(), SceneError> {
        let place = |x1: f64, x2: f64| format!("counter_surface at ({x1}, {x2})");
        let ShapeBounds { minimum_height, volume: [least, largest], .. } = heights.bounds;
        for [x1, x2] in heights.surface()?.places(blocks.size) {
            let height = self.counter_surface.height(x1, x2);
            SceneError::require(height.is_finite(), place(x1, x2), height, "finite heights over the whole base")?;
            let allowed = format!("at least admissible.minimum_height = {minimum_height} (mm)");
            SceneError::require(height >= minimum_height, place(x1, x2), height, allowed)?;
        }
        let volume = format!("[{least}, {largest}]");
        SceneError::require(
            least <= largest,
            "admissible.volume",
            volume,
            "the smallest volume, then the largest (mm³)",
        )?;
        for [x1, x2] in blocks.grid().places() {
            let height = self.counter_surface.height(x1, x2);
            SceneError::require(height.is_finite(), place(x1, x2), height, "finite heights over the whole base")?;
            if let Some(UpperBody { top, .. }) = self.upper {
                let allowed = format!("above the counter surface, which has the height {height} mm at ({x1}, {x2})");
                SceneError::require(top > height, "upper.top", top, allowed)?;
            }
        }
        Ok(())
    }

    /// Checks the supports and loads of a block, whose contact face takes none of them.
    fn validate_block(name: &str, body: &BodyScene, contact: BlockFace) -> Result<(), SceneError> {
        let check = |part: &str, index: usize, face: &str| {
            let field = format!("{name}.{part}[{index}].face");
            find(&field, face, BlockFace::ALL.iter().map(|face| face.name()))?;
            let allowed = "any face but the contact boundary";
            SceneError::require(face != contact.name(), field, format!("\"{face}\""), allowed)
        };
        for (index, load) in body.loads.iter().enumerate() {
            match (&load.kind, load.place.as_deref()) {
                // It names a volume.
                (LoadKind::BodyForce(_), _) | (_, None) => {}
                (_, Some(face)) => check("loads", index, face)?,
            }
        }
        for (index, support) in body.supports.iter().enumerate() {
            check("supports", index, &support.face)?;
        }
        let vertical = |face: &str| ![BlockFace::Bottom, BlockFace::Top].iter().any(|other| other.name() == face);
        let holds = |held: &Held| matches!(held, Held::Components([_, _, Some(_)]));
        SceneError::require(
            !body.supports.iter().any(|support| holds(&support.held) && vertical(&support.face)),
            format!("{name}.supports: held"),
            "u₃ held on a vertical face",
            "u₃ held on the face opposite to the contact boundary only (it would hold the contact normal)",
        )
    }

    /// The bodies, lower first, for changes.
    pub fn bodies_mut(&mut self) -> impl Iterator<Item = &mut BodyScene> {
        std::iter::once(&mut self.lower).chain(self.upper.as_mut().map(|upper| &mut upper.body))
    }

    /// The bodies with their names, lower first.
    pub fn bodies(&self) -> impl Iterator<Item = (&'static str, &BodyScene)> {
        std::iter::once(("lower", &self.lower)).chain(self.upper.as_ref().map(|upper| ("upper", &upper.body)))
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        if self.upper.is_some() { 2 } else { 1 }
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.shape.control_count()
    }
}
