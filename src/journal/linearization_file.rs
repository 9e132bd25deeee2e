//! Jacobians of evaluations as files beside the journal: binary, with a checksum, since they are large.
//!
//! ```text
//! "NSLIN1\n\0", m, n, k (u64), accuracy, outputs (m), Jacobian (m × n by columns), slacks (k), their Jacobian (k × n), checksum
//! ```
//! All numbers are little endian. There are m outputs of n variables and k slacks of inactive constraints; k = 2⁶⁴ − 1
//! stands for no slacks. The checksum is that of Fowler, Noll and Vo (FNV-1a, 64 bits) over all bytes before it.

use crate::composite::{InactiveConstraints, Linearization};
use crate::{Matrix, Vector};
use std::io;

const MAGIC: &[u8; 8] = b"NSLIN1\n\0";
/// k of a file without slacks.
const NO_SLACKS: u64 = u64::MAX;

/// The bytes of a file.
pub(super) fn encode(linearization: &Linearization) -> Vec<u8> {
    let Linearization { outputs, jacobian, accuracy, inactive } = linearization;
    let mut bytes = MAGIC.to_vec();
    let count = inactive.as_ref().map_or(NO_SLACKS, |inactive| inactive.slacks.len() as u64);
    for size in [outputs.len() as u64, jacobian.ncols() as u64, count] {
        bytes.extend(size.to_le_bytes());
    }
    let mut write = |values: &[f64]| bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    write(&[*accuracy]);
    write(outputs.as_slice());
    write(jacobian.as_slice());
    if let Some(inactive) = inactive {
        write(inactive.slacks.as_slice());
        write(inactive.jacobian.as_slice());
    }
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// What the bytes of a file say.
///
/// # Errors
/// [`io::ErrorKind::InvalidData`] for bytes that are not those of a whole file.
pub(super) fn decode(bytes: &[u8]) -> io::Result<Linearization> {
    let torn = || io::Error::new(io::ErrorKind::InvalidData, "not a whole file of a Jacobian");
    let (body, sum) = bytes.split_last_chunk::<8>().ok_or_else(torn)?;
    if u64::from_le_bytes(*sum) != checksum(body) {
        return Err(torn());
    }
    let body = body.strip_prefix(MAGIC).ok_or_else(torn)?;
    let mut words = body.chunks_exact(8).map(|word| word.try_into().map_or([0; 8], |word: [u8; 8]| word));
    let mut size = || words.next().map(u64::from_le_bytes).ok_or_else(torn);
    let (rows, columns, count) = (size()?, size()?, size()?);
    let values: Vec<f64> = words.map(f64::from_le_bytes).collect();
    let slacks = if count == NO_SLACKS { 0 } else { count };
    let expected = rows.checked_add(slacks).and_then(|lines| lines.checked_mul(columns.checked_add(1)?));
    if expected.and_then(|expected| expected.checked_add(1)) != Some(values.len() as u64) {
        return Err(torn());
    }
    let (m, n, k) = (rows as usize, columns as usize, slacks as usize);
    let mut rest = &values[..];
    let mut take = |count: usize| {
        let (taken, left) = rest.split_at(count);
        rest = left;
        taken
    };
    let accuracy = take(1)[0];
    let outputs = Vector::from_column_slice(take(m));
    let jacobian = Matrix::from_column_slice(m, n, take(m * n));
    let slacks = Vector::from_column_slice(take(k));
    let inactive = InactiveConstraints { slacks, jacobian: Matrix::from_column_slice(k, n, take(k * n)) };
    Ok(Linearization { outputs, jacobian, accuracy, inactive: (count != NO_SLACKS).then_some(inactive) })
}

/// FNV-1a, 64 bits.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Linearization {
        let slacks = Vector::from_vec(vec![0.1, 1e-300]);
        let jacobian = Matrix::from_fn(2, 3, |i, j| 0.1 + (i + 2 * j) as f64);
        Linearization {
            outputs: Vector::from_vec(vec![1.0 / 3.0, -0.0, 1e300, 5e-324]),
            jacobian: Matrix::from_fn(4, 3, |i, j| (i as f64 + 0.7).powi(j as i32)),
            accuracy: 1e-4,
            inactive: Some(InactiveConstraints { slacks, jacobian }),
        }
    }

    #[test]
    fn a_file_reads_back_bit_by_bit() {
        for linearization in [example(), Linearization { inactive: None, ..example() }] {
            assert_eq!(decode(&encode(&linearization)).expect("whole"), linearization);
        }
    }

    #[test]
    fn a_torn_or_changed_file_is_refused() {
        let bytes = encode(&example());
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "{length}");
        }
        for index in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[index] ^= 1;
            assert!(decode(&changed).is_err(), "{index}");
        }
    }
}
