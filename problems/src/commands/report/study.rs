//! The files of a study: its table, curves over the values, and the page. Optimized rows have reports of their own.

use crate::commands::failure::Failure;
use crate::commands::folder::{Folder, REPORT, SCENE, START, STUDY};
use crate::commands::loaded_scene::LoadedScene;
use crate::commands::report::sections;
use crate::commands::report::stamp::stamp;
use crate::commands::run_kind::RUN;
use crate::commands::study::row::{Outcome, Row, Solved};
use crate::commands::study::table::{StudyJson, row_folder, values};
use crate::commands::study::varied::parts;
use figures::page::{Block, File, Page, Section};
use figures::{Curve, Figure, FigureError, LinePanel, Lines};

/// Folder of the figures.
const FIGURES: &str = "figures";
const CURVES: &str = "Every mark is a row that has a result. The axis begins at zero.";

/// Writes table, figures and page of a study.
pub fn write_study(folder: &Folder, loaded: &LoadedScene, study: &StudyJson) -> Result<(), Failure> {
    let mut files = vec![File { path: "study.csv".into(), what: "the table with all digits".into() }];
    folder.write("study.csv", study.csv())?;
    let mut pictures = Vec::new();
    if loaded.case.output.pictures {
        let shown: Vec<Shown<'_>> = study.rows.iter().filter_map(Shown::of).collect();
        for figure in curves(study, &shown) {
            let figure = figure.map_err(Failure::computation)?;
            folder.within(FIGURES)?.draw(&figure)?;
            files.push(File { path: format!("{FIGURES}/{}.svg", figure.name), what: figure.title.clone() });
            pictures.push(Block::Picture { figure, caption: CURVES.into() });
        }
    }
    if !loaded.case.output.report {
        return Ok(());
    }
    for (path, what) in [
        ("report.txt", "the table as text"),
        (REPORT, "everything as one JSON object, once all rows are there"),
        (SCENE, "the scene"),
        (START, "the control heights at which rows begin, if they were given"),
        (STUDY, "what is varied, for --resume"),
        (RUN, "that this is a study, for --resume"),
        ("rows.json", "the rows so far, with their controls"),
    ] {
        files.push(File { path: path.into(), what: what.into() });
    }
    for (number, row) in (1..).zip(&study.rows) {
        if matches!(&row.outcome, Outcome::Solved(solved) if solved.optimization.is_some()) {
            let what = format!("the optimization of row {number}: {}", caption(row));
            files.push(File { path: format!("{}/report.html", row_folder(number)), what });
        }
    }
    let varied: Vec<&str> = study.vary.iter().map(|varied| varied.name()).collect();
    let page = Page {
        title: format!("{}: study of {}", loaded.case.scene.name, varied.join(", ")),
        lead: format!("Rows: {}.{}", study.counted(), unconfirmed(study)),
        origin: stamp(),
        warnings: vec![],
        sections: vec![
            Section::new("Rows", vec![table(study)]),
            Section::new("Pictures", pictures),
            sections::origin(&loaded.file.print()?, &[]),
            Section::new("Files", vec![Block::Files(files)]),
        ],
    };
    folder.write("report.html", page.html())
}

/// How many optimizations are not confirmed, in a sentence; nothing where all are.
fn unconfirmed(study: &StudyJson) -> String {
    let runs = study.rows.iter().filter_map(|row| Shown::of(row)?.solved.optimization.as_ref());
    let (all, open) = runs.fold((0, 0), |(all, open), run| (all + 1, open + usize::from(!run.confirmed)));
    match open {
        0 => String::new(),
        _ => format!(
            " {open} of {all} optimizations ended unconfirmed; their rows hold the best shape found, and the column \"ended\" says why."
        ),
    }
}

/// The table; the reason of a failed row stands in the cell after the values.
fn table(study: &StudyJson) -> Block {
    let head = study.head();
    let rows: Vec<Vec<String>> = study.rows.iter().map(|row| study.cells(row)).collect();
    Block::table(head, rows)
}

/// A row that has a result.
struct Shown<'a> {
    row: &'a Row,
    solved: &'a Solved,
}

impl<'a> Shown<'a> {
    fn of(row: &'a Row) -> Option<Self> {
        Some(Self { row, solved: row.solved()? })
    }
}

/// Objective, peak pressure, contact area and the quantities of the scene over the first option whose values are
/// numbers, one curve for all rows that agree in the others.
fn curves(study: &StudyJson, shown: &[Shown<'_>]) -> Vec<Result<Figure, FigureError>> {
    let numbers = |values: &[String]| values.len() > 1 && values.iter().all(|value| value.parse::<f64>().is_ok());
    let Some(across) = study.vary.iter().position(|varied| numbers(varied.values())) else { return vec![] };
    let figure = |name: &str, quantity: &str, unit: &str, value: &dyn Fn(&Solved) -> Option<f64>| {
        let mut curves: Vec<Curve> = Vec::new();
        for Shown { row, solved } in shown {
            let mut others = values(row);
            let Ok(place) = others.remove(across).parse() else { continue };
            let others = others.iter().zip(study.vary.iter().enumerate().filter(|(index, _)| *index != across));
            let name: Vec<String> = others.map(|(value, (_, varied))| format!("{} {value}", varied.name())).collect();
            let name = if name.is_empty() { "rows".to_owned() } else { name.join(", ") };
            let Some(value) = value(solved) else { continue };
            let point = (place, value);
            match curves.iter_mut().find(|curve| curve.name == name) {
                Some(curve) => curve.points.push(point),
                None => curves.push(Curve { name, points: vec![point] }),
            }
        }
        curves.iter_mut().for_each(|curve| curve.points.sort_by(|a, b| a.0.total_cmp(&b.0)));
        let across = study.vary[across].name();
        Lines {
            name: name.to_owned(),
            title: format!("{quantity} over {across}"),
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            columns: 1,
            panels: vec![LinePanel { caption: String::new(), across: across.to_owned(), curves }],
        }
        .figure()
    };
    if shown.is_empty() {
        return vec![];
    }
    let mut figures = vec![
        figure("peak_pressure", "peak pressure", "MPa", &|solved| Some(solved.peak_pressure)),
        figure("contact_area", "contact area", "mm²", &|solved| Some(solved.contact_area)),
    ];
    // Values of different units have no axis in common.
    let unit = &shown[0].solved.objective_unit;
    if shown.iter().all(|shown| shown.solved.objective_unit == *unit) {
        figures.insert(0, figure("objective", "Θ", &set(unit), &|solved| Some(solved.objective)));
    }
    for (number, (title, unit)) in (1..).zip(study.quantities()) {
        let value = |solved: &Solved| Some(solved.quantities.iter().find(|told| told.title == title)?.value);
        figures.push(figure(&format!("quantity_{number}"), &title, &set(&unit), &value));
    }
    figures
}

/// A unit as figures take it: what stands in braces is set higher.
fn set(unit: &str) -> String {
    unit.split_once('^').map_or_else(|| unit.to_owned(), |(base, power)| format!("{base}^{{{power}}}"))
}

/// The options of a row, and whether its shape is only the best one found.
fn caption(row: &Row) -> String {
    let options = row.options.iter().map(|option| <[&str; 2]>::from(parts(option)).join(" "));
    let found = Shown::of(row).and_then(|shown| shown.solved.optimization.as_ref()).filter(|run| !run.confirmed);
    options.chain(found.map(|_| "best found".to_owned())).collect::<Vec<_>>().join(", ")
}
