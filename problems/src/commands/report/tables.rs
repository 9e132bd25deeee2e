//! Tables of comma-separated values; the names of columns carry their units.

use crate::commands::numbers::{exact, plain_unit};
use crate::commands::solved_shape::ContactObjective;
use contact::contact_shape::ContactState;
use nonsmooth::Report;

/// One line per contact node: place, pressure and traction, remaining gap (≥ 0 up to accuracy), area and normal, from
/// the body into what it touches, status; where there are several contacts, the number of its contact. The force of
/// the body on what it touches is the sum of area × (pressure × normal + traction).
pub fn contact_nodes(objective: &ContactObjective, controls: &[f64], state: &ContactState) -> String {
    let problem = objective.solver().problem();
    let head = "x1_mm,x2_mm,x3_mm,pressure_MPa,traction_1_MPa,traction_2_MPa,traction_3_MPa,remaining_gap_mm,area_mm2,\
                normal_1,normal_2,normal_3,status\n";
    let several = problem.scene.contacts.len() > 1;
    let mut table = if several { format!("contact,{head}") } else { head.to_owned() };
    let (pressures, positions) = (objective.pressures(state), problem.map.positions(controls));
    for (index, (point, pressure)) in problem.boundary.contact_points().iter().zip(pressures).enumerate() {
        let [x1, x2, x3] = positions[point.body][point.node as usize];
        let (area, [n1, n2, n3]) = (state.rows.nodes[index].area, state.rows.nodes[index].normal.map(|n| n + 0.0));
        let [t1, t2, t3] = state.forces.tangential.get(index).map_or([0.0; 3], |force| force.map(|f| f / area));
        // The jump less the gap is negative where bodies are apart.
        let gap = -state.forces.opening[index];
        let cells = [x1, x2, x3, pressure, t1, t2, t3, gap, area, n1, n2, n3].map(exact).join(",");
        let contact = if several { format!("{},", point.contact + 1) } else { String::new() };
        table += &format!("{contact}{cells},{:?}\n", state.forces.status[index]);
    }
    table
}

/// One line per evaluation of an optimization. The aggregate norm is in the norm of the optimizer, which has no unit in
/// common with Θ.
pub fn history(objective: &ContactObjective, report: &Report) -> String {
    let unit = plain_unit(&objective.unit()).replace(' ', "_");
    let named = ["value", "center_value", "predicted_decrease"].map(|name| format!("{name}_{unit}")).join(",");
    let mut table = format!("evaluation,kind,{named},aggregate_norm,aggregate_error_{unit},seconds\n");
    for record in &report.history {
        let value = record.value.map_or_else(String::new, exact);
        let numbers = [
            record.center_value,
            record.predicted_decrease,
            record.aggregate_norm,
            record.aggregate_error,
            record.seconds,
        ];
        table += &format!("{},{},{value},{}\n", record.evaluation, record.kind, numbers.map(exact).join(","));
    }
    table
}
