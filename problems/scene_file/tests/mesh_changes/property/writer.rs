//! A mesh written as a file of version 2.2 or 4.1, as text or binary.

use super::model::{Element, Model, dimension};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

/// The form of a file.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// Version 2.2, else 4.1.
    pub is_version_2: bool,
    pub is_binary: bool,
}

struct File {
    form: Form,
    bytes: Vec<u8>,
}

impl File {
    fn line(&mut self, text: impl Display) {
        self.bytes.extend(format!("{text}\n").as_bytes());
    }

    fn number<const N: usize>(&mut self, value: impl Display, bytes: [u8; N]) {
        if self.form.is_binary {
            self.bytes.extend(bytes);
        } else {
            self.bytes.extend(format!("{value} ").as_bytes());
        }
    }

    fn int(&mut self, value: u64) {
        self.number(value, (value as i32).to_le_bytes());
    }

    fn size(&mut self, value: u64) {
        self.number(value, value.to_le_bytes());
    }

    /// A tag, which has 64 bits since version 4.
    fn tag(&mut self, value: u64) {
        if self.form.is_version_2 { self.int(value) } else { self.size(value) }
    }

    fn real(&mut self, value: f64) {
        self.number(value, value.to_le_bytes());
    }

    fn end(&mut self, section: &str) {
        self.line("");
        self.line(format!("$End{section}"));
    }
}

/// The bytes of the file.
pub fn write(model: &Model, form: Form) -> Vec<u8> {
    let mut file = File { form, bytes: Vec::new() };
    let version = if form.is_version_2 { "2.2" } else { "4.1" };
    file.line(format!("$MeshFormat\n{version} {} 8", u8::from(form.is_binary)));
    if form.is_binary {
        file.int(1);
    }
    file.end("MeshFormat");
    file.line(format!("$PhysicalNames\n{}", model.groups.len()));
    model.groups.iter().for_each(|((dimension, name), tag)| file.line(format!("{dimension} {tag} \"{name}\"")));
    file.line("$EndPhysicalNames");
    if form.is_version_2 {
        version_2(&mut file, model)
    } else {
        version_4(&mut file, model)
    }
    file.bytes
}

/// Tags of the groups of an element.
fn groups(model: &Model, element: &Element) -> Vec<u64> {
    let dimension = dimension(element.kind);
    let tag = |name: &String| u64::from(*model.groups.get(&(dimension, name.clone())).unwrap());
    element.groups.iter().map(tag).collect()
}

fn version_2(file: &mut File, model: &Model) {
    file.line(format!("$Nodes\n{}", model.nodes.len()));
    for (tag, position) in model.node_tags.iter().zip(&model.nodes) {
        file.int(*tag);
        position.iter().for_each(|coordinate| file.real(*coordinate));
    }
    file.end("Nodes");
    let count: usize = model.elements.iter().map(|element| element.groups.len().max(1)).sum();
    file.line(format!("$Elements\n{count}"));
    let mut free = model.element_tags.iter().max().unwrap() + 1;
    for (element, own) in model.elements.iter().zip(&model.element_tags) {
        let mut groups = groups(model, element);
        if groups.is_empty() {
            groups.push(0);
        }
        for (index, group) in groups.into_iter().enumerate() {
            let tag = if index == 0 { *own } else { free };
            free += u64::from(index > 0);
            let head = [element.kind as u64, 1, 2];
            match file.form.is_binary {
                true => head.into_iter().chain([tag]).for_each(|number| file.int(number)),
                false => [tag, head[0], head[2]].into_iter().for_each(|number| file.int(number)),
            }
            [group, 1 + element.entity as u64].into_iter().for_each(|number| file.int(number));
            element.nodes.iter().for_each(|&node| file.int(node_tag(model, node)));
        }
    }
    file.end("Elements");
}

/// The tag of a node; one that no node has for a node that was dropped.
fn node_tag(model: &Model, node: usize) -> u64 {
    model.node_tags.get(node).copied().unwrap_or(1_000_000)
}

fn version_4(file: &mut File, model: &Model) {
    // Entities by dimension, groups and number.
    let key = |element: &Element| (dimension(element.kind), groups(model, element), element.entity);
    let keys: BTreeSet<_> = model.elements.iter().map(key).collect();
    let tags: BTreeMap<_, u64> = keys.iter().cloned().zip(1..).collect();
    file.line("$Entities");
    (0..4).for_each(|dimension| file.size(keys.iter().filter(|key| key.0 == dimension).count() as u64));
    for (key, tag) in &tags {
        file.int(*tag);
        (0..if key.0 == 0 { 3 } else { 6 }).for_each(|_| file.real(0.0));
        file.size(key.1.len() as u64);
        key.1.iter().for_each(|group| file.int(*group));
        if key.0 > 0 {
            file.size(0);
        }
    }
    file.end("Entities");
    file.line("$Nodes");
    let count = model.nodes.len() as u64;
    [1, count, 1, count].into_iter().for_each(|number| file.size(number));
    [3, *tags.values().max().unwrap(), 0].into_iter().for_each(|number| file.int(number));
    file.size(count);
    model.node_tags.iter().for_each(|tag| file.size(*tag));
    model.nodes.iter().flatten().for_each(|coordinate| file.real(*coordinate));
    file.end("Nodes");
    file.line("$Elements");
    let count = model.elements.len() as u64;
    [count, count, 1, count].into_iter().for_each(|number| file.size(number));
    for (element, tag) in model.elements.iter().zip(&model.element_tags) {
        let entity = tags[&key(element)];
        [dimension(element.kind) as u64, entity, element.kind as u64].into_iter().for_each(|number| file.int(number));
        file.size(1);
        file.tag(*tag);
        element.nodes.iter().for_each(|&node| file.tag(node_tag(model, node)));
    }
    file.end("Elements");
}
