//! Isotropic linear elasticity: σ = λ tr(ε) I + 2 μ ε, and how bricks discretise its volumetric part.

use crate::error::SceneError;

/// Treatment of the volume change in a brick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "FormulationName", transform = crate::schema::names_only))]
#[non_exhaustive]
pub enum Formulation {
    /// At every Gauss point. Locks when ν approaches ½.
    #[default]
    Standard,
    /// As the mean over the brick (B-bar with mean dilatation): the remedy against volumetric locking.
    MeanDilatation,
}

/// Poisson's ratio above which a material counts as nearly incompressible: up to it, Krylov methods do not notice.
const NEARLY_INCOMPRESSIBLE: f64 = 0.49;

/// Young's modulus and Poisson's ratio of an isotropic material, the formulation of its bricks, and its density.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Material {
    young_modulus: f64,
    poisson_ratio: f64,
    #[serde(default)]
    formulation: Formulation,
    #[serde(default)]
    density: Option<f64>,
}

impl Material {
    /// Young's modulus E in MPa, Poisson's ratio ν.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless E > 0 and −1 < ν < 0.5.
    pub fn new(young_modulus: f64, poisson_ratio: f64) -> Result<Self, SceneError> {
        let valid = young_modulus > 0.0 && young_modulus.is_finite();
        SceneError::require(valid, "Young's modulus", young_modulus, "a finite number > 0 (MPa)")?;
        let valid = poisson_ratio > -1.0 && poisson_ratio < 0.5;
        SceneError::require(valid, "Poisson's ratio", poisson_ratio, "−1 < ν < 0.5")?;
        Ok(Self { young_modulus, poisson_ratio, formulation: Formulation::default(), density: None })
    }

    /// Replaces the formulation of the bricks.
    #[must_use]
    pub fn with_formulation(self, formulation: Formulation) -> Self {
        Self { formulation, ..self }
    }

    /// Gives the material a density, kg/m³.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] unless it is finite and > 0.
    pub fn with_density(self, density: f64) -> Result<Self, SceneError> {
        let valid = density > 0.0 && density.is_finite();
        SceneError::require(valid, "density", density, "a finite number > 0 (kg/m³)")?;
        Ok(Self { density: Some(density), ..self })
    }

    /// The density in kg/m³, where it is known.
    pub fn density(&self) -> Option<f64> {
        self.density
    }

    /// A material of the same shear modulus and formulation that can be compressed, for a nearly incompressible one.
    /// Where a body may evade a change of volume, its stiffness is that of shear, and this material has it; standard
    /// bricks can evade less, so that theirs is stiffer.
    pub fn compressible_neighbour(&self) -> Option<Self> {
        let poisson_ratio = match self.formulation {
            Formulation::Standard => NEARLY_INCOMPRESSIBLE,
            Formulation::MeanDilatation => 0.45,
        };
        let young_modulus = 2.0 * self.shear_modulus() * (1.0 + poisson_ratio);
        (self.poisson_ratio > NEARLY_INCOMPRESSIBLE).then_some(Self { young_modulus, poisson_ratio, ..*self })
    }

    /// How bricks of this material see the change of volume.
    pub fn formulation(&self) -> Formulation {
        self.formulation
    }

    /// Young's modulus E in MPa.
    pub fn young_modulus(&self) -> f64 {
        self.young_modulus
    }

    /// Poisson's ratio ν of the law in use.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// Lamé's λ in MPa.
    pub fn lame_lambda(&self) -> f64 {
        let nu = self.poisson_ratio;
        self.young_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Shear modulus μ in MPa.
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// Bulk modulus κ = λ + ⅔μ in MPa.
    pub(crate) fn bulk_modulus(&self) -> f64 {
        self.young_modulus / (3.0 * (1.0 - 2.0 * self.poisson_ratio))
    }
}
