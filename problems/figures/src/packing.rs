//! Numbers as compressed text that a script on a page reads: levels of 16 bits, differences, planes of bytes, gzip,
//! base64. `assets/viewer.js` describes the layout and reads it.

use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;

/// The highest level; levels are 0 … 65534.
const LEVELS: f64 = 65534.0;
/// The level of what has no value.
const NONE: u16 = u16::MAX;

/// Arrays one after the other.
#[derive(Debug, Default)]
pub(super) struct Packing {
    bytes: Vec<u8>,
}

impl Packing {
    /// Adds finite numbers, and NaN for those that there are not, as levels between the least and the largest one; says
    /// as JSON where they are.
    pub fn levels(&mut self, values: impl Iterator<Item = f64> + Clone) -> String {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = values.clone().fold(ends, |[low, high], value| [low.min(value), high.max(value)]);
        let [low, high] = if low <= high { [low, high] } else { [0.0, 0.0] };
        let level = |value: f64| match (value.is_nan(), high > low) {
            (true, _) => NONE,
            (false, true) => ((value - low) / (high - low) * LEVELS).round() as u16,
            (false, false) => 0,
        };
        let levels: Vec<u16> = values.map(level).collect();
        let differences: Vec<[u8; 2]> =
            (0..levels.len()).map(|i| levels[i].wrapping_sub(before(&levels, i, 1)).to_be_bytes()).collect();
        let (at, n) = (self.planes(&differences), levels.len());
        format!("{{\"at\":{at},\"n\":{n},\"stride\":1,\"size\":2,\"low\":{low},\"high\":{high}}}")
    }

    /// Adds whole numbers, as differences to those `stride` places before; says as JSON where they are.
    pub fn integers(&mut self, values: &[u32], stride: usize) -> String {
        let differences: Vec<[u8; 4]> =
            (0..values.len()).map(|i| values[i].wrapping_sub(before(values, i, stride)).to_be_bytes()).collect();
        let (at, n) = (self.planes(&differences), values.len());
        format!("{{\"at\":{at},\"n\":{n},\"stride\":{stride},\"size\":4}}")
    }

    /// The first bytes of all numbers, then the second ones, …; returns where they begin.
    fn planes<const SIZE: usize>(&mut self, numbers: &[[u8; SIZE]]) -> usize {
        let at = self.bytes.len();
        (0..SIZE).for_each(|plane| self.bytes.extend(numbers.iter().map(|number| number[plane])));
        at
    }

    /// Header and arrays, compressed.
    pub fn text(self, header: &str) -> String {
        let length = (header.len() as u32).to_le_bytes();
        base64(&compressed(&[&length, header.as_bytes(), &self.bytes]))
    }
}

/// The number `stride` places before one; 0 at the beginning.
fn before<T: Copy + Default>(values: &[T], index: usize, stride: usize) -> T {
    index.checked_sub(stride).map(|index| values[index]).unwrap_or_default()
}

/// Some bytes as gzip without a date, so that the same bytes give the same ones.
pub(super) fn compressed(parts: &[&[u8]]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    for part in parts {
        encoder.write_all(part).expect("a vector takes everything");
    }
    encoder.finish().expect("a vector takes everything")
}

/// Bytes as text (RFC 4648, section 4).
pub(super) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or_default());
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= group.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// A text as JSON.
pub(super) fn json_text(text: &str) -> String {
    let letter = |letter: char| match letter {
        '"' | '\\' => format!("\\{letter}"),
        letter if letter.is_control() => format!("\\u{:04x}", u32::from(letter)),
        letter => letter.to_string(),
    };
    format!("\"{}\"", text.chars().map(letter).collect::<String>())
}

/// A list of what is JSON already.
pub(super) fn json_list(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(","))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use flate2::read::GzDecoder;
    use serde_json::Value;
    use std::io::Read;

    pub(crate) struct Unpacked {
        pub header: Value,
        pub bytes: Vec<u8>,
    }

    /// Header and arrays from a text.
    pub(crate) fn unpacked(text: &str) -> Unpacked {
        let mut bytes = Vec::new();
        GzDecoder::new(&decoded(text)[..]).read_to_end(&mut bytes).expect("gzip");
        let rest = bytes.split_off(4);
        let length = u32::from_le_bytes(bytes.try_into().expect("four bytes")) as usize;
        let header = serde_json::from_slice(&rest[..length]).expect("JSON");
        Unpacked { header, bytes: rest[length..].to_vec() }
    }

    /// The numbers of an array, read as the script does.
    pub(crate) fn values(array: &Value, bytes: &[u8]) -> Vec<f64> {
        let [at, n, stride, size] =
            ["at", "n", "stride", "size"].map(|name| array[name].as_u64().expect("a number") as usize);
        let modulus = 1_u64 << (8 * size);
        let mut found: Vec<u64> = Vec::new();
        for i in 0..n {
            let difference = (0..size).fold(0, |sum, plane| sum << 8 | u64::from(bytes[at + plane * n + i]));
            found.push((difference + before(&found, i, stride)) % modulus);
        }
        let Some([low, high]) = array["low"].as_f64().zip(array["high"].as_f64()).map(<[f64; 2]>::from) else {
            return found.into_iter().map(|number| number as f64).collect();
        };
        let value = |level| if level == 65535 { f64::NAN } else { low + level as f64 * (high - low) / 65534.0 };
        found.into_iter().map(value).collect()
    }

    fn decoded(text: &str) -> Vec<u8> {
        let value = |letter: u8| match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            other => panic!("{other}"),
        };
        let letters: Vec<u8> = text.trim_end_matches('=').bytes().map(value).collect();
        let group = |group: &[u8]| {
            let bits = (0..4).fold(0, |bits, i| bits << 6 | u32::from(group.get(i).copied().unwrap_or_default()));
            bits.to_be_bytes()[1..group.len()].to_vec()
        };
        letters.chunks(4).flat_map(group).collect()
    }

    #[test]
    fn base64_of_the_standard() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!((base64(bytes.as_bytes()), decoded(text)), (text.to_owned(), bytes.as_bytes().to_vec()));
        }
    }

    #[test]
    fn texts_with_quotes_and_lines_are_json() {
        let text = "a \"b\" \\ \n µ";
        assert_eq!(serde_json::from_str::<String>(&json_text(text)).expect("JSON"), text);
    }

    #[test]
    fn ends_are_exact_and_one_value_alone_too() {
        for expected in [vec![-3.5, 1e-9, 7.25], vec![4.0, 4.0], vec![f64::NAN], vec![]] {
            let mut packing = Packing::default();
            let array = serde_json::from_str(&packing.levels(expected.iter().copied())).expect("JSON");
            let found = values(&array, &packing.bytes);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!(found.is_nan() && expected.is_nan() || (found - expected).abs() < 1e-4);
            }
        }
    }
}
