//! What a scene is made of, and what is allowed.

use crate::body::mesh::BlockFace;
use crate::error::SceneError;
use crate::names::find;
use crate::scene::{Block, BodyScene, ContactScene, CounterSurface, Geometry, Held, LoadKind, Master, NormalKind};
use crate::shape::{Coordinates, LatticeShape, ShapedFace};
use serde::{Deserialize, Serialize};

/// A contact problem: elastic bodies, what touches what, and what the controls move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The name of the scene in reports.
    pub name: String,
    /// The bodies; at least one has controls.
    pub bodies: Vec<BodyScene>,
    /// What touches what, and how.
    pub contacts: Vec<ContactScene>,
}

/// What lies opposite to a face of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Opposite<'s> {
    /// Heights over (x₁, x₂) that do not change.
    Heights(&'s CounterSurface),
    /// Heights of another body that are controls.
    Shaped(usize),
}

impl Scene {
    /// The only body with controls and its block, where the controls are heights of a face.
    pub fn shaped_block(&self) -> Option<(&Block, &LatticeShape)> {
        let mut shaped = self.bodies.iter().filter(|body| body.shape.is_some());
        match (shaped.next(), shaped.next()) {
            (Some(body), None) => Some((body.block()?, body.heights()?)),
            _ => None,
        }
    }

    /// The shape of the only body with controls, where these are heights of a face.
    pub fn heights(&self) -> Option<&LatticeShape> {
        self.shaped_block().map(|(_, heights)| heights)
    }

    /// The shapes of all bodies that controls move.
    pub fn shapes(&self) -> impl Iterator<Item = &LatticeShape> {
        self.bodies.iter().filter_map(|body| body.shape.as_ref())
    }

    /// The scene with changed blocks; bodies of meshes stay as they are.
    #[must_use]
    pub fn with_blocks(mut self, change: impl Fn(&mut Block)) -> Self {
        for body in &mut self.bodies {
            if let Geometry::Block(block) = &mut body.geometry {
                change(block);
            }
        }
        self
    }

    /// The scene with other bricks and subdomains of all its blocks.
    #[must_use]
    pub fn with_bricks(self, bricks: [usize; 3], subdomains: [usize; 3]) -> Self {
        self.with_blocks(|block| (block.bricks, block.subdomains) = (bricks, subdomains))
    }

    /// The scene with changed shapes of its bodies.
    #[must_use]
    pub fn with_shapes(mut self, change: impl Fn(&mut LatticeShape)) -> Self {
        self.bodies.iter_mut().filter_map(|body| body.shape.as_mut()).for_each(change);
        self
    }

    /// The scene with another friction coefficient of all contacts that may slide.
    #[must_use]
    pub fn with_friction(mut self, friction: f64) -> Self {
        self.contacts.iter_mut().filter(|contact| !contact.is_tied()).for_each(|contact| contact.friction = friction);
        self
    }

    /// The largest friction coefficient of the contacts, without those of regions.
    pub fn friction(&self) -> f64 {
        self.contacts.iter().map(|contact| contact.friction).fold(0.0, f64::max)
    }

    /// Whether any contact has friction.
    pub fn has_friction(&self) -> bool {
        self.contacts.iter().any(ContactScene::has_friction)
    }

    /// Number of controls.
    pub fn control_count(&self) -> usize {
        self.bodies.iter().map(BodyScene::control_count).sum()
    }

    /// The controls at the start, body by body: heights, or no displacement, mm.
    pub fn start(&self) -> Vec<f64> {
        self.shapes().flat_map(LatticeShape::start_controls).collect()
    }

    /// What messages call a contact.
    pub(crate) fn contact_field(&self, index: usize) -> String {
        format!("contact[{index}]")
    }

    /// What messages call the obstacle of a contact.
    pub(crate) fn obstacle_field(&self, index: usize) -> String {
        format!("contact[{index}].obstacle")
    }

    /// What lies opposite to a face of a body in a contact where sides may part; none where it has no heights.
    pub(crate) fn opposite(&self, body: usize, face: ShapedFace) -> Option<Opposite<'_>> {
        let is_own = |own: &crate::scene::BodyFace| own.body == body && own.face == face.block_face().name();
        for contact in self.contacts.iter().filter(|contact| !contact.is_tied()) {
            let other = match &contact.master {
                Master::Obstacle(surface) if is_own(&contact.slave) => {
                    return surface.has_heights().then_some(Opposite::Heights(surface));
                }
                Master::Body(master) if is_own(&contact.slave) => master,
                Master::Body(master) if is_own(master) => &contact.slave,
                _ => continue,
            };
            let block = self.bodies.get(other.body)?.block()?;
            let shaped = self.bodies[other.body].heights().and_then(LatticeShape::face);
            return [ShapedFace::Bottom, ShapedFace::Top].into_iter().find_map(|side| {
                (other.face == side.block_face().name()).then(|| match side {
                    _ if shaped == Some(side) => Opposite::Shaped(other.body),
                    ShapedFace::Bottom => Opposite::Heights(&block.bottom),
                    ShapedFace::Top => Opposite::Heights(&block.top),
                })
            });
        }
        None
    }

    /// Checks every field that needs no mesh.
    ///
    /// # Errors
    /// [`SceneError`] naming the field, its value and what is allowed.
    pub fn validate(&self) -> Result<(), SceneError> {
        SceneError::require(!self.bodies.is_empty(), "body", "none", "at least one body")?;
        SceneError::require(!self.contacts.is_empty(), "contact", "none", "at least one contact")?;
        SceneError::require(self.control_count() > 0, "body", "no controls", "a surface or a lattice of some body")?;
        for (index, body) in self.bodies.iter().enumerate() {
            let others = || self.bodies[..index].iter().map(|other| other.name.as_str());
            let is_new = !body.name.is_empty() && others().all(|other| other != body.name);
            let field = format!("body[{index}].name");
            SceneError::require(is_new, field, format!("\"{}\"", body.name), "a name that no other body has")?;
        }
        (0..self.contacts.len()).try_for_each(|index| self.validate_contact(index))?;
        for (index, body) in self.bodies.iter().enumerate() {
            let mut faces = self.contacts.iter().flat_map(ContactScene::faces);
            let takes_part = faces.any(|face| face.body == index);
            let allowed = "bodies that take part in a contact";
            SceneError::require(takes_part, format!("body[{index}]"), format!("\"{}\"", body.name), allowed)?;
        }
        (0..self.bodies.len()).try_for_each(|index| self.validate_body(index))
    }

    fn validate_contact(&self, index: usize) -> Result<(), SceneError> {
        let (contact, field) = (&self.contacts[index], self.contact_field(index));
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let coefficients = contact.friction_by_region.iter().map(|(_, friction)| *friction);
        let name = if self.contacts.len() == 1 { "friction".into() } else { format!("{field}.friction") };
        for friction in std::iter::once(contact.friction).chain(coefficients) {
            SceneError::require(friction == 0.0 || positive(friction), &name, friction, "a finite number ≥ 0")?;
        }
        let interference = contact.interference;
        let place = format!("{field}.interference");
        SceneError::require(interference.is_finite(), place, interference, "a finite number (mm)")?;
        if let Some(clearance) = contact.clearance {
            let valid = clearance.is_finite() && interference == 0.0 && contact.master_face().is_some();
            let allowed = "a finite number (mm), for two bodies, without an interference besides";
            SceneError::require(valid && !contact.is_tied(), format!("{field}.clearance"), clearance, allowed)?;
        }
        let exists = |part: &str, own: &crate::scene::BodyFace| {
            let allowed = format!("one of the {} bodies", self.bodies.len());
            SceneError::require(own.body < self.bodies.len(), format!("{field}.{part}.body"), own.body, allowed)
        };
        exists("slave", &contact.slave)?;
        if let Some(master) = contact.master_face() {
            exists("master", master)?;
            let allowed = "a face of another body: a body that touches itself cannot be solved, since large \
                           displacements alone bring it there";
            let value = format!("\"{}\"", self.bodies[master.body].name);
            SceneError::require(master.body != contact.slave.body, format!("{field}.master.body"), value, allowed)?;
        }
        if contact.is_tied() {
            let allowed = "no friction and no interference between glued faces";
            let valid = contact.friction == 0.0 && contact.friction_by_region.is_empty() && interference == 0.0;
            SceneError::require(valid, format!("{field}.tied"), true, allowed)?;
        }
        self.validate_normals(index)
    }

    /// Checks that the surfaces have the normals that a contact asks for.
    fn validate_normals(&self, index: usize) -> Result<(), SceneError> {
        let contact = &self.contacts[index];
        let Some(surface) = contact.obstacle() else { return Ok(()) };
        surface.check(&self.obstacle_field(index))?;
        let refused = |value: &str, allowed: &str| {
            Err(SceneError::out_of_range(format!("{}.normal", self.contact_field(index)), value, allowed))
        };
        match contact.normal {
            NormalKind::Surface if matches!(surface, CounterSurface::Punch { .. }) => {
                refused("\"surface\"", "\"x3\" with a punch, which has a step")
            }
            NormalKind::X3 if !surface.has_heights() => {
                refused("\"x3\"", "\"surface\" with an obstacle that is no height over x1 and x2")
            }
            _ => Ok(()),
        }
    }

    fn validate_body(&self, index: usize) -> Result<(), SceneError> {
        let body = &self.bodies[index];
        if let Some(shape) = &body.shape {
            shape.validate()?;
        }
        let Geometry::Block(block) = &body.geometry else {
            let in_block = body.shape.as_ref().is_some_and(|shape| shape.coordinates == Coordinates::Block);
            let allowed = "a lattice in space: coordinates along bricks are those of blocks only";
            return SceneError::require(!in_block, "lattice", "the coordinates of a block for a mesh", allowed);
        };
        block.validate(&format!("{}.block", body.name))?;
        if let Some(heights) = body.heights() {
            self.validate_heights(index, block, heights)?;
        }
        self.validate_block(index, block)
    }

    /// Checks that there is room between the bounds of heights and what lies opposite to them.
    fn validate_heights(&self, index: usize, block: &Block, heights: &LatticeShape) -> Result<(), SceneError> {
        let Some(face) = heights.face() else { return Ok(()) };
        let Some(Opposite::Heights(surface)) = self.opposite(index, face) else { return Ok(()) };
        let what = format!("what lies opposite to {} of {}", face.block_face().name(), self.bodies[index].name);
        let place = |[x1, x2]: [f64; 2]| format!("{what} at ({x1}, {x2})");
        let finite = "finite heights over the whole base";
        for at in heights.height_places(block) {
            let height = surface.height(at[0], at[1]);
            SceneError::require(height.is_finite(), place(at), height, finite)?;
            if let (ShapedFace::Top, Some(thickness)) = (face, heights.thickness) {
                let least = block.bottom.height(at[0], at[1]) + thickness;
                let allowed = format!("at least lattice.thickness = {thickness} (mm)");
                SceneError::require(height >= least, place(at), height, allowed)?;
            }
        }
        for at in block.grid().places() {
            let height = surface.height(at[0], at[1]);
            SceneError::require(height.is_finite(), place(at), height, finite)?;
        }
        Ok(())
    }

    /// Checks the faces of a block, and its supports and loads: its contact faces take none of them.
    fn validate_block(&self, index: usize, block: &Block) -> Result<(), SceneError> {
        let body = &self.bodies[index];
        let name = &body.name;
        let start = body.start_block().unwrap_or_else(|| block.clone());
        for [x1, x2] in block.grid().places() {
            let [bottom, top] = [&start.bottom, &start.top].map(|surface| surface.height(x1, x2));
            let place = || format!("{name}.block.bottom at ({x1}, {x2})");
            SceneError::require(bottom.is_finite(), place(), bottom, "finite heights over the whole base")?;
            let allowed = format!("above the bottom, which has the height {bottom} mm at ({x1}, {x2})");
            SceneError::require(top > bottom, format!("{name}.block.top"), top, allowed)?;
        }
        let faces = self.contacts.iter().flat_map(ContactScene::faces);
        let contact: Vec<&str> = faces.filter(|face| face.body == index).map(|face| face.face.as_str()).collect();
        let check = |part: &str, index: usize, face: &str| {
            let field = format!("{name}.{part}[{index}].face");
            find(&field, face, BlockFace::ALL.iter().map(|face| face.name()))?;
            let allowed = "any face but the contact boundary";
            SceneError::require(!contact.contains(&face), field, format!("\"{face}\""), allowed)
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
        let horizontal = contact.iter().any(|face| !vertical(face));
        let holds = |held: &Held| matches!(held, Held::Components([_, _, Some(_)]));
        SceneError::require(
            !(horizontal && body.supports.iter().any(|support| holds(&support.held) && vertical(&support.face))),
            format!("{name}.supports: held"),
            "u₃ held on a vertical face",
            "u₃ held on the face opposite to the contact boundary only (it would hold the contact normal)",
        )
    }
}
