//! Meshes in a plane: axes, outline, and text that a browser shows over the points: SVG titles on areas that are not
//! seen.

use super::canvas::{Canvas, INK, Place, Stroke, closed, escaped};
use super::chart::{Frame, Parts, ROOM_LEFT};
use super::error::{FigureError, mesh, positive};
use super::regions::{Corner, area, borders, lines, parts, sides};
use super::scale::{Axis, extent, number};
use std::fmt::Write;

/// Most points of a panel that have a text of their own, some 150 bytes each; larger meshes have none.
const MAX_NAMED_POINTS: usize = 5000;

/// Triangles and quadrilaterals over points of a plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan<'a> {
    points: &'a [[f64; 2]],
    /// Counterclockwise faces.
    pub faces: Vec<Vec<usize>>,
    low: [f64; 2],
    /// Lengths along both axes, > 0.
    pub size: [f64; 2],
}

impl<'a> Plan<'a> {
    /// A mesh that is the part with this name of a figure.
    pub fn new(figure: &str, part: &str, points: &'a [[f64; 2]], faces: &[Vec<usize>]) -> Result<Self, FigureError> {
        mesh(figure, part, points, faces)?;
        let ends = [0, 1].map(|axis| extent(points.iter().map(|point| point[axis])).unwrap_or((0.0, 0.0)));
        let size = ends.map(|(low, high)| high - low);
        positive(figure, &format!("{part}, side"), size)?;
        Ok(Self { points, faces: counterclockwise(points, faces), low: ends.map(|end| end.0), size })
    }

    /// Position of a point, text.
    pub fn position(&self, point: usize) -> String {
        let [x, y] = self.points[point].map(number);
        format!("({x}, {y})")
    }

    /// Places of the points in a frame.
    pub fn places(&self, frame: Frame) -> Vec<Place> {
        let share = |point: &[f64; 2], axis: usize| (point[axis] - self.low[axis]) / self.size[axis];
        self.points.iter().map(|point| frame.place([0, 1].map(|axis| share(point, axis)))).collect()
    }

    /// The outline of the mesh, and the frame with its axes.
    pub fn axes(&self, canvas: &mut Canvas, frame: Frame, places: &[Place], names: &[String; 2]) {
        let outer = sides(&self.faces).into_iter().filter(|(_, faces)| faces.len() == 1);
        let outer: Vec<[usize; 2]> = outer.map(|(side, _)| side).collect();
        canvas.lines(&lines(&outer, places), Stroke::solid(INK, 0.6));
        let axis =
            |axis: usize| Axis::linear(&names[axis], "", [self.low[axis], self.low[axis] + self.size[axis]], 0.0, 5);
        frame.axes(canvas, &axis(0), &axis(1), Parts { left: ROOM_LEFT, grid: false });
    }

    /// The number, the place and some text for every point of a face.
    pub fn name_points(&self, canvas: &mut Canvas, places: &[Place], text: impl Fn(usize) -> String) {
        if places.len() > MAX_NAMED_POINTS {
            return;
        }
        let mut areas: Vec<Vec<Vec<Corner>>> = vec![Vec::new(); places.len()];
        parts(&self.faces, places).for_each(|(point, part)| areas[point].push(part));
        let mut group = "<g class=\"nodes\" fill=\"none\" pointer-events=\"all\" transform=\"scale(.1)\">\n".to_owned();
        for (point, areas) in areas.into_iter().enumerate().filter(|(_, areas)| !areas.is_empty()) {
            let path: String = borders(areas.into_iter()).iter().map(|border| closed(border)).collect();
            let text = format!("node {point} at {}: {}", self.position(point), text(point));
            // Titles know no superscripts.
            let text = escaped(&text.replace("^{", "^").replace('}', ""));
            let _ = writeln!(group, "<path d=\"{path}\"><title>{text}</title></path>");
        }
        canvas.raw(&group);
        canvas.raw("</g>\n");
    }
}

/// Faces turned so that all are counterclockwise.
pub(super) fn counterclockwise(points: &[[f64; 2]], faces: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let turned = |face: &Vec<usize>| match area(face, points) < 0.0 {
        true => face.iter().rev().copied().collect(),
        false => face.clone(),
    };
    faces.iter().map(turned).collect()
}

/// Points in the order of their numbers, without those that are nearer than a distance, along both axes, to one before.
pub(super) fn spread(places: &[Place], distance: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for (point, [x, y]) in places.iter().enumerate() {
        let near = |&other: &usize| (x - places[other][0]).abs().max((y - places[other][1]).abs()) < distance;
        if !kept.iter().any(near) {
            kept.push(point);
        }
    }
    kept
}
