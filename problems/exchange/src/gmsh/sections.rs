//! The sections of a Gmsh file, one by one.

use crate::gmsh::elements::{ElementKind, element_kind};
use crate::gmsh::error::GmshError;
use crate::gmsh::groups::Groups;
use crate::gmsh::source::{Form, Source, extract};
use std::collections::{BTreeSet, HashMap, HashSet};
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

/// Elements of one kind on one entity.
pub(super) struct Block {
    pub(super) kind: ElementKind,
    pub(super) dimension: usize,
    /// Tags of the physical groups of the entity.
    pub(super) physical: Rc<[u32]>,
    /// Tag of each element and tags of its nodes.
    pub(super) elements: Vec<(u64, Vec<u64>)>,
}

/// (dimension, tag) of an entity → tags of its physical groups.
type Entities = HashMap<(usize, i32), Rc<[u32]>>;

/// Most physical groups of an entity. Members of groups grow with the product of elements and groups, and their memory
/// must be in proportion to the file.
pub(super) const MAX_GROUPS: usize = 32;

/// What is allowed where a tag or a section must be new.
const NEW: &str = "one that has not appeared before";

/// Reads all sections.
pub(super) fn contents(source: &mut Source) -> Result<Contents, GmshError> {
    format(source)?;
    let (mut contents, mut entities, mut seen) = (Contents::default(), None, BTreeSet::new());
    while let Some(head) = source.line() {
        let name = extract(head);
        let Some(word) = head.strip_prefix(b"$").filter(|word| !word.starts_with(b"End")) else {
            return Err(source.refused("what follows a section", name, "another section, such as $Nodes"));
        };
        let end = [b"$End", word].concat();
        let is_read = matches!(&*name, "$PhysicalNames" | "$Entities" | "$Nodes" | "$Elements");
        if name == "$MeshFormat" || is_read && !seen.insert(name.clone()) {
            return Err(source.refused("a section", name, NEW));
        }
        match &*name {
            "$PhysicalNames" => names(source, &mut contents.groups)?,
            "$Entities" if seen.contains("$Elements") => {
                return Err(source.refused("a section after $Elements", name, "$Entities before $Elements"));
            }
            "$Entities" => entities = Some(read_entities(source, &mut contents.groups)?),
            "$Nodes" => nodes(source, &mut contents)?,
            "$Elements" => contents.blocks = elements(source, entities.as_ref())?,
            "$PartitionedEntities" => {
                let what = "the mesh of $PartitionedEntities";
                return Err(source.refused(what, "partitioned", "a mesh without partitions"));
            }
            _ => source.skip_section(&end)?,
        }
        end_of_section(source, &end)?;
    }
    let required = [
        (true, "$Nodes", "the section $Nodes, which holds the nodes"),
        (true, "$Elements", "the section $Elements, which holds the elements"),
        (contents.groups.has_names(), "$Entities", "the section $Entities, which says what is in the physical groups"),
    ];
    match required.into_iter().find(|(is_required, name, _)| *is_required && !seen.contains(*name)) {
        Some((_, _, what)) => Err(GmshError::Missing { place: source.place(), what }),
        None => Ok(contents),
    }
}

fn end_of_section(source: &mut Source, end: &[u8]) -> Result<(), GmshError> {
    match source.line() {
        Some(line) if line == end => Ok(()),
        Some(line) => Err(source.refused("what follows the contents of a section", extract(line), extract(end))),
        None => Err(GmshError::Truncated { place: source.place(), what: "the end of the section" }),
    }
}

/// Reads `$MeshFormat`, which must be the first section, and sets the form of the source.
fn format(source: &mut Source) -> Result<(), GmshError> {
    let Some(line) = source.line() else {
        return Err(GmshError::Truncated { place: source.place(), what: "$MeshFormat" });
    };
    if line != b"$MeshFormat" {
        return Err(source.refused("the first line", extract(line), "$MeshFormat"));
    }
    let version: f64 = source.text_number("the version", "4.1")?;
    if version != 4.1 {
        return Err(source.refused("the version of the file", format!("{version:?}"), "4.1; save it as version 4.1"));
    }
    let is_binary = source.text_in("the file type (0: text, 1: binary)", 0..=1)? == 1;
    source.text_in("the size of a number in bytes", 8..=8)?;
    if is_binary {
        // The size ends its line.
        source.skip_line();
        source.set_form(Form::Little);
        match i32::from_le_bytes(source.binary("the number that tells the byte order")?) {
            1 => {}
            order if order.swap_bytes() == 1 => source.set_form(Form::Big),
            order => return Err(source.refused("the number that tells the byte order", order, "1")),
        }
    }
    end_of_section(source, b"$EndMeshFormat")
}

/// Reads `$PhysicalNames`, which are text in binary files too.
fn names(source: &mut Source, groups: &mut Groups) -> Result<(), GmshError> {
    let count = source.text_in("the number of physical names", 0..=i32::MAX)?;
    for _ in 0..count {
        let dimension = source.text_in("the dimension of a physical group", 0..=3)?;
        let tag = source.text_in("the tag of a physical group", 1..=i32::MAX)? as u32;
        let line = source.line().unwrap_or_default();
        let quoted = line.strip_prefix(b"\"").and_then(|line| line.strip_suffix(b"\""));
        let name = quoted.and_then(|name| std::str::from_utf8(name).ok()).filter(|name| !name.contains('"'));
        let name = name.ok_or_else(|| {
            source.refused("the name of a physical group", extract(line), "UTF-8 text between two quotation marks")
        })?;
        if !groups.name((dimension, tag), name) {
            return Err(source.refused("the tag of a physical group with a name", tag, NEW));
        }
    }
    Ok(())
}

/// Reads `$Entities`.
fn read_entities(source: &mut Source, groups: &mut Groups) -> Result<Entities, GmshError> {
    const GROUPS: &str = "the number of physical groups of an entity";
    let mut counts = [0; 4];
    for count in &mut counts {
        // Tag, three or six coordinates, the number of physical groups.
        *count = source.count("the number of entities", 1, 4)?;
    }
    let mut entities = Entities::new();
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let entity = source.int("the tag of an entity")?;
            if entities.contains_key(&(dimension, entity)) {
                return Err(source.refused("the tag of an entity", entity, NEW));
            }
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                source.real("the box around an entity")?;
            }
            let (mut physical, groups_of_entity) = (Vec::new(), source.count(GROUPS, 1, 0)?);
            if groups_of_entity > MAX_GROUPS {
                return Err(source.refused(GROUPS, groups_of_entity, format!("at most {MAX_GROUPS}")));
            }
            for _ in 0..groups_of_entity {
                // The sign states the orientation of the entity inside the group.
                let tag = source.int("the tag of a physical group")?.unsigned_abs();
                if tag == 0 {
                    return Err(source.refused("the tag of a physical group", "0", "numbers other than 0"));
                }
                if !physical.contains(&tag) {
                    physical.push(tag);
                    groups.open((dimension, tag));
                }
            }
            // Points have no entities that bound them.
            let bounds = if dimension == 0 { 0 } else { source.count("the number of bounding entities", 1, 0)? };
            for _ in 0..bounds {
                source.int("the tag of a bounding entity")?;
            }
            entities.insert((dimension, entity), physical.into());
        }
    }
    Ok(entities)
}

/// The head of `$Nodes` or `$Elements`: the number of blocks and the number of items in all of them.
fn block_counts(source: &mut Source, what: &'static str, longs: usize) -> Result<[usize; 2], GmshError> {
    let counts = [source.count("the number of blocks", 3, 1)?, source.count(what, 0, longs)?];
    // Nothing here depends on them.
    source.size("the smallest tag")?;
    source.size("the largest tag")?;
    Ok(counts)
}

/// Refuses a sum over the blocks that disagrees with the head of the section.
fn agree(source: &Source, what: &'static str, sum: usize, total: usize, fits: bool) -> Result<(), GmshError> {
    if fits {
        return Ok(());
    }
    Err(source.refused(what, sum, format!("{total}, which the head of the section states")))
}

/// The tag of a node or an element, which must not be among the tags before.
fn new_tag(source: &mut Source, what: &'static str, tags: &mut HashSet<u64>) -> Result<u64, GmshError> {
    let tag = source.tag(what)?;
    if tags.insert(tag) { Ok(tag) } else { Err(source.refused(what, tag, NEW)) }
}

/// Reads `$Nodes`.
fn nodes(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    const SUM: &str = "the number of nodes in the blocks";
    let [blocks, total] = block_counts(source, "the number of nodes", 4)?;
    for _ in 0..blocks {
        let dimension = source.int_in("the dimension of an entity", 0..=3)?;
        source.int("the tag of an entity")?;
        // As many as the dimension, if the flag is set.
        let parameters = dimension * source.int_in("the flag of parametric coordinates", 0..=1)?;
        let count = source.count("the number of nodes in a block", 0, 4 + parameters)?;
        let sum = contents.nodes.len() + count;
        agree(source, SUM, sum, total, sum <= total)?;
        for _ in 0..count {
            contents.node_tags.push(new_tag(source, "the tag of a node", &mut contents.known_nodes)?);
        }
        for _ in 0..count {
            let mut position = [0.0; 3];
            for coordinate in &mut position {
                *coordinate = source.finite("the coordinate of a node")?;
            }
            contents.nodes.push(position);
            for _ in 0..parameters {
                source.real("the parametric coordinate of a node")?;
            }
        }
    }
    agree(source, SUM, contents.nodes.len(), total, contents.nodes.len() == total)
}

/// Reads `$Elements`.
fn elements(source: &mut Source, entities: Option<&Entities>) -> Result<Vec<Block>, GmshError> {
    const SUM: &str = "the number of elements in the blocks";
    let [blocks, total] = block_counts(source, "the number of elements", 2)?;
    let (mut read, mut sum, mut tags) = (Vec::new(), 0, HashSet::new());
    for _ in 0..blocks {
        let stated = source.int_in("the dimension of an entity", 0..=3)?;
        let entity = source.int("the tag of an entity")?;
        let physical = match entities.map(|entities| entities.get(&(stated, entity))) {
            Some(Some(physical)) => Rc::clone(physical),
            Some(None) => {
                let found = format!("{entity} in dimension {stated}");
                return Err(source.refused("the tag of an entity", found, "entities of $Entities"));
            }
            None => Rc::default(),
        };
        let number = source.int("the type of elements")?;
        let (kind, dimension, nodes) = element_kind(number).map_err(|name| {
            let place = source.place();
            GmshError::ElementType { place, entity, number, name }
        })?;
        if dimension != stated {
            let allowed = format!("{dimension}, the dimension of its elements of type {number}");
            return Err(source.refused("the dimension of an entity", stated, allowed));
        }
        let count = source.count("the number of elements in a block", 0, 1 + nodes)?;
        sum += count;
        agree(source, SUM, sum, total, sum <= total)?;
        let mut elements = Vec::with_capacity(count);
        for _ in 0..count {
            let tag = new_tag(source, "the tag of an element", &mut tags)?;
            let nodes = (0..nodes).map(|_| source.tag("the tag of a node of an element"));
            elements.push((tag, nodes.collect::<Result<Vec<u64>, GmshError>>()?));
        }
        read.push(Block { kind, dimension, physical, elements });
    }
    agree(source, SUM, sum, total, sum == total)?;
    Ok(read)
}
