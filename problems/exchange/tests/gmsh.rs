//! Gmsh files: meshes by Gmsh are read with their groups, text and binary files hold one mesh, and what is written is
//! read back.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use exchange::gmsh::{
    CellKind, FacetKind, GmshCell, GmshFacet, GmshMesh, NodeData, Repeated, read, write, write_with_data,
};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A file by its path in the folder `problems`.
fn file(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)).unwrap()
}

fn sizes(groups: &BTreeMap<String, Vec<usize>>) -> Vec<(&str, usize)> {
    groups.iter().map(|(name, members)| (name.as_str(), members.len())).collect()
}

/// One tetrahedron with physical groups of all dimensions.
const TETRAHEDRON: &str = include_str!("data/tetrahedron.msh");

/// The text with one change, which must be one.
fn changed(old: &str, new: &str) -> Vec<u8> {
    assert!(TETRAHEDRON.contains(old), "{old}");
    TETRAHEDRON.replacen(old, new, 1).into_bytes()
}

#[test]
fn the_lugs_have_their_elements_and_groups() {
    let hex8 = read(&file("scenes/lug_hex8.msh")).unwrap();
    let tet10 = read(&file("scenes/lug_tet10.msh")).unwrap();
    let counts = |mesh: &GmshMesh| [mesh.nodes.len(), mesh.cells.len(), mesh.facets.len()];
    assert_eq!((counts(&hex8), counts(&tet10)), ([4108, 3276, 1578], [3539, 1881, 992]));
    assert!(hex8.cells.iter().all(|cell| cell.kind == CellKind::Hex8 && cell.nodes.len() == 8));
    assert!(tet10.cells.iter().all(|cell| cell.kind == CellKind::Tet10 && cell.nodes.len() == 10));
    assert!(hex8.facets.iter().all(|facet| facet.kind == FacetKind::Quad4 && facet.nodes.len() == 4));
    assert!(tet10.facets.iter().all(|facet| facet.kind == FacetKind::Tri6 && facet.nodes.len() == 6));
    assert_eq!((sizes(&hex8.volumes), sizes(&tet10.volumes)), (vec![("body", 3276)], vec![("body", 1881)]));
    let surfaces =
        |sizes: [usize; 5]| ["hole", "nose", "side", "top", "wall"].into_iter().zip(sizes).collect::<Vec<_>>();
    assert_eq!(sizes(&hex8.surfaces), surfaces([192, 288, 738, 168, 192]));
    assert_eq!(sizes(&tet10.surfaces), surfaces([100, 228, 437, 92, 135]));
    assert!(hex8.node_groups.is_empty() && tet10.node_groups.is_empty());
    // First node, and first quadrilateral, of the file.
    assert_eq!((hex8.nodes[0], hex8.node_tags[0]), ([-20.0, 0.0, 3.431457505076196], 1));
    let tags: Vec<u64> = hex8.facets[0].nodes.iter().map(|&id| hex8.node_tags[id]).collect();
    assert_eq!((hex8.facets[0].tag, tags), (1, vec![268, 286, 287, 284]));
}

/// Gmsh wrote the file with several groups on an entity, groups without a name, parametric coordinates and holes.
#[test]
fn text_and_binary_files_of_gmsh_hold_one_mesh() {
    let mesh = read(&file("exchange/tests/data/two_blocks.msh")).unwrap();
    assert_eq!(mesh, read(&file("exchange/tests/data/two_blocks_binary.msh")).unwrap());
    assert_eq!((mesh.nodes.len(), mesh.cells.len(), mesh.facets.len()), (36, 12, 36));
    assert_eq!(mesh.node_tags[..3], [103, 106, 109]);
    assert_eq!(sizes(&mesh.volumes), [("both blocks", 12), ("lower", 8), ("upper", 4)]);
    assert_eq!(sizes(&mesh.surfaces), [("30", 8), ("horizontal", 8), ("side", 4)]);
    // Two lines of two elements that share a corner; a group of points and one of lines that have one name.
    assert_eq!(sizes(&mesh.node_groups), [("9", 4), ("edge", 5)]);
    let heights = |name: &str| -> Vec<f64> {
        mesh.surfaces[name].iter().flat_map(|&facet| &mesh.facets[facet].nodes).map(|&id| mesh.nodes[id][2]).collect()
    };
    assert!(heights("horizontal").iter().all(|height| [0.0, 1.0].contains(height)));
    assert!(heights("30").iter().all(|height| [1.0, 1.5].contains(height)));
    assert!(mesh.node_groups["edge"].iter().all(|&id| mesh.nodes[id][1] == 0.0 || mesh.nodes[id][0] == 1.0));
}

/// In version 2.2 an element stands once for each of its groups, and Gmsh leaves out what is in none.
#[test]
fn version_2_has_the_groups_of_version_4() {
    let four = read(&file("exchange/tests/data/two_blocks.msh")).unwrap();
    let listed = read(&file("exchange/tests/data/two_blocks_2.msh")).unwrap();
    assert_eq!(listed, read(&file("exchange/tests/data/two_blocks_2_binary.msh")).unwrap());
    assert_eq!((listed.cells.len(), listed.facets.len()), (24, 20));
    let (merged, repeated) = listed.merged();
    assert_eq!((repeated.cells, repeated.facets), (12, 4));
    assert_eq!((merged.nodes.len(), merged.cells.len(), merged.facets.len()), (36, 12, 16));
    assert_eq!(sizes(&merged.volumes), sizes(&four.volumes));
    assert_eq!(sizes(&merged.surfaces), sizes(&four.surfaces));
    assert_eq!(sizes(&merged.node_groups), sizes(&four.node_groups));
    assert_eq!(merged.group_tags, four.group_tags);
    // The groups hold the same places.
    let centres = |mesh: &GmshMesh, name: &str| {
        let mean = |nodes: &[usize]| {
            let sum = |axis: usize| nodes.iter().map(|&id| mesh.nodes[id][axis]).sum::<f64>();
            [0, 1, 2].map(|axis| (1e6 * sum(axis) / nodes.len() as f64).round() as i64)
        };
        let facets = mesh.surfaces.get(name).into_iter().flatten().map(|&facet| mean(&mesh.facets[facet].nodes));
        let cells = mesh.volumes.get(name).into_iter().flatten().map(|&cell| mean(&mesh.cells[cell].nodes));
        let nodes = mesh.node_groups.get(name).into_iter().flatten().map(|&id| mean(&[id]));
        facets.chain(cells).chain(nodes).collect::<BTreeSet<_>>()
    };
    for (_, name) in four.group_tags.keys() {
        assert_eq!(centres(&merged, name), centres(&four, name), "{name}");
        assert!(!centres(&four, name).is_empty(), "{name}");
    }
}

/// Gmsh repeats the mesh where it appends a view.
#[test]
fn a_view_behind_a_mesh_is_skipped() {
    let mesh = read(&file("exchange/tests/data/box.msh")).unwrap();
    assert_eq!(read(&file("exchange/tests/data/box_view.msh")).unwrap(), mesh);
    // One without a mesh of its own, and one of the other version behind a binary mesh.
    let view = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$NodeData\n1\n\"$Nodes\"\n$EndNodeData\n";
    for binary in [false, true] {
        let bytes = [&write(&mesh, binary).unwrap()[..], view].concat();
        assert_eq!(read(&bytes).unwrap(), mesh);
    }
}

/// Whatever the order of their nodes: facets are equal by their corners, cells by all their nodes.
#[test]
fn what_is_listed_more_than_once_is_merged_into_all_its_groups() {
    let once = read(&file("scenes/lug_tet10.msh")).unwrap();
    assert_eq!(once.merged(), (Cow::Borrowed(&once), Repeated::default()));
    let mut mesh = once.clone();
    let tag = |mesh: &GmshMesh| (mesh.facets.len() + mesh.cells.len() + 1) as u64;
    for turned in [[0, 1, 2, 3, 4, 5], [1, 2, 0, 4, 5, 3], [0, 2, 1, 5, 4, 3]] {
        let nodes = turned.map(|place| once.facets[7].nodes[place]).to_vec();
        mesh.facets.push(GmshFacet { kind: FacetKind::Tri6, nodes, tag: tag(&mesh) });
    }
    let corners = once.facets[8].nodes[..3].to_vec();
    mesh.facets.push(GmshFacet { kind: FacetKind::Tri3, nodes: corners, tag: tag(&mesh) });
    let nodes = [1, 2, 0, 3, 5, 6, 4, 9, 7, 8].map(|place| once.cells[5].nodes[place]).to_vec();
    mesh.cells.push(GmshCell { kind: CellKind::Tet10, nodes, tag: tag(&mesh) });
    mesh.surfaces.insert("again".into(), (992..996).collect());
    mesh.volumes.insert("again".into(), vec![1881]);
    let (merged, repeated) = mesh.merged();
    assert_eq!((repeated.facets, repeated.cells), (2, 1));
    assert_eq!((&merged.facets, &merged.cells), (&once.facets, &once.cells));
    assert_eq!((&merged.surfaces["again"], &merged.volumes["again"]), (&vec![7, 8], &vec![5]));
    assert_eq!(merged.surfaces["hole"], once.surfaces["hole"]);
}

#[test]
fn groups_keep_their_tags() {
    let mut mesh = read(TETRAHEDRON.as_bytes()).unwrap();
    let tags: Vec<u32> = mesh.group_tags.values().copied().collect();
    assert_eq!(tags, [1, 5, 6, 4, 2]);
    mesh.group_tags.insert((2, "base".into()), 77);
    mesh.group_tags.remove(&(3, "body".into()));
    let again = read(&write(&mesh, true).unwrap()).unwrap();
    assert_eq!(again.group_tags[&(2, "base".into())], 77);
    // A free one.
    assert_eq!(again.group_tags[&(3, "body".into())], 2);
}

#[test]
fn what_is_written_is_read_back_as_text_and_binary() {
    let files = ["scenes/lug_hex8.msh", "scenes/lug_tet10.msh", "exchange/tests/data/two_blocks.msh"];
    let read_files = files.into_iter().chain(["exchange/tests/data/box.msh"]).map(|path| read(&file(path)).unwrap());
    for mesh in read_files.chain([read(TETRAHEDRON.as_bytes()).unwrap()]) {
        for binary in [false, true] {
            let bytes = write(&mesh, binary).unwrap();
            assert_eq!(read(&bytes).unwrap(), mesh);
            assert_eq!(write(&read(&bytes).unwrap(), binary).unwrap(), bytes, "the same mesh gives the same bytes");
        }
    }
}

#[test]
fn groups_may_be_empty_or_without_a_name_and_nodes_beyond_the_volume_are_dropped() {
    let mesh = read(TETRAHEDRON.as_bytes()).unwrap();
    assert_eq!(mesh.node_tags, [40, 10, 20, 30]);
    assert_eq!(sizes(&mesh.surfaces), [("5", 1), ("6", 0), ("base", 1)]);
    assert_eq!((&mesh.node_groups["tip"], mesh.cells[0].nodes.as_slice()), (&vec![0], &[1, 2, 3, 0][..]));
    // A facet on a node that no cell uses is dropped with it; a group must not hold it.
    let apart = changed("2 1 2 1\n3 10 20 30", "2 1 2 1\n3 10 20 90");
    assert!(read(&apart).unwrap_err().to_string().starts_with("element 3 of the physical group \"base\": no volume"));
    let apart = String::from_utf8(apart).unwrap().replacen("1 1 0 2 4 -5 1 1", "1 1 0 0 1 1", 1);
    assert_eq!(read(apart.as_bytes()).unwrap().facets, []);
}

#[test]
fn sections_that_are_not_needed_are_skipped_and_lines_may_end_with_cr() {
    let mesh = read(TETRAHEDRON.as_bytes()).unwrap();
    let more = "$Comments\n$Nodes\n1 2\n$EndComments\n\n$Periodic\n0\n$EndPeriodic\n$Nodes\n";
    assert_eq!(read(&changed("$Nodes\n", more)).unwrap(), mesh);
    assert_eq!(read(TETRAHEDRON.replace('\n', " \r\n").as_bytes()).unwrap(), mesh);
    // Without names, groups need no section.
    let (head, rest) = TETRAHEDRON.split_once("$PhysicalNames").unwrap();
    let bare = read([head, &rest[rest.find("$Nodes").unwrap()..]].concat().as_bytes()).unwrap();
    assert_eq!((bare.cells, bare.surfaces.len()), (mesh.cells, 0));
}

/// A tetrahedron without entities as a binary file in either byte order.
fn binary_tetrahedron(big: bool) -> Vec<u8> {
    let mut bytes = b"$MeshFormat\n4.1 1 8\n".to_vec();
    let order = |mut number: Vec<u8>| {
        if big {
            number.reverse();
        }
        number
    };
    let int = |number: i32| order(number.to_le_bytes().to_vec());
    let size = |number: u64| order(number.to_le_bytes().to_vec());
    bytes.extend([&int(1)[..], b"\n$EndMeshFormat\n$Nodes\n"].concat());
    [1, 4, 1, 4].map(size).iter().for_each(|number| bytes.extend(number));
    [3, 1, 0].map(int).iter().for_each(|number| bytes.extend(number));
    [4, 1, 2, 3, 4].map(size).iter().for_each(|number| bytes.extend(number));
    for position in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.1_f64]] {
        position.iter().for_each(|coordinate| bytes.extend(order(coordinate.to_le_bytes().to_vec())));
    }
    bytes.extend(b"\n$EndNodes\n$Elements\n");
    [1, 1, 1, 1].map(size).iter().for_each(|number| bytes.extend(number));
    [3, 1, 4].map(int).iter().for_each(|number| bytes.extend(number));
    [1, 1, 1, 2, 3, 4].map(size).iter().for_each(|number| bytes.extend(number));
    bytes.extend(b"\n$EndElements\n");
    bytes
}

#[test]
fn binary_files_are_read_in_either_byte_order() {
    let mesh = read(&binary_tetrahedron(false)).unwrap();
    assert_eq!((mesh.nodes[3], mesh.cells[0].kind), ([0.0, 0.0, 0.1], CellKind::Tet4));
    assert_eq!(read(&binary_tetrahedron(true)).unwrap(), mesh);
    let mut wrong = binary_tetrahedron(false);
    wrong[20] = 7;
    let message = "byte 20: the number that tells the byte order is 7; allowed: 1";
    assert_eq!(read(&wrong).unwrap_err().to_string(), message);
}

#[test]
fn fields_at_nodes_are_written() {
    let mesh = read(TETRAHEDRON.as_bytes()).unwrap();
    let field = |components: usize| NodeData {
        name: "displacement".into(),
        components,
        values: (0..4 * components).map(|value| value as f64 / 8.0).collect(),
    };
    let text = String::from_utf8(write_with_data(&mesh, &[field(3)], false).unwrap()).unwrap();
    let expected = "$NodeData\n1\n\"displacement\"\n1\n0.0\n3\n0\n3\n4\n40 0.0 0.125 0.25\n10 0.375 0.5 0.625\n\
                    20 0.75 0.875 1.0\n30 1.125 1.25 1.375\n$EndNodeData\n";
    assert!(text.ends_with(expected), "{text}");
    let binary = write_with_data(&mesh, &[field(1), field(9)], true).unwrap();
    assert_eq!(read(&binary).unwrap(), mesh);
    let refused = |field: NodeData, words: &str| {
        let message = write_with_data(&mesh, &[field], false).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    };
    refused(field(2), "number of components of field displacement is 2; allowed: 1, 3, 9");
    refused(NodeData { values: vec![0.0; 5], ..field(1) }, "number of values of field displacement is 5; allowed: 4");
    refused(NodeData { values: vec![f64::NAN; 4], ..field(1) }, "value of field displacement is NaN");
    refused(NodeData { name: "a\"b".into(), ..field(1) }, "name of field \"a\\\"b\"");
}

#[test]
fn a_mesh_that_makes_no_file_is_not_written() {
    let refused = |change: &dyn Fn(&mut GmshMesh), words: &str| {
        let mut mesh = read(TETRAHEDRON.as_bytes()).unwrap();
        change(&mut mesh);
        let message = write(&mesh, false).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    };
    refused(&|mesh| mesh.nodes[2][1] = f64::INFINITY, "coordinate of node 2 is inf; allowed: finite numbers");
    refused(&|mesh| mesh.node_tags[1] = 40, "tag of node 1 is 40; allowed: positive numbers, each once");
    refused(&|mesh| mesh.cells[0].tag = 0, "tag of element (facets, then cells) 1 is 0");
    refused(&|mesh| mesh.cells[0].nodes[3] = 4, "node of element 4 is 4; allowed: numbers below 4");
    refused(&|mesh| mesh.facets[0].kind = FacetKind::Quad4, "number of nodes of facet 0 is 3; allowed: 4");
    refused(&|mesh| mesh.cells.clear(), "number of cells is 0; allowed: at least 1");
    refused(&|mesh| mesh.node_tags.truncate(3), "number of node tags is 3; allowed: 4");
    let many = |mesh: &mut GmshMesh| (0..33).for_each(|group| _ = mesh.volumes.insert(format!("{group}"), vec![0]));
    let twice = |mesh: &mut GmshMesh| _ = mesh.group_tags.insert((2, "base".into()), 5);
    refused(&twice, "tag of group base is 5; allowed: numbers from 1 to 2^31 - 1, each once per dimension");
    refused(&many, "number of groups with member 0 is 33; allowed: at most 32");
    refused(&|mesh| _ = mesh.volumes.insert("x".into(), vec![1]), "member of group x is 1; allowed: numbers below 1");
    refused(&|mesh| _ = mesh.surfaces.insert("a\nb".into(), vec![]), "name of group \"a\\nb\"");
}
