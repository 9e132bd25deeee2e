//! Column by column products and sums of blocks; sums in a fixed order, whatever the number of threads.

use crate::linear::entry::{Entry, Row, vectorized};
use crate::linear::parallel::for_parts;
use crate::linear::real::Real;
use crate::linear::sums::Sums;

/// Rows that are worked on together: their numbers stay in the cache of a core, and sums in single precision short.
const CHUNK: usize = 256;

/// aᵀb per column, for every a of a list.
pub fn products<E: Real, const N: usize>(sums: &dyn Sums, list: &[&[Row<E, N>]], b: &[Row<E, N>]) -> Vec<Row<f64, N>> {
    let numbers = sums.sum(b.len(), Row::<f64, N>::WIDTH * list.len(), &|part, sums| {
        for first in part.clone().step_by(CHUNK) {
            let chunk = first..part.end.min(first + CHUNK);
            for (a, sums) in list.iter().zip(sums.chunks_exact_mut(Row::<f64, N>::WIDTH)) {
                let (a, b) = (&a[chunk.clone()], &b[chunk.clone()]);
                let product = vectorized(
                    #[inline(always)]
                    || {
                        let mut sum = Row::<E, N>::ZERO;
                        for (a, b) in a.iter().zip(b) {
                            sum.add_product(a, b);
                        }
                        sum
                    },
                );
                sums.iter_mut().zip(product.iter()).for_each(|(sum, product)| *sum += product.double());
            }
        }
    });
    rows(&numbers)
}

/// |a|₂ per column, with squares in double precision, so that they neither overflow nor underflow whatever the units.
pub fn norms<E: Real, const N: usize>(sums: &dyn Sums, a: &[Row<E, N>]) -> Row<f64, N> {
    let numbers = sums.sum(a.len(), Row::<f64, N>::WIDTH, &|part, sums| {
        let square = vectorized(
            #[inline(always)]
            || {
                let mut sum = Row::<f64, N>::ZERO;
                for a in &a[part] {
                    let a = a.to();
                    sum.add_product(&a, &a);
                }
                sum
            },
        );
        sums.iter_mut().zip(square.iter()).for_each(|(sum, square)| *sum += square);
    });
    rows(&numbers)[0].map(f64::sqrt)
}

fn rows<const N: usize>(numbers: &[f64]) -> Vec<Row<f64, N>> {
    let row = |numbers: &[f64]| {
        let mut row = Row::ZERO;
        numbers.iter().enumerate().for_each(|(column, &number)| row.set(column, number));
        row
    };
    numbers.chunks_exact(Row::<f64, N>::WIDTH).map(row).collect()
}

/// y += Σ factors∘x, with one factor per column for every x; x may have another precision than y.
pub fn add_combination<E: Real, F: Real, const N: usize>(y: &mut [Row<E, N>], terms: &[(Row<f64, N>, &[Row<F, N>])]) {
    for_parts(y.chunks_mut(CHUNK), &|chunk, y| {
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
