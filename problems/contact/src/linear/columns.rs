//! Column by column products and sums of blocks; sums in a fixed order, whatever the number of threads.

use crate::linear::entry::{Entry, Row, vectorized};
use crate::linear::real::Real;
use rayon::prelude::*;

/// Rows that are worked on together: their numbers stay in the cache of one core, and sums in single precision stay short.
const CHUNK: usize = 256;

/// aᵀb per column, for every a of a list.
pub fn products<E: Real, const N: usize>(list: &[&[Row<E, N>]], b: &[Row<E, N>]) -> Vec<Row<f64, N>> {
    let partial: Vec<Vec<Row<E, N>>> = b
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, b)| {
            let product = |a: &&[Row<E, N>]| {
                let a = &a[chunk * CHUNK..][..b.len()];
                vectorized(
                    #[inline(always)]
                    || {
                        let mut sum = Row::ZERO;
                        for (a, b) in a.iter().zip(b) {
                            sum.add_product(a, b);
                        }
                        sum
                    },
                )
            };
            list.iter().map(product).collect()
        })
        .collect();
    let mut sums = vec![Row::ZERO; list.len()];
    for chunk in partial {
        for (sum, partial) in sums.iter_mut().zip(chunk) {
            sum.add_scaled(1.0, &partial.to());
        }
    }
    sums
}

/// |a|₂ per column, with squares in double precision, so that they neither overflow nor underflow whatever the units.
pub fn norms<E: Real, const N: usize>(a: &[Row<E, N>]) -> Row<f64, N> {
    let square = |a: &[Row<E, N>]| {
        vectorized(
            #[inline(always)]
            || {
                let mut sum = Row::<f64, N>::ZERO;
                for a in a {
                    let a = a.to();
                    sum.add_product(&a, &a);
                }
                sum
            },
        )
    };
    let partial: Vec<Row<f64, N>> = a.par_chunks(CHUNK).map(square).collect();
    let mut sum = Row::ZERO;
    partial.iter().for_each(|partial| sum.add_scaled(1.0, partial));
    sum.map(f64::sqrt)
}

/// y += Σ factors∘x, with one factor per column for every x; x may have another precision than y.
pub fn add_combination<E: Real, F: Real, const N: usize>(y: &mut [Row<E, N>], terms: &[(Row<f64, N>, &[Row<F, N>])]) {
    y.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, y)| {
        for (factors, x) in terms {
            let (factors, x) = (factors.to::<E>(), &x[chunk * CHUNK..][..y.len()]);
            vectorized(
                #[inline(always)]
                || {
                    for (y, x) in y.iter_mut().zip(x) {
                        y.add_product(&factors, &x.to());
                    }
                },
            );
        }
    });
}
