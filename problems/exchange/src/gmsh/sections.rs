//! The sections of a Gmsh file, one by one.

use crate::gmsh::contents::{Block, Contents, MAX_GROUPS, NEW, group_tag, new_tag};
use crate::gmsh::elements::element_kind;
use crate::gmsh::error::GmshError;
use crate::gmsh::groups::Groups;
use crate::gmsh::source::{Form, Source, extract};
use crate::gmsh::version_2;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::rc::Rc;

/// (dimension, tag) of an entity → tags of its physical groups.
type Entities = HashMap<(usize, i32), Rc<[u32]>>;

/// The first line of a file, and of a view that Gmsh appended.
const FORMAT: &[u8] = b"$MeshFormat";

/// Reads the first line of a file.
pub(super) fn first_line(source: &mut Source) -> Result<(), GmshError> {
    match source.line() {
        Some(FORMAT) => Ok(()),
        Some(line) => Err(source.refused("the first line", extract(line), "$MeshFormat")),
        None => Err(GmshError::Truncated { place: source.place(), what: "$MeshFormat" }),
    }
}

/// What the sections behind a line `$MeshFormat` hold, up to the end of the file or the next such line.
pub(super) struct Part {
    pub(super) contents: Contents,
    /// Whether it has nodes or elements: the rest of a file that has none is data of a view.
    pub(super) has_mesh: bool,
    /// Whether a line `$MeshFormat` ended it.
    pub(super) is_followed: bool,
}

/// Reads the sections behind a line `$MeshFormat`.
pub(super) fn part(source: &mut Source) -> Result<Part, GmshError> {
    let version = format(source)?;
    let (mut contents, mut entities, mut seen) = (Contents::default(), None, BTreeSet::new());
    let mut is_followed = false;
    while let Some(head) = source.line() {
        let name = extract(head);
        let Some(word) = head.strip_prefix(b"$").filter(|word| !word.starts_with(b"End")) else {
            return Err(source.refused("what follows a section", name, "another section, such as $Nodes"));
        };
        if head == FORMAT {
            is_followed = true;
            break;
        }
        let end = [b"$End", word].concat();
        let is_read = matches!(&*name, "$PhysicalNames" | "$Entities" | "$Nodes" | "$Elements");
        if is_read && !seen.insert(name.clone()) {
            return Err(source.refused("a section", name, NEW));
        }
        match (&*name, version) {
            ("$PhysicalNames", _) => names(source, &mut contents.groups)?,
            ("$Nodes", Version::Two) => version_2::nodes(source, &mut contents)?,
            ("$Elements", Version::Two) => version_2::elements(source, &mut contents)?,
            ("$Entities", _) if seen.contains("$Elements") => {
                return Err(source.refused("a section after $Elements", name, "$Entities before $Elements"));
            }
            ("$Entities", Version::Four) => entities = Some(read_entities(source, &mut contents.groups)?),
            ("$Nodes", Version::Four) => nodes(source, &mut contents)?,
            ("$Elements", Version::Four) => contents.blocks = elements(source, entities.as_ref())?,
            ("$PartitionedEntities", _) => {
                let what = "the mesh of $PartitionedEntities";
                return Err(source.refused(what, "partitioned", "a mesh without partitions"));
            }
            _ => source.skip_section(&end)?,
        }
        end_of_section(source, &end)?;
    }
    let has_mesh = seen.contains("$Nodes") || seen.contains("$Elements");
    // Elements of version 2.2 name their groups themselves.
    let needs_entities = version == Version::Four && contents.groups.has_names();
    let required = [
        (true, "$Nodes", "the section $Nodes, which holds the nodes"),
        (true, "$Elements", "the section $Elements, which holds the elements"),
        (needs_entities, "$Entities", "the section $Entities, which says what is in the physical groups"),
    ];
    match required.into_iter().find(|(is_required, name, _)| *is_required && !seen.contains(*name)) {
        Some((_, _, what)) if has_mesh => Err(GmshError::Missing { place: source.place(), what }),
        _ => Ok(Part { contents, has_mesh, is_followed }),
    }
}

fn end_of_section(source: &mut Source, end: &[u8]) -> Result<(), GmshError> {
    match source.line() {
        Some(line) if line == end => Ok(()),
        Some(line) => Err(source.refused("what follows the contents of a section", extract(line), extract(end))),
        None => Err(GmshError::Truncated { place: source.place(), what: "the end of the section" }),
    }
}

/// The version of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    /// 2.2.
    Two,
    /// 4.1.
    Four,
}

/// Reads what follows the line `$MeshFormat`, and sets the form of the source.
fn format(source: &mut Source) -> Result<Version, GmshError> {
    const ALLOWED: &str = "4.1, 2.2";
    source.set_form(Form::Text);
    let version: f64 = source.text_number("the version", ALLOWED)?;
    let version = match version {
        2.2 => Version::Two,
        4.1 => Version::Four,
        _ => return Err(source.refused("the version of the file", format!("{version:?}"), ALLOWED)),
    };
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
    end_of_section(source, b"$EndMeshFormat")?;
    Ok(version)
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
                let tag = group_tag(source, "the tag of a physical group")?;
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

/// Reads `$Nodes`.
fn nodes(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    const SUM: &str = "the number of nodes in the blocks";
    const NODE: &str = "the tag of a node";
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
            let tag = source.tag(NODE)?;
            contents.node_tags.push(new_tag(source, NODE, tag, &mut contents.known_nodes)?);
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
    const ELEMENT: &str = "the tag of an element";
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
            GmshError::ElementType { place, entity: Some(entity), number, name }
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
            let tag = source.tag(ELEMENT)?;
            let tag = new_tag(source, ELEMENT, tag, &mut tags)?;
            let nodes = (0..nodes).map(|_| source.tag("the tag of a node of an element"));
            elements.push((tag, nodes.collect::<Result<Vec<u64>, GmshError>>()?));
        }
        read.push(Block { kind, dimension, physical, elements });
    }
    agree(source, SUM, sum, total, sum == total)?;
    Ok(read)
}
