//! Dot products and rotations of plain slices.

/// xᵀ y with eight independent sums.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
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

/// Σ |x_i y_i|: size of the terms of a dot product.
pub(super) fn dot_terms(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| (a * b).abs()).sum()
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
