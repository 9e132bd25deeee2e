//! The Python module `nonsmooth._engine`: what the package `nonsmooth` (python/package) needs of the engine.
//!
//! The package checks and arranges what a user passes; this module calls the user's function (`oracle`), drives the run
//! (`run`) and hands out reports and certificates (`outcome`, `certificate`). Vectors are copied between the languages.

#![forbid(unsafe_code)]

mod certificate;
#[cfg(feature = "collection")]
mod collection;
#[cfg(feature = "contact")]
mod contact_mesh;
#[cfg(feature = "contact")]
mod contact_run;
#[cfg(feature = "contact")]
mod contact_scene;
#[cfg(feature = "contact")]
mod contact_state;
mod convert;
mod errors;
mod failure;
mod nonlinear;
mod oracle;
mod outcome;
mod outer;
mod run;
mod setup;
mod taylor;
mod watched;

use pyo3::prelude::*;

#[pymodule]
fn _engine(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", nonsmooth::VERSION)?;
    module.add_function(wrap_pyfunction!(run::minimize, module)?)?;
    module.add_function(wrap_pyfunction!(taylor::taylor_test, module)?)?;
    module.add_class::<certificate::Certificate>()?;
    module.add("OutsideDomain", module.py().get_type::<errors::OutsideDomain>())?;
    module.add("InfeasibleError", module.py().get_type::<errors::InfeasibleError>())?;
    #[cfg(feature = "contact")]
    {
        module.add_class::<contact_scene::ContactScene>()?;
        module.add_function(wrap_pyfunction!(contact_scene::new_scene, module)?)?;
    }
    #[cfg(feature = "collection")]
    {
        module.add_class::<collection::CollectionProblem>()?;
        module.add_class::<collection::ConstrainedProblem>()?;
    }
    Ok(())
}
