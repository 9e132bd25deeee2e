//! What a scene is made of, and what is allowed.

use crate::body::elasticity::Material;
use crate::body::mesh::{Face, Grid};
use crate::error::SceneError;
use crate::scene::CounterSurface;
use crate::shape::{ShapeBounds, SplineKind, SplineSurface};
use serde::{Deserialize, Serialize};

/// Displacement components held at zero on a face of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// The face that is held.
    pub face: Face,
    /// Which of u₁, u₂, u₃ are zero there.
    pub components: [bool; 3],
}

/// A constant traction on a face of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// The face that is loaded.
    pub face: Face,
    /// Force per area along the axes, MPa.
    pub traction: [f64; 3],
}

/// Material, supports and loads of one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyScene {
    /// The elastic constants of the body.
    pub material: Material,
    /// The faces that are held, with the components.
    pub supports: Vec<Support>,
    /// The faces that are loaded, with the tractions.
    pub loads: Vec<Load>,
}

impl BodyScene {
    /// Which of u₁, u₂, u₃ supports hold at node (i, j, k) of this body.
    pub fn held(&self, grid: &Grid, position: [usize; 3]) -> [bool; 3] {
        let mut held = [false; 3];
        for support in &self.supports {
            if grid.is_on(support.face, position) {
                for (held, component) in held.iter_mut().zip(support.components) {
                    *held |= component;
                }
            }
        }
        held
    }
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
    /// Lengths a, b of the base, mm.
    pub size: [f64; 2],
    /// Bricks along x₁, x₂, x₃ of each body.
    pub mesh: [usize; 3],
    /// Subdomains along x₁, x₂, x₃ of each body.
    pub subdomains: [usize; 3],
    /// The body whose upper surface is optimized.
    pub lower: BodyScene,
    /// The elastic body above; none for a rigid obstacle.
    pub upper: Option<UpperBody>,
    /// F²: the obstacle, or the lower surface of the upper body.
    pub counter_surface: CounterSurface,
    /// Coulomb friction coefficient 𝓕.
    pub friction: f64,
    /// Kind of the spline surface.
    pub surface: SplineKind,
    /// Control points along x₁, x₂.
    pub control_points: [usize; 2],
    /// Constants of the admissible set.
    pub bounds: ShapeBounds,
    /// All controls at the start, mm.
    pub start_height: f64,
}

impl Scene {
    /// Checks every field.
    ///
    /// # Errors
    /// [`SceneError`] naming the field, its value and what is allowed.
    pub fn validate(&self) -> Result<(), SceneError> {
        for (axis, (&mesh, &subdomains)) in self.mesh.iter().zip(&self.subdomains).enumerate() {
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
        for (axis, &length) in self.size.iter().enumerate() {
            SceneError::require(positive(length), format!("size[{axis}]"), length, "a finite length > 0 mm")?;
        }
        let valid = self.friction == 0.0 || positive(self.friction);
        SceneError::require(valid, "friction", self.friction, "a finite number ≥ 0")?;
        let height = self.start_height;
        SceneError::require(positive(height), "surface.start", height, "a finite mean height > 0 mm")?;
        self.validate_heights()?;
        Self::validate_body("lower", &self.lower, Face::Top)?;
        if let Some(upper) = &self.upper {
            Self::validate_body("upper", &upper.body, Face::Bottom)?;
        }
        Ok(())
    }

    /// Checks that there is room between the bounds of the shape, the counter surface, and the top of the upper body.
    fn validate_heights(&self) -> Result<(), SceneError> {
        let place = |x1: f64, x2: f64| format!("counter_surface at ({x1}, {x2})");
        let ShapeBounds { minimum_height, volume: [least, largest], .. } = self.bounds;
        for [x1, x2] in self.spline_surface()?.places(self.size) {
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
        let grid = self.grid();
        for [x1, x2] in grid.columns().map(|(i, j)| grid.position(i, j)) {
            let height = self.counter_surface.height(x1, x2);
            SceneError::require(height.is_finite(), place(x1, x2), height, "finite heights over the whole base")?;
            if let Some(UpperBody { top, .. }) = self.upper {
                let allowed = format!("above the counter surface, which has the height {height} mm at ({x1}, {x2})");
                SceneError::require(top > height, "upper.top", top, allowed)?;
            }
        }
        Ok(())
    }

    fn validate_body(name: &str, body: &BodyScene, contact: Face) -> Result<(), SceneError> {
        let not_on_contact = |part: &str, face: Face| {
            let (field, value) = (format!("{name}.{part}: face"), format!("{face:?}"));
            SceneError::require(face != contact, field, value, "any face but the contact boundary")
        };
        for load in &body.loads {
            for value in load.traction {
                let field = format!("{name}.loads: traction");
                SceneError::require(value.is_finite(), field, value, "finite numbers (MPa)")?;
            }
            not_on_contact("loads", load.face)?;
        }
        body.supports.iter().try_for_each(|support| not_on_contact("supports", support.face))?;
        let vertical = |face: Face| !matches!(face, Face::Bottom | Face::Top);
        SceneError::require(
            !body.supports.iter().any(|support| support.components[2] && vertical(support.face)),
            format!("{name}.supports: held"),
            "u₃ held on a vertical face",
            "u₃ held on the face opposite to the contact boundary only (it would hold the contact normal)",
        )
    }

    /// Sum of the magnitudes of all loads, N, with the sides of all bodies as high as the lower body at the start.
    pub fn load(&self) -> f64 {
        let ([a, b], height) = (self.size, self.start_height);
        let area = |face: Face| match face {
            Face::X1Min | Face::X1Max => b * height,
            Face::X2Min | Face::X2Max => a * height,
            Face::Bottom | Face::Top => a * b,
        };
        let bodies = std::iter::once(&self.lower).chain(self.upper.as_ref().map(|upper| &upper.body));
        let loads = bodies.flat_map(|body| &body.loads);
        loads.map(|load| area(load.face) * load.traction.iter().map(|t| t * t).sum::<f64>().sqrt()).sum()
    }

    /// The bodies, lower first, for changes.
    pub fn bodies_mut(&mut self) -> impl Iterator<Item = &mut BodyScene> {
        std::iter::once(&mut self.lower).chain(self.upper.as_mut().map(|upper| &mut upper.body))
    }

    /// The spline surface of the contact boundary.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] when there are too few control points for the degree.
    pub fn spline_surface(&self) -> Result<SplineSurface, SceneError> {
        SplineSurface::new(self.surface, self.control_points)
    }

    /// The grid that both bodies share.
    pub fn grid(&self) -> Grid {
        Grid { cells: self.mesh, size: self.size }
    }
}
