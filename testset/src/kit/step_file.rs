//! STEP files read back: entities (ISO 10303-21), and B-spline surfaces evaluated by de Boor's algorithm.

use std::collections::BTreeMap;

/// A parameter of an entity.
#[derive(Debug, Clone, PartialEq)]
pub enum Parameter {
    /// The number of another entity.
    Reference(usize),
    /// An integer or real parameter.
    Number(f64),
    /// A parenthesised list of parameters.
    List(Vec<Parameter>),
    /// A text with its quotes, a name, `$` or `*`.
    Word(String),
}

impl Parameter {
    /// A list.
    ///
    /// # Panics
    /// When it is none.
    pub fn list(&self) -> &[Self] {
        let Self::List(list) = self else { panic!("{self:?} is no list") };
        list
    }

    /// A number.
    ///
    /// # Panics
    /// When it is none.
    pub fn number(&self) -> f64 {
        let Self::Number(number) = self else { panic!("{self:?} is no number") };
        *number
    }

    /// The number of an entity.
    ///
    /// # Panics
    /// When it is none.
    pub fn reference(&self) -> usize {
        let Self::Reference(number) = self else { panic!("{self:?} is no reference") };
        *number
    }
}

/// The entities of a file that have a name, by their numbers: the name, and the parameters.
pub type Entities = BTreeMap<usize, (String, Vec<Parameter>)>;

/// The entities of a STEP file, complex ones left out. All references must lead to an entity.
///
/// # Panics
/// When the text has another form.
pub fn entities(text: &str) -> Entities {
    assert!(text.starts_with("ISO-10303-21;\nHEADER;\n") && text.ends_with("ENDSEC;\nEND-ISO-10303-21;\n"));
    let (_, data) = text.split_once("\nDATA;\n").expect("a data section");
    let (data, _) = data.split_once("ENDSEC;").expect("its end");
    let (mut found, mut numbers) = (Entities::new(), Vec::new());
    for line in data.lines() {
        let (number, entity) = line.strip_prefix('#').and_then(|line| line.split_once('=')).expect(line);
        let number: usize = number.parse().expect(line);
        numbers.push(number);
        let entity = entity.strip_suffix(';').expect(line);
        let (name, rest) = entity.split_at(entity.find('(').expect(line));
        if !name.is_empty() {
            let (parameters, rest) = parameter(rest);
            assert_eq!(rest, "", "{line}");
            found.insert(number, (name.to_owned(), parameters.list().to_vec()));
        }
    }
    let dangling = |parameter: &Parameter| matches!(parameter, Parameter::Reference(to) if !numbers.contains(to));
    assert!(!found.values().flat_map(|(_, parameters)| parameters).any(dangling), "a reference leads nowhere");
    found
}

/// The first parameter of a text, and what follows.
fn parameter(text: &str) -> (Parameter, &str) {
    if let Some(mut rest) = text.strip_prefix('(') {
        let mut list = Vec::new();
        while !rest.starts_with(')') {
            let (next, behind) = parameter(rest);
            list.push(next);
            rest = behind.strip_prefix(',').unwrap_or(behind);
        }
        return (Parameter::List(list), &rest[1..]);
    }
    if let Some(quoted) = text.strip_prefix('\'') {
        let end = quoted.find('\'').expect("the end of a text") + 2;
        return (Parameter::Word(text[..end].to_owned()), &text[end..]);
    }
    let end = text.find([',', ')', '(']).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    if rest.starts_with('(') {
        // A value with the name of its type.
        return parameter(rest);
    }
    // A real number has a point.
    let number = word.parse().ok().filter(|_: &f64| word.starts_with(['-', '.']) || word.starts_with(char::is_numeric));
    let parameter = match (word.strip_prefix('#'), number) {
        (Some(reference), _) => Parameter::Reference(reference.parse().expect(word)),
        (None, Some(number)) => Parameter::Number(number),
        (None, None) => Parameter::Word(word.to_owned()),
    };
    (parameter, rest)
}

/// A B-spline surface as it stands in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Polynomial degrees in both parameters.
    pub degrees: [usize; 2],
    /// Knots, repetitions listed.
    pub knots: [Vec<f64>; 2],
    /// Control points, a row per basis function of the first parameter.
    pub points: Vec<Vec<[f64; 3]>>,
}

impl Surface {
    /// The only B-spline surface of a file.
    ///
    /// # Panics
    /// When there is none, or another one.
    pub fn of(entities: &Entities) -> Self {
        let mut surfaces = entities.values().filter(|(name, _)| name == "B_SPLINE_SURFACE_WITH_KNOTS");
        let (_, parameters) = surfaces.next().expect("a B-spline surface");
        assert!(surfaces.next().is_none(), "two B-spline surfaces");
        let point = |parameter: &Parameter| -> [f64; 3] {
            let (name, coordinates) = &entities[&parameter.reference()];
            assert_eq!(name, "CARTESIAN_POINT");
            std::array::from_fn(|axis| coordinates[1].list()[axis].number())
        };
        let points = parameters[3].list().iter().map(|row| row.list().iter().map(point).collect()).collect();
        let knots = |axis: usize| -> Vec<f64> {
            let (counts, knots) = (parameters[8 + axis].list(), parameters[10 + axis].list());
            assert_eq!(counts.len(), knots.len());
            let repeated = counts.iter().zip(knots);
            repeated.flat_map(|(count, knot)| std::iter::repeat_n(knot.number(), count.number() as usize)).collect()
        };
        let degrees = [1, 2].map(|place| parameters[place].number() as usize);
        Self { degrees, knots: [knots(0), knots(1)], points }
    }

    /// The point of two parameters.
    pub fn at(&self, parameters: [f64; 2]) -> [f64; 3] {
        let rows = self.points.iter().map(|row| de_boor(self.degrees[1], &self.knots[1], row, parameters[1]));
        de_boor(self.degrees[0], &self.knots[0], &rows.collect::<Vec<_>>(), parameters[0])
    }
}

/// The point of a B-spline curve: control points are cut off until one is left.
fn de_boor(degree: usize, knots: &[f64], points: &[[f64; 3]], parameter: f64) -> [f64; 3] {
    assert_eq!(knots.len(), points.len() + degree + 1);
    let span = (degree..points.len()).rev().find(|&span| knots[span] <= parameter).unwrap_or(degree);
    let mut kept: Vec<[f64; 3]> = points[span - degree..=span].to_vec();
    for round in 1..=degree {
        for place in (round..=degree).rev() {
            let (left, right) = (knots[place + span - degree], knots[place + 1 + span - round]);
            let share = (parameter - left) / (right - left);
            kept[place] = std::array::from_fn(|axis| (1.0 - share) * kept[place - 1][axis] + share * kept[place][axis]);
        }
    }
    kept[degree]
}
