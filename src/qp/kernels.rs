//! Dot products and rotations of plain slices.

/// xᵀ y with eight independent sums.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (x_blocks, y_blocks) = (x.chunks_exact(8), y.chunks_exact(8));
    let tail: f64 = x_blocks.remainder().iter().zip(y_blocks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in x_blocks.zip(y_blocks) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

/// Σ g_i (x_i − y_i) with eight independent sums.
pub(crate) fn difference_dot(g: &[f64], x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (blocks, rest) = g.as_chunks::<8>();
    let (x_blocks, x_rest) = x.as_chunks::<8>();
    let (y_blocks, y_rest) = y.as_chunks::<8>();
    let tail: f64 = rest.iter().zip(x_rest.iter().zip(y_rest)).map(|(g, (x, y))| g * (x - y)).sum();
    for (g, (x, y)) in blocks.iter().zip(x_blocks.iter().zip(y_blocks)) {
        for k in 0..8 {
            sums[k] += g[k] * (x[k] - y[k]);
        }
    }
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
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

/// Σ w_i (x_i − y_i)² with eight independent sums.
pub(crate) fn weighted_squared_distance(w: &[f64], x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (blocks, rest) = w.as_chunks::<8>();
    let (x_blocks, x_rest) = x.as_chunks::<8>();
    let (y_blocks, y_rest) = y.as_chunks::<8>();
    let tail: f64 = rest.iter().zip(x_rest.iter().zip(y_rest)).map(|(w, (x, y))| w * (x - y) * (x - y)).sum();
    for (w, (x, y)) in blocks.iter().zip(x_blocks.iter().zip(y_blocks)) {
        for k in 0..8 {
            sums[k] += w[k] * (x[k] - y[k]) * (x[k] - y[k]);
        }
    }
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

/// Σ w_i x_i² with eight independent sums.
pub(crate) fn weighted_squares(w: &[f64], x: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (blocks, rest) = w.as_chunks::<8>();
    let (x_blocks, x_rest) = x.as_chunks::<8>();
    let tail: f64 = rest.iter().zip(x_rest).map(|(w, x)| w * x * x).sum();
    for (w, x) in blocks.iter().zip(x_blocks) {
        for k in 0..8 {
            sums[k] += w[k] * x[k] * x[k];
        }
    }
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
}

/// Σ |x_i y_i|: size of the terms of a dot product.
pub(crate) fn dot_terms(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (x_blocks, x_rest) = x.as_chunks::<8>();
    let (y_blocks, y_rest) = y.as_chunks::<8>();
    let tail: f64 = x_rest.iter().zip(y_rest).map(|(a, b)| (a * b).abs()).sum();
    for (a, b) in x_blocks.iter().zip(y_blocks) {
        for k in 0..8 {
            sums[k] += (a[k] * b[k]).abs();
        }
    }
    tail + ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]))
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
