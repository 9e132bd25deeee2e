//! Solved shapes as a page of their own, for programs that have no folder: a notebook.

use crate::commands::failure::Failure;
use crate::commands::report::captions;
use crate::commands::report::gallery::ShownShape;
use crate::commands::report::key_numbers;
use crate::commands::report::space::space;
use crate::commands::solved_shape::{ContactObjective, SolvedShape};
use figures::page::{Block, Page, Section};
use nonsmooth::Vector;
use scene_file::OutputSection;

/// Shapes by their labels and controls, solved: their key numbers and the bodies in three dimensions, as HTML.
///
/// # Errors
/// [`Failure`] for controls without a shape, and for a shape without a state.
pub fn solved_page(objective: &ContactObjective, shapes: &[(&str, &Vector)]) -> Result<String, Failure> {
    let solved = shapes.iter().map(|(_, controls)| SolvedShape::at(objective, controls));
    let solved = solved.collect::<Result<Vec<_>, _>>()?;
    let wanted = OutputSection { vtk: false, ..OutputSection::default() };
    let mut shown = Vec::new();
    for ((label, _), shape) in shapes.iter().zip(&solved) {
        for case in 0..objective.cases().count() {
            shown.push(ShownShape::new(objective, ("shape", label), (shape, case), &wanted)?);
        }
    }
    let labels: Vec<&str> = shapes.iter().map(|(label, _)| *label).collect();
    let view = space(objective, &labels, &shown)?;
    let blocks = view.map(|view| Block::Space { view, caption: captions::SPACE.into() });
    let sections = vec![
        Section::new("In three dimensions", blocks.into_iter().collect()),
        key_numbers::section(objective, &shown),
    ];
    let title = format!("{}: {}", objective.solver().problem().scene.name, labels.join(" and "));
    Ok(Page { title, sections, ..Page::default() }.html())
}
