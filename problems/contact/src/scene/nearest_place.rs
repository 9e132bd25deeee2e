//! The nearest point of a curve over [0, 1].

/// Parts at whose ends the search begins.
const PARTS: usize = 8;

/// The place of the nearest point, from the square of the distance and half of its slope: the best of some places, then
/// bisection of the slope around it.
pub(super) fn nearest_place(square: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> f64 {
    let place = |k: usize| k as f64 / PARTS as f64;
    let best = (1..=PARTS).fold(0, |best, k| if square(place(k)) < square(place(best)) { k } else { best });
    let (mut low, mut high) = (place(best.saturating_sub(1)), place((best + 1).min(PARTS)));
    if slope(low) >= 0.0 {
        return low;
    }
    if slope(high) <= 0.0 {
        return high;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if slope(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}
