//! `export` of the shape of a mesh.

use serde_json::{Value, json};
use testset::kit::{self, text};

const CONTACT: &str = env!("CARGO_BIN_EXE_contact3d");

#[test]
fn the_change_of_a_mesh_is_what_lies_between_the_shapes() {
    raised("false");
}

/// Supports do not hold the nodes in the middles of the edges of the nose, which contact ties to their ends.
#[test]
fn nodes_of_the_contact_face_move_where_supports_hold_others() {
    raised("true");
}

/// The folder of a run has the mesh under another name: the scene that was run exports its shape all the same.
#[test]
fn the_scene_of_a_run_exports_its_shape() {
    let scene = format!("{}/scenes/lug_tet10.toml", env!("CARGO_MANIFEST_DIR"));
    let folder = kit::scratch();
    let (run, shape) = (folder.path().join("run"), folder.path().join("shape"));
    kit::json(CONTACT, &[&scene, "--max-evaluations", "1", "--no-checks", "--out", text(&run), "--json"]);
    let printed =
        kit::json(CONTACT, &[&scene, "export", "--run", text(&run), "--msh", "--out", text(&shape), "--json"]);
    assert_eq!(printed["files"][1]["file"], "body.msh", "{printed}");
    let other = format!("{}/scenes/lug_hex8.toml", env!("CARGO_MANIFEST_DIR"));
    let refused = kit::run(CONTACT, &[&other, "export", "--run", text(&run), "--out", text(&folder.path().join("o"))]);
    assert!(kit::errors(&refused).contains("the meshes differ"), "{}", kit::errors(&refused));
}

/// The lug moved up by 0.1 mm as a whole: its files agree with each other, with the nose, a cylinder, and with the top.
/// `hold`: whether supports, which hold the wall along x1 and x2, hold nodes in the shape too.
fn raised(hold: &str) {
    let hold = format!("body.lattice.hold_supports={hold}");
    let scene = format!("{}/scenes/lug_tet10.toml", env!("CARGO_MANIFEST_DIR"));
    let folder = kit::scratch();
    let count =
        kit::json(CONTACT, &[&scene, "evaluate", "--no-checks", "--json"])["subgradient"].as_array().unwrap().len();
    // Displacements of control points are their three components in turn; all of them go up by a tenth.
    let controls: Vec<f64> = (0..count).map(|index| if index % 3 == 2 { 0.1 } else { 0.0 }).collect();
    let file = folder.path().join("controls.json");
    std::fs::write(&file, json!(controls).to_string()).unwrap();
    let out = folder.path().join("shape");
    let options = ["export", "--controls", text(&file), "--set", &hold, "--out", text(&out), "--json"];
    let printed = kit::json(CONTACT, &[&[scene.as_str()], &options[..]].concat());
    let names: Vec<&str> =
        printed["files"].as_array().unwrap().iter().map(|file| file["file"].as_str().unwrap()).collect();
    let expected = ["controls.json", "surface.stl", "body.stl", "faces.step", "change.csv", "body.msh", "body.vtu"];
    assert_eq!(names, expected);
    assert_eq!(printed["left_out"], Value::Null);
    let faces = printed["files"][3]["faces"].as_array().unwrap();
    let nose = faces.iter().find(|face| face["face"] == "nose").unwrap();
    let [distance, allowed] = ["distance", "allowed"].map(|key| nose[key].as_f64().unwrap());
    // 1e-4 of the height of 40 mm; a hundredth of it ends the refinement.
    assert!(allowed == 0.004 && distance < 0.01 * allowed && nose["nodes"].as_u64().unwrap() > 400, "{nose}");
    let entities = testset::kit::step_file::entities(&std::fs::read_to_string(out.join("faces.step")).unwrap());
    let count = entities.values().filter(|(name, _)| name == "B_SPLINE_SURFACE_WITH_KNOTS").count();
    assert_eq!(count, faces.len());
    let table = std::fs::read_to_string(out.join("change.csv")).unwrap();
    let rows = |face: &str| -> Vec<Vec<f64>> {
        let own = table.lines().filter_map(|line| line.strip_prefix(face));
        own.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect()
    };
    let (nose, top) = (rows("nose,"), rows("top,"));
    assert!(nose.len() > 100 && top.len() > 50, "{}", &table[..400]);
    for row in top {
        assert!(row[6] > 1.0 - 1e-12 && (row[7] + 0.1).abs() < 1e-12, "{row:?}");
    }
    let mut largest = 0.0_f64;
    for row in &nose {
        let (from, normal, amount, to) = (&row[1..4], &row[4..7], row[7], &row[8..11]);
        let moved: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        assert!(moved[0] == 0.0 && moved[1] == 0.0 && (moved[2] - 0.1).abs() < 1e-12, "{row:?}");
        // The nose is a cylinder of radius 60 mm about (0, 0, 60): its normal points away from its axis.
        let radius = [from[0], from[2] - 60.0].map(|part| part / 60.0);
        assert!((normal[0] - radius[0]).abs() < 0.08 && (normal[2] - radius[1]).abs() < 0.08, "{row:?}");
        // Upwards is into the body. The displacement along the normal is the amount, up to the curvature and to what
        // slides along the nose.
        let along: f64 = normal.iter().zip(from.iter().zip(to)).map(|(n, (from, to))| n * (from - to)).sum();
        assert!(amount > -1e-3 && (amount - along).abs() < 5e-3, "{amount} {along}");
        largest = largest.max(amount);
    }
    assert!(largest > 0.09 && largest < 0.101, "{largest}");
    let grid = std::fs::read_to_string(out.join("body.vtu")).unwrap();
    let nodes = std::fs::read(out.join("body.msh")).unwrap();
    let mesh = exchange::gmsh::read(&nodes).unwrap();
    assert!(grid.contains(&format!("NumberOfPoints=\"{}\"", mesh.nodes.len())) && grid.contains("Name=\"change\""));
}

/// Four hexahedra with the faces between their halves, groups that overlap, and tags of groups as a user set them.
const LAYERS: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n2 77 \"foot\"\n2 5 \"head\"\n2 9 \"ends\"\n\
    2 40 \"between\"\n3 6 \"body\"\n$EndPhysicalNames\n$Nodes\n12\n1 0 0 0\n2 9 0 0\n3 9 9 0\n4 0 9 0\n5 0 0 5\n\
    6 9 0 5\n7 9 9 5\n8 0 9 5\n9 0 0 9\n10 9 0 9\n11 9 9 9\n12 0 9 9\n$EndNodes\n$Elements\n7\n1 3 2 77 1 1 2 3 4\n\
    2 3 2 9 1 1 2 3 4\n3 3 2 5 2 9 10 11 12\n4 3 2 9 2 9 10 11 12\n5 3 2 40 3 5 6 7 8\n6 5 2 6 1 1 2 3 4 5 6 7 8\n\
    7 5 2 6 1 5 6 7 8 9 10 11 12\n$EndElements\n";

#[test]
fn an_exported_mesh_keeps_surfaces_between_cells_and_tags_of_groups() {
    let folder = kit::scratch();
    std::fs::write(folder.path().join("layers.msh"), LAYERS).unwrap();
    let scene = folder.path().join("layers.toml");
    let fields = "name = \"layers\"\nfriction = 0.2\n\n\
        [[contact]]\nslave = { face = \"head\" }\nobstacle = { form = \"plane\", height = 9.5 }\n[[body]]\nmesh = \"layers.msh\"\n\
        material = { young_modulus = 1e5, poisson_ratio = 0.3 }\nsupports = [{ face = \"foot\", held = [\"u1\", \"u2\", \"u3\"] }]\n\
        [body.lattice]\ncontrol_points = [2, 2, 2]\nfixed = [\"between\"]\ndisplacement = [-1.0, 1.0]\n";
    std::fs::write(&scene, fields).unwrap();
    let out = folder.path().join("shape");
    kit::json(CONTACT, &[text(&scene), "export", "--out", text(&out), "--json"]);
    let mesh = exchange::gmsh::read(&std::fs::read(out.join("body.msh")).unwrap()).unwrap();
    let sizes: Vec<(&str, usize)> = mesh.surfaces.iter().map(|(name, facets)| (&**name, facets.len())).collect();
    assert_eq!(sizes, [("between", 1), ("ends", 2), ("foot", 1), ("head", 1)]);
    assert!(mesh.node_groups.is_empty() && mesh.facets.len() == 3, "{mesh:?}");
    let tags: Vec<(&str, u32)> = mesh.group_tags.iter().map(|((_, name), tag)| (&**name, *tag)).collect();
    assert_eq!(tags, [("between", 40), ("ends", 9), ("foot", 77), ("head", 5), ("body", 6)]);
}

/// The numbers of all lines below a keyword of an input file of CalculiX, up to the next one.
fn below(text: &str, keyword: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().skip_while(|line| *line != keyword).skip(1).take_while(|line| !line.starts_with('*'));
    let numbers = |line: &str| line.split(',').map(|number| number.trim().parse().unwrap()).collect();
    lines.map(numbers).collect()
}

#[test]
fn a_deck_of_calculix_has_the_loads_and_supports_of_its_case() {
    let scene = format!("{}/scenes/bracket.toml", env!("CARGO_MANIFEST_DIR"));
    let folder = kit::scratch();
    for (case, force) in [("upright", [0.0, 0.0, -39000.0]), ("forward", [16480.0, 0.0, -35350.0])] {
        let out = folder.path().join(case);
        kit::json(CONTACT, &[&scene, "export", "--inp", "--case", case, "--out", text(&out), "--json"]);
        let deck = std::fs::read_to_string(out.join("body.inp")).unwrap();
        let mut sum = [0.0; 3];
        below(&deck, "*CLOAD").iter().for_each(|load| sum[load[1] as usize - 1] += load[2]);
        assert!(sum.iter().zip(force).all(|(sum, force)| (sum - force).abs() < 1e-6), "{sum:?}");
        let nodes = below(&deck, "*NODE, NSET=ALL_NODES");
        assert_eq!((nodes.len(), below(&deck, "*ELEMENT, TYPE=C3D10, ELSET=ALL_ELEMENTS").len()), (6831, 3676));
        assert_eq!(below(&deck, "*ELASTIC"), [[1.69e5, 0.275]]);
        let members = |name: &str| below(&deck, &format!("*NSET, NSET={name}")).concat();
        let held = below(&deck, "*BOUNDARY");
        let holds = |node: f64, axis: f64| held.contains(&vec![node, axis, axis, 0.0]);
        assert!(members("SEAT").iter().all(|&node| [1.0, 2.0, 3.0].iter().all(|&axis| holds(node, axis))));
        assert!(members("STOP").iter().all(|&node| holds(node, 1.0)));
        let plane = members("SYMMETRY");
        assert!(plane.iter().all(|&node| holds(node, 2.0) && nodes[node as usize - 1][2].abs() < 1e-9));
    }
}

#[test]
fn supports_along_other_directions_than_axes_are_equations() {
    // The sides of the taper's sector of 30 degrees are held along their normals.
    let scene = format!("{}/scenes/taper.toml", env!("CARGO_MANIFEST_DIR"));
    let folder = kit::scratch();
    let out = folder.path().join("deck");
    kit::json(CONTACT, &[&scene, "export", "--inp", "--out", text(&out), "--json"]);
    let deck = std::fs::read_dir(&out).unwrap().map(|file| file.unwrap().path());
    let deck = deck.filter(|path| path.extension().is_some_and(|ending| ending == "inp"));
    let deck: String = deck.map(|path| std::fs::read_to_string(path).unwrap()).collect();
    let lines: Vec<&str> = deck.lines().collect();
    let equations = lines.windows(3).filter(|lines| lines[0] == "*EQUATION");
    let mut count = 0;
    for equation in equations {
        let terms: Vec<f64> = equation[2].split(',').map(|number| number.trim().parse().unwrap()).collect();
        assert_eq!(terms.len(), 3 * equation[1].parse::<usize>().unwrap());
        // One node, the first factor not 0.
        assert!(terms.chunks(3).all(|term| term[0] == terms[0]) && terms[2].abs() > 0.1, "{terms:?}");
        count += 1;
    }
    assert!(count > 50, "{count}");
}
