//! The numbers that docs/measurements.md begins with are those of today's build.

use std::path::Path;
use studies::headline::{friction_table, optimization_line, state_line};
use studies::scaling::Case;
use testset::kit::rounds_alike;

/// Relative difference allowed for printed values and pressures on processors that round alike.
const VALUES: f64 = 2e-3;
/// Relative difference allowed for printed values on other processors: the runs end stationary, to 1e-7 of Θ.
const VALUES_ELSEWHERE: f64 = 2e-3;
/// Relative difference allowed for peak pressures on other processors: Σσ⁴ determines them less well than Θ.
const PEAKS_ELSEWHERE: f64 = 0.02;
/// Difference allowed for evaluations until a value is reached, for the same reason.
const COUNTS: f64 = 3.0;

/// Relative difference allowed for a number of a table.
fn allowed(number: f64) -> f64 {
    match (rounds_alike(), number > 1e9) {
        (true, _) => VALUES,
        (false, true) => VALUES_ELSEWHERE,
        (false, false) => PEAKS_ELSEWHERE,
    }
}

fn page(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)).unwrap()
}

/// The line of a page that begins so.
fn line<'a>(page: &'a str, start: &str) -> &'a str {
    page.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("no line begins with {start}"))
}

/// The numbers of a line, a space between thousands read over; signs of powers and units are passed by.
fn numbers(line: &str) -> Vec<f64> {
    let (mut text, characters) = (String::new(), line.chars().collect::<Vec<char>>());
    for (at, &character) in characters.iter().enumerate() {
        let digit = |at: Option<usize>| at.and_then(|at| characters.get(at)).is_some_and(char::is_ascii_digit);
        let thousands = character == ' ' && digit(at.checked_sub(1)) && (1..=3).all(|next| digit(Some(at + next)));
        if !thousands {
            text.push(character);
        }
    }
    text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == 'e')).filter_map(|word| word.parse().ok()).collect()
}

/// A line of the page and the line computed now hold the same numbers: counts of evaluations within [`COUNTS`].
fn compare(documented: &str, computed: &str) {
    println!("{documented}\n{computed}");
    let (expected, found) = (numbers(documented), numbers(computed));
    assert_eq!(expected.len(), found.len(), "{documented}\n{computed}");
    for (expected, found) in expected.iter().zip(&found) {
        let count = expected.fract() == 0.0 && *expected < 1000.0;
        let allowed = if count { COUNTS } else { allowed(*expected) * expected };
        // Printed digits round as well.
        assert!(
            (expected - found).abs() <= allowed + 0.1 * f64::from(u8::from(*expected < 100.0)),
            "{expected} {found}"
        );
    }
}

#[test]
fn optimizations_of_both_examples() {
    let measured = page("docs/measurements.md");
    compare(line(&measured, "| Signorini (Example 5.1)"), &optimization_line(0).unwrap());
    compare(line(&measured, "| Hertz (Example 5.2)"), &optimization_line(1).unwrap());
}

#[test]
fn states_of_growing_meshes() {
    let measured = page("docs/measurements.md");
    for (mesh, subdomains) in [(12, 2), (35, 5)] {
        let documented = numbers(line(&measured, &format!("| {mesh}³ / {subdomains}³")));
        let computed = numbers(&state_line(Case { mesh, subdomains }).unwrap());
        // Bricks, subdomains, torn dofs, contact nodes, Θ; then products, which rounding may move by some.
        for index in 0..5 {
            assert!((computed[index] / documented[index] - 1.0).abs() < 1e-9, "{documented:?} {computed:?}");
        }
        for index in 5..7 {
            assert!((computed[index] - documented[index]).abs() <= COUNTS, "{documented:?} {computed:?}");
        }
    }
}

#[test]
fn leaving_friction_out_costs_what_the_page_says() {
    let results = page("docs/measurements.md");
    let (table, loss) = friction_table().unwrap();
    for computed in table.lines().skip(2) {
        let name = computed.split('|').nth(1).unwrap();
        let name = name.trim().replace("start", "start, α ≡ 100");
        let (documented, computed) = (numbers(line(&results, &format!("| {name}"))), numbers(computed));
        let documented = &documented[documented.len() - 4..];
        for (expected, found) in documented.iter().zip(&computed) {
            assert!(
                (found / expected - 1.0).abs() < 5.0 * allowed(*expected),
                "{name}: {found}, documented {expected}"
            );
        }
    }
    assert!((loss - 1.43).abs() < 0.02, "{loss}");
}
