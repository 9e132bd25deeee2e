//! Fields of solved shapes: two independent solvers agree, forces are in equilibrium through every section, boundary
//! values are those of the contact law.

use crate::common::{bent, length, unit};
use contact::body::Body;
use contact::body::elasticity::stress::{COMPONENTS, stress_at};
use contact::body::elasticity::{CellNodes, Formulation, hex8};
use contact::contact_shape::{ContactShape, ContactState, SolverKind};
use contact::cost::{NodeWeight, PressureCost, PressureMeasure};
use contact::equilibrium::{ContactStatus, TangentsOf};
use contact::error::ContactError;
use contact::fields::{BodyFields, Fields};
use contact::scene::{Scene, hertz, signorini};
use nonsmooth::composite::OuterFunction;
use nonsmooth::{Accuracy, OutputJacobian, StateSolver, Vector};
use testset::kit::relative_difference;

/// Bricks of a body along every axis.
const BRICKS: usize = 6;

fn solve(scene: Scene, kind: SolverKind, control: Option<Vector>) -> (ContactShape, ContactState, Vector) {
    let shape = ContactShape::new(scene.with_bricks([BRICKS; 3], [2, 3, 2]), kind).unwrap();
    let control = control.unwrap_or_else(|| shape.start());
    let state = shape.solve(&control, None, Accuracy::TIGHTEST).unwrap();
    (shape, state, control)
}

/// Both examples, with and without friction and in both formulations of the bricks.
fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        for (friction, formulation) in
            [(0.3, Formulation::Standard), (0.0, Formulation::Standard), (0.3, Formulation::MeanDilatation)]
        {
            let mut scene = scene.clone().with_friction(friction);
            for body in &mut scene.bodies {
                body.material = body.material.with_formulation(formulation);
            }
            scenes.push(scene);
        }
    }
    scenes
}

#[test]
fn both_solvers_give_the_same_fields() {
    for scene in scenes() {
        let control = bent(&scene);
        let label = format!("{} friction {}", scene.name, scene.friction());
        let (torn, direct) = [SolverKind::Newton, SolverKind::Direct]
            .map(|kind| {
                let (shape, state, _) = solve(scene.clone(), kind, Some(control.clone()));
                shape.fields(&state).unwrap()
            })
            .into();
        let bodies = if scene.bodies.len() > 1 { 2 } else { 1 };
        assert_eq!((torn.bodies.len(), direct.bodies.len()), (bodies, bodies));
        for (body, (first, second)) in torn.bodies.iter().zip(&direct.bodies).enumerate() {
            let displacement =
                relative_difference(first.displacement.as_flattened(), second.displacement.as_flattened());
            let stress = relative_difference(first.stress.as_flattened(), second.stress.as_flattened());
            let nodal = relative_difference(&first.nodal_von_mises, &second.nodal_von_mises);
            let size = first.displacement.as_flattened().iter().fold(0.0, |size: f64, u| size.max(u.abs()));
            let defect = first.gluing_defect / size;
            println!(
                "{label}, body {}: displacement {displacement:.1e}, stress {stress:.1e}, von Mises {nodal:.1e}, \
                 gluing defect {defect:.1e}",
                body + 1
            );
            // Both states are solved to relative residuals near 1e-12; measured differences are at most 6e-13.
            assert!(displacement < 1e-10 && stress < 1e-10 && nodal < 1e-10, "{label}");
            assert!(defect < 1e-10 && second.gluing_defect == 0.0, "{label}: {defect:.1e}");
            assert_eq!((&first.mesh, &first.positions), (&second.mesh, &second.positions));
            let mut numbers = first.subdomain.clone();
            numbers.sort_unstable();
            numbers.dedup();
            assert_eq!(numbers, (12 * body..12 * (body + 1)).collect::<Vec<_>>());
            assert!(second.subdomain.iter().all(|&number| number == body));
        }
        let contact = [&torn.contact, &direct.contact];
        assert!(relative_difference(&contact[0].pressure, &contact[1].pressure) < 1e-10);
        assert!(relative_difference(&contact[0].remaining_gap, &contact[1].remaining_gap) < 1e-9);
        assert_eq!(contact[0].status, contact[1].status);
        assert_eq!(contact[0].traction.is_some(), scene.friction() > 0.0);
        assert_eq!(contact[0].slip.is_some(), scene.friction() > 0.0);
    }
}

/// The bricks of a layer, which are numbered upwards column by column.
fn layer_of(fields: &BodyFields, layer: usize) -> impl Iterator<Item = usize> + use<> {
    (0..fields.mesh.cell_count()).filter(move |cell| cell % BRICKS == layer)
}

/// Force that the bricks of a layer of a body pass upwards: ∫ σ ∇φ dV with φ rising from 0 to 1 through the layer.
fn section_force(fields: &BodyFields, body: &Body, layer: usize) -> [f64; 3] {
    let mut force = [0.0; 3];
    for cell in layer_of(fields, layer) {
        let CellNodes::Hex8(nodes) = fields.mesh.cell_nodes(cell, &fields.positions) else { panic!("bricks alone") };
        let (points, u) = (hex8::gauss_points(&nodes), fields.mesh.cell_values(cell, &fields.displacement));
        for point in &points {
            let stress = stress_at(point, &points, body.solid.material(cell), &u);
            let mut full = [[0.0; 3]; 3];
            for (value, (row, column)) in stress.iter().zip(COMPONENTS) {
                (full[row][column], full[column][row]) = (*value, *value);
            }
            for (component, force) in force.iter_mut().enumerate() {
                // The last four corners are those of the upper face.
                for corner in 4..8 {
                    let along: f64 = (0..3).map(|j| full[component][j] * point.gradients[corner][j]).sum();
                    *force += point.volume * along;
                }
            }
        }
    }
    force
}

#[test]
fn every_layer_passes_on_what_acts_beyond_it() {
    for scene in scenes() {
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let (shape, state, _) = solve(scene.clone(), kind, Some(bent(&scene)));
            let (fields, bodies) = (shape.fields(&state).unwrap(), &shape.problem().bodies);
            let contact: f64 = fields.contact.pressure.iter().zip(&fields.contact.area).map(|(p, a)| p * a).sum();
            assert!((contact / state.forces.total_normal_force() - 1.0).abs() < 1e-14);
            // Nothing else acts along e₃ between the bottom of the lower body and the contact boundary.
            for layer in 0..6 {
                let force = section_force(&fields.bodies[0], &bodies[0], layer)[2];
                assert!((force / -contact - 1.0).abs() < 1e-9, "{kind:?} layer {layer}: {force} {contact}");
            }
            if scene.bodies.len() == 1 {
                // 3000 MPa on 100 mm × 100 mm.
                assert!((contact / 3e7 - 1.0).abs() < 1e-9, "{contact}");
                continue;
            }
            let grid = shape.problem().scene.bodies[0].block().unwrap().grid();
            let height = |j: usize, k: usize| fields.bodies[1].positions[grid.node([BRICKS, j, k])][2];
            // −2000 MPa on the top of 10 mm × 10 mm and on the share of the side above the layer.
            for layer in 0..6 {
                let side: f64 = (0..6)
                    .map(|j| {
                        let area = |k: usize| {
                            (height(j, k + 1) - height(j, k) + height(j + 1, k + 1) - height(j + 1, k)) / 2.0
                                * (10.0 / 6.0)
                        };
                        (layer + 1..6).map(area).sum::<f64>() + half_moment(&height, j, layer)
                    })
                    .sum();
                let expected = -2000.0 * (100.0 + side);
                let force = section_force(&fields.bodies[1], &bodies[1], layer)[2];
                assert!((force / expected - 1.0).abs() < 1e-9, "{kind:?} upper layer {layer}: {force} {expected}");
            }
        }
    }
}

/// ∫ φ dA over one side face of the layer, φ rising from 0 at its lower to 1 at its upper edge; edges are straight and
/// the height is linear along the face, so that φ is ½ on average at every place along it.
fn half_moment(height: &impl Fn(usize, usize) -> f64, j: usize, layer: usize) -> f64 {
    let edge = |j: usize| height(j, layer + 1) - height(j, layer);
    0.5 * (edge(j) + edge(j + 1)) / 2.0 * (10.0 / 6.0)
}

#[test]
fn mean_vertical_stress_of_a_flat_layer_is_the_load_over_the_area() {
    // Bricks of the flat start are boxes: the stress is trilinear at most and its mean is the value at the centre.
    for formulation in [Formulation::Standard, Formulation::MeanDilatation] {
        let mut scene = signorini().unwrap();
        scene.bodies[0].material = scene.bodies[0].material.with_formulation(formulation);
        for kind in [SolverKind::Newton, SolverKind::Direct] {
            let (shape, state, _) = solve(scene.clone(), kind, None);
            let fields = shape.fields(&state).unwrap();
            let body = &fields.bodies[0];
            for layer in 0..6 {
                let (sum, volume) = layer_of(body, layer).fold((0.0, 0.0), |(sum, total), cell| {
                    let volume = body.mesh.cell_nodes(cell, &body.positions).volume();
                    (sum + volume * body.stress[cell][2], total + volume)
                });
                assert!((sum / volume + 3000.0).abs() < 3000.0 * 1e-9, "{formulation:?} {kind:?}: {}", sum / volume);
            }
        }
    }
}

#[test]
fn contact_fields_obey_the_contact_law() {
    for scene in [signorini().unwrap(), hertz().unwrap()] {
        let (shape, state, control) = solve(scene.clone(), SolverKind::Newton, Some(bent(&scene)));
        let (problem, friction) = (shape.problem(), scene.friction());
        let Fields { bodies, contact } = shape.fields(&state).unwrap();
        let largest = contact.pressure.iter().copied().fold(0.0, f64::max);
        let (traction, slip) = (contact.traction.as_ref().unwrap(), contact.slip.as_ref().unwrap());
        let positions = problem.positions(control.as_slice()).unwrap();
        let mut seen = std::collections::HashSet::new();
        for (node, status) in contact.status.iter().enumerate() {
            seen.insert(*status);
            let (pressure, tangential) = (contact.pressure[node], length(traction[node]));
            assert!(pressure >= 0.0 && tangential <= friction * pressure * (1.0 + 1e-12));
            assert_eq!(contact.position[node], positions[0][contact.nodes[node] as usize]);
            match status {
                ContactStatus::Open => assert!(pressure == 0.0 && contact.remaining_gap[node] > 0.0),
                ContactStatus::Stick => assert!(length(slip[node]) < 1e-8),
                ContactStatus::Slip => assert!(tangential > 0.99 * friction * pressure),
            }
            // The gap that is left is the distance of the deformed surfaces along e₃ (the contact normal of the model).
            let above = if let Some(upper) = bodies.get(1) {
                let sides = problem.boundary.points[node].sides.iter().zip(&state.rows.nodes[node].weights).skip(1);
                let place = |index: usize| upper.positions[index][2] + upper.displacement[index][2];
                sides.map(|(side, weight)| -weight * place(side.node as usize)).sum()
            } else {
                contact.position[node][2] + contact.gap[node]
            };
            let deformed = contact.position[node][2] + contact.displacement[node][2];
            assert!((above - deformed - contact.remaining_gap[node]).abs() < 1e-9, "{node}");
            assert!(contact.remaining_gap[node] > -1e-9 && largest > 0.0);
        }
        assert_eq!(contact.status.len(), (BRICKS + 1) * (BRICKS + 1));
        assert_eq!((contact.facets.facets.len(), bodies[0].mesh.cell_count()), (BRICKS * BRICKS, BRICKS.pow(3)));
        assert!(seen.len() >= 2, "{seen:?}");
    }
}

#[test]
fn position_sensitivities_are_what_the_subgradient_is_made_of() {
    for kind in [SolverKind::Newton, SolverKind::Direct] {
        let scene = hertz().unwrap();
        let (shape, state, control) = solve(scene.clone(), kind, Some(bent(&scene)));
        let measure = PressureMeasure::Norm { exponent: 4.0, weight: NodeWeight::Nodes };
        let cost = PressureCost::new(measure, shape.problem()).unwrap();
        let gradient = shape.output_dual(&control, &state, &cost.subgradient(&shape.outputs(&state)));
        // Areas are those of the projected grid.
        assert_eq!(gradient.control.amax(), 0.0);
        let (positions, _) = shape.position_sensitivity(&state, &gradient.state).unwrap();
        let (subgradient, _) = shape.pull_back(&control, &state, &gradient.state).unwrap();
        // Along changes of the controls: Σ over nodes of ∂J/∂x · x′.
        let along = |change: Vec<f64>| -> f64 {
            let changes = [change];
            let velocities = shape.problem().map.velocities(&changes);
            let node = |body: usize, (node, sensitivity): (usize, &[f64; 3])| {
                let velocity = velocities.at(body, node as u32, 0);
                (0..3).map(|axis| velocity[axis] * sensitivity[axis]).sum::<f64>()
            };
            let nodes = |body: usize| positions[shape.problem().map.nodes(body)].iter().enumerate();
            [0, 1].map(|body| nodes(body).map(|own| node(body, own)).sum::<f64>()).into_iter().sum()
        };
        let size = subgradient.amax();
        for index in [0, 7, 20, 35] {
            let sum = along(unit(36, index));
            assert!((sum - subgradient[index]).abs() < 1e-12 * size, "{sum} {}", subgradient[index]);
        }
        // And along the controls against a difference quotient of J.
        let direction = Vector::from_fn(36, |index, _| (0.9 * index as f64).cos());
        let value = |step: f64| {
            let moved = &control + step * &direction;
            cost.value(&shape.outputs(&shape.solve(&moved, None, Accuracy::TIGHTEST).unwrap()))
        };
        let quotient = (value(1e-5) - value(-1e-5)) / 2e-5;
        let predicted = along(direction.as_slice().to_vec());
        println!("{kind:?}: derivative {predicted:.6e}, difference quotient {quotient:.6e}");
        // Central differences of a step 1e-5: relative error of the order of 1e-6.
        assert!((predicted / quotient - 1.0).abs() < 1e-4, "{predicted} {quotient}");
    }
}

#[test]
fn states_of_other_solvers_and_meshes_are_refused() {
    let (torn, torn_state, _) = solve(signorini().unwrap(), SolverKind::Newton, None);
    let (direct, direct_state, _) = solve(signorini().unwrap(), SolverKind::Direct, None);
    let message = |result: Result<Fields, nonsmooth::OracleError>| result.unwrap_err().to_string();
    assert!(message(torn.fields(&direct_state)).contains("another kind of contact solver"));
    assert!(message(direct.fields(&torn_state)).contains("another kind of contact solver"));
    for (kind, state) in [(SolverKind::Newton, &torn_state), (SolverKind::Direct, &direct_state)] {
        let other = ContactShape::new(signorini().unwrap().with_bricks([4; 3], [2; 3]), kind).unwrap();
        let text = message(other.fields(state));
        assert!(text.contains("another mesh"), "{text}");
        let (solver, state) = (other.contact_solver(), &state.solution);
        let (dual, change) = (vec![1.0; other.problem().boundary.row_count], vec![1.0; 36]);
        let mut refusals = vec![
            solver.sensitivities(state, &dual, 1e-8).map(|_| ()),
            solver.tangents(state, &[change], TangentsOf::Contact, 1e-8).map(|_| ()),
            solver.diagnose(state).map(|_| ()),
            solver.estimate_contraction(state, 10).map(|_| ()),
            solver.bodies(state).map(|_| ()),
        ];
        // Total FETI has nothing to lose there, whatever the state.
        if kind == SolverKind::Direct {
            refusals.push(solver.force_rounding(state).map(|_| ()));
        }
        for refusal in refusals {
            let error = refusal.unwrap_err();
            assert!(matches!(error, ContactError::ForeignState { .. }), "{error}");
        }
        let state = other.solve(&other.start(), None, Accuracy::TIGHTEST).unwrap();
        let error = solver.tangents(&state.solution, &[vec![1.0; 35]], TangentsOf::Contact, 1e-8).unwrap_err();
        assert!(matches!(error, ContactError::ForeignState { expected: 36, found: 35, .. }), "{error}");
    }
}
