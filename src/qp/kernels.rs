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
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

/// xᵀ y.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    sum_of([x, y], |[x, y]| x * y)
}

/// Σ g_i (x_i − y_i).
pub(crate) fn difference_dot(g: &[f64], x: &[f64], y: &[f64]) -> f64 {
    sum_of([g, x, y], |[g, x, y]| g * (x - y))
}

/// gᵀ(y − x), hᵀ(y − x), gᵀr and |y − x|² in one pass, with four independent sums each.
pub(crate) fn pair_sums(g: &[f64], x: &[f64], h: &[f64], y: &[f64], r: &[f64]) -> [f64; 4] {
    let mut sums = [[0.0; 4]; 4];
    let mut add = |lane: usize, g: f64, x: f64, h: f64, y: f64, r: f64| {
        let s = y - x;
        sums[0][lane] += g * s;
        sums[1][lane] += h * s;
        sums[2][lane] += g * r;
        sums[3][lane] += s * s;
    };
    let ((g, g_rest), (x, x_rest), (h, h_rest)) = (g.as_chunks::<4>(), x.as_chunks::<4>(), h.as_chunks::<4>());
    let ((y, y_rest), (r, r_rest)) = (y.as_chunks::<4>(), r.as_chunks::<4>());
    for ((g, x), ((h, y), r)) in g.iter().zip(x).zip(h.iter().zip(y).zip(r)) {
        for k in 0..4 {
            add(k, g[k], x[k], h[k], y[k], r[k]);
        }
    }
    for ((g, x), ((h, y), r)) in g_rest.iter().zip(x_rest).zip(h_rest.iter().zip(y_rest).zip(r_rest)) {
        add(0, *g, *x, *h, *y, *r);
    }
    sums.map(|lanes| (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]))
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

/// y += factor · x.
pub(super) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += factor * x;
    }
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
