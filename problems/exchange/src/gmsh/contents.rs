//! What the sections of a file of either version hold.

use crate::gmsh::elements::ElementKind;
use crate::gmsh::error::GmshError;
use crate::gmsh::groups::Groups;
use crate::gmsh::source::Source;
use std::collections::HashSet;
use std::rc::Rc;

/// What a file holds, before tags are resolved.
#[derive(Default)]
pub(super) struct Contents {
    pub(super) groups: Groups,
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) node_tags: Vec<u64>,
    /// The tags of the nodes once more.
    pub(super) known_nodes: HashSet<u64>,
    pub(super) blocks: Vec<Block>,
}

/// Elements of one kind in the same physical groups.
pub(super) struct Block {
    pub(super) kind: ElementKind,
    pub(super) dimension: usize,
    /// Tags of the physical groups.
    pub(super) physical: Rc<[u32]>,
    /// Tag of each element and tags of its nodes.
    pub(super) elements: Vec<(u64, Vec<u64>)>,
}

/// Most physical groups of an entity. Members of groups grow with the product of elements and groups, and their memory
/// must be in proportion to the file.
pub(super) const MAX_GROUPS: usize = 32;

/// What is allowed where a tag or a section must be new.
pub(super) const NEW: &str = "one that has not appeared before";

/// The tag of a node or an element, which must not be among the tags before.
pub(super) fn new_tag(
    source: &Source,
    what: &'static str,
    tag: u64,
    tags: &mut HashSet<u64>,
) -> Result<u64, GmshError> {
    if tags.insert(tag) { Ok(tag) } else { Err(source.refused(what, tag, NEW)) }
}

/// The tag of a physical group without its sign, which states an orientation.
pub(super) fn group_tag(source: &mut Source, what: &'static str) -> Result<u32, GmshError> {
    let tag = source.int(what)?;
    let positive = tag.checked_abs().ok_or_else(|| source.refused(what, tag, "numbers above -2^31"))?;
    Ok(positive.unsigned_abs())
}
