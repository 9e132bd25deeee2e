//! Numbers and lines of a Gmsh file in text or binary form.

use crate::gmsh::error::{GmshError, Place};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Longest extract of a file in a message, characters.
const MAX_EXTRACT: usize = 40;

/// What an integer may be.
const INT: &str = "whole numbers of 32 bits";

/// Form of the numbers inside sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    Little,
    Big,
}

/// A file and the place up to which it is read.
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Where the number or line begins that was read last.
    start: usize,
    /// Form of the numbers inside sections.
    form: Form,
}

impl<'a> Source<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, start: 0, form: Form::Text }
    }

    pub(super) fn set_form(&mut self, form: Form) {
        self.form = form;
    }

    pub(super) const fn form(&self) -> Form {
        self.form
    }

    /// Place of the number or line that was read last.
    pub(super) fn place(&self) -> Place {
        if self.form != Form::Text {
            return Place::Byte(self.start);
        }
        let before = self.bytes.get(..self.start).unwrap_or_default();
        Place::Line(1 + before.iter().filter(|byte| **byte == b'\n').count())
    }

    /// The error that the number or line read last is not allowed.
    pub(super) fn refused(&self, what: &'static str, found: impl Display, allowed: impl Display) -> GmshError {
        GmshError::Value { place: self.place(), what, found: found.to_string(), allowed: allowed.to_string() }
    }

    fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    fn skip_blanks(&mut self) {
        self.at += self.rest().iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        self.start = self.at;
    }

    /// The next line that is not blank, without blanks at its ends; none at the end of the file.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        let rest = self.rest();
        self.skip_line();
        let line = rest.get(..self.at - self.start).unwrap_or_default().trim_ascii();
        (!line.is_empty()).then_some(line)
    }

    /// Skips what is left of the line.
    pub(super) fn skip_line(&mut self) {
        let rest = self.rest();
        self.at += rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |length| length + 1);
    }

    /// Skips the contents of a section, whose last line ends with `end`: binary contents may stand before it.
    pub(super) fn skip_section(&mut self, end: &[u8]) -> Result<(), GmshError> {
        for line in self.rest().split_inclusive(|byte| *byte == b'\n') {
            if let Some(contents) = line.trim_ascii_end().strip_suffix(end) {
                self.at += contents.len();
                return Ok(());
            }
            self.at += line.len();
        }
        self.start = self.at;
        Err(GmshError::Truncated { place: self.place(), what: "the end of the section" })
    }

    /// The next number of a text.
    pub(super) fn text_number<T: FromStr>(&mut self, what: &'static str, allowed: &str) -> Result<T, GmshError> {
        self.skip_blanks();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = rest.get(..length).unwrap_or_default();
        if word.is_empty() {
            return Err(GmshError::Truncated { place: self.place(), what });
        }
        self.at += length;
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.refused(what, extract(word), allowed))
    }

    /// The next bytes of a binary file, the least significant one first.
    pub(super) fn binary<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], GmshError> {
        self.start = self.at;
        let Some(&(mut found)) = self.rest().first_chunk::<N>() else {
            self.start = self.bytes.len();
            return Err(GmshError::Truncated { place: self.place(), what });
        };
        self.at += N;
        if self.form == Form::Big {
            found.reverse();
        }
        Ok(found)
    }

    /// A whole number in a range, which is text in binary files too.
    pub(super) fn text_in(&mut self, what: &'static str, allowed: RangeInclusive<i32>) -> Result<usize, GmshError> {
        let found = self.text_number(what, INT)?;
        self.among(what, found, &allowed)
    }

    /// A whole number in a range.
    pub(super) fn int_in(&mut self, what: &'static str, allowed: RangeInclusive<i32>) -> Result<usize, GmshError> {
        let found = self.int(what)?;
        self.among(what, found, &allowed)
    }

    fn among(&self, what: &'static str, found: i32, allowed: &RangeInclusive<i32>) -> Result<usize, GmshError> {
        usize::try_from(found).ok().filter(|_| allowed.contains(&found)).ok_or_else(|| {
            let [first, last] = [allowed.start(), allowed.end()];
            let range = if first == last { first.to_string() } else { format!("whole numbers from {first} to {last}") };
            self.refused(what, found, range)
        })
    }

    /// A whole number of 32 bits with sign.
    pub(super) fn int(&mut self, what: &'static str) -> Result<i32, GmshError> {
        match self.form {
            Form::Text => self.text_number(what, INT),
            Form::Little | Form::Big => Ok(i32::from_le_bytes(self.binary(what)?)),
        }
    }

    /// A whole number of 64 bits without sign.
    pub(super) fn size(&mut self, what: &'static str) -> Result<u64, GmshError> {
        match self.form {
            Form::Text => self.text_number(what, "whole numbers from 0 to 2^64 - 1"),
            Form::Little | Form::Big => Ok(u64::from_le_bytes(self.binary(what)?)),
        }
    }

    /// A floating-point number, infinite ones included.
    pub(super) fn real(&mut self, what: &'static str) -> Result<f64, GmshError> {
        match self.form {
            Form::Text => self.text_number(what, "numbers"),
            Form::Little | Form::Big => Ok(f64::from_le_bytes(self.binary(what)?)),
        }
    }

    pub(super) fn finite(&mut self, what: &'static str) -> Result<f64, GmshError> {
        let value = self.real(what)?;
        if value.is_finite() { Ok(value) } else { Err(self.refused(what, value, "finite numbers")) }
    }

    /// The tag of a node or an element.
    pub(super) fn tag(&mut self, what: &'static str) -> Result<u64, GmshError> {
        let tag = self.size(what)?;
        if tag > 0 { Ok(tag) } else { Err(self.refused(what, "0", "positive numbers")) }
    }

    /// The number of items that follow, each with so many numbers of 32 and of 64 bits. It is refused if the rest of
    /// the file is too short for them: what a count reserves in memory is in proportion to the file.
    pub(super) fn count(&mut self, what: &'static str, ints: usize, longs: usize) -> Result<usize, GmshError> {
        let found = self.size(what)?;
        // In a text, a number has at least one digit and a blank or the end of a line.
        let least = if self.form == Form::Text { 2 * (ints + longs) } else { 4 * ints + 8 * longs };
        let most = self.rest().len() / least.max(1);
        let count = usize::try_from(found).ok().filter(|count| *count <= most);
        count.ok_or_else(|| {
            self.refused(what, found, format!("at most {most}, for which the rest of the file is long enough"))
        })
    }
}

/// The beginning of an extract of a file, as printable text.
pub(super) fn extract(bytes: &[u8]) -> String {
    // A character has at most four bytes.
    let bytes = bytes.get(..4 * MAX_EXTRACT).unwrap_or(bytes);
    let printable = |character: char| if character.is_control() { '?' } else { character };
    String::from_utf8_lossy(bytes).chars().take(MAX_EXTRACT).map(printable).collect()
}
