//! The fields of a scene file that options of the command line override.

use crate::commands::arguments::Arguments;
use clap::Parser;
use contact::error::SceneError;
use contact::shape::SplineKind;
use scene_file::{MeasureName, MethodName, ObjectiveSection, SceneFile, SplineName, default_subdomains};

/// Largest traction of a scene, MPa.
const LARGEST_TRACTION: f64 = 1e15;

impl Arguments {
    /// The options that stand for fields of the scene, with the fields and whether they are given.
    fn fields(&self) -> [(&'static str, &'static str, bool); 17] {
        [
            ("mesh", "mesh.bricks", self.mesh.is_some()),
            ("subdomains", "mesh.subdomains", self.subdomains.is_some()),
            ("friction", "friction", self.friction.is_some()),
            ("surface", "surface.spline", self.surface.is_some()),
            ("surface", "surface.degree", self.surface.is_some()),
            ("control_points", "surface.control_points", self.control_points.is_some()),
            ("poisson_ratio", "lower.material.poisson_ratio", self.poisson_ratio.is_some()),
            ("young_modulus", "lower.material.young_modulus", self.young_modulus.is_some()),
            ("formulation", "lower.material.formulation", self.formulation.is_some()),
            ("solver", "solver.kind", self.solver.is_some()),
            ("preconditioner", "solver.preconditioner", self.preconditioner.is_some()),
            ("objective", "objective.measure", self.objective.is_some()),
            ("exponent", "objective.exponent", self.exponent.is_some()),
            ("optimizer", "optimizer.method", self.optimizer.is_some()),
            ("max_evaluations", "optimizer.max_evaluations", self.max_evaluations.is_some()),
            ("continuation", "optimizer.continuation", self.continuation.is_some()),
            ("starts", "optimizer.starts", self.starts.is_some()),
        ]
    }

    /// Help that says what holds where an option is not given: the field of a scene, or its value in the scene of the binary.
    pub fn help_with_defaults(mut command: clap::Command, scene: Option<&SceneFile>) -> clap::Command {
        let Ok(nothing) = Self::try_parse_from(["help"]) else { return command };
        for (option, field, _) in nothing.fields().into_iter().filter(|(_, field, _)| *field != "surface.degree") {
            let default = scene.map_or_else(|| format!("{field} of the scene"), |scene| scene.value(field));
            command = command.mut_arg(option, |argument| {
                let meaning = argument.get_help().map(ToString::to_string).unwrap_or_default();
                argument.help(format!("{meaning} [default: {default}]"))
            });
        }
        command
    }

    /// An error in the words of the command line where an option is at fault.
    pub fn blame(&self, error: SceneError) -> SceneError {
        let source = if let SceneError::InFile { source, .. } = &error { source } else { &error };
        let SceneError::OutOfRange { field, value, allowed } = source else { return error };
        let fields = self.fields();
        match fields.iter().find(|(_, path, given)| *given && field.starts_with(path)) {
            Some((option, ..)) => SceneError::out_of_range(format!("--{}", option.replace('_', "-")), value, allowed),
            None => error,
        }
    }

    /// The scene file with the options put in; checked when it becomes a case.
    ///
    /// # Errors
    /// [`SceneError::OutOfRange`] for loads beyond what a scene may have.
    pub fn apply(&self, mut file: SceneFile) -> Result<SceneFile, SceneError> {
        let mesh = &mut file.mesh;
        if let Some(bricks) = self.mesh {
            mesh.bricks = bricks;
            // Subdomains of the file that do not fit the new mesh give way to those that do.
            let fits = |counts: &[usize; 3]| bricks.iter().zip(counts).all(|(n, &count)| count > 0 && n % count == 0);
            mesh.subdomains = Some(mesh.subdomains.filter(fits).unwrap_or(bricks.map(default_subdomains)));
        }
        mesh.subdomains = self.subdomains.map(|count| [count; 3]).or(mesh.subdomains);
        file.friction = self.friction.unwrap_or(file.friction);
        if let Some(kind) = self.surface {
            (file.surface.spline, file.surface.degree) = match kind {
                SplineKind::BSpline(degree) => (SplineName::Bspline, Some(degree)),
                SplineKind::Bezier => (SplineName::Bezier, None),
            };
        }
        file.surface.control_points = self.control_points.unwrap_or(file.surface.control_points);
        let material = &mut file.lower.material;
        material.young_modulus = self.young_modulus.unwrap_or(material.young_modulus);
        material.poisson_ratio = self.poisson_ratio.unwrap_or(material.poisson_ratio);
        if let Some(formulation) = self.formulation {
            let upper = file.upper.iter_mut().map(|upper| &mut upper.material);
            std::iter::once(&mut file.lower.material).chain(upper).for_each(|m| m.formulation = formulation);
        }
        if let Some(factor) = self.load_factor {
            let upper = file.upper.iter_mut().flat_map(|upper| &mut upper.loads);
            for load in file.lower.loads.iter_mut().chain(upper) {
                for traction in &mut load.traction {
                    let scaled = factor * *traction;
                    if scaled.abs() > LARGEST_TRACTION {
                        let allowed =
                            format!("|traction| ≤ {LARGEST_TRACTION:e} MPa, here {factor:e} times {traction:e}");
                        return Err(SceneError::out_of_range("--load-factor", format!("{factor:e}"), allowed));
                    }
                    *traction = scaled;
                }
            }
        }
        file.solver.kind = self.solver.unwrap_or(file.solver.kind);
        file.solver.preconditioner = self.preconditioner.unwrap_or(file.solver.preconditioner);
        self.apply_objective(&mut file);
        file.optimizer.max_evaluations = self.max_evaluations.unwrap_or(file.optimizer.max_evaluations);
        file.optimizer.time_limit = self.time_limit.or(file.optimizer.time_limit);
        if let Some(meshes) = &self.continuation {
            file.optimizer.continuation.clone_from(meshes);
        }
        file.optimizer.starts = self.starts.unwrap_or(file.optimizer.starts);
        if let Some(folder) = &self.out {
            file.output.folder = Some(folder.display().to_string());
        }
        Ok(file)
    }

    /// Puts the objective and the method in; what a file says for another objective does not hold for this one.
    fn apply_objective(&self, file: &mut SceneFile) {
        if let Some(measure) = self.objective.filter(|measure| *measure != file.objective.measure) {
            // Exponent, wanted pressure and region of the file belong to the file's measure.
            file.objective = ObjectiveSection { measure, ..ObjectiveSection::default() };
        }
        file.objective.exponent = self.exponent.or(file.objective.exponent);
        let has_model = !matches!(file.objective.measure, MeasureName::StressNorm | MeasureName::Compliance);
        if self.objective.is_some() && !has_model {
            // The file's method belongs to the file's measure.
            file.optimizer.method = file.optimizer.method.filter(|method| *method != MethodName::Composite);
        }
        file.optimizer.method = self.optimizer.or(file.optimizer.method);
    }
}
