//! The code on the pages: that of README.md stands in this file and runs, that of docs/plug_in_your_problem.md in an
//! example.

use nonsmooth::{BundleTrust, BundleTrustConfig, Convexity, FnObjective, Polyhedron, Vector};

#[test]
fn closure_over_a_box() -> Result<(), Box<dyn std::error::Error>> {
    let theta = FnObjective::new(2, |x: &Vector| {
        let (bowl, plane) = (x.norm_squared(), 4.0 - x[0] - x[1]);
        if bowl > plane { (bowl, x * 2.0) } else { (plane, Vector::from_element(2, -1.0)) }
    });
    let set = Polyhedron::boxed(Vector::zeros(2), Vector::from_element(2, 3.0))?;
    let config = BundleTrustConfig { convexity: Convexity::Convex, ..BundleTrustConfig::default() };
    let report = BundleTrust::new(config)?.constraints(set).minimize(&theta, Vector::zeros(2))?;
    // x = y with 2x² = 4 − 2x: x = 1, Θ = 2.
    assert!((report.value - 2.0).abs() < 1e-6, "{report}");
    assert!(report.termination.is_confirmed(), "{report}");
    Ok(())
}

/// The blocks of Rust on a page.
fn rust_blocks(page: &str) -> Vec<&str> {
    page.split("```rust\n").skip(1).filter_map(|rest| rest.split("\n```").next()).collect()
}

#[test]
fn code_of_the_readme_is_the_code_tested_here() {
    let tested = include_str!("readme_example.rs").replace(' ', "");
    let [block] = rust_blocks(include_str!("../../README.md"))[..] else { panic!("one program") };
    for line in block.lines() {
        let printed_or_imported = line.starts_with("println!") || line.starts_with("use ") || line.starts_with("//");
        assert!(printed_or_imported || tested.contains(&line.replace(' ', "")), "README.md: {line}");
    }
}

#[test]
fn own_problem_of_the_page_is_the_example() {
    let page = include_str!("../../docs/plug_in_your_problem.md");
    let [block] = rust_blocks(page)[..] else { panic!("one program") };
    assert!(include_str!("../../examples/own_problem.rs").contains(block), "differs from the example:\n{block}");
    // The signatures on the page are those of the traits.
    let (source, signature) =
        (include_str!("../../src/problem.rs"), |line: &&str| line.trim_start().starts_with("fn "));
    let plain = |text: &str| text.replace(",\n    )", ")").split_whitespace().collect::<String>();
    let traits = page.split("```text\n").nth(1).and_then(|rest| rest.split("\n```").next()).expect("the traits");
    assert_eq!(traits.lines().filter(signature).count(), 6);
    for line in traits.lines().filter(signature) {
        assert!(plain(source).contains(&plain(line)), "not in src/problem.rs: {line}");
    }
}
