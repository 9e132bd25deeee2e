//! The text of a STEP file: numbered entities between header and end (ISO 10303-21).

use std::fmt::Write;

/// The number of an entity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Id(usize);

impl std::fmt::Display for Id {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// The entities of a file.
#[derive(Debug, Default)]
pub struct Entities {
    text: String,
    count: usize,
}

impl Entities {
    /// Adds an entity and returns its number in the file.
    pub fn add(&mut self, entity: impl std::fmt::Display) -> Id {
        self.count += 1;
        // Writing to a string does not fail.
        let _ = writeln!(self.text, "#{}={entity};", self.count);
        Id(self.count)
    }

    /// Adds a point, mm.
    pub fn point(&mut self, point: [f64; 3]) -> Id {
        let coordinates = list(point.map(real));
        self.add(format_args!("CARTESIAN_POINT('',{coordinates})"))
    }

    /// Adds a DIRECTION entity; the components need no normalization.
    pub fn direction(&mut self, direction: [f64; 3]) -> Id {
        let ratios = list(direction.map(real));
        self.add(format_args!("DIRECTION('',{ratios})"))
    }

    /// Adds a frame: its origin (mm), its third axis, and its first one.
    pub fn frame(&mut self, origin: [f64; 3], third: [f64; 3], first: [f64; 3]) -> Id {
        let (origin, third, first) = (self.point(origin), self.direction(third), self.direction(first));
        self.add(format_args!("AXIS2_PLACEMENT_3D('',{origin},{third},{first})"))
    }

    /// The text of the STEP file, header included.
    pub fn file(self, name: &str) -> String {
        let (name, program) = (text(name), text(concat!("nonsmooth ", env!("CARGO_PKG_VERSION"))));
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('lengths in mm'),'2;1');\n\
             FILE_NAME({name},'',(''),(''),{program},{program},'');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
            self.text
        )
    }
}

/// Parts of a list in parentheses.
pub fn list(parts: impl IntoIterator<Item = impl std::fmt::Display>) -> String {
    let parts: Vec<String> = parts.into_iter().map(|part| part.to_string()).collect();
    format!("({})", parts.join(","))
}

/// A real number that is read back bit by bit: it has a point, and an `E` before its exponent.
pub fn real(value: f64) -> String {
    let text = format!("{value:E}");
    let (digits, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let point = if digits.contains('.') { "" } else { "." };
    if exponent == "0" { format!("{digits}{point}") } else { format!("{digits}{point}E{exponent}") }
}

/// A text between quotes; characters beyond ASCII by their numbers.
pub fn text(text: &str) -> String {
    let mut quoted = String::from("'");
    for character in text.chars() {
        match character {
            '\'' => quoted += "''",
            '\\' => quoted += "\\\\",
            ' '..='~' => quoted.push(character),
            // Writing to a string does not fail.
            other => drop(write!(quoted, "\\X4\\{:08X}\\X0\\", u32::from(other))),
        }
    }
    quoted + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_texts_have_the_form_of_the_standard() {
        for (value, expected) in [(0.0, "0."), (-1.5, "-1.5"), (100.0, "1.E2"), (1e-7, "1.E-7"), (0.1, "1.E-1")] {
            assert_eq!(real(value), expected);
            assert_eq!(expected.parse::<f64>().expect("a number"), value);
        }
        assert_eq!(text(r"it's \ λ"), r"'it''s \\ \X4\000003BB\X0\'");
    }
}
