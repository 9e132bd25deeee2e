//! First scenes for meshes, and obstacles from files.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use contact::equilibrium::ContactProblem;
use exchange::gmsh::{self, CellKind, FacetKind, GmshCell, GmshFacet, GmshMesh};
use scene_file::{Case, SceneFile};
use testset::kit;

/// A ring of hexahedra around the axis x₂: its bore or its rim is the face that touches.
fn ring(contact: &str) -> GmshMesh {
    let (around, radii, width) = (24, [5.0, 8.0, 12.0], 6.0);
    let node = |i: usize, r: usize, k: usize| ((i % around) * 3 + r) * 2 + k;
    let place = |index: usize| {
        let (i, r, k) = (index / 6, index / 2 % 3, index % 2);
        let angle = std::f64::consts::TAU * i as f64 / around as f64;
        [radii[r] * angle.cos(), width * k as f64, radii[r] * angle.sin()]
    };
    let cell = |i: usize, r: usize| {
        let side = |k: usize| [node(i, r, k), node(i + 1, r, k), node(i + 1, r + 1, k), node(i, r + 1, k)];
        [side(0), side(1)].concat()
    };
    let cells = (0..2 * around).map(|index| GmshCell {
        kind: CellKind::Hex8,
        nodes: cell(index / 2, index % 2),
        tag: index as u64 + 1,
    });
    let facet = |index: usize, nodes: [usize; 4]| GmshFacet {
        kind: FacetKind::Quad4,
        nodes: nodes.to_vec(),
        tag: (2 * around + index) as u64 + 1,
    };
    let round = |r: usize| move |i: usize| [node(i, r, 0), node(i + 1, r, 0), node(i + 1, r, 1), node(i, r, 1)];
    let facets = (0..around).map(round(0)).chain((0..around).map(round(2)));
    let names = if contact == "bore" { ["bore contact", "rim"] } else { ["bore", "rim contact"] };
    GmshMesh {
        nodes: (0..6 * around).map(place).collect(),
        node_tags: (1..=6 * around as u64).collect(),
        cells: cells.collect(),
        facets: facets.enumerate().map(|(index, nodes)| facet(index, nodes)).collect(),
        surfaces: names
            .iter()
            .enumerate()
            .map(|(at, name)| ((*name).into(), (at * around..(at + 1) * around).collect()))
            .collect(),
        ..GmshMesh::default()
    }
}

/// A face around the body gets a cylinder as its obstacle: a shaft in a bore, a bore around a rim.
#[test]
fn a_draft_knows_faces_around_the_body_units_and_missing_names() {
    let folder = kit::scratch();
    let drafted = |mesh: &GmshMesh| {
        let file = folder.path().join("ring.msh");
        std::fs::write(&file, gmsh::write(mesh, true).unwrap()).unwrap();
        let text = scene_file::draft(&file).map_err(|error| error.to_string())?;
        let scene = SceneFile::parse(&text, "draft").unwrap();
        let case = Case::new(&scene, folder.path()).unwrap();
        Ok::<_, String>((text, ContactProblem::new(case.scene).unwrap().preview()))
    };
    for (contact, radius, side) in [("bore", "radius = 5.0", "outside"), ("rim", "radius = 12.0", "inside")] {
        let (text, preview) = drafted(&ring(contact)).unwrap();
        assert!(text.contains("form = \"cylinder\"") && text.contains("axis = [0.0, 1.0, 0.0]"), "{text}");
        assert!(text.contains(radius) && text.contains(&format!("side = \"{side}\"")), "{text}");
        assert!(text.contains("control_points = [1, 1, 4]") && text.contains("# load: "), "{text}");
        assert!(preview.gaps.iter().all(|gap| gap.abs() < 1e-9) && preview.contact_nodes == 48, "{preview:?}");
    }
    let mut small = ring("bore");
    small.nodes.iter_mut().flatten().for_each(|x| *x *= 1e-3);
    let (text, preview) = drafted(&small).unwrap();
    assert!(text.contains("unit = \"m\"") && text.contains("radius = 5.0") && preview.contact_nodes == 48, "{text}");
    let mut nameless = ring("bore");
    nameless.surfaces.clear();
    nameless.facets.clear();
    let error = drafted(&nameless).unwrap_err();
    assert!(error.contains("ring.msh: named faces = []") && error.contains("addPhysicalGroup(2"), "{error}");
}

/// A block of hexahedra over the unit cube with a name per face: x1 = 0, 1, x2 = 0, 1, x3 = 0, 1.
fn named_block(names: [&str; 6], place: impl Fn([f64; 3]) -> [f64; 3]) -> GmshMesh {
    const COUNT: usize = 6;
    let number = |[i, j, k]: [usize; 3]| (i * (COUNT + 1) + j) * (COUNT + 1) + k;
    let all =
        |count: usize| (0..count).flat_map(move |i| (0..count).flat_map(move |j| (0..count).map(move |k| [i, j, k])));
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let cell = |at: [usize; 3]| corners.map(|by: [usize; 3]| number(std::array::from_fn(|axis| at[axis] + by[axis])));
    let cells = all(COUNT).enumerate().map(|(index, at)| GmshCell {
        kind: CellKind::Hex8,
        nodes: cell(at).to_vec(),
        tag: index as u64 + 1,
    });
    let mut mesh = GmshMesh {
        nodes: all(COUNT + 1).map(|at| place(at.map(|index| index as f64 / COUNT as f64))).collect(),
        node_tags: (1..=(COUNT as u64 + 1).pow(3)).collect(),
        cells: cells.collect(),
        ..GmshMesh::default()
    };
    for (face, name) in names.iter().enumerate() {
        let (axis, level) = (face / 2, face % 2 * COUNT);
        let first = mesh.facets.len();
        for (s, t) in (0..COUNT).flat_map(|s| (0..COUNT).map(move |t| (s, t))) {
            let at = |s: usize, t: usize| {
                let mut at = [level; 3];
                (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (s, t);
                number(at)
            };
            let nodes = vec![at(s, t), at(s + 1, t), at(s + 1, t + 1), at(s, t + 1)];
            let tag = (mesh.cells.len() + mesh.facets.len() + 1) as u64;
            mesh.facets.push(GmshFacet { kind: FacetKind::Quad4, nodes, tag });
        }
        mesh.surfaces.insert((*name).into(), (first..mesh.facets.len()).collect());
    }
    mesh
}

/// Two flanks get a contact each, a seat the ball on its side, and the load stays within the plane of symmetry; what no
/// name tells is asked.
#[test]
fn a_draft_knows_forms_and_asks_what_it_cannot_know() {
    let folder = kit::scratch();
    let drafted = |mesh: &GmshMesh| {
        let file = folder.path().join("part.msh");
        std::fs::write(&file, gmsh::write(mesh, true).unwrap()).unwrap();
        scene_file::draft(&file).unwrap()
    };
    let preview = |text: &str| {
        let case = Case::new(&SceneFile::parse(text, "draft").unwrap(), folder.path()).unwrap();
        ContactProblem::new(case.scene).unwrap().preview()
    };
    let open = |text: &str| {
        let words = |line: &String| line.split(": ").nth(1).unwrap_or_default().to_owned();
        scene_file::open_questions(text).iter().map(words).collect::<Vec<_>>()
    };
    // A tongue that is wider below: its flanks look up and outwards, and a force on top would pull at it.
    let tongue = |[x, y, z]: [f64; 3]| [(24.0 - 10.0 * z) * (x - 0.5), 30.0 * y, 8.0 * z];
    let text = drafted(&named_block(["flank left", "flank right", "front", "back", "bottom", "top"], tongue));
    assert_eq!(text.matches("[contact.obstacle]\n").count(), 2, "{text}");
    assert!(text.contains("face = \"bottom\", force = [0.0, 0.0, ") && text.contains("would pull at it"), "{text}");
    assert!(text.contains("region = [\"flank left\", \"flank right\"]"), "{text}");
    assert_eq!(open(&text), ["support", "load"], "{text}");
    assert!(preview(&text).gaps.iter().all(|gap| gap.abs() < 1e-9));
    // Half of a block on a ball below: the seat is hollow, and its mean normal crosses the plane of symmetry.
    let seat = |[x, y, z]: [f64; 3]| {
        let [x, y] = [10.0 * x, 16.0 * (y - 0.5)];
        let low = (400.0 - x * x - y * y).sqrt() - 20.0;
        [x, y, low + (15.0 - low) * z]
    };
    let text = drafted(&named_block(["symmetry", "side", "front", "back", "seat", "load"], seat));
    assert!(text.contains("form = \"ball\"\ncentre = [0.0, 0.0, -20.0]\nradius = 20.0\nside = \"outside\""), "{text}");
    assert!(text.contains("loads = [{ face = \"load\", force = [0.0, 0.0, -"), "{text}");
    assert_eq!(open(&text), ["support"], "{text}");
    assert!(preview(&text).gaps.iter().all(|gap| gap.abs() < 1e-9));
    // A quarter of a rounded sole: its mean normal leans, the floor does not.
    let sole = |[x, y, z]: [f64; 3]| {
        let [x, y] = [10.0 * x, 8.0 * y];
        let low = 20.0 - (400.0 - x * x).sqrt();
        [x, y, low + (15.0 - low) * z]
    };
    let text = drafted(&named_block(["symmetry left", "side", "symmetry front", "back", "sole", "load"], sole));
    assert!(
        text.contains("form = \"tilted-plane\"\npoint = [0.0, ") && text.contains("\nnormal = [0.0, 0.0, -1.0]"),
        "{text}"
    );
    assert!(preview(&text).gaps.iter().all(|gap| *gap > -1e-9));
    // Names that say nothing.
    let text = drafted(&named_block(["a", "b", "c", "d", "e", "f"], |x| x.map(|x| 20.0 * x)));
    assert_eq!(open(&text), ["support", "load", "shape", "contact"], "{text}");
    let error = SceneFile::parse(&text, "part.toml").unwrap_err().to_string();
    assert!(error.contains("contact is missing") && error.contains("leaves open: contact: no name says"), "{error}");
}

/// A rail of surface elements alone: a square of side 60 at the height −1 that looks upwards.
const RAIL: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"rail\"\n$EndPhysicalNames\n\
    $Nodes\n4\n\
    1 -30 -30 -1\n2 30 -30 -1\n3 30 30 -1\n4 -30 30 -1\n$EndNodes\n$Elements\n1\n1 3 2 1 1 1 2 3 4\n$EndElements\n";

/// A flat foot a millimetre above obstacles of all forms that lie anywhere in space.
#[test]
fn obstacles_come_from_numbers_profiles_and_meshes() {
    let folder = kit::scratch();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let box_of = |corner: [f64; 3], sides: [f64; 3]| {
        move |x: [f64; 3]| std::array::from_fn(|axis| corner[axis] + sides[axis] * x[axis])
    };
    let foot = named_block(["a", "b", "c", "d", "foot", "load"], box_of([-10.0, -10.0, 0.0], [20.0, 20.0, 10.0]));
    let below = named_block(["a", "b", "c", "d", "e", "rail"], box_of([-30.0, -30.0, -10.0], [60.0, 60.0, 9.0]));
    write("foot.msh", &gmsh::write(&foot, true).unwrap());
    write("below.msh", &gmsh::write(&below, true).unwrap());
    write("rail.msh", RAIL.as_bytes());
    let corners = [[-0.03_f32, -0.03, -0.001], [0.03, -0.03, -0.001], [0.03, 0.03, -0.001], [-0.03, 0.03, -0.001]];
    let triangles = [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]];
    write("rail.stl", &exchange::stl(&triangles).unwrap());
    write("rail.csv", b"# radius, height\n0, 0\n30, 0\n30, -5\n");
    let drafted = scene_file::draft(&folder.path().join("foot.msh")).unwrap();
    let (before, after) = drafted.split_once("[contact.obstacle]\n").unwrap();
    let rest = &after[after.find("# What is minimised").unwrap()..];
    let gaps = |obstacle: &str| {
        let text = format!("{before}[contact.obstacle]\n{obstacle}\n{rest}");
        let scene = SceneFile::parse(&text, "part.toml").map_err(|error| error.to_string())?;
        let case = Case::new(&scene, folder.path()).map_err(|error| error.to_string())?;
        ContactProblem::new(case.scene).map(|problem| problem.preview().gaps).map_err(|error| error.to_string())
    };
    for obstacle in [
        "form = \"cone\"\npoint = [0.0, 0.0, -32.778697]\naxis = [1.0, 0.0, 0.0]\nradius = 30.0\nhalf_angle = 10.0",
        "form = \"torus\"\ncentre = [0, 0, -31]\naxis = [0, 1, 0]\nmajor_radius = 20.0\nminor_radius = 10.0",
        "form = \"torus\"\ncentre = [0, 0, -31]\naxis = [1, 0, 0]\nmajor_radius = -480.0\nminor_radius = 510.0",
        "form = \"revolution\"\nfile = \"rail.csv\"\npoint = [0.0, 0.0, -1.0]\naxis = [0.0, 0.0, 1.0]",
        "form = \"mesh\"\nfile = \"below.msh\"\nface = \"rail\"",
        "form = \"mesh\"\nfile = \"rail.msh\"\nface = \"rail\"",
        "form = \"mesh\"\nfile = \"rail.stl\"\nunit = \"m\"",
    ] {
        let [least, largest] = gaps(obstacle).unwrap();
        let is_flat = ["mesh", "revolution"].iter().any(|form| obstacle.contains(form));
        assert!((least - 1.0).abs() < 1e-5 && (is_flat == (largest < 1.0 + 1e-5)), "{obstacle}: {least} to {largest}");
    }
    for (obstacle, words) in [
        ("form = \"mesh\"\nfile = \"below.msh\"", "contact[0].obstacle.face = missing is not allowed"),
        ("form = \"mesh\"\nfile = \"below.msh\"\nface = \"rial\"", "rial"),
        ("form = \"mesh\"\nfile = \"rail.msh\"\nface = \"rial\"", "contact[0].obstacle.face = \"rial\" is not allowed"),
        ("form = \"mesh\"\nfile = \"rail.stl\"\nface = \"rail\"", "none: an STL file is one face"),
        ("form = \"mesh\"\nfile = \"none.stl\"", "none.stl"),
        ("form = \"mesh\"\nfile = \"rail.csv\"\nface = \"rail\"", "rail.csv"),
        ("form = \"revolution\"\nfile = \"below.msh\"\npoint = [0, 0, 0]\naxis = [0, 0, 1]", "below.msh"),
        ("form = \"revolution\"\nfile = \"rail.csv\"\npoint = [0, 0, 0]\naxis = [0, 0, 0]", "contact[0].obstacle.axis"),
        (
            "form = \"torus\"\ncentre = [0, 0, 0]\naxis = [0, 0, 1]\nmajor_radius = -3.0\nminor_radius = 2.0",
            "contact[0].obstacle.major_radius = -3 is not allowed",
        ),
        ("form = \"cone\"\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 2.0\nhalf_angle = 90.0", "half_angle"),
    ] {
        let refusal = gaps(obstacle).unwrap_err();
        assert!(refusal.contains(words), "{obstacle}: {refusal}");
    }
}
