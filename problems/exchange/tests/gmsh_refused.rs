//! Gmsh files that are refused: what is wrong, where, and what is allowed; no damage causes a panic.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use exchange::gmsh::{read, write};

/// One tetrahedron with physical groups of all dimensions.
const TETRAHEDRON: &str = include_str!("data/tetrahedron.msh");

/// Two blocks of hexahedra with all that Gmsh writes, as text and as a binary file.
const TEXT: &[u8] = include_bytes!("data/two_blocks.msh");
const BINARY: &[u8] = include_bytes!("data/two_blocks_binary.msh");

/// Their groups in version 2.2.
const TEXT_2: &str = include_str!("data/two_blocks_2.msh");
const BINARY_2: &[u8] = include_bytes!("data/two_blocks_2_binary.msh");

/// One change of the tetrahedron → the beginning of the message.
const REFUSED: [(&str, &str, &str); 53] = [
    ("$MeshFormat", "$Mesh", "line 1: the first line is $Mesh; allowed: $MeshFormat"),
    ("4.1 0", "2.2 0", "line 20: the tag of a node is 0; allowed: whole numbers from 1"),
    ("4.1 0", "4 0", "line 2: the version of the file is 4.0; allowed: 4.1, 2.2"),
    ("4.1 0", "4.2 0", "line 2: the version of the file is 4.2"),
    ("4.1 0", "x 0", "line 2: the version is x; allowed: 4.1"),
    ("4.1 0", "4.1 2", "line 2: the file type (0: text, 1: binary) is 2; allowed: whole numbers from 0 to 1"),
    ("0 8", "0 4", "line 2: the size of a number in bytes is 4; allowed: 8"),
    ("0 8", "0 8 8", "line 2: what follows the contents of a section is 8; allowed: $EndMeshFormat"),
    ("$EndMeshFormat\n", "$EndMeshFormat\n$MeshFormat\n", "line 5: the version is $PhysicalNames; allowed: 4.1, 2.2"),
    ("$PhysicalNames\n3", "$PhysicalNames\n4", "line 9: the dimension of a physical group is $EndPhysicalNames"),
    ("$PhysicalNames\n3", "$PhysicalNames\n2", "line 8: what follows the contents of a section is 3 2 \"body\""),
    ("$PhysicalNames\n3", "$PhysicalNames\n-3", "line 5: the number of physical names is -3"),
    (
        "0 1 \"tip\"",
        "4 1 \"tip\"",
        "line 6: the dimension of a physical group is 4; allowed: whole numbers from 0 to 3",
    ),
    ("0 1 \"tip\"", "0 0 \"tip\"", "line 6: the tag of a physical group is 0"),
    (
        "0 1 \"tip\"",
        "0 1 tip",
        "line 6: the name of a physical group is tip; allowed: UTF-8 text between two quotation",
    ),
    ("0 1 \"tip\"", "0 1 \"t\"p\"", "line 6: the name of a physical group is \"t\"p\""),
    ("0 1 \"tip\"", "2 4 \"tip\"", "line 7: the tag of a physical group with a name is 4; allowed: one that has not"),
    (
        "0 1 \"tip\"",
        "2 5 \"base\"",
        "the physical groups 4 and 5 of dimension 2 are both called \"base\"; allowed: one",
    ),
    ("2 4 \"base\"", "2 4 \"5\"", "the physical groups 4 and 5 of dimension 2 are both called \"5\""),
    ("1 1 2 1\n", "1 1 99999999999 1\n", "line 11: the number of entities is 99999999999; allowed: at most "),
    ("1 1 2 1\n", "1 1 2.5 1\n", "line 11: the number of entities is 2.5; allowed: whole numbers from 0"),
    ("2 4 -5 1 1", "2 4 0 1 1", "line 14: the tag of a physical group is 0; allowed: numbers other than 0"),
    ("2 4 -5 1 1", "77777 4 -5 1 1", "line 14: the number of physical groups of an entity is 77777; allowed: at most "),
    ("2 0 0 9 1 1 9", "1 0 0 9 1 1 9", "line 15: the tag of an entity is 1; allowed: one that has not appeared"),
    ("$EndEntities", "", "line 18: what follows the contents of a section is $Nodes; allowed: $EndEntities"),
    ("$Entities", "$PartitionedEntities", "line 10: the mesh of $PartitionedEntities is partitioned; allowed: a mesh"),
    ("$EndEntities", "$EndEntities\n$Entities", "line 18: a section is $Entities; allowed: one that has not appeared"),
    ("$EndEntities", "$EndEntities\n$EndEntities", "line 18: what follows a section is $EndEntities; allowed: another"),
    ("$EndEntities", "$EndEntities\nx", "line 18: what follows a section is x; allowed: another section"),
    ("2 5 1 90", "2 6 1 90", "line 31: the number of nodes in the blocks is 5; allowed: 6, which the head of the"),
    ("2 5 1 90", "2 4 1 90", "line 23: the number of nodes in the blocks is 5; allowed: 4, which the head of the"),
    (
        "2 5 1 90",
        "2 18446744073709551615 1 90",
        "line 19: the number of nodes is 18446744073709551615; allowed: at most",
    ),
    ("2 5 1 90", "2 18446744073709551616 1 90", "line 19: the number of nodes is 18446744073709551616; allowed: whole"),
    ("2 1 1 4\n", "4 1 1 4\n", "line 23: the dimension of an entity is 4; allowed: whole numbers from 0 to 3"),
    ("2 1 1 4\n", "2 1 2 4\n", "line 23: the flag of parametric coordinates is 2; allowed: whole numbers from 0 to 1"),
    ("2 1 1 4\n", "2 1 1 5000\n", "line 23: the number of nodes in a block is 5000; allowed: at most"),
    ("10\n20\n30\n", "10\n20\n10\n", "line 26: the tag of a node is 10; allowed: one that has not appeared before"),
    ("10\n20\n30\n", "10\n20\n0\n", "line 26: the tag of a node is 0; allowed: positive numbers"),
    ("10\n20\n30\n", "10\n20\n-3\n", "line 26: the tag of a node is -3; allowed: whole numbers from 0"),
    ("10\n20\n30\n", "10\n20\n31\n", "element 3: node 30 is unknown; allowed: nodes of $Nodes"),
    ("9 9 9", "9 NaN 9", "line 31: the coordinate of a node is NaN; allowed: finite numbers"),
    ("9 9 9", "9 1e999 9", "line 31: the coordinate of a node is inf; allowed: finite numbers"),
    ("9 9 9", "9 nine 9", "line 31: the coordinate of a node is nine; allowed: numbers"),
    ("4 4 1 4", "4 5 1 4", "line 42: the number of elements in the blocks is 4; allowed: 5"),
    ("4 4 1 4", "3 3 1 4", "line 41: what follows the contents of a section is 3 1 4 1; allowed: $EndElements"),
    ("0 1 15 1", "0 7 15 1", "line 35: the tag of an entity is 7 in dimension 0; allowed: entities of $Entities"),
    (
        "2 1 2 1",
        "2 1 4 1",
        "line 39: the dimension of an entity is 2; allowed: 3, the dimension of its elements of type 4",
    ),
    ("3 10 20 30", "2 10 20 30", "line 40: the tag of an element is 2; allowed: one that has not appeared before"),
    ("4 10 20 30 40", "4 10 20 30 41", "element 4: node 41 is unknown; allowed: nodes of $Nodes"),
    ("1 40\n", "1 90\n", "element 1 of the physical group \"tip\": no volume element uses node 90"),
    ("3 1 4 1\n4 10 20 30 40", "2 2 2 1\n4 10 20 30", "line 44: the file ends without volume elements"),
    ("$EndElements\n", "", "line 43: the file ends there; the end of the section must follow"),
    ("$EndElements", "$EndElements\n$Other", "line 45: the file ends there; the end of the section must follow"),
];

/// Asserts the beginning of the message for a file.
fn assert_refused(bytes: &[u8], expected: &str) {
    let message = read(bytes).unwrap_err().to_string();
    assert!(message.starts_with(expected), "expected: {expected}\nfound:    {message}");
}

#[test]
fn one_wrong_item_is_named_with_its_place_and_what_is_allowed() {
    let mut wrong = Vec::new();
    for (old, new, expected) in REFUSED {
        assert!(TETRAHEDRON.contains(old), "{old}");
        let message = read(TETRAHEDRON.replacen(old, new, 1).as_bytes()).unwrap_err().to_string();
        if !message.starts_with(expected) {
            wrong.push(format!("{old:?} -> {new:?}\n    expected: {expected}\n    found:    {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn an_entity_has_at_most_32_groups() {
    for (count, is_read) in [(32, true), (33, false)] {
        let tags: String = (1..=count).map(|tag| format!("{tag} ")).collect();
        let text = TETRAHEDRON.replacen("1 1 1 1 2 1 1\n", &format!("1 1 1 {count} {tags}1 1\n"), 1);
        assert_eq!(read(text.as_bytes()).is_ok(), is_read, "{count} groups");
    }
}

#[test]
fn missing_sections_are_named() {
    for (section, expected) in [
        ("Entities", "line 36: the file ends without the section $Entities, which says what is in the physical groups"),
        ("Nodes", "line 29: the file ends without the section $Nodes, which holds the nodes"),
        ("Elements", "line 33: the file ends without the section $Elements, which holds the elements"),
    ] {
        let (head, rest) = TETRAHEDRON.split_once(&format!("${section}\n")).unwrap();
        let (_, tail) = rest.split_once(&format!("$End{section}\n")).unwrap();
        assert_refused([head, tail].concat().as_bytes(), expected);
    }
    let (start, end) = (TETRAHEDRON.find("$Entities").unwrap(), TETRAHEDRON.find("$Nodes").unwrap());
    let late = [&TETRAHEDRON[..start], &TETRAHEDRON[end..], &TETRAHEDRON[start..end]].concat();
    assert_refused(late.as_bytes(), "line 36: a section after $Elements is $Entities; allowed: $Entities before");
    assert_refused(b"", "line 1: the file ends there; $MeshFormat must follow");
}

#[test]
fn element_types_that_are_not_read_are_refused_by_name() {
    for (number, name) in [
        (6, "prism6"),
        (7, "pyramid5"),
        (10, "quad9"),
        (12, "hex27"),
        (16, "quad8"),
        (17, "hex20"),
        (18, "prism15"),
        (29, "tet20"),
        (36, "quad16"),
        (92, "hex64"),
        (137, "tet16"),
        (73, "a type of high order or unknown"),
        (-1, "a type of high order or unknown"),
    ] {
        let text = TETRAHEDRON.replacen("3 1 4 1\n", &format!("3 1 {number} 1\n"), 1);
        assert_refused(
            text.as_bytes(),
            &format!("line 41: entity 1 has elements of type {number} ({name}); allowed: hex8, tet4, tet10"),
        );
    }
}

#[test]
fn wrong_items_of_version_2_are_named() {
    let line = |words: &str| 1 + TEXT_2.lines().position(|line| line == words).unwrap();
    let (element, facet) = ("3 1 2 4 1 1 13", "9 3 2 1 1 1 13 29 16");
    let (at, under) = (line(element), line(facet));
    for (old, new, expected) in [
        ("\n36\n", "\n37\n", "line 51: the tag of a node is $EndNodes; allowed: whole numbers of 32 bits".into()),
        ("\n36\n", "\n35\n", "line 50: what follows the contents of a section is 36 ".into()),
        ("\n2 1 0 0\n", "\n1 1 0 0\n", "line 16: the tag of a node is 1; allowed: one that has not".into()),
        ("\n2 1 0 0\n", "\n0 1 0 0\n", "line 16: the tag of a node is 0; allowed: whole numbers from 1".into()),
        (element, "3 1 2 4 1 1", format!("line {}: ", at + 1)),
        (element, "2 1 2 4 1 1 13", format!("line {at}: the tag of an element is 2; allowed: one that has not")),
        (element, "3 1 -1 4 1 1 13", format!("line {at}: the number of tags of an element is -1; allowed: whole")),
        (element, "3 7 2 4 1 1 13", format!("line {at}: elements of type 7 (pyramid5); allowed: hex8, tet4")),
        (element, "3 1 2 4 1 1 77", "element 3: node 77 is unknown; allowed: nodes of $Nodes".into()),
        (facet, "9 3 2 -2147483648 1 1 13 29 16", format!("line {under}: the physical group of an element is -2147")),
    ] {
        assert!(TEXT_2.contains(old), "{old}");
        assert_refused(TEXT_2.replacen(old, new, 1).as_bytes(), &expected);
    }
    let elements = BINARY_2.windows(10).position(|bytes| bytes == b"$Elements\n").unwrap() + 13;
    for (count, range) in [(0_i32, "1 to 52"), (53, "1 to 52")] {
        let mut bytes = BINARY_2.to_vec();
        bytes[elements + 4..elements + 8].copy_from_slice(&count.to_le_bytes());
        let place = elements + 4;
        let words =
            format!("byte {place}: the number of elements of one type is {count}; allowed: whole numbers from {range}");
        assert_refused(&bytes, &words);
    }
}

#[test]
fn a_second_mesh_must_be_the_first_one() {
    let again = [TETRAHEDRON, TETRAHEDRON].concat();
    assert_eq!(read(again.as_bytes()), read(TETRAHEDRON.as_bytes()));
    let other = [TETRAHEDRON, &TETRAHEDRON.replacen("0 0 1\n2 1 1 4", "0 0 2\n2 1 1 4", 1)].concat();
    assert_refused(other.as_bytes(), "line 87: the mesh after a second $MeshFormat is another one; allowed: the mesh");
}

#[test]
fn binary_files_name_bytes() {
    for (length, expected) in [
        (21, "byte 21: the file ends there; the number that tells the byte order must follow"),
        (5000, "byte 5000: the file ends there; the flag of parametric coordinates must follow"),
        (5003, "byte 5003: the file ends there; the flag of parametric coordinates must follow"),
    ] {
        assert_refused(&BINARY[..length], expected);
    }
    let nodes = BINARY.windows(7).position(|bytes| bytes == b"$Nodes\n").unwrap() + 7;
    let mut bytes = BINARY.to_vec();
    bytes[nodes + 8..nodes + 16].fill(0xff);
    let place = nodes + 8;
    assert_refused(&bytes, &format!("byte {place}: the number of nodes is 18446744073709551615; allowed: at most "));
}

/// Random numbers (xorshift64*), the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % limit.max(1)
    }

    /// A range of at most `most` items among `count`.
    fn range(&mut self, count: usize, most: usize) -> std::ops::Range<usize> {
        let start = self.below(count);
        start..(start + 1 + self.below(most)).min(count)
    }
}

/// Words that replace a number of a text.
const WORDS: [&[u8]; 12] = [
    b"0",
    b"-1",
    b"1",
    b"NaN",
    b"-inf",
    b"1e999",
    b"2147483648",
    b"4294967295",
    b"9999999999999",
    b"18446744073709551615",
    b"99999999999999999999999",
    b"\xff\xfe",
];

/// One random damage of a file: of its bytes, its lines or its numbers.
fn damaged(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = file.to_vec();
    let lines: Vec<&[u8]> = file.split_inclusive(|byte| *byte == b'\n').collect();
    match random.below(7) {
        0 => {
            let place = random.below(bytes.len());
            bytes[place] ^= 1 << random.below(8);
        }
        1 => bytes.truncate(random.below(file.len())),
        2 => drop(bytes.drain(random.range(file.len(), 40))),
        3 => {
            let range = random.range(lines.len(), 12);
            return [&lines[..range.start], &lines[range.end..]].concat().concat();
        }
        4 => {
            let range = random.range(lines.len(), 60);
            return [&lines[..range.end], &lines[range.start..]].concat().concat();
        }
        5 => {
            let mut words: Vec<&[u8]> = file.split_inclusive(u8::is_ascii_whitespace).collect();
            let place = random.below(words.len());
            let word = [WORDS[random.below(WORDS.len())], b"\n"].concat();
            words[place] = &word;
            return words.concat();
        }
        _ => {
            let range = random.range(file.len(), 9);
            bytes[range].fill([0, 1, 0x7f, 0x80, 0xff][random.below(5)]);
        }
    }
    bytes
}

/// Whether a message says where: a line, a byte, or the tag of an element or of groups.
fn has_place(message: &str) -> bool {
    ["line ", "byte ", "element ", "the physical groups "].iter().any(|start| {
        message.strip_prefix(start).is_some_and(|rest| rest.starts_with(|character: char| character.is_ascii_digit()))
    })
}

/// Reads damaged files; returns how many were refused.
fn refused_of(damages: usize, seed: u64) -> usize {
    let (mut random, mut refused) = (Random(seed), 0);
    for index in 0..damages {
        let file = [TEXT, BINARY, TETRAHEDRON.as_bytes(), TEXT_2.as_bytes(), BINARY_2][index % 5];
        let mut bytes = damaged(file, &mut random);
        while random.below(4) == 0 {
            bytes = damaged(&bytes, &mut random);
        }
        match read(&bytes) {
            // Damage of a coordinate or a name gives another mesh, which must be sound.
            Ok(mesh) => assert_eq!(read(&write(&mesh, index % 2 == 0).unwrap()).unwrap(), mesh, "damage {index}"),
            Err(error) => {
                refused += 1;
                assert!(has_place(&error.to_string()), "damage {index}: {error}");
            }
        }
    }
    refused
}

#[test]
fn damaged_files_are_refused_with_a_place_or_give_a_sound_mesh() {
    let refused = refused_of(2000, 1);
    // Most damage contradicts something; damage of coordinates, boxes and names is a different mesh.
    assert!((1000..1900).contains(&refused), "{refused} of 2000 refused");
}
