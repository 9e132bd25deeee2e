"""Contact scenes from Python give the numbers of the binaries."""

import copy
import json
import multiprocessing
import os
import subprocess
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import nonsmooth
from conftest import Interrupt, same_bits

contact = pytest.importorskip("nonsmooth.contact", reason="built without the feature contact")

SCENES = Path(__file__).parents[2] / "problems" / "scenes"
SMALL = {"body[0].block.bricks": [4, 4, 4], "body[0].block.subdomains": [2, 2, 2]}
BOTH_SMALL = {path.replace("0", str(body)): value for path, value in SMALL.items() for body in (0, 1)}


@pytest.fixture(scope="module")
def signorini():
    return contact.Scene.from_toml(SCENES / "signorini.toml")


def test_the_state_at_the_start_is_that_of_the_method_page(signorini):
    state = signorini.evaluate()
    # docs/verification.md: independent implementations agree on these digits.
    assert abs(state.theta / 4.4456794708e17 - 1) < 1e-10
    counts = [(state.status == kind).sum() for kind in (contact.OPEN, contact.STICK, contact.SLIP)]
    assert counts == [96, 32, 41]
    assert abs(state.total_force / 3e7 - 1) < 1e-9
    assert state.pressures.shape == (13, 13) and state.gradient.shape == (6, 6)
    assert (state.pressures[state.status == contact.OPEN] == 0).all()
    assert abs((np.maximum(state.pressures, 0) ** 4).sum() / state.theta - 1) < 1e-12
    assert state.unit == "MPa⁴" and state.root == 1


def test_the_gradient_passes_the_taylor_test():
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    x = scene.start + 0.3 * np.cos(np.arange(36)).reshape(6, 6)
    assert nonsmooth.taylor_test(scene.fun, x.ravel(), disp=False).right


def test_one_run_is_that_of_the_readme():
    told = []
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", optimizer={"single": True})
    result = scene.optimize(callback=told.append)
    # README.md: 14 evaluations, confirmed.
    assert result.success and result.nfev == 14 == len(told) and len(result.runs) == 1
    assert abs(result.fun / 1.4770e16 - 1) < 1e-4
    assert result.recheck().agrees
    assert abs(scene.evaluate(result.x.reshape(6, 6)).theta / result.fun - 1) < 1e-9


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        # Attempts, a run from the best of them, fairness.
        ("signorini.toml", {**SMALL, "optimizer.starts": 2}),
        ("jack_seat.toml", {**BOTH_SMALL, "optimizer.max_evaluations": 8}),
        ("signorini.toml", {"optimizer.continuation": [2, 4], "optimizer.max_evaluations": 5}),
        ("lug_hex8.toml", {"optimizer.continuation": ["lug_hex8.msh", "lug_tet10.msh"], "optimizer.max_evaluations": 3}),
    ],
)
def test_optimize_finds_the_controls_of_the_program(contact3d, tmp_path, name, fields):
    scene = contact.Scene.from_toml(SCENES / name, **fields)
    seen = []
    result = scene.optimize(journal=tmp_path, callback=lambda intermediate_result: seen.append(intermediate_result.x))
    changes = [f"--set={path}={json.dumps(value)}" for path, value in fields.items()]
    printed = subprocess.run([contact3d, SCENES / name, *changes, "--json"], capture_output=True, check=False)
    assert printed.returncode in (0, 1), printed.stderr
    report = json.loads(printed.stdout)
    assert same_bits(result.x, np.ravel(report["controls"]))
    assert same_bits(result.fun, report["objective"]) and result.message.startswith(report["termination"]["text"])
    counts = [(stage["run"], stage["evaluations"]) for stage in report["stages"]]
    assert [(run["run"], run["nfev"]) for run in result.runs] == counts and len(counts) > 1
    assert len(seen) == result.nfev == sum(count for _, count in counts)
    # The callback of a run in a coarse net has all controls.
    assert all(x.shape == result.x.shape for x in seen)
    assert same_bits(scene.optimize(resume=tmp_path).x, result.x)


def test_a_callback_ends_all_runs():
    told = []

    def stop(x):
        told.append(x)
        if len(told) == 3:
            raise StopIteration

    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    result = scene.optimize(callback=stop)
    assert result.reason == "stopped" and result.nfev == len(told) == 3 and len(result.runs) == 1
    assert scene.optimize(options={"max_seconds": 1e-6}).reason == "time_limit"


@pytest.mark.parametrize(
    ("objective", "unit"),
    [
        ({"quantity": "compliance"}, "N mm"),
        ({"quantity": "stress-norm"}, "MPa"),
        ({"quantity": "pressure-deviation", "wanted": {"form": "formula", "pressure": "3000"}}, "MPa²"),
    ],
)
def test_other_objectives_have_derivatives_and_optima(objective, unit):
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, objective=objective)
    start = scene.evaluate()
    assert start.unit == unit and start.root == 1
    assert nonsmooth.taylor_test(scene.fun, scene.start.ravel(), disp=False).right
    result = scene.optimize(options={"max_evaluations": 10})
    assert result.fun < 0.9 * start.theta


def test_the_same_scene_for_minimize_and_by_keywords():
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, friction=0.0)
    assert "friction = 0.0" in scene.to_toml()
    bounds, rows = scene.constraints
    result = nonsmooth.minimize(
        scene.fun, scene.start.ravel(), bounds=bounds, constraints=rows, options={"max_evaluations": 10}
    )
    assert result.fun < scene.evaluate().theta and result.largest_violation < 1e-9


def test_a_scene_weighs_nodes_by_their_area_unless_it_says_nodes(signorini):
    nodes = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    area = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, objective={"weight": "area"})
    first, second = nodes.evaluate(), area.evaluate()
    assert (first.unit, second.unit) == ("MPa⁴", "MPa⁴·mm²")
    cells = np.full((5, 5), 625.0)
    for edge in (cells[0], cells[-1], cells[:, 0], cells[:, -1]):
        edge /= 2
    assert abs((cells * np.maximum(second.pressures, 0) ** 4).sum() / second.theta - 1) < 1e-12
    assert abs(first.theta**0.25 / first.norm_in_mpa - 1) < 1e-12
    assert abs((second.theta / 1e4) ** 0.25 / second.norm_in_mpa - 1) < 1e-12
    with pytest.raises(ValueError, match="objective.weight = nodes.*pressure-norm"):
        contact.Scene.from_toml(SCENES / "signorini.toml", objective={"quantity": "compliance", "weight": "nodes"})


def test_reports_have_labels_cases_and_units():
    reports = [
        {"quantity": "contact-force", "axis": "x3"},
        {"quantity": "reaction", "region": {"face": "x1-min"}, "label": "left support"},
    ]
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, report=reports)
    state = scene.evaluate()
    force, support = state.reports
    assert (force["quantity"], force["label"], force["case"], force["unit"]) == ("contact-force", None, None, "N")
    assert abs(force["value"] / -state.total_force - 1) < 1e-9
    assert support["label"] == "left support" and np.isfinite(support["value"])


def codes(found):
    return {warning.split(":")[0] for warning in found.warnings}


def test_results_have_the_warnings_of_the_commands():
    # docs/warnings.md names the first two.
    state = contact.Scene.from_toml(SCENES / "signorini.toml").evaluate()
    assert {"large-displacement", "large-strain"} <= codes(state)
    body = {
        "material": {"young_modulus": 2.1e5, "poisson_ratio": 0.4999},
        "supports": [{"face": "bottom", "held": ["u1", "u2", "u3"]}],
        "loads": [{"face": "x1-max", "traction": [0.0, 0.0, -1.0]}],
        "block": {"size": [20.0, 20.0], "bricks": [4, 4, 4]},
        "lattice": {
            "heights": "top", "start": {"form": "plane", "height": 20.0},
            "thickness": 15.0, "slope": 1.0, "volume": [1000.0, 9000.0],
        },
    }
    scene = contact.Scene(
        name="never touches", friction=0.3, body=[body],
        contact=[{"slave": {"face": "top"}, "obstacle": {"form": "plane", "height": 21.0}}],
    )
    assert codes(scene.evaluate()) == {"no-contact", "volume-locking"}
    assert codes(scene.optimize()) == {"no-contact", "volume-locking", "flat-objective", "plateau"}


def test_heights_that_the_commands_refuse_are_refused(signorini):
    for change, words in [(5.0, "control"), (-60.0, "control")]:
        heights = signorini.start + change
        for call in (signorini.evaluate, signorini.fun):
            with pytest.raises(nonsmooth.OutsideDomain, match=f"admissible set: .*{words}"):
                call(heights)


def test_a_shape_without_a_solution_is_outside_the_domain():
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    # The surface lies below the base: elements are inverted.
    with pytest.raises(nonsmooth.OutsideDomain):
        scene.fun(np.full(36, -1.0))


def test_a_run_is_resumed(tmp_path):
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    whole = scene.optimize()
    scene.optimize(journal=tmp_path, options={"max_evaluations": 3})
    with pytest.raises(FileExistsError, match="resume="):
        scene.optimize(journal=tmp_path)
    with pytest.raises(FileNotFoundError, match="journal="):
        scene.optimize(resume=tmp_path / "elsewhere")
    with pytest.raises(ValueError, match="began at another x0"):
        scene.optimize(start=scene.start + 1e-3, resume=tmp_path)
    assert same_bits(scene.optimize(resume=tmp_path).x, whole.x)


@pytest.mark.parametrize(
    "fields, words",
    [
        ({"frictio": 0.3}, "friction"),
        ({"friction": -0.3}, "friction = -0.3 is not allowed"),
        ({"body[0].block.bricks": [0, 4, 4]}, r"body\[0\].block.bricks\[0\] = 0"),
        ({"friction": np.nan}, "friction = nan is not allowed"),
        ({"body[0].lattice.start.height": float("inf")}, r"body\[0\].lattice.start.height = inf"),
        ({"body[2].name": "third"}, "without gap"),
    ],
)
def test_bad_fields_are_named(fields, words):
    with pytest.raises(ValueError, match=words):
        contact.Scene.from_toml(SCENES / "signorini.toml", **fields)


def test_bad_shapes_and_missing_files_are_refused(signorini):
    with pytest.raises(FileNotFoundError, match="nowhere.toml"):
        contact.Scene.from_toml("nowhere.toml")
    with pytest.raises(ValueError, match="friction is missing"):
        contact.Scene.from_toml(SCENES / "signorini.toml", friction=None)
    with pytest.raises(TypeError, match="objective.weight is NoneType.*leave out"):
        contact.Scene.from_toml(SCENES / "signorini.toml", objective={"weight": None})
    with pytest.raises(ValueError, match=r"signorini.toml: there is no field `frictio`") as caught:
        contact.Scene.from_toml(SCENES / "signorini.toml", frictio=0.3)
    assert str(caught.value).count("signorini.toml") == 1
    with pytest.raises(ValueError, match=r"heights has shape \(9, 4\), expected \(6, 6\)"):
        signorini.evaluate(np.full((9, 4), 100.0))
    with pytest.raises(TypeError, match="heights is .* expected real numbers"):
        signorini.evaluate(signorini.start + 0j)
    with pytest.raises(ValueError, match="heights has 3 entries, expected 36"):
        signorini.evaluate([1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="admissible|outside|violat"):
        signorini.optimize(start=np.full(36, 10.0))


def theta_there(scene, heights, answers):
    answers.put(scene.evaluate(heights).theta)


def test_an_interrupt_ends_a_state(interruptible):
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **{"body[0].block.bricks": [16, 16, 16]})
    whole = scene.evaluate().theta
    interrupt = Interrupt(0.3)
    end = time.perf_counter() + 10
    with pytest.raises(KeyboardInterrupt):
        while time.perf_counter() < end:
            scene.evaluate()
    # Half a second of two processors.
    assert interrupt.age() < 1
    assert scene.evaluate().theta == whole
    interrupts = []
    with pytest.raises(KeyboardInterrupt) as caught:
        scene.optimize(callback=lambda x: interrupts.append(Interrupt(0.2) if not interrupts else None))
    assert interrupts[0].age() < 1
    # The signal may come between the end of an evaluation and its callback.
    assert caught.value.best.fun <= whole and caught.value.best.nfev - len(interrupts) in (0, 1)


def test_scenes_go_to_other_processes():
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, friction=0.1)
    assert copy.deepcopy(scene).to_toml() == scene.to_toml()
    spawned = multiprocessing.get_context("spawn")
    answers = spawned.Queue()
    process = spawned.Process(target=theta_there, args=(scene, scene.start, answers))
    process.start()
    assert answers.get(timeout=60) == scene.evaluate().theta
    process.join()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_says_that_it_cannot_solve():
    """The threads of the solver are not there: without a word, it would wait for them without end."""
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    scene.evaluate()
    with warnings.catch_warnings():
        # Newer versions of Python warn of a fork beside threads.
        warnings.simplefilter("ignore")
        child = os.fork()
    if child == 0:
        try:
            scene.evaluate()
        except RuntimeError as error:
            os._exit(7 if "spawn" in str(error) else 1)
        os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7


def test_the_worst_of_some_cases_is_the_objective():
    cases = [{"name": "a"}, {"name": "b", "load_factor": 1.2, "weight": 0.4}, {"name": "c", "friction": 0.0}]
    limits = [{"quantity": "peak-pressure", "at_most": 5000.0, "case": "b"}, {"quantity": "stress", "at_most": 4000.0}]
    scene = contact.Scene.from_toml(SCENES / "hertz.toml", **BOTH_SMALL, case=cases, limit=limits)
    state = scene.evaluate()
    assert list(state.cases) == ["a", "b", "c"]
    weighted = {name: case["weighted_value"] for name, case in state.cases.items()}
    assert state.theta == max(weighted.values())
    worst = max(weighted, key=weighted.get)
    assert (state.pressures == state.cases[worst]["pressures"]).all()
    assert [(limit["quantity"], limit["case"]) for limit in state.limits] == [
        ("peak-pressure", "b"), ("stress", "a"), ("stress", "b"), ("stress", "c")
    ]
    assert state.limits[0]["value"] == state.cases["b"]["pressures"].max()


def test_bodies_and_contacts_of_lists_are_told_apart():
    state = contact.Scene.from_toml(SCENES / "stack.toml").evaluate()
    assert list(state.bodies) == ["base", "pad", "head"]
    # The pad is the slave of both contacts and the body whose top is optimized.
    assert set(state.contact_bodies) == {1} and set(state.contacts) == {0, 1}
    assert same_bits(state.positions, state.bodies["pad"]["positions"])
    heights = state.positions[state.contact_nodes, 2]
    assert np.allclose(heights[state.contacts == 0], 18) and np.allclose(heights[state.contacts == 1], 10)
    assert state.pressures.ndim == 1 and state.gradient.shape == (5, 5)
    # Both contacts carry the load of the head, 60 MPa on 14 mm x 14 mm.
    force = (state.areas[:, None] * state.tractions)[:, 2]
    assert np.allclose([force[state.contacts == number].sum() for number in (0, 1)], [11760, -11760])
    assert state.bodies["head"]["von_mises"].shape == (6 * 6 * 3,)


def test_one_mesh_is_refused_for_several_bodies():
    corners = [[x, y, z] for z in (0, 10) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
    with pytest.raises(ValueError, match="mesh = 3 bodies"):
        contact.Scene.from_mesh(corners, [range(8)], {"head": [[4, 5, 6, 7]]}, SCENES / "stack.toml")


def test_facets_and_cells_of_arrays_count_once():
    corners = [[x, y, z] for z in (0, 10) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]

    def scene(cells, foot):
        return contact.Scene.from_mesh(
            corners, cells, {"foot": foot, "head": [[4, 5, 6, 7]], "side": [[0, 3, 7, 4]]},
            name="one cell", friction=0.2,
            body=[{"material": {"young_modulus": 1e5, "poisson_ratio": 0.3},
                   "loads": [{"face": "foot", "pressure": 5.0}],
                   "supports": [{"face": "side", "held": ["u1", "u2"]}],
                   "lattice": {"control_points": [2, 2, 2], "displacement": [-1.0, 1.0]}}],
            contact=[{"slave": {"face": "head"}, "obstacle": {"form": "plane", "height": 10.5}}])

    once = scene([range(8)], [[0, 1, 2, 3]])
    twice = scene([range(8), [1, 2, 3, 0, 5, 6, 7, 4]], [[0, 1, 2, 3], [3, 0, 2, 1], [0, 1, 2, 3]])
    assert same_bits(once.evaluate().pressures, twice.evaluate().pressures)
    assert not [note for note in once.notes if "more than once" in note]
    told = [note for note in twice.notes if "more than once" in note]
    assert len(told) == 1 and "1 facet and 1 cell are listed more than once; each counts once" in told[0]


def test_a_scene_is_shown_before_and_after_its_solve(tmp_path):
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL)
    page = scene.show()
    page.save(tmp_path / "scene.html")
    assert (tmp_path / "scene.html").read_text(encoding="utf-8") == page.html
    assert "nothing is solved" in page.html and 'class="space"' in page.html
    frame = page._repr_html_()
    assert frame.startswith("<iframe srcdoc=") and "<script" not in frame  # quoted for the attribute
    solved = scene.show(scene.start - 0.01)
    assert "In three dimensions" in solved.html and "peak contact pressure" in solved.html
    with pytest.raises(ValueError, match="heights has 1 entries, expected 36"):
        scene.show([1.0])


def test_a_mesh_gets_a_first_scene(tmp_path):
    mesh = tmp_path / "lug.msh"
    mesh.write_bytes((SCENES / "lug_tet10.msh").read_bytes())
    path = contact.new_scene(mesh)
    assert path == str(tmp_path / "lug.toml")
    scene = contact.Scene.from_toml(path)
    assert abs(scene.evaluate().total_force / 26000 - 1) < 1e-3
    assert "nose" in scene.show().html
    with pytest.raises(ValueError, match="exists"):
        contact.new_scene(mesh)
    with pytest.raises(ValueError, match="none.msh"):
        contact.new_scene(tmp_path / "none.msh")


@pytest.mark.parametrize("file", ["signorini.toml", "lug_tet10.toml"])
def test_values_over_the_contact_nodes_are_drawn(file):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    state = contact.Scene.from_toml(SCENES / file).evaluate()
    for values in ["pressures", "gaps", "status", "areas"]:
        axes = state.plot(values)
        drawn = axes.collections[0].get_array()
        known = np.isfinite(np.asarray(getattr(state, values), dtype=float)) & (state.contact_nodes >= 0)
        assert drawn.max() == np.asarray(getattr(state, values), dtype=float)[known].max()
        matplotlib.pyplot.close(axes.figure)
    with pytest.raises(ValueError, match="pressures, gaps"):
        state.plot("stresses")


LIMITED = {"friction": 0.1, "limit": [{"quantity": "peak-pressure", "at_most": 3000.0}, {"quantity": "volume", "at_most": 1.001e6}]}


def test_limits_are_constraints_with_gradients_for_other_optimizers():
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, **LIMITED)
    _bounds, (_rows, limits) = scene.constraints
    start = scene.start.ravel()
    direction = np.cos(np.arange(start.size))
    values = [limits.fun(start + step * direction) for step in (1e-4, -1e-4)]
    slopes = limits.jac(start) @ direction
    assert np.allclose((values[0] - values[1]) / 2e-4, slopes, rtol=1e-4)
    state = scene.evaluate()
    excess = [own["value"] - own["at_most"] for own in state.limits]
    assert np.allclose(limits.fun(start), excess, rtol=1e-9)


def test_the_violation_of_limits_is_told():
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, limit=[{"quantity": "peak-pressure", "at_most": 100.0}])
    result = scene.optimize(options={"max_evaluations": 2})
    assert not result.success
    assert result.constr_violation == max(own["excess"] for own in result.limits) > 1.0


def test_fields_replace_tables_and_none_removes():
    path = "contact[0].obstacle"
    scene = contact.Scene.from_toml(SCENES / "signorini.toml", **SMALL, **{path: {"form": "plane", "height": 103.0}})
    assert "\nfirst = " not in scene.to_toml()
    with pytest.raises(ValueError, match="a contact without its sides"):
        contact.Scene.from_toml(SCENES / "signorini.toml", **{path: None})
