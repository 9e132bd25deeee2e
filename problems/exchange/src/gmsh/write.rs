//! A mesh written as a Gmsh file.

use crate::gmsh::check::check;
use crate::gmsh::elements::number_and_nodes;
use crate::gmsh::error::GmshError;
use crate::gmsh::layout::Layout;
use crate::gmsh::mesh::{GmshMesh, NodeData};
use std::fmt::Debug;
use std::io::Write;

/// The bytes of a Gmsh file of version 4.1: text, or binary with the least significant byte first. The front page of
/// the module states what of a mesh that was read is kept.
///
/// # Errors
/// [`GmshError::Mesh`] for a mesh without cells, for numbers of nodes that do not fit a kind, ids that do not exist,
/// tags that are 0 or not unique, coordinates that are not finite, more than 32 groups with one member, and names that
/// are empty or have quotation marks or more than one line.
pub fn write(mesh: &GmshMesh, binary: bool) -> Result<Vec<u8>, GmshError> {
    write_with_data(mesh, &[], binary)
}

/// As [`write()`], with fields at the nodes.
///
/// # Errors
/// Those of [`write()`], and [`GmshError::Mesh`] for fields whose name, number of values or values are not allowed and
/// for tags of nodes beyond 32 bits.
///
/// # Limits of readers
/// Gmsh 4.15.2 reads all files. meshio 5.3.5 reads fields in binary files only if the tags of nodes are 1, 2, …, and it
/// refuses files in which some elements are in physical groups and some are not.
pub fn write_with_data(mesh: &GmshMesh, data: &[NodeData], binary: bool) -> Result<Vec<u8>, GmshError> {
    check(mesh, data)?;
    let layout = Layout::new(mesh)?;
    let mut file = File { bytes: Vec::new(), binary };
    file.text(&format!("$MeshFormat\n4.1 {} 8\n", u8::from(binary)));
    if binary {
        file.int(1);
        file.text("\n");
    }
    file.text("$EndMeshFormat\n");
    if !layout.names.is_empty() {
        file.text(&format!("$PhysicalNames\n{}\n", layout.names.len()));
        layout.names.iter().for_each(|(dimension, tag, name)| file.text(&format!("{dimension} {tag} \"{name}\"\n")));
        file.text("$EndPhysicalNames\n");
    }
    file.entities(&layout);
    file.nodes(mesh);
    file.elements(&layout);
    data.iter().for_each(|field| file.data(field, &mesh.node_tags));
    Ok(file.bytes)
}

/// A file as far as it is written.
struct File {
    bytes: Vec<u8>,
    binary: bool,
}

impl File {
    fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    /// A number: bytes or, in a text, debug output. That has an exponent where it is shorter, and is read back bit by
    /// bit.
    fn number<const N: usize>(&mut self, value: impl Debug, bytes: [u8; N]) {
        if self.binary {
            self.bytes.extend(bytes);
        } else {
            // Writing to a vector does not fail.
            let _ = write!(self.bytes, "{value:?} ");
        }
    }

    fn int(&mut self, value: i32) {
        self.number(value, value.to_le_bytes());
    }

    fn size(&mut self, value: u64) {
        self.number(value, value.to_le_bytes());
    }

    fn real(&mut self, value: f64) {
        self.number(value, value.to_le_bytes());
    }

    /// Ends a line of a text.
    fn end_line(&mut self) {
        if !self.binary {
            self.bytes.pop_if(|last| *last == b' ');
            self.bytes.push(b'\n');
        }
    }

    /// Ends a section; a line must begin there.
    fn end(&mut self, section: &str) {
        if self.binary {
            self.text("\n");
        }
        self.text(&format!("$End{section}\n"));
    }

    fn entities(&mut self, layout: &Layout) {
        self.text("$Entities\n");
        layout.entities.iter().for_each(|entities| self.size(entities.len() as u64));
        self.end_line();
        for (dimension, entities) in layout.entities.iter().enumerate() {
            for entity in entities {
                self.int(entity.tag);
                entity.low.iter().for_each(|coordinate| self.real(*coordinate));
                if dimension > 0 {
                    entity.high.iter().for_each(|coordinate| self.real(*coordinate));
                }
                self.size(entity.physical.len() as u64);
                entity.physical.iter().for_each(|tag| self.int(*tag));
                if dimension > 0 {
                    // Entities that bound this one.
                    self.size(0);
                }
                self.end_line();
            }
        }
        self.end("Entities");
    }

    /// The head of a section of blocks.
    fn blocks(&mut self, blocks: usize, tags: impl Iterator<Item = u64> + Clone) {
        let (smallest, largest) = (tags.clone().min().unwrap_or(0), tags.clone().max().unwrap_or(0));
        [blocks as u64, tags.count() as u64, smallest, largest].into_iter().for_each(|number| self.size(number));
        self.end_line();
    }

    /// The head of a block: three numbers and how many items follow.
    fn block(&mut self, numbers: [i32; 3], count: usize) {
        numbers.into_iter().for_each(|number| self.int(number));
        self.size(count as u64);
        self.end_line();
    }

    /// All nodes as one block on the first volume, which exists because there are cells.
    fn nodes(&mut self, mesh: &GmshMesh) {
        self.text("$Nodes\n");
        self.blocks(1, mesh.node_tags.iter().copied());
        self.block([3, 1, 0], mesh.nodes.len());
        for tag in &mesh.node_tags {
            self.size(*tag);
            self.end_line();
        }
        for position in &mesh.nodes {
            position.iter().for_each(|coordinate| self.real(*coordinate));
            self.end_line();
        }
        self.end("Nodes");
    }

    fn elements(&mut self, layout: &Layout) {
        self.text("$Elements\n");
        let tags = layout.blocks.iter().flat_map(|block| &block.elements).map(|(tag, _)| *tag);
        self.blocks(layout.blocks.len(), tags);
        for block in &layout.blocks {
            let (number, _) = number_and_nodes(block.kind);
            self.block([block.dimension as i32, block.entity, number], block.elements.len());
            for (tag, nodes) in &block.elements {
                self.size(*tag);
                nodes.iter().for_each(|node| self.size(*node));
                self.end_line();
            }
        }
        self.end("Elements");
    }

    fn data(&mut self, field: &NodeData, tags: &[u64]) {
        // One text, the name; one number, the time; three whole numbers: step, components, nodes.
        let (name, components) = (&field.name, field.components);
        self.text(&format!("$NodeData\n1\n\"{name}\"\n1\n0.0\n3\n0\n{components}\n{}\n", tags.len()));
        for (tag, values) in tags.iter().zip(field.values.chunks(components)) {
            // Tags beyond 32 bits were refused.
            self.int(*tag as i32);
            values.iter().for_each(|value| self.real(*value));
            self.end_line();
        }
        self.end("NodeData");
    }
}
