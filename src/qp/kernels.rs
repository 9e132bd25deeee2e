//! Dot products and rotations of plain slices.

/// Σ term(x_i, y_i, …) with eight independent sums.
#[inline(always)]
fn sum_of<const K: usize>(vectors: [&[f64]; K], term: impl Fn([f64; K]) -> f64) -> f64 {
    let length = vectors.iter().map(|vector| vector.len()).min().unwrap_or(0);
    let count = length / 8;
    let blocks = vectors.map(|vector| &vector.as_chunks::<8>().0[..count]);
    let rest = vectors.map(|vector| &vector[8 * count..length]);
    let tail: f64 = (0..length - 8 * count).map(|i| term(rest.map(|rest| rest[i]))).sum();
    let mut sums = [0.0; 8];
    for i in 0..count {
        let block = blocks.map(|blocks| &blocks[i]);
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += term(block.map(|block| block[k]));
        }
    }
    total(tail, sums)
}

/// xᵀ y.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    sum_of([x, y], |[x, y]| x * y)
}

/// The products of y with some vectors, two at a time, each rounded as by [`dot`].
pub(super) fn dots<'x>(vectors: impl ExactSizeIterator<Item = &'x [f64]>, y: &[f64]) -> Vec<f64> {
    let mut products = Vec::with_capacity(vectors.len());
    let (mut vectors, (blocks, rest)) = (vectors, y.as_chunks::<8>());
    while let Some(first) = vectors.next() {
        let Some(second) = vectors.next() else {
            products.push(dot(first, y));
            break;
        };
        let parts = [first, second].map(|vector| vector.as_chunks::<8>());
        let sums = two_dot_lanes([parts[0].0, parts[1].0, blocks]);
        for ((_, tail), sums) in parts.iter().zip(sums) {
            products.push(total(tail.iter().zip(rest).map(|(x, y)| x * y).sum(), sums));
        }
    }
    products
}

/// The sums of two products over whole blocks; not inlined for the reason given at [`pair_lanes`].
#[inline(never)]
fn two_dot_lanes([x, z, y]: [&[[f64; 8]]; 3]) -> [[f64; 8]; 2] {
    let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
    for ((x, z), y) in x.iter().zip(z).zip(y) {
        for k in 0..8 {
            first[k] += x[k] * y[k];
        }
        for k in 0..8 {
            second[k] += z[k] * y[k];
        }
    }
    [first, second]
}

/// Σ g_i (x_i − y_i).
pub(crate) fn difference_dot(g: &[f64], x: &[f64], y: &[f64]) -> f64 {
    sum_of([g, x, y], |[g, x, y]| g * (x - y))
}

/// gᵀ(y − x), hᵀ(y − x), gᵀr and |y − x|² in one pass, with four independent sums each.
pub(crate) fn pair_sums(g: &[f64], x: &[f64], h: &[f64], y: &[f64], r: &[f64]) -> [f64; 4] {
    let rests = [g, x, h, y, r].map(|vector| vector.as_chunks::<4>().1);
    let mut sums = pair_lanes([g, x, h, y, r].map(|vector| vector.as_chunks().0));
    for i in 0..rests[0].len() {
        let [g, x, h, y, r] = rests.map(|rest| rest[i]);
        let s = y - x;
        for (sum, term) in sums.iter_mut().zip([g * s, h * s, g * r, s * s]) {
            sum[0] += term;
        }
    }
    sums.map(|lanes| (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]))
}

/// The sums of [`pair_sums`] over whole blocks. Not inlined: where the compiler sees the four results side by side, it
/// packs them into one register instead of four terms of one sum, and the pass takes more than twice as long.
#[inline(never)]
fn pair_lanes([g, x, h, y, r]: [&[[f64; 4]]; 5]) -> [[f64; 4]; 4] {
    let (mut ahead, mut behind, mut product, mut squared) = ([0.0; 4], [0.0; 4], [0.0; 4], [0.0; 4]);
    for ((g, x), ((h, y), r)) in g.iter().zip(x).zip(h.iter().zip(y).zip(r)) {
        let s: [f64; 4] = std::array::from_fn(|k| y[k] - x[k]);
        add_products(&mut ahead, g, &s);
        add_products(&mut behind, h, &s);
        add_products(&mut product, g, r);
        add_products(&mut squared, &s, &s);
    }
    [ahead, behind, product, squared]
}

/// sum_k += x_k y_k.
#[inline(always)]
fn add_products(sum: &mut [f64; 4], x: &[f64; 4], y: &[f64; 4]) {
    for k in 0..4 {
        sum[k] += x[k] * y[k];
    }
}

/// Σ w_i (x_i − y_i)².
pub(crate) fn weighted_squared_distance(w: &[f64], x: &[f64], y: &[f64]) -> f64 {
    sum_of([w, x, y], |[w, x, y]| w * (x - y) * (x - y))
}

/// Σ w_i x_i².
pub(crate) fn weighted_squares(w: &[f64], x: &[f64]) -> f64 {
    sum_of([w, x], |[w, x]| w * x * x)
}

/// Σ |x_i y_i|: size of the terms of a dot product.
pub(crate) fn dot_terms(x: &[f64], y: &[f64]) -> f64 {
    sum_of([x, y], |[x, y]| (x * y).abs())
}

/// Σ |x_i y_i| and Σ |x_i z_i| in one pass, each rounded as by [`dot_terms`].
pub(crate) fn two_dot_terms(x: &[f64], y: &[f64], z: &[f64]) -> [f64; 2] {
    let rests = [x, y, z].map(|vector| vector.as_chunks::<8>().1);
    let sums = two_term_lanes([x, y, z].map(|vector| vector.as_chunks().0));
    let tail = |k: usize| rests[0].iter().zip(rests[k]).map(|(x, y)| (x * y).abs()).sum::<f64>();
    std::array::from_fn(|k| total(tail(k + 1), sums[k]))
}

/// The sums of [`two_dot_terms`] over whole blocks; not inlined for the reason given at [`pair_lanes`].
#[inline(never)]
fn two_term_lanes([x, y, z]: [&[[f64; 8]]; 3]) -> [[f64; 8]; 2] {
    let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
    for ((x, y), z) in x.iter().zip(y).zip(z) {
        for k in 0..8 {
            first[k] += (x[k] * y[k]).abs();
        }
        for k in 0..8 {
            second[k] += (x[k] * z[k]).abs();
        }
    }
    [first, second]
}

/// The sum of a tail and eight lanes.
fn total(tail: f64, sums: [f64; 8]) -> f64 {
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

/// y += factor · x.
pub(super) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
}

/// y += Σ factor · x, rounded as by [`add_scaled`] one after the other; y is read and written once for four of them.
pub(super) fn add_all_scaled(y: &mut [f64], terms: &[(f64, &[f64])]) {
    let (fours, rest) = terms.as_chunks::<4>();
    for [(a, x), (b, z), (c, u), (d, v)] in fours {
        let others = x.iter().zip(*z).zip(u.iter().zip(*v));
        for (y, ((x, z), (u, v))) in y.iter_mut().zip(others) {
            *y = *y + a * x + b * z + c * u + d * v;
        }
    }
    rest.iter().for_each(|(factor, x)| add_scaled(y, *factor, x));
}

/// Euclidean norm.
pub(super) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// A plane rotation (x, y) ↦ (c x + s y, c y − s x).
#[derive(Clone, Copy)]
pub(super) struct Rotation {
    cosine: f64,
    sine: f64,
}

impl Rotation {
    /// The rotation that maps (a, b) to (√(a² + b²), 0).
    pub(super) fn onto_first(a: f64, b: f64) -> Self {
        let length = a.hypot(b);
        if length == 0.0 { Self { cosine: 1.0, sine: 0.0 } } else { Self { cosine: a / length, sine: b / length } }
    }

    pub(super) fn apply(self, x: &mut f64, y: &mut f64) {
        let (first, second) = (self.cosine * *x + self.sine * *y, self.cosine * *y - self.sine * *x);
        *x = first;
        *y = second;
    }

    pub(super) fn apply_to_slices(self, x: &mut [f64], y: &mut [f64]) {
        for (x, y) in x.iter_mut().zip(y) {
            self.apply(x, y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers whose sums depend on their order.
    fn vector(length: usize, seed: usize) -> Vec<f64> {
        (0..length).map(|i| ((17 * i + 31 * seed) as f64).sin() * 10_f64.powi(((i + seed) % 7) as i32)).collect()
    }

    #[test]
    fn several_vectors_at_once_are_rounded_as_one_after_the_other() {
        for (length, count) in [(0, 3), (1, 1), (7, 4), (8, 5), (29, 6), (64, 9)] {
            let vectors: Vec<Vec<f64>> = (0..count).map(|seed| vector(length, seed)).collect();
            let y = vector(length, count);
            let each: Vec<f64> = vectors.iter().map(|x| dot(x, &y)).collect();
            assert_eq!(dots(vectors.iter().map(Vec::as_slice), &y), each);
            let terms: Vec<(f64, &[f64])> = vectors.iter().map(|x| (x.len() as f64 / 3.0, x.as_slice())).collect();
            let (mut together, mut one_by_one) = (y.clone(), y);
            add_all_scaled(&mut together, &terms);
            terms.iter().for_each(|(factor, x)| add_scaled(&mut one_by_one, *factor, x));
            assert_eq!(together, one_by_one);
        }
    }
}
