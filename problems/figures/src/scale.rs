//! Axes as numbers: ranges, ticks and their labels.
//!
//! A power of ten is taken out of the labels when the largest number is ≥ 10⁵ or < 10⁻²: `Θ (10^{18} MPa^{4})`, ticks
//! 0, 1, 2.

/// Smallest range of a linear axis relative to the largest number; beyond, labels would differ in rounding errors only.
const MIN_RELATIVE_RANGE: f64 = 1e-6;

/// A tick: its place on the axis as a share 0 … 1, and its label.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub share: f64,
    pub label: String,
}

/// An axis with its range.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// What it shows, with the unit and the power of ten that was taken out.
    pub title: String,
    pub ticks: Vec<Tick>,
    logarithmic: bool,
    /// Numbers are divided by it before anything else.
    unit: f64,
    low: f64,
    high: f64,
}

impl Axis {
    /// A linear axis over the finite ones of some values, with a share of the range as room at both ends.
    pub fn linear(name: &str, unit: &str, values: impl IntoIterator<Item = f64>, room: f64, most: usize) -> Self {
        let (low, high) = extent(values).unwrap_or((0.0, 1.0));
        let magnitude = low.abs().max(high.abs());
        let power = power_of(magnitude);
        let power = if (-2..5).contains(&power) { 0 } else { power };
        let factor = 10.0_f64.powi(power);
        let (mut low, mut high, magnitude) = (low / factor, high / factor, magnitude / factor);
        if high - low <= MIN_RELATIVE_RANGE * magnitude {
            let half = if magnitude > 0.0 { 0.05 * magnitude } else { 1.0 };
            (low, high) = (low - half, high + half);
        }
        let room = room * (high - low);
        (low, high) = (low - room, high + room);
        let step = nice_step((high - low) / most.max(1) as f64);
        let decimals = (-power_of(step)).max(0) as usize;
        // A tick at an end may be lost by rounding: allowed for by a small part of a step.
        let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
        let tick = |index: i64| {
            let value = index as f64 * step;
            Tick { share: ((value - low) / (high - low)).clamp(0.0, 1.0), label: signed(format!("{value:.decimals$}")) }
        };
        Self {
            title: titled(name, unit, power),
            ticks: (first..=last).map(tick).collect(),
            logarithmic: false,
            unit: factor,
            low,
            high,
        }
    }

    /// A logarithmic axis over the positive finite ones of some values; at least one decade line is seen.
    pub fn logarithmic(name: &str, unit: &str, values: impl IntoIterator<Item = f64>, room: f64, most: usize) -> Self {
        let exponents = values.into_iter().filter(|value| *value > 0.0).map(f64::log10);
        let (low, high) = extent(exponents).unwrap_or((0.0, 1.0));
        let room = room * (high - low).max(0.5);
        let (mut low, mut high) = (low - room, high + room);
        if low.ceil() > high.floor() {
            (low, high) = (low.floor(), high.ceil());
        }
        let (first, last) = (low.ceil() as i32, high.floor() as i32);
        let stride = (last - first) / most.max(1) as i32 + 1;
        let share = |exponent: f64| (exponent - low) / (high - low);
        let decades = (first..=last).filter(|exponent| exponent.rem_euclid(stride) == 0);
        let mut ticks: Vec<Tick> = decades
            .map(|power| Tick {
                share: share(f64::from(power)),
                label: format!("10^{{{}}}", signed(power.to_string())),
            })
            .collect();
        if last - first < 2 {
            // Few decades: their parts are labelled too.
            for power in first - 1..=last {
                for digit in [2, 5] {
                    let place = share(f64::from(power) + f64::from(digit).log10());
                    if (0.0..=1.0).contains(&place) {
                        let label = format!("{digit}·10^{{{}}}", signed(power.to_string()));
                        ticks.push(Tick { share: place, label });
                    }
                }
            }
            ticks.sort_by(|a, b| a.share.total_cmp(&b.share));
        }
        Self { title: titled(name, unit, 0), ticks, logarithmic: true, unit: 1.0, low, high }
    }

    /// Place of a value as a share of the axis; outside 0 … 1 if the value lies outside. None for values without a
    /// place.
    pub fn share(&self, value: f64) -> Option<f64> {
        let position = if self.logarithmic { value.log10() } else { value / self.unit };
        let share = (position - self.low) / (self.high - self.low);
        share.is_finite().then_some(share)
    }

    /// Labels of both ends, in the unit of the ticks.
    pub fn end_labels(&self) -> [String; 2] {
        [self.low, self.high].map(|end| number(if self.logarithmic { 10.0_f64.powf(end) } else { end }))
    }

    /// The values at both ends.
    pub fn ends(&self) -> [f64; 2] {
        let value = |position: f64| if self.logarithmic { 10.0_f64.powf(position) } else { position * self.unit };
        [value(self.low), value(self.high)]
    }
}

/// Smallest and largest of the finite values; none without any.
pub(super) fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}

/// A number with four digits, as figures write it: with the minus sign of print, large and small ones with a power of
/// ten.
///
/// ```
/// assert_eq!([14_809.3, -0.5, 2.1e7].map(figures::number), ["14809", "−0.5", "2.100·10^{7}"]);
/// ```
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return signed(value.to_string());
    }
    let power = power_of(value.abs());
    if (-3..6).contains(&power) {
        let decimals = (3 - power).max(0) as usize;
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return signed(text.to_owned());
    }
    let text = format!("{value:.3e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    signed(format!("{digits}·10^{{{exponent}}}"))
}

/// A space and the unit, as they stand behind a number; nothing without a unit.
pub(super) fn behind(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// The largest of 1, 2, 5 times a power of ten that is not above a number > 0, such as a magnification; rounding of the
/// number is allowed for.
///
/// ```
/// assert_eq!([0.07, 1.0, 1.9, 99.0].map(figures::nice_below), [0.05, 1.0, 1.0, 50.0]);
/// ```
pub fn nice_below(length: f64) -> f64 {
    let power = 10.0_f64.powi(power_of(length));
    let digit = [5.0, 2.0].into_iter().find(|digit| digit * power <= length * (1.0 + 1e-9)).unwrap_or(1.0);
    digit * power
}

/// The smallest of 1, 2, 5 times a power of ten that is not below a length.
fn nice_step(length: f64) -> f64 {
    let power = 10.0_f64.powi(power_of(length));
    [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|step| *step >= length).unwrap_or(length)
}

/// Exponent of the decade of a number ≥ 0; 0 for zero.
fn power_of(magnitude: f64) -> i32 {
    if magnitude <= 0.0 || !magnitude.is_finite() {
        return 0;
    }
    // Powers of ten themselves must not fall into the decade below. Beyond ±300 a power of ten is no ordinary number.
    (magnitude.log10() + 1e-9).floor().clamp(-300.0, 300.0) as i32
}

fn titled(name: &str, unit: &str, power: i32) -> String {
    let factor = if power == 0 { String::new() } else { signed(format!("10^{{{power}}}")) };
    match (factor.is_empty(), unit.is_empty()) {
        (true, true) => name.to_owned(),
        (true, false) => format!("{name} ({unit})"),
        (false, true) => format!("{name} ({factor})"),
        (false, false) => format!("{name} ({factor} {unit})"),
    }
}

/// A number's text with the minus sign of print, and none before zero.
fn signed(text: String) -> String {
    let zero = text.chars().all(|letter| "-0.".contains(letter));
    if zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    #[test]
    fn powers_of_ten_are_taken_out_of_large_and_small_numbers() {
        let axis = Axis::linear("Θ", "MPa^{4}", [1e17, 3.97e18], 0.0, 5);
        assert_eq!((axis.title.as_str(), labels(&axis)), ("Θ (10^{18} MPa^{4})", vec!["1", "2", "3"]));
        let axis = Axis::linear("gap", "mm", [0.0, 2e-12], 0.0, 5);
        assert_eq!(
            (axis.title.as_str(), labels(&axis)),
            ("gap (10^{−12} mm)", vec!["0.0", "0.5", "1.0", "1.5", "2.0"])
        );
        let axis = Axis::linear("p", "MPa", [0.0, 14_809.0], 0.0, 5);
        assert_eq!((axis.title.as_str(), labels(&axis)), ("p (MPa)", vec!["0", "5000", "10000"]));
    }

    #[test]
    fn no_values_one_value_and_numbers_without_end_give_an_axis() {
        let cases = [
            vec![],
            vec![f64::NAN],
            vec![0.0],
            vec![7.0; 3],
            vec![-1e300, 1e300],
            vec![1e18, 1e18 + 1e3],
            vec![5e-324],
        ];
        for values in cases {
            for axis in
                [Axis::linear("", "", values.clone(), 0.04, 5), Axis::logarithmic("", "", values.clone(), 0.04, 5)]
            {
                assert!((1..=12).contains(&axis.ticks.len()), "{values:?}: {axis:?}");
                assert!(axis.ticks.iter().all(|tick| (0.0..=1.0).contains(&tick.share)), "{values:?}: {axis:?}");
                assert!(axis.ticks.windows(2).all(|pair| pair[0].label != pair[1].label), "{values:?}: {axis:?}");
            }
        }
    }

    #[test]
    fn logarithmic_axes_show_decades_and_parts_of_few() {
        assert_eq!(labels(&Axis::logarithmic("", "", [1.0, 1e4], 0.0, 8)).len(), 5);
        assert_eq!(
            labels(&Axis::logarithmic("", "", [2.0, 30.0], 0.0, 8)),
            ["2·10^{0}", "5·10^{0}", "10^{1}", "2·10^{1}"]
        );
        assert!(labels(&Axis::logarithmic("", "", [1e-16, 1e18], 0.0, 8)).len() <= 9);
    }

    #[test]
    fn numbers_have_four_digits() {
        let texts = [14_809.3, 4082.0, 0.012_345, 1.040_3e17, -2e-9, 0.0, 50.0, -0.0].map(number);
        assert_eq!(texts, ["14809", "4082", "0.01235", "1.040·10^{17}", "−2.000·10^{−9}", "0", "50", "0"]);
        assert_eq!([37.0, 100.0, 1e-12, 26.0].map(nice_below), [20.0, 100.0, 1e-12, 20.0]);
    }
}
