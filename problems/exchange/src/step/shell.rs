//! Faces, the open shell of the surface, and the closed shell of the solid between a plane and the surface.

use super::entities::{Entities, Id, list, real, text};
use super::spline::{SplineHeights, SplinePatch};
use crate::error::ExchangeError;

/// Length below which points of the file are one, mm.
const CONFUSION: f64 = 1e-7;

/// Surfaces, each as a face with its name in an open shell of its own.
pub fn surfaces<'a>(name: &str, faces: impl IntoIterator<Item = (&'a str, &'a SplinePatch)>) -> String {
    let mut entities = Entities::default();
    let shell = |(name, spline): (&str, &SplinePatch)| {
        let rim = Rim::of_surface(&mut entities, spline);
        let geometry = spline_surface(&mut entities, spline);
        let path = rim.around(&mut entities);
        let face = face(&mut entities, name, path, geometry);
        entities.add(format_args!("OPEN_SHELL({},({face}))", text(name)))
    };
    let shells: Vec<Id> = faces.into_iter().map(shell).collect();
    let model = entities.add(format_args!("SHELL_BASED_SURFACE_MODEL('',{})", list(shells)));
    product(&mut entities, name, "MANIFOLD_SURFACE_SHAPE_REPRESENTATION", model);
    entities.file(name)
}

/// The solid between the horizontal plane at the height `plane` (mm) and the surface, which lies above it.
///
/// # Errors
/// [`ExchangeError::Thickness`] for a control height that does not lie above the plane.
pub fn solid(name: &str, spline: &SplineHeights, plane: f64) -> Result<String, ExchangeError> {
    let patch = spline.patch();
    let [n1, n2] = patch.counts();
    for [x1, x2, height] in (0..n1).flat_map(|i| (0..n2).map(move |j| patch.point(i, j))) {
        if height <= plane {
            return Err(ExchangeError::Thickness { x1, x2, height, plane });
        }
    }
    let mut entities = Entities::default();
    let (bottom, top) = (Rim::of_plane(&mut entities, spline.ends(), plane), Rim::of_surface(&mut entities, patch));
    let uprights: [Id; 4] =
        std::array::from_fn(|corner| straight(&mut entities, &bottom.corners[corner], &top.corners[corner]));
    let surface = spline_surface(&mut entities, patch);
    let above = top.around(&mut entities);
    let mut faces = vec![face(&mut entities, "", above, surface)];
    let down = entities.frame([0.0, 0.0, plane], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    let ground = entities.add(format_args!("PLANE('',{down})"));
    let below = bottom.around_from_below(&mut entities);
    faces.push(face(&mut entities, "", below, ground));
    for side in 0..4 {
        let next = (side + 1) % 4;
        let path =
            [(bottom.edges[side], true), (uprights[next], true), (top.edges[side], false), (uprights[side], false)];
        let path = path_around(&mut entities, path);
        let (outward, along) = SIDES[side];
        let frame = entities.frame(bottom.corners[side].place, outward, along);
        let wall = entities.add(format_args!("PLANE('',{frame})"));
        faces.push(face(&mut entities, "", path, wall));
    }
    let shell = entities.add(format_args!("CLOSED_SHELL('',{})", list(faces)));
    let body = entities.add(format_args!("MANIFOLD_SOLID_BREP('',{shell})"));
    product(&mut entities, name, "ADVANCED_BREP_SHAPE_REPRESENTATION", body);
    Ok(entities.file(name))
}

/// Outward normal and direction of the sides x₂ = 0, x₁ = a, x₂ = b, x₁ = 0, in the order of the edges of a [`Rim`].
const SIDES: [([f64; 3], [f64; 3]); 4] = [
    ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
    ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
    ([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
    ([-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
];

/// A corner of a face.
#[derive(Debug, Clone, Copy)]
struct Corner {
    place: [f64; 3],
    vertex: Id,
}

impl Corner {
    fn new(entities: &mut Entities, place: [f64; 3]) -> Self {
        let point = entities.point(place);
        Self { place, vertex: entities.add(format_args!("VERTEX_POINT('',{point})")) }
    }
}

/// The four corners of a face, from that with the least parameters on, and the edges from each to the next:
/// counterclockwise seen from where the normal points to.
struct Rim {
    corners: [Corner; 4],
    edges: [Id; 4],
}

impl Rim {
    fn of_plane(entities: &mut Entities, [[a0, a1], [b0, b1]]: [[f64; 2]; 2], plane: f64) -> Self {
        let corners = [[a0, b0], [a1, b0], [a1, b1], [a0, b1]].map(|[x1, x2]| Corner::new(entities, [x1, x2, plane]));
        let edges = std::array::from_fn(|side| straight(entities, &corners[side], &corners[(side + 1) % 4]));
        Self { corners, edges }
    }

    fn of_surface(entities: &mut Entities, spline: &SplinePatch) -> Self {
        let [n1, n2] = spline.counts();
        let corners = [[0, 0], [n1 - 1, 0], [n1 - 1, n2 - 1], [0, n2 - 1]]
            .map(|[i, j]| Corner::new(entities, spline.point(i, j)));
        let edges = std::array::from_fn(|side| {
            let axis = side % 2;
            let points = (0..spline.counts()[axis]).map(|index| match side {
                0 => spline.point(index, 0),
                1 => spline.point(n1 - 1, index),
                2 => spline.point(n1 - 1 - index, n2 - 1),
                _ => spline.point(0, n2 - 1 - index),
            });
            let points: Vec<Id> = points.map(|point| entities.point(point)).collect();
            // The edges that run back have their knots mirrored.
            let mut knots = spline.distinct_knots(axis);
            if side >= 2 {
                let ends = knots[0].0 + knots[knots.len() - 1].0;
                knots = knots.into_iter().rev().map(|(knot, count)| (ends - knot, count)).collect();
            }
            let curve = entities.add(format_args!(
                "B_SPLINE_CURVE_WITH_KNOTS('',{},{},.UNSPECIFIED.,.F.,.F.,{},.UNSPECIFIED.)",
                spline.degree(axis),
                list(points),
                with_multiplicities(&[knots])
            ));
            edge(entities, &corners[side], &corners[(side + 1) % 4], curve)
        });
        Self { corners, edges }
    }

    /// The path around, counterclockwise seen from where the normal points to.
    fn around(&self, entities: &mut Entities) -> Id {
        path_around(entities, self.edges.map(|edge| (edge, true)))
    }

    /// The path around, counterclockwise from below.
    fn around_from_below(&self, entities: &mut Entities) -> Id {
        let [first, second, third, fourth] = self.edges.map(|edge| (edge, false));
        path_around(entities, [fourth, third, second, first])
    }
}

/// An edge on a straight line.
fn straight(entities: &mut Entities, from: &Corner, to: &Corner) -> Id {
    let way: [f64; 3] = std::array::from_fn(|axis| to.place[axis] - from.place[axis]);
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (point, direction) = (entities.point(from.place), entities.direction(way.map(|x| x / length)));
    let vector = entities.add(format_args!("VECTOR('',{direction},{})", real(length)));
    let line = entities.add(format_args!("LINE('',{point},{vector})"));
    edge(entities, from, to, line)
}

fn edge(entities: &mut Entities, from: &Corner, to: &Corner, curve: Id) -> Id {
    entities.add(format_args!("EDGE_CURVE('',{},{},{curve},.T.)", from.vertex, to.vertex))
}

/// A closed path over edges, each in its direction or against it.
fn path_around(entities: &mut Entities, edges: [(Id, bool); 4]) -> Id {
    let edges = edges.map(|(edge, forward)| {
        let sense = if forward { ".T." } else { ".F." };
        entities.add(format_args!("ORIENTED_EDGE('',*,*,{edge},{sense})"))
    });
    entities.add(format_args!("EDGE_LOOP('',{})", list(edges)))
}

/// A face on a surface whose normal points outwards.
fn face(entities: &mut Entities, name: &str, path: Id, surface: Id) -> Id {
    let bound = entities.add(format_args!("FACE_OUTER_BOUND('',{path},.T.)"));
    entities.add(format_args!("ADVANCED_FACE({},({bound}),{surface},.T.)", text(name)))
}

fn spline_surface(entities: &mut Entities, spline: &SplinePatch) -> Id {
    let [n1, n2] = spline.counts();
    let row = |i: usize, entities: &mut Entities| list((0..n2).map(|j| entities.point(spline.point(i, j))));
    let rows: Vec<String> = (0..n1).map(|i| row(i, entities)).collect();
    entities.add(format_args!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',{},{},{},.UNSPECIFIED.,.F.,.F.,.F.,{},.UNSPECIFIED.)",
        spline.degree(0),
        spline.degree(1),
        list(rows),
        with_multiplicities(&[spline.distinct_knots(0), spline.distinct_knots(1)])
    ))
}

/// The multiplicities of the knots of all axes, then the knots.
fn with_multiplicities(knots: &[Vec<(f64, usize)>]) -> String {
    let counts = knots.iter().map(|knots| list(knots.iter().map(|(_, count)| *count)));
    let values = knots.iter().map(|knots| list(knots.iter().map(|(knot, _)| real(*knot))));
    counts.chain(values).collect::<Vec<_>>().join(",")
}

/// What makes geometry a product with a shape, with millimetres as the unit of length.
fn product(entities: &mut Entities, name: &str, representation: &str, item: Id) {
    let name = text(name);
    let length = entities.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let angle = entities.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let solid_angle = entities.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    let uncertainty = entities.add(format_args!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),{length},'distance_accuracy_value','confusion accuracy')",
        real(CONFUSION)
    ));
    let context = entities.add(format_args!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))REPRESENTATION_CONTEXT('',''))"
    ));
    let frame = entities.frame([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let shape = entities.add(format_args!("{representation}({name},({frame},{item}),{context})"));
    let application = entities.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
    entities.add(format_args!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})"
    ));
    let context = entities.add(format_args!("PRODUCT_CONTEXT('',{application},'mechanical')"));
    let product = entities.add(format_args!("PRODUCT({name},{name},'',({context}))"));
    entities.add(format_args!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"));
    let formation = entities.add(format_args!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
    let context = entities.add(format_args!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
    let definition = entities.add(format_args!("PRODUCT_DEFINITION('design','',{formation},{context})"));
    let definition_shape = entities.add(format_args!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
    entities.add(format_args!("SHAPE_DEFINITION_REPRESENTATION({definition_shape},{shape})"));
}
