//! Bodies in space that the reader of a page turns: skins of meshes, with values at their nodes in several states.

use crate::classes;
use crate::colours;
use crate::error::{FigureError, below, count, finite, mesh, some};
use crate::packing::{Packing, json_list, json_text};

/// Bodies with values at their nodes, in shapes and load cases.
///
/// ```
/// use figures::{Space, SpaceBody, SpaceField, SpaceShape, SpaceState, grid_faces};
/// let space = Space {
///     name: "space".into(),
///     towards: [1.0, -1.0, 1.0],
///     magnification: 10.0,
///     fields: vec![SpaceField { name: "pressure".into(), unit: "MPa".into(), classes: vec![] }],
///     bodies: vec![SpaceBody {
///         name: "plate".into(),
///         numbers: vec![0, 1, 2, 3],
///         faces: grid_faces([2, 2]),
///         apart: [0.0; 3],
///     }],
///     shapes: vec![SpaceShape {
///         name: "start".into(),
///         places: vec![vec![[0.0; 3], [0.0, 9.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 1.0]]],
///     }],
///     cases: vec![String::new()],
///     states: vec![SpaceState {
///         shape: 0,
///         case: 0,
///         displacements: vec![vec![[0.0; 3]; 4]],
///         values: vec![vec![vec![1.0, 2.0, f64::NAN, 4.0]]],
///     }],
/// };
/// assert!(space.view()?.data.len() > 100);
/// # Ok::<(), figures::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    /// Name of the view, for messages.
    pub name: String,
    /// From the bodies towards the viewer.
    pub towards: [f64; 3],
    /// Factor of the displacements as they are drawn at first.
    pub magnification: f64,
    /// What the nodes have values of; the length of the displacement is added to them.
    pub fields: Vec<SpaceField>,
    /// The bodies, the same in all shapes and states.
    pub bodies: Vec<SpaceBody>,
    /// The shapes.
    pub shapes: Vec<SpaceShape>,
    /// Names of the load cases.
    pub cases: Vec<String>,
    /// Each shape in each load case.
    pub states: Vec<SpaceState>,
}

/// What nodes have values of.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceField {
    /// What it is called.
    pub name: String,
    /// Unit of the values.
    pub unit: String,
    /// Names of the classes whose numbers, from 0 on, are the values; nothing for a field of numbers.
    pub classes: Vec<String>,
}

/// The skin of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceBody {
    /// What it is called.
    pub name: String,
    /// The numbers of its nodes, as the reader is told them.
    pub numbers: Vec<u32>,
    /// Triangles and quadrilaterals by the places of their nodes among these, counterclockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
    /// By how much it is moved where the reader wants to look between the bodies.
    pub apart: [f64; 3],
}

/// The places of the nodes without load.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceShape {
    /// What it is called.
    pub name: String,
    /// By bodies, mm.
    pub places: Vec<Vec<[f64; 3]>>,
}

/// A shape in a load case.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceState {
    /// Its shape, by the place in the list.
    pub shape: usize,
    /// Its load case, by the place in the list.
    pub case: usize,
    /// Displacements of the nodes by bodies, mm.
    pub displacements: Vec<Vec<[f64; 3]>>,
    /// Values by fields, bodies and nodes; NaN where there is none.
    pub values: Vec<Vec<Vec<f64>>>,
}

/// A view as pages hold it.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceView {
    /// All numbers in 16 bits each, compressed, as base64.
    pub data: String,
}

impl Space {
    /// Packs the numbers for a page, in 16 bits each: they are known up to 1/131068 of the range of their list.
    ///
    /// # Errors
    /// [`FigureError`] without bodies, shapes, cases or states; unless every face joins three or four different nodes,
    /// every list has an entry per body and node, all places and displacements are finite and all classes exist.
    pub fn view(&self) -> Result<SpaceView, FigureError> {
        self.check()?;
        let mut packing = Packing::default();
        let bodies: Vec<String> = self.bodies.iter().map(|body| body.packed(&mut packing)).collect();
        let vectors = |packing: &mut Packing, of_bodies: &[Vec<[f64; 3]>]| {
            let of_body =
                |nodes: &Vec<[f64; 3]>| json_list([0, 1, 2].map(|axis| packing.levels(nodes.iter().map(|x| x[axis]))));
            json_list(of_bodies.iter().map(of_body).collect::<Vec<_>>())
        };
        let mut shapes = Vec::new();
        for SpaceShape { name, places } in &self.shapes {
            shapes.push(format!("{{\"name\":{},\"places\":{}}}", json_text(name), vectors(&mut packing, places)));
        }
        let mut states = Vec::new();
        for SpaceState { shape, case, displacements, values } in &self.states {
            let displacement = vectors(&mut packing, displacements);
            let known = |nodes: &[f64]| nodes.iter().any(|value| value.is_finite());
            let mut of_body = |nodes: &Vec<f64>| match known(nodes) {
                true => packing.levels(nodes.iter().copied()),
                false => "null".to_owned(),
            };
            let values = json_list(values.iter().map(|field| json_list(field.iter().map(&mut of_body))));
            states.push(format!(
                "{{\"shape\":{shape},\"case\":{case},\"displacement\":{displacement},\"values\":{values}}}"
            ));
        }
        let header = format!(
            "{{\"length\":\"mm\",\"towards\":{},\"times\":{},\"scale\":{},\"classColours\":{},\"fields\":{},\
             \"bodies\":{},\"shapes\":{},\"cases\":{},\"states\":{}}}",
            json_list(self.towards.map(|part| part.to_string())),
            self.magnification,
            json_list(colours::scale().map(|colour| json_text(&colour))),
            json_list(classes::COLOURS.map(json_text)),
            json_list(self.fields.iter().map(SpaceField::packed)),
            json_list(bodies),
            json_list(shapes),
            json_list(self.cases.iter().map(|name| json_text(name))),
            json_list(states),
        );
        Ok(SpaceView { data: packing.text(&header) })
    }

    fn check(&self) -> Result<(), FigureError> {
        let name = &self.name;
        let counts = [self.bodies.len(), self.shapes.len(), self.cases.len(), self.states.len()];
        for (what, found) in ["bodies", "shapes", "load cases", "states"].into_iter().zip(counts) {
            some(name, what, found)?;
        }
        finite(name, "direction", self.towards.into_iter().chain([self.magnification]))?;
        for (index, shape) in self.shapes.iter().enumerate() {
            self.check_vectors(&format!("shape {index}"), &shape.places)?;
        }
        for (index, body) in self.bodies.iter().enumerate() {
            let part = format!("body {index}");
            mesh(name, &part, &self.shapes[0].places[index], &body.faces)?;
            finite(name, &format!("{part}, way"), body.apart)?;
        }
        self.states.iter().enumerate().try_for_each(|(index, state)| self.check_state(index, state))
    }

    /// Whether there is a finite vector for every node of every body.
    fn check_vectors(&self, part: &str, of_bodies: &[Vec<[f64; 3]>]) -> Result<(), FigureError> {
        count(&self.name, &format!("bodies in {part}"), self.bodies.len(), of_bodies.len())?;
        for (body, nodes) in self.bodies.iter().zip(of_bodies) {
            count(&self.name, &format!("nodes of {} in {part}", body.name), body.numbers.len(), nodes.len())?;
            finite(&self.name, &format!("{part}, part of node"), nodes.iter().flatten().copied())?;
        }
        Ok(())
    }

    fn check_state(&self, index: usize, state: &SpaceState) -> Result<(), FigureError> {
        let (name, part) = (&self.name, format!("state {index}"));
        below(name, &format!("{part}, shape"), &[state.shape], self.shapes.len())?;
        below(name, &format!("{part}, case"), &[state.case], self.cases.len())?;
        self.check_vectors(&part, &state.displacements)?;
        count(name, &format!("fields in {part}"), self.fields.len(), state.values.len())?;
        for (field, of_bodies) in self.fields.iter().zip(&state.values) {
            let what = format!("{part}, {}", field.name);
            count(name, &format!("bodies in {what}"), self.bodies.len(), of_bodies.len())?;
            for (body, nodes) in self.bodies.iter().zip(of_bodies) {
                count(name, &format!("nodes of {} in {what}", body.name), body.numbers.len(), nodes.len())?;
                let known = nodes.iter().copied().filter(|value| !value.is_nan());
                finite(name, &format!("{what}, value"), known.clone())?;
                let classes: Vec<usize> =
                    if field.classes.is_empty() { vec![] } else { known.map(|value| value as usize).collect() };
                below(name, &format!("{what}, class"), &classes, field.classes.len())?;
            }
        }
        Ok(())
    }
}

impl SpaceField {
    fn packed(&self) -> String {
        let classes = json_list(self.classes.iter().map(|name| json_text(name)));
        format!("{{\"name\":{},\"unit\":{},\"classes\":{classes}}}", json_text(&self.name), json_text(&self.unit))
    }
}

impl SpaceBody {
    fn packed(&self, packing: &mut Packing) -> String {
        let corners = |count: usize| -> Vec<u32> {
            self.faces.iter().filter(|face| face.len() == count).flatten().map(|&node| node as u32).collect()
        };
        format!(
            "{{\"name\":{},\"apart\":{},\"numbers\":{},\"quads\":{},\"triangles\":{}}}",
            json_text(&self.name),
            json_list(self.apart.map(|part| part.to_string())),
            packing.integers(&self.numbers, 1),
            packing.integers(&corners(4), 4),
            packing.integers(&corners(3), 3),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid_faces;
    use crate::packing::tests::{Unpacked, unpacked};

    /// A wave over a plate; rough, so that it is compressed less than fields are.
    fn wave(side: usize, node: usize, number: usize) -> f64 {
        let ([x, y], phase) = (at(side, node), number as f64);
        (3.0 * x + phase).sin() * (2.0 * y).cos() + 0.1 * (1e4 * (node as f64 + 0.1).sqrt() + phase).sin()
    }

    fn at(side: usize, node: usize) -> [f64; 2] {
        [node / side, node % side].map(|index| index as f64 / side as f64)
    }

    fn state(side: usize, bodies: usize, [shape, case, own]: [usize; 3]) -> SpaceState {
        let nodes = side * side;
        let contact = |node: usize| wave(side, node, 0) > 0.5;
        let moved = |body: usize| {
            let moved = move |node| [1, 2, 3].map(|axis| 0.1 * wave(side, node, own + 10 * axis + 100 * body));
            (0..nodes).map(moved).collect()
        };
        let pressure = |node| if contact(node) { 1e3 * wave(side, node, own) } else { f64::NAN };
        let status = |node| if contact(node) { (node % 3) as f64 } else { f64::NAN };
        let stress = |body: usize| (0..nodes).map(|node| 300.0 * wave(side, node, own + 100 * body).abs()).collect();
        let rest = vec![vec![f64::NAN; nodes]; bodies - 1];
        let first = |values: Vec<f64>| [vec![values], rest.clone()].concat();
        SpaceState {
            shape,
            case,
            displacements: (0..bodies).map(moved).collect(),
            values: vec![
                first((0..nodes).map(pressure).collect()),
                (0..bodies).map(stress).collect(),
                first((0..nodes).map(status).collect()),
            ],
        }
    }

    /// Plates of so many nodes along both sides, in states of which each has other values.
    fn plates(side: usize, bodies: usize, [shapes, cases]: [usize; 2]) -> Space {
        let nodes = side * side;
        let place = |shape: usize, node: usize| {
            let [x, y] = at(side, node);
            [100.0 * x, 100.0 * y, 100.0 + wave(side, node, shape)]
        };
        let field = |name: &str, unit: &str, classes: &[&str]| SpaceField {
            name: name.into(),
            unit: unit.into(),
            classes: classes.iter().map(|name| (*name).to_owned()).collect(),
        };
        let body = |body: usize| SpaceBody {
            name: format!("body {body}"),
            numbers: (0..nodes as u32).map(|node| 7 * node).collect(),
            faces: grid_faces([side, side]),
            apart: [0.0, 0.0, 10.0 * body as f64],
        };
        let shape = |shape: usize| SpaceShape {
            name: format!("shape \"{shape}\""),
            places: vec![(0..nodes).map(|node| place(shape, node)).collect(); bodies],
        };
        Space {
            name: "space".into(),
            towards: [1.0, -1.0, 1.0],
            magnification: 20.0,
            fields: vec![
                field("contact pressure", "MPa", &[]),
                field("von Mises stress", "MPa", &[]),
                field("status", "", &["open", "stick", "slip"]),
            ],
            bodies: (0..bodies).map(body).collect(),
            shapes: (0..shapes).map(shape).collect(),
            cases: (0..cases).map(|case| format!("case {case}")).collect(),
            states: (0..shapes * cases).map(|own| state(side, bodies, [own / cases, own % cases, own])).collect(),
        }
    }

    #[test]
    fn numbers_come_back_up_to_half_a_level() {
        let mut space = plates(9, 2, [2, 2]);
        space.bodies[1].faces = vec![vec![0, 1, 80], vec![3, 4, 5, 7]];
        let Unpacked { header, bytes } = unpacked(&space.view().expect("numbers").data);
        let read = |array: &serde_json::Value| crate::packing::tests::values(array, &bytes);
        let close = |array: &serde_json::Value, expected: &[f64]| {
            let [low, high] = ["low", "high"].map(|name| array[name].as_f64().expect("a number"));
            let half = 0.5 * (high - low) / 65534.0 * (1.0 + 1e-6);
            let found = read(array);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                assert!(found.is_nan() && expected.is_nan() || (found - expected).abs() <= half, "{found} {expected}");
            }
        };
        assert_eq!(header["shapes"][1]["name"], "shape \"1\"");
        for (own, state) in space.states.iter().enumerate() {
            let packed = &header["states"][own];
            assert_eq!(
                (packed["shape"].as_u64(), packed["case"].as_u64()),
                (Some(own as u64 / 2), Some(own as u64 % 2))
            );
            for body in 0..2 {
                for axis in 0..3 {
                    let expected: Vec<f64> = state.displacements[body].iter().map(|u| u[axis]).collect();
                    close(&packed["displacement"][body][axis], &expected);
                    let places: Vec<f64> = space.shapes[own / 2].places[body].iter().map(|x| x[axis]).collect();
                    close(&header["shapes"][own / 2]["places"][body][axis], &places);
                }
                for field in 0..3 {
                    match &packed["values"][field][body] {
                        serde_json::Value::Null => assert!(body == 1 && field != 1),
                        array => close(array, &state.values[field][body]),
                    }
                }
            }
        }
        let numbers: Vec<f64> = space.bodies[0].numbers.iter().map(|&number| f64::from(number)).collect();
        assert_eq!(read(&header["bodies"][0]["numbers"]), numbers);
        let quads: Vec<f64> = space.bodies[0].faces.iter().flatten().map(|&node| node as f64).collect();
        assert_eq!(read(&header["bodies"][0]["quads"]), quads);
        assert_eq!(read(&header["bodies"][1]["quads"]), [3.0, 4.0, 5.0, 7.0]);
        assert_eq!(read(&header["bodies"][1]["triangles"]), [0.0, 1.0, 80.0]);
    }

    /// Two cubes of 46³ nodes each, 200 000 in all, have 25 000 nodes on their skins.
    #[test]
    fn a_volume_of_200_000_nodes_in_two_shapes_and_three_cases_needs_less_than_six_megabytes() {
        let side = 113;
        let text = plates(side, 2, [2, 3]).view().expect("numbers").data;
        let page = text.len() + crate::page::library().len();
        println!("data {} bytes, with the library {page}", text.len());
        assert!(2 * side * side >= 2 * (46 * 46 * 46 - 44 * 44 * 44) && page < 6_000_000, "{page}");
    }

    #[test]
    fn lists_that_do_not_fit_are_refused() {
        let mut wrong = plates(3, 1, [1, 1]);
        wrong.states[0].values[0][0].pop();
        assert!(matches!(wrong.view(), Err(FigureError::Count { expected: 9, found: 8, .. })));
        let mut wrong = plates(3, 1, [1, 1]);
        wrong.shapes[0].places[0][4][1] = f64::NAN;
        assert!(matches!(wrong.view(), Err(FigureError::Number { index: 13, .. })));
        let mut wrong = plates(3, 1, [1, 1]);
        wrong.states[0].values[2][0][0] = 3.0;
        assert!(matches!(wrong.view(), Err(FigureError::Number { .. })));
        let mut wrong = plates(3, 1, [1, 1]);
        wrong.bodies[0].faces[0][0] = 9;
        assert!(matches!(wrong.view(), Err(FigureError::Face { .. })));
        let mut wrong = plates(3, 1, [1, 1]);
        wrong.states.clear();
        assert!(matches!(wrong.view(), Err(FigureError::Empty { .. })));
    }
}
