//! A Gmsh file read as a mesh.

use crate::gmsh::contents::Contents;
use crate::gmsh::elements::ElementKind;
use crate::gmsh::error::GmshError;
use crate::gmsh::mesh::{GmshCell, GmshFacet, GmshMesh};
use crate::gmsh::sections::{Part, first_line, part};
use crate::gmsh::source::Source;
use std::collections::{HashMap, HashSet};

/// Reads a Gmsh file of version 4.1 or 2.2, text or binary in either byte order.
///
/// # Errors
/// [`GmshError`] for another version, a partitioned mesh, elements other than those of [`GmshMesh`], lines and points,
/// a file that is damaged or contradicts itself, a second mesh that differs from the first one, a mesh without volume
/// elements, and elements of physical groups on nodes that no volume element uses.
pub fn read(bytes: &[u8]) -> Result<GmshMesh, GmshError> {
    read_elements(bytes, false)
}

/// Reads a mesh that may consist of surface elements alone; its nodes are theirs then.
///
/// # Errors
/// As [`read`].
pub fn read_surfaces(bytes: &[u8]) -> Result<GmshMesh, GmshError> {
    read_elements(bytes, true)
}

fn read_elements(bytes: &[u8], may_be_surface: bool) -> Result<GmshMesh, GmshError> {
    let mut source = Source::new(bytes);
    first_line(&mut source)?;
    let mut mesh = None;
    loop {
        let Part { contents, has_mesh, is_followed } = part(&mut source)?;
        if has_mesh {
            let mut used = used_nodes(&contents, |kind| matches!(kind, ElementKind::Cell(_)))?;
            if used.is_empty() && may_be_surface {
                used = used_nodes(&contents, |kind| matches!(kind, ElementKind::Facet(_)))?;
            }
            if used.is_empty() {
                return Err(GmshError::Missing { place: source.place(), what: "volume elements (hex8, tet4, tet10)" });
            }
            let found = self::mesh(contents, &used)?;
            match &mesh {
                None => mesh = Some(found),
                Some(first) if *first == found => {}
                Some(_) => {
                    let allowed = "the mesh before it, which Gmsh repeats where it appends a view";
                    return Err(source.refused("the mesh after a second $MeshFormat", "another one", allowed));
                }
            }
        }
        if !is_followed {
            let what = "the section $Nodes, which holds the nodes";
            return mesh.ok_or_else(|| GmshError::Missing { place: source.place(), what });
        }
    }
}

/// Tags of the nodes that some kinds of elements use. All elements must be on nodes of the file.
fn used_nodes(contents: &Contents, counts: impl Fn(ElementKind) -> bool) -> Result<HashSet<u64>, GmshError> {
    let mut used = HashSet::new();
    for block in &contents.blocks {
        for (element, nodes) in &block.elements {
            if let Some(&node) = nodes.iter().find(|node| !contents.known_nodes.contains(node)) {
                return Err(GmshError::UnknownNode { element: *element, node });
            }
            if counts(block.kind) {
                used.extend(nodes);
            }
        }
    }
    Ok(used)
}

/// The mesh on the nodes with the tags `used`.
fn mesh(contents: Contents, used: &HashSet<u64>) -> Result<GmshMesh, GmshError> {
    let Contents { mut groups, nodes, node_tags, blocks, .. } = contents;
    let mut mesh = GmshMesh::default();
    let mut ids = HashMap::new();
    for (tag, position) in node_tags.into_iter().zip(nodes).filter(|(tag, _)| used.contains(tag)) {
        ids.insert(tag, mesh.nodes.len());
        mesh.nodes.push(position);
        mesh.node_tags.push(tag);
    }
    for block in blocks {
        let dimension = block.dimension;
        for (tag, nodes) in block.elements {
            let found =
                nodes.iter().map(|node| ids.get(node).copied().ok_or(*node)).collect::<Result<Vec<usize>, u64>>();
            let nodes = match (found, block.physical.first()) {
                (Ok(nodes), _) => nodes,
                (Err(node), Some(&group)) => {
                    let group = groups.name_of((dimension, group));
                    return Err(GmshError::Detached { element: tag, group, node });
                }
                (Err(_), None) => continue,
            };
            let members = match block.kind {
                ElementKind::Cell(kind) => {
                    mesh.cells.push(GmshCell { kind, nodes, tag });
                    vec![mesh.cells.len() - 1]
                }
                ElementKind::Facet(kind) => {
                    mesh.facets.push(GmshFacet { kind, nodes, tag });
                    vec![mesh.facets.len() - 1]
                }
                ElementKind::Line | ElementKind::Point => nodes,
            };
            for group in &*block.physical {
                members.iter().for_each(|member| groups.add((dimension, *group), *member));
            }
        }
    }
    mesh.group_tags = groups.tags();
    mesh.volumes = groups.by_name(3..=3)?;
    mesh.surfaces = groups.by_name(2..=2)?;
    mesh.node_groups = groups.by_name(0..=1)?;
    Ok(mesh)
}
