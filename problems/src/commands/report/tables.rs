//! Tables of comma-separated values.

use crate::commands::solved_shape::ContactObjective;
use contact::contact_shape::ContactState;
use nonsmooth::Report;

/// One line per contact node: place (mm), pressure and traction (MPa), remaining gap (mm, ≥ 0 up to the accuracy of the state),
/// status.
pub fn contact_nodes(objective: &ContactObjective, state: &ContactState) -> String {
    let problem = objective.solver().problem();
    let mut table = String::from("x1,x2,pressure,traction_1,traction_2,remaining_gap,status\n");
    let pressures = objective.pressures(state);
    for (index, (point, pressure)) in problem.boundary.points.iter().zip(pressures).enumerate() {
        let [x1, x2] = problem.grid.position(point.position[0], point.position[1]);
        let traction = state.forces.tangential.get(index).map_or([0.0; 2], |force| force.map(|f| f / point.area));
        // The jump less the gap is negative where bodies are apart.
        let (gap, status) = (-state.forces.opening[index], state.forces.status[index]);
        table += &format!("{x1},{x2},{pressure},{},{},{gap},{status:?}\n", traction[0], traction[1]);
    }
    table
}

/// One line per evaluation of an optimization.
pub fn history(report: &Report) -> String {
    let mut table =
        String::from("evaluation,kind,value,center_value,predicted_decrease,aggregate_norm,aggregate_error,seconds\n");
    for record in &report.history {
        let value = record.value.map_or_else(String::new, |value| value.to_string());
        table += &format!(
            "{},{},{value},{},{},{},{},{}\n",
            record.evaluation,
            record.kind,
            record.center_value,
            record.predicted_decrease,
            record.aggregate_norm,
            record.aggregate_error,
            record.seconds
        );
    }
    table
}
