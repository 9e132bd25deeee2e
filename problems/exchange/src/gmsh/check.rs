//! What a mesh must be before it is written.

use crate::gmsh::error::GmshError;
use crate::gmsh::mesh::{GmshMesh, NodeData};
use std::collections::HashSet;

/// The error that something in a mesh or its data is not allowed.
pub(super) fn refused(what: &'static str, index: impl ToString, found: impl ToString, allowed: &str) -> GmshError {
    GmshError::Mesh { what, index: index.to_string(), found: found.to_string(), allowed: allowed.into() }
}

/// Refuses a mesh that would make a file which cannot be read.
pub(super) fn check(mesh: &GmshMesh, data: &[NodeData]) -> Result<(), GmshError> {
    counted("number of", "node tags", mesh.node_tags.len(), mesh.nodes.len())?;
    if mesh.cells.is_empty() {
        return Err(refused("number of", "cells", 0, "at least 1"));
    }
    for (index, position) in mesh.nodes.iter().enumerate() {
        finite("coordinate of node", index, position)?;
    }
    unique("tag of node", mesh.node_tags.iter().copied())?;
    unique("tag of element (facets, then cells)", element_tags(mesh))?;
    for (index, cell) in mesh.cells.iter().enumerate() {
        counted("number of nodes of cell", index, cell.nodes.len(), cell.kind.node_count())?;
    }
    for (index, facet) in mesh.facets.iter().enumerate() {
        counted("number of nodes of facet", index, facet.nodes.len(), facet.kind.node_count())?;
    }
    for name in mesh.volumes.keys().chain(mesh.surfaces.keys()).chain(mesh.node_groups.keys()) {
        printable("name of group", name)?;
    }
    check_group_tags(mesh)?;
    data.iter().try_for_each(|field| check_data(field, mesh))
}

fn check_group_tags(mesh: &GmshMesh) -> Result<(), GmshError> {
    let mut seen = HashSet::new();
    for ((dimension, name), &tag) in &mesh.group_tags {
        if tag == 0 || i32::try_from(tag).is_err() || !seen.insert((dimension, tag)) {
            let allowed = "numbers from 1 to 2^31 - 1, each once per dimension";
            return Err(refused("tag of group", name, tag, allowed));
        }
    }
    Ok(())
}

/// Tags of all facets and cells.
pub(super) fn element_tags(mesh: &GmshMesh) -> impl Iterator<Item = u64> {
    mesh.facets.iter().map(|facet| facet.tag).chain(mesh.cells.iter().map(|cell| cell.tag))
}

fn check_data(field: &NodeData, mesh: &GmshMesh) -> Result<(), GmshError> {
    printable("name of field", &field.name)?;
    if ![1, 3, 9].contains(&field.components) {
        return Err(refused("number of components of field", &field.name, field.components, "1, 3, 9"));
    }
    counted("number of values of field", &field.name, field.values.len(), field.components * mesh.nodes.len())?;
    // The format has tags of 32 bits in data.
    if let Some((index, tag)) = mesh.node_tags.iter().enumerate().find(|(_, tag)| i32::try_from(**tag).is_err()) {
        return Err(refused("tag of node", index, tag, "tags up to 2^31 - 1 in a file with fields"));
    }
    finite("value of field", &field.name, &field.values)
}

fn finite(what: &'static str, index: impl ToString, values: &[f64]) -> Result<(), GmshError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(refused(what, index, value, "finite numbers")),
        None => Ok(()),
    }
}

fn unique(what: &'static str, tags: impl Iterator<Item = u64>) -> Result<(), GmshError> {
    let mut seen = HashSet::new();
    for (index, tag) in tags.enumerate() {
        if tag == 0 || !seen.insert(tag) {
            return Err(refused(what, index, tag, "positive numbers, each once"));
        }
    }
    Ok(())
}

fn counted(what: &'static str, index: impl ToString, found: usize, expected: usize) -> Result<(), GmshError> {
    if found == expected { Ok(()) } else { Err(refused(what, index, found, &expected.to_string())) }
}

/// A name stands in quotation marks on one line.
fn printable(what: &'static str, name: &str) -> Result<(), GmshError> {
    if !name.is_empty() && !name.contains(['"', '\n']) {
        return Ok(());
    }
    let allowed = "text without quotation marks, on one line";
    Err(refused(what, format!("{name:?}"), "not one that the file can hold", allowed))
}
