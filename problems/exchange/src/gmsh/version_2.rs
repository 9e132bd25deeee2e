//! Nodes and elements of a Gmsh file of version 2.2. An element has a physical group of its own, and stands there once
//! for each of several ones.

use crate::gmsh::contents::{Block, Contents, group_tag, new_tag};
use crate::gmsh::elements::{ElementKind, element_kind};
use crate::gmsh::error::GmshError;
use crate::gmsh::source::{Form, Source};
use std::collections::HashSet;
use std::rc::Rc;

/// What elements in sequence have in common in a binary file, and what an element says in a text.
struct Head {
    kind: ElementKind,
    dimension: usize,
    nodes: usize,
    /// How many elements follow.
    count: usize,
    /// Tags of the element: physical group, entity, partitions.
    tags: usize,
}

/// Reads `$Nodes`.
pub(super) fn nodes(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    const TAG: &str = "the tag of a node";
    for _ in 0..text_count(source, "the number of nodes")? {
        let tag = tag(source, TAG)?;
        contents.node_tags.push(new_tag(source, TAG, tag, &mut contents.known_nodes)?);
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            *coordinate = source.finite("the coordinate of a node")?;
        }
        contents.nodes.push(position);
    }
    Ok(())
}

/// Reads `$Elements`.
pub(super) fn elements(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    let mut left = text_count(source, "the number of elements")?;
    let mut seen = HashSet::new();
    while left > 0 {
        let first = (source.form() == Form::Text).then(|| element_tag(source, &mut seen)).transpose()?;
        let head = head(source, left)?;
        left -= head.count;
        for _ in 0..head.count {
            let tag = first.map_or_else(|| element_tag(source, &mut seen), Ok)?;
            let physical = physical_group(source, &head)?;
            let nodes = (0..head.nodes).map(|_| self::tag(source, "the tag of a node of an element"));
            let element = (tag, nodes.collect::<Result<Vec<u64>, GmshError>>()?);
            add(contents, &head, physical, element);
        }
    }
    Ok(())
}

/// The head of elements, of which so many are left.
fn head(source: &mut Source, left: usize) -> Result<Head, GmshError> {
    const COUNT: &str = "the number of elements of one type";
    let number = source.int("the type of elements")?;
    let place = source.place();
    let (kind, dimension, nodes) =
        element_kind(number).map_err(|name| GmshError::ElementType { place, entity: None, number, name })?;
    let count = match source.form() {
        Form::Text => 1,
        Form::Little | Form::Big => {
            let found = source.int(COUNT)?;
            let count = usize::try_from(found).ok().filter(|count| (1..=left).contains(count));
            count.ok_or_else(|| {
                source.refused(COUNT, found, format!("whole numbers from 1 to {left}, which are left"))
            })?
        }
    };
    let tags = source.int_in("the number of tags of an element", 0..=i32::MAX)?;
    Ok(Head { kind, dimension, nodes, count, tags })
}

/// The physical group of the next element: the first one of its tags, 0 for none.
fn physical_group(source: &mut Source, head: &Head) -> Result<u32, GmshError> {
    let mut physical = 0;
    for index in 0..head.tags {
        match index {
            0 => physical = group_tag(source, "the physical group of an element")?,
            _ => _ = source.int("a tag of an element")?,
        }
    }
    Ok(physical)
}

/// Adds an element, in the last block if that has elements like this.
fn add(contents: &mut Contents, head: &Head, physical: u32, element: (u64, Vec<u64>)) {
    let physical = if physical == 0 { &[][..] } else { &[physical] };
    match contents.blocks.last_mut() {
        Some(block) if block.kind == head.kind && *block.physical == *physical => block.elements.push(element),
        _ => {
            physical.iter().for_each(|tag| contents.groups.open((head.dimension, *tag)));
            let (kind, dimension) = (head.kind, head.dimension);
            contents.blocks.push(Block { kind, dimension, physical: Rc::from(physical), elements: vec![element] });
        }
    }
}

/// A count, which is a line of text in binary files too.
fn text_count(source: &mut Source, what: &'static str) -> Result<usize, GmshError> {
    let count = source.text_in(what, 0..=i32::MAX)?;
    source.skip_line();
    Ok(count)
}

fn element_tag(source: &mut Source, seen: &mut HashSet<u64>) -> Result<u64, GmshError> {
    const TAG: &str = "the tag of an element";
    let tag = tag(source, TAG)?;
    new_tag(source, TAG, tag, seen)
}

/// A tag: a positive number of 32 bits.
fn tag(source: &mut Source, what: &'static str) -> Result<u64, GmshError> {
    Ok(source.int_in(what, 1..=i32::MAX)? as u64)
}
