//! Colours: a scale from dark blue over green to yellow, and a few that are told apart in curves.
//!
//! The scale is the curve of largest chroma ≤ 0.17 in OKLab \[Ottosson2020\] whose lightness rises from 0.27 to 0.93
//! while the hue turns from 300° to 105°, at places of equal distance along it: equal steps of the value look equally
//! large, and lightness alone gives the order (also in grey and for colour-blind readers).

/// sRGB of the scale.
const SCALE: [[u8; 3]; 17] = [
    [52, 0, 96],
    [53, 1, 123],
    [44, 33, 142],
    [20, 56, 158],
    [0, 75, 151],
    [1, 91, 146],
    [1, 108, 147],
    [2, 126, 151],
    [5, 145, 154],
    [1, 162, 156],
    [3, 178, 153],
    [0, 193, 145],
    [41, 206, 130],
    [113, 217, 114],
    [164, 225, 99],
    [208, 232, 86],
    [249, 237, 82],
];

/// Colours of curves: dark enough on white, different in lightness, red and green not side by side.
pub(super) const CURVES: [&str; 7] = ["#1b5fa8", "#d1622b", "#2f8f6b", "#8a4fa3", "#b8912b", "#444444", "#c65a92"];

/// The colour of the curve of a number.
pub(super) fn curve(index: usize) -> &'static str {
    CURVES[index % CURVES.len()]
}

/// The colours of the scale at equal distances, from the least to the largest value.
pub(super) fn scale() -> [String; SCALE.len()] {
    SCALE.map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"))
}

/// Colour of a share 0 … 1 of the scale; smaller and larger shares get the colours of its ends.
pub(super) fn colour(share: f64) -> String {
    let position = share.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let index = (position as usize).min(SCALE.len() - 2);
    let rest = position - index as f64;
    let [r, g, b] = std::array::from_fn(|i| {
        let (low, high) = (f64::from(SCALE[index][i]), f64::from(SCALE[index + 1][i]));
        (low + rest * (high - low)).round() as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness from sRGB.
    fn lightness([r, g, b]: [u8; 3]) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        116.0 * (0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)).cbrt() - 16.0
    }

    #[test]
    fn lightness_rises_without_jumps() {
        let steps: Vec<f64> = SCALE.windows(2).map(|pair| lightness(pair[1]) - lightness(pair[0])).collect();
        assert!(steps.iter().all(|step| (1.5..9.0).contains(step)), "{steps:?}");
        assert!(lightness(SCALE[0]) < 15.0 && lightness(SCALE[16]) > 90.0);
    }

    #[test]
    fn ends_of_the_scale_are_kept_for_what_lies_outside() {
        assert_eq!((colour(-1.0), colour(f64::NAN).len(), colour(2.0)), ("#340060".into(), 7, "#f9ed52".into()));
    }
}
