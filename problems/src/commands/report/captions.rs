//! What is to be seen in the figures of a report, in sentences.

pub const PRESSURE: &str = "Contact pressure over the plan of the contact surface; a ring marks the peak. On one scale, equal colours are \
    equal pressures. On scales of their own, small differences can be seen.";

/// The pressure map of a single shape.
pub const PRESSURE_ALONE: &str = "Contact pressure over the plan of the contact surface; a ring marks the peak.";

pub const CUTS: &str = "The same pressures along lines through the peak of each shape.";

pub const STATUS: &str = "Open nodes carry no pressure. Sticking nodes hold by friction, slipping nodes slide against it. Arrows show the \
    friction traction that the slave body exerts on what it touches; all are drawn on one scale.";

pub const STATUS_WITHOUT_FRICTION: &str = "Open nodes carry no pressure, closed ones do.";

pub const SURFACE_MAP: &str = "The contact surface without load, seen along its normal: heights above their mean, or outward displacements \
    by the shape, in mm. The lines join points of equal values; a ring marks the largest one.";

pub const COURSE: &str = "Every mark is an evaluation. Its shape says what became of it, its colour who proposed it. The line is the best \
    value so far. Values worse than the start do not stretch the axis: they stand at the upper edge with an arrow and their value. Where \
    there is a dashed line, no shape that carries the same total force can be below it.";

pub const SPACE: &str = "The skins of the bodies. Drag to turn them; after a click, the wheel zooms; two fingers zoom and shift. The arrow keys, \
    + and − do the same. Click a node for its number in the mesh of its body (from 0 on), its place without load and its values. They are \
    stored in 16 bits: the digits that are shown are true to one unit of the last one.";
