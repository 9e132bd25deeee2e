//! Pressure maps as SVG: one square per contact node, darker to brighter, with a scale.

use std::fmt::Write;

/// Width of the map, pixels.
const WIDTH: f64 = 420.0;
/// Colours from no pressure to the largest, sRGB.
const COLOURS: [[f64; 3]; 5] =
    [[20.0, 20.0, 60.0], [70.0, 40.0, 140.0], [190.0, 60.0, 110.0], [245.0, 140.0, 60.0], [250.0, 240.0, 160.0]];

/// A map of the pressures of the nodes (x₁, x₂, pressure) over a base of the given size, on a scale up to `largest`.
pub fn pressure_map(
    title: &str,
    size: [f64; 2],
    counts: [usize; 2],
    nodes: &[(f64, f64, f64)],
    largest: f64,
) -> String {
    field_map(title, "MPa", size, counts, nodes, largest)
}

/// A map of any field that is not negative, with its unit.
pub fn field_map(
    title: &str,
    unit: &str,
    size: [f64; 2],
    counts: [usize; 2],
    nodes: &[(f64, f64, f64)],
    largest: f64,
) -> String {
    let decimals =
        if largest >= 100.0 { 0 } else { (3.0 - largest.max(1e-12).log10().ceil()).clamp(0.0, 9.0) as usize };
    let scale = WIDTH / size[0];
    let height = size[1] * scale;
    let (dx, dy) = (WIDTH / (counts[0] - 1) as f64, height / (counts[1] - 1) as f64);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0}\" height=\"{:.0}\" font-family=\"sans-serif\" \
         font-size=\"13\">\n<text x=\"20\" y=\"22\">{title}</text>\n<svg x=\"20\" y=\"34\" width=\"{WIDTH:.0}\" \
         height=\"{height:.0}\">\n",
        WIDTH + 130.0,
        height + 70.0
    );
    for &(x, y, pressure) in nodes {
        let colour = colour(if largest > 0.0 { pressure / largest } else { 0.0 });
        let (left, top) = (x * scale - dx / 2.0, height - y * scale - dy / 2.0);
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{dx:.2}\" height=\"{dy:.2}\" fill=\"{colour}\"/>"
        );
    }
    svg += "</svg>\n";
    for step in 0..=10 {
        let share = f64::from(step) / 10.0;
        let top = 34.0 + (1.0 - share) * (height - 20.0);
        let _ = writeln!(
            svg,
            "<rect x=\"{:.0}\" y=\"{top:.1}\" width=\"18\" height=\"{:.1}\" fill=\"{}\"/>\
             <text x=\"{:.0}\" y=\"{:.1}\">{:.decimals$}</text>",
            WIDTH + 32.0,
            (height - 20.0) / 10.0 + 1.0,
            colour(share),
            WIDTH + 56.0,
            top + 12.0,
            share * largest
        );
    }
    let _ =
        writeln!(svg, "<text x=\"20\" y=\"{:.0}\">x1 to the right, x2 upwards; {unit}</text>\n</svg>", height + 56.0);
    svg
}

/// Colour of a share of the scale.
fn colour(share: f64) -> String {
    let position = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let index = (position as usize).min(COLOURS.len() - 2);
    let rest = position - index as f64;
    let [r, g, b] =
        std::array::from_fn(|i| (COLOURS[index][i] + rest * (COLOURS[index + 1][i] - COLOURS[index][i])).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_has_a_square_and_the_scale_ends_at_the_largest_pressure() {
        let nodes = [(0.0, 0.0, 1.0), (0.0, 2.0, 2.0), (3.0, 0.0, 3.0), (3.0, 2.0, 4000.0)];
        let svg = pressure_map("p", [3.0, 2.0], [2, 2], &nodes, 4000.0);
        assert_eq!(svg.matches("<rect").count(), 4 + 11);
        assert!(svg.contains(">4000<") && svg.contains("#faf0a0") && svg.trim_end().ends_with("</svg>"));
    }
}
