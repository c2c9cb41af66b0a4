//! The native module of the Python package `posecut`: graphs, their arrays, and the stages that run on them.
//!
//! The classes that users see are in `python/posecut`; this module holds what needs Rust. A `graph::Graph` never changes: a stage
//! returns another one. Work runs in a thread of its own, without the interpreter's lock (`work`).

#![allow(clippy::needless_pass_by_value, reason = "arguments of Python are extracted as values")]

mod arrays;
mod assembly;
mod columns;
mod error;
mod files;
mod graph;
mod messages;
mod stages;
mod work;

use pyo3::prelude::*;

/// What Python imports.
#[pymodule(name = "_posecut")]
fn native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<error::Error>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<graph::Graph>()?;
    module.add_function(wrap_pyfunction!(files::read, module)?)?;
    module.add_function(wrap_pyfunction!(files::from_bytes, module)?)?;
    module.add_function(wrap_pyfunction!(assembly::from_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(stages::names, module)?)?;
    module.add_function(wrap_pyfunction!(stages::help, module)?)
}
