//! Reproducible numbers, and how far two sets of numbers are apart.

use serde_json::Value;

/// A seeded generator (SplitMix64): a Weyl sequence through a mixing function.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// One of 0, 1, …, `count` − 1; 0 for `count` = 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count.max(1) as u64) as usize
    }
}

/// Deterministic noise: as many numbers in [−1, 1) as the point has entries. They jump from point to point and are
/// always the same at one point (a hash of the Fowler–Noll–Vo kind over the bits of the entries so far). Another `salt`
/// gives other noise.
pub fn jitters(x: &[f64], salt: u64) -> impl Iterator<Item = f64> {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64 ^ salt.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x.iter().map(move |entry| {
        hash = (hash ^ entry.to_bits()).wrapping_mul(0x0100_0000_01b3);
        hash ^= hash >> 29;
        (hash >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    })
}

/// The last of [`jitters`], which all entries have a part in; 0 for a point without entries.
pub fn jitter(x: &[f64], salt: u64) -> f64 {
    jitters(x, salt).last().unwrap_or(0.0)
}

/// Heights of a gently wavy surface, at most 0.8 % below `height`.
pub fn wavy(height: f64, count: usize) -> Vec<f64> {
    (0..count).map(|index| height * (1.0 - 0.004 * (1.0 + (1.3 * index as f64).sin()))).collect()
}

/// Largest difference of two sequences over the largest entry of the second; 0 if they are equal.
///
/// # Panics
/// When one sequence is longer than the other.
pub fn relative_difference<'a>(
    found: impl IntoIterator<Item = &'a f64>,
    expected: impl IntoIterator<Item = &'a f64>,
) -> f64 {
    let (mut difference, mut largest) = (0.0_f64, f64::MIN_POSITIVE);
    let mut found = found.into_iter();
    for b in expected {
        let a = found.next().expect("as many numbers as expected");
        difference = difference.max((a - b).abs());
        largest = largest.max(b.abs());
    }
    assert!(found.next().is_none(), "more numbers than expected");
    difference / largest
}

/// The numbers of a JSON array.
///
/// # Panics
/// When the value is something else.
pub fn numbers(value: &Value) -> Vec<f64> {
    let entries = value.as_array().unwrap_or_else(|| panic!("no array: {value}"));
    entries.iter().map(|entry| entry.as_f64().unwrap_or_else(|| panic!("no number: {entry}"))).collect()
}
