//! Formulas: precedence, refusals with their places, nesting.

use contact::error::SceneError;
use contact::formula::Formula;

fn parse(text: &str) -> Result<Formula, SceneError> {
    Formula::parse("f", text)
}

fn value(text: &str) -> f64 {
    parse(text).unwrap_or_else(|error| panic!("{text}: {error}")).value([2.0, 3.0, 5.0])
}

#[test]
fn precedence_is_that_of_mathematics() {
    for (text, expected) in [
        ("2^3^2", 512.0),
        ("(2^3)^2", 64.0),
        ("-x1^2", -4.0),
        ("2^-1", 0.5),
        ("2*-x1", -4.0),
        ("x1 - -x2^2", 11.0),
        ("--x1", 2.0),
        ("2^-x1^2", 0.0625),
        ("8/2/2", 2.0),
        ("8/2*x1", 8.0),
        ("1 - 2 - 3", -4.0),
        ("2 + 3*x2^2", 29.0),
        (".5 + 1. + 2.5e-3 + 1E+1", 11.5025),
        ("max(x1, min(7, x2)) + abs(-1)", 4.0),
        ("sin (PI/2) + log10(100) + exp(0)", 4.0),
        ("round(2.5) + ceil(0.2) + floor(-0.2)", 3.0),
    ] {
        let found = value(text);
        assert!((found - expected).abs() < 1e-12, "{text}: {found}");
    }
    assert!(value("max(sqrt(x1 - x2), 0)").is_nan() && value("min(0, ln(-1))").is_nan());
}

#[test]
fn everything_else_is_refused_with_its_place() {
    for (text, found, allowed) in [
        ("", "the end", "a number, x1, x2, x3"),
        ("sin x1", "\"x1\" at character 5", "a parenthesis after sin"),
        ("sin", "the end", "a parenthesis after sin"),
        ("2 x1", "\"x1\" at character 3", "an operator"),
        ("2x1", "\"x1\" at character 2", "an operator"),
        ("x1(2)", "\"(\" at character 3", "an operator"),
        ("(x1", "the end", "an operator (+ - * / ^) or )"),
        ("x1)", "\")\" at character 3", "an operator"),
        ("max(1)", "\")\" at character 6", "a second argument of max"),
        ("sin(1, 2)", "\",\" at character 6", "the ) of sin"),
        ("x1 + * 2", "\"*\" at character 6", "a number, x1, x2, x3"),
        ("3 + height", "\"height\" at character 5", "the names x1, x2, x3, PI and the functions abs"),
        ("pi", "\"pi\" at character 1", "PI"),
        ("1..2", "\".\" at character 3", "an operator"),
        (".", "\".\" at character 1", "a number such as"),
        ("2e*3", "\"e\" at character 2", "an operator"),
        ("2 − x1", "\"−\" at character 3", "an operator"),
        ("é", "\"é\" at character 1", "the names"),
    ] {
        let refusal = parse(text).expect_err(text).to_string();
        let (before, after) = refusal.split_once(" is not allowed; allowed: ").expect("both");
        assert!(before == format!("f = {found}") && after.contains(allowed), "{text}: {refusal}");
    }
    let long = parse(&"x1+".repeat(400)).expect_err("too long").to_string();
    assert!(long.contains("at most 1000"), "{long}");
}

#[test]
fn deep_nesting_is_refused_before_the_stack_ends() {
    for text in ["(".repeat(999), "-".repeat(999), "sin(".repeat(249), "2^".repeat(499), "max(1,".repeat(166)] {
        assert!(parse(&text).expect_err(&text).to_string().contains("inside each other"), "{text}");
    }
    assert!((value(&("(".repeat(99) + "x1" + &")".repeat(99))) - 2.0).abs() < 1e-15);
    assert!((value(&("1+".repeat(499) + "1")) - 500.0).abs() < 1e-12);
}
