//! Physical groups while a file is read.

use crate::gmsh::error::GmshError;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// (dimension, tag) of a physical group.
type Key = (usize, u32);

/// Physical groups by dimension and tag.
#[derive(Default)]
pub(super) struct Groups {
    names: BTreeMap<Key, String>,
    members: BTreeMap<Key, Vec<usize>>,
}

impl Groups {
    pub(super) fn has_names(&self) -> bool {
        !self.names.is_empty()
    }

    /// Gives a group its name; an empty one is none. False if it has a name already.
    pub(super) fn name(&mut self, key: Key, name: &str) -> bool {
        self.open(key);
        name.is_empty() || self.names.insert(key, name.into()).is_none()
    }

    /// Makes a group, which may stay empty.
    pub(super) fn open(&mut self, key: Key) {
        self.members.entry(key).or_default();
    }

    pub(super) fn add(&mut self, key: Key, member: usize) {
        self.members.entry(key).or_default().push(member);
    }

    /// The name of a group: its tag if the file gives none.
    pub(super) fn name_of(&self, key: Key) -> String {
        self.names.get(&key).cloned().unwrap_or_else(|| key.1.to_string())
    }

    /// Tags of the groups by dimension and name. Groups of points and of lines become groups of nodes: where two of
    /// these have one tag, the second one gets a free one.
    pub(super) fn tags(&self) -> BTreeMap<(usize, String), u32> {
        let (mut tags, mut used, mut others) = (BTreeMap::new(), BTreeSet::new(), Vec::new());
        for &key in self.members.keys() {
            let (dimension, tag) = (if key.0 < 2 { 0 } else { key.0 }, key.1);
            let name = (dimension, self.name_of(key));
            if tags.contains_key(&name) {
                continue;
            }
            match used.insert((dimension, tag)) {
                true => _ = tags.insert(name, tag),
                false => others.push(name),
            }
        }
        let mut free = (1..).filter(|tag| !used.contains(&(0, *tag)));
        for name in others {
            if !tags.contains_key(&name) {
                tags.extend(free.next().map(|tag| (name, tag)));
            }
        }
        tags
    }

    /// The groups of some dimensions by name, members ascending. Groups of different dimensions may share a name.
    pub(super) fn by_name(&self, dimensions: RangeInclusive<usize>) -> Result<BTreeMap<String, Vec<usize>>, GmshError> {
        let (mut groups, mut tags) = (BTreeMap::<String, Vec<usize>>::new(), BTreeMap::new());
        for (&key, members) in self.members.iter().filter(|((dimension, _), _)| dimensions.contains(dimension)) {
            let (name, (dimension, tag)) = (self.name_of(key), key);
            if let Some(first) = tags.insert((dimension, name.clone()), tag) {
                return Err(GmshError::Name { dimension, tags: [first, tag], name });
            }
            groups.entry(name).or_default().extend(members);
        }
        for members in groups.values_mut() {
            members.sort_unstable();
            members.dedup();
        }
        Ok(groups)
    }
}
