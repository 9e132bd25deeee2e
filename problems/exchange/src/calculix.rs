//! A body with supports and loads as an input file of CalculiX, which Abaqus reads as well.
//!
//! Elements are C3D10 and C3D8. Numbers have 13 digits: CalculiX reads 20 characters. Names are letters, digits and
//! underscores; CalculiX does not distinguish small letters from capitals.

use crate::error::ExchangeError;
use std::collections::BTreeSet;
use std::fmt::{Display, Write};

/// Numbers of a set or an element in a line.
const IN_LINE: usize = 16;

/// Elements of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementKind {
    /// Hexahedra of 8 nodes, in Gmsh's order.
    C3D8,
    /// Tetrahedra of 10 nodes, in Gmsh's order.
    C3D10,
}

/// Elements of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name of the set.
    pub name: String,
    /// The elements, by their places in the deck.
    pub elements: Vec<usize>,
    /// Young's modulus, MPa.
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

/// One linear static step. Nodes are places in the list of nodes, axes 0 to 2.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Deck {
    /// Lines of comments at the head.
    pub comments: Vec<String>,
    /// Places of the nodes, mm.
    pub nodes: Vec<[f64; 3]>,
    /// Elements with their nodes.
    pub elements: Vec<(ElementKind, Vec<usize>)>,
    /// The materials: every element is in one part.
    pub parts: Vec<Part>,
    /// Named sets of nodes.
    pub node_sets: Vec<(String, Vec<usize>)>,
    /// Node, axis, prescribed displacement, mm.
    pub held: Vec<(usize, usize, f64)>,
    /// Sums of factors times displacements that are 0: terms (node, axis, factor), of which the first is eliminated.
    pub equations: Vec<Vec<(usize, usize, f64)>>,
    /// Forces on nodes, N.
    pub loads: Vec<(usize, [f64; 3])>,
}

impl Deck {
    /// The text of the file.
    ///
    /// # Errors
    /// [`ExchangeError::Number`] for numbers that are not finite.
    pub fn text(&self) -> Result<String, ExchangeError> {
        self.check()?;
        let mut text = String::new();
        let mut line = |words: &dyn Display| {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{words}");
        };
        self.comments.iter().for_each(|comment| line(&format_args!("** {comment}")));
        line(&"*NODE, NSET=ALL_NODES");
        for (node, x) in (1..).zip(&self.nodes) {
            line(&format_args!("{node}, {:.12e}, {:.12e}, {:.12e}", x[0], x[1], x[2]));
        }
        for kind in [ElementKind::C3D8, ElementKind::C3D10] {
            let own = || (1..).zip(&self.elements).filter(|(_, (other, _))| *other == kind);
            if own().next().is_some() {
                line(&format_args!("*ELEMENT, TYPE={kind:?}, ELSET=ALL_ELEMENTS"));
            }
            for (number, (_, nodes)) in own() {
                let ordered: Vec<usize> = order(kind).iter().map(|&place| nodes[place] + 1).collect();
                line(&format_args!("{number}, {}", joined(&ordered)));
            }
        }
        let mut names = Names::default();
        for part in &self.parts {
            let name = names.new_name(&part.name);
            line(&format_args!("*ELSET, ELSET={name}"));
            numbers(&part.elements, &mut line);
            line(&format_args!(
                "*MATERIAL, NAME={name}\n*ELASTIC\n{:.12e}, {:.12e}",
                part.young_modulus, part.poisson_ratio
            ));
            line(&format_args!("*SOLID SECTION, ELSET={name}, MATERIAL={name}"));
        }
        for (name, nodes) in &self.node_sets {
            line(&format_args!("*NSET, NSET={}", names.new_name(name)));
            numbers(nodes, &mut line);
        }
        for terms in &self.equations {
            line(&format_args!("*EQUATION\n{}", terms.len()));
            let terms = terms.iter().map(|(node, axis, factor)| format!("{}, {}, {factor:.12e}", node + 1, axis + 1));
            line(&terms.collect::<Vec<_>>().join(", "));
        }
        line(&"*STEP\n*STATIC");
        if !self.held.is_empty() {
            line(&"*BOUNDARY");
        }
        for (node, axis, value) in &self.held {
            line(&format_args!("{}, {}, {}, {value:.12e}", node + 1, axis + 1, axis + 1));
        }
        if !self.loads.is_empty() {
            line(&"*CLOAD");
        }
        for (node, force) in &self.loads {
            for (axis, force) in (1..).zip(force).filter(|(_, force)| **force != 0.0) {
                line(&format_args!("{}, {axis}, {force:.12e}", node + 1));
            }
        }
        line(&"*NODE FILE\nU, RF\n*EL FILE\nS\n*END STEP");
        Ok(text)
    }

    fn check(&self) -> Result<(), ExchangeError> {
        let all = [
            ("coordinate of node", self.nodes.as_flattened().to_vec()),
            ("prescribed displacement", self.held.iter().map(|(_, _, value)| *value).collect()),
            ("factor of an equation", self.equations.iter().flatten().map(|(_, _, factor)| *factor).collect()),
            ("force", self.loads.iter().flat_map(|(_, force)| *force).collect()),
        ];
        for (what, values) in all {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(ExchangeError::Number { what, index, value: values[index], allowed: "finite numbers" });
            }
        }
        Ok(())
    }
}

/// The nodes of an element of the file by their places in Gmsh's order.
fn order(kind: ElementKind) -> &'static [usize] {
    match kind {
        ElementKind::C3D8 => &[0, 1, 2, 3, 4, 5, 6, 7],
        ElementKind::C3D10 => &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    }
}

fn joined(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

/// Places as numbers from 1 on, some in a line.
fn numbers(places: &[usize], line: &mut dyn FnMut(&dyn Display)) {
    for places in places.chunks(IN_LINE) {
        line(&joined(&places.iter().map(|place| place + 1).collect::<Vec<_>>()));
    }
}

/// Names that the file allows, each given once.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Names {
    fn new_name(&mut self, name: &str) -> String {
        let allowed = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
        let mut plain: String = name.chars().map(allowed).take(60).collect();
        if !plain.starts_with(|c: char| c.is_ascii_alphabetic()) {
            plain.insert(0, 'S');
        }
        let mut found = plain.clone();
        let mut number = 2;
        while !self.0.insert(found.clone()) {
            found = format!("{plain}_{number}");
            number += 1;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deck_has_its_nodes_elements_sets_supports_and_loads() {
        let deck = Deck {
            comments: vec!["one tetrahedron".into()],
            nodes: (0..10).map(|node| [f64::from(node), 0.5, -1.0]).collect(),
            elements: vec![(ElementKind::C3D10, (0..10).collect())],
            parts: vec![Part { name: "part 1".into(), elements: vec![0], young_modulus: 2e5, poisson_ratio: 0.3 }],
            node_sets: vec![("seat".into(), (0..10).collect()), ("Seat".into(), vec![3])],
            held: vec![(2, 1, 0.25)],
            equations: vec![vec![(4, 0, 1.0), (4, 2, -0.5)]],
            loads: vec![(9, [0.0, 0.0, -7.0])],
        };
        let text = deck.text().expect("finite numbers");
        for line in [
            "** one tetrahedron",
            "10, 9.000000000000e0, 5.000000000000e-1, -1.000000000000e0",
            "*ELEMENT, TYPE=C3D10, ELSET=ALL_ELEMENTS\n1, 1, 2, 3, 4, 5, 6, 7, 8, 10, 9\n",
            "*SOLID SECTION, ELSET=PART_1, MATERIAL=PART_1",
            "*NSET, NSET=SEAT\n1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n*NSET, NSET=SEAT_2\n4\n",
            "*EQUATION\n2\n5, 1, 1.000000000000e0, 5, 3, -5.000000000000e-1\n",
            "*BOUNDARY\n3, 2, 2, 2.500000000000e-1\n*CLOAD\n10, 3, -7.000000000000e0\n",
        ] {
            assert!(text.contains(line), "{line}\nin\n{text}");
        }
        assert!(!text.contains("C3D8"));
        let wrong = Deck { loads: vec![(0, [f64::NAN, 0.0, 0.0])], ..deck };
        assert!(wrong.text().expect_err("no number").to_string().contains("force 0 is NaN"));
    }
}
