//! Entities and blocks of the file that holds a mesh.

use crate::gmsh::check::{element_tags, refused};
use crate::gmsh::contents::MAX_GROUPS;
use crate::gmsh::elements::ElementKind;
use crate::gmsh::error::GmshError;
use crate::gmsh::mesh::GmshMesh;
use std::collections::{BTreeMap, HashMap, HashSet};

/// What a file states about physical groups and elements.
#[derive(Default)]
pub(super) struct Layout<'m> {
    /// (dimension, tag, name) of each physical group.
    pub(super) names: Vec<(usize, i32, &'m str)>,
    /// Entities of each dimension.
    pub(super) entities: [Vec<Entity>; 4],
    pub(super) blocks: Vec<Block>,
}

/// An entity: what its elements have in common is their set of physical groups.
pub(super) struct Entity {
    pub(super) tag: i32,
    /// Smallest coordinates.
    pub(super) low: [f64; 3],
    /// Largest coordinates.
    pub(super) high: [f64; 3],
    /// Tags of its physical groups.
    pub(super) physical: Vec<i32>,
}

/// Consecutive elements of one type on one entity.
pub(super) struct Block {
    pub(super) dimension: usize,
    pub(super) entity: i32,
    pub(super) kind: ElementKind,
    /// Tag of each element and tags of its nodes.
    pub(super) elements: Vec<(u64, Vec<u64>)>,
}

/// An element to be written: kind, tag, ids of its nodes.
type Element<'m> = (ElementKind, u64, &'m [usize]);

impl<'m> Layout<'m> {
    /// The layout of a mesh: points of the groups of nodes, facets, cells.
    pub(super) fn new(mesh: &'m GmshMesh) -> Result<Self, GmshError> {
        let mut layout = Self::default();
        let own: HashSet<u32> = mesh.group_tags.values().copied().collect();
        let mut free = (1..=i32::MAX).filter(|tag| !own.contains(&tag.unsigned_abs()));
        let node_groups = layout.groups_of(mesh, (0, mesh.nodes.len()), &mesh.node_groups, &mut free)?;
        let facet_groups = layout.groups_of(mesh, (2, mesh.facets.len()), &mesh.surfaces, &mut free)?;
        let cell_groups = layout.groups_of(mesh, (3, mesh.cells.len()), &mesh.volumes, &mut free)?;
        // Points become elements, whose tags must be free.
        let used: HashSet<u64> = element_tags(mesh).collect();
        let free = (1..).filter(|tag| !used.contains(tag));
        let in_groups = node_groups.into_iter().enumerate().filter(|(_, groups)| !groups.is_empty());
        for ((id, groups), tag) in in_groups.zip(free) {
            // A point is a place: each node has its own.
            let entity = layout.add_entity(0, groups);
            layout.add_element(mesh, (0, entity), (ElementKind::Point, tag, &[id]))?;
        }
        let facets = mesh.facets.iter().map(|facet| (ElementKind::Facet(facet.kind), facet.tag, &*facet.nodes));
        layout.add_elements(mesh, 2, facets.zip(facet_groups))?;
        let cells = mesh.cells.iter().map(|cell| (ElementKind::Cell(cell.kind), cell.tag, &*cell.nodes));
        layout.add_elements(mesh, 3, cells.zip(cell_groups))?;
        Ok(layout)
    }

    /// Numbers the groups of a dimension that have no tag, and lists those of each of its `count` members.
    fn groups_of(
        &mut self,
        mesh: &GmshMesh,
        (dimension, count): (usize, usize),
        groups: &'m BTreeMap<String, Vec<usize>>,
        free: &mut impl Iterator<Item = i32>,
    ) -> Result<Vec<Vec<i32>>, GmshError> {
        let mut of_member = vec![Vec::new(); count];
        for (name, members) in groups {
            let own = mesh.group_tags.get(&(dimension, name.clone()));
            // Tags beyond 32 bits were refused, and as many groups do not fit into memory.
            let Some(tag) = own.map(|tag| *tag as i32).or_else(|| free.next()) else { break };
            self.names.push((dimension, tag, name));
            for &member in members {
                let Some(tags) = of_member.get_mut(member) else {
                    return Err(refused("member of group", name, member, &format!("numbers below {count}")));
                };
                if tags.last() != Some(&tag) {
                    tags.push(tag);
                }
                if tags.len() > MAX_GROUPS {
                    let allowed = format!("at most {MAX_GROUPS}");
                    return Err(refused("number of groups with member", member, tags.len(), &allowed));
                }
            }
        }
        Ok(of_member)
    }

    fn add_elements(
        &mut self,
        mesh: &GmshMesh,
        dimension: usize,
        elements: impl Iterator<Item = (Element<'m>, Vec<i32>)>,
    ) -> Result<(), GmshError> {
        let mut entity_of_groups = HashMap::new();
        for (element, groups) in elements {
            let entity =
                *entity_of_groups.entry(groups).or_insert_with_key(|groups| self.add_entity(dimension, groups.clone()));
            self.add_element(mesh, (dimension, entity), element)?;
        }
        Ok(())
    }

    /// Adds an entity; returns its place among those of its dimension.
    fn add_entity(&mut self, dimension: usize, physical: Vec<i32>) -> usize {
        let entities = &mut self.entities[dimension];
        // As many entities as 32 bits can count do not fit into memory.
        let tag = entities.len() as i32 + 1;
        entities.push(Entity { tag, low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], physical });
        entities.len() - 1
    }

    /// Adds an element to an entity, in the last block if that is one of its entity and type.
    fn add_element(
        &mut self,
        mesh: &GmshMesh,
        (dimension, place): (usize, usize),
        (kind, tag, ids): Element,
    ) -> Result<(), GmshError> {
        let entity = &mut self.entities[dimension][place];
        let mut nodes = Vec::with_capacity(ids.len());
        for &id in ids {
            let (Some(position), Some(node)) = (mesh.nodes.get(id), mesh.node_tags.get(id)) else {
                let allowed = format!("numbers below {}", mesh.nodes.len());
                return Err(refused("node of element", tag, id, &allowed));
            };
            nodes.push(*node);
            for axis in 0..3 {
                entity.low[axis] = entity.low[axis].min(position[axis]);
                entity.high[axis] = entity.high[axis].max(position[axis]);
            }
        }
        let entity = entity.tag;
        match self.blocks.last_mut() {
            Some(block) if (block.dimension, block.entity, block.kind) == (dimension, entity, kind) => {
                block.elements.push((tag, nodes));
            }
            _ => self.blocks.push(Block { dimension, entity, kind, elements: vec![(tag, nodes)] }),
        }
        Ok(())
    }
}
